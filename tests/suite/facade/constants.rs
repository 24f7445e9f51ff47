//! Constants and their digits.

use lindstedt::unstable::algebra::Stop;
use lindstedt::unstable::coeff::{PolynomialRing, Symbol};
use lindstedt::unstable::derivation::constants::{Constants, sine_sum};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::number::certified;
use rug::Rational;

#[test]
fn sine_sums() {
    let balls = Balls::new(200);
    let a = Rational::from((7, 5));
    let amplitude = balls.from_rational(&a);
    let sin_over_a = balls.div(&balls.sin(&amplitude), &amplitude);
    let sum = |n, at: &_, balls| sine_sum(n, at, balls, &Stop::default()).unwrap();
    let s0 = sum(0, &amplitude, balls);
    assert!(sin_over_a.is_some_and(|q| q.overlaps(&s0)));
    // S_1 = a/2 d/da (sin a/a) = (cos a - sin a/a)/2.
    let s1 = sum(1, &amplitude, balls);
    let expected = balls.mul_power_of_two(&balls.sub(&balls.cos(&amplitude), &s0), -1);
    assert!(s1.overlaps(&expected) && s1.relative_accuracy_bits() > 180);
    // S_9 at amplitude 1: mpmath 1.3.0, nsum((-1)^k k^9/(2k+1)!).
    let s9 = certified(None, 30, |balls| Some(sum(9, &balls.one(), balls)));
    let decimal = s9.map(|n| n.decimal);
    assert_eq!(decimal.as_deref(), Ok("0.869699443754233368698929266402"));
}

#[test]
fn digits_of_constants() {
    let ring = PolynomialRing::default();
    let mu = ring.symbol(Symbol::Moment(2));
    let constants = Constants::default();
    let number = certified(None, 20, |balls| constants.evaluate(&mu, balls));
    // mu_2 = (ln^2 2 + pi^2/12)/2, mpmath 1.3.0.
    assert_eq!(number.map(|n| n.decimal).as_deref(), Ok("0.65146002367115732145"));
}
