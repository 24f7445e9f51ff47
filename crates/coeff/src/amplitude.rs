//! K[a, 1/a]: functions of the amplitude a, the constants of an averaged expansion.

use crate::print::{Print, Style, Term, power};
use crate::sparse::{Monomial, Sparse};
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;
use std::collections::BTreeMap;

/// a^exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AmplitudePower(pub i32);

impl Monomial for AmplitudePower {
    fn unit() -> Self {
        Self(0)
    }
    fn times(&self, other: &Self) -> Self {
        // Exponents are bounded by degree times order, far below i32.
        Self(self.0.saturating_add(other.0))
    }
}

/// An element of [`AmplitudePolynomials`].
pub type AmplitudePolynomial<E> = Sparse<AmplitudePower, E>;

/// Laurent polynomials in the amplitude a over a ring K of numbers or parameters.
///
/// ```
/// use lindstedt_algebra::{Rationals, Ring};
/// use lindstedt_coeff::amplitude::AmplitudePolynomials;
/// use lindstedt_coeff::print::{Print, Style};
/// use rug::Rational;
///
/// let ring = AmplitudePolynomials::new(Rationals);
/// let drift = ring.sub(&ring.power(1, Rational::from((1, 2))), &ring.power(3, Rational::from((1, 8))));
/// assert_eq!(ring.print(&drift, Style::Text), "1/2*a - 1/8*a^3");
/// ```
#[derive(Clone, Debug, Default)]
pub struct AmplitudePolynomials<K> {
    /// K.
    pub coefficients: K,
}

impl<K: RationalAlgebra> AmplitudePolynomials<K> {
    /// The ring over K.
    pub fn new(coefficients: K) -> Self {
        Self { coefficients }
    }
    /// c a^exponent.
    pub fn power(&self, exponent: i32, c: K::Element) -> AmplitudePolynomial<K::Element> {
        Sparse::term(&self.coefficients, AmplitudePower(exponent), c)
    }
    /// An element of K.
    pub fn embed(&self, c: K::Element) -> AmplitudePolynomial<K::Element> {
        self.power(0, c)
    }
    /// The element of K that f is, if f does not depend on a.
    pub fn as_coefficient(&self, f: &AmplitudePolynomial<K::Element>) -> Option<K::Element> {
        match f.terms() {
            [] => Some(self.coefficients.zero()),
            [(AmplitudePower(0), c)] => Some(c.clone()),
            _ => None,
        }
    }
}

impl<K: RationalAlgebra> Ring for AmplitudePolynomials<K> {
    type Element = AmplitudePolynomial<K::Element>;

    fn zero(&self) -> Self::Element {
        Sparse::default()
    }
    fn one(&self) -> Self::Element {
        self.embed(self.coefficients.one())
    }
    fn is_zero(&self, f: &Self::Element) -> bool {
        f.is_zero()
    }
    fn may_vanish(&self, f: &Self::Element) -> bool {
        f.terms().iter().all(|(_, c)| self.coefficients.may_vanish(c))
    }
    fn add_assign(&self, f: &mut Self::Element, g: &Self::Element) {
        f.add_assign(&self.coefficients, g);
    }
    fn neg(&self, f: &Self::Element) -> Self::Element {
        f.neg(&self.coefficients)
    }
    fn mul(&self, f: &Self::Element, g: &Self::Element) -> Self::Element {
        f.mul(&self.coefficients, g)
    }
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        // K sums the products of one power at once.
        let mut powers: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (f, g) in pairs {
            for (m, x) in f.terms() {
                for (n, y) in g.terms() {
                    powers.entry(m.times(n)).or_default().push((x, y));
                }
            }
        }
        let k = &self.coefficients;
        let terms = powers.into_iter().map(|(m, list)| (m, k.sum_of_products(&list)));
        let nonzero = terms.filter(|(_, c)| !k.is_zero(c)).collect();
        Sparse::from_increasing(nonzero).unwrap_or_default()
    }
}

impl<K: RationalAlgebra> RationalAlgebra for AmplitudePolynomials<K> {
    fn rational(&self, q: &Rational) -> Self::Element {
        self.embed(self.coefficients.rational(q))
    }
    fn scale(&self, f: &Self::Element, q: &Rational) -> Self::Element {
        f.scale(&self.coefficients, q)
    }
    /// The inverse of a single term with a coefficient that K can invert.
    fn reciprocal(&self, f: &Self::Element) -> Option<Self::Element> {
        let [(AmplitudePower(n), c)] = f.terms() else { return None };
        Some(self.power(-n, self.coefficients.reciprocal(c)?))
    }
    fn as_rational(&self, f: &Self::Element) -> Option<Rational> {
        self.coefficients.as_rational(&self.as_coefficient(f)?)
    }
}

impl<K: RationalAlgebra + Print> Print for AmplitudePolynomials<K> {
    fn print_terms(&self, f: &Self::Element, style: Style) -> Vec<Term> {
        let term = |(AmplitudePower(n), c): &(AmplitudePower, K::Element)| {
            let name = (*n != 0).then(|| power("a", (*n).into(), style));
            self.coefficients.factor(c, style).times(name)
        };
        match f.terms() {
            [(AmplitudePower(0), c)] => self.coefficients.print_terms(c, style),
            terms => terms.iter().map(term).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::{Rationals, laws};

    #[test]
    fn laws_hold() {
        let ring = AmplitudePolynomials::new(Rationals);
        let q = |n, d| Rational::from((n, d));
        let mixed = ring.add(&ring.power(3, q(2, 5)), &ring.power(-1, q(-1, 3)));
        let samples = [ring.zero(), ring.one(), ring.power(2, q(7, 1)), mixed.clone()];
        assert_eq!(laws::rational_algebra(&ring, &samples), Ok(()));
    }
}
