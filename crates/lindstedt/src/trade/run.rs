//! One run of one method: the period, its stated error, its time and memory.

use super::sums::Series;
use super::{Method, Reason, Summation, simulation};
use crate::evaluate::setting::Setting;
use crate::evaluate::source::{Source, coefficients_of};
use crate::numeric::{self, Tier};
use crate::{Error, Route, Settings, Solution, derive};
use lindstedt_algebra::Stop;
use lindstedt_coeff::Polynomial;
use lindstedt_equation::{AmplitudeRole, Problem};
use lindstedt_expand::ExpandError;
use rug::{Float, Rational};
use std::time::Instant;

/// What a run found.
pub(super) struct Found {
    pub(super) summation: Option<Summation>,
    pub(super) seconds: f64,
    /// For one more value of the small parameter.
    pub(super) again: f64,
    pub(super) bytes: u64,
    pub(super) period: Float,
    /// The stated absolute error.
    pub(super) error: Float,
}

pub(super) struct Job<'a> {
    pub(super) setting: &'a Setting,
    /// What is known of the series; its own coefficients are not used.
    pub(super) source: &'a Source,
    pub(super) memory: u64,
    pub(super) bits: u32,
    /// A derivation or a sum that takes longer is broken off.
    pub(super) seconds: f64,
}

/// Longer runs are not repeated: noise is small beside them.
const LONG: f64 = 1.0;

pub(super) fn has_energy_route(problem: &Problem) -> bool {
    matches!(problem.amplitude, AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSums)
}

/// Work that asks whether to go on.
type Work<'w, T> = dyn Fn(&mut dyn FnMut() -> bool) -> Result<T, Reason> + 'w;

/// The fastest of some runs.
fn best<T>(
    repeats: u32,
    goes_on: &mut dyn FnMut() -> bool,
    run: &Work<'_, T>,
) -> Result<(T, f64), Reason> {
    let once = |goes_on: &mut dyn FnMut() -> bool| {
        let start = Instant::now();
        run(goes_on).map(|found| (found, start.elapsed().as_secs_f64()))
    };
    let mut best = once(goes_on)?;
    for _ in 1..repeats {
        if best.1 > LONG || !goes_on() {
            break;
        }
        // A repetition that runs out of time does not count.
        match once(goes_on) {
            Ok(again) if again.1 < best.1 => best = again,
            _ => {}
        }
    }
    Ok(best)
}

impl Job<'_> {
    /// The fastest of some runs: one sum or two of the same series, or the integrated period.
    pub(super) fn run(
        &self,
        method: &Method,
        order: usize,
        repeats: u32,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Found>, Reason> {
        let derived = |goes_on: &mut dyn FnMut() -> bool| match *method {
            Method::Exact { digits } => self.exact(Route::Driver, order, digits, goes_on),
            Method::Energy { digits } => self.exact(Route::EnergyIntegral, order, digits, goes_on),
            Method::Collocation { digits } => {
                self.numeric(Tier::Collocation { digits }, order, goes_on)
            }
            Method::Doubles => self.numeric(Tier::Doubles, order, goes_on),
            Method::Fourier { harmonics } => {
                self.numeric(Tier::Fourier { harmonics }, order, goes_on)
            }
            _ => Err(Reason::Refused(Error::NoValue)),
        };
        let integrated = |goes_on: &mut dyn FnMut() -> bool| match *method {
            Method::Simulation { digits } => simulation::in_digits(self.setting, digits, goes_on),
            _ => simulation::in_doubles(self.setting, method.digits(), goes_on),
        };
        if !method.has_order() {
            let ((period, error, bytes), seconds) = best(repeats, goes_on, &integrated)?;
            let found = Found { summation: None, seconds, again: seconds, bytes, period, error };
            return Ok(vec![found]);
        }
        let ((series, bytes), seconds) = best(repeats, goes_on, &derived)?;
        let found = |sum: super::sums::Sum| Found {
            summation: Some(sum.summation),
            seconds: seconds + sum.seconds,
            again: sum.again,
            bytes,
            period: sum.period,
            error: sum.error,
        };
        Ok(series.sums(self.source, repeats, &self.stop())?.into_iter().map(found).collect())
    }

    /// Says stop after the seconds of a run from now.
    fn stop(&self) -> Stop {
        let (start, seconds) = (Instant::now(), self.seconds);
        Stop::new(move || start.elapsed().as_secs_f64() > seconds)
    }

    fn settings(&self, order: usize, route: Route) -> Settings {
        let stop = self.stop();
        let parameters = self.setting.parameters().clone();
        let condition = Some(self.setting.condition);
        let memory = self.memory;
        Settings { order, condition, parameters, memory, route, stop }
    }

    fn exact(
        &self,
        route: Route,
        order: usize,
        digits: u32,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<(Series, u64), Reason> {
        let settings = self.settings(order, route);
        let result = derive(&self.setting.problem, &settings, &mut |_| goes_on());
        let result = result.map_err(Reason::Refused)?;
        if result.order < order {
            let reason = ExpandError::Interrupted { order: result.order };
            return Err(Reason::Refused(reason.into()));
        }
        let terms: usize = (0..=order).map(|n| result.terms(n)).sum();
        let all = || result.series.iter().flat_map(|s| &s.coefficients);
        let symbolic: usize = all().map(|p| p.terms().len()).sum();
        let size = all().map(largest).max().unwrap_or(0);
        // x, x' and x'' are kept; a term is a fraction and its exponents.
        let copies = if matches!(result.solution, Solution::FrequencyOnly) { 1 } else { 3 };
        let bytes = (copies * terms + symbolic) as u64 * (96 + u64::from(size) / 8);
        let values = coefficients_of(result, self.source.step, &self.source.ratio);
        let values = values.map_err(Reason::Refused)?;
        let accuracy = bits_for(digits).min(self.bits);
        Ok((Series { values, errors: None, accuracy }, bytes))
    }

    fn numeric(
        &self,
        tier: Tier,
        order: usize,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<(Series, u64), Reason> {
        let settings = self.settings(order, Route::Driver);
        let result = numeric::derive(&self.setting.problem, &settings, tier, &mut |_| goes_on());
        let result = result.map_err(Reason::Refused)?;
        let series = result.named("period_over_2pi").ok_or(Reason::Refused(Error::NoValue))?;
        // As `numeric` predicts it: twelve lists of values per order.
        let value = if result.bits <= 53 { 8 } else { u64::from(result.bits) / 8 + 48 };
        let bytes = (order as u64 + 1) * result.nodes as u64 * value * 12;
        let step = self.source.step;
        let skipped = series.coefficients.iter().enumerate().filter(|(n, _)| n % step != 0);
        if skipped.into_iter().any(|(_, (c, e))| Float::with_val(53, c.abs_ref()) > *e) {
            return Err(Reason::Refused(Error::NoValue));
        }
        let inverse = Rational::from(self.source.ratio.recip_ref());
        let mut scale = Rational::from(1);
        let (mut values, mut errors) = (Vec::new(), Vec::new());
        for (n, (c, e)) in series.coefficients.iter().enumerate() {
            if n % step == 0 {
                values.push(Float::with_val(c.prec().max(64) + 64, c * &scale));
                errors.push(Float::with_val(53, e * &scale).abs());
            }
            scale *= &inverse;
        }
        let padded = move |bits| Some(values.iter().map(|c| Float::with_val(bits, c)).collect());
        let accuracy = result.bits.max(64).min(self.bits);
        Ok((Series { values: Box::new(padded), errors: Some(errors), accuracy }, bytes))
    }
}

fn bits_for(digits: u32) -> u32 {
    (f64::from(digits) * std::f64::consts::LOG2_10).ceil() as u32 + 8
}

/// Bits of the largest fraction.
fn largest(p: &Polynomial) -> u32 {
    let bits = |q: &Rational| q.numer().significant_bits() + q.denom().significant_bits();
    p.terms().iter().map(|(_, q)| bits(q)).max().unwrap_or(0)
}
