//! Exact values of parameters, as a user writes them.

use crate::Error;
use lindstedt_number::ball::{Ball, Balls};
use rug::ops::Pow;
use rug::{Integer, Rational};

/// An exact real number: a rational number or a rational multiple of pi.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// A rational number.
    Rational(Rational),
    /// A rational multiple of pi.
    PiTimes(Rational),
}

/// Decimal exponents beyond this are refused: nothing in the engine needs them, and an exact
/// 1e999999999 would fill the memory.
const LARGEST_EXPONENT: u32 = 100_000;

impl Value {
    /// Reads `3`, `-1/3`, `0.1` (= 1/10), `2.5e-3`, `pi`, `pi/4`, `2*pi/3`, `-3/2*pi`.
    ///
    /// # Errors
    /// [`Error::BadValue`] for anything else, NaN and infinities included.
    ///
    /// ```
    /// use lindstedt::Value;
    /// use rug::Rational;
    /// assert_eq!(Value::parse("2.5e-3"), Ok(Value::Rational(Rational::from((1, 400)))));
    /// assert_eq!(Value::parse("2*pi/3"), Ok(Value::PiTimes(Rational::from((2, 3)))));
    /// assert!(Value::parse("nan").is_err());
    /// ```
    pub fn parse(text: &str) -> Result<Self, Error> {
        let bad = || Error::BadValue { text: text.chars().take(80).collect() };
        let mut factor = Rational::from(1);
        let mut pi = 0u32;
        let mut divide = false;
        let trimmed = text.trim();
        let (negative, body) = match trimmed.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, trimmed),
        };
        let mut rest = body;
        loop {
            let end = rest.find(['*', '/']).unwrap_or(rest.len());
            let (token, tail) = rest.split_at(end);
            if token.trim() == "pi" && !divide {
                pi += 1;
            } else {
                let number = decimal(token.trim()).ok_or_else(bad)?;
                if divide {
                    if number.is_zero() {
                        return Err(bad());
                    }
                    factor /= number;
                } else {
                    factor *= number;
                }
            }
            let Some(operator) = tail.chars().next() else { break };
            divide = operator == '/';
            rest = &tail[1..];
        }
        if negative {
            factor = -factor;
        }
        match pi {
            0 => Ok(Self::Rational(factor)),
            1 => Ok(Self::PiTimes(factor)),
            _ => Err(bad()),
        }
    }

    /// The value as a ball.
    pub fn ball(&self, balls: Balls) -> Ball {
        match self {
            Self::Rational(q) => balls.from_rational(q),
            Self::PiTimes(q) => balls.mul_rational(&balls.pi(), q),
        }
    }

    /// The rational number, if it is one.
    pub fn as_rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(q) => Some(q),
            Self::PiTimes(_) => None,
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rational(q) => write!(f, "{q}"),
            Self::PiTimes(q) if *q == 1 => write!(f, "pi"),
            Self::PiTimes(q) => write!(f, "{q}*pi"),
        }
    }
}

/// A decimal number with optional exponent, without sign, exactly.
fn decimal(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: String = [whole, fraction].concat();
    let is_digit = |c: char| c.is_ascii_digit();
    if digits.is_empty() || !digits.chars().all(is_digit) || digits.len() > 1_000_000 {
        return None;
    }
    let places = i64::from(exponent) - i64::try_from(fraction.len()).ok()?;
    let power = u32::try_from(places.unsigned_abs()).ok().filter(|&p| p <= LARGEST_EXPONENT)?;
    let scale = Integer::from(10).pow(power);
    let number = Rational::from(digits.parse::<Integer>().ok()?);
    Some(if places >= 0 { number * scale } else { number / scale })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_exact() {
        let q = |n, d| Ok(Value::Rational(Rational::from((n, d))));
        assert_eq!(Value::parse("1/3"), q(1, 3));
        assert_eq!(Value::parse("0.1"), q(1, 10));
        assert_eq!(Value::parse("-.5"), q(-1, 2));
        assert_eq!(Value::parse("2.5e-3"), q(1, 400));
        assert_eq!(Value::parse(" -3/2*pi "), Ok(Value::PiTimes(Rational::from((-3, 2)))));
        assert_eq!(Value::parse("pi"), Ok(Value::PiTimes(Rational::from(1))));
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "-",
            "nan",
            "inf",
            "1/0",
            "1e",
            "e5",
            "1..2",
            "pi*pi",
            "2/pi",
            "1e999999999",
            "--1",
            "1 2",
            "0x10",
            "\u{664}",
            "1/",
            "*2",
            "1e-99999999999999999999",
        ] {
            assert!(Value::parse(text).is_err(), "{text:?}");
        }
    }
}
