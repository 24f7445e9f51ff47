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
use lindstedt_series::resummation::{Method, Sample, partial_sums, resum};
use rug::ops::Pow;
use rug::{Float, Rational};
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
    /// c_n; nothing where it vanishes.
    coefficients: Vec<Option<Coefficient<'a>>>,
    small: &'a Exact,
    first: usize,
    step: usize,
}

/// Of fewer orders the terms of one series do not tell how they fall: one may be small by accident.
const SHORT: usize = 4;

type Coefficient<'a> = Box<dyn Fn(Balls) -> Ball + 'a>;

impl<'a> Along<'a> {
    fn new(cycle: &'a Cycle, series: &'a [Algebraic], small: &'a Exact) -> Option<Self> {
        let value = |c: &'a Algebraic| -> Option<Coefficient<'a>> {
            let value = move |balls| cycle.enclosed(c, balls);
            (!c.element.is_empty()).then(|| Box::new(value) as _)
        };
        Self::of(series.iter().map(value).collect(), small)
    }

    fn of(coefficients: Vec<Option<Coefficient<'a>>>, small: &'a Exact) -> Option<Self> {
        let mut present = (0..coefficients.len()).filter(|n| coefficients[*n].is_some());
        let first = present.next()?;
        let step = present.map(|n| n - first).fold(0, gcd).max(1);
        Some(Self { coefficients, small, first, step })
    }

    fn power(&self, n: usize, bits: u32) -> Float {
        let small = Float::with_val(bits, self.small.ball(Balls::new(bits)).midpoint());
        small.pow(u32::try_from(n).unwrap_or(u32::MAX))
    }

    fn coefficient(&self, n: usize, bits: u32) -> Float {
        let Some(coefficient) = &self.coefficients[n] else { return Float::new(bits) };
        let at = |k: u32| coefficient(Balls::new(bits.saturating_mul(1 << k)));
        let known = |ball: &Ball| ball.relative_accuracy_bits() >= i64::from(bits);
        let found = (1..=DOUBLINGS).map(at).find(known);
        found.map_or_else(|| Float::new(bits), |ball| Float::with_val(bits, ball.midpoint()))
    }

    /// The first term.
    fn leading(&self, bits: u32) -> Float {
        self.coefficient(self.first, bits) * self.power(self.first, bits)
    }

    fn sample(&self, bits: u32) -> Sample {
        let orders = (self.first..self.coefficients.len()).step_by(self.step);
        let coefficients = orders.map(|n| self.coefficient(n, bits)).collect();
        Sample { coefficients, point: self.power(self.step, bits), map: None, radius: None, bits }
    }

    /// |t_n| by n, the order of eps behind the first.
    fn sizes(&self, bits: u32) -> Vec<f64> {
        let Sample { coefficients, point, .. } = self.sample(bits);
        let mut sizes = vec![0.0; self.coefficients.len() - self.first];
        for (n, c) in coefficients.iter().enumerate() {
            sizes[n * self.step] = c.to_f64().abs() * power(point.to_f64().abs(), n);
        }
        sizes
    }

    /// The sum, with an error that is infinite where the terms do not fall.
    /// The rest of a short partial sum is `least`, at least, or without one that of terms which fall like `first` from the
    /// first one on: four times that where all others vanish.
    fn sum(
        &self,
        [q, first]: [f64; 2],
        least: Option<f64>,
        bits: u32,
        method: Option<Method>,
        stop: &Stop,
    ) -> Option<Ball> {
        let sample = remembered(|bits| Some(self.sample(bits)));
        let resummed = resum(&sample, method, bits, stop).ok().map(|r| r.outcome.estimate);
        let (value, error) = match resummed.filter(|found| found.error.is_finite()) {
            Some(found) => (found.value, found.error),
            None => {
                let (sizes, last) = (self.sizes(bits), self.coefficients.len() - self.first - 1);
                let rests = last_two(&sizes).map(|(n, size)| size * power(q, last - n));
                let geometric =
                    |t: f64, q: f64| if q < 1.0 { t / (1.0 - q) } else { f64::INFINITY };
                let none = geometric(sizes[0] * SAFETY * power(q, last + 1), q);
                let slow = sizes[0] * power(first, last + 1);
                let none = none.max(SAFETY * slow);
                let rest = rests.reduce(f64::max).map_or(none, |t| geometric(t * SAFETY * q, q));
                let least = match least {
                    Some(least) if last < SHORT => least,
                    None if 2 * last < SHORT => slow,
                    _ => 0.0,
                };
                let rest = rest.max(least);
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

/// By how much at most the terms of all fall per order; where all vanish, as if the coefficients to come were 1.
fn ratio<'a>(along: impl Iterator<Item = &'a Along<'a>>, small: &Exact, bits: u32) -> f64 {
    let ratios = along.flat_map(|along| {
        let sizes = along.sizes(bits);
        falls(&sizes, sizes[0]).concat()
    });
    ratios.reduce(f64::max).unwrap_or_else(|| small.to_f64().abs())
}

/// Whether an exponent is negative; nothing where its error leaves that open.
fn is_stable(exponent: Option<&Ball>) -> Option<bool> {
    let sign = exponent.filter(|ball| ball.is_finite() && !ball.contains_zero());
    sign.map(|ball| ball.midpoint().is_sign_negative())
}

/// The sum of a Floquet exponent, and whether its cycle is stable.
pub(crate) fn exponent(
    series: &[Rational],
    small: &Exact,
    digits: usize,
    stop: &Stop,
) -> (Option<Number>, Option<bool>) {
    let bits = bits_for(digits.saturating_add(16));
    let value = |c: &'_ Rational| -> Option<Coefficient<'_>> {
        let c = c.clone();
        (!c.is_zero()).then(|| Box::new(move |balls: Balls| balls.from_rational(&c)) as _)
    };
    let along = Along::of(series.iter().map(value).collect(), small);
    let sum = along.and_then(|along| {
        let q = ratio(std::iter::once(&along), small, bits);
        along.sum([q; 2], None, bits, Some(Method::Pade), stop)
    });
    (sum.as_ref().and_then(|sum| Number::estimated(sum, digits)), is_stable(sum.as_ref()))
}

/// All cycles by increasing amplitude; `near` is how the terms of the motion at an amplitude fall, and the
/// rest of psi' there.
pub(super) fn summed(
    found: &Cycles,
    small: &Exact,
    digits: usize,
    near: &dyn Fn(&Float) -> [f64; 2],
    stop: &Stop,
) -> Vec<SummedCycle> {
    found.cycles.iter().map(|cycle| SummedCycle::new(cycle, small, digits, near, stop)).collect()
}

impl SummedCycle {
    fn new(
        cycle: &Cycle,
        small: &Exact,
        digits: usize,
        near: &dyn Fn(&Float) -> [f64; 2],
        stop: &Stop,
    ) -> Self {
        let bits = bits_for(digits.saturating_add(16));
        let series = [&cycle.squared_amplitude, &cycle.frequency, &cycle.exponent];
        let along = series.map(|series| Along::new(cycle, series, small));
        let q = ratio(along.iter().flatten(), small, bits);
        let amplitude = along[0].as_ref().map(|along| along.leading(bits).sqrt());
        let [first, turn] = amplitude.map_or([f64::NAN; 2], |a| near(&a));
        let [square, turns, exponent] = along;
        let sum = |along: Option<Along<'_>>, least| {
            along.and_then(|along| along.sum([q, first], least, bits, None, stop))
        };
        let sums = [sum(square, None), sum(turns, Some(turn)), sum(exponent, None)];
        let [square, frequency, exponent] = &sums;
        let number = |ball: &Option<Ball>| Number::estimated(ball.as_ref()?, digits);
        Self {
            amplitude: number(&square.as_ref().and_then(|ball| Balls::new(bits).sqrt(ball))),
            frequency: number(frequency),
            floquet_exponent: number(exponent),
            stable: is_stable(exponent.as_ref()),
        }
    }
}
