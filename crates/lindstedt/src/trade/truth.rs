//! True periods, from a route that the runs do not take.

use super::found::Found;
use super::{Method, Row, Trade};
use crate::Error;
use crate::evaluate::setting::Setting;
use crate::evaluate::source::Source;
use lindstedt_number::ball::{Ball, Balls};
use rug::Float;
use rug::float::Round;

/// The true period at given parameters.
pub(super) struct Truth {
    pub(super) period: Float,
    /// Its relative error: rounding, the radius of the proof, the estimate of the integrator.
    uncertainty: f64,
    /// Its formula or source. From the time domain: the integrator's own rows are then judged by the same
    /// integrator with more digits.
    source: String,
}

impl Truth {
    /// The closed form of `source`, else what was proved, else
    /// the time domain.
    pub(super) fn new(
        source: &Source,
        (bits, digits): (u32, u32),
        proved: Option<&Ball>,
        simulate: &dyn Fn(u32) -> Result<Found, Error>,
    ) -> Result<Self, Error> {
        let rounding = (8.0 - f64::from(bits)).exp2();
        if let Some((text, formula)) = &source.closed {
            let ball = formula(Balls::new(bits).with_guard(64))
                .filter(|b| b.is_finite())
                .ok_or(Error::NoValue)?;
            let period = Float::with_val(bits, ball.midpoint());
            return Ok(Self { period, uncertainty: rounding, source: text.clone() });
        }
        if let Some(ball) = proved {
            let period = Float::with_val(bits, ball.midpoint());
            let relative = Float::with_val(53, ball.radius() / &period).abs().to_f64();
            let uncertainty = relative + rounding;
            return Ok(Self { period, uncertainty, source: "contraction proof".to_owned() });
        }
        let found = simulate(digits)?;
        let uncertainty = Float::with_val(53, &found.error / &found.period).abs().to_f64();
        let source = format!("time domain: Taylor series to {digits} digits");
        Ok(Self { period: Float::with_val(bits, &found.period), uncertainty, source })
    }

    /// The answer without rows.
    pub(super) fn begin(&self, setting: &Setting, repeats: u32) -> Trade {
        let decimal = || {
            let small = setting.small(Balls::new(self.period.prec()));
            small.midpoint().to_string_radix(10, Some(30))
        };
        let small = setting.rational_small().map_or_else(decimal, |small| small.to_string());
        let digits = self.period.prec() as usize * 3 / 10 - 18;
        Trade {
            period: self.period.to_string_radix(10, Some(digits)),
            period_error: self.uncertainty,
            source: self.source.clone(),
            ..Trade::begun(&setting.problem, small, repeats)
        }
    }

    pub(super) fn row(&self, method: Method, order: Option<usize>, found: Found) -> Row {
        let error = |x: Float| (x / &self.period).abs().to_f64_round(Round::Up);
        let bits = self.period.prec().max(found.period.prec());
        let stated_error = error(Float::with_val(53, &found.error));
        Row {
            method,
            order,
            summation: found.summation,
            seconds: found.seconds,
            seconds_again: found.again,
            bytes: found.bytes,
            period: printed(&found.period, stated_error),
            true_error: error(Float::with_val(bits, &found.period - &self.period)),
            stated_error,
            proved_error: None,
            pareto: false,
        }
    }
}

/// The digits that the stated error supports, and two more; without one, all.
fn printed(period: &Float, stated: f64) -> String {
    if !stated.is_finite() {
        return period.to_string_radix(10, None);
    }
    let digits = (-stated.max(1e-300).log10()).max(0.0) as usize + 3;
    period.to_string_radix(10, Some(digits.min(period.prec() as usize * 3 / 10).max(2)))
}
