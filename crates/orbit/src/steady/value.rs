//! Values of parameters.

use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::interval::Interval;
use rug::Rational;

/// Bits of the values that are enclosed.
const BITS: u32 = 80;

/// The value of a parameter: exact where it is a rational number.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A rational number.
    Rational(Rational),
    /// What contains it.
    Within(Interval),
}

impl Value {
    /// An enclosure.
    #[must_use]
    pub fn interval(&self) -> Interval {
        match self {
            Self::Rational(q) => Interval::of(q),
            Self::Within(interval) => *interval,
        }
    }
    /// The number, if it is rational.
    #[must_use]
    pub fn as_rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(q) => Some(q),
            Self::Within(_) => None,
        }
    }
}

impl From<&Exact> for Value {
    fn from(exact: &Exact) -> Self {
        match exact.as_rational() {
            Some(q) => Self::Rational(q.clone()),
            None => Self::from(&exact.ball(Balls::new(BITS))),
        }
    }
}

impl From<&Ball> for Value {
    fn from(ball: &Ball) -> Self {
        Self::Within(Interval::of_ball(ball))
    }
}
