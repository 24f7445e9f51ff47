//! Closed forms of periods.

use lindstedt::unstable::algebra::Stop;
use lindstedt::unstable::evaluation::closed::{
    duffing, gamma_ratio, gamma_ratio_of_rational, pendulum, power_law,
};
use lindstedt::unstable::number::ball::{Ball, Balls};
use lindstedt::unstable::number::digits::certify;
use rug::Rational;

/// mpmath 1.3.0: 4 ellipk(sin(a/2)^2), gamma, 4 ellipk(r/(2+2r))/sqrt(1+r).
#[test]
fn closed_forms() {
    let digits = |f: &dyn Fn(Balls) -> Option<Ball>| certify(25, 4000, f).map(|d| d.0);
    let q = |n: i32, d: i32| Rational::from((n, d));
    let of = |n: i32, d: i32| move |balls: Balls| balls.from_rational(&q(n, d));
    let p = of(1, 1);
    let value = digits(&|balls| pendulum(balls, &p(balls)));
    assert_eq!(value.as_deref(), Ok("6.699975664370452712701211"));
    let never = Stop::default();
    let value = digits(&|balls| power_law(balls, &balls.one(), None, &balls.one(), &never));
    assert_eq!(value.as_deref(), Ok("7.416298709205487673735401"));
    // x'' + sgn x = 0: 4 sqrt 2, and with amplitude 4 twice as long.
    let four = |balls: Balls| balls.from_i64(4);
    let value =
        digits(&|balls| power_law(balls, &of(-1, 2)(balls), Some(&q(-1, 2)), &four(balls), &never));
    assert_eq!(value.as_deref(), Ok("11.31370849898476039041351"));
    let value = digits(&|balls| duffing(balls, &balls.from_i64(1)));
    assert_eq!(value.as_deref(), Ok("4.768022029102460806304518"));
}

/// Two routes: MPFR's gamma function, and the halves of the beta integral.
#[test]
fn gamma_ratios() {
    for bits in [2, 60, 400, 2000] {
        let balls = Balls::new(bits).with_guard(32);
        for (n, d) in [(0, 1), (1, 1 << 30), (1, 4), (1, 3), (1, 2), (1, 1), (7, 2), (64, 1)] {
            let y = Rational::from((n, d));
            let one = gamma_ratio(balls, &balls.from_rational(&y)).unwrap();
            let two = gamma_ratio_of_rational(balls, &y, &Stop::default()).unwrap();
            let size = two.abs_upper();
            assert!(one.overlaps(&two), "{y} {bits}");
            assert!(*two.radius() < size >> (bits - 2), "{y} {bits}: {}", two.radius());
        }
    }
}
