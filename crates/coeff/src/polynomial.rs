//! Q[named constants]: polynomials with rational coefficients and Laurent exponents in the
//! log-cosine moments mu_m, the sums S_n, ln 2, pi, zeta(k) and formal parameters.

use crate::sparse::{Accumulator, Monomial, Sparse};
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use rug::Rational;
use smallvec::SmallVec;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// A constant that has a name. Nothing is assumed about its value: identities between constants
/// (zeta(2) = pi^2/6, the closed forms of mu_m) are theorems applied by name elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// A formal parameter, by its position in [`PolynomialRing::parameters`].
    Parameter(u16),
    /// S_n, the n-th Taylor coefficient of a formal function, n! [z^n] F(z).
    Sum(u16),
    /// mu_m = (1/m!) <(-ln|cos t|)^m>, the log-cosine moments.
    Moment(u16),
    /// ln 2.
    LogTwo,
    /// pi.
    Pi,
    /// zeta(k).
    Zeta(u16),
}

impl Symbol {
    /// The weight that makes the expansions homogeneous: mu_m, zeta(m) and S_m have weight m,
    /// ln 2 and pi weight 1, parameters weight 0.
    pub fn weight(self) -> u32 {
        match self {
            Self::Parameter(_) => 0,
            Self::Sum(n) | Self::Moment(n) | Self::Zeta(n) => u32::from(n),
            Self::LogTwo | Self::Pi => 1,
        }
    }
}

/// A product of powers of symbols: strictly increasing symbols, exponents not zero.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct PowerProduct(SmallVec<[(Symbol, i16); 4]>);

impl PowerProduct {
    /// symbol^exponent.
    pub fn power(symbol: Symbol, exponent: i16) -> Self {
        let mut factors = SmallVec::new();
        if exponent != 0 {
            factors.push((symbol, exponent));
        }
        Self(factors)
    }

    /// The product of powers of strictly increasing symbols; powers with exponent zero are left out.
    pub(crate) fn increasing(factors: impl Iterator<Item = (Symbol, i16)>) -> Self {
        Self(factors.filter(|(_, exponent)| *exponent != 0).collect())
    }

    /// The factors, symbols increasing.
    pub fn factors(&self) -> &[(Symbol, i16)] {
        &self.0
    }

    /// The sum of weight times exponent.
    pub fn weight(&self) -> i64 {
        self.0.iter().map(|&(s, e)| i64::from(s.weight()) * i64::from(e)).sum()
    }
}

impl Ord for PowerProduct {
    /// By weight, then by the list of factors: a fixed order for printing and comparing.
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight().cmp(&other.weight()).then_with(|| self.0.cmp(&other.0))
    }
}

impl PartialOrd for PowerProduct {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Monomial for PowerProduct {
    fn unit() -> Self {
        Self::default()
    }

    fn times(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        let mut product = SmallVec::with_capacity(a.len() + b.len());
        let (mut i, mut j) = (0, 0);
        while i < a.len() && j < b.len() {
            match a[i].0.cmp(&b[j].0) {
                Ordering::Less => {
                    product.push(a[i]);
                    i += 1;
                }
                Ordering::Greater => {
                    product.push(b[j]);
                    j += 1;
                }
                Ordering::Equal => {
                    // Exponents are bounded by the order of the expansion, far below i16.
                    let exponent = a[i].1.saturating_add(b[j].1);
                    if exponent != 0 {
                        product.push((a[i].0, exponent));
                    }
                    i += 1;
                    j += 1;
                }
            }
        }
        product.extend_from_slice(&a[i..]);
        product.extend_from_slice(&b[j..]);
        Self(product)
    }
}

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
        a.mul(&Rationals, b)
    }
    fn sum_of_products(&self, pairs: &[(&Polynomial, &Polynomial)]) -> Polynomial {
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
        let mut inverse = monomial.clone();
        for factor in &mut inverse.0 {
            factor.1 = factor.1.checked_neg()?;
        }
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
