//! Sparse polynomials: a sorted list of monomials with their coefficients.
//!
//! The representation shared by the polynomials in named constants, their exponents in a list or in one word
//! (coefficients in Q), by those in the amplitude and by the Lobachevsky ring (coefficients in a ring of constants).
//! Canonical: monomials strictly increasing, no coefficient zero, so that equality of lists is equality of polynomials.

use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;
use rustc_hash::FxHashMap;
use std::cmp::Ordering;
use std::fmt::Debug;
use std::hash::Hash;

/// A power product that multiplies.
pub trait Monomial: Clone + Ord + Hash + Debug + Send + Sync {
    /// The empty product.
    fn unit() -> Self;
    /// The product of two power products.
    fn times(&self, other: &Self) -> Self;
}

/// Sorts by numbers, where all have one, and else as `compare` says.
pub(crate) fn sort_by_rank<T, K: Ord>(
    list: &mut [T],
    rank: impl Fn(&T) -> Option<K>,
    compare: impl Fn(&T, &T) -> Ordering,
) {
    if list.iter().all(|t| rank(t).is_some()) {
        list.sort_by_cached_key(rank);
    } else {
        list.sort_by(compare);
    }
}

/// A polynomial: monomials strictly increasing, coefficients nonzero.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse<M, E> {
    terms: Vec<(M, E)>,
}

impl<M, E> Default for Sparse<M, E> {
    fn default() -> Self {
        Self { terms: Vec::new() }
    }
}

impl<M: Monomial, E: Clone + PartialEq + Debug + Send + Sync> Sparse<M, E> {
    /// The polynomial with the single term `coefficient * monomial`.
    pub fn term<R: Ring<Element = E>>(ring: &R, monomial: M, coefficient: E) -> Self {
        if ring.is_zero(&coefficient) {
            return Self::default();
        }
        Self { terms: vec![(monomial, coefficient)] }
    }

    /// Collects terms in any order, adding up equal monomials.
    pub fn collect<R: Ring<Element = E>>(
        ring: &R,
        terms: impl IntoIterator<Item = (M, E)>,
    ) -> Self {
        let mut sum = Accumulator::default();
        for (monomial, coefficient) in terms {
            sum.add(ring, monomial, coefficient);
        }
        sum.finish(ring)
    }

    /// The polynomial with these terms, none of which is zero; nothing unless the monomials increase strictly.
    pub fn from_increasing(mut terms: Vec<(M, E)>) -> Option<Self> {
        terms.shrink_to_fit();
        let increases = terms.is_sorted_by(|(m, _), (n, _)| m < n);
        increases.then_some(Self { terms })
    }

    /// The polynomial with these terms, of different monomials, none of which is zero.
    pub fn from_different(
        mut terms: Vec<(M, E)>,
        rank: impl Fn(&M) -> Option<u128>,
    ) -> Option<Self> {
        sort_by_rank(&mut terms, |(m, _)| rank(m), |(m, _), (n, _)| m.cmp(n));
        Self::from_increasing(terms)
    }

    /// The terms in increasing order of monomials.
    pub fn terms(&self) -> &[(M, E)] {
        &self.terms
    }

    /// The terms in increasing order of monomials.
    pub fn into_terms(self) -> impl Iterator<Item = (M, E)> {
        self.terms.into_iter()
    }

    /// Whether there is no term.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The coefficient of a monomial, if it occurs.
    pub fn coefficient(&self, monomial: &M) -> Option<&E> {
        let found = self.terms.binary_search_by(|(m, _)| m.cmp(monomial));
        found.ok().map(|index| &self.terms[index].1)
    }

    /// self <- self + other, by merging the sorted lists.
    pub fn add_assign<R: Ring<Element = E>>(&mut self, ring: &R, other: &Self) {
        if self.is_zero() {
            self.terms.clone_from(&other.terms);
            return;
        }
        if other.is_zero() {
            return;
        }
        let mut merged = Vec::with_capacity(self.terms.len() + other.terms.len());
        let mut right = other.terms.iter().peekable();
        for (monomial, mut coefficient) in std::mem::take(&mut self.terms) {
            while let Some(term) = right.next_if(|(m, _)| m.cmp(&monomial) == Ordering::Less) {
                merged.push(term.clone());
            }
            if let Some((_, addend)) = right.next_if(|(m, _)| *m == monomial) {
                ring.add_assign(&mut coefficient, addend);
                if ring.is_zero(&coefficient) {
                    continue;
                }
            }
            merged.push((monomial, coefficient));
        }
        merged.extend(right.cloned());
        self.terms = merged;
    }

    /// Applies a map that sends nonzero coefficients to anything and keeps the monomials.
    #[must_use]
    pub fn map<R: Ring<Element = E>>(&self, ring: &R, f: impl Fn(&E) -> E) -> Self {
        let image = self.terms.iter().map(|(m, c)| (m.clone(), f(c)));
        Self { terms: image.filter(|(_, c)| !ring.is_zero(c)).collect() }
    }

    /// -self.
    #[must_use]
    pub fn neg<R: Ring<Element = E>>(&self, ring: &R) -> Self {
        self.map(ring, |c| ring.neg(c))
    }

    /// q self for a rational number q.
    #[must_use]
    pub fn scale<R: RationalAlgebra<Element = E>>(&self, ring: &R, q: &Rational) -> Self {
        self.map(ring, |c| ring.scale(c, q))
    }

    /// self * other.
    #[must_use]
    pub fn mul<R: Ring<Element = E>>(&self, ring: &R, other: &Self) -> Self {
        let mut product = Accumulator::default();
        product.add_product(ring, self, other);
        product.finish(ring)
    }
}

/// A sum of products under construction: terms in a hash table, sorted once at the end.
#[derive(Debug)]
pub struct Accumulator<M, E> {
    terms: FxHashMap<M, E>,
}

impl<M, E> Default for Accumulator<M, E> {
    fn default() -> Self {
        Self { terms: FxHashMap::default() }
    }
}

impl<M: Monomial, E: Clone + PartialEq + Debug + Send + Sync> Accumulator<M, E> {
    /// Adds one term.
    pub fn add<R: Ring<Element = E>>(&mut self, ring: &R, monomial: M, coefficient: E) {
        use std::collections::hash_map::Entry;
        match self.terms.entry(monomial) {
            Entry::Occupied(mut entry) => ring.add_assign(entry.get_mut(), &coefficient),
            Entry::Vacant(entry) => {
                entry.insert(coefficient);
            }
        }
    }

    /// Adds a product of polynomials.
    pub fn add_product<R: Ring<Element = E>>(
        &mut self,
        ring: &R,
        a: &Sparse<M, E>,
        b: &Sparse<M, E>,
    ) {
        self.add_product_while(ring, a, b, &|| true);
    }

    /// Adds a product of polynomials as long as `go_on`, which is asked once per term of `a`, says
    /// so; whether it was finished.
    pub fn add_product_while<R: Ring<Element = E>>(
        &mut self,
        ring: &R,
        a: &Sparse<M, E>,
        b: &Sparse<M, E>,
        go_on: &dyn Fn() -> bool,
    ) -> bool {
        for (m, x) in &a.terms {
            if !go_on() {
                return false;
            }
            for (n, y) in &b.terms {
                self.add(ring, m.times(n), ring.mul(x, y));
            }
        }
        true
    }

    /// The sorted polynomial.
    pub fn finish<R: Ring<Element = E>>(self, ring: &R) -> Sparse<M, E> {
        let mut terms: Vec<_> = self.terms.into_iter().filter(|(_, c)| !ring.is_zero(c)).collect();
        terms.sort_unstable_by(|(m, _), (n, _)| m.cmp(n));
        Sparse { terms }
    }
}
