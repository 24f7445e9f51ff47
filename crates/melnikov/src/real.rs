//! Exact real parameters.

use crate::MelnikovError;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::cmp::Ordering;
use std::fmt;

/// An exact real number as a user writes it: `1/3`, `0.1`, `pi/4`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Real {
    /// A rational number.
    Rational(Rational),
    /// A nonzero rational multiple of pi.
    PiMultiple(Rational),
}

impl Real {
    /// q pi (the rational number 0 for q = 0).
    #[must_use]
    pub fn pi_multiple(q: Rational) -> Self {
        if q.is_zero() { Self::Rational(q) } else { Self::PiMultiple(q) }
    }
    /// The rational number that x is.
    ///
    /// # Errors
    /// [`MelnikovError::NotFinite`] under the given name.
    pub fn from_f64(x: f64, name: &'static str) -> Result<Self, MelnikovError> {
        let q = Rational::from_f64(x).ok_or(MelnikovError::NotFinite { name })?;
        Ok(Self::Rational(q))
    }
    /// An enclosure.
    #[must_use]
    pub fn ball(&self, balls: Balls) -> Ball {
        match self {
            Self::Rational(q) => balls.from_rational(q),
            Self::PiMultiple(q) => balls.mul_rational(&balls.pi(), q),
        }
    }
    /// The rational number, if it is one.
    #[must_use]
    pub fn as_rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(q) => Some(q),
            Self::PiMultiple(_) => None,
        }
    }
    /// The sign, exactly.
    #[must_use]
    pub fn sign(&self) -> Ordering {
        match self {
            Self::Rational(q) | Self::PiMultiple(q) => q.cmp0(),
        }
    }
    /// |x|.
    #[must_use]
    pub fn abs(&self) -> Self {
        match self {
            Self::Rational(q) => Self::Rational(Rational::from(q.abs_ref())),
            Self::PiMultiple(q) => Self::PiMultiple(Rational::from(q.abs_ref())),
        }
    }
    /// -x.
    #[must_use]
    pub fn neg(&self) -> Self {
        match self {
            Self::Rational(q) => Self::Rational(Rational::from(-q)),
            Self::PiMultiple(q) => Self::PiMultiple(Rational::from(-q)),
        }
    }
    /// The nearest double (within 1 ulp for multiples of pi).
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        self.ball(Balls::new(120)).midpoint().to_f64()
    }
    pub(crate) fn positive(&self, name: &'static str) -> Result<(), MelnikovError> {
        match self.sign() {
            Ordering::Greater => Ok(()),
            _ => Err(MelnikovError::NotPositive { name }),
        }
    }
}

impl From<Rational> for Real {
    fn from(q: Rational) -> Self {
        Self::Rational(q)
    }
}

impl From<i32> for Real {
    fn from(n: i32) -> Self {
        Self::Rational(Rational::from(n))
    }
}

impl From<(i32, u32)> for Real {
    /// n/d; a denominator of 0 is read as 1.
    fn from((n, d): (i32, u32)) -> Self {
        Self::Rational(Rational::from((n, d.max(1))))
    }
}

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rational(q) => write!(f, "{q}"),
            Self::PiMultiple(q) if *q == 1 => write!(f, "pi"),
            Self::PiMultiple(q) => write!(f, "{q} pi"),
        }
    }
}
