//! Polynomials with rational coefficients in numbered variables, and systems of them as functions of doubles and of
//! intervals.

use super::value::Value;
use lindstedt_number::interval::Interval;
use rug::Rational;
use std::collections::BTreeMap;
use std::ops::{Add, Mul};

/// A polynomial: exponents of the variables (missing ones are 0) with coefficients, none of which is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    pub(super) terms: BTreeMap<Vec<u32>, Coefficient>,
}

/// Any number within a radius of a rational one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Coefficient {
    pub(super) middle: Rational,
    pub(super) radius: f64,
}

impl Coefficient {
    fn times(&self, other: &Self) -> Self {
        let middle = Rational::from(&self.middle * &other.middle);
        if self.radius == 0.0 && other.radius == 0.0 {
            return Self { middle, radius: 0.0 };
        }
        let [a, b] = [self, other].map(|c| Interval::point(Interval::of(&c.middle).above()));
        let [r, s] = [self, other].map(|c| Interval::point(c.radius));
        Self { middle, radius: (a * s + b * r + r * s).above() }
    }
}

impl Polynomial {
    /// Adds q times a monomial.
    pub fn add_term(&mut self, exponents: &[u32], q: &Rational) {
        self.put(exponents, &Coefficient { middle: q.clone(), radius: 0.0 });
    }

    fn put(&mut self, exponents: &[u32], c: &Coefficient) {
        let used = exponents.iter().rposition(|e| *e > 0).map_or(0, |last| last + 1);
        let key = exponents[..used].to_vec();
        let mut sum = self.terms.remove(&key).unwrap_or_default();
        sum.middle += &c.middle;
        if c.radius != 0.0 {
            sum.radius = (Interval::point(sum.radius) + Interval::point(c.radius)).above();
        }
        if sum != Coefficient::default() {
            self.terms.insert(key, sum);
        }
    }

    /// The variable i.
    #[must_use]
    pub fn variable(i: usize) -> Self {
        let mut exponents = vec![0; i + 1];
        exponents[i] = 1;
        let mut variable = Self::default();
        variable.add_term(&exponents, &Rational::from(1));
        variable
    }

    /// A constant.
    #[must_use]
    pub fn constant(q: Rational) -> Self {
        Self::within(q, 0.0)
    }

    /// Any constant within a radius of a rational number.
    #[must_use]
    pub fn within(middle: Rational, radius: f64) -> Self {
        let mut constant = Self::default();
        constant.put(&[], &Coefficient { middle, radius });
        constant
    }

    /// The same in the variables n, n + 1, ...
    #[must_use]
    pub fn after(&self, n: usize) -> Self {
        let moved = |(exponents, c): (&Vec<u32>, &Coefficient)| {
            let all = std::iter::repeat_n(0, if exponents.is_empty() { 0 } else { n });
            (all.chain(exponents.iter().copied()).collect(), c.clone())
        };
        Self { terms: self.terms.iter().map(moved).collect() }
    }

    /// Whether both are single terms, one a positive number times the other.
    #[must_use]
    pub fn is_positive_times(&self, other: &Self) -> bool {
        let single = |p: &Self| p.terms.len() == 1;
        let sign = |p: &Self| p.terms.values().all(|c| c.middle > 0);
        single(self) && self.terms.keys().eq(other.terms.keys()) && sign(self) == sign(other)
    }

    /// The derivative by the variable i.
    #[must_use]
    pub fn by(&self, i: usize) -> Self {
        let mut derivative = Self::default();
        for (exponents, c) in &self.terms {
            if let Some(e) = exponents.get(i).copied().filter(|e| *e > 0) {
                let mut lower = exponents.clone();
                lower[i] -= 1;
                let power = Coefficient { middle: e.into(), radius: 0.0 };
                derivative.put(&lower, &c.times(&power));
            }
        }
        derivative
    }
}

impl Add<&Polynomial> for Polynomial {
    type Output = Self;
    fn add(mut self, other: &Self) -> Self {
        for (exponents, c) in &other.terms {
            self.put(exponents, c);
        }
        self
    }
}

/// The exponents of a product of monomials.
fn sum(a: &[u32], b: &[u32]) -> Vec<u32> {
    let (long, short) = if a.len() > b.len() { (a, b) } else { (b, a) };
    let mut sum = long.to_vec();
    sum.iter_mut().zip(short).for_each(|(e, f)| *e += f);
    sum
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: Self) -> Polynomial {
        let mut product = Polynomial::default();
        for (a, p) in &self.terms {
            for (b, q) in &other.terms {
                product.put(&sum(a, b), &p.times(q));
            }
        }
        product
    }
}

/// What polynomials are evaluated over.
pub(crate) trait Scalar: Copy + Add<Output = Self> + Mul<Output = Self> {
    const ZERO: Self;
    const ONE: Self;
    fn integer(n: u32) -> Self;
    fn coefficient(term: &Term) -> Self;
    /// The powers 0..=largest, one product or two each.
    fn powers(self, largest: u32) -> impl Iterator<Item = Self>;
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    fn integer(n: u32) -> Self {
        f64::from(n)
    }
    fn coefficient(term: &Term) -> Self {
        term.near
    }
    fn powers(self, largest: u32) -> impl Iterator<Item = Self> {
        (0..=largest).scan(1.0, move |next, _| Some(std::mem::replace(next, *next * self)))
    }
}

impl Scalar for Interval {
    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;
    fn integer(n: u32) -> Self {
        Self::point(f64::from(n))
    }
    fn coefficient(term: &Term) -> Self {
        term.coefficient
    }
    fn powers(self, largest: u32) -> impl Iterator<Item = Self> {
        self.powers(largest)
    }
}

/// A term of a [`System`].
#[derive(Clone, Debug)]
pub(crate) struct Term {
    coefficient: Interval,
    near: f64,
    /// The variables with their exponents, positive.
    powers: Vec<(usize, u32)>,
}

/// Polynomials in some variables as functions, the other variables having values.
#[derive(Clone, Debug)]
pub struct System {
    rows: Vec<Vec<Term>>,
    variables: usize,
    largest: u32,
}

impl System {
    /// The polynomials as functions of the variables for which `values` has nothing, in their order; a variable
    /// beyond the list is free if it occurs in a polynomial or is below `least`.
    ///
    /// Coefficients are enclosures: values like pi/4 take part in what is proved.
    #[must_use]
    pub fn new(rows: &[Polynomial], values: &[Option<Value>]) -> Self {
        let given: Vec<_> =
            values.iter().map(|value| value.as_ref().map(Value::interval)).collect();
        let exact: Vec<_> =
            values.iter().map(|value| value.as_ref().and_then(Value::as_rational)).collect();
        let mut place = Vec::new();
        let mut variables = 0;
        let named = rows.iter().flat_map(|row| row.terms.keys().map(Vec::len)).max();
        for i in 0..named.unwrap_or(0).max(values.len()) {
            place.push(variables);
            variables += usize::from(given.get(i).is_none_or(Option::is_none));
        }
        let row = |polynomial: &Polynomial| {
            let mut sums: BTreeMap<Vec<(usize, u32)>, (Rational, Interval)> = BTreeMap::new();
            for (exponents, c) in &polynomial.terms {
                let mut powers = Vec::new();
                let (mut scale, mut other) = (Rational::from(1), Interval::ONE);
                for (i, e) in exponents.iter().enumerate().filter(|(_, e)| **e > 0) {
                    match (exact.get(i).copied().flatten(), given.get(i).copied().flatten()) {
                        (Some(value), _) => (0..*e).for_each(|_| scale *= value),
                        (None, Some(value)) => other = other * value.powi(*e),
                        (None, None) => powers.push((place[i], *e)),
                    }
                }
                let sum = sums.entry(powers).or_insert((Rational::new(), Interval::ZERO));
                if c.radius > 0.0 {
                    let off = Interval::new(-c.radius, c.radius) * Interval::of(&scale) * other;
                    sum.1 = sum.1 + off;
                }
                let rational = scale * &c.middle;
                if other == Interval::ONE {
                    sum.0 += rational;
                } else {
                    sum.1 = sum.1 + Interval::of(&rational) * other;
                }
            }
            let term = |(powers, (rational, other)): (_, (Rational, Interval))| {
                let coefficient = Interval::of(&rational) + other;
                Term { near: coefficient.middle(), coefficient, powers }
            };
            let vanishes = |term: &Term| term.coefficient == Interval::ZERO;
            sums.into_iter().map(term).filter(|term| !vanishes(term)).collect()
        };
        let rows: Vec<Vec<Term>> = rows.iter().map(row).collect();
        let powers = rows.iter().flatten().flat_map(|term| &term.powers);
        let largest = powers.map(|(_, e)| *e).max().unwrap_or(0);
        Self { rows, variables, largest }
    }

    /// The number of polynomials.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The number of variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Powers 0..=largest of every variable, one after the other.
    fn powers<T: Scalar>(&self, at: &[T]) -> Vec<T> {
        let mut powers = Vec::with_capacity(at.len() * (self.largest as usize + 1));
        at.iter().for_each(|x| powers.extend(x.powers(self.largest)));
        powers
    }

    /// The values of the polynomials.
    pub(crate) fn values<T: Scalar>(&self, at: &[T]) -> Vec<T> {
        let powers = self.powers(at);
        let stride = self.largest as usize + 1;
        let product = |term: &Term| {
            let factors = term.powers.iter().map(|(i, e)| powers[i * stride + *e as usize]);
            factors.fold(T::coefficient(term), |product, factor| product * factor)
        };
        let value = |row: &Vec<Term>| row.iter().map(product).fold(T::ZERO, |a, b| a + b);
        self.rows.iter().map(value).collect()
    }

    /// The derivatives at a point, by rows.
    #[must_use]
    pub fn slopes(&self, at: &[f64]) -> Vec<f64> {
        self.derivatives(at).1
    }

    /// The values and the derivatives, row by row.
    pub(crate) fn derivatives<T: Scalar>(&self, at: &[T]) -> (Vec<T>, Vec<T>) {
        let powers = self.powers(at);
        let stride = self.largest as usize + 1;
        let n = self.variables;
        let mut slopes = vec![T::ZERO; self.rows.len() * n];
        let mut values = vec![T::ZERO; self.rows.len()];
        // The coefficient times the factors before each.
        let mut before = Vec::with_capacity(n);
        for ((row, value), slopes) in
            self.rows.iter().zip(&mut values).zip(slopes.chunks_exact_mut(n.max(1)))
        {
            for term in row {
                let mut product = T::coefficient(term);
                before.clear();
                for (i, e) in &term.powers {
                    before.push(product);
                    product = product * powers[i * stride + *e as usize];
                }
                *value = *value + product;
                let mut after = T::ONE;
                for ((i, e), before) in term.powers.iter().zip(&before).rev() {
                    let place = i * stride + *e as usize;
                    let slope = *before * (powers[place - 1] * T::integer(*e)) * after;
                    slopes[*i] = slopes[*i] + slope;
                    after = after * powers[place];
                }
            }
        }
        (values, slopes)
    }

    /// Every row's terms of its own highest degree in all variables, and an upper bound of the sum of
    /// |coefficients| for every degree up to that.
    pub(crate) fn leading(&self) -> (Self, Vec<Vec<f64>>) {
        let degree = |term: &Term| term.powers.iter().map(|(_, e)| e).sum::<u32>();
        let mut top = Vec::new();
        let mut sizes = Vec::new();
        for row in &self.rows {
            let highest = row.iter().map(degree).max().unwrap_or(0);
            let mut sums = vec![Interval::ZERO; highest as usize + 1];
            for term in row {
                let sum = &mut sums[degree(term) as usize];
                *sum = *sum + Interval::point(term.coefficient.above());
            }
            top.push(row.iter().filter(|term| degree(term) == highest).cloned().collect());
            sizes.push(sums.into_iter().map(Interval::high).collect());
        }
        (Self { rows: top, ..*self }, sizes)
    }
}
