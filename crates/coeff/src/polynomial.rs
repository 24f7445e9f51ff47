//! Q[named constants]: polynomials with rational coefficients and Laurent exponents in the
//! log-cosine moments mu_m, the sums S_n, ln 2, pi, zeta(k) and formal parameters.

pub use crate::power_product::{PowerProduct, Symbol};
use crate::product;
use crate::sparse::{Accumulator, Monomial, Sparse};
pub use lindstedt_algebra::power;
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use rug::Rational;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// An element of [`PolynomialRing`].
pub type Polynomial = Sparse<PowerProduct, Rational>;

/// Q[symbols, 1/symbols]. The value owns the names of the formal parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolynomialRing {
    /// The names of the formal parameters, in the order of [`Symbol::Parameter`].
    pub parameters: Vec<String>,
}

impl PolynomialRing {
    /// A symbol as a polynomial.
    pub fn symbol(&self, symbol: Symbol) -> Polynomial {
        self.power(symbol, 1)
    }

    /// symbol^exponent as a polynomial.
    pub fn power(&self, symbol: Symbol, exponent: i16) -> Polynomial {
        Sparse::term(&Rationals, PowerProduct::power(symbol, exponent), Rational::from(1))
    }

    /// Substitutes a polynomial for every symbol for which `image` gives one, the ring
    /// homomorphism to any rational algebra. Nothing where a negative power of an image that is
    /// no unit would be needed.
    pub fn substitute<R: RationalAlgebra>(
        &self,
        target: &R,
        a: &Polynomial,
        mut image: impl FnMut(Symbol) -> R::Element,
    ) -> Option<R::Element> {
        let mut powers: BTreeMap<(Symbol, i16), R::Element> = BTreeMap::new();
        let mut sum = target.zero();
        for (monomial, coefficient) in a.terms() {
            let mut product = target.rational(coefficient);
            for &(symbol, exponent) in monomial.factors() {
                if let Entry::Vacant(entry) = powers.entry((symbol, exponent)) {
                    let mut base = image(symbol);
                    if exponent < 0 {
                        base = target.reciprocal(&base)?;
                    }
                    let power = power(target, &base, exponent.unsigned_abs().into());
                    entry.insert(power);
                }
                product = target.mul(&product, &powers[&(symbol, exponent)]);
            }
            target.add_assign(&mut sum, &product);
        }
        Some(sum)
    }
}

impl Ring for PolynomialRing {
    type Element = Polynomial;

    fn zero(&self) -> Polynomial {
        Sparse::default()
    }
    fn one(&self) -> Polynomial {
        self.rational(&Rational::from(1))
    }
    fn is_zero(&self, a: &Polynomial) -> bool {
        a.is_zero()
    }
    fn add_assign(&self, a: &mut Polynomial, b: &Polynomial) {
        a.add_assign(&Rationals, b);
    }
    fn neg(&self, a: &Polynomial) -> Polynomial {
        a.neg(&Rationals)
    }
    fn mul(&self, a: &Polynomial, b: &Polynomial) -> Polynomial {
        if let ([(m, x)], [(n, y)]) = (a.terms(), b.terms()) {
            return Sparse::term(&Rationals, m.times(n), Rational::from(x * y));
        }
        product::sum_of_products(&[(a, b)]).unwrap_or_else(|| a.mul(&Rationals, b))
    }
    fn sum_of_products(&self, pairs: &[(&Polynomial, &Polynomial)]) -> Polynomial {
        if let Some(sum) = product::sum_of_products(pairs) {
            return sum;
        }
        let mut sum = Accumulator::default();
        for (a, b) in pairs {
            sum.add_product(&Rationals, a, b);
        }
        sum.finish(&Rationals)
    }
}

impl RationalAlgebra for PolynomialRing {
    fn rational(&self, q: &Rational) -> Polynomial {
        Sparse::term(&Rationals, PowerProduct::unit(), q.clone())
    }
    fn scale(&self, a: &Polynomial, q: &Rational) -> Polynomial {
        a.scale(&Rationals, q)
    }
    /// The inverse of a single term; polynomials with more terms are no units.
    fn reciprocal(&self, a: &Polynomial) -> Option<Polynomial> {
        let [(monomial, coefficient)] = a.terms() else { return None };
        let factors: Option<Vec<_>> =
            monomial.factors().iter().map(|&(s, e)| Some((s, e.checked_neg()?))).collect();
        let inverse = PowerProduct::increasing(factors?.into_iter());
        Some(Sparse::term(&Rationals, inverse, Rational::from(coefficient.recip_ref())))
    }
    fn as_rational(&self, a: &Polynomial) -> Option<Rational> {
        match a.terms() {
            [] => Some(Rational::new()),
            [(monomial, coefficient)] if monomial.factors().is_empty() => Some(coefficient.clone()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::laws;

    #[test]
    fn laws_hold() {
        let ring = PolynomialRing { parameters: vec!["a".into()] };
        let [mu1, a, s2] = [Symbol::Moment(1), Symbol::Parameter(0), Symbol::Sum(2)]
            .map(|symbol| ring.symbol(symbol));
        let mixed = ring.add(&ring.mul(&mu1, &a), &ring.scale(&s2, &Rational::from((3, 7))));
        let laurent = ring.sub(&ring.power(Symbol::Parameter(0), -2), &ring.one());
        let samples = [ring.zero(), ring.one(), mu1, a, mixed, laurent];
        assert_eq!(laws::rational_algebra(&ring, &samples), Ok(()));
    }

    #[test]
    fn substitution_is_a_homomorphism() {
        let ring = PolynomialRing::default();
        let (x, y) = (ring.symbol(Symbol::Moment(1)), ring.power(Symbol::Moment(2), -1));
        let p = ring.add(&ring.mul(&x, &y), &ring.mul(&x, &x));
        let value = |symbol| match symbol {
            Symbol::Moment(1) => Rational::from(3),
            _ => Rational::from((2, 5)),
        };
        let image = ring.substitute(&Rationals, &p, value);
        assert_eq!(image, Some(Rational::from((33, 2))));
        let zero = ring.substitute(&Rationals, &p, |_| Rational::new());
        assert_eq!(zero, None);
    }
}
