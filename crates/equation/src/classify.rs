//! What an equation is made of, and which methods take it, before any work starts.

use crate::monomials::{MOST_TERMS, Monomial, Monomials, angle, expand};
use crate::roots::root;
use crate::symmetry::{Parity, is_reversible, parity};
use crate::{AccelerationFault, Expression, Function, Problem};
use rug::Rational;
use std::collections::BTreeMap;
use thiserror::Error;

pub use crate::classification::{
    Algebra, Classification, Forcing, Method, Reason, Symmetry, Term, evaluate,
};
pub use crate::roots::rational_root;

/// Ratios of the frequencies of force and oscillator are recognised up to these numbers.
const LARGEST_RESONANCE: u32 = 10;

/// Why an equation could not be classified.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ClassifyError {
    /// x'' is not free.
    #[error("x'' does not stand alone")]
    Acceleration(AccelerationFault),
    /// Multiplied out, the equation is too long.
    #[error("multiplied out, the equation has more than {limit} terms")]
    TooManyTerms {
        /// The limit.
        limit: usize,
    },
}

/// Classifies a problem with the rational values that are known for its parameters.
///
/// # Errors
/// [`ClassifyError`].
///
/// # Example
/// ```
/// use lindstedt_equation::classify::{Method, Symmetry, classify};
/// use lindstedt_equation::{Expression, Problem};
/// let x = Expression::DISPLACEMENT;
/// let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let duffing = Problem::new("duffing", equation);
/// let parts = classify(&duffing, &Default::default())?;
/// assert_eq!(parts.weak.len(), 1);
/// assert_eq!(parts.symmetry, Symmetry::Odd);
/// assert!(parts.takes(Method::LindstedtPoincare));
/// # Ok::<(), lindstedt_equation::classify::ClassifyError>(())
/// ```
pub fn classify(
    problem: &Problem,
    values: &BTreeMap<String, Rational>,
) -> Result<Classification, ClassifyError> {
    let equation = problem.equation.acceleration_alone().map_err(ClassifyError::Acceleration)?;
    let rest = equation.terms().iter().filter(|t| **t != Expression::ACCELERATION).cloned();
    let rest = Expression::Sum(rest.collect()).smooth_powers().canonical();
    let all = expand(&rest).ok_or(ClassifyError::TooManyTerms { limit: MOST_TERMS })?;
    let is_linear = |m: &Monomial| m.order == 0 && m.is_power(1, 0);
    // x (x^2)^delta and x S(delta ln x^2) carry a linear part too.
    let stiffness = linear_at_zero(&rest).unwrap_or_else(|| all.coefficient(is_linear));
    let value = |e: &Expression| evaluate(e, values);
    let mut parts = Classification {
        frequency: root(&stiffness),
        stiffness,
        strong: Vec::new(),
        weak: Vec::new(),
        forcing: Vec::new(),
        delays: collect(&rest, &Expression::is_delayed),
        non_smooth: collect(
            &rest,
            &|e| matches!(e, Expression::Function(Function::Abs | Function::Sign, z) if !z.is_constant()),
        ),
        impact: problem.impact.is_some(),
        symmetry: if problem.impact.is_some() { Symmetry::None } else { Symmetry::Odd },
        reversible: true,
        algebra: Algebra::Numeric,
        methods: Vec::new(),
    };
    let stiffness_value = value(&parts.stiffness);
    for (monomial, q) in &all.terms {
        let term = all.tree(monomial, q);
        if term.contains(&Expression::Time) {
            parts.forcing.push(forcing(&all, monomial, term, stiffness_value.as_ref(), values));
            continue;
        }
        if parity(&term, true) != Some(Parity::Odd) {
            parts.symmetry = Symmetry::None;
        }
        if is_linear(monomial) {
            continue;
        }
        let order = monomial.order;
        // small^order is a factor; delta in (x^2)^delta vanishes at order zero too.
        let hidden = monomial
            .atoms
            .keys()
            .any(|key| all.atoms.get(key).is_some_and(|atom| atom.contains(&Expression::Small)));
        let list = if order > 0 || hidden { &mut parts.weak } else { &mut parts.strong };
        list.push(Term { term, order });
    }
    if !parts.strong.is_empty() && strong_terms_cancel(&rest, values) {
        parts.strong.clear();
    }
    parts.reversible =
        parts.forcing.is_empty() && problem.impact.is_none() && is_reversible(&equation);
    let stiffness_value = value(&parts.stiffness);
    crate::methods::decide(problem, &rest, values, stiffness_value, &mut parts);
    Ok(parts)
}

/// Whether the nonlinear terms at small parameter zero cancel each other at the values given.
fn strong_terms_cancel(rest: &Expression, values: &BTreeMap<String, Rational>) -> bool {
    let bind = |e: &Expression| match e {
        Expression::Small => Some(Expression::integer(0)),
        Expression::Parameter(name) => values.get(name).cloned().map(Expression::Number),
        _ => None,
    };
    let bound = without_trivial_powers(&rest.substitute(&bind).canonical());
    let Some(all) = expand(&bound) else { return false };
    all.terms.iter().all(|(monomial, q)| {
        monomial.is_power(1, 0) || all.tree(monomial, q).contains(&Expression::Time)
    })
}

/// kappa, when the equation at small parameter zero, multiplied out, is kappa x alone.
fn linear_at_zero(rest: &Expression) -> Option<Expression> {
    let off = |e: &Expression| matches!(e, Expression::Small).then(|| Expression::integer(0));
    let at_zero = without_trivial_powers(&rest.substitute(&off).canonical());
    let all = expand(&at_zero)?;
    let linear = all.terms.keys().all(|m| m.is_power(1, 0));
    linear.then(|| all.coefficient(|m| m.is_power(1, 0)))
}

/// y^0 = 1 and F(0) = F_0 where the small parameter was set to zero.
fn without_trivial_powers(e: &Expression) -> Expression {
    let is_zero = |e: &Expression| e.as_number().is_some_and(|n| n.is_zero());
    let at_zero = |e: &Expression| match e {
        Expression::Power(_, n) if is_zero(n) => Some(Expression::integer(1)),
        Expression::Function(Function::Exp, z) if is_zero(z) => Some(Expression::integer(1)),
        Expression::Formal(name, z) if is_zero(z) => {
            Some(Expression::parameter(&format!("{name}_0")))
        }
        _ => None,
    };
    e.map(&at_zero).canonical()
}

fn forcing(
    all: &Monomials,
    monomial: &Monomial,
    term: Expression,
    stiffness: Option<&Rational>,
    values: &BTreeMap<String, Rational>,
) -> Forcing {
    let atoms = || monomial.atoms.keys().filter_map(|key| all.atoms.get(key));
    let harmonic = atoms().find(|atom| atom.contains(&Expression::Time));
    let frequency = harmonic.and_then(frequency_of);
    let squared = frequency.as_ref().and_then(|f| evaluate(f, values)).map(|f| f.clone() * f);
    let resonance = squared
        .zip(stiffness.filter(|kappa| !kappa.is_zero()))
        .and_then(|(s, kappa)| ratio(&(s / kappa)));
    let delayed = atoms().any(Expression::is_delayed);
    let parametric = monomial.x + monomial.velocity > 0 || delayed;
    Forcing { order: monomial.order, frequency, parametric, resonance, term }
}

/// omega of cos(omega t + phase) or sin(omega t + phase), at order zero where the force is detuned.
fn frequency_of(e: &Expression) -> Option<Expression> {
    let Expression::Function(Function::Sin | Function::Cos, argument) = e else { return None };
    let (rate, start) = angle(argument)?;
    let frequency = rate.coefficient(|m| m.order == 0);
    let known = start.terms.keys().all(|m| m.order == 0);
    (known && frequency != Expression::integer(0)).then_some(frequency)
}

/// (k, m) with (k/m)^2 = q.
fn ratio(q: &Rational) -> Option<(u32, u32)> {
    let root = rational_root(q)?;
    let k = root.numer().to_u32().filter(|k| *k <= LARGEST_RESONANCE)?;
    let m = root.denom().to_u32().filter(|m| *m <= LARGEST_RESONANCE)?;
    Some((k, m))
}

/// The subexpressions of a kind, each once.
fn collect(e: &Expression, wanted: &dyn Fn(&Expression) -> bool) -> Vec<Expression> {
    let mut found: Vec<Expression> = Vec::new();
    for e in e.nodes().filter(|e| wanted(e)) {
        if !found.contains(e) {
            found.push(e.clone());
        }
    }
    found
}

/// kappa of x'' + kappa x at order zero; nothing when the equation is too long to multiply out.
pub fn linear_stiffness(equation: &Expression) -> Option<Expression> {
    let all = expand(equation)?;
    Some(all.coefficient(|m| m.order == 0 && m.is_power(1, 0)))
}

/// The coefficients of small^i x^j x'^k by [i, j, k], x'' left out, of an equation that is a
/// polynomial with numbers for coefficients; nothing for another one, or when it is too long to
/// multiply out.
///
/// ```
/// use lindstedt_equation::{Expression, classify::polynomial};
/// let x = Expression::DISPLACEMENT;
/// let duffing = Expression::ACCELERATION + 2 * x.clone() + 3 * Expression::Small * x.pow(3);
/// let terms: Vec<_> = polynomial(&duffing).into_iter().flatten().collect();
/// assert_eq!(terms, [([0, 1, 0], 2.into()), ([1, 3, 0], 3.into())]);
/// ```
pub fn polynomial(equation: &Expression) -> Option<BTreeMap<[u32; 3], Rational>> {
    let without = |e: &Expression| (*e == Expression::ACCELERATION).then(|| Expression::integer(0));
    let all = expand(&equation.substitute(&without))?;
    let plain = |(m, q): (&Monomial, &Rational)| {
        (m.atoms.is_empty() && m.parameters.is_empty())
            .then(|| ([m.order, m.x, m.velocity], q.clone()))
    };
    all.terms.iter().map(plain).collect()
}
