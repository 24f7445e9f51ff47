//! Products of rational polynomials over one common denominator.
//!
//! Rational arithmetic term by term spends its time in greatest common divisors. Here every
//! polynomial is brought over its own common denominator, the integer products are added up
//! over the common denominator of all pairs, and lowest terms are restored once at the end.
//! Long polynomials are multiplied by Kronecker substitution (z = 2^w, one integer product),
//! which hands the work to GMP's fast multiplication.

use crate::Products;
use rug::integer::Order;
use rug::{Assign, Integer, Rational};

/// Below this length schoolbook products win (measured on Duffing's and van der Pol's series).
const KRONECKER_LENGTH: usize = 8;

/// See [`crate::RationalAlgebra::products`].
pub(crate) fn rational(pairs: &[(&[Rational], &[Rational])]) -> Products<Rational> {
    let mut cleared: Vec<_> = pairs
        .iter()
        .map(|(a, b)| (clear_denominators(a), clear_denominators(b)))
        .filter(|((a, _), (b, _))| !a.is_empty() && !b.is_empty())
        .collect();
    let mut denominator = Integer::from(1);
    for ((_, p), (_, q)) in &cleared {
        denominator.lcm_mut(&Integer::from(p * q));
    }
    for ((a, p), (_, q)) in &mut cleared {
        let factor = Integer::from(denominator.div_exact_ref(&Integer::from(&*p * &*q)));
        if factor != 1 {
            for x in a {
                *x *= &factor;
            }
        }
    }
    let integers: Vec<(&[Integer], &[Integer])> =
        cleared.iter().map(|((a, _), (b, _))| (&a[..], &b[..])).collect();
    let products = integer(&integers);
    let divide = |numerators: Vec<Integer>| {
        let over = |n| Rational::from((n, denominator.clone()));
        numerators.into_iter().map(over).collect()
    };
    Products {
        by_sum: divide(products.by_sum),
        by_difference: divide(products.by_difference),
        offset: products.offset,
    }
}

/// The numerators over the least common denominator of a slice, and that denominator.
fn clear_denominators(values: &[Rational]) -> (Vec<Integer>, Integer) {
    let mut denominator = Integer::from(1);
    for value in values {
        if !denominator.is_divisible(value.denom()) {
            denominator.lcm_mut(value.denom());
        }
    }
    let mut cofactor = Integer::new();
    let numerators = values
        .iter()
        .map(|value| {
            cofactor.assign(denominator.div_exact_ref(value.denom()));
            Integer::from(&cofactor * value.numer())
        })
        .collect();
    (numerators, denominator)
}

/// Products of integer polynomials, schoolbook for short ones, Kronecker for long ones.
fn integer(pairs: &[(&[Integer], &[Integer])]) -> Products<Integer> {
    let mut products = Products::zeros(pairs, &Integer::new());
    let offset = products.offset;
    let is_long =
        |(a, b): &&(&[Integer], &[Integer])| a.len().min(b.len()) >= KRONECKER_LENGTH;
    for (a, b) in pairs.iter().filter(|pair| !is_long(pair)) {
        for (i, x) in a.iter().enumerate().filter(|(_, x)| !x.is_zero()) {
            for (j, y) in b.iter().enumerate().filter(|(_, y)| !y.is_zero()) {
                products.by_sum[i + j] += x * y;
                products.by_difference[i + offset - j] += x * y;
            }
        }
    }
    let long: Vec<_> = pairs.iter().filter(is_long).collect();
    if long.is_empty() {
        return products;
    }
    let words = slot_words(&long);
    let (mut by_sum, mut by_difference) = (Integer::new(), Integer::new());
    for (a, b) in long {
        let packed = pack(a.iter(), words);
        by_sum += &packed * pack(b.iter(), words);
        let shift = offset + 1 - b.len();
        by_difference += (packed * pack(b.iter().rev(), words)) << slot_bits(shift, words);
    }
    unpack_add(&mut products.by_sum, by_sum, words);
    unpack_add(&mut products.by_difference, by_difference, words);
    products
}

/// Words of 64 bits that hold every coefficient of the sum of products with its sign: a
/// coefficient is a sum of at most `pairs * min(length)` products.
fn slot_words(pairs: &[&(&[Integer], &[Integer])]) -> usize {
    let bits = |values: &[Integer]| values.iter().map(Integer::significant_bits).max();
    let widest = pairs
        .iter()
        .map(|(a, b)| {
            let count = a.len().min(b.len()) * pairs.len();
            bits(a).unwrap_or(0) + bits(b).unwrap_or(0) + count.ilog2() + 1
        })
        .max()
        .unwrap_or(0);
    (widest as usize + 1).div_ceil(64)
}

fn slot_bits(slots: usize, words: usize) -> u32 {
    u32::try_from(slots * words * 64).unwrap_or(u32::MAX)
}

/// The value of the polynomial at z = 2^(64 words), coefficients lowest first.
fn pack<'a>(values: impl ExactSizeIterator<Item = &'a Integer>, words: usize) -> Integer {
    let mut positive = vec![0u64; values.len() * words];
    let mut negative = Vec::new();
    let length = positive.len();
    for (index, value) in values.enumerate() {
        let target = if value.is_negative() {
            negative.resize(length, 0);
            &mut negative
        } else {
            &mut positive
        };
        let digits = value.significant_digits::<u64>();
        let start = index * words;
        value.write_digits(&mut target[start..start + digits], Order::Lsf);
    }
    Integer::from_digits(&positive, Order::Lsf) - Integer::from_digits(&negative, Order::Lsf)
}

/// Adds the coefficients of a packed polynomial. Half a slot is added everywhere first, so that
/// every slot holds a nonnegative number and no borrow crosses from slot to slot.
fn unpack_add(target: &mut [Integer], packed: Integer, words: usize) {
    let mut half = vec![0u64; target.len() * words];
    for slot in half.chunks_mut(words) {
        slot[words - 1] = 1 << 63;
    }
    let half_slot = Integer::from(1) << (slot_bits(1, words) - 1);
    let digits = (packed + Integer::from_digits(&half, Order::Lsf)).to_digits::<u64>(Order::Lsf);
    for (value, slot) in target.iter_mut().zip(digits.chunks(words)) {
        *value += Integer::from_digits(slot, Order::Lsf) - &half_slot;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RationalAlgebra, Rationals, Ring};

    /// The default of the trait, without common denominators: the independent route.
    struct TermByTerm;
    impl Ring for TermByTerm {
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
        fn add_assign(&self, a: &mut Rational, b: &Rational) {
            *a += b;
        }
        fn neg(&self, a: &Rational) -> Rational {
            Rational::from(-a)
        }
        fn mul(&self, a: &Rational, b: &Rational) -> Rational {
            Rational::from(a * b)
        }
    }
    impl RationalAlgebra for TermByTerm {
        fn rational(&self, q: &Rational) -> Rational {
            q.clone()
        }
        fn scale(&self, a: &Rational, q: &Rational) -> Rational {
            Rational::from(a * q)
        }
        fn reciprocal(&self, _: &Rational) -> Option<Rational> {
            None
        }
        fn as_rational(&self, a: &Rational) -> Option<Rational> {
            Some(a.clone())
        }
    }

    #[test]
    fn common_denominators_and_kronecker_agree_with_term_by_term() {
        let mut state = 12345u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            i64::try_from(state >> 33).unwrap_or(0) - (1 << 30)
        };
        let mut polynomial = |length: usize| -> Vec<Rational> {
            (0..length)
                .map(|i| {
                    let value = Rational::from((next(), next().abs() + 1));
                    if i % 5 == 3 { Rational::new() } else { value.clone() * &value * value }
                })
                .collect()
        };
        let lengths = [(1, 1), (3, 7), (8, 8), (9, 31), (31, 9), (40, 40), (0, 4)];
        let data: Vec<_> = lengths.iter().map(|&(m, n)| (polynomial(m), polynomial(n))).collect();
        for count in 1..=data.len() {
            let pairs: Vec<_> = data[..count].iter().map(|(a, b)| (&a[..], &b[..])).collect();
            assert_eq!(Rationals.products(&pairs), TermByTerm.products(&pairs));
        }
    }
}
