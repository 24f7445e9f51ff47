//! Exact real numbers, as a user writes them.

use crate::NumberError;
use crate::ball::{Ball, Balls};
use rug::float::Constant;
use rug::ops::Pow;
use rug::{Float, Integer, Rational};
use serde::{Serialize, Serializer};
use std::cmp::Ordering;
use std::fmt;
use std::ops::Neg;
use std::str::FromStr;

/// An exact real number: q, q pi, or a square root of a rational number.
///
/// Zero is [`Exact::Rational`]; the functions of this type keep that, and the square root of a
/// square is rational. So equal numbers are equal as data.
///
/// ```
/// use lindstedt_number::Exact;
/// use rug::Rational;
///
/// let angle: Exact = "-3/2*pi".parse()?;
/// assert_eq!(angle, Exact::PiTimes(Rational::from((-3, 2))));
/// assert_eq!("2.5e-3".parse(), Ok(Exact::from((1, 400))));
/// assert_eq!(angle.times(&Rational::from((2, 3))).to_string(), "-1*pi");
/// assert!(angle < Exact::from(-4) && Exact::root(Rational::from(2)) < Exact::from((3, 2)));
/// # Ok::<(), lindstedt_number::NumberError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Exact {
    /// A rational number.
    Rational(Rational),
    /// A rational multiple of pi.
    PiTimes(Rational),
    /// sign(q) sqrt |q|. It comes out of exact solutions and is not read from text.
    Root(Rational),
}

/// Decimal exponents beyond this are refused: nothing in the engine needs them, and an exact
/// 1e999999999 would fill the memory.
const LARGEST_EXPONENT: u32 = 100_000;
/// Digits of one number beyond this are refused.
const MOST_DIGITS: usize = 1_000_000;
/// The precision of the first comparison with pi; it is doubled until the order is decided.
const FIRST_BITS: u32 = 64;

impl Exact {
    /// Reads `3`, `-1/3`, `0.1` (= 1/10), `2.5e-3`, `pi`, `pi/4`, `2*pi/3`, `-3/2*pi`.
    ///
    /// # Errors
    /// [`NumberError::BadValue`] for anything else, NaN and infinities included.
    pub fn parse(text: &str) -> Result<Self, NumberError> {
        Self::read(text.trim())
            .ok_or_else(|| NumberError::BadValue { text: text.chars().take(80).collect() })
    }

    fn read(text: &str) -> Option<Self> {
        let (negative, mut rest) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text),
        };
        let mut factor = Rational::from(1);
        let mut pi = 0u32;
        let mut divide = false;
        loop {
            let end = rest.find(['*', '/']).unwrap_or(rest.len());
            let (token, tail) = rest.split_at(end);
            match (token.trim(), divide) {
                ("pi", false) => pi += 1,
                (token, false) => factor *= decimal(token)?,
                (token, true) => factor /= decimal(token).filter(|q| !q.is_zero())?,
            }
            let Some(operator) = tail.chars().next() else { break };
            divide = operator == '/';
            rest = &tail[1..];
        }
        if negative {
            factor = -factor;
        }
        match pi {
            0 => Some(Self::Rational(factor)),
            1 => Some(Self::pi_times(factor)),
            _ => None,
        }
    }

    /// q pi.
    #[must_use]
    pub fn pi_times(q: Rational) -> Self {
        if q.is_zero() { Self::Rational(q) } else { Self::PiTimes(q) }
    }

    /// sign(q) sqrt |q|, rational where it is.
    #[must_use]
    pub fn root(q: Rational) -> Self {
        let numerator = Integer::from(q.numer().abs_ref());
        if !(numerator.is_perfect_square() && q.denom().is_perfect_square()) {
            return Self::Root(q);
        }
        let size = Rational::from((numerator.sqrt(), Integer::from(q.denom().sqrt_ref())));
        Self::Rational(if q < 0 { -size } else { size })
    }

    /// The rational number that x is; nothing for NaN and infinities.
    #[must_use]
    pub fn from_f64(x: f64) -> Option<Self> {
        Rational::from_f64(x).map(Self::Rational)
    }

    /// The value as a ball.
    #[must_use]
    pub fn ball(&self, balls: Balls) -> Ball {
        match self {
            Self::Rational(q) => balls.from_rational(q),
            Self::PiTimes(q) => balls.mul_rational(&balls.pi(), q),
            Self::Root(q) => {
                let size = balls.from_rational(&Rational::from(q.abs_ref()));
                let root = balls.sqrt(&size).unwrap_or_else(|| balls.indeterminate());
                if *q < 0 { balls.neg(&root) } else { root }
            }
        }
    }

    /// The value as a float of `bits` bits, within one unit in the last place.
    #[must_use]
    pub fn float(&self, bits: u32) -> Float {
        match self {
            Self::Rational(q) => Float::with_val(bits, q),
            Self::PiTimes(q) => Float::with_val(bits, Constant::Pi) * q,
            Self::Root(_) => {
                let wide = self.ball(Balls::new(bits.saturating_add(32)));
                Float::with_val(bits, wide.midpoint())
            }
        }
    }

    /// The nearest double (within 1 ulp where the number is irrational).
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        self.ball(Balls::new(120)).midpoint().to_f64()
    }

    /// The rational number, if it is one.
    #[must_use]
    pub fn as_rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(q) => Some(q),
            Self::PiTimes(_) | Self::Root(_) => None,
        }
    }

    /// The sign, exactly.
    #[must_use]
    pub fn sign(&self) -> Ordering {
        match self {
            Self::Rational(q) | Self::PiTimes(q) | Self::Root(q) => q.cmp0(),
        }
    }

    /// |x|.
    #[must_use]
    pub fn abs(&self) -> Self {
        if self.sign().is_lt() { -self } else { self.clone() }
    }

    /// q x.
    #[must_use]
    pub fn times(&self, q: &Rational) -> Self {
        match self {
            _ if q.is_zero() => Self::Rational(Rational::new()),
            Self::Rational(x) => Self::Rational(Rational::from(x * q)),
            Self::PiTimes(x) => Self::PiTimes(Rational::from(x * q)),
            Self::Root(x) => Self::Root(Rational::from(x * q) * Rational::from(q.abs_ref())),
        }
    }

    /// x/y, where it is rational and y is not 0.
    #[must_use]
    pub fn ratio(&self, other: &Self) -> Option<Rational> {
        match (self, other) {
            (_, other) if other.sign().is_eq() => None,
            (Self::Rational(x), Self::Rational(y)) | (Self::PiTimes(x), Self::PiTimes(y)) => {
                Some(Rational::from(x / y))
            }
            (Self::Root(x), Self::Root(y)) => {
                // The sign of x/y is that of the quotient.
                Self::root(Rational::from(x / y)).as_rational().cloned()
            }
            (x, _) if x.sign().is_eq() => Some(Rational::new()),
            _ => None,
        }
    }
}

impl Neg for &Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        match self {
            Exact::Rational(q) => Exact::Rational(Rational::from(-q)),
            Exact::PiTimes(q) => Exact::PiTimes(Rational::from(-q)),
            Exact::Root(q) => Exact::Root(Rational::from(-q)),
        }
    }
}

impl Ord for Exact {
    /// Decided: numbers of one kind, and rational numbers and roots, are compared exactly; pi is
    /// transcendental, so a nonzero multiple of it differs from the others at some precision.
    fn cmp(&self, other: &Self) -> Ordering {
        // x |x|, of a rational number or a root: it grows with x.
        let square = |x: &Self| match x {
            Self::Rational(q) => Some(q * Rational::from(q.abs_ref())),
            Self::Root(q) => Some(q.clone()),
            Self::PiTimes(_) => None,
        };
        match (self, other) {
            (x, y) if x.sign() != y.sign() || x.sign().is_eq() => x.sign().cmp(&y.sign()),
            (Self::Rational(x), Self::Rational(y)) | (Self::PiTimes(x), Self::PiTimes(y)) => {
                x.cmp(y)
            }
            (x, y) => match (square(x), square(y)) {
                (Some(x), Some(y)) => x.cmp(&y),
                _ => x.compare_at_some_precision(y),
            },
        }
    }
}

impl Exact {
    fn compare_at_some_precision(&self, other: &Self) -> Ordering {
        let mut bits = FIRST_BITS;
        loop {
            let balls = Balls::new(bits);
            let difference = balls.sub(&self.ball(balls), &other.ball(balls));
            if difference.is_positive() {
                return Ordering::Greater;
            }
            if difference.is_negative() {
                return Ordering::Less;
            }
            if balls.bits() < bits {
                // The largest precision there is: only numbers of ten million digits come here.
                return Ordering::Equal;
            }
            bits = bits.saturating_mul(2);
        }
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl FromStr for Exact {
    type Err = NumberError;

    fn from_str(text: &str) -> Result<Self, NumberError> {
        Self::parse(text)
    }
}

impl fmt::Display for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rational(q) => write!(f, "{q}"),
            Self::PiTimes(q) if *q == 1 => write!(f, "pi"),
            Self::PiTimes(q) => write!(f, "{q}*pi"),
            Self::Root(q) if *q < 0 => write!(f, "-sqrt({})", Rational::from(q.abs_ref())),
            Self::Root(q) => write!(f, "sqrt({q})"),
        }
    }
}

impl Serialize for Exact {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl From<Rational> for Exact {
    fn from(q: Rational) -> Self {
        Self::Rational(q)
    }
}

impl From<i64> for Exact {
    fn from(n: i64) -> Self {
        Self::Rational(Rational::from(n))
    }
}

impl From<i32> for Exact {
    fn from(n: i32) -> Self {
        Self::Rational(Rational::from(n))
    }
}

impl From<(i32, u32)> for Exact {
    /// n/d; a denominator of 0 is read as 1.
    fn from((n, d): (i32, u32)) -> Self {
        Self::Rational(Rational::from((n, d.max(1))))
    }
}

/// A decimal number with optional exponent of ten, without sign, exactly: `12`, `.5`, `2.5e-3`.
/// Nothing for other text, for more than 10^6 digits or an exponent beyond 10^5.
#[must_use]
pub fn decimal(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: String = [whole, fraction].concat();
    let is_digit = |c: char| c.is_ascii_digit();
    if digits.is_empty() || !digits.chars().all(is_digit) || digits.len() > MOST_DIGITS {
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
        let q = |n, d| Ok(Exact::Rational(Rational::from((n, d))));
        let pi = |n, d| Ok(Exact::PiTimes(Rational::from((n, d))));
        let table = [
            ("1/3", q(1, 3)),
            ("0.1", q(1, 10)),
            ("-.5", q(-1, 2)),
            ("2.5e-3", q(1, 400)),
            ("1.e+2", q(100, 1)),
            (" -3/2*pi ", pi(-3, 2)),
            ("3 * pi / 4", pi(3, 4)),
            ("pi", pi(1, 1)),
            ("-pi/4", pi(-1, 4)),
            ("0*pi", q(0, 1)),
        ];
        for (text, value) in table {
            assert_eq!(Exact::parse(text), value, "{text}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let nonsense = [
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
            "2pi",
            "pi/0",
            "+",
        ];
        for text in nonsense {
            assert!(Exact::parse(text).is_err(), "{text:?}");
        }
    }

    /// What is written is read back as the same number.
    #[test]
    fn text_is_read_back() {
        for text in ["0", "-7", "22/7", "pi", "-1*pi", "355/113*pi"] {
            assert_eq!(Exact::parse(text).map(|x| x.to_string()).as_deref(), Ok(text));
        }
    }

    /// Order and operations against balls, over all pairs of kinds.
    #[test]
    fn order_and_operations() {
        let balls = Balls::new(300);
        let q = |n, d| Rational::from((n, d));
        let all = [
            Exact::from(0),
            Exact::from((22, 7)),
            Exact::from((-7, 5)),
            Exact::pi_times(q(1, 1)),
            Exact::pi_times(q(-4, 9)),
            Exact::root(q(2, 1)),
            Exact::root(q(-2, 1)),
            Exact::root(q(987, 100)),
            Exact::root(q(18, 1)),
        ];
        for a in &all {
            for b in &all {
                let difference = balls.sub(&a.ball(balls), &b.ball(balls));
                let order = a.cmp(b);
                assert_eq!(difference.is_positive(), order.is_gt(), "{a} {b}");
                assert_eq!(difference.is_negative(), order.is_lt(), "{a} {b}");
                if let Some(ratio) = a.ratio(b) {
                    assert_eq!(b.times(&ratio), *a, "{a} {b}");
                }
            }
            let scaled = a.times(&q(-3, 4)).ball(balls);
            let expected = balls.mul_rational(&a.ball(balls), &q(-3, 4));
            assert!(scaled.overlaps(&expected), "{a}");
            assert!((a.float(100) - a.ball(balls).midpoint()).abs() < 1e-28);
            assert!(!a.abs().sign().is_lt() && a.abs() >= *a && a.abs() >= -a);
        }
        assert_eq!(Exact::root(q(4, 9)), Exact::from((2, 3)));
        assert_eq!(Exact::root(q(-4, 9)), Exact::from((-2, 3)));
        assert_eq!(all[8].ratio(&all[6]), Some(q(-3, 1)));
    }

    #[test]
    fn order_ratio_and_words() {
        let of = |text: &str| Exact::parse(text).unwrap();
        let root = |q: i32| Exact::root(Rational::from(q));
        // 333/106 < pi < 355/113, both sides of zero; sqrt(2) beside its convergents.
        let rising = [
            of("-355/113"),
            of("-pi"),
            of("-333/106"),
            root(-2),
            of("0"),
            of("pi/4"),
            of("7/5"),
            root(2),
            of("17/12"),
            of("333/106"),
            of("pi"),
            of("355/113"),
            root(10),
        ];
        for (i, x) in rising.iter().enumerate() {
            for (j, y) in rising.iter().enumerate() {
                assert_eq!(x.cmp(y), i.cmp(&j), "{x} {y}");
            }
        }
        assert_eq!((root(9), root(-4)), (of("3"), of("-2")));
        let words = [of("1/2"), of("pi"), of("3/4*pi"), root(2), root(-2)].map(|x| x.to_string());
        assert_eq!(words, ["1/2", "pi", "3/4*pi", "sqrt(2)", "-sqrt(2)"]);
        assert_eq!(root(-2).to_f64(), -std::f64::consts::SQRT_2);
        assert_eq!((of("pi").to_f64(), of("0.1").to_f64()), (std::f64::consts::PI, 0.1));
        assert_eq!(Exact::from_f64(0.375), Some(of("3/8")));
        assert_eq!(Exact::from_f64(f64::NAN), None);
        let q = |n: i32, d: i32| Some(Rational::from((n, d)));
        assert_eq!(of("3").ratio(&of("4")), q(3, 4));
        assert_eq!(of("3*pi").ratio(&of("4*pi")), q(3, 4));
        assert_eq!(root(-8).ratio(&root(2)), q(-2, 1));
        assert_eq!((of("0").ratio(&of("pi")), of("1").ratio(&of("pi"))), (q(0, 1), None));
        assert_eq!((of("1").ratio(&of("0")), root(2).ratio(&root(3))), (None, None));
    }
}
