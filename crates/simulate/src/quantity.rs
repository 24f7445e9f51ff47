//! Values of parameters, exact where they can be.

use rug::float::Constant;
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Quantity {
    /// A rational number.
    Rational(Rational),
    /// A rational multiple of pi.
    PiMultiple(Rational),
    /// A float; the caller is responsible for its having enough digits.
    Float(Float),
}

impl Quantity {
    /// Reads `3`, `-0.25`, `2.5e-3`, `1/3`, `pi`, `2*pi`, `pi/4`, `2/3*pi`, `3*pi/4`; nothing for
    /// other text.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let Some((before, after)) = compact.split_once("pi") else {
            return fraction(&compact).map(Self::Rational);
        };
        let factor = match before {
            "" | "+" => Rational::from(1),
            "-" => Rational::from(-1),
            other => fraction(other.strip_suffix('*')?)?,
        };
        let divisor = match after {
            "" => Rational::from(1),
            other => decimal(other.strip_prefix('/')?)?,
        };
        (divisor.cmp0().is_ne()).then(|| Self::PiMultiple(factor / divisor))
    }

    /// The rational, if it is one.
    #[must_use]
    pub fn rational(&self) -> Option<Rational> {
        match self {
            Self::Rational(q) => Some(q.clone()),
            Self::PiMultiple(q) => q.is_zero().then(Rational::new),
            Self::Float(_) => None,
        }
    }

    /// The value as a float of `bits` bits, within one unit in the last place.
    #[must_use]
    pub fn float(&self, bits: u32) -> Float {
        match self {
            Self::Rational(q) => Float::with_val(bits, q),
            Self::PiMultiple(q) => Float::with_val(bits, Constant::Pi) * q,
            Self::Float(x) => Float::with_val(bits, x),
        }
    }
}

impl From<i64> for Quantity {
    fn from(n: i64) -> Self {
        Self::Rational(Rational::from(n))
    }
}

impl From<Rational> for Quantity {
    fn from(q: Rational) -> Self {
        Self::Rational(q)
    }
}

impl From<Float> for Quantity {
    fn from(x: Float) -> Self {
        Self::Float(x)
    }
}

/// `a` or `a/b` with decimals a, b.
fn fraction(text: &str) -> Option<Rational> {
    let Some((above, below)) = text.split_once('/') else { return decimal(text) };
    let below = decimal(below)?;
    let above = decimal(above)?;
    (below.cmp0().is_ne()).then(|| above / below)
}

/// A decimal number with an optional exponent (at most 10 000), exactly.
fn decimal(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let places = i32::try_from(decimals.len()).ok()?;
    let power = exponent.checked_sub(places)?;
    let digits = format!("{whole}{decimals}");
    let valid = digits.trim_start_matches(['+', '-']);
    if valid.is_empty() || !valid.bytes().all(|b| b.is_ascii_digit()) || power.abs() > 10_000 {
        return None;
    }
    let integer = rug::Integer::from_str_radix(digits.strip_prefix('+').unwrap_or(&digits), 10);
    let ten = Rational::from(10);
    Some(Rational::from(integer.ok()?) * rug::ops::Pow::pow(ten, power))
}

/// The values of the parameters of an equation, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    values: BTreeMap<String, Quantity>,
}

impl Parameters {
    /// No values.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more value (or another one).
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Quantity>) -> Self {
        self.set(name, value);
        self
    }

    /// Sets a value.
    pub fn set(&mut self, name: &str, value: impl Into<Quantity>) {
        self.values.insert(name.to_owned(), value.into());
    }

    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Quantity> {
        self.values.get(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_exactly() {
        let q = |p: i64, q: i64| Rational::from((p, q));
        let rational = |p, r| Some(Quantity::Rational(q(p, r)));
        let multiple = |p, r| Some(Quantity::PiMultiple(q(p, r)));
        for (text, value) in [
            ("3", rational(3, 1)),
            ("-0.25", rational(-1, 4)),
            ("2.5e-3", rational(1, 400)),
            (".5", rational(1, 2)),
            ("+1.e2", rational(100, 1)),
            ("1/3", rational(1, 3)),
            ("pi", multiple(1, 1)),
            ("-pi/4", multiple(-1, 4)),
            ("3 * pi / 4", multiple(3, 4)),
            ("2/3*pi", multiple(2, 3)),
            ("", None),
            ("-", None),
            ("1/0", None),
            ("pi/0", None),
            ("x", None),
            ("1e999999", None),
            ("2pi", None),
        ] {
            assert_eq!(Quantity::parse(text), value, "{text}");
        }
    }
}
