//! Sums of so few terms that nothing can be said about their error.

use crate::number::{Number, Status};
use lindstedt_coeff::ball::{Ball, Balls};
use lindstedt_coeff::digits::{decimal, error_string};
use lindstedt_series::resummation::{
    Estimate, Growth, Method, Outcome, ResummationError, Resummed, Sample, partial_sums,
};
use rug::Float;
use rug::float::Special;

/// The resummation methods want so many coefficients for a value,
const FEWEST: usize = 3;
/// and so many for an estimate of its error.
const FEWEST_FOR_AN_ESTIMATE: usize = 7;

/// Whether a missing estimate is the fault of the number of coefficients.
pub(super) fn has_no_estimate(known: usize) -> bool {
    known < FEWEST_FOR_AN_ESTIMATE
}

/// Whether no method but the partial sum gives a value.
pub(super) fn is_few(known: usize) -> bool {
    known < FEWEST
}

/// The partial sum, its error unknown, of a series too short for [`Sample::sum`]; nothing for a
/// longer one and for a method that needs more.
pub(super) fn partial_sum(
    sample: &dyn Fn(u32) -> Option<Sample>,
    known: usize,
    method: Option<Method>,
    accuracy: u32,
) -> Option<Result<Resummed, ResummationError>> {
    if known >= FEWEST || !matches!(method, None | Some(Method::PartialSum)) {
        return None;
    }
    let bits = accuracy.saturating_add(64);
    let sum = || {
        let sample = sample(bits)?;
        partial_sums(&sample.coefficients, &sample.point, bits).pop()
    };
    let Some(value) = sum() else { return Some(Err(ResummationError::NoCoefficients { bits })) };
    let infinite = Float::with_val(53, Special::Infinity);
    let estimate = Estimate { value, error: infinite.clone() };
    let outcome = Outcome { estimate, order: known - 1, degrees: None, smallest_term: None };
    let method = Method::PartialSum;
    let tried = vec![(method, Ok(infinite))];
    let (growth, singularity) = (Growth::Undecided, None);
    Some(Ok(Resummed { method, outcome, growth, singularity, tried, bits }))
}

/// The midpoint with all digits asked for: what was computed is known. How far it is from the truth
/// is the radius where it was measured; else nothing.
pub(super) fn plain(ball: &Ball, digits: usize, is_measured: bool) -> Option<Number> {
    let balls = Balls::new(ball.midpoint().prec());
    let middle = balls.from_parts(ball.midpoint(), &Float::new(53));
    let decimal = decimal(&middle, digits)?;
    let error = is_measured.then(|| error_string(ball, &decimal));
    Some(Number { exact: None, decimal, error, status: Status::Estimated })
}
