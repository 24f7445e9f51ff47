//! From a problem as it was written to the equation that is expanded: values put in, x scaled by
//! the amplitude, time scaled so that the linear stiffness is 1 where the velocity occurs.

use crate::error::DerivationError as Error;
use crate::settings::Settings;
use lindstedt_equation::classify::{linear_stiffness, rational_root};
use lindstedt_equation::print::Style;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem, Unknown};
use lindstedt_expand::ExpandError;
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// A problem ready for the driver.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The problem with the equation that is expanded.
    pub problem: Problem,
    /// Values that were put in.
    pub bound: BTreeMap<String, Rational>,
    /// omega_0, where time was scaled.
    pub time_scale: Rational,
}

/// Prepares a problem. With a free amplitude parameters stay symbols and nothing is scaled.
///
/// # Errors
/// [`Error::Irrational`], [`Error::BadValue`], and those of an x'' that does not stand alone.
pub fn prepare(problem: &Problem, settings: &Settings) -> Result<Prepared, Error> {
    let mut prepared = Prepared {
        problem: problem.clone(),
        bound: BTreeMap::new(),
        time_scale: Rational::from(1),
    };
    let condition = settings.condition.or(problem.conditions.first().copied());
    if matches!(condition, None | Some(Condition::FreeAmplitude)) {
        return Ok(prepared);
    }
    let value = |name: &str| -> Result<Option<Rational>, Error> {
        let card = problem.parameters.iter().find(|card| card.name == name);
        let default = card.map(|card| &*card.default).filter(|text| !text.is_empty());
        let value = match (settings.parameters.get(name), default) {
            (Some(value), _) => value.clone(),
            (None, Some(text)) => Exact::parse(text)?,
            (None, None) => return Ok(None),
        };
        let irrational = || Error::Irrational { name: name.to_owned(), value: value.to_string() };
        value.as_rational().cloned().map(Some).ok_or_else(irrational)
    };
    let mut equation = problem.equation.smooth_powers().canonical();
    for name in equation.parameters() {
        if let Some(q) = value(&name)? {
            prepared.bound.insert(name, q);
        }
    }
    if !prepared.bound.is_empty() {
        let put_in = |e: &Expression| match e {
            Expression::Parameter(name) => {
                prepared.bound.get(name).cloned().map(Expression::Number)
            }
            _ => None,
        };
        equation = equation.substitute(&put_in).canonical();
    }
    equation = equation.acceleration_alone().map_err(|_| {
        let term = equation.print(&problem.small, Style::Text);
        ExpandError::AccelerationNotIsolated { term }
    })?;
    if problem.amplitude == AmplitudeRole::Scaled {
        let amplitude = value("amplitude")?.unwrap_or_else(|| Rational::from(1));
        equation = scale(equation, &amplitude, &Rational::from(1));
    }
    if equation.contains(&Expression::VELOCITY)
        && !equation.nodes().any(|e| *e == Expression::Time || e.is_delayed())
        && let Some(Expression::Number(kappa)) = linear_stiffness(&equation)
        && let Some(root) = rational_root(&kappa)
    {
        equation = scale(equation, &Rational::from(1), &root);
        prepared.time_scale = root;
    }
    prepared.problem.equation = equation;
    Ok(prepared)
}

/// The equation of y(s) for x = a y, t = s/w, divided by a w^2.
fn scale(equation: Expression, a: &Rational, w: &Rational) -> Expression {
    if *a == 1 && *w == 1 {
        return equation;
    }
    let number = |q: Rational| Expression::Number(q);
    let change = |e: &Expression| match e {
        Expression::Unknown(Unknown { derivative: 0, .. }) => Some(number(a.clone()) * e.clone()),
        Expression::Unknown(Unknown { derivative: 1, .. }) => {
            Some(number(Rational::from(a * w)) * e.clone())
        }
        _ => None,
    };
    let inverse = (a * Rational::from(w * w)).recip();
    let term = |term: &Expression| match *term == Expression::ACCELERATION {
        true => Expression::ACCELERATION,
        false => number(inverse.clone()) * term.substitute(&change),
    };
    let scaled = Expression::Sum(equation.terms().iter().map(term).collect());
    distribute_powers(&scaled).canonical()
}

/// (q y)^n as q^n y^n, so that numbers meet.
fn distribute_powers(e: &Expression) -> Expression {
    let change = |e: &Expression| {
        let Expression::Power(base, n) = e else { return None };
        n.as_number().filter(Rational::is_integer)?;
        Some(match distribute_powers(base).canonical() {
            Expression::Product(mut factors)
                if matches!(factors.first(), Some(Expression::Number(_))) =>
            {
                let number = factors.remove(0).pow((**n).clone());
                number * Expression::Product(factors).canonical().pow((**n).clone())
            }
            base => base.pow((**n).clone()),
        })
    };
    e.map(&change)
}
