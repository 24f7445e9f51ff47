//! Functions of the phase at a point, as balls.

use crate::lobachevsky::LobachevskyElement;
use crate::lobachevsky_function::{LambdaTable, Point, cosine, log_cosine, sine};
use crate::trigonometric::TrigonometricPolynomial;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::fmt::Debug;

/// c_0 + sum_k (c_k cos k x + s_k sin k x), from given values of the coefficients. Nothing when
/// a coefficient has no value. Harmonics by the angle addition formulas: O(n) products; the
/// radius grows linearly with n.
pub fn trigonometric<E>(
    f: &TrigonometricPolynomial<E>,
    x: &Point,
    balls: Balls,
    coefficient: impl Fn(&E) -> Option<Ball>,
) -> Option<Ball> {
    let (cos, sin) = (cosine(x, balls), sine(x, balls));
    let (mut c, mut s) = (balls.one(), balls.zero());
    let mut sum = balls.zero();
    for k in 0..f.cos.len().max(f.sin.len()) {
        for (list, value) in [(&f.cos, &c), (&f.sin, &s)] {
            if let Some(factor) = list.get(k) {
                sum = balls.add(&sum, &balls.mul(&coefficient(factor)?, value));
            }
        }
        let next = balls.sub(&balls.mul(&c, &cos), &balls.mul(&s, &sin));
        s = balls.add(&balls.mul(&s, &cos), &balls.mul(&c, &sin));
        c = next;
    }
    Some(sum)
}

/// The value of an element of the Lobachevsky ring, at the precision of the table (which must
/// reach the largest Lambda_m that occurs). Nothing when a coefficient has no value, and at the
/// zeros of cos x when l or a negative power of cos x occurs: the limit may exist there, but it
/// is not computed.
pub fn lobachevsky<E: Clone + PartialEq + Debug + Send + Sync>(
    f: &LobachevskyElement<E>,
    x: &Point,
    table: &LambdaTable,
    coefficient: impl Fn(&E) -> Option<Ball>,
) -> Option<Ball> {
    let balls = table.balls();
    let (cos, sin) = (cosine(x, balls), sine(x, balls));
    let lambdas = table.values(x);
    let log = log_cosine(x, balls).map(|value| balls.neg(&value));
    let mut sum = balls.zero();
    for (factor, polynomial) in f.blocks() {
        let mut block = balls.zero();
        for (word, c) in polynomial.terms() {
            let mut term = coefficient(c)?;
            for (index, &exponent) in word.exponents().iter().enumerate().filter(|(_, e)| **e > 0) {
                let base = if index == 0 { log.as_ref()? } else { lambdas.get(index)? };
                term = balls.mul(&term, &balls.powi(base, i64::from(exponent))?);
            }
            block = balls.add(&block, &term);
        }
        let mut value = balls.powi(&cos, i64::from(factor.power))?;
        if factor.sine {
            value = balls.mul(&value, &sin);
        }
        sum = balls.add(&sum, &balls.mul(&block, &value));
    }
    Some(sum)
}

/// The value of a rational coefficient.
pub fn of_rational(balls: Balls) -> impl Fn(&Rational) -> Option<Ball> {
    move |q| Some(balls.from_rational(q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lobachevsky, Trigonometric};
    use lindstedt_algebra::{PhaseAlgebra, Rationals, Ring};
    use lindstedt_coeff::PolynomialRing;

    #[test]
    fn elements_of_both_algebras_at_a_point() {
        let balls = Balls::new(200);
        let x = Point::Rational(Rational::from((9, 7)));
        let (cos, sin) = (cosine(&x, balls), sine(&x, balls));
        // cos 3x = 4 cos^3 - 3 cos, sin 2x = 2 sin cos.
        let a = Trigonometric::new(Rationals);
        let f = a.add(&a.cos(3, Rational::from((1, 3))), &a.sin(2, Rational::from(5)));
        let value = trigonometric(&f, &x, balls, of_rational(balls));
        let cube = balls.mul_i64(&balls.mul(&cos, &balls.square(&cos)), 4);
        let third =
            balls.mul_rational(&balls.sub(&cube, &balls.mul_i64(&cos, 3)), &Rational::from((1, 3)));
        let expected = balls.add(&third, &balls.mul_i64(&balls.mul(&sin, &cos), 10));
        assert!(value.is_some_and(|v| v.overlaps(&expected) && v.relative_accuracy_bits() > 180));

        // x_1(pi/4) and x_1(pi/3) of the power law, x_1 = cos l + sin Lambda_1 (mpmath 1.3.0).
        let ring = Lobachevsky::new(PolynomialRing::default());
        let x1 = ring.sum_of_products(&[
            (&ring.cosine(), &ring.log_secant()),
            (&ring.sine(), &ring.lambda(1)),
        ]);
        let table = LambdaTable::new(1, balls);
        let one = |_: &_| Some(balls.one());
        for (part, expected) in
            [(4, "-0.0787782056210015997202045188148"), (3, "-0.0929090169743008872791768684345")]
        {
            let value = lobachevsky(&x1, &Point::PiTimes(Rational::from((1, part))), &table, one);
            let decimal = value.and_then(|v| lindstedt_number::digits::decimal(&v, 30));
            assert_eq!(decimal.as_deref(), Some(expected));
        }
        let pole = Point::PiTimes(Rational::from((1, 2)));
        assert!(lobachevsky(&x1, &pole, &table, one).is_none());
    }
}
