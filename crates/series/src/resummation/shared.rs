//! What the sums of one series at many points have in common, made once: the nearest singularity, the series in its
//! variables, the approximants, the nodes of an integral. A sum is the same with it as without.

use super::made::Made;
use super::{Picture, Sample};
use lindstedt_algebra::Stop;
use std::sync::{Arc, Mutex, PoisonError};

/// At most so many series, each at one precision, are kept.
const KEPT: usize = 16;

/// What was made of the series that were summed with it, the last few of them.
///
/// ```
/// use lindstedt_series::resummation::{Sample, Shared, resum, resum_with};
/// use rug::Float;
/// // ln(1 + x)/x at two points.
/// let sample = |x: f64| move |bits: u32| Some(Sample {
///     coefficients: (1..25i32).map(|n| Float::with_val(bits, (-1i32).pow(n as u32 - 1)) / n).collect(),
///     point: Float::with_val(bits, x),
///     map: None,
///     radius: None,
///     bits,
/// });
/// let shared = Shared::default();
/// for x in [0.5, 1.5] {
///     let found = resum_with(&sample(x), None, 100, &Default::default(), &shared)?;
///     let alone = resum(&sample(x), None, 100, &Default::default())?;
///     assert_eq!(found.outcome.estimate.value, alone.outcome.estimate.value);
/// }
/// # Ok::<(), lindstedt_series::resummation::ResummationError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Shared(Arc<Mutex<Vec<Arc<Made>>>>);

impl Shared {
    /// What was made of the series of a sample.
    pub(super) fn of(&self, sample: &Sample, accuracy: u32) -> Arc<Made> {
        let mut list = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = list.iter().find(|made| made.is_of(sample, accuracy)) {
            return Arc::clone(known);
        }
        let made = Arc::new(Made::new(sample, accuracy));
        if list.len() == KEPT {
            list.remove(0);
        }
        list.push(Arc::clone(&made));
        made
    }

    /// Poles and zeros of the diagonal approximant of a sample that was summed to so many bits; nothing once `stop` said so.
    #[must_use]
    pub fn picture(&self, sample: &Sample, accuracy: u32, stop: &Stop) -> Option<Picture> {
        self.of(sample, accuracy).picture(stop)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Method, UniformMap, resum, resum_with};
    use super::*;
    use rug::{Float, Rational};

    /// (1 + x)^(1/2) and sum n! (-x)^n, to order 20.
    fn series(which: usize, x: f64) -> impl Fn(u32) -> Option<Sample> {
        move |bits| {
            let mut c = vec![Rational::from(1)];
            for n in 0..20i64 {
                let next = [Rational::from((1 - 2 * n, 2 * n + 2)), Rational::from(-n - 1)];
                c.push(next[which].clone() * &c[c.len() - 1]);
            }
            let [scale, prefactor] = [1.0, 0.5].map(|x| Float::with_val(bits, x));
            let known = UniformMap { scale, prefactor, radius: None };
            Some(Sample {
                coefficients: c.iter().map(|q| Float::with_val(bits, q)).collect(),
                point: Float::with_val(bits, x),
                map: (which == 0).then_some(known),
                radius: None,
                bits,
            })
        }
    }

    /// Two series in turn, at many points, by every method: value and error are bit by bit those of a sum that shares nothing,
    /// and what is made is made once for each series and precision.
    #[test]
    fn sums_that_share_are_those_that_do_not() {
        let stop = Stop::default();
        for method in Method::ALL.map(Some).into_iter().chain([None]) {
            let shared = Shared::default();
            for x in [-0.4, 0.1, 0.75, 3.0] {
                for which in [0, 1] {
                    let source = series(which, x);
                    let alone = resum(&source, method, 100, &stop);
                    let found = resum_with(&source, method, 100, &stop, &shared);
                    let [alone, found] = [alone, found].map(|found| {
                        let it = found.ok()?;
                        let sum = it.outcome.estimate;
                        Some((it.method, sum.value, sum.error, it.bits))
                    });
                    assert_eq!(alone, found, "{method:?} {which} at {x}");
                }
            }
            // Two series at p, 2p, ... bits.
            let made = shared.0.lock().unwrap().len();
            assert!(made <= 10, "{method:?}: {made}");
        }
    }
}
