//! One point modulo two primes, where polynomials in named constants are compared without being multiplied.

use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_coeff::polynomial::power;
use lindstedt_coeff::{Polynomial, Symbol};
use lindstedt_phase::modular::PrimePair;
use rug::{Integer, Rational};
use rustc_hash::FxHashMap;
use std::cell::RefCell;

/// A homomorphism from polynomials in named constants to Z/pq, p and q primes of 30 bits: every symbol has one
/// residue, but for the mu_m those that are given.
///
/// Two polynomials of total degree d that differ have the same image at a random point with a chance of at most
/// (d/p)(d/q) (Schwartz 1980, Zippel 1979, and p, q independent): below 2^-48 for d < 64.
pub(super) struct Point {
    pair: PrimePair,
    /// mu_0, mu_1, ...
    moments: Vec<u64>,
    powers: RefCell<FxHashMap<(Symbol, i16), u64>>,
    denominators: RefCell<FxHashMap<Integer, Option<u64>>>,
}

impl Point {
    /// Every symbol with a residue of its own.
    pub fn new() -> Self {
        Self {
            pair: PrimePair::largest(),
            moments: Vec::new(),
            powers: RefCell::default(),
            denominators: RefCell::default(),
        }
    }

    /// The same point with mu_m in place of its residue; nothing where one has no image.
    pub fn with_moments<'a>(
        mut self,
        moments: impl Iterator<Item = &'a Polynomial>,
    ) -> Option<Self> {
        self.moments = moments.map(|mu| self.image(mu)).collect::<Option<_>>()?;
        self.powers.borrow_mut().clear();
        Some(self)
    }

    /// Z/pq.
    pub fn ring(&self) -> &PrimePair {
        &self.pair
    }

    /// The image of a polynomial; nothing where a denominator or a symbol with a negative exponent has no inverse.
    pub fn image(&self, p: &Polynomial) -> Option<u64> {
        let mut sum = self.pair.zero();
        for (monomial, coefficient) in p.terms() {
            let mut term = self.rational(coefficient)?;
            for &(symbol, exponent) in monomial.factors() {
                term = self.pair.mul(&term, &self.power(symbol, exponent)?);
            }
            self.pair.add_assign(&mut sum, &term);
        }
        Some(sum)
    }

    fn rational(&self, q: &Rational) -> Option<u64> {
        let numerator = self.pair.integer(q.numer());
        if *q.denom() == 1 {
            return Some(numerator);
        }
        let known = self.denominators.borrow().get(q.denom()).copied();
        let inverse = known.unwrap_or_else(|| {
            let inverse = self.pair.reciprocal(&self.pair.integer(q.denom()));
            self.denominators.borrow_mut().insert(q.denom().clone(), inverse);
            inverse
        });
        Some(self.pair.mul(&numerator, &inverse?))
    }

    fn power(&self, symbol: Symbol, exponent: i16) -> Option<u64> {
        if let Some(power) = self.powers.borrow().get(&(symbol, exponent)) {
            return Some(*power);
        }
        let mut base = self.residue(symbol);
        if exponent < 0 {
            base = self.pair.reciprocal(&base)?;
        }
        let power = power(&self.pair, &base, u32::from(exponent.unsigned_abs()));
        self.powers.borrow_mut().insert((symbol, exponent), power);
        Some(power)
    }

    fn residue(&self, symbol: Symbol) -> u64 {
        let (kind, index) = match symbol {
            Symbol::Moment(m) => match self.moments.get(usize::from(m)) {
                Some(residue) => return *residue,
                None => (1, m),
            },
            Symbol::Sum(n) => (2, n),
            Symbol::Zeta(k) => (3, k),
            Symbol::Parameter(index) => (4, index),
            Symbol::LogTwo => (5, 0),
            Symbol::Pi => (6, 0),
        };
        // The finalizer of MurmurHash3, a permutation of 64 bits: residues without a pattern.
        let mut hash = 0x9e37_79b9_7f4a_7c15u64.wrapping_mul((kind << 16) + u64::from(index) + 1);
        hash = (hash ^ (hash >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        hash = (hash ^ (hash >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        self.pair.integer(&Integer::from(hash ^ (hash >> 33)))
    }
}
