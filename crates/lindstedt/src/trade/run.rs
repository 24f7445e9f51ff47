//! One run of one method: the period, its stated error, its time and memory.

use super::{Method, Reason, Truth, simulation};
use crate::numeric::{self, Tier};
use crate::{Error, Route, Settings, Solution, derive};
use lindstedt_coeff::Polynomial;
use lindstedt_coeff::ball::Balls;
use lindstedt_equation::{AmplitudeRole, Problem};
use lindstedt_expand::ExpandError;
use rug::Float;
use rug::float::Constant;
use std::time::Instant;

/// What a run found.
pub(super) struct Found {
    pub(super) seconds: f64,
    /// For one more value of the small parameter; nothing where everything is done again.
    pub(super) again: Option<f64>,
    pub(super) bytes: u64,
    pub(super) period: Float,
    /// The stated absolute error.
    pub(super) error: Float,
}

pub(super) struct Job<'a> {
    pub(super) problem: &'a Problem,
    pub(super) truth: &'a Truth,
    pub(super) memory: u64,
    pub(super) bits: u32,
}

/// Period, stated error, bytes, seconds of the summation.
type Summed = (Float, Float, u64, Option<f64>);

fn simulated((period, error, bytes): (Float, Float, u64)) -> Summed {
    (period, error, bytes, None)
}

/// Longer runs are not repeated: noise is small beside them.
const LONG: f64 = 1.0;

pub(super) fn has_energy_route(problem: &Problem) -> bool {
    matches!(problem.amplitude, AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSums)
}

impl Job<'_> {
    /// The fastest of some runs.
    pub(super) fn best(
        &self,
        method: &Method,
        order: usize,
        repeats: u32,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Found, Reason> {
        let mut best = self.once(method, order, goes_on)?;
        for _ in 1..repeats {
            if best.seconds > LONG || !goes_on() {
                break;
            }
            // A repetition that runs out of time does not count.
            match self.once(method, order, goes_on) {
                Ok(again) if again.seconds < best.seconds => best = again,
                _ => {}
            }
        }
        Ok(best)
    }

    fn once(
        &self,
        method: &Method,
        order: usize,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Found, Reason> {
        let start = Instant::now();
        let (period, error, bytes, again) = match *method {
            Method::Exact { digits } => self.exact(Route::Driver, order, digits, goes_on)?,
            Method::Energy { digits } => {
                self.exact(Route::EnergyIntegral, order, digits, goes_on)?
            }
            Method::Collocation { digits } => {
                self.numeric(Tier::Collocation { digits }, order, goes_on)?
            }
            Method::Doubles => self.numeric(Tier::Doubles, order, goes_on)?,
            Method::Fourier { harmonics } => {
                self.numeric(Tier::Fourier { harmonics }, order, goes_on)?
            }
            Method::SimulationInDoubles { digits } => {
                simulated(simulation::in_doubles(self.problem, self.truth, digits, goes_on)?)
            }
            Method::Simulation { digits } => {
                simulated(simulation::in_digits(self.problem, self.truth, digits, goes_on)?)
            }
        };
        Ok(Found { seconds: start.elapsed().as_secs_f64(), again, bytes, period, error })
    }

    fn settings(&self, order: usize, route: Route) -> Settings {
        let parameters = self.truth.given.clone();
        Settings { order, parameters, memory: self.memory, route, ..Settings::default() }
    }

    fn exact(
        &self,
        route: Route,
        order: usize,
        digits: u32,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Summed, Reason> {
        let settings = self.settings(order, route);
        let result = derive(self.problem, &settings, &mut |_| goes_on());
        let result = result.map_err(Reason::Refused)?;
        if result.order < order {
            let reason = ExpandError::Interrupted { order: result.order };
            return Err(Reason::Refused(reason.into()));
        }
        let series = result.named("period_over_2pi").ok_or(Reason::Refused(Error::NoValue))?;
        let bits = bits_for(digits);
        let balls = Balls::new(bits).with_guard(order as u32 + 32);
        let ball = |n| {
            let ball = result.ball(series, n, balls).ok_or(Reason::Refused(Error::NoValue))?;
            Ok((ball.midpoint().clone(), ball.radius().clone()))
        };
        let list = (0..=order).map(ball).collect::<Result<Vec<_>, Reason>>()?;
        let terms: usize = (0..=order).map(|n| result.terms(n)).sum();
        let all = || result.series.iter().flat_map(|s| &s.coefficients);
        let symbolic: usize = all().map(|p| p.terms().len()).sum();
        let size = all().map(largest).max().unwrap_or(0);
        // x, x' and x'' are kept; a term is a fraction and its exponents.
        let copies = if matches!(result.solution, Solution::FrequencyOnly) { 1 } else { 3 };
        let bytes = (copies * terms + symbolic) as u64 * (96 + u64::from(size) / 8);
        Ok(self.timed_sum(&list, bits, bytes))
    }

    fn numeric(
        &self,
        tier: Tier,
        order: usize,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Summed, Reason> {
        let settings = self.settings(order, Route::Driver);
        let result = numeric::derive(self.problem, &settings, tier, &mut |_| goes_on());
        let result = result.map_err(Reason::Refused)?;
        let series = result.named("period_over_2pi").ok_or(Reason::Refused(Error::NoValue))?;
        // As `numeric` predicts it: twelve lists of values per order.
        let value = if result.bits <= 53 { 8 } else { u64::from(result.bits) / 8 + 48 };
        let bytes = (order as u64 + 1) * result.nodes as u64 * value * 12;
        Ok(self.timed_sum(&series.coefficients, result.bits.max(64), bytes))
    }

    fn timed_sum(&self, list: &[(Float, Float)], bits: u32, bytes: u64) -> Summed {
        let start = Instant::now();
        let (sum, error) = self.sum(list, bits);
        (sum, error, bytes, Some(start.elapsed().as_secs_f64()))
    }

    /// 2 pi times the partial sum, and its error: of the coefficients, of rounding, of the rest.
    fn sum(&self, coefficients: &[(Float, Float)], bits: u32) -> (Float, Float) {
        let bits = bits.min(self.bits);
        let x = Float::with_val(bits + 64, &self.truth.small);
        let mut power = Float::with_val(bits + 64, 1);
        let (mut terms, mut errors) = (Vec::new(), Vec::new());
        for (value, error) in coefficients {
            terms.push(Float::with_val(bits + 64, value * &power));
            errors.push(Float::with_val(53, error * &power).abs());
            power *= &x;
        }
        let (count, rest) = rest(&terms);
        let sum = |list: &[Float], bits| {
            let zero = Float::with_val(bits, 0);
            list.iter().take(count).fold(zero, |sum, term| sum + term)
        };
        let period = sum(&terms, bits + 64) * Float::with_val(bits + 64, Constant::Pi) * 2u32;
        let period = Float::with_val(bits, period);
        let rounding = Float::with_val(53, period.abs_ref()) >> (bits - 2);
        let error = (sum(&errors, 53) + rest) * std::f64::consts::TAU + rounding;
        (period, error)
    }
}

fn bits_for(digits: u32) -> u32 {
    (f64::from(digits) * std::f64::consts::LOG2_10).ceil() as u32 + 8
}

/// Bits of the largest fraction.
fn largest(p: &Polynomial) -> u32 {
    let bits = |q: &rug::Rational| q.numer().significant_bits() + q.denom().significant_bits();
    p.terms().iter().map(|(_, q)| bits(q)).max().unwrap_or(0)
}

/// How many terms to sum, and the rest estimated: with b the largest of the last two terms that do
/// not vanish and r the largest root |t_(k+2)/t_k|^(1/2) among the last ones, 4 b r/(1 - r); terms
/// that do not decrease are broken off at the smallest, and it counts four times.
fn rest(terms: &[Float]) -> (usize, Float) {
    let sizes: Vec<(usize, f64)> = (terms.iter().enumerate())
        .filter(|(_, t)| !t.is_zero())
        .map(|(n, t)| (n, log2(t)))
        .collect();
    let two = |log: f64| Float::with_val(53, log).exp2();
    let Some(&(_, first)) = sizes.first() else { return (terms.len(), Float::new(53)) };
    if sizes.len() < 4 {
        // Two or three terms tell little: the whole last one, or everything.
        let last = sizes.last().map_or(first, |s| s.1);
        let log = if sizes.len() < 2 { first } else { last + 2.0 };
        return (terms.len(), two(log));
    }
    let start = (sizes.len() / 2).min(sizes.len() - 3);
    let late = sizes.get(start..).unwrap_or(&[]);
    let rate = |pair: (&(usize, f64), &(usize, f64))| (pair.1.1 - pair.0.1) / 2.0;
    let rate = late.iter().zip(late.iter().skip(2)).map(rate).fold(f64::NEG_INFINITY, f64::max);
    let ratio = rate.exp2();
    if ratio < 0.95 {
        let last = sizes.iter().rev().take(2).map(|s| s.1).fold(f64::NEG_INFINITY, f64::max);
        return (terms.len(), two(last + 2.0 + (ratio / (1.0 - ratio)).max(0.01).log2()));
    }
    let smallest = sizes.iter().min_by(|a, b| a.1.total_cmp(&b.1)).copied();
    let (n, log) = smallest.unwrap_or((terms.len(), first));
    (n + 1, two(log + 2.0))
}

/// log2 |x|, also far outside of f64.
fn log2(x: &Float) -> f64 {
    let (mantissa, exponent) = x.to_f64_exp();
    mantissa.abs().log2() + f64::from(exponent)
}
