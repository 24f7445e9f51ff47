//! The series of a run summed: as it stands, and by the method whose error estimate is least.

use super::found::{Found, fastest};
use crate::evaluate::source::{Coefficients, Source};
use crate::{Error, EvaluationError};
use lindstedt_algebra::Stop;
use lindstedt_number::ball::Balls;
use lindstedt_series::resummation::{
    Estimate, Method, ResummationError, Sample, Singularity, partial_sums, resum,
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

/// Sums that take less are timed again, and the least time counts.
const SHORT: f64 = 0.01;

fn failed(reason: ResummationError) -> Error {
    EvaluationError::Resummation { problem: String::new(), reason }.into()
}

impl Series {
    fn sample(&self, source: &Source, bits: u32) -> Option<Sample> {
        source.sample_of((self.values)(bits)?, bits)
    }

    /// The partial sum, and the value by the method that `auto` chooses where it is another one
    /// and has an error estimate. Their times are those of the sums alone.
    pub(super) fn sums(
        &self,
        source: &Source,
        repeats: u32,
        stop: &Stop,
    ) -> Result<Vec<Found>, Error> {
        let timed = |run: &dyn Fn() -> Result<Found, Error>| {
            fastest((repeats, SHORT), stop, run).map(|(found, seconds)| Found {
                seconds,
                again: found.again.min(seconds),
                ..found
            })
        };
        let mut list = vec![timed(&|| self.partial_sum(source, stop))?];
        list.extend(timed(&|| self.resummed(source, stop)).ok());
        Ok(list)
    }

    fn partial_sum(&self, source: &Source, stop: &Stop) -> Result<Found, Error> {
        let bits = self.accuracy + 64;
        let none = || failed(ResummationError::NoCoefficients { bits });
        let sample = self.sample(source, bits).ok_or_else(none)?;
        let estimate = self.sum(&sample, Method::PartialSum, None, stop).map_err(failed)?;
        self.found(source, &sample, (Method::PartialSum, None), &estimate, stop)
    }

    fn resummed(&self, source: &Source, stop: &Stop) -> Result<Found, Error> {
        let found = resum(&|bits| self.sample(source, bits), None, self.accuracy, stop);
        let found = found.map_err(failed)?;
        let estimate = &found.outcome.estimate;
        if found.method == Method::PartialSum || !estimate.error.is_finite() {
            return Err(failed(ResummationError::Undefined));
        }
        let none = || failed(ResummationError::NoCoefficients { bits: found.bits });
        let sample = self.sample(source, found.bits).ok_or_else(none)?;
        let singularity = found.singularity.as_ref();
        let start = Instant::now();
        sample.sum(found.method, singularity, self.accuracy, stop).map_err(failed)?;
        let again = start.elapsed().as_secs_f64();
        let found = self.found(source, &sample, (found.method, singularity), estimate, stop)?;
        Ok(Found { again, ..found })
    }

    /// The sum by a method; of too few coefficients for an estimate the partial sum, without one.
    fn sum(
        &self,
        sample: &Sample,
        method: Method,
        singularity: Option<&Singularity>,
        stop: &Stop,
    ) -> Result<Estimate, ResummationError> {
        match sample.sum(method, singularity, self.accuracy, stop) {
            Err(reason @ ResummationError::TooFewCoefficients { .. }) => {
                let sums = partial_sums(&sample.coefficients, &sample.point, sample.bits);
                let value = sums.last().cloned().ok_or(reason)?;
                Ok(Estimate { value, error: Float::with_val(53, Special::Infinity) })
            }
            found => found.map(|outcome| outcome.estimate),
        }
    }

    /// What the errors e_n of the coefficients make of the value: the sum of its changes by
    /// +e_n, by (-1)^n e_n, and by signs in pairs. Of a partial sum the first is the bound
    /// sum e_n x^n for x > 0, the second for x < 0; other methods are not linear in them.
    fn noise(
        &self,
        sample: &Sample,
        (method, singularity): (Method, Option<&Singularity>),
        value: &Float,
        stop: &Stop,
    ) -> Result<Float, ResummationError> {
        let Some(errors) = &self.errors else { return Ok(Float::new(53)) };
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
            noise += match self.sum(&changed, method, singularity, stop) {
                Ok(other) => Float::with_val(53, &other.value - value).abs(),
                Err(ResummationError::Stopped) => return Err(ResummationError::Stopped),
                Err(_) => Float::with_val(53, Special::Infinity),
            };
        }
        Ok(noise)
    }

    /// 2 pi times the factor of the source.
    fn found(
        &self,
        source: &Source,
        sample: &Sample,
        by: (Method, Option<&Singularity>),
        estimate: &Estimate,
        stop: &Stop,
    ) -> Result<Found, Error> {
        let noise = self.noise(sample, by, &estimate.value, stop).map_err(failed)?;
        let balls = Balls::new(self.accuracy + 64);
        let factor = (source.factor)(balls).ok_or(Error::NoValue)?;
        let scale = balls.mul(&balls.mul_i64(&balls.pi(), 2), &factor);
        let period = Float::with_val(self.accuracy + 64, &estimate.value * scale.midpoint());
        let period = Float::with_val(self.accuracy, period);
        let rounding = Float::with_val(53, period.abs_ref()) >> (self.accuracy - 2);
        let error = (noise + &estimate.error) * scale.abs_upper() + rounding;
        let (seconds, again) = (0.0, f64::INFINITY);
        Ok(Found { summation: Some(by.0), seconds, again, bytes: 0, period, error })
    }
}
