//! Values: of parameters as they were given, of expressions in them, of enclosures as numbers.

use super::Coefficient;
use crate::{Error, Exact, Number};
use lindstedt_algebra::RationalAlgebra;
use lindstedt_equation::Expression;
use lindstedt_number::ball::{Ball, Balls};
use std::collections::BTreeSet;

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

pub(super) fn collect(expression: &Expression, names: &mut BTreeSet<String>) {
    match expression {
        Expression::Parameter(name) => {
            names.insert(name.clone());
        }
        Expression::Sum(list) | Expression::Product(list) => {
            list.iter().for_each(|inner| collect(inner, names));
        }
        Expression::Power(a, b) | Expression::Delayed(a, b) => {
            collect(a, names);
            collect(b, names);
        }
        Expression::Function(_, inner) | Expression::Formal(_, inner) => collect(inner, names),
        _ => {}
    }
}

/// The value of an expression in numbers and parameters.
pub(super) fn constant<K: RationalAlgebra>(
    ring: &K,
    expression: &Expression,
    values: &dyn Fn(&str) -> Option<K::Element>,
) -> Option<K::Element> {
    let value = |inner: &Expression| constant(ring, inner, values);
    match expression {
        Expression::Number(q) => Some(ring.rational(q)),
        Expression::Parameter(name) => values(name),
        Expression::Sum(list) => {
            list.iter().try_fold(ring.zero(), |sum, inner| Some(ring.add(&sum, &value(inner)?)))
        }
        Expression::Product(list) => list
            .iter()
            .try_fold(ring.one(), |product, inner| Some(ring.mul(&product, &value(inner)?))),
        Expression::Power(base, exponent) => {
            let Expression::Number(n) = &**exponent else { return None };
            let n = n.is_integer().then(|| n.numer().to_i32()).flatten()?;
            let base = value(base)?;
            let base = if n < 0 { ring.reciprocal(&base)? } else { base };
            (n.unsigned_abs() <= 1000)
                .then(|| lindstedt_coeff::polynomial::power(ring, &base, n.unsigned_abs()))
        }
        _ => None,
    }
}
