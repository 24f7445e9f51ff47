//! Sums of products of polynomials over Q: exponents packed into one word, numerators over one denominator.
//!
//! For every symbol the exponents of the factors lie in known intervals, so that the exponent of a product, less the
//! smallest possible one, needs few bits. With all of them side by side in 128 bits a product of monomials is a sum of
//! words, and with the least common denominator taken out first a term costs one product of integers: no greatest
//! common divisor before the end.

use crate::power_product::{PowerProduct, Symbol};
use crate::sparse::{Monomial, Sparse};
use rug::{Integer, Rational};
use rustc_hash::FxHashMap;

/// Where a product of fewer terms is formed, packing is no gain.
const FEWEST: usize = 64;

type Over<M> = Sparse<M, Rational>;
type Polynomial = Over<PowerProduct>;

/// The pairs of factors.
type Pairs<'a> = [(&'a Polynomial, &'a Polynomial)];

/// One symbol: the least and the largest exponent in the left and in the right factors.
#[derive(Clone, Copy)]
struct Field {
    symbol: Symbol,
    least: [i16; 2],
    largest: [i16; 2],
}

impl Field {
    fn bits(&self) -> u32 {
        let sum = |list: [i16; 2]| i32::from(list[0]) + i32::from(list[1]);
        u32::BITS - (sum(self.largest) - sum(self.least)).unsigned_abs().leading_zeros()
    }
}

/// The layout of a word: fields by increasing symbol, with the place of each.
struct Layout(Vec<(Field, u32)>);

impl Layout {
    /// Nothing where a word has not room for the exponents.
    fn new(pairs: &Pairs<'_>) -> Option<Self> {
        let mut fields: Vec<Field> = Vec::new();
        let factors = pairs.iter().flat_map(|(a, b)| [(0, *a), (1, *b)]);
        for (side, polynomial) in factors {
            for (monomial, _) in polynomial.terms() {
                for &(symbol, exponent) in monomial.factors() {
                    let index = match fields.binary_search_by_key(&symbol, |field| field.symbol) {
                        Ok(index) => index,
                        Err(index) => {
                            let none = [0; 2];
                            fields.insert(index, Field { symbol, least: none, largest: none });
                            index
                        }
                    };
                    let field = &mut fields[index];
                    field.least[side] = field.least[side].min(exponent);
                    field.largest[side] = field.largest[side].max(exponent);
                }
            }
        }
        let mut end = 0;
        let place = |field: Field| {
            let start = end;
            end += field.bits();
            (field, start)
        };
        let fields = fields.into_iter().map(place).collect();
        (end <= u128::BITS).then_some(Self(fields))
    }

    /// The word of a factor on one side.
    fn pack(&self, side: usize, monomial: &PowerProduct) -> u128 {
        let mut known = monomial.factors().iter().peekable();
        let mut word = 0;
        for (field, start) in &self.0 {
            let exponent = known.next_if(|(symbol, _)| *symbol == field.symbol).map_or(0, |f| f.1);
            let above = i32::from(exponent) - i32::from(field.least[side]);
            word |= u128::from(above.unsigned_abs()) << start;
        }
        word
    }

    /// The product that a sum of two words is.
    fn unpack(&self, word: u128) -> PowerProduct {
        let exponent = |(field, start): &(Field, u32)| {
            let above = (word >> start) & ((1 << field.bits()) - 1);
            let least = i32::from(field.least[0]) + i32::from(field.least[1]);
            (field.symbol, (above as i32 + least) as i16)
        };
        PowerProduct::increasing(self.0.iter().map(exponent))
    }
}

/// sum a_i b_i; nothing where it is short or the exponents have no room.
pub(crate) fn sum_of_products(pairs: &Pairs<'_>) -> Option<Polynomial> {
    if is_short(pairs) {
        return None;
    }
    let layout = Layout::new(pairs)?;
    let over = |(word, c): (u128, Rational)| {
        let monomial = layout.unpack(word);
        (monomial.weight(), monomial, c)
    };
    let sum = in_words(pairs, |side, monomial| layout.pack(side, monomial));
    let mut terms: Vec<_> = sum.map(over).collect();
    terms.sort_unstable_by(|(v, m, _), (w, n, _)| {
        v.cmp(w).then_with(|| m.factors().cmp(n.factors()))
    });
    Sparse::from_increasing(terms.into_iter().map(|(_, monomial, c)| (monomial, c)).collect())
}

/// Whether a sum of products has so few terms that it is formed directly.
pub(crate) fn is_short<M: Monomial>(pairs: &[(&Over<M>, &Over<M>)]) -> bool {
    pairs.iter().map(|(a, b)| a.terms().len() * b.terms().len()).sum::<usize>() < FEWEST
}

/// The terms of sum a_i b_i that do not vanish, in any order; the words of the left (0) and the right (1) factors are
/// added.
pub(crate) fn in_words<M: Monomial>(
    pairs: &[(&Over<M>, &Over<M>)],
    word: impl Fn(usize, &M) -> u128,
) -> impl Iterator<Item = (u128, Rational)> {
    let denominators: Vec<[Integer; 2]> =
        pairs.iter().map(|(a, b)| [a, b].map(|f| denominator(f))).collect();
    let mut common = Integer::from(1);
    for [a, b] in &denominators {
        common.lcm_mut(&Integer::from(a * b));
    }
    let packed = |side: usize, f: &Over<M>, over: &Integer| -> Vec<(u128, Integer)> {
        let numerator = |c: &Rational| Integer::from(over.div_exact_ref(c.denom())) * c.numer();
        f.terms().iter().map(|(m, c)| (word(side, m), numerator(c))).collect()
    };
    let mut sums: FxHashMap<u128, Integer> = FxHashMap::default();
    for ((a, b), [_, own]) in pairs.iter().zip(&denominators) {
        // The right factor over its own denominator, the left one over the rest of the common one.
        let left = packed(0, a, &Integer::from(common.div_exact_ref(own)));
        let right = packed(1, b, own);
        for (m, x) in &left {
            for (n, y) in &right {
                *sums.entry(m.wrapping_add(*n)).or_default() += x * y;
            }
        }
    }
    let nonzero = sums.into_iter().filter(|(_, c)| !c.is_zero());
    nonzero.map(move |(word, c)| (word, Rational::from((c, common.clone()))))
}

/// The least common denominator of the coefficients.
fn denominator<M: Monomial>(f: &Over<M>) -> Integer {
    let mut common = Integer::from(1);
    for (_, c) in f.terms() {
        if *c.denom() != 1 {
            common.lcm_mut(c.denom());
        }
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolynomialRing;
    use crate::sparse::Accumulator;
    use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};

    /// Polynomials with exponents of either sign and unlike denominators.
    fn polynomial(seed: i32, symbols: &[Symbol], least: i16) -> Polynomial {
        let ring = PolynomialRing::default();
        let mut sum = ring.zero();
        for k in 0..12 {
            let mut term = ring.rational(&Rational::from((seed * k - 17, k + 2)));
            for (i, &symbol) in (0..).zip(symbols) {
                let exponent = least + ((seed + k * (i + 3)) % 13) as i16;
                term = ring.mul(&term, &ring.power(symbol, exponent));
            }
            ring.add_assign(&mut sum, &term);
        }
        sum
    }

    fn directly(pairs: &Pairs<'_>) -> Polynomial {
        let mut sum = Accumulator::default();
        pairs.iter().for_each(|(a, b)| sum.add_product(&Rationals, a, b));
        sum.finish(&Rationals)
    }

    #[test]
    fn products_are_those_of_the_terms() {
        let few = [Symbol::Parameter(0), Symbol::Moment(3), Symbol::Zeta(3)];
        let [a, b, c] =
            [(2, -5), (3, 0), (5, -2)].map(|(seed, least)| polynomial(seed, &few, least));
        let minus = PolynomialRing::default().neg(&a);
        for pairs in [&[(&a, &b)][..], &[(&a, &c), (&b, &b), (&c, &a)], &[(&a, &b), (&minus, &b)]] {
            assert_eq!(sum_of_products(pairs), Some(directly(pairs)));
        }
        // The whole range of one exponent, and more symbols than a word has room for.
        let wide = [Symbol::Pi, Symbol::LogTwo];
        let (low, high) = (polynomial(1, &wide, -16000), polynomial(4, &wide, 16000));
        assert_eq!(sum_of_products(&[(&low, &high)]), Some(directly(&[(&low, &high)])));
        let many: Vec<_> = (0..40).map(Symbol::Parameter).collect();
        let (d, e) = (polynomial(2, &many, -3), polynomial(3, &many, 1));
        assert_eq!(sum_of_products(&[(&d, &e)]), None);
        assert_eq!(PolynomialRing::default().mul(&d, &e), directly(&[(&d, &e)]));
    }
}
