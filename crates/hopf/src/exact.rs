//! Hopf points in Q(pi): guessed from their digits, proved by L(i omega_0; alpha_0) = 0.

use crate::complex::{ComplexNumbers, Pair};
use crate::equation::{DelayEquation, Field, value};
use crate::pi::{InPi, PiField};
use crate::search::HopfPoint;
use lindstedt_algebra::Ring;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Integer, Rational};

/// Bits of the digits that are guessed from.
pub(crate) const BITS: u32 = 320;
/// A fraction of this many bits, both parts together, is taken for the number.
const SHORT: u32 = 96;

/// alpha_0 and omega_0 of a point to [`BITS`] bits, where omega_0 is a rational multiple of a power of pi, every
/// omega_0 T a multiple of pi/2, and alpha_0 in Q(pi), as the root of what is linear in it or a rational multiple of a
/// power of pi.
pub(crate) fn exact(equation: &DelayEquation<InPi>, point: &HopfPoint) -> Option<(InPi, InPi)> {
    multiples(&point.frequency).into_iter().find_map(|omega| {
        let solved = solved(equation, &omega);
        let guessed = || multiples(&point.parameter);
        let all = solved.map_or_else(guessed, |alpha| vec![alpha]);
        let fits = |alpha: &InPi| {
            let enclosed = PiField.ball(alpha, Balls::new(BITS));
            enclosed.is_some_and(|ball| ball.overlaps(&point.parameter))
                && root(equation, &omega, alpha)
                    .is_some_and(|z| ComplexNumbers(&PiField).is_zero(&z))
        };
        all.into_iter().find(fits).map(|alpha| (alpha, omega.clone()))
    })
}

/// The number as q pi^n with a short q, n = 1, 0, -1, 2, -2.
fn multiples(ball: &Ball) -> Vec<InPi> {
    let balls = Balls::new(BITS);
    let of = |n: i32| {
        let scale = balls.powi(&balls.pi(), (-n).into())?;
        Some(PiField.power(&short(&balls.mul(ball, &scale))?, n))
    };
    [1, 0, -1, 2, -2].into_iter().filter_map(of).collect()
}

/// The first convergent of the continued fraction that lies in the ball, if it is short.
fn short(ball: &Ball) -> Option<Rational> {
    if ball.contains_zero() {
        return Some(Rational::new());
    }
    let mut rest = ball.midpoint().to_rational()?;
    let (mut last, mut this) = ([0, 1].map(Integer::from), [1, 0].map(Integer::from));
    loop {
        let whole = Integer::from(rest.floor_ref());
        let next = [0, 1].map(|k| Integer::from(&whole * &this[k]) + &last[k]);
        (last, this) = (this, next);
        let found = Rational::from((this[0].clone(), this[1].clone()));
        if this[0].significant_bits() + this[1].significant_bits() > SHORT {
            return None;
        }
        if ball.contains(&found) {
            return Some(found);
        }
        rest -= whole;
        rest = Rational::from(rest.recip_ref());
    }
}

/// L(i omega; alpha).
fn root(equation: &DelayEquation<InPi>, omega: &InPi, alpha: &InPi) -> Option<Pair<InPi>> {
    let at = |c: &[InPi]| value(&PiField, c, alpha);
    parts(equation, omega, &at, &|c| vec![at(c)])?.pop()
}

/// The alpha with L = A + alpha B = 0, where L is of this form and alpha is real.
fn solved(equation: &DelayEquation<InPi>, omega: &InPi) -> Option<InPi> {
    let ends = |c: &[InPi], degree: usize| c.iter().skip(degree + 1).all(|c| PiField.is_zero(c));
    let linear = equation.linear().all(|(term, _)| ends(&term.coefficient, 1));
    if !linear || !equation.delays.iter().all(|delay| ends(delay, 0)) {
        return None;
    }
    let of = |c: &[InPi], k: usize| c.get(k).cloned().unwrap_or_else(|| PiField.zero());
    let both = |c: &[InPi]| vec![of(c, 0), of(c, 1)];
    let [a, b] = parts(equation, omega, &|c| of(c, 0), &both)?.try_into().ok()?;
    let plane = ComplexNumbers(&PiField);
    let [alpha, none] = plane.neg(&plane.mul(&a, &plane.reciprocal(&b)?));
    PiField.is_zero(&none).then_some(alpha)
}

/// sum c_j (i omega)^n e^(-i omega T) for every c_j of the coefficients.
fn parts(
    equation: &DelayEquation<InPi>,
    omega: &InPi,
    delay: &dyn Fn(&[InPi]) -> InPi,
    of: &dyn Fn(&[InPi]) -> Vec<InPi>,
) -> Option<Vec<Pair<InPi>>> {
    let plane = ComplexNumbers(&PiField);
    let mut sums: Vec<Pair<InPi>> = Vec::new();
    for (term, factor) in equation.linear() {
        let later = delay(&equation.delays[factor.delay]);
        let turn = plane.conj(&PiField.turn(&PiField.mul(&later, omega))?);
        let power = (0..factor.derivative).fold(PiField.one(), |all, _| PiField.mul(&all, omega));
        let own = plane.differentiated(&plane.times(&turn, &power), 1, factor.derivative);
        for (k, c) in of(&term.coefficient).iter().enumerate() {
            if sums.len() == k {
                sums.push(plane.zero());
            }
            plane.add_assign(&mut sums[k], &plane.times(&own, c));
        }
    }
    Some(sums)
}
