//! Q[S_0, 1/S_0, S_1, ..., S_k] with all exponents of a monomial in one word: a product of monomials is a sum.
//!
//! The small-delta method lets S_j come with the j-th power of the small parameter, so that exponents are bounded by the
//! weight and need few bits: 6 for S_1 at order 16, 2 for S_18. The exponent of S_0 has either sign.

use crate::polynomial::{Polynomial, PowerProduct, Symbol};
use crate::product;
use crate::sparse::{Accumulator, Monomial, Sparse};
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use rug::Rational;

/// The exponents of S_0, S_1, ... in the fields of a [`PackedSums`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Packed(u128);

impl Monomial for Packed {
    fn unit() -> Self {
        Self(0)
    }
    fn times(&self, other: &Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

/// An element of [`PackedSums`].
pub type PackedPolynomial = Sparse<Packed, Rational>;

/// Bits of the exponent of S_0, a number in two's complement at the top of the word.
const LEADING: u32 = 24;

/// The ring of polynomials in S_1, ..., S_k whose monomials have weight sum j e_j at most a bound, Laurent in S_0.
///
/// Exact. The bound is the caller's word: a product of greater weight means nothing.
///
/// ```
/// use lindstedt_algebra::Ring;
/// use lindstedt_coeff::packed::PackedSums;
/// let ring = PackedSums::new(3, 6).ok_or("too many")?;
/// let (one, two) = (ring.sum(1).ok_or("no S_1")?, ring.sum(2).ok_or("no S_2")?);
/// let product = ring.mul(&one, &two);
/// assert_eq!(ring.pack(&ring.unpack(&product)), Some(product));
/// assert_eq!(ring.sum(4), None);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PackedSums {
    /// Where the field of S_j begins, for j = 1, ..., k, and where the last one ends.
    fields: Vec<u32>,
}

impl PackedSums {
    /// The ring with S_0, ..., S_largest and weights up to a bound; nothing where a word has not room for them.
    #[must_use]
    pub fn new(largest: usize, weight: usize) -> Option<Self> {
        let mut fields = vec![0];
        let mut end = 0;
        for j in 1..=largest {
            end += (weight / j).checked_ilog2().map_or(0, |bits| bits + 1);
            fields.push(end);
        }
        (end + LEADING <= u128::BITS).then_some(Self { fields })
    }

    /// S_j, if the ring has it.
    #[must_use]
    pub fn sum(&self, j: usize) -> Option<PackedPolynomial> {
        Some(Sparse::term(&Rationals, self.power(j, 1)?, Rational::from(1)))
    }

    /// S_j^exponent; nothing where it does not fit.
    fn power(&self, j: usize, exponent: i16) -> Option<Packed> {
        if j == 0 {
            let shifted = i128::from(exponent) << (u128::BITS - LEADING);
            return Some(Packed(shifted.cast_unsigned()));
        }
        let (start, end) = (*self.fields.get(j - 1)?, *self.fields.get(j)?);
        let exponent = u128::try_from(exponent).ok()?;
        (exponent >> (end - start) == 0).then_some(Packed(exponent << start))
    }

    /// The same polynomial in [`crate::PolynomialRing`].
    #[must_use]
    pub fn unpack(&self, p: &PackedPolynomial) -> Polynomial {
        let terms = p.terms().iter().map(|(m, c)| (self.factors(*m), c.clone()));
        let mut terms: Vec<_> = terms.collect();
        terms.sort_unstable_by(|(m, _), (n, _)| m.cmp(n));
        // Different words are different products.
        Sparse::from_increasing(terms).unwrap_or_default()
    }

    fn factors(&self, monomial: Packed) -> PowerProduct {
        let leading = monomial.0.cast_signed() >> (u128::BITS - LEADING);
        let rest = (1u16..).zip(self.fields.windows(2)).map(|(j, field)| {
            let width = field[1] - field[0];
            let exponent = (monomial.0 >> field[0]) & ((1 << width) - 1);
            (Symbol::Sum(j), exponent as i16)
        });
        PowerProduct::increasing(std::iter::once((Symbol::Sum(0), leading as i16)).chain(rest))
    }

    /// The polynomial of [`crate::PolynomialRing`] as an element of this ring, if it is one.
    #[must_use]
    pub fn pack(&self, p: &Polynomial) -> Option<PackedPolynomial> {
        let packed = |(monomial, c): &(PowerProduct, Rational)| {
            let mut product = Packed::unit();
            for &(symbol, exponent) in monomial.factors() {
                let Symbol::Sum(j) = symbol else { return None };
                product = product.times(&self.power(j.into(), exponent)?);
            }
            Some((product, c.clone()))
        };
        let mut terms: Vec<_> = p.terms().iter().map(packed).collect::<Option<_>>()?;
        terms.sort_unstable_by_key(|(m, _)| *m);
        Sparse::from_increasing(terms)
    }
}

impl Ring for PackedSums {
    type Element = PackedPolynomial;

    fn zero(&self) -> PackedPolynomial {
        Sparse::default()
    }
    fn one(&self) -> PackedPolynomial {
        self.rational(&Rational::from(1))
    }
    fn is_zero(&self, a: &PackedPolynomial) -> bool {
        a.is_zero()
    }
    fn add_assign(&self, a: &mut PackedPolynomial, b: &PackedPolynomial) {
        a.add_assign(&Rationals, b);
    }
    fn neg(&self, a: &PackedPolynomial) -> PackedPolynomial {
        a.neg(&Rationals)
    }
    fn mul(&self, a: &PackedPolynomial, b: &PackedPolynomial) -> PackedPolynomial {
        if let ([(m, x)], [(n, y)]) = (a.terms(), b.terms()) {
            return Sparse::term(&Rationals, m.times(n), Rational::from(x * y));
        }
        self.sum_of_products(&[(a, b)])
    }
    fn sum_of_products(
        &self,
        pairs: &[(&PackedPolynomial, &PackedPolynomial)],
    ) -> PackedPolynomial {
        if product::is_short(pairs) {
            let mut sum = Accumulator::default();
            pairs.iter().for_each(|(a, b)| sum.add_product(&Rationals, a, b));
            return sum.finish(&Rationals);
        }
        let sum = product::in_words(pairs, |_, Packed(word)| *word);
        let mut terms: Vec<_> = sum.map(|(word, c)| (Packed(word), c)).collect();
        terms.sort_unstable_by_key(|(m, _)| *m);
        Sparse::from_increasing(terms).unwrap_or_default()
    }
}

impl RationalAlgebra for PackedSums {
    fn rational(&self, q: &Rational) -> PackedPolynomial {
        Sparse::term(&Rationals, Packed::unit(), q.clone())
    }
    fn scale(&self, a: &PackedPolynomial, q: &Rational) -> PackedPolynomial {
        a.scale(&Rationals, q)
    }
    /// The inverse of c S_0^k; nothing else is a unit.
    fn reciprocal(&self, a: &PackedPolynomial) -> Option<PackedPolynomial> {
        let [(Packed(monomial), c)] = a.terms() else { return None };
        let no_others = monomial << LEADING == 0;
        let inverse = Packed(monomial.wrapping_neg());
        no_others.then(|| Sparse::term(&Rationals, inverse, Rational::from(c.recip_ref())))
    }
    fn as_rational(&self, a: &PackedPolynomial) -> Option<Rational> {
        match a.terms() {
            [] => Some(Rational::new()),
            [(monomial, c)] if *monomial == Packed::unit() => Some(c.clone()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolynomialRing;
    use lindstedt_algebra::laws;

    #[test]
    fn laws_hold() {
        let ring = PackedSums::new(4, 16).unwrap();
        let [s0, s1, s3] = [0, 1, 3].map(|j| ring.sum(j).unwrap());
        let inverse = ring.reciprocal(&s0).unwrap();
        let mixed = ring.add(&ring.mul(&s1, &inverse), &ring.scale(&s3, &Rational::from((3, 7))));
        let samples = [ring.zero(), ring.one(), s0, s1, mixed, inverse];
        assert_eq!(laws::rational_algebra(&ring, &samples), Ok(()));
    }

    #[test]
    fn packing_is_a_homomorphism_both_ways() {
        let (ring, target) = (PackedSums::new(5, 12).unwrap(), PolynomialRing::default());
        let element = |list: &[(usize, i16)]| {
            let factor =
                |&(j, e): &(usize, i16)| (ring.power(j, e).unwrap(), Rational::from((e, 5)));
            Sparse::collect(&Rationals, list.iter().map(factor))
        };
        let (a, b) =
            (element(&[(0, -3), (1, 4), (2, 1)]), element(&[(0, 2), (3, 1), (5, 2), (1, 1)]));
        let product = ring.unpack(&ring.mul(&a, &b));
        assert_eq!(product, target.mul(&ring.unpack(&a), &ring.unpack(&b)));
        assert_eq!(ring.pack(&product), Some(ring.mul(&a, &b)));
        // Long enough for the sum over words, with S_0 of either sign and what cancels.
        let long =
            element(&[(0, -3), (0, 2), (1, 4), (1, 1), (2, 2), (2, 1), (3, 1), (4, 1), (5, 1)]);
        let minus = ring.neg(&long);
        let pairs = [(&long, &long), (&minus, &a), (&long, &a)];
        let square = ring.unpack(&ring.sum_of_products(&pairs));
        let mut directly = Accumulator::default();
        directly.add_product(&Rationals, &ring.unpack(&long), &ring.unpack(&long));
        assert_eq!(square, directly.finish(&Rationals));
        assert_eq!(ring.pack(&target.symbol(Symbol::Moment(1))), None);
        assert_eq!(ring.pack(&target.power(Symbol::Sum(2), -1)), None);
        assert_eq!(ring.reciprocal(&ring.sum(2).unwrap()), None);
        assert_eq!(PackedSums::new(60, 200), None);
    }
}
