//! Constants without moments.

use super::Moments;
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;

/// The constants of the ring R_0 in which Lambda_m' = l^m/m!: the same ring with mu_m = 0. What holds there for the
/// still part of a solution holds for all mu_m (`docs/src/concepts/clock.md`), and needs no symbols for them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Formal<C>(pub C);

impl<C: RationalAlgebra> Moments for Formal<C> {
    fn moment(&self, _: u16) -> C::Element {
        self.0.zero()
    }
}

impl<C: Ring> Ring for Formal<C> {
    type Element = C::Element;

    fn zero(&self) -> C::Element {
        self.0.zero()
    }
    fn one(&self) -> C::Element {
        self.0.one()
    }
    fn is_zero(&self, a: &C::Element) -> bool {
        self.0.is_zero(a)
    }
    fn add_assign(&self, a: &mut C::Element, b: &C::Element) {
        self.0.add_assign(a, b);
    }
    fn neg(&self, a: &C::Element) -> C::Element {
        self.0.neg(a)
    }
    fn mul(&self, a: &C::Element, b: &C::Element) -> C::Element {
        self.0.mul(a, b)
    }
    fn sum_of_products(&self, pairs: &[(&C::Element, &C::Element)]) -> C::Element {
        self.0.sum_of_products(pairs)
    }
}

impl<C: RationalAlgebra> RationalAlgebra for Formal<C> {
    fn rational(&self, q: &Rational) -> C::Element {
        self.0.rational(q)
    }
    fn scale(&self, a: &C::Element, q: &Rational) -> C::Element {
        self.0.scale(a, q)
    }
    fn reciprocal(&self, a: &C::Element) -> Option<C::Element> {
        self.0.reciprocal(a)
    }
    fn as_rational(&self, a: &C::Element) -> Option<Rational> {
        self.0.as_rational(a)
    }
}
