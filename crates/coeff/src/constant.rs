//! Expressions in numbers and parameters as elements of a ring.

use crate::polynomial::power;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_equation::{Expression, Function, Operations};
use rug::Rational;

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
        let n = exponent.as_number().filter(Rational::is_integer)?.numer().to_i32()?;
        let base = base.evaluate(self)?;
        let base = if n < 0 { self.ring.reciprocal(&base)? } else { base };
        (n.unsigned_abs() <= 1000).then(|| power(self.ring, &base, n.unsigned_abs()))
    }

    fn function(&mut self, _: Function, _: &Expression) -> Option<K::Element> {
        None
    }
}

/// The value of an expression in numbers and parameters.
pub fn constant<K: RationalAlgebra>(
    ring: &K,
    expression: &Expression,
    values: &dyn Fn(&str) -> Option<K::Element>,
) -> Option<K::Element> {
    expression.evaluate(&mut Constants { ring, values })
}
