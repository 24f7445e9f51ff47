//! Sums of so few terms that nothing can be said about their error.

use lindstedt_number::Number;
use lindstedt_number::ball::Ball;
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
pub(crate) fn has_no_estimate(known: usize) -> bool {
    known < FEWEST_FOR_AN_ESTIMATE
}

/// Whether no method but the partial sum gives a value.
pub(crate) fn is_few(known: usize) -> bool {
    known < FEWEST
}

/// The partial sum, its error unknown except at 0, of a series too short for [`Sample::sum`]; nothing for a
/// longer one and for a method that needs more.
pub(crate) fn partial_sum(
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
        let value = partial_sums(&sample.coefficients, &sample.point, bits).pop()?;
        let unknown = if sample.point.is_zero() { Special::Zero } else { Special::Infinity };
        Some(Estimate { value, error: Float::with_val(53, unknown) })
    };
    let Some(estimate) = sum() else { return Some(Err(ResummationError::NoCoefficients { bits })) };
    let order = known - 1;
    let outcome = Outcome { estimate, order, degrees: None, tentative: None, smallest_term: None };
    let method = Method::PartialSum;
    let tried = vec![(method, Ok(outcome.estimate.error.clone()))];
    let (growth, singularity) = (Growth::Undecided, None);
    Some(Ok(Resummed { method, outcome, growth, singularity, tried, bits }))
}

/// The midpoint without regard to what is proved of it. How far it is from the truth is the radius
/// where it was measured; else nothing is known, and four digits are shown.
pub fn plain(ball: &Ball, digits: usize, is_measured: bool) -> Option<Number> {
    let shown = if is_measured { Number::measured } else { Number::without_estimate };
    shown(ball, digits)
}
