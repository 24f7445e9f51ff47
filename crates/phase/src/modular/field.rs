//! Z/p for primes just below 2^61, in Montgomery form.

use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::integer::IsPrime;
use rug::{Integer, Rational};

/// No prime is taken below this: the bounds of the sums rely on p being close to 2^61.
const SMALLEST: u64 = (1 << 61) - (1 << 57);
/// Products that are added up before a sum is brought below p 2^64 again.
const CHUNK: usize = 4;

/// The field Z/p, 2^61 - 2^57 < p < 2^61. Elements are x 2^64 mod p.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimeField {
    prime: u64,
    /// -1/p mod 2^64.
    negative_inverse: u64,
    /// 2^128 mod p, which brings integers to Montgomery form.
    square: u64,
}

impl PrimeField {
    /// Z/p for a prime in that range; the caller vouches for primality.
    fn new(prime: u64) -> Self {
        // Newton's iteration doubles the correct bits of 1/p mod 2^64.
        let mut inverse = prime;
        for _ in 0..6 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(prime.wrapping_mul(inverse)));
        }
        let power = (1u128 << 64) % u128::from(prime);
        let square = power * power % u128::from(prime);
        Self { prime, negative_inverse: inverse.wrapping_neg(), square: square as u64 }
    }

    /// The largest primes below `below` (at most 2^61) that are 1 modulo `modulus`, descending.
    pub fn with_roots_of_unity(modulus: u64, below: u64) -> impl Iterator<Item = Self> {
        let start = (below.min(1 << 61) - 2) / modulus * modulus + 1;
        let candidates = (SMALLEST..=start).rev().step_by(modulus as usize);
        candidates.filter(|&n| Integer::from(n).is_probably_prime(40) != IsPrime::No).map(Self::new)
    }

    /// p.
    pub fn prime(&self) -> u64 {
        self.prime
    }

    /// t / 2^64 mod p for t < p 2^64.
    #[inline]
    fn reduce(&self, t: u128) -> u64 {
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        // t + m p < p 2^64 + 2^64 p < 2^126.
        let reduced = ((t + u128::from(m) * u128::from(self.prime)) >> 64) as u64;
        if reduced >= self.prime { reduced - self.prime } else { reduced }
    }

    /// sum + at most four products, again below p 2^64: the sum of four products is below
    /// 4 p^2 < 2^124, so with p > 2^61 - 2^57 one subtraction of p 2^64 is enough.
    #[inline]
    fn accumulate(&self, sum: u128, products: impl Iterator<Item = (u64, u64)>) -> u128 {
        let total = products.fold(sum, |sum, (a, b)| sum + u128::from(a) * u128::from(b));
        let bound = u128::from(self.prime) << 64;
        if total >= bound { total - bound } else { total }
    }

    /// sum_i a_i b_i with one reduction, over the shorter length.
    pub(super) fn dot(&self, a: &[u64], b: &[u64]) -> u64 {
        let chunks = a.chunks(CHUNK).zip(b.chunks(CHUNK));
        let sum = chunks
            .fold(0, |sum, (a, b)| self.accumulate(sum, a.iter().copied().zip(b.iter().copied())));
        self.reduce(sum)
    }

    /// sum_i a_i[j] b_i[j] for every j.
    pub(super) fn pointwise(&self, pairs: &[(&[u64], &[u64])]) -> Vec<u64> {
        let length = pairs.iter().map(|(a, b)| a.len().min(b.len())).max().unwrap_or(0);
        let mut sums = vec![0u128; length];
        for chunk in pairs.chunks(CHUNK) {
            if let [(a, b), (c, d), (e, f), (g, h)] = chunk {
                // The same as below with the loops exchanged: one pass over the sums.
                for (j, sum) in sums.iter_mut().enumerate() {
                    let products = [(a[j], b[j]), (c[j], d[j]), (e[j], f[j]), (g[j], h[j])];
                    *sum = self.accumulate(*sum, products.into_iter());
                }
            } else {
                for (a, b) in chunk {
                    for ((sum, &x), &y) in sums.iter_mut().zip(*a).zip(*b) {
                        *sum = self.accumulate(*sum, std::iter::once((x, y)));
                    }
                }
            }
        }
        sums.into_iter().map(|sum| self.reduce(sum)).collect()
    }

    /// The image of an integer.
    pub fn integer(&self, n: &Integer) -> u64 {
        // A remainder by a modulus of 61 bits fits.
        let residue = Integer::from(n.modulo_ref(&Integer::from(self.prime)));
        self.reduce(u128::from(residue.to_u64().unwrap_or(0)) * u128::from(self.square))
    }

    /// The representative of an element in 0..p.
    pub fn representative(&self, a: u64) -> u64 {
        self.reduce(u128::from(a))
    }

    /// a^exponent.
    pub fn power(&self, a: u64, mut exponent: u64) -> u64 {
        let (mut result, mut square) = (self.one(), a);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.mul(&result, &square);
            }
            square = self.mul(&square, &square);
            exponent >>= 1;
        }
        result
    }

    /// An element of exact multiplicative order n, a divisor of p - 1.
    pub fn root_of_unity(&self, n: u64) -> Option<u64> {
        let cofactor = (self.prime - 1) / n;
        let prime_factors: Vec<u64> =
            (2..=n).filter(|q| n.is_multiple_of(*q) && (2..*q).all(|r| q % r != 0)).collect();
        (2u64..1000)
            .map(|base| self.power(self.integer(&Integer::from(base)), cofactor))
            .find(|&root| prime_factors.iter().all(|q| self.power(root, n / q) != self.one()))
    }
}

impl Ring for PrimeField {
    type Element = u64;

    fn zero(&self) -> u64 {
        0
    }
    fn one(&self) -> u64 {
        self.reduce(u128::from(self.square))
    }
    fn is_zero(&self, a: &u64) -> bool {
        *a == 0
    }
    fn add_assign(&self, a: &mut u64, b: &u64) {
        *a += b;
        if *a >= self.prime {
            *a -= self.prime;
        }
    }
    fn neg(&self, a: &u64) -> u64 {
        if *a == 0 { 0 } else { self.prime - a }
    }
    fn mul(&self, a: &u64, b: &u64) -> u64 {
        self.reduce(u128::from(*a) * u128::from(*b))
    }
}

impl RationalAlgebra for PrimeField {
    /// A denominator divisible by p has no image; zero is returned. A result computed with it
    /// is wrong modulo p, which the proof of the reconstructed expansion detects.
    fn rational(&self, q: &Rational) -> u64 {
        let numerator = self.integer(q.numer());
        if *q.denom() == 1 {
            return numerator;
        }
        let denominator = self.reciprocal(&self.integer(q.denom())).unwrap_or(0);
        self.mul(&numerator, &denominator)
    }
    fn scale(&self, a: &u64, q: &Rational) -> u64 {
        self.mul(a, &self.rational(q))
    }
    fn reciprocal(&self, a: &u64) -> Option<u64> {
        (*a != 0).then(|| self.power(*a, self.prime - 2))
    }
    /// An element of Z/p belongs to many rational numbers.
    fn as_rational(&self, _: &u64) -> Option<Rational> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_integers() {
        let field = PrimeField::with_roots_of_unity(24, 1 << 61).next().expect("a prime");
        let p = Integer::from(field.prime());
        let mut x = Integer::from(123456789);
        for _ in 0..1000 {
            let y = Integer::from(x.square_ref()) + 987654321;
            let product = field.mul(&field.integer(&x), &field.integer(&y));
            let expected = Integer::from(&x * &y).modulo(&p);
            assert_eq!(field.representative(product), expected);
            x = y.modulo(&p);
        }
        let third = field.rational(&Rational::from((-2, 3)));
        assert_eq!(field.scale(&third, &Rational::from((-3, 2))), field.one());
        let root = field.root_of_unity(24).unwrap_or(0);
        assert_eq!(field.power(root, 24), field.one());
        assert_ne!(field.power(root, 12), field.one());
        assert_ne!(field.power(root, 8), field.one());
    }
}
