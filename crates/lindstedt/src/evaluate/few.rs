//! Sums of so few terms that nothing can be said about their error.

use crate::constants::{Number, Status};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::digits::{decimal, error_string};
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

/// The partial sum, its error unknown except at 0, of a series too short for [`Sample::sum`]; nothing for a
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

/// The digits of a number whose error nothing is known of: more would look as if they were.
const SHOWN: usize = 4;
/// Digits beyond those that a measured error leaves.
const BEYOND: usize = 2;

/// The midpoint without regard to what is proved of it. How far it is from the truth is the radius
/// where it was measured; else nothing is known, and four digits are shown.
pub(super) fn plain(ball: &Ball, digits: usize, is_measured: bool) -> Option<Number> {
    let balls = Balls::new(ball.midpoint().prec());
    let middle = balls.from_parts(ball.midpoint(), &Float::new(53));
    if !is_measured {
        let decimal = decimal(&middle, digits.min(SHOWN))?;
        return Some(Number { exact: None, decimal, error: None, status: Status::NoEstimate });
    }
    let known = ball.relative_accuracy_bits().clamp(0, 400_000) * 301 / 1000;
    let most = usize::try_from(known).map_or(digits, |known| known + BEYOND).max(SHOWN);
    let decimal = decimal(&middle, digits.min(most))?;
    let error = Some(error_string(ball, &decimal));
    Some(Number { exact: None, decimal, error, status: Status::Estimated })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

    use super::*;

    /// pi with nothing known of its error, and with one of 1e-3.
    #[test]
    fn digits_shown() {
        let balls = Balls::new(200);
        let pi = balls.pi();
        let unknown = plain(&pi, 30, false).unwrap();
        assert_eq!((&*unknown.decimal, unknown.status), ("3.142", Status::NoEstimate));
        assert_eq!(plain(&pi, 1, false).unwrap().decimal, "3");
        let measured = plain(&balls.add_error(&pi, &Float::with_val(53, 1e-3)), 30, true).unwrap();
        assert_eq!((&*measured.decimal, measured.status), ("3.1416", Status::Estimated));
        assert!(measured.error.unwrap().parse::<f64>().unwrap() >= 1e-3);
    }
}
