//! Periods and forces by routes that share nothing with the expansions.

use lindstedt::unstable::evaluation::closed::agm;
use lindstedt_melnikov::hyperbolic::gamma;
use lindstedt_melnikov::quadrature::tanh_sinh;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Integer, Rational};

/// The exact period of x'' + x^n = 0, x(0) = 1, x'(0) = 0, for the exponent
/// n > 0 of x |x|^(n-1), by the beta integral:
///
///   T = 4 sqrt((n + 1)/2) int_0^1 dx/sqrt(1 - x^(n+1))
///     = 4 sqrt(pi (n + 1)/2) Gamma(1 + 1/(n + 1))/Gamma(1/2 + 1/(n + 1)).
pub(super) fn power_law_period(n: &Rational, balls: Balls) -> Option<Ball> {
    if *n <= 0 {
        return None;
    }
    let next = Rational::from(n + 1u32);
    let shift = Rational::from(next.recip_ref());
    let above = gamma(balls, &Rational::from(&shift + 1u32))?;
    let below = gamma(balls, &(shift + Rational::from((1, 2))))?;
    let root = balls.sqrt(&balls.mul_rational(&balls.pi(), &(next / 2u32)))?;
    balls.div(&balls.mul_i64(&balls.mul(&root, &above), 4), &below)
}

/// d(omega^2)/d(delta) at delta = 0, omega^2 = (2 pi/T)^2, of that closed form by a central
/// difference. Estimated.
pub(super) fn frequency_squared_slope(balls: Balls) -> Option<Ball> {
    let shift = balls.bits() / 4;
    let step = Rational::from((1, Integer::from(1) << shift));
    let squared = |delta: Rational| {
        let period = power_law_period(&(delta * 2u32 + 1u32), balls)?;
        let omega = balls.div(&balls.mul_i64(&balls.pi(), 2), &period)?;
        Some(balls.square(&omega))
    };
    let difference = balls.sub(&squared(step.clone())?, &squared(-step)?);
    Some(balls.mul_power_of_two(&difference, i32::try_from(shift).ok()? - 1))
}

/// The exact period of the pendulum with amplitude a: T = 4 K(sin(a/2)) = 2 pi/agm(1, cos(a/2)).
pub(super) fn pendulum_period(amplitude: &Rational, balls: Balls) -> Option<Ball> {
    let half = balls.from_rational(&Rational::from(amplitude / 2u32));
    let mean = agm(balls, &balls.one(), &balls.cos(&half))?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}

/// The same period by the hypergeometric series T = 2 pi sum_k ((1/2)_k/k!)^2 sin^(2k)(a/2); the
/// terms decrease at least like powers of sin^2(a/2), which bounds the rest.
pub(super) fn pendulum_period_by_series(amplitude: &Rational, balls: Balls) -> Option<Ball> {
    let half = balls.from_rational(&Rational::from(amplitude / 2u32));
    let square = balls.square(&balls.sin(&half));
    let (mut term, mut sum) = (balls.one(), balls.zero());
    for k in 1..=4 * i64::from(balls.bits()) {
        sum = balls.add(&sum, &term);
        let factor = Rational::from((2 * k - 1, 2 * k));
        let ratio = balls.mul_rational(&square, &factor.square());
        term = balls.mul(&term, &ratio);
    }
    let rest = balls.div(&term, &balls.sub(&balls.one(), &square))?;
    let sum = balls.add_error(&sum, &rest.abs_upper());
    Some(balls.mul_i64(&balls.mul(&balls.pi(), &sum), 2))
}

/// The exact period for n = 3 by the same mean: int_0^1 dx/sqrt(1 - x^4) is lemniscatic,
/// T = 2 pi/agm(1, 1/sqrt 2).
pub(super) fn cubic_period(balls: Balls) -> Option<Ball> {
    let root = balls.sqrt(&balls.from_rational(&Rational::from((1, 2))))?;
    let mean = agm(balls, &balls.one(), &root)?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}

/// int_low^high -ln|cos t| dt by tanh-sinh quadrature in MPFR, split at the odd multiples of
/// pi/2 inside: no theory of the integrand beyond its definition. Estimated, not certified:
/// about 30 digits; not a number where they are not reached.
pub(super) fn integral_of_log_secant(low: &Float, high: &Float) -> Float {
    const BITS: u32 = 110;
    /// The nodes come that near to a pole.
    const POLE_BITS: u32 = 300;
    if low > high {
        return -integral_of_log_secant(high, low);
    }
    let half_pi = Float::with_val(POLE_BITS, rug::float::Constant::Pi) / 2u32;
    let poles = (-8..=8).filter(|k| k % 2 != 0).map(|k| Float::with_val(POLE_BITS, &half_pi * k));
    let mut nodes = vec![low.clone()];
    nodes.extend(poles.filter(|pole| pole > low && pole < high));
    nodes.push(high.clone());
    let log_secant = |t: &Float| Some(-Float::with_val(t.prec(), t.cos_ref()).abs().ln());
    let part = |pair: &[Float]| match pair {
        [from, to] => tanh_sinh(BITS, from, to, log_secant).ok().map(|found| found.value),
        _ => None,
    };
    let sum = nodes.windows(2).try_fold(Float::new(BITS), |sum, pair| Some(sum + part(pair)?));
    sum.unwrap_or_else(|| Float::with_val(BITS, rug::float::Special::Nan))
}

/// Taylor coefficient 1 or 2 of force(delta) at 0, by a central difference with step 2^-(bits/4):
/// the error is of the size 2^-(bits/2). Estimated, not certified.
pub(super) fn difference(
    power: usize,
    balls: Balls,
    force: impl Fn(&Ball) -> Option<Ball>,
) -> Option<Ball> {
    let shift = i32::try_from(balls.bits() / 4).ok()?;
    let step = balls.mul_power_of_two(&balls.one(), -shift);
    let (right, left) = (force(&step)?, force(&balls.neg(&step))?);
    if power == 1 {
        return Some(balls.mul_power_of_two(&balls.sub(&right, &left), shift - 1));
    }
    let middle = balls.mul_i64(&force(&balls.zero())?, 2);
    let second = balls.sub(&balls.add(&right, &left), &middle);
    Some(balls.mul_power_of_two(&second, 2 * shift - 1))
}

/// The coefficients of y^exponent for a series y with leading coefficient one, as in
/// [`lindstedt_series::Series::power`], in balls.
pub(super) fn power(y: &[Ball], exponent: &Rational, balls: Balls) -> Option<Vec<Ball>> {
    let mut z = vec![balls.one()];
    for n in 1..y.len() {
        let mut sum = balls.zero();
        for k in 1..=n {
            let factor = Rational::from(exponent + 1u32) * Rational::from(k) - Rational::from(n);
            let term = balls.mul(y.get(k)?, z.get(n - k)?);
            sum = balls.add(&sum, &balls.mul_rational(&term, &factor));
        }
        z.push(balls.div_i64(&sum, i64::try_from(n).ok()?)?);
    }
    Some(z)
}
