//! The limit cycles of an averaged oscillator at one value of the small parameter.
//!
//! The series of a^2, of the frequency and of the Floquet exponent are exact (`derivation`, `averaging/cycles.rs`). Where
//! only every s-th power occurs (s = 2 where t -> -t, eps -> -eps leaves the equation as it is) eps^s is the variable.
//! Series with enough coefficients are resummed; of shorter ones the partial sum counts, and what follows is judged as in
//! `rest.rs`: terms t_n of all three are taken to fall like the same q^n. All estimated.

use super::rest::{SAFETY, falls, last_two, power};
use crate::digits::bits_for;
use crate::source::gcd;
use crate::source::remembered;
use lindstedt_algebra::Stop;
use lindstedt_derivation::averaging::{Algebraic, Cycle, Cycles};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number};
use lindstedt_series::resummation::{Sample, partial_sums, resum};
use rug::Float;
use rug::ops::Pow;
use serde::Serialize;

/// A limit cycle at one value of the small parameter; of every number nothing where not one digit is supported.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SummedCycle {
    /// a, the amplitude of the first harmonic.
    pub amplitude: Option<Number>,
    /// psi'.
    pub frequency: Option<Number>,
    /// The Floquet exponent per unit of t that is not zero.
    pub floquet_exponent: Option<Number>,
    /// Whether the exponent is negative; nothing where the estimated error leaves it open.
    pub stable: Option<bool>,
}

/// Attempts at enclosing a coefficient; one that may still vanish then is taken to.
const DOUBLINGS: u32 = 4;

/// eps^first (c_0 + c_1 eps^step + ...) along a cycle.
struct Along<'a> {
    cycle: &'a Cycle,
    series: &'a [Algebraic],
    small: &'a Exact,
    first: usize,
    step: usize,
}

impl<'a> Along<'a> {
    fn new(cycle: &'a Cycle, series: &'a [Algebraic], small: &'a Exact) -> Option<Self> {
        let mut present = (0..series.len()).filter(|n| !series[*n].element.is_empty());
        let first = present.next()?;
        let step = present.map(|n| n - first).fold(0, gcd).max(1);
        Some(Self { cycle, series, small, first, step })
    }

    fn power(&self, n: usize, bits: u32) -> Float {
        let small = Float::with_val(bits, self.small.ball(Balls::new(bits)).midpoint());
        small.pow(u32::try_from(n).unwrap_or(u32::MAX))
    }

    fn coefficient(&self, c: &Algebraic, bits: u32) -> Float {
        let at = |k: u32| self.cycle.enclosed(c, Balls::new(bits.saturating_mul(1 << k)));
        let known = |ball: &Ball| ball.relative_accuracy_bits() >= i64::from(bits);
        let found = (1..=DOUBLINGS).map(at).find(known);
        found.map_or_else(|| Float::new(bits), |ball| Float::with_val(bits, ball.midpoint()))
    }

    fn sample(&self, bits: u32) -> Sample {
        let series = self.series[self.first..].iter().step_by(self.step);
        let coefficients = series.map(|c| self.coefficient(c, bits)).collect();
        Sample { coefficients, point: self.power(self.step, bits), map: None, radius: None, bits }
    }

    /// |t_n| by n, the order of eps behind the first.
    fn sizes(&self, bits: u32) -> Vec<f64> {
        let Sample { coefficients, point, .. } = self.sample(bits);
        let mut sizes = vec![0.0; self.series.len() - self.first];
        for (n, c) in coefficients.iter().enumerate() {
            sizes[n * self.step] = c.to_f64().abs() * power(point.to_f64().abs(), n);
        }
        sizes
    }

    /// The sum, with an error that is infinite where the terms do not fall.
    fn sum(&self, q: f64, bits: u32, stop: &Stop) -> Option<Ball> {
        let sample = remembered(|bits| Some(self.sample(bits)));
        let resummed = resum(&sample, None, bits, stop).ok().map(|r| r.outcome.estimate);
        let (value, error) = match resummed.filter(|found| found.error.is_finite()) {
            Some(found) => (found.value, found.error),
            None => {
                let (sizes, last) = (self.sizes(bits), self.series.len() - self.first - 1);
                let rests = last_two(&sizes).map(|(n, size)| size * power(q, last - n));
                let none = sizes[0] * power(q, last + 1);
                let rest = rests.reduce(f64::max).map_or(none, |t| t * SAFETY * q / (1.0 - q));
                let rest = if q < 1.0 { rest } else { f64::INFINITY };
                let sample = self.sample(bits);
                let sums = partial_sums(&sample.coefficients, &sample.point, bits);
                (sums.last()?.clone(), Float::with_val(53, rest))
            }
        };
        let factor = self.power(self.first, bits);
        let error = error * Float::with_val(53, factor.abs_ref());
        Some(Balls::new(bits).from_parts(&(value * factor), &error))
    }
}

/// All cycles by increasing amplitude.
pub(super) fn summed(
    found: &Cycles,
    small: &Exact,
    digits: usize,
    stop: &Stop,
) -> Vec<SummedCycle> {
    found.cycles.iter().map(|cycle| SummedCycle::new(cycle, small, digits, stop)).collect()
}

impl SummedCycle {
    fn new(cycle: &Cycle, small: &Exact, digits: usize, stop: &Stop) -> Self {
        let bits = bits_for(digits.saturating_add(16));
        let series = [&cycle.squared_amplitude, &cycle.frequency, &cycle.exponent];
        let along = series.map(|series| Along::new(cycle, series, small));
        let ratios = along.iter().flatten().flat_map(|along| {
            let sizes = along.sizes(bits);
            falls(&sizes, sizes[0]).concat()
        });
        // Where all vanish, as if the coefficients to come were 1.
        let q = ratios.reduce(f64::max).unwrap_or_else(|| small.to_f64().abs());
        let sums = along.map(|along| along?.sum(q, bits, stop));
        let [square, frequency, exponent] = &sums;
        let number = |ball: &Option<Ball>| Number::estimated(ball.as_ref()?, digits);
        let sign = exponent.as_ref().filter(|ball| ball.is_finite() && !ball.contains_zero());
        Self {
            amplitude: number(&square.as_ref().and_then(|ball| Balls::new(bits).sqrt(ball))),
            frequency: number(frequency),
            floquet_exponent: number(exponent),
            stable: sign.map(|ball| ball.midpoint().is_sign_negative()),
        }
    }
}
