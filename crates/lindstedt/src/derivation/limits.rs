//! What is refused before any work: parameters outside their domains, too much memory.

use super::{Route, Settings};
use crate::{Error, Value};
use lindstedt_coeff::ball::Balls;
use lindstedt_equation::{AmplitudeRole, Expression, Function, Problem};
use std::collections::BTreeMap;

/// Names and domains of the parameters given.
pub(super) fn check_parameters(
    problem: &Problem,
    given: &BTreeMap<String, Value>,
) -> Result<(), Error> {
    for (name, value) in given {
        if !problem.parameters.iter().any(|card| card.name == name) {
            let known: Vec<&str> = problem.parameters.iter().map(|card| card.name).collect();
            return Err(Error::UnknownParameter {
                problem: problem.name.to_owned(),
                name: name.clone(),
                known: known.join(", "),
            });
        }
        let outside =
            |domain| Error::OutsideDomain { name: name.clone(), value: value.to_string(), domain };
        let ball = value.ball(Balls::new(64));
        let balls = Balls::new(256);
        let exact = value.ball(balls);
        match name.as_str() {
            "amplitude" => match problem.amplitude {
                AmplitudeRole::ScalesFrequency { .. } if !ball.is_positive() => {
                    return Err(outside("amplitude > 0 (there is no oscillation at amplitude 0)"));
                }
                AmplitudeRole::InSums => {
                    // pi itself is the separatrix; a rational multiple of pi is compared exactly.
                    let below = match value {
                        Value::PiTimes(q) => *q < 1,
                        Value::Rational(_) => balls.sub(&balls.pi(), &exact).is_positive(),
                    };
                    if !ball.is_positive() || !below {
                        return Err(outside("0 < amplitude < pi (at pi the period is infinite)"));
                    }
                }
                AmplitudeRole::InSmallParameter if !exact.is_positive() => {
                    return Err(outside("amplitude > 0 (there is no oscillation at amplitude 0)"));
                }
                _ => {}
            },
            "n" | "delta"
                if problem.amplitude == (AmplitudeRole::ScalesFrequency { exponent: 2 })
                    && !balls.add(&exact, &balls.one()).is_positive() =>
            {
                return Err(outside("greater than -1"));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether the equation needs the Lobachevsky ring.
pub(super) fn has_logarithms(expression: &Expression) -> bool {
    match expression {
        Expression::Sum(list) | Expression::Product(list) => list.iter().any(has_logarithms),
        Expression::Power(base, exponent) => {
            !matches!(**exponent, Expression::Number(_)) || has_logarithms(base)
        }
        Expression::Function(Function::Ln, _) | Expression::Formal(..) => true,
        Expression::Function(_, argument) => has_logarithms(argument),
        _ => false,
    }
}

/// Refuses before allocating. Measured: the Lobachevsky ring takes 0.7 GiB at order 20 and 1.5
/// times more per order; with formal sums 0.1 GiB at order 10 and twice as much per order; van
/// der Pol's series over Q 0.42 GiB at order 164, growing like the fourth power of the order.
pub(super) fn limit_memory(problem: &Problem, settings: &Settings) -> Result<(), Error> {
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
    let bits = gibibytes + 30.0;
    if bits > (settings.memory.max(1) as f64).log2() {
        return Err(Error::TooLarge {
            order: settings.order,
            exponent: (bits * 2f64.log10()).round() as u64,
            limit: settings.memory >> 20,
        });
    }
    Ok(())
}
