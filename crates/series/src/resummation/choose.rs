//! One method or the best of all, with the rounding measured and kept below the rest.

use super::estimate::{Tentative, distance};
use super::made::Made;
use super::{Growth, Method, Outcome, ResummationError, Sample, Shared, Singularity, growth};
use lindstedt_algebra::Stop;
use rug::Float;
use std::sync::Arc;

/// What was found.
#[derive(Clone, Debug)]
pub struct Resummed {
    /// The method used.
    pub method: Method,
    /// Its value, the error estimate with the measured rounding, and what it used.
    pub outcome: Outcome,
    /// How the coefficients grow.
    pub growth: Growth,
    /// The nearest singularity, where one is stable.
    pub singularity: Option<Singularity>,
    /// Every method tried: its error estimate, or why it has none.
    pub tried: Vec<(Method, Result<Float, ResummationError>)>,
    /// The precision at which the value was computed.
    pub bits: u32,
}

/// What the least of several estimates is multiplied by.
const SELECTION: u32 = 4;
/// What the distance from an independent method is multiplied by.
const AGREEMENT: u32 = 4;
/// The same where they are compared at two orders.
const TWICE: u32 = 2;
/// Doublings of the precision before the rounding is added to the error as it is.
const DOUBLINGS: u32 = 4;

/// Sums a series by one method, or with `None` by the one whose error estimate is least (`auto`;
/// among estimates within a factor ten the simpler method is taken, unless it has hardly
/// two digits).
///
/// `source` gives coefficients and point at a precision. Everything is computed at p and 2p bits,
/// p doubled until the two values differ by less than an eighth of the error estimate or by less
/// than 2^-`accuracy` relative; the difference is added to the error.
///
/// `stop` is asked for every row of an elimination, every zero of a polynomial and every node of an integral; what was
/// computed with one of them broken off is thrown away.
///
/// # Errors
/// That of the method, or for `auto` that of the last method; [`ResummationError::NoCoefficients`]
/// where the source gives none; [`ResummationError::Stopped`].
///
/// ```
/// use lindstedt_series::resummation::{Method, Sample, resum};
/// use rug::Float;
/// // Euler's divergent series sum (-1)^n n! x^n at x = 1/10.
/// let source = |bits: u32| Some(Sample {
///     coefficients: (0..25u32)
///         .map(|n| Float::with_val(bits, Float::factorial(n)) * (-1i32).pow(n))
///         .collect(),
///     point: Float::with_val(bits, 1) / 10u32,
///     map: None,
///     radius: None,
///     bits,
/// });
/// let found = resum(&source, None, 100, &Default::default())?;
/// assert_eq!(found.method, Method::BorelPade);
/// // 10 e^10 E_1(10).
/// let error = (found.outcome.estimate.value - 0.915_633_339_397_880_8f64).abs();
/// assert!(error < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resum(
    source: &dyn Fn(u32) -> Option<Sample>,
    method: Option<Method>,
    accuracy: u32,
    stop: &Stop,
) -> Result<Resummed, ResummationError> {
    resum_with(source, method, accuracy, stop, &Shared::default())
}

/// As [`resum`] at one of many points: what does not depend on the point is made once.
///
/// # Errors
/// As [`resum`].
pub fn resum_with(
    source: &dyn Fn(u32) -> Option<Sample>,
    method: Option<Method>,
    accuracy: u32,
    stop: &Stop,
    shared: &Shared,
) -> Result<Resummed, ResummationError> {
    // Once it was yes the answer stays yes: nothing broken off passes this question.
    let found = chosen(source, method, (accuracy, stop), shared);
    if stop.asked() { Err(ResummationError::Stopped) } else { found }
}

fn chosen(
    source: &dyn Fn(u32) -> Option<Sample>,
    method: Option<Method>,
    (accuracy, stop): (u32, &Stop),
    shared: &Shared,
) -> Result<Resummed, ResummationError> {
    let sample = |bits: u32| source(bits).ok_or(ResummationError::NoCoefficients { bits });
    let with = |sample: Sample| {
        let made = shared.of(&sample, accuracy);
        (sample, made)
    };
    let first = sample(accuracy.saturating_add(128))?;
    // Pade approximants of order N lose a few bits per order.
    let loss = u32::try_from(first.coefficients.len()).unwrap_or(u32::MAX).saturating_mul(4);
    let bits = accuracy.saturating_add(64).saturating_add(loss);
    let low = if first.bits >= bits { first } else { sample(bits)? };
    let high = with(sample(low.bits.saturating_mul(2))?);
    let low = with(low);
    let growth = growth(&low.0.coefficients);
    let singularity = high.1.singularity(stop);
    let methods = method.map_or_else(|| Method::ALL.to_vec(), |method| vec![method]);
    let mut tried = Vec::new();
    let mut values: Vec<(Method, Outcome)> = Vec::new();
    let mut bits = Vec::new();
    for method in methods {
        if stop.asked() {
            return Err(ResummationError::Stopped);
        }
        let limits = (accuracy, stop);
        let sample = |bits| sample(bits).map(with);
        let found = settled(&sample, [&low, &high], method, singularity.as_ref(), limits);
        if let Ok((outcome, at)) = &found {
            values.push((method, outcome.clone()));
            bits.push(*at);
        }
        tried.push((method, found.map(|(outcome, _)| outcome.estimate.error)));
    }
    match low.0.selected(&values, accuracy, tried.len() > 1) {
        Some((index, outcome)) => {
            let (method, bits) = (values[index].0, bits[index]);
            Ok(Resummed { method, outcome, growth, singularity, tried, bits })
        }
        None => Err(tried.pop().and_then(|(_, r)| r.err()).unwrap_or(ResummationError::Undefined)),
    }
}

impl Sample {
    /// The best of the values of several methods: its index, and its outcome with the error that the
    /// others allow; `several` tells whether there was a choice.
    pub(super) fn selected(
        &self,
        values: &[(Method, Outcome)],
        accuracy: u32,
        several: bool,
    ) -> Option<(usize, Outcome)> {
        let mut best: Option<usize> = None;
        for (index, (_, outcome)) in values.iter().enumerate() {
            let error = &outcome.estimate.error;
            let better = best.is_none_or(|best| {
                // Below the accuracy asked for there is no better.
                let best = &values[best].1.estimate;
                let size = Float::with_val(53, best.value.abs_ref());
                let least = best.error.clone();
                let has_digits = Float::with_val(53, &least * (100 * SELECTION)) < size;
                let factor = if has_digits { 10u32 } else { 1u32 };
                least > size >> accuracy && Float::with_val(53, error * factor) < least
                    || error.is_finite() && !least.is_finite()
            });
            if better {
                best = Some(index);
            }
        }
        let (method, mut outcome) = values.get(best?).cloned()?;
        // The least of several estimates is more often too small than each. Where another
        // method with a comparable estimate disagrees by more than that estimate allows, the
        // excess is added.
        let own = outcome.estimate.clone();
        if several && !self.has_known_tail(method) {
            outcome.estimate.error *= SELECTION;
        }
        let others = values.iter().filter(|(m, _)| Self::are_independent(*m, method));
        let diverges = self.radius == Some(0.0);
        if let Some(agreed) = agreement(&outcome, others.map(|(_, other)| other), diverges) {
            outcome.estimate.error = outcome.estimate.error.min(&agreed);
        }
        for (_, other) in values {
            if other.estimate.error <= Float::with_val(53, &own.error * 100u32) {
                let gap = distance(&other.estimate.value, &own.value);
                let excess = gap - &other.estimate.error;
                if excess > own.error {
                    let sum = Float::with_val(53, &own.error + excess);
                    outcome.estimate.error = outcome.estimate.error.max(&sum);
                }
            }
        }
        Some((best?, outcome))
    }
}

/// Two sequences that share no approximants agree to the error of the worse one: where they do, the less cautious estimate of
/// the better one counts. Of a series that diverges everywhere, whose approximants converge less evenly, it counts for less where they
/// agree at two orders one after the other: that they meet by chance at both is rare, and the larger distance, the earlier
/// one less by what the error falls, is the error of the worse. (Of 2519 sums of random functions with a radius 2 would be
/// further off than that, by a quarter.) And where the other method agrees within its own estimate, twice the largest distance
/// from four neighbours in the table of approximants is enough: of 1170 sums of the pendulum's series, to twelve orders from 8 to 24, one
/// was further off than that, by an eighth.
fn agreement<'a>(
    own: &Outcome,
    others: impl Iterator<Item = &'a Outcome>,
    diverges: bool,
) -> Option<Float> {
    let tentative = own.tentative.as_ref().filter(|tentative| tentative.error.is_finite())?;
    let gap = |other: &Outcome| distance(&other.estimate.value, &own.estimate.value);
    let nearest = others.min_by(|a, b| gap(a).total_cmp(&gap(b)))?;
    let once = gap(nearest).max(&tentative.error) * AGREEMENT;
    let Some(other) = nearest.tentative.as_ref().filter(|_| diverges) else { return Some(once) };
    let earlier = distance(&other.before, &tentative.before) * tentative.ratio;
    let twice = once.min(&(gap(nearest).max(&earlier) * TWICE));
    let agrees = gap(nearest) <= nearest.estimate.error;
    Some(match tentative.beside.as_ref().filter(|_| agrees) {
        Some(beside) => twice.min(&Float::with_val(53, beside * TWICE)),
        None => twice,
    })
}

/// A sample with what was made of its series.
type With = (Sample, Arc<Made>);

/// One method at p and 2p bits, until the rounding does not matter.
fn settled(
    sample: &dyn Fn(u32) -> Result<With, ResummationError>,
    first: [&With; 2],
    method: Method,
    singularity: Option<&Singularity>,
    (accuracy, stop): (u32, &Stop),
) -> Result<(Outcome, u32), ResummationError> {
    let [low, high] = first;
    let sum = |(sample, made): &With| sample.sum_made(made, (method, singularity), accuracy, stop);
    let mut before = sum(low)?;
    let mut bits = high.0.bits;
    let mut after = sum(high)?;
    for _ in 0..DOUBLINGS {
        let rounding = distance(&before.estimate.value, &after.estimate.value);
        let size = Float::with_val(53, after.estimate.value.abs_ref()) >> accuracy;
        if rounding.clone() * 8u32 <= after.estimate.error || rounding <= size {
            break;
        }
        bits = bits.saturating_mul(2);
        before = after;
        after = sum(&sample(bits)?)?;
    }
    let rounding = distance(&before.estimate.value, &after.estimate.value);
    // An error of exactly 0 is a rational function, known to the rounding.
    let size = Float::with_val(53, after.estimate.value.abs_ref()) >> (bits / 4);
    let asked = Float::with_val(53, after.estimate.value.abs_ref()) >> accuracy;
    let rounding = rounding.max(&size.min(&asked));
    after.estimate.error += &rounding;
    after.tentative = after.tentative.map(|t| Tentative {
        error: t.error + &rounding,
        beside: t.beside.map(|beside| beside + &rounding),
        ..t
    });
    Ok((after, bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    type Series = (&'static str, fn(u32, u32) -> Float, fn(&Float) -> Float);

    fn binomial(p: (i32, u32), n: u32, bits: u32) -> Float {
        let p = rug::Rational::from(p);
        let mut value = rug::Rational::from(1);
        for k in 0..n {
            value *= (p.clone() - k) / (k + 1);
        }
        Float::with_val(bits, value)
    }

    fn series() -> Vec<Series> {
        vec![
            ("sqrt", |n, bits| binomial((1, 2), n, bits), |x| (x.clone() + 1u32).sqrt()),
            (
                "log",
                |n, bits| {
                    if n == 0 {
                        Float::with_val(bits, 1)
                    } else {
                        Float::with_val(bits, if n % 2 == 1 { 1 } else { -1 }) / n
                    }
                },
                |x| Float::with_val(x.prec(), x.ln_1p_ref()) + 1u32,
            ),
            (
                "exp",
                |n, bits| Float::with_val(bits, Float::factorial(n)).recip(),
                |x| x.clone().exp(),
            ),
            (
                "geometric",
                |n, bits| Float::with_val(bits, if n % 2 == 0 { 1 } else { -1 }),
                |x| (x.clone() + 1u32).recip(),
            ),
            (
                "atan",
                |n, bits| match n {
                    0 => Float::with_val(bits, 2),
                    _ if n % 2 == 0 => Float::new(bits),
                    _ => Float::with_val(bits, if n % 4 == 1 { 1 } else { -1 }) / n,
                },
                |x| Float::with_val(x.prec(), x.atan_ref()) + 2u32,
            ),
            // Gamma(0, 1/x) e^(1/x)/x.
            (
                "Euler",
                |n, bits| Float::with_val(bits, Float::factorial(n)) * (-1i32).pow(n),
                |x| {
                    let inverse = Float::with_val(x.prec(), x.recip_ref());
                    let zero = Float::new(x.prec());
                    zero.gamma_inc(&inverse) * inverse.clone().exp() * inverse
                },
            ),
        ]
    }

    /// Every method at every order and point, refused or with a true error below its estimate.
    #[test]
    fn no_estimate_is_below_the_true_error() {
        let (mut checked, mut sharp) = (0, 0);
        for (name, c, f) in series() {
            for order in [3u32, 6, 14] {
                for x in [1e-3, 0.3, 1.0, 1.7, 6.0, 40.0] {
                    let source = |bits: u32| {
                        Some(Sample {
                            coefficients: (0..=order).map(|n| c(n, bits)).collect(),
                            point: Float::with_val(bits, x),
                            map: None,
                            radius: None,
                            bits,
                        })
                    };
                    let exact = f(&Float::with_val(600, x));
                    for method in [
                        None,
                        Some(Method::PartialSum),
                        Some(Method::Pade),
                        Some(Method::ConformalPade),
                        Some(Method::BorelPade),
                    ] {
                        let Ok(found) = resum(&source, method, 80, &Stop::default()) else {
                            continue;
                        };
                        let estimate = &found.outcome.estimate;
                        let error = distance(&estimate.value, &exact);
                        assert!(
                            error <= estimate.error,
                            "{name} order {order} x {x} {method:?} -> {:?}: {error} > {}",
                            found.method,
                            estimate.error
                        );
                        checked += 1;
                        sharp += u32::from(estimate.error < 1e-6);
                    }
                }
            }
        }
        assert!(checked > 225 && sharp > 75, "{checked} {sharp}");
    }
}
