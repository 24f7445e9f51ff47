//! What is refused before any work: parameters outside their domains, too much memory.

use crate::error::DerivationError as Error;
use crate::settings::{Route, Settings};
use crate::values::all_values;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Function, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_multimodular::Proved;
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// x = -y: what starts at x(0) = -a starts at y(0) = a. An equation that is odd in x is that of y,
/// too, and moves at -a as at a half a period later; another one moves on another orbit.
const NEGATIVE: &str = "amplitude > 0 (a start at -a is a start at a of the equation with -x in place of \
                        x, which is the same equation if it is odd)";

/// The parameters there are, in place of one that is none.
pub(crate) fn unknown_parameter(problem: &Problem, name: &str) -> Error {
    let known: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    Error::UnknownParameter { problem: problem.name.to_string(), name: name.to_owned(), known }
}

/// Refuses symbols named like something that the answer is written with: `meaning` of a name, without the number
/// behind `_`, and whether it has one.
///
/// # Errors
/// [`Error::SymbolTaken`].
pub(crate) fn refuse_taken<'a>(
    symbols: impl IntoIterator<Item = &'a String>,
    meaning: impl Fn(&str, bool) -> Option<&'static str>,
) -> Result<(), Error> {
    for name in symbols {
        let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let (base, numbered) = match name.split_once('_') {
            Some((base, text)) if number(text) => (base, true),
            _ => (&**name, false),
        };
        if let Some(meaning) = meaning(base, numbered) {
            return Err(Error::SymbolTaken { name: name.clone(), meaning });
        }
    }
    Ok(())
}

/// Refuses symbols whose powers could leave the type of exponents, where a product would stop at its end: an order
/// holds at most one factor of the law and one division by the linear part more than the order below, each with
/// powers up to those of the equation; as much again is left for what is formed on the way.
///
/// # Errors
/// [`ExpandError::UnsupportedTerm`] with the power.
pub(crate) fn refuse_high_powers<'a>(
    equations: impl IntoIterator<Item = &'a Expression>,
    order: usize,
) -> Result<(), Error> {
    for equation in equations {
        let power = equation.fold(&mut highest_power);
        let within = power.saturating_add(1).saturating_mul(4 * (order as u64 + 1));
        if within > u64::from(i16::MAX.unsigned_abs()) {
            let term = format!("a parameter to a power up to {power} at order {order}");
            return Err(ExpandError::UnsupportedTerm { term }.into());
        }
    }
    Ok(())
}

/// A bound of the powers of parameters in an expression, from those in its [`Expression::children`].
fn highest_power(e: &Expression, below: &[u64]) -> u64 {
    let sum = || below.iter().fold(0, |sum: u64, power| sum.saturating_add(*power));
    match (e, below) {
        (Expression::Parameter(_), _) => 1,
        (Expression::Power(_, exponent), [base, _]) => match &**exponent {
            Expression::Number(q) => {
                let n = q.clone().abs().ceil().numer().to_u64().unwrap_or(u64::MAX);
                base.saturating_mul(n)
            }
            _ => sum(),
        },
        (Expression::Product(_), _) => sum(),
        _ => below.iter().copied().max().unwrap_or(0),
    }
}

/// Names and domains of the parameters given.
///
/// # Errors
/// [`Error::UnknownParameter`], [`Error::OutsideDomain`].
pub fn check_parameters(problem: &Problem, given: &BTreeMap<String, Exact>) -> Result<(), Error> {
    let unknown = given.keys().find(|name| problem.parameters.iter().all(|c| c.name != **name));
    if let Some(name) = unknown {
        return Err(unknown_parameter(problem, name));
    }
    // The values of the card are no better than those given: a file may hold any.
    let values = all_values(problem, given);
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
///
/// # Errors
/// [`Error::OutsideDomain`].
pub fn check_delays(e: &Expression, values: &BTreeMap<String, Exact>) -> Result<(), Error> {
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
#[must_use]
pub fn has_logarithms(expression: &Expression) -> bool {
    expression.nodes().any(|e| match e {
        Expression::Power(_, exponent) => !matches!(**exponent, Expression::Number(_)),
        Expression::Function(Function::Ln | Function::Exp, _) | Expression::Formal(..) => true,
        _ => false,
    })
}

/// The order up to which an expansion over Q is derived to see how its numbers grow.
const PROBE: usize = 24;

/// The bytes of all numbers and the terms of every order of an expansion up to one.
pub(crate) type Bytes<'a> = dyn Fn(usize) -> Option<Vec<[f64; 2]>> + 'a;

/// The bytes and the terms of the Fourier coefficients of an expansion, order by order.
pub(crate) fn bytes_of(proved: &Proved) -> Vec<[f64; 2]> {
    proved.solution.iter().map(|x| [x.bits() as f64 / 8.0, x.terms() as f64]).collect()
}

/// log2 of the bytes that an expansion over Q takes. The numbers grow like a power of the order (measured: Duffing
/// 3.0, van der Pol 3.9; all numbers of an order N have N^3 or N^4 bits), which two low orders show; of them there are
/// N^2, each with 56 bytes of its own. At the peak residues and the printed form stand beside them. Between the peaks
/// of text and of JSON, MB: van der Pol 120 47 and 65, 164 78 and 162, Duffing 200 47 and 56, 400 142 and 225.
fn over_q(order: usize, bytes: &Bytes<'_>) -> f64 {
    let base = 16e6;
    // What cannot be derived says so itself.
    let Some(probe) = (order > PROBE).then(|| bytes(PROBE)).flatten() else {
        return f64::log2(base);
    };
    let sum = |n: usize, part: usize| probe.iter().take(n + 1).map(|x| x[part]).sum::<f64>();
    let [half, whole] = [PROBE / 2, PROBE].map(|n| sum(n, 0));
    let rate = (whole / half).log2().clamp(2.5, 4.0);
    let longer = order as f64 / PROBE as f64;
    let held = whole * longer.powf(rate) + 56.0 * sum(PROBE, 1) * longer.powi(2);
    f64::log2(base + 11.0 * held)
}

/// log2 of the bytes that an expansion by a clock takes, between what it is as text, which counts long functions, and as
/// JSON, which has them all: monomials grow with the partitions of the order, like exp(2.5 N^(1/2)), and their
/// coefficients do again where they are polynomials in the sums.
fn by_clock(order: f64, sums: bool) -> f64 {
    let (bytes, at, rate) = if sums { (0.45e9, 16.0f64, 4.28) } else { (0.18e9, 30.0f64, 2.47) };
    let growing = f64::log2(bytes) + rate * (order.sqrt() - at.sqrt()) / std::f64::consts::LN_2;
    let base = f64::log2(13e6);
    let (less, more) = (base.min(growing), base.max(growing));
    more + (less - more).exp2().ln_1p() / std::f64::consts::LN_2
}

/// Whether the frequency alone goes by primes: the energy integral is of forces without velocity, from x(0).
fn by_primes(problem: &Problem, settings: &Settings) -> bool {
    let asked = settings.condition.or(problem.conditions.first().copied());
    let moves = problem.equation.contains(&Expression::VELOCITY);
    settings.route == Route::Frequency
        && !has_logarithms(&problem.equation)
        && (moves || asked != Some(Condition::InitialAmplitude))
}

/// Refuses before allocating. Measured: the Lobachevsky ring takes 0.7 GiB at order 20 and 1.5
/// times more per order; with formal sums 0.1 GiB at order 10 and twice as much per order; over Q
/// `bytes` tells the size of the numbers up to an order ([`bytes_of`]).
pub(crate) fn limit_memory(
    problem: &Problem,
    settings: &Settings,
    bytes: &Bytes<'_>,
) -> Result<(), Error> {
    let order = settings.order as f64;
    let sums = matches!(problem.amplitude, AmplitudeRole::InSums);
    let logarithms = has_logarithms(&problem.equation);
    let alone = matches!(settings.route, Route::EnergyIntegral | Route::Frequency);
    let bits = if alone && by_primes(problem, settings) {
        // On every core some images and the functions of one; of every prime three numbers per order.
        let cores = rayon::current_num_threads() as f64;
        f64::log2(6e6 + cores * 400.0 * order * order + 1.1 * order.powi(3))
    } else if alone && !logarithms {
        // Three series of N numbers of O(N) bits.
        f64::log2(6e6 + 16.0 * order * order)
    } else if alone {
        // 28 629 terms in 0.1 GiB at order 30; the number of partitions grows by 1.2 per order,
        // with formal sums by 1.5.
        30.0 + 0.1f64.log2() + if sums { (order - 14.0) * 0.6 } else { (order - 30.0) * 0.27 }
    } else if logarithms && settings.route != Route::Driver {
        by_clock(order, sums)
    } else if sums {
        30.0 + 0.1f64.log2() + (order - 10.0)
    } else if logarithms {
        30.0 + 0.7f64.log2() + (order - 20.0) * 1.5f64.log2()
    } else {
        // No expansion is known that takes as much as this: nothing need be derived to allow it.
        let most = 31.0 + 4.0 * (order / 164.0).log2();
        if refuse_above(settings.memory, settings.order, most.max(24.0)).is_ok() {
            return Ok(());
        }
        over_q(settings.order, bytes)
    };
    refuse_above(settings.memory, settings.order, bits)
}

/// Predictions are within a factor of two of the truth: what is predicted to need four times the limit needs more
/// than twice the limit.
const MARGIN: f64 = 4.0;

/// Refuses an order that is predicted to need 2^`bits` bytes, if that is certain to be more than twice `memory`. What
/// needs less begins; whoever counts memory while it grows stops it.
///
/// # Errors
/// [`Error::TooLarge`].
pub fn refuse_above(memory: u64, order: usize, bits: f64) -> Result<(), Error> {
    let limit = (memory.max(1) as f64).log2();
    if bits <= limit + MARGIN.log2() {
        return Ok(());
    }
    Err(Error::TooLarge { order, needed: bits, limit })
}
