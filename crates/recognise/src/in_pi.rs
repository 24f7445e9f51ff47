//! Constants of a bound equation: polynomials in pi over Q.

use crate::bound::PI;
use lindstedt_equation::Expression;
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// sum_k q_k pi^k.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct InPi(BTreeMap<i32, Rational>);

impl InPi {
    /// Adds the constant factor of a term; nothing if it is no power of pi over Q.
    pub fn add(&mut self, monomial: &Monomial, q: &Rational) -> Option<()> {
        let power = match monomial.parameters.iter().collect::<Vec<_>>()[..] {
            [] => 0,
            [(name, n)] if name == PI => *n,
            _ => return None,
        };
        let sum = self.0.entry(power).or_default();
        *sum += q;
        if sum.is_zero() {
            self.0.remove(&power);
        }
        Some(())
    }
    /// The constant that a bound expression is.
    pub fn of(e: &Expression) -> Option<Self> {
        let mut sum = Self::default();
        for (monomial, q) in &expand(e)?.terms {
            let bare = Monomial { parameters: monomial.parameters.clone(), ..Monomial::default() };
            (bare == *monomial).then_some(())?;
            sum.add(monomial, q)?;
        }
        Some(sum)
    }
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }
    /// The number, where it is rational or a rational multiple of pi.
    pub fn value(&self) -> Option<Exact> {
        match self.0.iter().collect::<Vec<_>>()[..] {
            [] => Some(Exact::from(0)),
            [(0, q)] => Some(Exact::Rational(q.clone())),
            [(1, q)] => Some(Exact::PiTimes(q.clone())),
            _ => None,
        }
    }
    /// The positive square root of q or q pi^2, q >= 0.
    pub fn root(&self) -> Option<Exact> {
        match self.0.iter().collect::<Vec<_>>()[..] {
            [] => Some(Exact::from(0)),
            [(0, q)] if *q > 0 => Some(Exact::root(q.clone())),
            [(2, q)] => rational_root(q).map(Exact::PiTimes),
            _ => None,
        }
    }
    pub fn scaled(&self, factor: &Rational) -> Self {
        Self(self.0.iter().map(|(k, q)| (*k, Rational::from(q * factor))).collect())
    }
    pub fn neg(&self) -> Self {
        self.scaled(&Rational::from(-1))
    }
    /// (k, q_k).
    pub fn terms(&self) -> impl Iterator<Item = (i32, &Rational)> {
        self.0.iter().map(|(k, q)| (*k, q))
    }
    /// As it is written.
    pub fn expression(&self) -> Expression {
        let power = |(k, q): (i32, &Rational)| match k {
            0 => Expression::Number(q.clone()),
            k => Expression::Number(q.clone()) * Expression::parameter(PI).pow(i64::from(k)),
        };
        let terms = self.terms().map(power);
        Expression::Sum(terms.collect()).canonical()
    }
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for (k, q) in &other.0 {
            let entry = sum.0.entry(*k).or_default();
            *entry += q;
            if entry.is_zero() {
                sum.0.remove(k);
            }
        }
        sum
    }
}
