//! One run of one method: the period, its stated error, its time and memory.

use super::found::{Found, fastest};
use super::sums::Series;
use super::{Bench, Method, simulation};
use crate::evaluate::source::coefficients_of;
use crate::numeric::Tier;
use crate::{Error, Route, Solution};
use lindstedt_algebra::Stop;
use lindstedt_coeff::Polynomial;
use lindstedt_derivation::{Settings, derive, numeric};
use lindstedt_equation::Quantity;
use lindstedt_expand::ExpandError;
use rug::{Float, Rational};

/// Longer runs are not repeated: noise is small beside them.
const LONG: f64 = 1.0;

impl Bench<'_> {
    /// The fastest of some runs: one sum or two of the same series, or the integrated period.
    pub(super) fn run(&self, method: &Method, order: usize) -> Result<Vec<Found>, Error> {
        let (stop, repeats) = (self.stop(), self.plan.repeats);
        let derived = || match *method {
            Method::Exact { digits } => self.exact(Route::default(), order, digits, &stop),
            Method::Energy { digits } => self.exact(Route::EnergyIntegral, order, digits, &stop),
            Method::Collocation { digits } => {
                self.numeric(Tier::Collocation { digits }, order, &stop)
            }
            Method::Doubles => self.numeric(Tier::Doubles, order, &stop),
            Method::Fourier { harmonics } => {
                self.numeric(Tier::Fourier { harmonics }, order, &stop)
            }
            _ => Err(Error::NoValue),
        };
        let integrated = || match *method {
            Method::Simulation { digits } => simulation::in_digits(&self.motion, digits, &stop),
            _ => simulation::in_doubles(&self.motion, method.digits(), &stop),
        };
        if !method.has_order() {
            let (found, seconds) = fastest((repeats, LONG), &stop, &integrated)?;
            return Ok(vec![Found { seconds, again: seconds, ..found }]);
        }
        let ((series, bytes), seconds) = fastest((repeats, LONG), &stop, &derived)?;
        // The sums have the time of a run for themselves.
        let mut list = series.sums(&self.source, repeats, &self.stop())?;
        for found in &mut list {
            found.seconds += seconds;
            found.bytes = bytes;
        }
        Ok(list)
    }

    fn settings(&self, order: usize, route: Route, stop: &Stop) -> Settings {
        let parameters = self.setting.parameters().clone();
        let condition = Some(self.setting.condition);
        let (memory, stop) = (self.work.memory, stop.clone());
        Settings { order, condition, parameters, memory, route, stop }
    }

    fn exact(
        &self,
        route: Route,
        order: usize,
        digits: u32,
        stop: &Stop,
    ) -> Result<(Series, u64), Error> {
        let settings = self.settings(order, route, stop);
        let result = derive(&self.setting.problem, &settings, &mut |_| !stop.asked())?;
        if result.order < order {
            return Err(ExpandError::Interrupted { order: result.order }.into());
        }
        let terms: usize = (0..=order).map(|n| result.terms(n)).sum();
        let all = || result.series.iter().flat_map(|s| &s.coefficients);
        let symbolic: usize = all().map(|p| p.terms().len()).sum();
        let size = all().map(largest).max().unwrap_or(0);
        // x, x' and x'' are kept; a term is a fraction and its exponents.
        let copies = if matches!(result.solution, Solution::FrequencyOnly { .. }) { 1 } else { 3 };
        let bytes = (copies * terms + symbolic) as u64 * (96 + u64::from(size) / 8);
        let values = coefficients_of(result, self.source.step, &self.source.ratio)?;
        let wanted = (f64::from(digits) * std::f64::consts::LOG2_10).ceil() as u32 + 8;
        Ok((Series { values, errors: None, accuracy: wanted.min(self.bits) }, bytes))
    }

    fn numeric(&self, tier: Tier, order: usize, stop: &Stop) -> Result<(Series, u64), Error> {
        let settings = self.settings(order, Route::Driver, stop);
        let result =
            numeric::derive(&self.setting.problem, &settings, tier, &mut |_| !stop.asked())?;
        let series = result.named(Quantity::Period).ok_or(Error::NoValue)?;
        // As `numeric` predicts it: twelve lists of values per order.
        let value = if result.bits <= 53 { 8 } else { u64::from(result.bits) / 8 + 48 };
        let bytes = (order as u64 + 1) * result.nodes as u64 * value * 12;
        let step = self.source.step;
        let inverse = Rational::from(self.source.ratio.recip_ref());
        let mut scale = Rational::from(1);
        let (mut values, mut errors) = (Vec::new(), Vec::new());
        for (n, (c, e)) in series.coefficients.iter().enumerate() {
            if n % step == 0 {
                values.push(Float::with_val(c.prec().max(64) + 64, c * &scale));
                errors.push(Float::with_val(53, e * &scale).abs());
            } else if Float::with_val(53, c.abs_ref()) > *e {
                return Err(Error::NoValue);
            }
            scale *= &inverse;
        }
        let padded = move |bits| Some(values.iter().map(|c| Float::with_val(bits, c)).collect());
        let accuracy = result.bits.max(64).min(self.bits);
        Ok((Series { values: Box::new(padded), errors: Some(errors), accuracy }, bytes))
    }
}

/// Bits of the largest fraction.
fn largest(p: &Polynomial) -> u32 {
    let bits = |q: &Rational| q.numer().significant_bits() + q.denom().significant_bits();
    p.terms().iter().map(|(_, q)| bits(q)).max().unwrap_or(0)
}
