//! Values: of parameters as they were given, of expressions in them, of enclosures as numbers.

use super::Coefficient;
use crate::error::DerivationError as Error;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_equation::{Expression, Function, Operations};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number};
use rug::Rational;

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

/// The ring of the coefficients, with the values of parameters in it.
struct Constants<'a, K: RationalAlgebra> {
    ring: &'a K,
    values: &'a dyn Fn(&str) -> Option<K::Element>,
}

impl<K: RationalAlgebra> Operations for Constants<'_, K> {
    type Value = K::Element;

    fn number(&mut self, q: &Rational) -> Option<K::Element> {
        Some(self.ring.rational(q))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<K::Element> {
        let Expression::Parameter(name) = leaf else { return None };
        (self.values)(name)
    }

    fn add(&mut self, a: K::Element, b: K::Element) -> Option<K::Element> {
        Some(self.ring.add(&a, &b))
    }

    fn multiply(&mut self, a: K::Element, b: K::Element) -> Option<K::Element> {
        Some(self.ring.mul(&a, &b))
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<K::Element> {
        let Expression::Number(n) = exponent else { return None };
        let n = n.is_integer().then(|| n.numer().to_i32()).flatten()?;
        let base = base.evaluate(self)?;
        let base = if n < 0 { self.ring.reciprocal(&base)? } else { base };
        (n.unsigned_abs() <= 1000)
            .then(|| lindstedt_coeff::polynomial::power(self.ring, &base, n.unsigned_abs()))
    }

    fn function(&mut self, _: Function, _: &Expression) -> Option<K::Element> {
        None
    }
}

/// The value of an expression in numbers and parameters.
pub(crate) fn constant<K: RationalAlgebra>(
    ring: &K,
    expression: &Expression,
    values: &dyn Fn(&str) -> Option<K::Element>,
) -> Option<K::Element> {
    expression.evaluate(&mut Constants { ring, values })
}
