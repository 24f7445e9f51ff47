//! True periods, from a route that the runs do not take.

use super::run::Found;
use super::{Method, Reason, Row, simulation};
use crate::evaluate::setting::Setting;
use crate::evaluate::source::Source;
use crate::{Error, Exact};
use lindstedt_number::ball::Balls;
use rug::{Float, Rational};

/// T(1) of x'' - (1 - x^2) x' + x = 0 to 98 digits: mpmath 1.3.0 with 125 digits, Taylor series of
/// order 150 and the secant method on the section x' = 0; the integrator of this project agrees,
/// and the first 13 digits are in Andersen and Geer (1982).
const VAN_DER_POL: &str = concat!(
    "6.66328685932313018969968203048232870681264631688387",
    "665511486318208092586484560686486896662005327122"
);
/// Its relative error.
const VAN_DER_POL_ERROR: f64 = 1e-97;
/// Digits of the integrator beyond the most that are judged.
const MORE: u32 = 8;

/// The true period at given parameters.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The period.
    pub period: Float,
    /// Its relative error: rounding, the digits of a reference, the estimate of the integrator.
    pub uncertainty: f64,
    /// Its formula or source.
    pub source: String,
    /// Whether it is from the time domain: the integrator's own rows are then judged by the same
    /// integrator with more digits.
    pub from_time_domain: bool,
    /// The parameters used.
    pub at: Vec<(String, Exact)>,
    /// The value of the small parameter of the series.
    pub small: Float,
    /// The same, where it is rational.
    pub rational_small: Option<Rational>,
}

impl Truth {
    pub(super) fn row(&self, method: Method, order: Option<usize>, found: Found) -> Row {
        let error = |x: Float| (x / &self.period).abs().to_f64_round(rug::float::Round::Up);
        let bits = self.period.prec().max(found.period.prec());
        Row {
            method,
            order,
            summation: found.summation,
            seconds: found.seconds,
            seconds_again: found.again,
            bytes: found.bytes,
            true_error: error(Float::with_val(bits, &found.period - &self.period)),
            stated_error: error(Float::with_val(53, &found.error)),
            period: found.period,
        }
    }
}

/// The closed form of `source`, else the reference (van der Pol at 1), else the time domain.
pub(super) fn truth(
    setting: &Setting,
    source: &Source,
    bits: u32,
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<Truth, Reason> {
    let small = Float::with_val(bits, setting.small(Balls::new(bits)).midpoint());
    let rounding = (8.0 - f64::from(bits)).exp2();
    let truth = |period: Float, uncertainty: f64, source: String| Truth {
        period,
        uncertainty,
        from_time_domain: source.starts_with(TIME_DOMAIN),
        source,
        at: setting.at.clone(),
        small: small.clone(),
        rational_small: setting.rational_small(),
    };
    if let Some((text, formula)) = &source.closed {
        let ball = formula(Balls::new(bits).with_guard(64));
        let ball = ball.filter(|b| b.is_finite()).ok_or(Reason::Refused(Error::NoValue))?;
        return Ok(truth(Float::with_val(bits, ball.midpoint()), rounding, text.clone()));
    }
    let known = lindstedt_problems::find("van-der-pol");
    let is_known = known.is_some_and(|known| known.equation == setting.problem.equation);
    if is_known && small == 1 {
        let reference = Float::parse(VAN_DER_POL).map_err(|_| Reason::Refused(Error::NoValue))?;
        let uncertainty = rounding.max(VAN_DER_POL_ERROR);
        return Ok(truth(Float::with_val(bits, reference), uncertainty, REFERENCE.to_owned()));
    }
    let (period, error, _) = simulation::in_digits(setting, digits + MORE, goes_on)?;
    let uncertainty = Float::with_val(53, &error / &period).abs().to_f64();
    let text = format!("{TIME_DOMAIN}: Taylor series to {} digits", digits + MORE);
    Ok(truth(Float::with_val(bits, &period), uncertainty, text))
}

const REFERENCE: &str = "reference of 98 digits";
const TIME_DOMAIN: &str = "time domain";
