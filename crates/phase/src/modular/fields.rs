//! Z/p_1 x ... x Z/p_8 for primes just below 2^30: one prime per lane of a vector, in Montgomery form.
//!
//! What is done modulo one prime is done modulo all eight by the same instructions. Sums of products are added up in
//! 64 bits, twelve products between two folds, and reduced once; long loops are written for the vectors that there are,
//! and the processor decides (`words`).

mod shared;

use super::pair::PrimePair;
use super::primes;
pub use super::words::{LANES, Residues};
use super::words::{Plain, Words, padded};
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::{Integer, Rational};
use shared::{Shared, SumsOfProducts};

/// Sums not yet reduced.
type Sums = [u64; LANES];

const ZERO: Residues = [0; LANES];
/// Products that are added up before their sum is folded: 12 (p - 1)^2 + 2^32 p < 2^64.
const CHUNK: usize = 12;

/// The product of the fields Z/p of eight primes. It has zero divisors: what vanishes modulo one of the primes is
/// not zero, and has no reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct PrimeFields {
    primes: Residues,
    /// -1/p mod 2^32.
    negative_inverses: Residues,
    /// 2^32 mod p and 2^64 mod p.
    ones: Residues,
    squares: Residues,
    pairs: [PrimePair; LANES / 2],
    arch: pulp::Arch,
}

/// f of every lane.
#[inline(always)]
fn each(f: impl Fn(usize) -> u32) -> Residues {
    std::array::from_fn(f)
}

impl PrimeFields {
    /// The next eight of a list of odd primes below 2^30; nothing when there are not so many.
    fn new(list: &mut impl Iterator<Item = u32>) -> Option<Self> {
        let mut primes = ZERO;
        for slot in &mut primes {
            *slot = list.next()?;
        }
        // Newton's iteration doubles the correct bits of 1/p mod 2^32.
        let inverse =
            |p: u32| (0..5).fold(p, |q, _| q.wrapping_mul(2u32.wrapping_sub(p.wrapping_mul(q))));
        let power = |p: u32, bits: u32| ((1u128 << bits) % u128::from(p)) as u32;
        let pairs = std::array::from_fn(|i| PrimePair::new(primes[2 * i], primes[2 * i + 1]));
        Some(Self {
            primes,
            negative_inverses: primes.map(|p| inverse(p).wrapping_neg()),
            ones: primes.map(|p| power(p, 32)),
            squares: primes.map(|p| power(p, 64)),
            pairs,
            arch: pulp::Arch::new(),
        })
    }

    /// The largest primes below 2^30 that are 1 modulo `modulus`, eight at a time, descending.
    pub fn with_roots_of_unity(modulus: u64) -> impl Iterator<Item = Self> {
        let mut list = primes::one_modulo(modulus);
        std::iter::from_fn(move || Self::new(&mut list))
    }

    /// The primes.
    pub fn primes(&self) -> [u32; LANES] {
        self.primes
    }

    /// The same primes as moduli of 60 bits, by which numbers leave and enter.
    pub fn pairs(&self) -> &[PrimePair; LANES / 2] {
        &self.pairs
    }

    #[cfg(test)]
    pub(super) fn on_every_processor(self) -> Vec<Self> {
        let mut list = Vec::new();
        for arch in tests::arches() {
            list.push(Self { arch, ..self });
        }
        list
    }

    /// Runs a kernel on the vectors of this processor.
    pub(super) fn vectorised<K: Kernel>(&self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        match self.arch {
            pulp::Arch::V4(words) => return pulp::Simd::vectorize(words, On(kernel, words)),
            pulp::Arch::V3(words) => return pulp::Simd::vectorize(words, On(kernel, words)),
            _ => {
                if let Some(words) = pulp::x86::V1::try_new() {
                    return kernel.run(words);
                }
            }
        }
        kernel.run(Plain)
    }

    /// t / 2^32 mod p for t < 2^32 p.
    #[inline(always)]
    fn reduce(&self, t: &Sums) -> Residues {
        each(|l| {
            let m = (t[l] as u32).wrapping_mul(self.negative_inverses[l]);
            let sum = ((t[l] + u64::from(m) * u64::from(self.primes[l])) >> 32) as u32;
            // A difference that wraps around is the larger number.
            sum.min(sum.wrapping_sub(self.primes[l]))
        })
    }

    /// A congruent number below 2^32 p: at most (2^32 - 1) (p - 1) + 2^32 - 1.
    #[inline(always)]
    fn fold(&self, t: &mut Sums) {
        for (t, one) in t.iter_mut().zip(&self.ones) {
            *t = (*t >> 32) * u64::from(*one) + (*t & 0xffff_ffff);
        }
    }

    #[inline(always)]
    fn reduce_any(&self, mut t: Sums) -> Residues {
        self.fold(&mut t);
        self.reduce(&t)
    }

    #[inline(always)]
    pub(super) fn product(&self, a: &Residues, b: &Residues) -> Residues {
        self.reduce(&std::array::from_fn(|l| u64::from(a[l]) * u64::from(b[l])))
    }

    #[inline(always)]
    pub(super) fn sum(&self, a: &Residues, b: &Residues) -> Residues {
        each(|l| {
            let sum = a[l] + b[l];
            sum.min(sum.wrapping_sub(self.primes[l]))
        })
    }

    #[inline(always)]
    pub(super) fn difference(&self, a: &Residues, b: &Residues) -> Residues {
        each(|l| {
            let difference = a[l].wrapping_sub(b[l]);
            difference.min(difference.wrapping_add(self.primes[l]))
        })
    }

    /// sum_i a_i\[j\] b_i\[j\] for every j < `length`, the length of every row.
    pub(super) fn pointwise(
        &self,
        pairs: &[(&[Residues], &[Residues])],
        length: usize,
    ) -> Vec<Residues> {
        self.vectorised(SumOfProducts { fields: self, pairs, length })
    }

    /// The same for several sums that share their rows, of which every part is read once.
    pub(super) fn sums<'a, B: Shared<'a>>(
        &'a self,
        sums: &[Vec<(&'a [Residues], B)>],
    ) -> Vec<Vec<Residues>> {
        match sums {
            [pairs] => {
                let length = longest(pairs);
                vec![self.vectorised(SumOfProducts { fields: self, pairs, length })]
            }
            _ => self.vectorised(SumsOfProducts::new(self, sums)),
        }
    }

    /// sum_i c_i a_i\[j\] for every j, as long as the longest row.
    pub(super) fn combination(&self, terms: &[(&[Residues], Residues)]) -> Vec<Residues> {
        self.vectorised(SumOfProducts { fields: self, pairs: terms, length: longest(terms) })
    }

    /// 1/a for every a, with one inversion; nothing if one of them is no unit.
    pub fn reciprocals(&self, list: &[Residues]) -> Option<Vec<Residues>> {
        let mut before = Vec::with_capacity(list.len());
        let mut product = self.one();
        for a in list {
            before.push(product);
            product = self.product(&product, a);
        }
        let mut inverse = self.reciprocal(&product)?;
        for (slot, a) in before.iter_mut().zip(list).rev() {
            *slot = self.product(slot, &inverse);
            inverse = self.product(&inverse, a);
        }
        Some(before)
    }

    /// The image of an integer.
    pub fn integer(&self, n: &Integer) -> Residues {
        self.joined(&self.pairs.map(|pair| pair.integer(n)))
    }

    /// The images of integers, which share what belongs to the primes.
    pub fn integers<'a>(&self, list: impl Iterator<Item = &'a Integer> + Clone) -> Vec<Residues> {
        let parts = self.pairs.map(|pair| pair.integers(list.clone()));
        let join = |i: usize| self.joined(&parts.each_ref().map(|part| part[i]));
        (0..parts[0].len()).map(join).collect()
    }

    /// The number with those residues modulo the pairs.
    pub fn joined(&self, parts: &[u64; LANES / 2]) -> Residues {
        let plain: [u64; LANES / 2] =
            std::array::from_fn(|i| self.pairs[i].representative(parts[i]));
        let lanes = each(|l| (plain[l / 2] % u64::from(self.primes[l])) as u32);
        self.product(&lanes, &self.squares)
    }

    /// The residues of a number modulo the pairs.
    pub fn parted(&self, a: &Residues) -> [u64; LANES / 2] {
        let plain = self.reduce(&a.map(u64::from));
        std::array::from_fn(|i| self.pairs[i].joined(plain[2 * i], plain[2 * i + 1]))
    }

    /// a^n, another n in every lane.
    fn powers(&self, a: &Residues, mut exponents: Residues) -> Residues {
        let (mut result, mut square) = (self.ones, *a);
        while exponents != ZERO {
            let next = self.product(&result, &square);
            result = each(|l| if exponents[l] & 1 == 1 { next[l] } else { result[l] });
            square = self.product(&square, &square);
            exponents = exponents.map(|n| n >> 1);
        }
        result
    }

    /// a^n.
    pub fn power(&self, a: &Residues, exponent: u32) -> Residues {
        self.powers(a, [exponent; LANES])
    }

    /// An element of exact multiplicative order n modulo every prime, for n that divides every p - 1.
    pub fn root_of_unity(&self, n: u64) -> Option<Residues> {
        let mut roots = ZERO;
        for (root, &p) in roots.iter_mut().zip(&self.primes) {
            *root = primes::root_of_unity(p, n)?;
        }
        Some(self.product(&roots, &self.squares))
    }
}

/// What is written once for all vectors; all that it calls must be inlined.
pub(super) trait Kernel {
    type Output;
    fn run<W: Words>(self, words: W) -> Self::Output;
}

/// A kernel compiled for certain vectors.
struct On<K, W>(K, W);

impl<K: Kernel, W: Words> pulp::NullaryFnOnce for On<K, W> {
    type Output = K::Output;

    #[inline(always)]
    fn call(self) -> K::Output {
        self.0.run(self.1)
    }
}

/// The primes as they are needed at even and at odd places.
#[derive(Clone, Copy)]
pub(super) struct Moduli<W: Words> {
    words: W,
    primes: [W::Word; 2],
    negative_inverses: [W::Word; 2],
    ones: [W::Word; 2],
}

/// A number at all points, as it is and with its odd places shifted to the even ones.
#[inline(always)]
fn halves<W: Words>(words: W, row: &Residues) -> [W::Word; 2] {
    let word = words.same(row);
    [word, words.high(word)]
}

impl<W: Words> Moduli<W> {
    #[inline(always)]
    pub(super) fn new(words: W, fields: &PrimeFields) -> Self {
        Self {
            words,
            primes: halves(words, &fields.primes),
            negative_inverses: halves(words, &fields.negative_inverses),
            ones: halves(words, &fields.ones),
        }
    }

    #[inline(always)]
    fn zero(&self) -> [W::Word; 2] {
        [self.words.same(&ZERO); 2]
    }

    /// t + a b.
    #[inline(always)]
    fn accumulate(&self, [even, odd]: [W::Word; 2], a: W::Word, b: W::Word) -> [W::Word; 2] {
        let words = self.words;
        [words.accumulate(even, a, b), words.accumulate(odd, words.high(a), words.high(b))]
    }

    #[inline(always)]
    fn fold(&self, t: [W::Word; 2]) -> [W::Word; 2] {
        [self.words.fold(t[0], self.ones[0]), self.words.fold(t[1], self.ones[1])]
    }

    /// t / 2^32 mod p for t < 2^32 p.
    #[inline(always)]
    fn reduce(&self, t: [W::Word; 2]) -> W::Word {
        self.words.join(self.reduce_half(t[0], 0), self.reduce_half(t[1], 1), self.primes[0])
    }

    /// The multiple of 2^32 that t becomes with a multiple of p.
    #[inline(always)]
    fn reduce_half(&self, t: W::Word, i: usize) -> W::Word {
        let multiple = self.words.product(t, self.negative_inverses[i]);
        self.words.accumulate(t, multiple, self.primes[i])
    }

    /// sum_i a_i\[j\] b_i\[j\] for every j of `sums`, zero where a row has ended.
    #[inline(always)]
    pub(super) fn sum_of_products<B: Factor>(
        &self,
        pairs: &[(&[Residues], B)],
        sums: &mut [Residues],
    ) {
        if pairs.len() <= CHUNK {
            for (tile, sums) in sums.chunks_mut(W::ROWS).enumerate() {
                let t = self.add_products(self.zero(), pairs, tile * W::ROWS);
                self.words.store(self.reduce(self.fold(t)), sums);
            }
            return;
        }
        let mut list = vec![self.zero(); sums.len().div_ceil(W::ROWS)];
        // A few rows from end to end, so that the processor foresees what is read next.
        for pairs in pairs.chunks(CHUNK) {
            for (tile, t) in list.iter_mut().enumerate() {
                *t = self.add_products(self.fold(*t), pairs, tile * W::ROWS);
            }
        }
        for (t, sums) in list.into_iter().zip(sums.chunks_mut(W::ROWS)) {
            self.words.store(self.reduce(self.fold(t)), sums);
        }
    }

    /// The sum of some products at the points of one word.
    #[inline(always)]
    pub(super) fn sum_of_words(
        &self,
        mut pairs: impl ExactSizeIterator<Item = (W::Word, W::Word)>,
        sums: &mut [Residues],
    ) {
        let mut t = self.zero();
        while pairs.len() > 0 {
            t = self.fold(t);
            for (a, b) in pairs.by_ref().take(CHUNK) {
                t = self.accumulate(t, a, b);
            }
        }
        self.words.store(self.reduce(self.fold(t)), sums);
    }

    /// t + sum_i a_i b_i at the points of one word.
    #[inline(always)]
    fn add_products<B: Factor>(
        &self,
        mut t: [W::Word; 2],
        pairs: &[(&[Residues], B)],
        start: usize,
    ) -> [W::Word; 2] {
        for (a, b) in pairs {
            if a.len() > start {
                let a = padded(self.words, a, start);
                t = self.accumulate(t, a, b.word(self.words, start));
            }
        }
        t
    }

    /// sum_j m\[j\]\[k\] x_j for every k of `sums`; the rows of the matrix are `stride` apart and as long, a multiple of
    /// the points in a word.
    #[inline(always)]
    pub(super) fn matrix(
        &self,
        matrix: &[Residues],
        stride: usize,
        x: &[Residues],
        sums: &mut [Residues],
    ) {
        for (tile, sums) in sums.chunks_mut(W::ROWS).enumerate() {
            let mut t = self.zero();
            for (rows, x) in matrix.chunks(CHUNK * stride).zip(x.chunks(CHUNK)) {
                t = self.fold(t);
                for (row, x) in rows.chunks_exact(stride).zip(x) {
                    let row = self.words.load(&row[tile * W::ROWS..][..W::ROWS]);
                    t = self.accumulate(t, row, self.words.same(x));
                }
            }
            self.words.store(self.reduce(self.fold(t)), sums);
        }
    }

    /// a_j b_j in place of a_j.
    #[inline(always)]
    pub(super) fn multiply(&self, a: &mut [Residues], b: &[Residues]) {
        for (tile, a) in a.chunks_mut(W::ROWS).enumerate() {
            let word = padded(self.words, a, 0);
            let t = self.accumulate(self.zero(), word, padded(self.words, b, tile * W::ROWS));
            self.words.store(self.reduce(t), a);
        }
    }
}

/// Factors of one product in every place: a row, or one number.
pub(super) trait Factor: Copy {
    fn word<W: Words>(self, words: W, start: usize) -> W::Word;
}

impl Factor for &[Residues] {
    #[inline(always)]
    fn word<W: Words>(self, words: W, start: usize) -> W::Word {
        padded(words, self, start)
    }
}

impl Factor for Residues {
    #[inline(always)]
    fn word<W: Words>(self, words: W, _: usize) -> W::Word {
        words.same(&self)
    }
}

struct SumOfProducts<'a, B> {
    fields: &'a PrimeFields,
    pairs: &'a [(&'a [Residues], B)],
    length: usize,
}

impl<B: Factor> Kernel for SumOfProducts<'_, B> {
    type Output = Vec<Residues>;

    #[inline(always)]
    fn run<W: Words>(self, words: W) -> Vec<Residues> {
        let mut sums = vec![ZERO; self.length];
        Moduli::new(words, self.fields).sum_of_products(self.pairs, &mut sums);
        sums
    }
}

/// The length of the longest first factor.
pub(super) fn longest<B>(pairs: &[(&[Residues], B)]) -> usize {
    pairs.iter().map(|(row, _)| row.len()).max().unwrap_or(0)
}

/// t + a b.
#[inline(always)]
fn accumulate(t: &mut Sums, a: &Residues, b: &Residues) {
    for l in 0..LANES {
        t[l] += u64::from(a[l]) * u64::from(b[l]);
    }
}

impl Ring for PrimeFields {
    type Element = Residues;

    fn zero(&self) -> Residues {
        ZERO
    }
    fn one(&self) -> Residues {
        self.ones
    }
    fn is_zero(&self, a: &Residues) -> bool {
        *a == ZERO
    }
    fn add_assign(&self, a: &mut Residues, b: &Residues) {
        *a = self.sum(a, b);
    }
    fn neg(&self, a: &Residues) -> Residues {
        self.difference(&ZERO, a)
    }
    fn sub(&self, a: &Residues, b: &Residues) -> Residues {
        self.difference(a, b)
    }
    fn mul(&self, a: &Residues, b: &Residues) -> Residues {
        self.product(a, b)
    }
    fn sum_of_products(&self, pairs: &[(&Residues, &Residues)]) -> Residues {
        let mut t = [0; LANES];
        for pairs in pairs.chunks(CHUNK) {
            self.fold(&mut t);
            for (a, b) in pairs {
                accumulate(&mut t, a, b);
            }
        }
        self.reduce_any(t)
    }
}

impl RationalAlgebra for PrimeFields {
    /// A denominator that one of the primes divides has no image; zero is returned. A result computed with it
    /// is wrong, which the proof of the reconstructed expansion detects.
    fn rational(&self, q: &Rational) -> Residues {
        let numerator = self.integer(q.numer());
        if *q.denom() == 1 {
            return numerator;
        }
        let denominator = self.reciprocal(&self.integer(q.denom())).unwrap_or(ZERO);
        self.product(&numerator, &denominator)
    }
    fn scale(&self, a: &Residues, q: &Rational) -> Residues {
        self.product(a, &self.rational(q))
    }
    fn reciprocal(&self, a: &Residues) -> Option<Residues> {
        let is_unit = a.iter().all(|&a| a != 0);
        is_unit.then(|| self.powers(a, self.primes.map(|p| p - 2)))
    }
    /// An element belongs to many rational numbers.
    fn as_rational(&self, _: &Residues) -> Option<Rational> {
        None
    }
}

#[cfg(test)]
mod tests;
