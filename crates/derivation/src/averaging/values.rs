//! Values: of parameters as they were given, of enclosures as numbers.

use super::Coefficient;
use crate::error::DerivationError as Error;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number};

/// A number from its enclosure: all digits are certain, or it is zero to twice the digits.
pub(super) fn enclosed(ball: &Ball, digits: usize, bits: u32) -> Result<Coefficient, Error> {
    let number = Number::of_all_digits(ball, digits);
    number.map(Coefficient::Number).ok_or(Error::NotEnoughBits { bits, best: None })
}

/// A value as it was given, or a delay of k periods.
pub(super) enum Given {
    Value(Exact),
    Period(Exact, Exact),
}

impl Given {
    pub(super) fn ball(&self, balls: Balls) -> Option<Ball> {
        match self {
            Self::Value(value) => Some(value.ball(balls)),
            Self::Period(periods, frequency) => {
                let angle = balls.mul(&balls.mul_i64(&balls.pi(), 2), &periods.ball(balls));
                balls.div(&angle, &frequency.ball(balls))
            }
        }
    }
}
