//! Equations with the values put in, and their linear part.

use super::forces::{Angles, InPhases, Phase, is_wave, leading_rates, phases};
use super::modes::{Matrix, spectrum};
use super::unit::Unit;
use super::{Names, ResonanceError};
use crate::error::DerivationError as Error;
use lindstedt_equation::monomials::{MOST_TERMS, Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Unknown};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// The name of an unknown while its equation is multiplied out as one of a parameter: none is written so.
fn stand_in(unknown: &Unknown) -> Expression {
    Expression::parameter(&format!("{}'{}", unknown.index, unknown.derivative))
}

const WAVE: &str = "'t";
const LATE: &str = "'late";

/// The equation at eps = 0, multiplied out, unknowns and forces as parameters.
fn at_zero(equation: &Expression) -> Result<Monomials, ResonanceError> {
    let change = |e: &Expression| match e {
        Expression::Small => Some(Expression::integer(0)),
        Expression::Unknown(Unknown { delay: Some(_), .. }) => Some(Expression::parameter(LATE)),
        Expression::Unknown(unknown) => Some(stand_in(unknown)),
        wave if is_wave(wave) => Some(Expression::parameter(WAVE)),
        _ => None,
    };
    let all = expand(&equation.map(&change).canonical());
    all.ok_or(ResonanceError::TooManyTerms { limit: MOST_TERMS })
}

/// A factor of a term: an unknown (index and derivative), or a force.
fn unknowns_of(m: &Monomial) -> impl Iterator<Item = ([usize; 2], i32)> {
    m.parameters.iter().filter_map(|(name, n)| {
        let (index, derivative) = name.split_once('\'')?;
        Some(([index.parse().ok()?, derivative.parse().ok()?], *n))
    })
}

/// The coefficients of x_k and x_k'' in an equation at order zero, by index.
struct Linear {
    mass: BTreeMap<usize, Expression>,
    stiffness: BTreeMap<usize, Expression>,
}

fn linear(equation: &Expression, names: Names<'_>) -> Result<Linear, ResonanceError> {
    let all = at_zero(equation)?;
    let mut linear = Linear { mass: BTreeMap::new(), stiffness: BTreeMap::new() };
    for (m, q) in &all.terms {
        let refused =
            || ResonanceError::NotWeaklyNonlinear { term: names.shown(&written(&all.tree(m, q))) };
        let mut found = unknowns_of(m);
        let (first, second) = (found.next(), found.next());
        let force = m.parameters.contains_key(WAVE);
        if !m.atoms.is_empty() || m.parameters.contains_key(LATE) {
            return Err(refused());
        }
        let list = match (first, second) {
            (None, None) => continue,
            (Some(([_, 0], 1)), None) if !force => &mut linear.stiffness,
            (Some(([_, 2], 1)), None) if !force => &mut linear.mass,
            _ => return Err(refused()),
        };
        let Some(([index, _], _)) = first else { continue };
        let mut rest = m.clone();
        rest.parameters.retain(|name, _| !name.contains('\''));
        let sum = list.remove(&index).unwrap_or_else(|| 0.into());
        list.insert(index, (sum + all.tree(&rest, q)).canonical());
    }
    Ok(linear)
}

/// A term with its unknowns again.
fn written(e: &Expression) -> Expression {
    e.map(&|e| {
        let Expression::Parameter(name) = e else { return None };
        match name.as_str() {
            WAVE => return Some(Expression::parameter("cos(...*t)")),
            LATE => return Some(Expression::parameter("x(t - ...)")),
            _ => {}
        }
        let (index, derivative) = name.split_once('\'')?;
        Some(Expression::unknown(index.parse().ok()?, derivative.parse().ok()?))
    })
}

fn rational(name: &str, value: &Exact) -> Result<Rational, Error> {
    let irrational = || Error::Irrational { name: name.to_owned(), value: value.to_string() };
    value.as_rational().cloned().ok_or_else(irrational)
}

/// Equations with the values put in and the phases of the forces taken out, and their linear part.
pub(super) struct Prepared {
    pub equations: Vec<Expression>,
    pub forces: Vec<Phase>,
    pub independent: Vec<String>,
    pub unit: Option<Unit>,
    pub angles: Angles,
    pub mass: Matrix,
    pub stiffness: Matrix,
    pub bound: BTreeMap<String, Rational>,
}

impl Prepared {
    /// Prepares the left sides of equations with the values given, and those of the cards where a frequency
    /// depends on them.
    pub(super) fn of(
        equations: &[Expression],
        given: &BTreeMap<String, Exact>,
        cards: &dyn Fn(&str) -> Option<Exact>,
        names: Names<'_>,
    ) -> Result<Self, Error> {
        for e in equations.iter().flat_map(Expression::nodes) {
            match e {
                Expression::Unknown(unknown) if unknown.index >= equations.len() => {
                    let count = unknown.index + 1;
                    let equations = equations.len();
                    return Err(ResonanceError::Equations { unknowns: count, equations }.into());
                }
                _ => {}
            }
        }
        let mut bound = BTreeMap::new();
        let mentioned: BTreeSet<String> =
            equations.iter().flat_map(Expression::parameters).collect();
        // A delay may be a multiple of pi.
        let turns = |name: &String| match given.get(name) {
            Some(Exact::PiTimes(q)) if is_only_late(equations, name) => Some(q.clone()),
            _ => None,
        };
        let equations: Vec<_> = equations.iter().map(|e| with_turns(e, &turns)).collect();
        let given = given.iter().filter(|(name, _)| turns(name).is_none());
        for (name, value) in given.filter(|(name, _)| mentioned.contains(*name)) {
            bound.insert(name.clone(), rational(name, value)?);
        }
        let equations: Vec<_> =
            equations.iter().map(|e| e.with_values(&bound).canonical()).collect();
        // What the frequencies depend on has its value, too.
        let parts = equations.iter().map(|e| linear(e, names)).collect::<Result<Vec<_>, _>>()?;
        let entries = parts.iter().flat_map(|p| p.mass.values().chain(p.stiffness.values()));
        let needed: BTreeSet<String> = entries.flat_map(Expression::parameters).collect();
        let rates = leading_rates(&equations, names)?;
        let rates: BTreeSet<String> = rates.iter().flat_map(Expression::parameters).collect();
        let mut independent = Vec::new();
        for name in needed.union(&rates) {
            match cards(name) {
                Some(value) => drop(bound.insert(name.clone(), rational(name, &value)?)),
                None if needed.contains(name) => {}
                None => independent.push(name.clone()),
            }
        }
        let equations: Vec<_> =
            equations.iter().map(|e| e.with_values(&bound).canonical()).collect();
        let parts = equations.iter().map(|e| linear(e, names)).collect::<Result<Vec<_>, _>>()?;
        let entries = parts.iter().flat_map(|p| p.stiffness.values());
        let unit = Unit::symbol(parts.iter().flat_map(|p| p.mass.values()), entries)?;
        let matrix = |of: &dyn Fn(&Linear) -> &BTreeMap<usize, Expression>, unit: Option<&Unit>| {
            let number = |e: &Expression| unit.map_or(e.as_number(), |unit| unit.multiples(e));
            let entry = |p: &Linear, j| match of(p).get(&j) {
                None => Ok(Rational::new()),
                Some(e) => number(e).ok_or_else(|| ResonanceError::IrrationalFactor {
                    factor: names.shown(e),
                    unknown: names.0.unknown(j),
                }),
            };
            let row = |p| (0..parts.len()).map(|j| entry(p, j)).collect();
            parts.iter().map(row).collect::<Result<Matrix, _>>()
        };
        let (mass, stiffness) =
            (matrix(&|p| &p.mass, None)?, matrix(&|p| &p.stiffness, unit.as_ref())?);
        let root = || {
            let squares = spectrum(&mass, &stiffness).ok()?.squares;
            Unit::root(&squares, &leading_rates(&equations, names).ok()?)
        };
        let unit = unit.or_else(|| root().filter(|_| independent.is_empty()));
        let named = |e: &Expression| unit.as_ref().map_or_else(|| e.clone(), |unit| unit.named(e));
        let equations: Vec<_> = equations.iter().map(named).collect();
        let InPhases { phases: forces, equations, angles } =
            phases(&equations, (unit.as_ref(), &independent), names)?;
        Ok(Self { equations, forces, independent, unit, angles, mass, stiffness, bound })
    }
}

/// Whether a parameter occurs in delays alone.
fn is_only_late(equations: &[Expression], name: &str) -> bool {
    let now = |e: &Expression| match e {
        Expression::Unknown(x) if x.delay.is_some() => Some(Expression::unknown(x.index, 0)),
        _ => None,
    };
    let occurs = |e: &Expression| e.parameters().iter().any(|known| known == name);
    equations.iter().any(occurs) && !equations.iter().any(|e| occurs(&e.map(&now)))
}

/// q pi in the place of every parameter for which there is a q.
fn with_turns(e: &Expression, q: &dyn Fn(&String) -> Option<Rational>) -> Expression {
    e.substitute(&|e| {
        let Expression::Parameter(name) = e else { return None };
        Some(Expression::Number(q(name)?) * Expression::parameter("pi"))
    })
}
