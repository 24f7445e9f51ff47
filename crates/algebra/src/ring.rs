//! Rings and algebras over the rational numbers.

use rug::{Integer, Rational};
use std::fmt::Debug;

/// A commutative ring with one. The value owns the context, elements are bare data.
///
/// Elements are canonical: two elements are equal in the ring exactly when `==` says so. Laws:
/// [`laws::ring`](crate::laws::ring). Nothing fails: what a ring cannot do has no method here.
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Rationals, Ring, laws};
/// use rug::Rational;
/// let half = Rational::from((1, 2));
/// assert_eq!(Rationals.add(&half, &half), Rationals.one());
/// assert_eq!(Rationals.reciprocal(&Rationals.zero()), None);
/// assert_eq!(laws::rational_algebra(&Rationals, &[Rationals.zero(), Rationals.one(), half]), Ok(()));
/// ```
pub trait Ring: Sync {
    /// A bare element; it means nothing without its ring.
    type Element: Clone + PartialEq + Debug + Send + Sync;

    /// The neutral element of addition.
    fn zero(&self) -> Self::Element;
    /// The neutral element of multiplication.
    fn one(&self) -> Self::Element;
    /// Whether `a` is the zero of the ring.
    fn is_zero(&self, a: &Self::Element) -> bool;
    /// Whether `a` may be the zero of the ring: where elements are enclosures, whether zero is
    /// enclosed.
    fn may_vanish(&self, a: &Self::Element) -> bool {
        self.is_zero(a)
    }
    /// About how many coefficients of a word an element has: a product costs a few nanoseconds for every pair of them. What
    /// costs less than waking another core stays where it is.
    fn size(&self, _: &Self::Element) -> usize {
        16
    }
    /// a <- a + b.
    fn add_assign(&self, a: &mut Self::Element, b: &Self::Element);
    /// -a.
    fn neg(&self, a: &Self::Element) -> Self::Element;
    /// a b.
    fn mul(&self, a: &Self::Element, b: &Self::Element) -> Self::Element;

    /// a + b.
    fn add(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        let mut sum = a.clone();
        self.add_assign(&mut sum, b);
        sum
    }
    /// a - b.
    fn sub(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        self.add(a, &self.neg(b))
    }
    /// a_1 b_1 + ... + a_m b_m. The inner loop of every order of an expansion: rings override
    /// it where the sum costs less than its products one by one.
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let mut sum = self.zero();
        for (a, b) in pairs {
            self.add_assign(&mut sum, &self.mul(a, b));
        }
        sum
    }
    /// 2 (a_1 b_1 + ... + a_m b_m) + c^2: the coefficient of a square of series, each product formed
    /// once; the square c^2 stands in the middle of an even order.
    fn coefficient_of_square(
        &self,
        pairs: &[(&Self::Element, &Self::Element)],
        middle: Option<&Self::Element>,
    ) -> Self::Element {
        let half = self.sum_of_products(pairs);
        let mut sum = self.add(&half, &half);
        if let Some(c) = middle {
            self.add_assign(&mut sum, &self.mul(c, c));
        }
        sum
    }
    /// Whether [`Self::sums_of_products`] of many sums that share their factors costs less than they do one by one.
    const SUMS_AT_ONCE: bool = false;
    /// Of every list the sum of its products, those of its second half twice.
    fn sums_of_products(&self, lists: &[Products<'_, Self::Element>]) -> Vec<Self::Element> {
        let sum = |[once, twice]: &Products<'_, Self::Element>| {
            let twice = self.coefficient_of_square(twice, None);
            self.add(&twice, &self.sum_of_products(once))
        };
        lists.iter().map(sum).collect()
    }
}

/// Pairs whose products are summed, once and twice.
pub type Products<'a, E> = [Vec<(&'a E, &'a E)>; 2];

/// A ring that contains the rational numbers: q -> q 1 is injective, and `scale` by q is the product
/// with its image. Laws: [`laws::rational_algebra`](crate::laws::rational_algebra).
pub trait RationalAlgebra: Ring {
    /// The image of a rational number.
    fn rational(&self, q: &Rational) -> Self::Element;
    /// q a.
    fn scale(&self, a: &Self::Element, q: &Rational) -> Self::Element;
    /// 1/a when `a` is a unit that this ring can invert, else nothing.
    fn reciprocal(&self, a: &Self::Element) -> Option<Self::Element>;
    /// The rational number that `a` is, if it is one.
    fn as_rational(&self, a: &Self::Element) -> Option<Rational>;
}

/// The field Q, on GMP's rationals (always in lowest terms, so canonical). Exact; a product of n-bit
/// numbers costs a product and a greatest common divisor of n-bit integers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rationals;

impl Ring for Rationals {
    type Element = Rational;

    fn zero(&self) -> Rational {
        Rational::new()
    }
    fn one(&self) -> Rational {
        Rational::from(1)
    }
    fn is_zero(&self, a: &Rational) -> bool {
        a.is_zero()
    }
    fn size(&self, a: &Rational) -> usize {
        1 + (a.numer().significant_bits() + a.denom().significant_bits()) as usize / 64
    }
    fn add_assign(&self, a: &mut Rational, b: &Rational) {
        *a += b;
    }
    fn neg(&self, a: &Rational) -> Rational {
        Rational::from(-a)
    }
    fn mul(&self, a: &Rational, b: &Rational) -> Rational {
        Rational::from(a * b)
    }
    /// Products of integers are added without a greatest common divisor.
    fn sum_of_products(&self, pairs: &[(&Rational, &Rational)]) -> Rational {
        let (mut whole, mut rest) = (Integer::new(), Rational::new());
        for (a, b) in pairs {
            if a.is_integer() && b.is_integer() {
                whole += a.numer() * b.numer();
            } else {
                rest += Rational::from(*a * *b);
            }
        }
        rest += whole;
        rest
    }
}

impl RationalAlgebra for Rationals {
    fn rational(&self, q: &Rational) -> Rational {
        q.clone()
    }
    fn scale(&self, a: &Rational, q: &Rational) -> Rational {
        Rational::from(a * q)
    }
    fn reciprocal(&self, a: &Rational) -> Option<Rational> {
        (!a.is_zero()).then(|| Rational::from(a.recip_ref()))
    }
    fn as_rational(&self, a: &Rational) -> Option<Rational> {
        Some(a.clone())
    }
}

/// base^exponent by repeated squaring.
pub fn power<R: Ring>(ring: &R, base: &R::Element, mut exponent: u32) -> R::Element {
    let (mut result, mut square) = (ring.one(), base.clone());
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = ring.mul(&result, &square);
        }
        exponent >>= 1;
        if exponent > 0 {
            square = ring.mul(&square, &square);
        }
    }
    result
}
