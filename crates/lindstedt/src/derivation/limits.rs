//! What is refused before any work: parameters outside their domains, too much memory.

use super::{Route, Settings};
use crate::{Error, Exact};
use lindstedt_equation::{AmplitudeRole, Expression, Function, Problem};
use rug::Rational;
use std::collections::BTreeMap;

/// x = -y: what starts at x(0) = -a starts at y(0) = a. An equation that is odd in x is that of y,
/// too, and moves at -a as at a half a period later; another one moves on another orbit.
const NEGATIVE: &str = "amplitude > 0 (a start at -a is a start at a of the equation with -x in place of \
                        x, which is the same equation if it is odd)";

/// The parameters there are, in place of one that is none.
pub(crate) fn unknown_parameter(problem: &Problem, name: &str) -> Error {
    let known: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
    let mut known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    if *name == *problem.small {
        known += &format!(" ({name} is the small parameter: no coefficient depends on it)");
    }
    Error::UnknownParameter { problem: problem.name.to_string(), name: name.to_owned(), known }
}

/// Names and domains of the parameters given.
pub fn check_parameters(problem: &Problem, given: &BTreeMap<String, Exact>) -> Result<(), Error> {
    let unknown = given.keys().find(|name| problem.parameters.iter().all(|c| c.name != **name));
    if let Some(name) = unknown {
        return Err(unknown_parameter(problem, name));
    }
    // The values of the card are no better than those given: a file may hold any. What is no
    // number ("+") is no quantity.
    let mut values = given.clone();
    for card in &problem.parameters {
        if let (false, Ok(value)) = (given.contains_key(&*card.name), Exact::parse(&card.default)) {
            values.insert(card.name.to_string(), value);
        }
    }
    check_delays(&problem.equation, &values)?;
    for (name, value) in &values {
        let outside =
            |domain| Error::OutsideDomain { name: name.clone(), value: value.to_string(), domain };
        let scales = matches!(problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        match name.as_str() {
            "amplitude" => {
                let zero = Exact::Rational(Rational::new());
                let bounded = matches!(problem.amplitude, AmplitudeRole::InSums);
                let enters = matches!(
                    problem.amplitude,
                    AmplitudeRole::InSums
                        | AmplitudeRole::ScalesFrequency { .. }
                        | AmplitudeRole::InSmallParameter
                        | AmplitudeRole::Scaled
                );
                if enters && *value < zero {
                    return Err(outside(NEGATIVE));
                } else if enters && *value <= zero {
                    return Err(outside("amplitude > 0 (there is no oscillation at amplitude 0)"));
                } else if bounded && Exact::PiTimes(Rational::from(1)) <= *value {
                    return Err(outside("0 < amplitude < pi (at pi the period is infinite)"));
                }
            }
            "n" | "delta" if scales && *value <= Exact::from(-1) => {
                return Err(outside("greater than -1"));
            }
            _ => {}
        }
    }
    let both = given.get("n").zip(given.get("delta"));
    if let Some((n, delta)) = both.and_then(|(n, d)| n.as_rational().zip(d.as_rational()))
        && *n != Rational::from(delta * 2u32) + 1u32
    {
        return Err(Error::OutsideDomain {
            name: "n".to_owned(),
            value: n.to_string(),
            domain: "n = 1 + 2 delta with the delta given",
        });
    }
    Ok(())
}

/// Refuses x(t - T) with T <= 0, which is no delay.
pub(crate) fn check_delays(e: &Expression, values: &BTreeMap<String, Exact>) -> Result<(), Error> {
    let Some(by) = e.nodes().find_map(Expression::delay) else { return Ok(()) };
    let (name, value) = match by {
        Expression::Parameter(name) => (name.to_string(), values.get(&**name).cloned()),
        Expression::Number(q) => ("delay".to_owned(), Some(Exact::Rational(q.clone()))),
        _ => return Ok(()),
    };
    match value {
        Some(value) if !value.sign().is_gt() => {
            let domain = "greater than 0 (it is a delay)";
            Err(Error::OutsideDomain { name, value: value.to_string(), domain })
        }
        _ => Ok(()),
    }
}

/// Whether the equation needs the Lobachevsky ring, or exp, which the route over many primes does
/// not take.
pub(crate) fn has_logarithms(expression: &Expression) -> bool {
    expression.nodes().any(|e| match e {
        Expression::Power(_, exponent) => !matches!(**exponent, Expression::Number(_)),
        Expression::Function(Function::Ln | Function::Exp, _) | Expression::Formal(..) => true,
        _ => false,
    })
}

/// Refuses before allocating. Measured: the Lobachevsky ring takes 0.7 GiB at order 20 and 1.5
/// times more per order; with formal sums 0.1 GiB at order 10 and twice as much per order; van
/// der Pol's series over Q 0.42 GiB at order 164, growing like the fourth power of the order.
pub(crate) fn limit_memory(problem: &Problem, settings: &Settings) -> Result<(), Error> {
    let order = settings.order as f64;
    let gibibytes = if settings.route == Route::EnergyIntegral {
        // 28 629 terms in 0.1 GiB at order 30; the number of partitions grows by 1.2 per order,
        // with formal sums by 1.5.
        let sums = matches!(problem.amplitude, AmplitudeRole::InSums);
        if sums {
            0.1f64.log2() + (order - 14.0) * 0.6
        } else {
            0.1f64.log2() + (order - 30.0) * 0.27
        }
    } else if matches!(problem.amplitude, AmplitudeRole::InSums) {
        0.1f64.log2() + (order - 10.0)
    } else if has_logarithms(&problem.equation) {
        0.7f64.log2() + (order - 20.0) * 1.5f64.log2()
    } else {
        0.42f64.log2() + 4.0 * (order / 164.0).log2()
    };
    refuse_above(settings.memory, settings.order, gibibytes + 30.0)
}

/// Refuses an order that needs 2^`bits` bytes, if that is more than `memory`.
pub(crate) fn refuse_above(memory: u64, order: usize, bits: f64) -> Result<(), Error> {
    if bits <= (memory.max(1) as f64).log2() {
        return Ok(());
    }
    let exponent = (bits * 2f64.log10()).round() as u64;
    Err(Error::TooLarge { order, exponent, limit: memory >> 20 })
}
