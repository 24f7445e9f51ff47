//! Periods in closed form, as balls.

use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

/// The arithmetic-geometric mean of two positive numbers; the mean lies between the iterates.
/// O(log p) square roots after O(log |log a/b|) first ones.
pub fn agm(balls: Balls, a: &Ball, b: &Ball) -> Option<Ball> {
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

/// ln Gamma(x) for x of 0.499 or more: MPFR rounds correctly at the midpoint; psi is monotone with
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

/// The terms of [`half_beta`] swell by (3/2)^y before they fall: up to this y so many bits do.
const LARGEST_SHARE: u32 = 64;
const SWELLING: u32 = 48;

/// Gamma(1 + y)/Gamma(1/2 + y) by MPFR, whose Bernoulli numbers take minutes at 10 000 digits; the
/// logarithms keep the ratio for y -> infinity.
pub fn gamma_ratio(balls: Balls, y: &Ball) -> Option<Ball> {
    let half = balls.mul_power_of_two(&balls.one(), -1);
    let upper = ln_gamma(balls, &balls.add(&balls.one(), y))?;
    let lower = ln_gamma(balls, &balls.add(&half, y))?;
    Some(balls.exp(&balls.sub(&upper, &lower)))
}

/// The same for a rational y: sqrt(pi)/B(1/2, 1/2 + y), B(p, q) = H(p, q) + H(q, p), halves of the
/// integral that converge geometrically. O(p^2) for p bits.
pub fn gamma_ratio_of_rational(balls: Balls, y: &Rational, stop: &Stop) -> Option<Ball> {
    let balls = Balls::new(balls.bits().saturating_add(SWELLING));
    let half = Rational::from((1, 2));
    let other = Rational::from(y + &half);
    let one_way = half_beta(balls, &half, &other, stop)?;
    let beta = balls.add(&one_way, &half_beta(balls, &other, &half, stop)?);
    balls.div(&balls.sqrt(&balls.pi())?, &beta)
}

/// H(p, q) = int_0^(1/2) t^(p-1) (1 - t)^(q-1) dt = 2^-p sum_k (1 - q)_k/k! 2^-k/(p + k) for p
/// and q of 1/2 or more. From k >= q on |c_k| = |(1 - q)_k|/(2^k k!) at least halves: the rest is
/// below |c_k|/p <= 2 |c_k|.
fn half_beta(balls: Balls, p: &Rational, q: &Rational, stop: &Stop) -> Option<Ball> {
    let (mut c, mut sum) = (balls.one(), balls.zero());
    let small = Float::with_val(53, Float::i_exp(1, -(i32::try_from(balls.bits()).ok()?) - 8));
    for k in 0u32.. {
        if k % 64 == 0 && stop.asked() {
            return None;
        }
        let place = Rational::from(p + k).recip();
        sum = balls.add(&sum, &balls.mul_rational(&c, &place));
        let size = c.abs_upper();
        if *q <= k && size <= small {
            sum = balls.add_error(&sum, &(size * 2u32));
            break;
        }
        let next = k + 1;
        c = balls.mul_rational(&c, &((Rational::from(next) - q) / (2 * u64::from(next))));
    }
    let power = balls.mul_rational(&balls.ln_2(), p);
    Some(balls.mul(&balls.exp(&balls.neg(&power)), &sum))
}

/// T = 4 sqrt(pi (1 + d)) Gamma(1 + y)/Gamma(1/2 + y) a^(-d), y = 1/(2 + 2d), of
/// x'' + x (x^2)^d = 0, d > -1, x(0) = a; d besides as a rational number, if it is one.
pub fn power_law(
    balls: Balls,
    delta: &Ball,
    rational: Option<&Rational>,
    amplitude: &Ball,
    stop: &Stop,
) -> Option<Ball> {
    let growth = balls.add(&balls.one(), delta);
    let share = rational.map(|d| Rational::from(d + 1u32) * 2u32).filter(|s| !s.is_zero());
    let share = share.map(Rational::recip).filter(|y| *y <= LARGEST_SHARE);
    let ratio = match share {
        Some(y) => gamma_ratio_of_rational(balls, &y, stop)?,
        None => gamma_ratio(balls, &balls.div(&balls.one(), &balls.mul_i64(&growth, 2))?)?,
    };
    let scale = balls.exp(&balls.neg(&balls.mul(delta, &balls.ln(amplitude)?)));
    let root = balls.sqrt(&balls.mul(&balls.pi(), &growth))?;
    Some(balls.mul_i64(&balls.mul(&root, &balls.mul(&ratio, &scale)), 4))
}

/// T = 4 K(sin(a/2)) = 2 pi/agm(1, cos(a/2)) of x'' + sin x = 0, x(0) = a < pi.
pub fn pendulum(balls: Balls, amplitude: &Ball) -> Option<Ball> {
    let half = balls.cos(&balls.mul_power_of_two(amplitude, -1));
    let mean = agm(balls, &balls.one(), &half)?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}

/// T = 4 K(k)/sqrt(1 + r) = 2 pi/agm(sqrt(1 + r), sqrt(1 + r/2)) of x'' + x + eps x^3 = 0,
/// r = eps x(0)^2 > -1, k^2 = r/(2 + 2r).
pub fn duffing(balls: Balls, rho: &Ball) -> Option<Ball> {
    let one = balls.one();
    let root = |x: &Ball| balls.sqrt(&balls.add(&one, x));
    let mean = agm(balls, &root(rho)?, &root(&balls.mul_power_of_two(rho, -1))?)?;
    balls.div(&balls.mul_i64(&balls.pi(), 2), &mean)
}
