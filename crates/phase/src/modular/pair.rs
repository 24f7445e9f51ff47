//! Z/M for the product M = p q of two primes just below 2^30, in Montgomery form: what integers are reduced by, and
//! lifted from.

use super::primes;
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::{Integer, Rational};

#[inline(always)]
fn wide(a: u64, b: u64) -> u128 {
    u128::from(a) * u128::from(b)
}

/// The ring Z/M, M = p q below 2^60. Elements are x 2^64 mod M.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimePair {
    modulus: u64,
    primes: [u32; 2],
    /// 1/p mod q.
    inverse: u64,
    /// -1/M mod 2^64.
    negative_inverse: u64,
    /// 2^128 mod M, which brings integers to Montgomery form.
    square: u64,
}

impl PrimePair {
    /// Z/M for two odd numbers below 2^30; the caller vouches for primality.
    pub(super) fn new(p: u32, q: u32) -> Self {
        let modulus = u64::from(p) * u64::from(q);
        // Newton's iteration doubles the correct bits of 1/M mod 2^64.
        let mut inverse = modulus;
        for _ in 0..6 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(modulus.wrapping_mul(inverse)));
        }
        let power = (1u128 << 64) % u128::from(modulus);
        let square = power * power % u128::from(modulus);
        Self {
            modulus,
            primes: [p, q],
            inverse: primes::power(q, u64::from(p), u64::from(q) - 2),
            negative_inverse: inverse.wrapping_neg(),
            square: square as u64,
        }
    }

    /// Z/M for the two largest primes below 2^30.
    #[must_use]
    pub fn largest() -> Self {
        // 2^30 - 35 and 2^30 - 41 (OEIS A013603).
        Self::new((1 << 30) - 35, (1 << 30) - 41)
    }

    /// M.
    pub fn modulus(&self) -> u64 {
        self.modulus
    }

    /// p and q.
    pub fn primes(&self) -> [u32; 2] {
        self.primes
    }

    /// The element that is a modulo p and b modulo q, given by representatives.
    pub(super) fn joined(&self, a: u32, b: u32) -> u64 {
        let [p, q] = self.primes.map(u64::from);
        let difference = u64::from(b) + q - u64::from(a) % q;
        self.small(u64::from(a) + p * (difference % q * self.inverse % q))
    }

    /// t / 2^64 mod M for t < 2^127.
    #[inline(always)]
    fn reduce(&self, t: u128) -> u64 {
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        // The lower halves of t and m M add up to 0 or 2^64.
        let carry = u64::from(t as u64 != 0);
        let mut sum =
            (t >> 64) as u64 + ((u128::from(m) * u128::from(self.modulus)) >> 64) as u64 + carry;
        // Below 2^63 + M < 16 M; a difference that wraps around is the larger number.
        for shift in [3, 2, 1, 0] {
            sum = sum.min(sum.wrapping_sub(self.modulus << shift));
        }
        sum
    }

    /// a b / 2^64 mod M for a b < 2^64 M.
    #[inline(always)]
    fn product(&self, a: u64, b: u64) -> u64 {
        let t = u128::from(a) * u128::from(b);
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        let sum = ((t + u128::from(m) * u128::from(self.modulus)) >> 64) as u64;
        sum.min(sum.wrapping_sub(self.modulus))
    }

    /// The image of a number below M.
    pub(super) fn small(&self, n: u64) -> u64 {
        self.product(n, self.square)
    }

    /// The image of an integer.
    pub fn integer(&self, n: &Integer) -> u64 {
        match n.to_i64() {
            Some(n) if n.unsigned_abs() < self.modulus => {
                let image = self.small(n.unsigned_abs());
                if n < 0 { self.neg(&image) } else { image }
            }
            _ => self.limbs(n, &self.limb_images(n.as_limbs().len())),
        }
    }

    /// The images of integers, which share what belongs to the modulus.
    pub fn integers<'a>(&self, list: impl Iterator<Item = &'a Integer> + Clone) -> Vec<u64> {
        let longest = list.clone().map(|n| n.as_limbs().len()).max().unwrap_or(0);
        let images = self.limb_images(longest);
        list.map(|n| self.limbs(n, &images)).collect()
    }

    /// The images of 2^(64 i), brought forward by another 2^64 against the reduction of the sum.
    fn limb_images(&self, length: usize) -> Vec<u64> {
        let next = |power: &u64| Some(self.product(*power, self.square));
        std::iter::successors(Some(self.square), next).take(length).collect()
    }

    /// sum_i l_i 2^(64 i) with one reduction: the products fill 128 bits, what they carry is counted.
    fn limbs(&self, n: &Integer, images: &[u64]) -> u64 {
        let (mut sum, mut carries) = (0u128, 0u64);
        for (&limb, &image) in n.as_limbs().iter().zip(images) {
            let (next, carry) = sum.overflowing_add(wide(limb, image));
            (sum, carries) = (next, carries + u64::from(carry));
        }
        // What stands above 2^126, over 2^64 as all of the sum.
        let above = self.product((carries << 2) + (sum >> 126) as u64, self.small(1 << 62));
        let residue = self.add(&self.reduce(sum & (u128::MAX >> 2)), &above);
        if n.is_negative() { self.neg(&residue) } else { residue }
    }

    /// The representative of an element in 0..M.
    pub fn representative(&self, a: u64) -> u64 {
        self.reduce(u128::from(a))
    }

    /// a^exponent.
    fn power(&self, a: u64, mut exponent: u64) -> u64 {
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
}

impl Ring for PrimePair {
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
    #[inline(always)]
    fn add_assign(&self, a: &mut u64, b: &u64) {
        let sum = *a + b;
        *a = sum.min(sum.wrapping_sub(self.modulus));
    }
    fn neg(&self, a: &u64) -> u64 {
        if *a == 0 { 0 } else { self.modulus - a }
    }
    #[inline(always)]
    fn sub(&self, a: &u64, b: &u64) -> u64 {
        let difference = a.wrapping_sub(*b);
        difference.min(difference.wrapping_add(self.modulus))
    }
    #[inline(always)]
    fn mul(&self, a: &u64, b: &u64) -> u64 {
        self.product(*a, *b)
    }
}

impl RationalAlgebra for PrimePair {
    /// A denominator that p or q divides has no image; zero is returned. A result computed with it
    /// is wrong, which the proof of the reconstructed expansion detects.
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
        // The units are a group of (p - 1) (q - 1).
        let [p, q] = self.primes.map(|p| u64::from(p) - 1);
        let inverse = self.power(*a, p * q - 1);
        (self.product(*a, inverse) == self.one()).then_some(inverse)
    }
    /// An element belongs to many rational numbers.
    fn as_rational(&self, _: &u64) -> Option<Rational> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_integers() {
        let mut list = primes::one_modulo(24);
        let [p, q] = std::array::from_fn(|_| list.next().expect("a prime"));
        let ring = PrimePair::new(p, q);
        let modulus = Integer::from(ring.modulus());
        let mut x = Integer::from(123456789);
        for _ in 0..1000 {
            let y = Integer::from(x.square_ref()) + 987654321;
            let product = ring.mul(&ring.integer(&x), &ring.integer(&y));
            let expected = Integer::from(&x * &y).modulo(&modulus);
            assert_eq!(ring.representative(product), expected);
            let joined = ring.joined(expected.mod_u(p), expected.mod_u(q));
            assert_eq!(joined, product);
            x = y.modulo(&modulus);
        }
        let third = ring.rational(&Rational::from((-2, 3)));
        assert_eq!(ring.scale(&third, &Rational::from((-3, 2))), ring.one());
        assert_eq!(ring.reciprocal(&ring.integer(&Integer::from(p))), None);
        assert_eq!(ring.reciprocal(&0), None);
    }

    #[test]
    fn agrees_with_integers_at_the_ends() {
        let mut list = primes::one_modulo(2);
        let largest: [u32; 2] = std::array::from_fn(|_| list.next().expect("a prime"));
        assert_eq!(PrimePair::largest().primes(), largest);
        for ring in [PrimePair::largest(), PrimePair::new(largest[1], largest[0])] {
            let modulus = Integer::from(ring.modulus());
            let [p, q] = ring.primes();
            // 0, 1, -1 and what is next to them, modulo each of the primes.
            let residues = |p: u32| [0, 1, 2, p / 2, p - 2, p - 1];
            let mut elements = Vec::new();
            for a in residues(p) {
                for b in residues(q) {
                    let x = ring.joined(a, b);
                    let n = ring.representative(x);
                    assert!(x < ring.modulus() && n < ring.modulus());
                    assert_eq!((n % u64::from(p), n % u64::from(q)), (a.into(), b.into()));
                    assert_eq!(ring.integer(&Integer::from(n)), x);
                    let unit = a != 0 && b != 0;
                    let inverse = ring.reciprocal(&x);
                    assert_eq!(inverse.map(|y| ring.mul(&x, &y)), unit.then(|| ring.one()));
                    elements.push((x, Integer::from(n)));
                }
            }
            for (x, m) in &elements {
                assert_eq!(ring.add(x, &ring.neg(x)), 0);
                for (y, n) in &elements {
                    let cases = [
                        (ring.add(x, y), Integer::from(m + n)),
                        (ring.sub(x, y), Integer::from(m - n)),
                        (ring.mul(x, y), Integer::from(m * n)),
                    ];
                    for (found, expected) in cases {
                        assert!(found < ring.modulus());
                        assert_eq!(ring.representative(found), expected.modulo(&modulus));
                    }
                }
            }
            // Integers of every length, whose limbs are all ones, around multiples of M, of either sign.
            for limbs in 1..=9u32 {
                let ones: Integer = (Integer::from(1) << (64 * limbs)) - 1;
                let multiple = Integer::from(&ones / &modulus) * &modulus;
                for n in [ones.clone(), Integer::from(&multiple - 1), multiple + 1] {
                    for n in [Integer::from(-&n), n] {
                        let expected = n.clone().modulo(&modulus);
                        assert_eq!(ring.representative(ring.integer(&n)), expected);
                        let together = ring.integers([&n, &ones].into_iter());
                        assert_eq!(ring.representative(together[0]), expected);
                    }
                }
            }
        }
    }
}
