//! The unit of frequency: 1, a symbol, or the square root of a rational number, of which all nu_j and, beside independent
//! parameters, all Omega_l are rational multiples.
//!
//! Over such a unit u every divisor L_j(i lambda) is u^2 times a rational number, so that coefficients are
//! polynomials in u and 1/u: u is a symbol of the algebra that has an inverse, what is resonant is decided by the rational
//! multiples, and the residual is that of the equations as they are written. Of u = sqrt(d) the square is put in at the end: c u^n becomes
//! c d^(n/2) or c d^((n - 1)/2) sqrt(d).

use super::{ResonanceError, SlowFlow, Terms, collected};
use lindstedt_equation::Expression;
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_equation::print::Style;
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::ops::Pow;
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// The highest power of a number that is formed.
const HIGHEST: u32 = 50;

/// A unit other than 1: a positive number.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its name among the symbols: `omega0`, `sqrt(2)`.
    pub name: String,
    /// Its square where it is the root of a rational number.
    pub square: Option<Rational>,
}

impl Unit {
    /// The symbol of which the squares are the factors of the linear part; nothing where these are numbers.
    ///
    /// # Errors
    /// [`ResonanceError::NoRatio`] of two symbols, [`ResonanceError::Unset`] of one that does not occur as its square.
    pub(super) fn symbol<'a>(
        mass: impl Iterator<Item = &'a Expression>,
        stiffness: impl Iterator<Item = &'a Expression>,
    ) -> Result<Option<Self>, ResonanceError> {
        if let Some(name) = mass.flat_map(Expression::parameters).next() {
            return Err(ResonanceError::Unset { name });
        }
        let (mut unit, mut number): (Option<String>, Option<String>) = (None, None);
        for all in stiffness.filter_map(expand) {
            for (monomial, q) in &all.terms {
                // Constants such as roots have a place among the parameters.
                let is_symbol = |(name, _): &(&String, _)| !all.atoms.contains_key(*name);
                let mut symbols = monomial.parameters.iter().filter(is_symbol);
                let Some((name, power)) = symbols.next() else {
                    number = Some(all.tree(monomial, q).print("eps", Style::Text));
                    continue;
                };
                let first = unit.get_or_insert_with(|| name.clone()).clone();
                if monomial.parameters.len() > 1 || *power != 2 {
                    return Err(ResonanceError::Unset { name: name.clone() });
                }
                if first != *name {
                    return Err(ResonanceError::NoRatio { first, second: name.clone() });
                }
            }
        }
        if let (Some(unit), Some(number)) = (&unit, number) {
            let (first, second) = (number, format!("{unit}^2"));
            return Err(ResonanceError::NoRatio { first, second });
        }
        Ok(unit.map(|name| Self { name, square: None }))
    }

    /// The root of which all frequencies are rational multiples, and all rates of forces, where there is one.
    pub(super) fn root(squares: &[Rational], rates: &[Expression]) -> Option<Self> {
        let first = squares.first().filter(|square| **square > 0)?;
        let mut square = Integer::from(first.numer() * first.denom());
        for p in 2..1000u32 {
            let factor = p * p;
            while square.is_divisible_u(factor) {
                square /= factor;
            }
        }
        let unit = Self { name: format!("sqrt({square})"), square: Some(square.into()) };
        let all = squares.iter().all(|square| unit.multiple(square).is_some());
        let rate = |rate: &Expression| {
            let all = expand(&unit.named(rate));
            all.is_some_and(|all| all.terms.keys().all(|monomial| unit.is_alone(monomial)))
        };
        let irrational = rational_root(first).is_none();
        (irrational && all && rates.iter().all(rate)).then_some(unit)
    }

    /// q with sqrt(square) = q u, of a root.
    fn multiple(&self, square: &Rational) -> Option<Rational> {
        rational_root(&Rational::from(square / self.square.as_ref()?))
    }

    /// Whether a monomial is a number times u.
    fn is_alone(&self, monomial: &Monomial) -> bool {
        monomial.parameters.len() == 1 && monomial.parameters.get(&self.name) == Some(&1)
    }

    /// e with multiples of u in the place of the roots of numbers that are such.
    pub(super) fn named(&self, e: &Expression) -> Expression {
        e.map(&|e| {
            let Expression::Power(base, n) = e else { return None };
            let twice = n.as_number()? * 2u32;
            let base = base.as_number().filter(|base| *base > 0)?;
            let odd = twice.is_integer() && twice.numer().is_odd();
            let whole = odd.then(|| (twice.numer() - Integer::from(1)).to_i32())?? / 2;
            let whole = Some(whole).filter(|n| n.unsigned_abs() <= HIGHEST)?;
            let factor = self.multiple(&base)? * Rational::from((&base).pow(whole));
            Some(Expression::Number(factor) * self.expression())
        })
    }

    /// That it has no value where one is needed.
    pub(super) fn unset(&self) -> ResonanceError {
        ResonanceError::Unset { name: self.name.clone() }
    }

    pub(super) fn expression(&self) -> Expression {
        Expression::parameter(&self.name)
    }

    /// The multiples of u^2 that factors of the linear part are.
    pub(super) fn multiples(&self, factor: &Expression) -> Option<Rational> {
        if self.square.is_some() {
            return factor.as_number();
        }
        let all = expand(factor)?;
        let square = |(m, q): (&Monomial, &Rational)| {
            let is_square = m.parameters.get(&self.name) == Some(&2);
            is_square.then(|| q.clone())
        };
        all.terms.iter().map(square).sum()
    }

    /// The linear equations of [`super::System`] have the squares of frequencies as numbers; with multiples of u^2 in their
    /// place where u is a root.
    pub(super) fn with_squares(
        &self,
        equation: Expression,
        j: usize,
        own: &Rational,
    ) -> Expression {
        let Some(d) = &self.square else { return equation };
        let square = Expression::Number(own.clone()) * self.expression().pow(2)
            - Expression::Number(Rational::from(own * d));
        (equation + square * Expression::unknown(j, 0)).canonical()
    }

    /// Its value, of a symbol by its name.
    pub(super) fn value(
        &self,
        values: &dyn Fn(&str) -> Option<Exact>,
        balls: Balls,
    ) -> Option<Ball> {
        let root = || self.square.clone().map(Exact::root);
        Some(root().or_else(|| values(&self.name))?.ball(balls))
    }

    /// Puts the square of a root into terms whose exponents of the symbols begin at `first`.
    pub(super) fn put_in<'a>(
        &self,
        symbols: &[String],
        first: usize,
        lists: impl Iterator<Item = &'a mut Terms>,
    ) {
        let place = symbols.iter().position(|name| *name == self.name);
        let (Some(place), Some(d)) = (place, &self.square) else { return };
        lists.for_each(|terms| *terms = reduced(std::mem::take(terms), first + place, d));
    }

    /// A constant with the square of a root put in: sqrt(2)^2*T is 2*T.
    pub(super) fn with_square(&self, e: Expression) -> Expression {
        let (Some(d), Some(all)) = (&self.square, expand(&e)) else { return e };
        let term = |(monomial, q): (&Monomial, &Rational)| {
            let mut monomial = monomial.clone();
            let power = monomial.parameters.remove(&self.name).unwrap_or(0);
            let pairs = power.div_euclid(2);
            if power != 2 * pairs {
                monomial.parameters.insert(self.name.clone(), 1);
            }
            all.tree(&monomial, &(Rational::from(d.pow(pairs)) * q))
        };
        let sum = Expression::Sum(all.terms.iter().map(term).collect());
        sum.multiplied_out().unwrap_or(sum).canonical()
    }

    /// The squares of frequencies as numbers, of a root.
    pub(super) fn plain(&self, squares: &[Rational]) -> Vec<Rational> {
        let d = self.square.clone().unwrap_or_else(|| 1.into());
        squares.iter().map(|square| Rational::from(square * &d)).collect()
    }

    /// The squares of frequencies in units of u^2, of those of a root.
    pub(super) fn scaled(&self, squares: &mut [Rational]) {
        if let Some(d) = &self.square {
            squares.iter_mut().for_each(|square| *square /= d);
        }
    }
}

impl SlowFlow {
    /// With the square of a root put in.
    pub(super) fn with_root(mut self) -> Self {
        let first = self.first_symbol();
        if let Some(unit) = &self.system.unit {
            let lists = [&mut self.flow, &mut self.solution, &mut self.detuning];
            let lists = lists.into_iter().flatten().flatten().chain(&mut self.energy);
            unit.put_in(&self.system.symbols, first, lists);
        }
        self
    }
}

fn reduced(terms: Terms, place: usize, square: &Rational) -> Terms {
    let mut sum: BTreeMap<Vec<i32>, [Rational; 2]> = BTreeMap::new();
    for AmplitudeTerm { mut exponents, re, im } in terms {
        let pairs = exponents[place].div_euclid(2);
        exponents[place] -= 2 * pairs;
        let factor = Rational::from(square.pow(pairs));
        let entry = sum.entry(exponents).or_default();
        entry.iter_mut().zip([re, im]).for_each(|(sum, part)| *sum += part * &factor);
    }
    collected(sum)
}
