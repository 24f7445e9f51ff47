//! Z/p for primes just below 2^61, in Montgomery form.

use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::{Integer, Rational};

/// No prime is taken below this, so that every one of them counts 60.9 bits.
const SMALLEST: u64 = (1 << 61) - (1 << 57);
/// Products that are added up before their sum is folded: 24 p^2 + p 2^64 < 2^127.
const CHUNK: usize = 24;
/// Points whose sums stay in the first cache.
const BLOCK: usize = 64;
/// Rows that are added up in one pass over the sums.
const PASS: usize = 4;
/// Bases that decide the primality of any number below 2^64 (J. Sinclair; the table of strong
/// pseudoprimes to base 2 below 2^64 is J. Feitsma's).
const BASES: [u64; 7] = [2, 325, 9375, 28178, 450_775, 9_780_504, 1_795_265_022];

#[inline(always)]
fn wide(a: u64, b: u64) -> u128 {
    u128::from(a) * u128::from(b)
}

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
    /// Z/p for an odd number in that range; the caller vouches for primality.
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
        let odd = candidates.filter(|n| n % 2 == 1 && n % 3 != 0 && n % 5 != 0 && n % 7 != 0);
        odd.map(Self::new).filter(Self::is_prime)
    }

    /// Whether p is prime: the strong test to bases that no composite number below 2^64 passes.
    fn is_prime(&self) -> bool {
        let twos = (self.prime - 1).trailing_zeros();
        let minus_one = self.neg(&self.one());
        BASES.iter().all(|&base| {
            let base = self.small(base);
            let mut power = self.power(base, (self.prime - 1) >> twos);
            let mut passes = power == self.one() || power == minus_one;
            for _ in 1..twos {
                power = self.mul(&power, &power);
                passes |= power == minus_one;
            }
            passes
        })
    }

    /// p.
    pub fn prime(&self) -> u64 {
        self.prime
    }

    /// t / 2^64 mod p for t < 2^127.
    #[inline(always)]
    fn reduce(&self, t: u128) -> u64 {
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        // The lower halves of t and m p add up to 0 or 2^64.
        let carry = u64::from(t as u64 != 0);
        let mut sum =
            (t >> 64) as u64 + ((u128::from(m) * u128::from(self.prime)) >> 64) as u64 + carry;
        // Below 2^63 + p < 6 p; a difference that wraps around is the larger number.
        for shift in [2, 1, 0] {
            sum = sum.min(sum.wrapping_sub(self.prime << shift));
        }
        sum
    }

    /// a b / 2^64 mod p: the product is below p 2^61, and one subtraction is enough.
    #[inline(always)]
    fn product(&self, a: u64, b: u64) -> u64 {
        let t = u128::from(a) * u128::from(b);
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        let sum = ((t + u128::from(m) * u128::from(self.prime)) >> 64) as u64;
        sum.min(sum.wrapping_sub(self.prime))
    }

    /// t modulo p 2^64, below it, for t < 2^127 < 5 p 2^64.
    #[inline(always)]
    fn fold(&self, mut t: u128) -> u128 {
        for shift in [2, 1, 0] {
            let bound = u128::from(self.prime) << (64 + shift);
            t = if t >= bound { t - bound } else { t };
        }
        t
    }

    /// sum_i a_i b_i with one reduction, over the shorter length.
    #[inline(always)]
    pub(super) fn dot(&self, a: &[u64], b: &[u64]) -> u64 {
        let sum = |a: &[u64], b: &[u64]| -> u128 {
            a.iter().zip(b).map(|(&a, &b)| u128::from(a) * u128::from(b)).sum()
        };
        if a.len() <= CHUNK {
            return self.reduce(sum(a, b));
        }
        let chunks = a.chunks(CHUNK).zip(b.chunks(CHUNK));
        self.reduce(chunks.fold(0, |t, (a, b)| self.fold(t) + sum(a, b)))
    }

    /// a b + c d.
    #[inline(always)]
    pub(super) fn two(&self, a: u64, b: u64, c: u64, d: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(b) + u128::from(c) * u128::from(d))
    }

    /// sum_i a_i[j] b_i[j] for every j < `length`, the length of every row.
    pub(super) fn pointwise(&self, pairs: &[(&[u64], &[u64])], length: usize) -> Vec<u64> {
        let mut result = Vec::with_capacity(length);
        for start in (0..length).step_by(BLOCK) {
            let range = start..length.min(start + BLOCK);
            let mut block = [0u128; BLOCK];
            let sums = &mut block[..range.len()];
            for (done, rows) in pairs.chunks(PASS).enumerate() {
                if let [(a, b), (c, d), (e, f), (g, h)] = rows {
                    let [a, b, c, d] = [a, b, c, d].map(|row| &row[range.clone()]);
                    let [e, f, g, h] = [e, f, g, h].map(|row| &row[range.clone()]);
                    for (j, sum) in sums.iter_mut().enumerate() {
                        *sum += wide(a[j], b[j])
                            + wide(c[j], d[j])
                            + wide(e[j], f[j])
                            + wide(g[j], h[j]);
                    }
                } else {
                    for (a, b) in rows {
                        let (a, b) = (&a[range.clone()], &b[range.clone()]);
                        for ((sum, &x), &y) in sums.iter_mut().zip(a).zip(b) {
                            *sum += wide(x, y);
                        }
                    }
                }
                self.fold_all(sums, done);
            }
            result.extend(sums.iter().map(|&sum| self.reduce(sum)));
        }
        result
    }

    /// sum_i c_i a_i[j] for every j, as long as the longest row.
    pub(super) fn combination(&self, terms: &[(&[u64], u64)]) -> Vec<u64> {
        let longest = terms.iter().map(|(row, _)| row.len()).max().unwrap_or(0);
        let mut result = Vec::with_capacity(longest);
        for start in (0..longest).step_by(BLOCK) {
            let mut block = [0u128; BLOCK];
            let sums = &mut block[..BLOCK.min(longest - start)];
            for (done, rows) in terms.chunks(PASS).enumerate() {
                add_rows(sums, start, rows);
                self.fold_all(sums, done);
            }
            result.extend(sums.iter().map(|&sum| self.reduce(sum)));
        }
        result
    }

    /// After every fifth pass: 20 products are less than 2^127 - p 2^64.
    #[inline(always)]
    fn fold_all(&self, sums: &mut [u128], done: usize) {
        if done % 5 == 4 {
            for sum in sums {
                *sum = self.fold(*sum);
            }
        }
    }

    /// The image of a number below p.
    pub(super) fn small(&self, n: u64) -> u64 {
        self.product(n, self.square)
    }

    /// 1/a for every a, with one inversion; nothing if one of them vanishes.
    pub fn reciprocals(&self, list: &[u64]) -> Option<Vec<u64>> {
        let mut before = Vec::with_capacity(list.len());
        let mut product = self.one();
        for a in list {
            before.push(product);
            product = self.mul(&product, a);
        }
        let mut inverse = self.reciprocal(&product)?;
        for (slot, a) in before.iter_mut().zip(list).rev() {
            *slot = self.mul(slot, &inverse);
            inverse = self.mul(&inverse, a);
        }
        Some(before)
    }

    /// The image of an integer.
    pub fn integer(&self, n: &Integer) -> u64 {
        match n.to_i64() {
            Some(n) if n.unsigned_abs() < self.prime => {
                let image = self.small(n.unsigned_abs());
                if n < 0 { self.neg(&image) } else { image }
            }
            _ => self.limbs(n, &self.limb_images(n.as_limbs().len())),
        }
    }

    /// The images of integers, which share what belongs to the prime.
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

/// Adds c_i a_i\[start + j\] to sum j, over as many as there are.
#[inline(always)]
fn add_rows(sums: &mut [u128], start: usize, rows: &[(&[u64], u64)]) {
    let end = start + sums.len();
    let part = |row| <[u64]>::get(row, start..end.min(row.len())).unwrap_or_default();
    let mut common = 0;
    if let [(a, s), (b, t), (c, u), (d, v)] = rows {
        let [a, b, c, d] = [a, b, c, d].map(|row| part(row));
        common = a.len().min(b.len()).min(c.len()).min(d.len());
        let [a, b, c, d] = [a, b, c, d].map(|row| &row[..common]);
        for (j, sum) in sums[..common].iter_mut().enumerate() {
            *sum += wide(a[j], *s) + wide(b[j], *t) + wide(c[j], *u) + wide(d[j], *v);
        }
    }
    for (row, factor) in rows {
        for (sum, &x) in sums.iter_mut().zip(part(row)).skip(common) {
            *sum += wide(x, *factor);
        }
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
    #[inline(always)]
    fn add_assign(&self, a: &mut u64, b: &u64) {
        let sum = *a + b;
        *a = sum.min(sum.wrapping_sub(self.prime));
    }
    fn neg(&self, a: &u64) -> u64 {
        if *a == 0 { 0 } else { self.prime - a }
    }
    #[inline(always)]
    fn sub(&self, a: &u64, b: &u64) -> u64 {
        let difference = a.wrapping_sub(*b);
        difference.min(difference.wrapping_add(self.prime))
    }
    #[inline(always)]
    fn mul(&self, a: &u64, b: &u64) -> u64 {
        self.product(*a, *b)
    }
    fn sum_of_products(&self, pairs: &[(&u64, &u64)]) -> u64 {
        let products = |part: &[(&u64, &u64)]| -> u128 {
            part.iter().map(|(a, b)| u128::from(**a) * u128::from(**b)).sum()
        };
        let chunks = pairs.chunks(CHUNK);
        self.reduce(chunks.fold(0, |sum, part| self.fold(sum) + products(part)))
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
        // Of every length, all bits set and others, of either sign.
        let mut list = vec![Integer::new(), Integer::from(-1), p.clone(), Integer::from(i64::MIN)];
        for bits in (61..9000).step_by(37) {
            let ones = (Integer::from(1) << bits) - 1u32;
            list.push(Integer::from(-&ones) / 3u32);
            list.push(ones);
        }
        let images = field.integers(list.iter());
        for (n, image) in list.iter().zip(images) {
            assert_eq!(field.representative(image), Integer::from(n.modulo_ref(&p)), "{n}");
            assert_eq!(field.integer(n), image);
        }
        let third = field.rational(&Rational::from((-2, 3)));
        assert_eq!(field.scale(&third, &Rational::from((-3, 2))), field.one());
        let root = field.root_of_unity(24).unwrap_or(0);
        assert_eq!(field.power(root, 24), field.one());
        assert_ne!(field.power(root, 12), field.one());
        assert_ne!(field.power(root, 8), field.one());
    }

    /// Against a test that shares nothing with the field's own.
    #[test]
    fn primes_are_prime_and_none_is_left_out() {
        let (modulus, count) = (8 * 21, 40);
        let primes: Vec<u64> = PrimeField::with_roots_of_unity(modulus, 1 << 61)
            .take(count)
            .map(|field| field.prime())
            .collect();
        let start = (1u64 << 61) / modulus * modulus + 1;
        let expected = (SMALLEST..=start)
            .rev()
            .step_by(modulus as usize)
            .filter(|&n| Integer::from(n).is_probably_prime(40) != rug::integer::IsPrime::No);
        assert!(primes.into_iter().eq(expected.take(count)));
        // Strong pseudoprimes to the first 4, 7 and 9 prime bases.
        for n in [3_215_031_751u64, 341_550_071_728_321, 3_825_123_056_546_413_051] {
            assert!(!PrimeField::new(n).is_prime(), "{n}");
        }
    }

    /// The largest residues there are, in every number of rows, against integers.
    #[test]
    fn long_sums_do_not_overflow() {
        let field = PrimeField::with_roots_of_unity(8, 1 << 61).next().expect("a prime");
        let largest = field.prime() - 1;
        let (row, shorter) = (vec![largest; 70], vec![largest; 50]);
        let square = field.mul(&largest, &largest);
        for count in 1..130u64 {
            let sum = field.mul(&square, &field.small(count));
            let pairs = vec![(&row[..], &row[..]); count as usize];
            assert_eq!(field.pointwise(&pairs, 70), vec![sum; 70], "{count}");
            let mut terms = vec![(&row[..], largest); count as usize];
            assert_eq!(field.combination(&terms), vec![sum; 70], "{count}");
            terms.push((&shorter[..], largest));
            let more = field.add(&sum, &square);
            let expected: Vec<u64> = (0..70).map(|j| if j < 50 { more } else { sum }).collect();
            assert_eq!(field.combination(&terms), expected, "{count}");
            let list = vec![largest; count as usize];
            assert_eq!(field.dot(&list, &list), sum, "{count}");
        }
        let list: Vec<u64> = (1..20).map(|n| field.small(n)).collect();
        let inverses = field.reciprocals(&list).expect("units");
        assert!(list.iter().zip(&inverses).all(|(a, b)| field.mul(a, b) == field.one()));
        assert_eq!(field.reciprocals(&[field.one(), 0]), None);
    }
}
