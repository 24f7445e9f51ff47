//! Names of methods and singularities, and doubles with their errors, in words.

use lindstedt_series::resummation::{Kind, Method};
use rug::Float;

pub(crate) fn short(x: &Float) -> String {
    if x.is_zero() { "0".to_owned() } else { format!("{:.1e}", Float::with_val(53, x)) }
}

/// A double with the digits that its error leaves, and the error rounded up to one digit.
#[must_use]
pub fn with_error(value: f64, error: f64) -> String {
    let [value, error] = rounded(value, error);
    format!("{value} +- {error}")
}

/// A double to the place of the first digit of its error, and the error rounded up to that digit.
#[must_use]
pub fn rounded(value: f64, error: f64) -> [String; 2] {
    let least = value.abs().max(f64::MIN_POSITIVE) * f64::EPSILON;
    let error = error.abs().max(least);
    let exponent = error.log10().floor();
    let unit = 10f64.powi(exponent as i32);
    let error = (error / unit * (1.0 - 1e-9)).ceil() * unit;
    let size = value.abs().max(error);
    if exponent > 0.0 || !(1e-4..1e6).contains(&size) {
        let digits = (size.log10().floor() - exponent).clamp(0.0, 17.0) as usize;
        return [format!("{value:.digits$e}"), format!("{error:.0e}")];
    }
    let places = (-exponent).clamp(0.0, 17.0) as usize;
    let error = if exponent < -4.0 { format!("{error:.0e}") } else { format!("{error:.places$}") };
    [format!("{value:.places$}"), error]
}

/// The name of a method in words.
#[must_use]
pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::PartialSum => "partial sum",
        Method::Pade => "Pade",
        Method::Uniform => "uniform (series in u)",
        Method::UniformPade => "Pade in u",
        Method::ConformalPade => "conformal map and Pade",
        Method::BorelPade => "Borel and Pade",
        _ => "another method",
    }
}

/// The name of a kind of singularity.
#[must_use]
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Pole => "pole",
        Kind::SquareRoot => "square root",
        Kind::InverseSquareRoot => "inverse square root",
        Kind::Logarithm => "logarithm",
        _ => "power",
    }
}
