//! The plain form of an evaluation.

use crate::digits::Digits;
use crate::displacements::{Displacement, Displacements};
use crate::names::{kind_name, rounded};
use crate::period::Evaluation;
use lindstedt_number::{Number, Status};
use lindstedt_series::resummation::{Complex, Growth, Method, Picture, ResummationError};
use rug::{Float, Integer};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// What one method gave: its error, null where there is none, or why it was refused.
#[derive(Serialize)]
struct Tried {
    resum: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Option<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
}

/// What the coefficients tell.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Coefficients {
    Entire,
    Radius { radius: Option<f64>, error: Option<f64> },
    Factorial { rate: f64 },
    Undecided,
}

#[derive(Serialize)]
struct Truncation<'a> {
    order: usize,
    period: Option<&'a Number>,
}

#[derive(Serialize)]
struct Pole {
    at: [f64; 2],
    residue: [f64; 2],
    doublet: bool,
}

#[derive(Serialize)]
struct Pade {
    poles: Vec<Pole>,
    zeros: Vec<[f64; 2]>,
}

/// The nearest singularity with as many digits as the approximants agree upon.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Real and imaginary part; the conjugate is another one.
    pub at: [String; 2],
    /// The error of both.
    pub error: String,
    /// alpha in (1 - x/x_c)^alpha.
    pub exponent: String,
    /// Its error.
    pub exponent_error: String,
    /// The name of its kind.
    pub kind: &'static str,
    /// Estimated.
    pub status: Status,
}

/// A double for a picture.
fn pair(z: &Complex) -> [f64; 2] {
    [z.re.to_f64(), z.im.to_f64()]
}

fn pade(picture: &Picture) -> Pade {
    let poles = picture.poles.iter();
    let poles = poles.map(|pole| Pole {
        at: pair(&pole.at),
        residue: pair(&pole.residue),
        doublet: pole.doublet,
    });
    Pade { poles: poles.collect(), zeros: picture.zeros.iter().map(pair).collect() }
}

/// One decimal more than the first that is in doubt: what rounding adds is below the error.
fn decimals(error: &Float) -> usize {
    let places = if error.is_zero() { 30.0 } else { 1.0 - error.clone().log10().to_f64() };
    places.floor().clamp(0.0, 30.0) as usize
}

/// The error with that of rounding the value to [`decimals`], rounded up.
fn stated(error: &Float) -> String {
    let rounding = 0.5 * 10f64.powi(-(decimals(error) as i32));
    format!("{:.1e}", (error.to_f64() + rounding) * 1.06)
}

/// A float with as many decimals as its error leaves; 0 within it.
fn fixed(x: &Float, error: &Float) -> String {
    let places = decimals(error);
    if x.clone().abs() <= *error {
        return "0".to_owned();
    }
    let scale = Integer::from(Integer::u_pow_u(10, u32::try_from(places).unwrap_or(30)));
    let shifted = Float::with_val(x.prec() + 128, x * &scale).round();
    let Some(integer) = shifted.to_integer() else { return x.to_string() };
    let digits = format!("{:0>width$}", integer.clone().abs().to_string(), width = places + 1);
    let (whole, fraction) = digits.split_at(digits.len() - places);
    let sign = if integer < 0 { "-" } else { "" };
    if places == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
}

impl Evaluation {
    /// The nearest singularity of the series, where one is stable.
    #[must_use]
    pub fn singularity(&self) -> Option<Place> {
        let found = self.resummed.singularity.as_ref()?;
        Some(Place {
            at: [&found.at.re, &found.at.im].map(|x| fixed(x, &found.error)),
            error: stated(&found.error),
            exponent: fixed(&found.exponent, &found.exponent_error),
            exponent_error: stated(&found.exponent_error),
            kind: kind_name(found.kind),
            status: Status::Estimated,
        })
    }

    fn growth(&self) -> Coefficients {
        match self.resummed.growth {
            Growth::Entire => Coefficients::Entire,
            Growth::Radius { .. } => {
                let found = self.estimated_radius();
                let [radius, error] =
                    found.map_or_else(Default::default, |(radius, error)| rounded(radius, error));
                let double = |text: &str| text.parse::<f64>().ok();
                Coefficients::Radius { radius: double(&radius), error: double(&error) }
            }
            Growth::Factorial { rate } => Coefficients::Factorial { rate },
            _ => Coefficients::Undecided,
        }
    }

    fn all_tried(&self) -> Vec<Tried> {
        let one = |(method, found): &(Method, Result<Float, ResummationError>)| {
            let shown = |error: &Float| error.is_finite().then(|| format!("{error:.2e}"));
            let refused = found.as_ref().err().map(ToString::to_string);
            Tried { resum: method.name(), error: found.as_ref().ok().map(shown), refused }
        };
        self.resummed.tried.iter().map(one).collect()
    }
}

impl Serialize for Evaluation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let method = self.resummed.method.name();
        let best = self.best_truncation.as_ref();
        let best =
            best.map(|(order, number)| Truncation { order: *order, period: number.as_ref() });
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("resum", method)?;
        map.serialize_entry("period", &self.period)?;
        map.serialize_entry("frequency", &self.frequency)?;
        map.serialize_entry("exact_period", &self.exact_period)?;
        if let Some(found) = &self.stability {
            map.serialize_entry("floquet_exponent", &found.floquet_exponent)?;
            map.serialize_entry("stable", &found.stable)?;
        }
        map.serialize_entry("verdict", &self.verdict)?;
        map.serialize_entry("true_error", &self.true_error)?;
        map.serialize_entry("measured_by", &self.measured_by)?;
        map.serialize_entry("asked", self.asked.map_or("auto", |_| method))?;
        let quantity = format!("T/(2*pi) as a series in {}", self.variable);
        map.serialize_entry("quantity", &quantity)?;
        map.serialize_entry("degrees", &self.resummed.outcome.degrees)?;
        map.serialize_entry("tried", &self.all_tried())?;
        map.serialize_entry("coefficients", &self.growth())?;
        map.serialize_entry("best_truncation", &best)?;
        map.serialize_entry("singularity", &self.singularity())?;
        map.serialize_entry("pade", &self.picture.as_ref().map(pade))?;
        map.serialize_entry("solution", &self.solution)?;
        if let Some(improved) = &self.improved {
            map.serialize_entry("improved", improved)?;
        }
        map.end()
    }
}

impl Serialize for Displacement {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.time.to_string())?;
        // Without a digit that the estimate supports there is no decimal to print.
        map.serialize_entry("x", &Digits::of(self.value.as_ref()))?;
        map.end()
    }
}

impl Serialize for Displacements {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("order", &self.order)?;
        map.serialize_entry("resum", &self.summed_by())?;
        map.serialize_entry("values", &self.points)?;
        map.end()
    }
}
