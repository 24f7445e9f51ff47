//! True periods.

use super::run::Found;
use super::{Method, Row};
use crate::{Error, Value};
use lindstedt_coeff::ball::Balls;
use lindstedt_equation::{AmplitudeRole, Problem};
use rug::float::Constant;
use rug::ops::Pow;
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// T(1) of x'' - (1 - x^2) x' + x = 0 to 98 digits: mpmath 1.3.0 with 125 digits, Taylor series of
/// order 150 and the secant method on the section x' = 0; the integrator of this project agrees,
/// and the first 13 digits are in Andersen and Geer (1982).
const VAN_DER_POL: &str = concat!(
    "6.66328685932313018969968203048232870681264631688387",
    "665511486318208092586484560686486896662005327122"
);
/// Its relative error.
const VAN_DER_POL_ERROR: f64 = 1e-97;

/// The true period at given parameters.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The period.
    pub period: Float,
    /// Its relative error: rounding, or the digits of the reference.
    pub uncertainty: f64,
    /// Its formula or source.
    pub source: &'static str,
    /// The parameters used, by name.
    pub at: BTreeMap<String, Value>,
    /// The value of the small parameter of the series.
    pub small: Rational,
    /// Parameters of the equation that the series needs (the amplitude).
    pub given: BTreeMap<String, Value>,
}

impl Truth {
    pub(super) fn row(&self, method: Method, order: Option<usize>, found: Found) -> Row {
        let error = |x: Float| (x / &self.period).abs().to_f64_round(rug::float::Round::Up);
        let bits = self.period.prec().max(found.period.prec());
        Row {
            method,
            order,
            seconds: found.seconds,
            seconds_again: found.again.unwrap_or(found.seconds),
            bytes: found.bytes,
            true_error: error(Float::with_val(bits, &found.period - &self.period)),
            stated_error: error(Float::with_val(53, &found.error)),
            period: found.period,
        }
    }
}

/// The closed form at the parameters given, others at their defaults.
pub(super) fn truth(
    problem: &Problem,
    given: &BTreeMap<String, Value>,
    bits: u32,
) -> Result<Truth, Error> {
    let quarter = || Rational::from((1, 4));
    let get = |name: &str, default: Rational| match given.get(name) {
        None => Ok(default),
        Some(Value::Rational(q)) => Ok(q.clone()),
        Some(Value::PiTimes(_)) => {
            Err(Error::NotAmongSymbols { name: name.to_owned(), missing: Vec::new() })
        }
    };
    let pi = Float::with_val(bits, Constant::Pi);
    let real = |q: &Rational| Float::with_val(bits, q);
    let amplitude = match given.get("amplitude") {
        Some(value) => value.clone(),
        None => Value::Rational(Rational::from(1)),
    };
    let a = amplitude.ball(Balls::new(bits)).midpoint().clone();
    let mut at = BTreeMap::new();
    let mut series = BTreeMap::new();
    let mut uncertainty = (-f64::from(bits) + 8.0).exp2();
    let (period, source, small) = match problem.amplitude {
        AmplitudeRole::ScalesFrequency { .. } => {
            let delta = match given.get("n") {
                Some(Value::Rational(n)) => (n.clone() - 1u32) / 2u32,
                _ => get("delta", quarter())?,
            };
            // T = 4 sqrt(pi/(2 (n+1))) Gamma(y)/Gamma(y + 1/2), y = 1/(n + 1) = 1/(2 + 2 delta).
            let y = real(&(delta.clone() * 2u32 + 2u32).recip());
            let root = (Float::with_val(bits, &pi * &y) / 2u32).sqrt();
            let half = Float::with_val(bits, &y + 0.5f64);
            let scale = a.pow(-real(&delta));
            at.insert("delta".to_owned(), Value::Rational(delta.clone()));
            at.insert("amplitude".to_owned(), amplitude.clone());
            series.insert("amplitude".to_owned(), amplitude);
            (root * 4u32 * y.gamma() / half.gamma() * scale, "gamma functions", delta)
        }
        AmplitudeRole::InSums => {
            let delta = get("delta", Rational::from(1))?;
            if delta != 1 {
                return Err(Error::NoValue);
            }
            let mean = (a / 2u32).cos().agm(&real(&delta));
            at.insert("amplitude".to_owned(), amplitude.clone());
            series.insert("amplitude".to_owned(), amplitude);
            (pi * 2u32 / mean, "2 pi/agm(1, cos(a/2))", delta)
        }
        AmplitudeRole::InSmallParameter => {
            let eps = get("eps", quarter())?;
            let a = get("amplitude", Rational::from(1))?;
            let rho = eps.clone() * &a * &a;
            if rho <= -1 {
                let (name, value) = ("eps".to_owned(), eps.to_string());
                return Err(Error::OutsideDomain { name, value, domain: "eps amplitude^2 > -1" });
            }
            let root = |q: Rational| real(&(q + 1u32)).sqrt();
            let mean = root(rho.clone()).agm(&root(rho.clone() / 2u32));
            at.insert("eps".to_owned(), Value::Rational(eps));
            at.insert("amplitude".to_owned(), Value::Rational(a));
            (pi * 2u32 / mean, "2 pi/agm(sqrt(1 + rho), sqrt(1 + rho/2))", rho)
        }
        AmplitudeRole::Determined => {
            let eps = get("eps", Rational::from(1))?;
            if eps != 1 {
                return Err(Error::NoValue);
            }
            let reference = Float::parse(VAN_DER_POL).map_err(|_| Error::NoValue)?;
            uncertainty = uncertainty.max(VAN_DER_POL_ERROR);
            at.insert("eps".to_owned(), Value::Rational(eps.clone()));
            (Float::with_val(bits, reference), "reference of 98 digits", eps)
        }
        _ => return Err(Error::NoValue),
    };
    Ok(Truth { period, uncertainty, source, at, small, given: series })
}
