//! A ring whose products end when the work is stopped.

use crate::{RationalAlgebra, Ring, Stop};
use rug::Rational;

/// The ring, until the work is stopped: from then on products are zero, so that long sums of them end soon.
/// Whoever takes a result asks the [`Stop`] behind it; after a yes it means nothing.
///
/// ```
/// use lindstedt_algebra::{Rationals, Ring, Stop, Stopping};
/// use rug::Rational;
/// let two = Rational::from(2);
/// let (never, now) = (Stop::default(), Stop::new(|| true));
/// assert_eq!(Stopping(&Rationals, &never).mul(&two, &two), 4);
/// assert_eq!(Stopping(&Rationals, &now).mul(&two, &two), 0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stopping<'a, R>(pub &'a R, pub &'a Stop);

impl<R: Ring> Ring for Stopping<'_, R> {
    type Element = R::Element;

    fn zero(&self) -> R::Element {
        self.0.zero()
    }
    fn one(&self) -> R::Element {
        self.0.one()
    }
    fn is_zero(&self, a: &R::Element) -> bool {
        self.0.is_zero(a)
    }
    fn may_vanish(&self, a: &R::Element) -> bool {
        self.0.may_vanish(a)
    }
    fn size(&self, a: &R::Element) -> usize {
        self.0.size(a)
    }
    fn add_assign(&self, a: &mut R::Element, b: &R::Element) {
        self.0.add_assign(a, b);
    }
    fn neg(&self, a: &R::Element) -> R::Element {
        self.0.neg(a)
    }
    fn mul(&self, a: &R::Element, b: &R::Element) -> R::Element {
        if self.1.asked() { self.zero() } else { self.0.mul(a, b) }
    }
    fn sum_of_products(&self, pairs: &[(&R::Element, &R::Element)]) -> R::Element {
        if self.1.asked() { self.zero() } else { self.0.sum_of_products(pairs) }
    }
    fn coefficient_of_square(
        &self,
        pairs: &[(&R::Element, &R::Element)],
        middle: Option<&R::Element>,
    ) -> R::Element {
        if self.1.asked() { self.zero() } else { self.0.coefficient_of_square(pairs, middle) }
    }
}

impl<R: RationalAlgebra> RationalAlgebra for Stopping<'_, R> {
    fn rational(&self, q: &Rational) -> R::Element {
        self.0.rational(q)
    }
    fn scale(&self, a: &R::Element, q: &Rational) -> R::Element {
        self.0.scale(a, q)
    }
    fn reciprocal(&self, a: &R::Element) -> Option<R::Element> {
        self.0.reciprocal(a)
    }
    fn as_rational(&self, a: &R::Element) -> Option<Rational> {
        self.0.as_rational(a)
    }
}
