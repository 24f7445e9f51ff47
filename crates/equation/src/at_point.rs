//! Expressions in one unknown as floats.

use crate::{Expression, Function, Operations, Unknown};
use rug::float::Constant;
use rug::ops::Pow;
use rug::{Float, Rational};
use std::collections::BTreeMap;

impl Expression {
    /// The value of an expression in x or x' alone, without delay, where this is w and the parameters
    /// have these values and pi its own: in floats of the precision of w, rounded at every operation.
    /// Nothing where something else occurs.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let value = Expression::DISPLACEMENT.pow(3).at_point(&rug::Float::with_val(53, 2), &[].into());
    /// assert_eq!(value.map(|v| v.to_f64()), Some(8.0));
    /// ```
    pub fn at_point(&self, w: &Float, values: &BTreeMap<String, Rational>) -> Option<Float> {
        self.evaluate(&mut At { w, values })
    }
}

/// Values at one w, which x' or x stands for.
struct At<'a> {
    w: &'a Float,
    values: &'a BTreeMap<String, Rational>,
}

impl Operations for At<'_> {
    type Value = Float;

    fn number(&mut self, q: &Rational) -> Option<Float> {
        Some(Float::with_val(self.w.prec(), q))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Float> {
        match leaf {
            Expression::Parameter(name) => match self.values.get(name) {
                Some(value) => self.number(value),
                None => (name == "pi").then(|| Float::with_val(self.w.prec(), Constant::Pi)),
            },
            Expression::Unknown(Unknown { derivative: 0 | 1, delay: None, .. }) => {
                Some(self.w.clone())
            }
            _ => None,
        }
    }

    fn add(&mut self, a: Float, b: Float) -> Option<Float> {
        Some(a + b)
    }

    fn multiply(&mut self, a: Float, b: Float) -> Option<Float> {
        Some(a * b)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Float> {
        let value = base.evaluate(self)?;
        Some(match exponent.as_number() {
            Some(n) if n.is_integer() => value.pow(n.numer().to_i32()?),
            _ => value.pow(exponent.evaluate(self)?),
        })
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Float> {
        let z = argument.evaluate(self)?;
        Some(match function {
            Function::Ln => z.ln(),
            Function::Exp => z.exp(),
            Function::Sin => z.sin(),
            Function::Cos => z.cos(),
            Function::Abs => z.abs(),
            Function::Sign if z.is_zero() => z,
            Function::Sign => z.signum(),
        })
    }
}
