//! From the equations of a problem to what is averaged: values put in, modes, the phase of the forces.

use super::algebraic::{AlgebraicModes, Entry};
use super::conserved::{axes, conserved_energy};
use super::forces::{
    Angles, InPhases, Phase, around, combination, harmonic, is_internal, is_wave, leading_rates,
    near, phases, sum,
};
use super::modes::{Matrix, Spectrum, inverted, spectrum};
use super::unit::Unit;
use super::{Names, ResonanceError};
use crate::error::DerivationError as Error;
use lindstedt_equation::monomials::{MOST_TERMS, Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Function, Unknown};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// What is averaged: x_j'' + nu_j^2 x_j + ... = 0 with forces cos(m eta_l), eta_l = Omega_l t + the detuning; frequencies
/// in multiples of the unit.
#[derive(Clone, Debug)]
pub struct System {
    /// The left sides, x_j'' alone; where there are shapes, of the modes.
    pub equations: Vec<Expression>,
    /// What frequencies and the rates of forces are multiples of; nothing where that is 1.
    pub unit: Option<Box<Unit>>,
    /// nu_j; of an irrational one a rational number beside it: within 2^-200, in a flow within its radius
    /// ([`Enclosed`](super::Enclosed)).
    pub frequencies: Vec<Rational>,
    /// nu_j^2.
    pub squares: Vec<Rational>,
    /// The phases of the forces.
    pub forces: Vec<Phase>,
    /// Parameters without a value that the rates of the forces depend on: taken to be independent of one another
    /// and of all numbers, so that no sum of them is a resonance unless it is one identically.
    pub independent: Vec<String>,
    /// Names without a value, in the order of printing.
    pub symbols: Vec<String>,
    /// P of x = P q, where the unknowns are no modes.
    pub shapes: Option<Matrix>,
    /// Where squares or shapes are irrational: what their numbers here are beside.
    pub algebraic: Option<AlgebraicModes>,
    /// The symbols that are cosines and sines of constant angles, with the angle and whether it is the sine: what forces
    /// are ahead of their phase, and what delays turn phases by.
    pub angles: BTreeMap<String, (Expression, bool)>,
    /// The values that were put in.
    pub bound: BTreeMap<String, Rational>,
    /// The frequency that was given where it lies beside a resonance, and the name of its detuning.
    pub beside: Option<Beside>,
}

/// From which rate a force is detuned: one that it lies beside, none, or this one.
#[derive(Clone, Copy)]
pub(super) enum Detuned<'a> {
    Beside,
    Not,
    From(&'a Rational),
}

/// A frequency beside a resonance: rate = Omega + eps * symbol.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The rate of the force's phase as it was given.
    pub rate: Rational,
    /// The symbol (rate - Omega)/eps.
    pub symbol: String,
}

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

impl System {
    /// What is averaged, with a force detuned by a symbol as it is asked for.
    pub(super) fn of(
        equations: &[Expression],
        given: &BTreeMap<String, Exact>,
        cards: &dyn Fn(&str) -> Option<Exact>,
        names: Names<'_>,
        detuned: Detuned<'_>,
    ) -> Result<Self, Error> {
        let prepared = Prepared::of(equations, given, cards, names)?;
        let (mass, stiffness) = (&prepared.mass, &prepared.stiffness);
        let irrational = || ResonanceError::NoRationalForm;
        let unit = prepared.unit;
        // Without a number nothing is enclosed.
        let symbol = unit.clone().filter(|unit| unit.square.is_none());
        let enclosed = || symbol.as_ref().map_or(Ok(()), |unit| Err(unit.unset()));
        let (mut modes, mut algebraic) = match spectrum(mass, stiffness) {
            Err(ResonanceError::NoRationalForm) => {
                enclosed()?;
                let found = AlgebraicModes::of(mass, stiffness)?;
                (found.spectrum().ok_or_else(irrational)?, Some(found))
            }
            other => (other?, None),
        };
        unit.iter().for_each(|unit| unit.scaled(&mut modes.squares));
        let frequencies = modes.frequencies_nearby().map_err(|error| match (error, &symbol) {
            (ResonanceError::NoOscillation { square }, Some(unit)) => {
                ResonanceError::NoOscillation { square: format!("{square}*{}^2", unit.name) }
            }
            (other, _) => other,
        })?;
        let squares = modes.squares.clone();
        let of = |modes: &_| separated(&prepared.equations, modes, algebraic.as_ref(), names);
        let mut equations = of(&modes)?;
        // Of equal frequencies the modes are whichever have the energy in the squares of their velocities.
        let equal = squares.iter().enumerate().any(|(j, square)| squares[..j].contains(square));
        if equal
            && prepared.forces.is_empty()
            && let Some(axes) = axes(&equations)
            && let Some(other) = modes.with_axes(&axes)
        {
            modes = other;
            equations = of(&modes)?;
        }
        if let Some(known) = &mut algebraic
            && prepared.forces.is_empty()
        {
            known.energy = energy(&prepared.equations, &modes, known, names)?;
        }
        if let Some(unit) = &unit {
            let own = equations.into_iter().zip(&squares).enumerate();
            equations = own.map(|(j, (e, square))| unit.with_squares(e, j, square)).collect();
        }
        let detunings = prepared.forces.iter().flat_map(|phase| &phase.detuning);
        let mut symbols = symbols(equations.iter().chain(detunings), names);
        let is_unit = |name: &String| unit.as_ref().is_some_and(|unit| unit.name == *name);
        symbols.retain(|name| !prepared.independent.contains(name) && !is_unit(name));
        let system = Self {
            equations,
            unit: unit.map(Box::new),
            frequencies,
            squares,
            forces: prepared.forces,
            independent: prepared.independent,
            angles: prepared.angles,
            symbols,
            shapes: modes.shapes,
            algebraic,
            bound: prepared.bound,
            beside: None,
        };
        if !system.is_exact() {
            enclosed()?;
        }
        if let Some(first) = system.independent.first().filter(|_| !system.is_exact()) {
            // Nothing says that they are independent of square roots.
            let (first, second) = (first.clone(), "irrational frequencies".to_owned());
            return Err(ResonanceError::NoRatio { first, second }.into());
        }
        let rate = system.force();
        let at = match detuned {
            Detuned::From(at) => Some(at.clone()).filter(|at| *at != rate),
            Detuned::Beside if rate > 0 => near(&rate, &system.frequencies),
            _ => None,
        };
        Ok(match at {
            Some(at) => system.detuned_from(at),
            None => system,
        })
    }

    /// Whether all frequencies are rational multiples of the unit.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let square = |nu: &Rational| nu.clone().square();
        self.algebraic.is_none()
            && self.frequencies.iter().zip(&self.squares).all(|(nu, known)| square(nu) == *known)
    }

    /// nu_j^2 in numbers, not in multiples of a root.
    pub(super) fn plain_squares(&self) -> Vec<Rational> {
        self.unit.as_ref().map_or_else(|| self.squares.clone(), |unit| unit.plain(&self.squares))
    }

    /// The first frequency without a value that coefficients are divided by.
    #[must_use]
    pub fn open_frequency(&self) -> Option<&String> {
        let unit = self.unit.as_ref().filter(|unit| unit.square.is_none());
        unit.map(|unit| &unit.name).or(self.independent.first())
    }

    /// The value of the unit; nothing where it is a symbol without one.
    #[must_use]
    pub fn unit_value(&self, values: &dyn Fn(&str) -> Option<Exact>, balls: Balls) -> Option<Ball> {
        self.unit.as_ref().map_or_else(|| Some(balls.one()), |unit| unit.value(values, balls))
    }

    /// The rates of the only force at resonances that this one is around, a half of them away at most, those of the
    /// lowest order first, then the nearest; none where it is at one.
    #[must_use]
    pub fn resonances_around(&self) -> Vec<Rational> {
        let rate = self.beside.as_ref().map_or_else(|| self.force(), |beside| beside.rate.clone());
        if rate > 0 { around(&rate, &self.frequencies) } else { Vec::new() }
    }

    /// Omega of the only force, where it is a multiple of the unit; else 0.
    #[must_use]
    pub fn force(&self) -> Rational {
        match &self.forces[..] {
            [only] => only.number().unwrap_or_default(),
            _ => Rational::new(),
        }
    }

    /// P^-1 of q = P^-1 x, where the unknowns are no modes.
    #[must_use]
    pub fn modes(&self) -> Option<Matrix> {
        self.shapes.as_ref().and_then(inverted)
    }

    /// The equations with cos m eta_l and sin m eta_l as parameters of the names `of` gives.
    pub(super) fn with_waves(
        &self,
        of: &dyn Fn(Function, usize, i32) -> String,
    ) -> Vec<Expression> {
        let named = |e: &Expression| {
            let (function, l, m) = harmonic(e).filter(|_| is_wave(e))?;
            Some(Expression::parameter(&of(function, l, m)))
        };
        self.equations.iter().map(|e| e.map(&named)).collect()
    }

    /// cos(m eta_l) or sin(m eta_l) with the angle of the phase in the time.
    pub(super) fn written(&self, (l, m, sine): (usize, i32, bool)) -> Option<Expression> {
        let phase = self.forces.get(l)?;
        let unit = self.unit.as_ref().map_or_else(|| 1.into(), |unit| unit.expression());
        let others = self.independent.iter().map(|name| Expression::parameter(name));
        let rates = phase.rate.iter().zip(std::iter::once(unit).chain(others));
        let rates = rates.map(|(q, factor)| Expression::Number(q.clone()) * factor);
        let detuned =
            (1i64..).zip(&phase.detuning).map(|(n, e)| Expression::Small.pow(n) * e.clone());
        let rate = Expression::Sum(rates.chain(detuned).collect());
        let angle = i64::from(m) * (rate * Expression::Time + phase.start.clone());
        let function = if sine { Function::Sin } else { Function::Cos };
        Some(angle.canonical().apply(function))
    }

    /// Puts the rates that are sums of irrational frequencies beside these as they are now.
    pub(super) fn settle_rates(&mut self) {
        for phase in self.forces.iter_mut().filter(|phase| !phase.of_modes.is_empty()) {
            phase.rate[0] = sum(&phase.of_modes, &self.frequencies);
        }
    }

    /// With the symbol of the detuning of the only force from a rate.
    fn detuned_from(mut self, at: Rational) -> Self {
        let (rate, exact) = (self.force(), self.is_exact());
        let [phase] = &mut self.forces[..] else { return self };
        let free = |name: &&str| !self.symbols.iter().any(|known| known == name);
        let symbol = ["sigma", "detuning", "sigma_0"].into_iter().find(free).unwrap_or("sigma_1");
        self.symbols.push(symbol.to_owned());
        if phase.detuning.is_empty() {
            phase.detuning.push(0.into());
        }
        phase.detuning[0] = (phase.detuning[0].clone() + Expression::parameter(symbol)).canonical();
        phase.rate[0] = at;
        if !exact {
            phase.of_modes = combination(&phase.rate[0], &self.frequencies).unwrap_or_default();
        }
        self.settle_rates();
        self.beside = Some(Beside { rate, symbol: symbol.to_owned() });
        self
    }
}

/// The names that occur, in the order of the data card, which is that of printing.
pub(super) fn symbols<'a>(
    equations: impl Iterator<Item = &'a Expression>,
    names: Names<'_>,
) -> Vec<String> {
    let used = equations.flat_map(Expression::parameters).filter(|name| !is_internal(name));
    let used: BTreeSet<String> = used.collect();
    let cards = names.0.parameters.iter().map(|card| card.name.to_string());
    let mut symbols: Vec<String> = cards.filter(|name| used.contains(name)).collect();
    let unlisted: Vec<_> = used.into_iter().filter(|name| !symbols.contains(name)).collect();
    symbols.extend(unlisted);
    symbols
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

/// Refuses a delay where one is not taken.
pub(super) fn refuse_delays(
    equations: &[Expression],
    names: Names<'_>,
) -> Result<(), ResonanceError> {
    let late = |e: &&Expression| matches!(e, Expression::Unknown(x) if x.delay.is_some());
    match equations.iter().flat_map(Expression::nodes).find(late) {
        None => Ok(()),
        Some(e) => Err(ResonanceError::Delay { term: names.shown(e) }),
    }
}

/// q_j'' + the rest of equation j, with x = P q in it; irrational numbers by their names.
pub(super) fn separated(
    equations: &[Expression],
    modes: &Spectrum,
    algebraic: Option<&AlgebraicModes>,
    names: Names<'_>,
) -> Result<Vec<Expression>, ResonanceError> {
    let without: Vec<Expression> =
        equations.iter().map(|e| without_acceleration(e, names)).collect::<Result<_, _>>()?;
    let without = match algebraic {
        None => without,
        Some(known) => without.iter().zip(&known.stiffness).map(without_stiffness).collect(),
    };
    let named = algebraic.is_some();
    let without: Vec<Expression> = without.iter().map(|e| in_modes(e, modes, named)).collect();
    let equation = |(j, row): (usize, &Vec<Rational>)| {
        let parts = row.iter().enumerate().zip(&without).filter(|((_, q), _)| !q.is_zero());
        let terms = parts
            .map(|((i, q), e)| (factor(q, Entry::Inverse(j, i), named) * e.clone()).canonical());
        let terms = terms.flat_map(|e| e.terms().to_vec());
        let square = algebraic.map(|_| Entry::Square(j).name());
        let square = square.map(|name| Expression::parameter(&name) * Expression::unknown(j, 0));
        let first = [Expression::unknown(j, 2)].into_iter().chain(square);
        Expression::Sum(first.chain(terms).collect())
    };
    Ok(modes.inverse.iter().enumerate().map(equation).collect())
}

/// A number; irrational ones have names, in the place of which their enclosures are put.
fn factor(q: &Rational, entry: Entry, named: bool) -> Expression {
    if named { Expression::parameter(&entry.name()) } else { Expression::Number(q.clone()) }
}

/// With P q in the place of x.
fn in_modes(e: &Expression, modes: &Spectrum, named: bool) -> Expression {
    let shape = |e: &Expression| {
        let (Some(shapes), Expression::Unknown(unknown)) = (&modes.shapes, e) else { return None };
        let mode = |index| Expression::Unknown(Unknown { index, ..unknown.clone() });
        let part =
            |(j, p): (usize, &Rational)| factor(p, Entry::Shape(unknown.index, j), named) * mode(j);
        Some(Expression::Sum(shapes[unknown.index].iter().enumerate().map(part).collect()))
    };
    e.map(&shape)
}

/// The energy that the equations solved for the x_j'' conserve, in irrational modes: names of their numbers would hide that these
/// depend on each other.
fn energy(
    equations: &[Expression],
    modes: &Spectrum,
    known: &AlgebraicModes,
    names: Names<'_>,
) -> Result<Option<Expression>, ResonanceError> {
    let inverse = known.mass_inverse.clone();
    let own = Spectrum { squares: Vec::new(), shapes: None, inverse };
    let own = separated(equations, &own, None, names)?;
    Ok(conserved_energy(&own).map(|energy| in_modes(&energy, modes, true)))
}

/// The equation without sum_j k_j x_j at order zero.
fn without_stiffness((equation, row): (&Expression, &Vec<Rational>)) -> Expression {
    let term = |(j, k): (usize, &Rational)| {
        Expression::Number(Rational::from(-k)) * Expression::unknown(j, 0)
    };
    let terms = row.iter().enumerate().map(term);
    let all = Expression::Sum(std::iter::once(equation.clone()).chain(terms).collect());
    all.multiplied_out().unwrap_or(all).canonical()
}

/// The equation without the x_k'', which stand in terms of their own with constant factors.
fn without_acceleration(
    equation: &Expression,
    names: Names<'_>,
) -> Result<Expression, ResonanceError> {
    let accelerated =
        |e: &Expression| matches!(e, Expression::Unknown(Unknown { derivative: 2.., .. }));
    let alone = |term: &Expression| match term {
        Expression::Product(factors) => {
            let (with, others): (Vec<_>, Vec<_>) = factors.iter().partition(|f| accelerated(f));
            with.len() == 1 && others.iter().all(|e| matches!(e, Expression::Number(_)))
        }
        single => accelerated(single),
    };
    let holds = |e: &Expression| e.nodes().any(accelerated);
    let split = |e: &Expression| {
        let (with, rest): (Vec<_>, Vec<_>) = e.terms().iter().cloned().partition(holds);
        match with.iter().find(|term| !alone(term)) {
            None => Ok(Expression::Sum(rest).canonical()),
            Some(term) => Err(ResonanceError::Acceleration { term: names.shown(term) }),
        }
    };
    split(&equation.canonical()).or_else(|error| {
        let all = equation.multiplied_out().ok_or(error)?;
        split(&all)
    })
}
