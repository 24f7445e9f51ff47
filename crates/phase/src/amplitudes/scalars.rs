//! Coefficients of amplitude polynomials: numerators over one common denominator where they are exact.

use lindstedt_algebra::RationalAlgebra;
use lindstedt_number::Whole;
use rug::Rational;
use std::fmt::Debug;

/// Numerators e of coefficients e/d with a common denominator d; rings that are no integers keep d = 1.
pub trait Scalars: Sync {
    /// A numerator.
    type Element: Clone + PartialEq + Debug + Send + Sync;
    /// e/d.
    type Number: Clone + PartialEq + Debug + Send + Sync;
    /// Whether elements cost so much that the products of one monomial are gathered and summed at once; d = 1 then.
    const GATHERS: bool = false;
    /// e and d > 0 of a number.
    fn numerator(&self, number: &Self::Number) -> (Self::Element, Whole);
    /// e/d.
    fn number(&self, e: &Self::Element, d: &Whole) -> Self::Number;
    /// e and d > 0 with q = e/d.
    fn fraction(&self, q: &Rational) -> (Self::Element, Whole);
    /// e/d as a rational number, if it is one.
    fn quotient(&self, e: &Self::Element, d: &Whole) -> Option<Rational>;
    /// A rational number within the enclosure e/d, if it is a number.
    fn middle(&self, e: &Self::Element, d: &Whole) -> Option<Rational> {
        self.quotient(e, d)
    }
    /// n and m > 0 with n/m = d/e; nothing where e cannot be told from zero.
    fn inverse(&self, e: &Self::Element, d: &Whole) -> Option<(Self::Element, Whole)>;
    /// 0.
    fn zero(&self) -> Self::Element;
    /// Whether e = 0.
    fn is_zero(&self, e: &Self::Element) -> bool;
    /// Whether zero is not excluded.
    fn may_vanish(&self, e: &Self::Element) -> bool {
        self.is_zero(e)
    }
    /// sum <- sum + e.
    fn add(&self, sum: &mut Self::Element, e: &Self::Element);
    /// -e.
    fn neg(&self, e: &Self::Element) -> Self::Element;
    /// a b.
    fn product(&self, a: &Self::Element, b: &Self::Element) -> Self::Element;
    /// sum <- sum + a b.
    fn add_product(&self, sum: &mut Self::Element, a: &Self::Element, b: &Self::Element) {
        self.add(sum, &self.product(a, b));
    }
    /// sum a_k b_k.
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let mut sum = self.zero();
        pairs.iter().for_each(|(a, b)| self.add_product(&mut sum, a, b));
        sum
    }
    /// q e as a numerator, where d = 1 for all; [`Self::GATHERS`].
    fn scale(&self, e: &Self::Element, q: &Rational) -> Self::Element {
        self.product(e, &self.fraction(q).0)
    }
    /// n e for a small n.
    fn multiple(&self, e: &Self::Element, n: i32) -> Self::Element {
        self.times(e, &Whole::from(i64::from(n)))
    }
    /// n e.
    fn times(&self, e: &Self::Element, n: &Whole) -> Self::Element;
    /// g <- gcd(g, e); 1 where elements have no divisors.
    fn content(&self, g: &mut Whole, e: &Self::Element);
    /// e <- e/n for a divisor n.
    fn divide(&self, e: &mut Self::Element, n: &Whole);
}

/// The integers: coefficients in Q.
#[derive(Clone, Copy, Debug, Default)]
pub struct Integers;

impl Scalars for Integers {
    type Element = Whole;
    type Number = Rational;

    fn numerator(&self, number: &Rational) -> (Whole, Whole) {
        self.fraction(number)
    }
    fn number(&self, e: &Whole, d: &Whole) -> Rational {
        e.over(d)
    }
    fn fraction(&self, q: &Rational) -> (Whole, Whole) {
        (Whole::from(q.numer()), Whole::from(q.denom()))
    }
    fn quotient(&self, e: &Whole, d: &Whole) -> Option<Rational> {
        Some(e.over(d))
    }
    fn inverse(&self, e: &Whole, d: &Whole) -> Option<(Whole, Whole)> {
        (!e.is_zero()).then(|| self.fraction(&e.over(d).recip()))
    }
    fn zero(&self) -> Whole {
        Whole::ZERO
    }
    #[inline]
    fn is_zero(&self, e: &Whole) -> bool {
        e.is_zero()
    }
    #[inline]
    fn add(&self, sum: &mut Whole, e: &Whole) {
        sum.add(e);
    }
    fn neg(&self, e: &Whole) -> Whole {
        e.neg()
    }
    fn product(&self, a: &Whole, b: &Whole) -> Whole {
        a.mul(b)
    }
    #[inline]
    fn add_product(&self, sum: &mut Whole, a: &Whole, b: &Whole) {
        sum.add_product(a, b);
    }
    fn multiple(&self, e: &Whole, n: i32) -> Whole {
        e.mul(&Whole::from(i64::from(n)))
    }
    fn times(&self, e: &Whole, n: &Whole) -> Whole {
        e.mul(n)
    }
    fn content(&self, g: &mut Whole, e: &Whole) {
        e.gcd(g);
    }
    fn divide(&self, e: &mut Whole, n: &Whole) {
        e.divide(n);
    }
}

/// Any algebra over Q: balls, doubles, fractions of parameters; with what a number of it is about.
#[derive(Clone, Copy, Debug)]
pub struct Over<K: RationalAlgebra> {
    ring: K,
    middle: fn(&K, &K::Element) -> Option<Rational>,
}

impl<K: RationalAlgebra> Over<K> {
    /// An exact ring.
    pub fn exact(ring: K) -> Self {
        Self { ring, middle: K::as_rational }
    }

    /// A ring of enclosures and the middle of one.
    pub fn enclosures(ring: K, middle: fn(&K, &K::Element) -> Option<Rational>) -> Self {
        Self { ring, middle }
    }
}

impl<K: RationalAlgebra> Scalars for Over<K> {
    type Element = K::Element;
    type Number = K::Element;
    const GATHERS: bool = true;

    fn numerator(&self, number: &K::Element) -> (K::Element, Whole) {
        (number.clone(), Whole::ONE)
    }
    fn number(&self, e: &K::Element, d: &Whole) -> K::Element {
        if *d == Whole::ONE { e.clone() } else { self.ring.scale(e, &Whole::ONE.over(d)) }
    }
    fn sum_of_products(&self, pairs: &[(&K::Element, &K::Element)]) -> K::Element {
        self.ring.sum_of_products(pairs)
    }
    fn fraction(&self, q: &Rational) -> (K::Element, Whole) {
        (self.ring.rational(q), Whole::ONE)
    }
    fn quotient(&self, e: &K::Element, _: &Whole) -> Option<Rational> {
        self.ring.as_rational(e)
    }
    fn middle(&self, e: &K::Element, _: &Whole) -> Option<Rational> {
        (self.middle)(&self.ring, e)
    }
    fn inverse(&self, e: &K::Element, d: &Whole) -> Option<(K::Element, Whole)> {
        if self.ring.may_vanish(e) {
            return None;
        }
        let inverse = self.ring.reciprocal(e)?;
        Some((self.ring.scale(&inverse, &d.over(&Whole::ONE)), Whole::ONE))
    }
    fn zero(&self) -> K::Element {
        self.ring.zero()
    }
    fn is_zero(&self, e: &K::Element) -> bool {
        self.ring.is_zero(e)
    }
    fn may_vanish(&self, e: &K::Element) -> bool {
        self.ring.may_vanish(e)
    }
    fn add(&self, sum: &mut K::Element, e: &K::Element) {
        self.ring.add_assign(sum, e);
    }
    fn neg(&self, e: &K::Element) -> K::Element {
        self.ring.neg(e)
    }
    fn product(&self, a: &K::Element, b: &K::Element) -> K::Element {
        self.ring.mul(a, b)
    }
    fn scale(&self, e: &K::Element, q: &Rational) -> K::Element {
        if *q == 1 || self.ring.is_zero(e) { e.clone() } else { self.ring.scale(e, q) }
    }
    fn times(&self, e: &K::Element, n: &Whole) -> K::Element {
        self.ring.scale(e, &n.over(&Whole::ONE))
    }
    fn content(&self, g: &mut Whole, _: &K::Element) {
        *g = Whole::ONE;
    }
    fn divide(&self, _: &mut K::Element, _: &Whole) {}
}
