//! Partial sums.

use super::estimate::{best_truncation, geometric_tail, settle, sizes};
use super::staircase::APPROXIMANTS;
use super::{Estimate, Growth, Outcome, ResummationError, Sample, growth, partial_sums};
use rug::Float;
use rug::float::Special;

/// The partial sum; of a series that diverges up to its smallest term.
pub(super) fn partial_sum(sample: &Sample) -> Result<Outcome, ResummationError> {
    let sums = partial_sums(&sample.coefficients, &sample.point, sample.bits);
    let radius = disc(&sample.coefficients, sample.radius);
    let outside = radius.is_some_and(|radius| sample.point.clone().abs() >= radius);
    if !outside {
        let known = sample.radius.is_some();
        return convergent(&sample.coefficients, &sample.point, (radius, known), sample.bits);
    }
    let asymptotic = radius == Some(0.0);
    // The smallest term among the last ones is no smallest term yet.
    let inside = |order: usize| {
        if asymptotic { order + 2 < sums.len() } else { 3 * order < 2 * sums.len() }
    };
    let terms = sizes(&sample.coefficients, &sample.point);
    let best = best_truncation(&sums, &terms).filter(|(order, _)| inside(*order));
    // Terms that do not grow well beyond the smallest ones are no divergence yet.
    let late = terms.into_iter().skip(sums.len() * 2 / 3).reduce(|a, b| a.max(&b));
    let grows = |estimate: &Estimate| {
        late.as_ref().is_some_and(|late| *late > Float::with_val(53, &estimate.error * 4u32))
    };
    let mut outcome = match best {
        Some((order, estimate)) if grows(&estimate) => {
            let smallest_term = Some(order);
            Outcome { estimate, order, degrees: None, tentative: None, smallest_term }
        }
        _ => last_sum(&sums)?,
    };
    if sample.radius != Some(0.0) {
        // Outside a disc of convergence nothing bounds the error by the terms, and a finite
        // number of coefficients does not prove that a series is asymptotic.
        outcome.estimate.error = Float::with_val(53, Special::Infinity);
    } else if outcome.smallest_term.is_some() {
        // An asymptotic series has its error below the smallest term or near it.
        outcome.estimate.error *= 3u32;
    }
    Ok(outcome)
}

/// The radius of convergence as far as it may be relied on; zero for a series that diverges
/// everywhere, nothing for an entire function or too few coefficients.
///
/// N coefficients n^p R^-n with p not known to better than 2 give R to a factor 1 - 2/N.
pub(super) fn disc(c: &[Float], known: Option<f64>) -> Option<f64> {
    known.or(match growth(c) {
        Growth::Radius { radius, .. } => Some(radius * (1.0 - 2.0 / c.len().max(3) as f64)),
        Growth::Factorial { .. } => Some(0.0),
        _ => None,
    })
}

/// The last partial sum, judged by those before it alone.
fn last_sum(sums: &[Float]) -> Result<Outcome, ResummationError> {
    let order = sums.len() - 1;
    let late = sums.get(order.saturating_sub(APPROXIMANTS)..).unwrap_or(sums);
    let estimate = settle(late, order).ok_or(ResummationError::Undefined)?;
    Ok(Outcome { estimate, order, degrees: None, tentative: None, smallest_term: None })
}

/// The last partial sum of a series that converges, |x| below the radius (and whether that is
/// known, not estimated).
pub(super) fn convergent(
    c: &[Float],
    x: &Float,
    (radius, known): (Option<f64>, bool),
    bits: u32,
) -> Result<Outcome, ResummationError> {
    let sums = partial_sums(c, x, bits);
    let mut outcome = last_sum(&sums)?;
    let ratio = radius.map_or_else(|| Float::new(53), |r| Float::with_val(53, x.abs_ref()) / r);
    outcome.estimate.error = geometric_tail(&sizes(c, x), &ratio, known);
    Ok(outcome)
}
