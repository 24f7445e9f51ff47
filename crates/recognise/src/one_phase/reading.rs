//! An equation read as an oscillator with a linear spring and a small law.

use super::OnePhase;
use crate::bound::{bind, missing, multiply_out, rest};
use crate::local::Point;
use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::expand;
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// Why a term is no function of x and x' alone.
fn unfit(term: &Expression) -> Option<Why> {
    let holds = |wanted: &dyn Fn(&Expression) -> bool| term.find(wanted).is_some();
    if holds(&|e| matches!(e, Expression::Time)) {
        return Some(Why::Forced);
    }
    if holds(&Expression::is_delayed) {
        return Some(Why::Late);
    }
    holds(&|e| matches!(e, Expression::Formal(..))).then_some(Why::Formal)
}

impl OnePhase {
    /// Reads the equation of a problem with the values of its parameters; the small one needs none.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit.
    pub fn new(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Self, Refusal> {
        let rest = rest(problem)?;
        missing(&rest.parameters(), values)?;
        let belt = belt(&rest);
        let mut others = values.clone();
        let (belt, factor) = belt.unzip();
        let value = belt.as_ref().and_then(|name| others.remove(name)).map_or(0.0, |v| v.to_f64());
        let all = multiply_out(&bind(&rest, &others))?;
        let (mut square, mut law) = (0.0, Vec::new());
        for (m, q) in &all.terms {
            let term = || all.tree(m, q);
            let refused = |why| Refusal::Term { term: Box::new(term()), why };
            if let Some(why) = unfit(&term()) {
                return Err(refused(why));
            }
            match m.order {
                0 => {
                    let spring = m.is_power(1, 0) && m.atoms.is_empty();
                    let value = Point::at(0.0, 1.0, 0.0).local(&term()).filter(|_| spring);
                    square += value.ok_or_else(|| refused(Why::NotSpring))?[0];
                }
                1 => {
                    let mut bare = m.clone();
                    bare.order = 0;
                    let bare = all.tree(&bare, q);
                    if bare.contains(&Expression::Small) {
                        return Err(refused(Why::SmallInside));
                    }
                    law.push(bare);
                }
                _ => return Err(refused(Why::HigherOrder)),
            }
        }
        if square.is_nan() || square <= 0.0 {
            return Err(Refusal::NoSpring);
        }
        let law = Expression::Sum(law).canonical();
        let bends = arguments(&law, &|e| match e {
            Expression::Function(Function::Abs | Function::Sign, z) => Some(z),
            _ => None,
        });
        let divisors = arguments(&law, &|e| match e {
            Expression::Power(z, n) if n.as_number().is_some_and(|n| n.is_negative()) => Some(z),
            _ => None,
        });
        let mut found = Self {
            frequency: square.sqrt(),
            belt_speed: None,
            belt,
            factor: factor.unwrap_or_default(),
            law,
            value,
            bends,
            divisors,
        };
        found.belt_speed = found.speed();
        Ok(found)
    }

    /// v* where all signs and absolute values change at one x' other than zero.
    fn speed(&self) -> Option<f64> {
        if self.belt.is_some() {
            return Some(self.factor * self.value);
        }
        let mut speeds = self.bends.iter().map(|z| {
            let [at, by_x, slope] = Point::at(0.0, 0.0, 0.0).local(z)?;
            let [other, ..] = Point::at(0.0, 1.0, 2.0).local(z)?;
            let linear = by_x == 0.0 && (other - at - 2.0 * slope).abs() < 1e-12 * (1.0 + at.abs());
            (linear && slope != 0.0).then(|| -at / slope)
        });
        let first = speeds.next()??;
        let same =
            |speed: Option<f64>| speed.is_some_and(|v| (v - first).abs() <= 1e-12 * first.abs());
        (first != 0.0 && speeds.all(same)).then_some(first)
    }
}

/// The parameter p with x' - c p the argument of every sign and absolute value of x', and c.
fn belt(rest: &Expression) -> Option<(String, f64)> {
    let mut found: Option<(String, Rational)> = None;
    for e in rest.nodes() {
        let Expression::Function(Function::Abs | Function::Sign, z) = e else { continue };
        if !z.contains(&Expression::VELOCITY) {
            continue;
        }
        let all = expand(z)?;
        let (mut slope, mut constant) = (Rational::new(), None);
        for (m, q) in &all.terms {
            let single = m.x == 0 && m.velocity == 0 && m.order == 0 && m.atoms.is_empty();
            match m.parameters.iter().collect::<Vec<_>>()[..] {
                [] if m.is_power(0, 1) && m.order == 0 => slope += q,
                [(name, 1)] if single && name != "pi" && constant.is_none() => {
                    constant = Some((name.clone(), q.clone()))
                }
                _ => return None,
            }
        }
        let (name, q) = constant?;
        if slope.is_zero() {
            return None;
        }
        let this = (name, -q / slope);
        if found.as_ref().is_some_and(|found| *found != this) {
            return None;
        }
        found = Some(this);
    }
    found.map(|(name, factor)| (name, factor.to_f64()))
}

/// Different arguments of what is picked, none constant.
fn arguments(
    law: &Expression,
    pick: &dyn Fn(&Expression) -> Option<&Expression>,
) -> Vec<Expression> {
    let mut list: Vec<Expression> =
        law.nodes().filter_map(pick).filter(|z| !z.is_constant()).cloned().collect();
    list.sort_by_key(|e| format!("{e:?}"));
    list.dedup();
    list
}
