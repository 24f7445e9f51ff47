//! Error estimates from the agreement of neighbouring approximants.

use rug::Float;
use rug::float::Special;
use rug::ops::Pow;

/// The least number of an approximant whose error is estimated.
const FEWEST: usize = 6;

/// A value with an estimated error.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The value.
    pub value: Float,
    /// The estimated bound of |value - true value| (53 bits), at least the last disagreement;
    /// infinite where nothing can be said.
    pub error: Float,
}

/// |a - b| in 53 bits.
pub(super) fn distance(a: &Float, b: &Float) -> Float {
    Float::with_val(53, a - b).abs()
}

/// The largest distance of `list` from `value`.
fn spread(list: &[Float], value: &Float) -> Option<Float> {
    list.iter().map(|v| distance(v, value)).reduce(|a, b| a.max(&b))
}

/// The last of a sequence of approximants, with an estimate of its error.
///
/// For errors e q^k the spread s1 of the `window` values before the last one and the spread s2
/// of the `window` before these satisfy s2/s1 - 1 = q^-window, so that |error| = s1/(s2/s1 - 2);
/// the estimate is that, but at least s1, and at most s1 times the number of the last approximant:
/// then the sequence converges slower than a geometric one, and for an error k^-p
/// the remainder is about s1 k/(p window). Four times the result, for luck in the differences.
///
/// Infinite where s2 < s1 (the sequence runs away) and for approximants below number six.
/// Nothing for fewer than two values.
///
/// What fools it: errors that oscillate with a period of more than some four windows and hardly
/// decrease, as at the edge of a disc with a singularity at a small angle to the point.
pub(super) fn settle(values: &[Float], window: usize, number: usize) -> Option<Estimate> {
    let (value, before) = values.split_last()?;
    if before.is_empty() || !value.is_finite() {
        return None;
    }
    let near = before.len().saturating_sub(window);
    let far = near.saturating_sub(window);
    let first = spread(before.get(near..)?, value)?;
    let worst = (number.max(4) as f64).max(1.0);
    let factor = match spread(before.get(far..near)?, value) {
        Some(second) if !first.is_zero() => {
            let ratio = Float::with_val(53, second / &first).to_f64();
            if ratio < 1.0 {
                f64::INFINITY
            } else {
                let factor = 1.0 / (ratio - 2.0).max(1.0 / worst);
                factor.max(1.0)
            }
        }
        Some(_) => 1.0,
        None => worst,
    };
    let factor = if number < FEWEST { f64::INFINITY } else { factor };
    let error = if first.is_zero() && factor.is_finite() {
        first
    } else {
        Float::with_val(53, first * (4.0 * factor))
    };
    let error = if error.is_nan() { Float::with_val(53, Special::Infinity) } else { error };
    Some(Estimate { value: value.clone(), error })
}

/// The last of a sequence of approximants; the error is four times the largest distance from it
/// in the sequence. For methods that converge slower than a geometric sequence, as Borel's with
/// Pade approximants of a transform with singularities near the path, and where [`settle`]'s
/// ratio of two windows would mean nothing.
pub(super) fn widest(values: &[Float], number: usize) -> Option<Estimate> {
    let (value, before) = values.split_last()?;
    let mut estimate = settle(values, before.len().div_ceil(2).clamp(1, 4), number)?;
    estimate.error = estimate.error.max(&(spread(before, value)? * 4u32));
    Some(estimate)
}

/// What may be missing from the last of the partial sums at |x| = `ratio` times the radius of
/// convergence (0 for an unknown one), if the terms go on as they began: below A q^n they leave
///
///   sum_{n > N} A q^n = A q^(N+1)/(1 - q).
///
/// q is the larger of `ratio` and the one between the largest terms of the middle and the last
/// third; A comes from the last third. Twice the result; infinite for q >= 1.
/// Where the radius is not known, N terms do not tell q from 1 - 1/N: 1/(1 - q) is at least N.
pub(super) fn geometric_tail(sums: &[Float], ratio: &Float, known: bool) -> Float {
    let terms: Vec<Float> = sums.windows(2).map(|pair| distance(&pair[1], &pair[0])).collect();
    let last = terms.len();
    let (early, late) = (last / 3, last * 2 / 3);
    let largest = |from: usize, to: usize| {
        let list = terms.iter().take(to).skip(from);
        list.fold(Float::new(53), |a, b| a.max(b))
    };
    let (before, after) = (largest(early, late), largest(late, last));
    let mut ratio = Float::with_val(53, ratio);
    if !before.is_zero() {
        let steps = (late - early).max(1) as f64;
        ratio = ratio.max(&(after / before).pow(1.0 / steps));
    }
    let mut rest = Float::with_val(53, 1 - &ratio);
    if !known {
        rest = rest.min(&Float::with_val(53, 1.0 / last.max(1) as f64));
    }
    if rest <= 0 || !rest.is_finite() {
        return Float::with_val(53, Special::Infinity);
    }
    let scaled = terms.iter().enumerate().skip(late).map(|(i, term)| {
        let left = u32::try_from(last - i).unwrap_or(u32::MAX);
        Float::with_val(53, (&ratio).pow(left)) * term
    });
    scaled.fold(Float::new(53), |a, b| a.max(&b)) * 2u32 / rest
}

/// The partial sum up to the smallest term, and its order: what is best for a divergent series.
/// The error estimate is the largest of the smallest term and its two neighbours.
pub(super) fn best_truncation(sums: &[Float]) -> Option<(usize, Estimate)> {
    let terms: Vec<Float> = sums.windows(2).map(|pair| distance(&pair[1], &pair[0])).collect();
    let smallest = (0..terms.len()).min_by(|&i, &j| terms[i].total_cmp(&terms[j]))?;
    let around = terms.get(smallest.saturating_sub(1)..(smallest + 2).min(terms.len()))?;
    let error = around.iter().cloned().reduce(|a, b| a.max(&b))?;
    let value = sums.get(smallest + 1)?.clone();
    Some((smallest + 1, Estimate { value, error }))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

    use super::*;

    /// The remainder of sum q^n cos(n phi) n^p at random q next to one, for slow oscillations too.
    #[test]
    fn tails_are_above_the_remainder() {
        for q in [0.3f64, 0.9, 0.99, 0.9995] {
            for phi in [0.0f64, 0.05, 0.4, 1.0, 3.1] {
                for p in [-3.0f64, -1.5, -0.5, 0.0] {
                    let term =
                        |n: i32| q.powi(n) * (f64::from(n) * phi).cos() * f64::from(n).powf(p);
                    for number in [8, 15, 30] {
                        let mut sum = Float::new(200);
                        let mut sums = vec![sum.clone()];
                        for n in 1..=number {
                            sum += term(n);
                            sums.push(sum.clone());
                        }
                        let found = geometric_tail(&sums, &Float::with_val(53, q), true);
                        let rest: f64 = (number + 1..80_000).map(term).sum();
                        assert!(found >= rest.abs(), "{q} {phi} {p} {number}: {found} {rest}");
                    }
                }
            }
        }
    }

    /// Errors q^k cos(k phi + psi), k^-p and 1/k!: the estimate holds for all of them.
    #[test]
    fn estimates_are_above_the_errors() {
        type Model = Box<dyn Fn(f64) -> f64>;
        let mut models: Vec<Model> = Vec::new();
        for q in [0.01f64, 0.3, 0.6, 0.9, 0.97] {
            for phi in
                [0.0f64, 0.4, 1.0, 1.57, 2.2, 3.1].into_iter().filter(|p| q < 0.9 || *p != 0.4)
            {
                models.push(Box::new(move |k| q.powf(k) * (k * phi + 0.3).cos()));
            }
        }
        for p in [1.0f64, 1.5, 3.0, 6.0] {
            models.push(Box::new(move |k| k.powf(-p)));
        }
        models.push(Box::new(|k| (1..=k as u32).map(|i| 1.0 / f64::from(i)).product()));
        let mut checked = 0;
        for model in &models {
            for number in 8..60usize {
                for window in [3usize, 4] {
                    let list: Vec<Float> = (number.saturating_sub(12).max(1)..=number)
                        .map(|k| Float::with_val(200, 1.0) + model(k as f64))
                        .collect();
                    let found = settle(&list, window, number).unwrap();
                    let error = model(number as f64).abs();
                    // Not below the rounding, which the caller measures, and not before anything
                    // has converged.
                    if !(1e-55..0.1).contains(&error) {
                        continue;
                    }
                    assert!(found.error >= error, "{number} {window}: {} < {error}", found.error);
                    checked += 1;
                }
            }
        }
        assert!(checked > 2000, "{checked}");
    }
}
