//! The equation sum_t c_t(alpha) prod_f D^n_f x(t - T_f) = 0 and its characteristic function.
//!
//! L(lambda; alpha) = sum c(alpha) lambda^n e^(-lambda T(alpha)) over the terms with one factor: x = e^(lambda t) solves
//! the linear equation where L vanishes.

use crate::complex::Pair;
use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_coeff::print::Print;
use lindstedt_equation::{Expression, Function, Operations};
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls, Complex, ComplexBalls};
use lindstedt_number::{Number, rational};
use rug::Rational;
use std::cmp::Ordering;

/// The name that stands for pi among the parameters of a constant expression.
pub const PI: &str = "pi";

/// D^derivative x(t - T), T by its place in [`DelayEquation::delays`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Factor {
    /// n of d^n x/dt^n.
    pub derivative: u32,
    /// Which delay; 0 is none.
    pub delay: usize,
}

/// c(alpha) times a product of factors.
#[derive(Clone, Debug, PartialEq)]
pub struct Term<C> {
    /// The coefficients of 1, alpha, alpha^2, ...
    pub coefficient: Vec<C>,
    /// The factors, at least one, increasing.
    pub factors: Vec<Factor>,
}

/// A scalar equation with delays, polynomial in x and its derivatives, x = 0 being an equilibrium. Constants
/// are expressions in [`PI`], or elements of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayEquation<C> {
    /// The order: that of the highest derivative, which stands with the factor one and without a delay.
    pub order: u32,
    /// T as polynomials in alpha; the first is zero.
    pub delays: Vec<Vec<C>>,
    /// The terms, the highest derivative included.
    pub terms: Vec<Term<C>>,
}

/// What an expansion needs of its numbers: a real field with pi, or enclosures.
pub trait Field: RationalAlgebra + Print {
    /// [cos, sin] of an angle, where they are in the field.
    fn turn(&self, angle: &Self::Element) -> Option<Pair<Self::Element>>;
    /// The value of a constant expression, where it is in the field.
    fn constant(&self, e: &Expression) -> Option<Self::Element>;
    /// The number with its digits; nothing where they are not known.
    fn number(&self, a: &Self::Element, digits: usize) -> Option<Number>;
    /// The sign of the number; nothing where it is not known.
    fn sign(&self, a: &Self::Element) -> Option<Ordering>;
}

impl<C> DelayEquation<C> {
    /// The same equation over other constants; nothing where one has no image.
    pub(crate) fn map<D>(&self, image: &dyn Fn(&C) -> Option<D>) -> Option<DelayEquation<D>> {
        let list = |list: &Vec<C>| list.iter().map(image).collect::<Option<Vec<D>>>();
        let term = |term: &Term<C>| {
            Some(Term { coefficient: list(&term.coefficient)?, factors: term.factors.clone() })
        };
        Some(DelayEquation {
            order: self.order,
            delays: self.delays.iter().map(list).collect::<Option<_>>()?,
            terms: self.terms.iter().map(term).collect::<Option<_>>()?,
        })
    }

    /// The terms of the linear equation, each with its only factor.
    pub(crate) fn linear(&self) -> impl Iterator<Item = (&Term<C>, Factor)> {
        self.terms.iter().filter_map(|term| match term.factors[..] {
            [factor] => Some((term, factor)),
            _ => None,
        })
    }
}

impl DelayEquation<Expression> {
    /// The equation over a field.
    pub(crate) fn over<F: Field>(&self, field: &F) -> Option<DelayEquation<F::Element>> {
        self.map(&|e| field.constant(e))
    }
}

/// p(x) by Horner's rule.
pub(crate) fn value<R: RationalAlgebra>(ring: &R, p: &[R::Element], x: &R::Element) -> R::Element {
    p.iter().rev().fold(ring.zero(), |sum, c| ring.add(&ring.mul(&sum, x), c))
}

/// The coefficients of p'.
pub(crate) fn derivative<R: RationalAlgebra>(ring: &R, p: &[R::Element]) -> Vec<R::Element> {
    p.iter().enumerate().skip(1).map(|(k, c)| ring.scale(c, &Rational::from(k))).collect()
}

impl Field for BallRing {
    fn turn(&self, angle: &Enclosure) -> Option<Pair<Enclosure>> {
        Some([self.balls.cos(&angle.0), self.balls.sin(&angle.0)].map(Enclosure))
    }

    fn constant(&self, e: &Expression) -> Option<Enclosure> {
        e.evaluate(&mut Constants(self.balls)).filter(Ball::is_finite).map(Enclosure)
    }

    fn number(&self, a: &Enclosure, digits: usize) -> Option<Number> {
        if self.is_zero(a) {
            return rational(&Rational::new(), digits).ok();
        }
        Number::of_all_digits(&a.0, digits)
    }

    fn sign(&self, a: &Enclosure) -> Option<Ordering> {
        let zero = self.is_zero(a).then_some(Ordering::Equal);
        let positive = a.0.is_positive().then_some(Ordering::Greater);
        zero.or(positive).or_else(|| a.0.is_negative().then_some(Ordering::Less))
    }
}

/// Balls, as what a constant expression is evaluated over.
struct Constants(Balls);

impl Operations for Constants {
    type Value = Ball;

    fn number(&mut self, q: &Rational) -> Option<Ball> {
        Some(self.0.from_rational(q))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Ball> {
        matches!(leaf, Expression::Parameter(name) if name == PI).then(|| self.0.pi())
    }

    fn add(&mut self, a: Ball, b: Ball) -> Option<Ball> {
        Some(self.0.add(&a, &b))
    }

    fn multiply(&mut self, a: Ball, b: Ball) -> Option<Ball> {
        Some(self.0.mul(&a, &b))
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Ball> {
        let (base, n) = (base.evaluate(self)?, exponent.as_number());
        match n.as_ref().filter(|n| n.is_integer()).and_then(|n| n.numer().to_i64()) {
            Some(n) => self.0.powi(&base, n),
            None if n.is_some_and(|n| n == 0.5) => self.0.sqrt(&base),
            None => {
                let exponent = exponent.evaluate(self)?;
                Some(self.0.exp(&self.0.mul(&exponent, &self.0.ln(&base)?)))
            }
        }
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Ball> {
        let z = argument.evaluate(self)?;
        match function {
            Function::Ln => self.0.ln(&z),
            Function::Exp => Some(self.0.exp(&z)),
            Function::Sin => Some(self.0.sin(&z)),
            Function::Cos => Some(self.0.cos(&z)),
            Function::Abs => Some(self.0.abs(&z)),
            Function::Sign if z.is_positive() => Some(self.0.one()),
            Function::Sign => z.is_negative().then(|| self.0.from_i64(-1)),
        }
    }
}

/// L and what Newton's method, the transversality and the count of roots need of it, at lambda.
#[derive(Clone, Debug)]
pub(crate) struct Characteristic {
    pub value: Complex,
    /// dL/dlambda.
    pub by_root: Complex,
    /// dL/dalpha.
    pub by_parameter: Complex,
}

/// L(lambda; alpha), dL/dlambda, dL/dalpha as balls.
pub(crate) fn characteristic(
    equation: &DelayEquation<Enclosure>,
    ring: BallRing,
    lambda: &Complex,
    alpha: &Ball,
) -> Characteristic {
    let balls = ring.balls;
    let plane = ComplexBalls::new(balls);
    let at = Enclosure(alpha.clone());
    let zero = plane.zero();
    let (mut all, mut root, mut parameter) = (zero.clone(), zero.clone(), zero);
    for (term, factor) in equation.linear() {
        let delay = &equation.delays[factor.delay];
        let later = value(&ring, delay, &at).0;
        let shift = plane.exp(&plane.neg(&plane.mul_real(lambda, &later)));
        let power = |n: u32| (0..n).fold(plane.one(), |all, _| plane.mul(&all, lambda));
        let c = value(&ring, &term.coefficient, &at).0;
        let slope = value(&ring, &derivative(&ring, &term.coefficient), &at).0;
        let delay_slope = value(&ring, &derivative(&ring, delay), &at).0;
        let (n, own) = (factor.derivative, plane.mul(&power(factor.derivative), &shift));
        all = plane.add(&all, &plane.mul_real(&own, &c));
        // d(lambda^n e^(-lambda T)) = (n lambda^(n-1) - T lambda^n) e^(-lambda T).
        let lower = plane.mul_real(&power(n.saturating_sub(1)), &balls.from_i64(n.into()));
        let by_root = plane.sub(&plane.mul(&lower, &shift), &plane.mul_real(&own, &later));
        root = plane.add(&root, &plane.mul_real(&by_root, &c));
        let through_delay = plane.mul(lambda, &plane.mul_real(&own, &balls.mul(&c, &delay_slope)));
        let direct = plane.mul_real(&own, &slope);
        parameter = plane.add(&parameter, &plane.sub(&direct, &through_delay));
    }
    Characteristic { value: all, by_root: root, by_parameter: parameter }
}

/// A bound of the roots with Re lambda >= 0: beyond it |lambda|^order exceeds the other terms. Nothing where
/// delayed terms of the highest order weigh one or more.
pub(crate) fn reach(
    equation: &DelayEquation<Enclosure>,
    ring: BallRing,
    alpha: &Ball,
) -> Option<f64> {
    let at = Enclosure(alpha.clone());
    let weights: Vec<(u32, f64)> = equation
        .linear()
        .map(|(term, factor)| {
            let weight = value(&ring, &term.coefficient, &at).0.abs_upper().to_f64().next_up();
            let own = factor == Factor { derivative: equation.order, delay: 0 };
            (factor.derivative, if own { -1.0 } else { weight })
        })
        .collect();
    // The sum over |lambda|^order falls as |lambda| grows.
    let exceeds = |r: f64| {
        let parts = weights.iter().map(|(n, w)| w * r.powi(*n as i32 - equation.order as i32));
        parts.sum::<f64>() < -1e-9
    };
    (-8..=24).map(|k| 2f64.powi(k)).find(|r| exceeds(*r))
}

/// Whether every delay is positive: surely, surely not, or open.
pub(crate) fn delays_positive(
    equation: &DelayEquation<Enclosure>,
    ring: BallRing,
    alpha: &Ball,
) -> Option<bool> {
    let at = Enclosure(alpha.clone());
    let mut known = Some(true);
    for delay in equation.delays.iter().skip(1) {
        let later = value(&ring, delay, &at).0;
        match (later.is_positive(), later.upper().cmp0()) {
            (true, _) => {}
            (_, Some(Ordering::Less | Ordering::Equal)) => return Some(false),
            _ => known = None,
        }
    }
    known
}
