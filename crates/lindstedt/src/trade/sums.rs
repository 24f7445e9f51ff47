//! The series of a run summed: as it stands, and by the method whose error estimate is least.

use super::{Reason, Summation};
use crate::Error;
use crate::evaluate::source::{Coefficients, Source};
use lindstedt_algebra::Stop;
use lindstedt_number::ball::Balls;
use lindstedt_series::resummation::{
    Estimate, Method, ResummationError, Sample, Singularity, partial_sums, resum_until,
};
use rug::Float;
use rug::float::Special;
use std::time::Instant;

/// The coefficients of T/2pi that a run found, in the variable of the source.
pub(super) struct Series {
    /// Their values at any precision; those of a numeric tier with zeros behind its last bit.
    pub(super) values: Coefficients,
    /// Their absolute errors, where they are not those of rounding.
    pub(super) errors: Option<Vec<Float>>,
    /// Bits of the result.
    pub(super) accuracy: u32,
}

/// A sum.
pub(super) struct Sum {
    pub(super) summation: Summation,
    pub(super) period: Float,
    /// The stated absolute error; infinite where there is no estimate.
    pub(super) error: Float,
    /// The time for the first value, in which the method is chosen, and for one more.
    pub(super) seconds: f64,
    pub(super) again: f64,
}

/// Sums that take less are timed again, and the least time counts.
const SHORT: f64 = 0.01;

fn failed(reason: ResummationError) -> Reason {
    let problem = String::new();
    Reason::Refused(Error::Resummation { problem, reason })
}

impl Series {
    fn sample(&self, source: &Source, bits: u32) -> Option<Sample> {
        source.sample_of((self.values)(bits)?, bits)
    }

    /// The partial sum, and the value by the method that `auto` chooses where it is another one
    /// and has an error estimate.
    pub(super) fn sums(
        &self,
        source: &Source,
        repeats: u32,
        stop: &Stop,
    ) -> Result<Vec<Sum>, Reason> {
        let mut list = vec![timed(repeats, || self.partial_sum(source))?];
        list.extend(timed(repeats, || self.resummed(source, stop)).ok());
        Ok(list)
    }

    fn partial_sum(&self, source: &Source) -> Result<Sum, Reason> {
        let start = Instant::now();
        let bits = self.accuracy + 64;
        let none = || failed(ResummationError::NoCoefficients { bits });
        let sample = self.sample(source, bits).ok_or_else(none)?;
        let found = sample.sum(Method::PartialSum, None, self.accuracy);
        let estimate = match found {
            Ok(outcome) => outcome.estimate,
            Err(ResummationError::TooFewCoefficients { .. }) => {
                let sums = partial_sums(&sample.coefficients, &sample.point, bits);
                let value = sums.last().cloned().ok_or_else(none)?;
                Estimate { value, error: Float::with_val(53, Special::Infinity) }
            }
            Err(reason) => return Err(failed(reason)),
        };
        let noise = self.noise(&sample, Method::PartialSum, None, &estimate.value);
        let (period, error) = self.period(source, &estimate, noise)?;
        let seconds = start.elapsed().as_secs_f64();
        let summation = Summation::PartialSum;
        Ok(Sum { summation, period, error, seconds, again: seconds })
    }

    fn resummed(&self, source: &Source, stop: &Stop) -> Result<Sum, Reason> {
        let start = Instant::now();
        let found = resum_until(&|bits| self.sample(source, bits), None, self.accuracy, stop);
        let found = found.map_err(failed)?;
        let estimate = &found.outcome.estimate;
        if found.method == Method::PartialSum || !estimate.error.is_finite() {
            return Err(failed(ResummationError::Undefined));
        }
        let none = || failed(ResummationError::NoCoefficients { bits: found.bits });
        let sample = self.sample(source, found.bits).ok_or_else(none)?;
        let singularity = found.singularity.as_ref();
        let noise = self.noise(&sample, found.method, singularity, &estimate.value);
        let (period, error) = self.period(source, estimate, noise)?;
        let seconds = start.elapsed().as_secs_f64();
        let start = Instant::now();
        sample.sum(found.method, singularity, self.accuracy).map_err(failed)?;
        let again = start.elapsed().as_secs_f64().min(seconds);
        let summation = Summation::Resummed(found.method);
        Ok(Sum { summation, period, error, seconds, again })
    }

    /// What the errors e_n of the coefficients make of the value: the sum of its changes by
    /// +e_n, by (-1)^n e_n, and by signs in pairs. Of a partial sum the first is the bound
    /// sum e_n x^n for x > 0, the second for x < 0; other methods are not linear in them.
    fn noise(
        &self,
        sample: &Sample,
        method: Method,
        singularity: Option<&Singularity>,
        value: &Float,
    ) -> Float {
        let Some(errors) = &self.errors else { return Float::new(53) };
        let signs: [fn(usize) -> bool; 3] = [|_| false, |n| n % 2 == 1, |n| n % 4 > 1];
        let mut noise = Float::new(53);
        for negative in signs {
            let mut changed = sample.clone();
            for ((n, c), e) in changed.coefficients.iter_mut().enumerate().zip(errors) {
                if negative(n) {
                    *c -= e;
                } else {
                    *c += e;
                }
            }
            let other = match changed.sum(method, singularity, self.accuracy) {
                Ok(outcome) => outcome.estimate.value,
                Err(ResummationError::TooFewCoefficients { .. }) => {
                    let sums = partial_sums(&changed.coefficients, &changed.point, changed.bits);
                    sums.last().cloned().unwrap_or_else(|| Float::new(53))
                }
                Err(_) => Float::with_val(53, Special::Infinity),
            };
            noise += Float::with_val(53, &other - value).abs();
        }
        noise
    }

    /// 2 pi times the factor of the source.
    fn period(
        &self,
        source: &Source,
        estimate: &Estimate,
        noise: Float,
    ) -> Result<(Float, Float), Reason> {
        let balls = Balls::new(self.accuracy + 64);
        let factor = (source.factor)(balls).ok_or(Reason::Refused(Error::NoValue))?;
        let scale = balls.mul(&balls.mul_i64(&balls.pi(), 2), &factor);
        let period = Float::with_val(self.accuracy + 64, &estimate.value * scale.midpoint());
        let period = Float::with_val(self.accuracy, period);
        let rounding = Float::with_val(53, period.abs_ref()) >> (self.accuracy - 2);
        let error = (noise + &estimate.error) * scale.abs_upper() + rounding;
        Ok((period, error))
    }
}

/// The sum with the least times of some runs.
fn timed(repeats: u32, run: impl Fn() -> Result<Sum, Reason>) -> Result<Sum, Reason> {
    let mut best = run()?;
    for _ in 1..repeats {
        if best.seconds > SHORT {
            break;
        }
        let next = run()?;
        best.seconds = best.seconds.min(next.seconds);
        best.again = best.again.min(next.again);
    }
    Ok(best)
}
