//! Periods in closed form, as balls.

use lindstedt_coeff::ball::{Ball, Balls};
use rug::Float;

/// The arithmetic-geometric mean of two positive numbers; the mean lies between the iterates.
/// O(log p) square roots after O(log |log a/b|) first ones.
pub(super) fn agm(balls: Balls, a: &Ball, b: &Ball) -> Option<Ball> {
    let (mut a, mut b) = (a.clone(), b.clone());
    for _ in 0..200 {
        if !a.is_positive() || !b.is_positive() {
            return None;
        }
        let gap = balls.sub(&a, &b).abs_upper();
        if gap <= a.abs_upper() >> balls.bits() || a.overlaps(&b) {
            return Some(balls.hull(&a, &b));
        }
        let mean = balls.mul_power_of_two(&balls.add(&a, &b), -1);
        b = balls.sqrt(&balls.mul(&a, &b))?;
        a = mean;
    }
    None
}

/// ln Gamma(x) for x > 1/2 - 1/10: MPFR rounds correctly at the midpoint; psi is monotone with
/// ln x - 1/x < psi(x) < ln x, so |psi| <= |ln m| + 4 on a ball of radius below 1/10.
fn ln_gamma(balls: Balls, x: &Ball) -> Option<Ball> {
    if *x.radius() > 0.1 || *x.midpoint() < 0.499 {
        return None;
    }
    let value = Float::with_val(balls.bits(), x.midpoint().ln_gamma_ref());
    let middle = balls.from_parts(x.midpoint(), &Float::new(53));
    let slope = balls.add(&balls.abs(&balls.ln(&middle)?), &balls.from_i64(4));
    let slope = balls.mul(&slope, &balls.from_parts(x.radius(), &Float::new(53)));
    let rounding = Float::with_val(53, value.abs_ref()) >> (balls.bits() - 1);
    let ball = balls.from_parts(&value, &rounding);
    ball.is_finite().then(|| balls.add_error(&ball, &slope.abs_upper()))
}

/// T = 4 sqrt(pi (1 + d)) Gamma(1 + y)/Gamma(1/2 + y) a^(-d), y = 1/(2 + 2d), of
/// x'' + x (x^2)^d = 0, d > -1, x(0) = a. The logarithms of the gamma functions keep the ratio
/// for y -> infinity.
pub(super) fn power_law(balls: Balls, delta: &Ball, amplitude: &Ball) -> Option<Ball> {
    let growth = balls.add(&balls.one(), delta);
    let y = balls.div(&balls.one(), &balls.mul_i64(&growth, 2))?;
    let half = balls.mul_power_of_two(&balls.one(), -1);
    let upper = ln_gamma(balls, &balls.add(&balls.one(), &y))?;
    let lower = ln_gamma(balls, &balls.add(&half, &y))?;
    let scale = balls.mul(delta, &balls.ln(amplitude)?);
    let exponent = balls.sub(&balls.sub(&upper, &lower), &scale);
    let root = balls.sqrt(&balls.mul(&balls.pi(), &growth))?;
    Some(balls.mul_i64(&balls.mul(&root, &balls.exp(&exponent)), 4))
}

/// T = 4 K(sin(a/2)) = 2 pi/agm(1, cos(a/2)) of x'' + sin x = 0, x(0) = a < pi.
pub(super) fn pendulum(balls: Balls, amplitude: &Ball) -> Option<Ball> {
    let half = balls.cos(&balls.mul_power_of_two(amplitude, -1));
    let mean = agm(balls, &balls.one(), &half)?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}

/// T = 4 K(k)/sqrt(1 + r) = 2 pi/agm(sqrt(1 + r), sqrt(1 + r/2)) of x'' + x + eps x^3 = 0,
/// r = eps x(0)^2 > -1, k^2 = r/(2 + 2r).
pub(super) fn duffing(balls: Balls, rho: &Ball) -> Option<Ball> {
    let one = balls.one();
    let root = |x: &Ball| balls.sqrt(&balls.add(&one, x));
    let mean = agm(balls, &root(rho)?, &root(&balls.mul_power_of_two(rho, -1))?)?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_coeff::digits::certify;
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
        let value = digits(&|balls| power_law(balls, &balls.one(), &balls.one()));
        assert_eq!(value.as_deref(), Ok("7.416298709205487673735401"));
        // x'' + sgn x = 0: 4 sqrt 2, and with amplitude 4 twice as long.
        let value = digits(&|balls| power_law(balls, &of(-1, 2)(balls), &balls.from_i64(4)));
        assert_eq!(value.as_deref(), Ok("11.31370849898476039041351"));
        let value = digits(&|balls| duffing(balls, &balls.from_i64(1)));
        assert_eq!(value.as_deref(), Ok("4.768022029102460806304518"));
    }
}
