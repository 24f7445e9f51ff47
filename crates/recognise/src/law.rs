//! The friction law of an equation: T(x' - v*), with v* the speed at which it jumps or bends.

use crate::bound::multiply_out;
use crate::in_pi::InPi;
use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Function};
use lindstedt_melnikov::{Friction, PolynomialFriction};
use lindstedt_number::Exact;
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A friction law and the speed of the belt.
#[derive(Clone, Debug)]
pub(crate) struct FrictionLaw {
    pub belt_speed: Exact,
    dry: Exact,
    /// t_k at index k.
    coefficients: Vec<Exact>,
    /// The whole law in w, which x' stands for, where it is more than a sign and a polynomial.
    whole: Option<Expression>,
}

/// Bits in which the limits of a law from both sides are compared.
const LIMIT_BITS: u32 = 200;

/// A function that is not smooth.
fn bends(e: &Expression) -> bool {
    matches!(e, Expression::Function(Function::Abs | Function::Sign, _))
}

/// v* from the sign(p x' + q) and |p x' + q| of an expression: -q/p, the same for all of them.
/// Read before the values of coefficients can make a term vanish.
fn belt_speed(perturbation: &Expression) -> Result<Option<InPi>, Refusal> {
    let mut speed: Option<InPi> = None;
    let mut refused = None;
    for whole in perturbation.nodes() {
        let Expression::Function(Function::Abs | Function::Sign, inside) = whole else { continue };
        if !inside.contains(&Expression::VELOCITY) {
            continue;
        }
        match (&speed, kink(inside)) {
            (_, None) => refused = Some(whole.clone()),
            (None, Some(found)) => speed = Some(found),
            (Some(first), Some(found)) if *first != found => refused = Some(whole.clone()),
            _ => {}
        }
    }
    match refused {
        Some(term) => Err(Refusal::Term { term: Box::new(term), why: Why::OtherSpeed }),
        None => Ok(speed),
    }
}

/// The zero in x' of p x' + q with a rational p.
fn kink(inside: &Expression) -> Option<InPi> {
    let all = expand(inside)?;
    let (mut slope, mut constant) = (Rational::new(), InPi::default());
    for (m, q) in &all.terms {
        if m.is_power(0, 1) && m.order == 0 && m.parameters.is_empty() {
            slope += q;
        } else if m.is_power(0, 0) && m.order == 0 {
            constant.add(m, q)?;
        } else {
            return None;
        }
    }
    (!slope.is_zero()).then(|| constant.scaled(&(Rational::from(-1) / slope)))
}

/// sign(p w) = sgn(p) sign(w) and |p w| = |p||w|, everywhere inside.
fn homogeneous(e: &Expression) -> Expression {
    e.map(&|e| {
        let Expression::Function(function @ (Function::Abs | Function::Sign), z) = e else {
            return None;
        };
        let all = expand(z)?;
        let [(m, slope)] = all.terms.iter().collect::<Vec<_>>()[..] else { return None };
        if !(m.is_power(0, 1) && m.parameters.is_empty() && m.order == 0) {
            return None;
        }
        let factor = match function {
            Function::Abs => Rational::from(slope.abs_ref()),
            _ => Rational::from(slope.signum_ref()),
        };
        Some(Expression::Number(factor) * Expression::VELOCITY.apply(*function))
    })
}

/// The expression on one side of w = 0: with that sign of w.
fn beside(e: &Expression, side: i64) -> Expression {
    e.map(&|e| match e {
        Expression::Function(Function::Sign, _) => Some(Expression::integer(side)),
        _ => None,
    })
}

impl FrictionLaw {
    /// The law of the bound terms of first order without t, `perturbation` being all of them as
    /// they were written.
    pub fn new(perturbation: &Expression, all: &Monomials) -> Result<Self, Refusal> {
        let belt = belt_speed(perturbation)?.unwrap_or_default();
        let shift = |e: &Expression| {
            (*e == Expression::VELOCITY).then(|| Expression::VELOCITY + belt.expression())
        };
        let terms = all.terms.iter().map(|(m, q)| all.tree(m, q));
        let shifted = Expression::Sum(terms.collect()).substitute(&shift).canonical();
        let sum = multiply_out(&homogeneous(&shifted).canonical())?;
        let irrational = |m: &Monomial, q: &Rational| Refusal::Term {
            term: Box::new(sum.tree(m, q)),
            why: Why::Irrational,
        };
        let (mut dry, mut closed) = (InPi::default(), true);
        let mut coefficients: BTreeMap<u32, InPi> = BTreeMap::new();
        for (m, q) in &sum.terms {
            let constant = Monomial { parameters: m.parameters.clone(), ..Monomial::default() };
            match sign_and_power(&sum, m) {
                Some((false, k)) => {
                    coefficients
                        .entry(k)
                        .or_default()
                        .add(&constant, q)
                        .ok_or_else(|| irrational(m, q))?;
                }
                Some((true, 0)) => dry.add(&constant, q).ok_or_else(|| irrational(m, q))?,
                _ => closed = false,
            }
        }
        let term = |k: u32| {
            Expression::Product(vec![Expression::Small, Expression::VELOCITY.pow(i64::from(k))])
        };
        let value = |c: &InPi, k: u32| {
            let refusal = || Refusal::Term { term: Box::new(term(k)), why: Why::Irrational };
            c.value().ok_or_else(refusal)
        };
        let degree = coefficients.keys().max().map_or(0, |k| k + 1);
        let list =
            (0..degree).map(|k| coefficients.get(&k).map_or(Ok(Exact::from(0)), |c| value(c, k)));
        Ok(Self {
            belt_speed: value(&belt, 0)?,
            dry: value(&dry, 0)?,
            coefficients: list.collect::<Result<_, _>>()?,
            whole: (!closed).then(|| {
                let bare =
                    |(m, q): (&Monomial, _)| sum.tree(&Monomial { order: 0, ..m.clone() }, q);
                Expression::Sum(sum.terms.iter().map(bare).collect()).canonical()
            }),
        })
    }

    /// Whether the law jumps at w = 0, or may have no bounded slope there: in a root, or where no value
    /// is found.
    pub fn jumps(&self) -> bool {
        let Some(whole) = &self.whole else { return self.dry.sign().is_ne() };
        if whole.find(&bends).is_none() {
            return false;
        }
        // The limits from both sides.
        let at = |e: &Expression| {
            [1, -1].map(|side| {
                evaluate(&beside(e, side), &Float::new(LIMIT_BITS)).filter(Float::is_finite)
            })
        };
        let [right, left] = at(whole);
        let is_steep = |e: &Expression| match e {
            Expression::Power(base, n) if !n.as_number().is_some_and(|n| n.is_integer()) => {
                at(base).iter().any(|value| value.as_ref().is_none_or(Float::is_zero))
            }
            _ => false,
        };
        whole.find(&is_steep).is_some() || !right.zip(left).is_some_and(|(r, l)| r == l)
    }

    /// The law for y with x = s y: T(s w)/s, and the speed of the belt v*/s.
    pub fn scaled(&self, s: &Rational) -> (Friction, Exact) {
        let inverse = Rational::from(s.recip_ref());
        let size = Rational::from(s.abs_ref());
        let mut power = inverse.clone();
        let mut coefficients = Vec::new();
        for c in &self.coefficients {
            coefficients.push(c.times(&power));
            power *= s;
        }
        let dry = self.dry.times(&Rational::from(size.recip_ref()));
        let polynomial = PolynomialFriction { dry, coefficients };
        let belt = self.belt_speed.times(&inverse);
        let Some(whole) = self.whole.clone() else {
            return (Friction::Polynomial(polynomial), belt);
        };
        let s = s.clone();
        let law = Arc::new(move |w: &Float| {
            let argument = Float::with_val(w.prec(), w * &s);
            let value = evaluate(&whole, &argument);
            value.unwrap_or_else(|| Float::with_val(w.prec(), f64::NAN)) / &s
        });
        let smooth = self.whole.iter().all(|whole| whole.find(&bends).is_none());
        (Friction::Custom { law, kinks: if smooth { Vec::new() } else { vec![0.0] } }, belt)
    }
}

/// (whether sign(w) is a factor, the power of w) of a term made of sign(w), |w| and w alone.
fn sign_and_power(all: &Monomials, m: &Monomial) -> Option<(bool, u32)> {
    let (mut signs, mut power) = (0, m.velocity);
    for (key, n) in &m.atoms {
        match all.atoms.get(key)? {
            Expression::Function(Function::Sign, z) if **z == Expression::VELOCITY => signs += n,
            Expression::Function(Function::Abs, z) if **z == Expression::VELOCITY => {
                signs += n;
                power += n;
            }
            _ => return None,
        }
    }
    (m.x == 0).then_some((signs % 2 == 1, power))
}

/// The value of a bound expression in x' alone (or, in [`crate::numeric`], in x alone) at w.
pub(crate) fn evaluate(e: &Expression, w: &Float) -> Option<Float> {
    e.at_point(w, &BTreeMap::new())
}
