//! Real balls: a midpoint at p bits and a rigorous radius.
//!
//! A [`Ball`] encloses one real number x: |x - midpoint| <= radius, always. The precision belongs
//! to the context [`Balls`]; elements are bare. Balls are not a ring (equality cannot be decided,
//! multiplication does not distribute), so the ring trait is not implemented: the same names are
//! inherent methods here.
//!
//! # Error bounds
//!
//! Every operation f is evaluated at the midpoints by MPFR with correct rounding, which costs at
//! most half a unit in the last place, and the radii are propagated by a bound of
//! |f(m + d) - f(m)| over |d| <= r that stands beside each operation. Radii have 53 bits and every
//! step in them is rounded up. MPFR's exponents reach 2^(+-10^9), so a radius of 10^-100000 is an
//! ordinary number; underflow is counted as an error, and an overflow gives the whole line.

mod complex;
mod elementary;
pub mod ring;

pub use complex::{Complex, ComplexBalls};

use rug::float::{Constant, Round, Special};
use rug::ops::{AddAssignRound, AssignRound, MulAssignRound, Pow};
use rug::{Float, Integer, Rational};
use std::cmp::Ordering;

/// Bits of a radius.
const RADIUS_BITS: u32 = 53;
/// Precisions are clamped to this range; the upper end (about 20 million digits) is where GMP's
/// reaction to missing memory, abort, would come near.
const MIN_BITS: u32 = 2;
const MAX_BITS: u32 = 1 << 26;

/// All real numbers x with |x - midpoint| <= radius.
///
/// An infinite radius stands for "nothing is known" and survives every operation.
#[derive(Clone, Debug)]
pub struct Ball {
    midpoint: Float,
    radius: Float,
}

/// The context of ball arithmetic: the precision of the midpoints in bits.
///
/// Operands of another precision are accepted; the result is rounded to this one and the rounding
/// is counted in the radius.
///
/// ```
/// use lindstedt_number::ball::Balls;
/// use rug::Rational;
///
/// let balls = Balls::new(128);
/// let third = balls.from_rational(&Rational::from((1, 3)));
/// let one = balls.mul(&third, &balls.from_i64(3));
/// assert!(one.contains(&Rational::from(1)));
/// assert!(one.relative_accuracy_bits() >= 125);
/// assert!(balls.div(&one, &balls.zero()).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Balls {
    bits: u32,
}

/// A value in radius precision, rounded up (the direction of every bound).
fn up<T>(value: T) -> Float
where
    Float: AssignRound<T, Round = Round, Ordering = Ordering>,
{
    Float::with_val_round(RADIUS_BITS, value, Round::Up).0
}

/// A value in radius precision, rounded down (for denominators of bounds).
fn down<T>(value: T) -> Float
where
    Float: AssignRound<T, Round = Round, Ordering = Ordering>,
{
    Float::with_val_round(RADIUS_BITS, value, Round::Down).0
}

fn radius_zero() -> Float {
    Float::new(RADIUS_BITS)
}

/// The error of rounding to nearest at p bits: ulp/2 = 2^(e-p-1) for |x| in [2^(e-1), 2^e).
///
/// At the lower end of the exponents the error is below the least positive number, 2^(exp_min-1),
/// instead; clamping the exponent from below covers that case and the result 0.
fn half_ulp(x: &Float) -> Float {
    let least = i64::from(rug::float::exp_min()) - 1;
    let exponent = x.get_exp().map_or(least, i64::from);
    let power = (exponent - i64::from(x.prec()) - 1).max(least);
    up(Float::i_exp(1, i32::try_from(power).unwrap_or(i32::MAX)))
}

/// r + s rounded up.
fn add_up(r: &Float, s: &Float) -> Float {
    up(r + s)
}

/// |x| rounded up.
fn magnitude(x: &Float) -> Float {
    up(x.abs_ref())
}

impl Ball {
    /// The centre of the ball.
    #[must_use]
    pub fn midpoint(&self) -> &Float {
        &self.midpoint
    }
    /// The radius, at least 0, possibly infinite.
    #[must_use]
    pub fn radius(&self) -> &Float {
        &self.radius
    }
    /// Whether the radius is 0.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.radius.is_zero()
    }
    /// Whether the radius is finite, that is whether anything is known.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.radius.is_finite()
    }
    /// Whether 0 lies in the ball. Decided exactly: |m| <= r.
    #[must_use]
    pub fn contains_zero(&self) -> bool {
        self.midpoint.cmp_abs(&self.radius) != Some(Ordering::Greater)
    }
    /// Whether every number of the ball is positive. Decided exactly: m > r.
    #[must_use]
    pub fn is_positive(&self) -> bool {
        self.midpoint > self.radius
    }
    /// Whether every number of the ball is negative. Decided exactly.
    #[must_use]
    pub fn is_negative(&self) -> bool {
        self.midpoint.is_sign_negative() && !self.contains_zero()
    }
    /// Whether q lies in the ball. Decided exactly.
    ///
    /// |m - q| <= r holds if and only if it holds after rounding |m - q| up to the grid of the
    /// radii, because r is a point of that grid.
    #[must_use]
    pub fn contains(&self, q: &Rational) -> bool {
        let above = up(&self.midpoint - q);
        let below = up(q - &self.midpoint);
        above <= self.radius && below <= self.radius
    }
    /// Whether the balls may have a common point: `false` proves that they have none, `true` is
    /// exact up to the rounding of the radii.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        let above = down(&self.midpoint - &other.midpoint);
        let below = down(&other.midpoint - &self.midpoint);
        let reach = up(&self.radius + &other.radius);
        above <= reach && below <= reach
    }
    /// An upper bound of |x| (53 bits): |m| + r rounded up.
    #[must_use]
    pub fn abs_upper(&self) -> Float {
        up(&magnitude(&self.midpoint) + &self.radius)
    }
    /// A lower bound of |x| (53 bits): max(|m| - r, 0) rounded down.
    #[must_use]
    pub fn abs_lower(&self) -> Float {
        if self.contains_zero() {
            return radius_zero();
        }
        let magnitude = Float::with_val(self.midpoint.prec(), self.midpoint.abs_ref());
        down(&magnitude - &self.radius)
    }
    /// A lower bound of x, at the precision of the midpoint.
    #[must_use]
    pub fn lower(&self) -> Float {
        let difference = &self.midpoint - &self.radius;
        Float::with_val_round(self.midpoint.prec(), difference, Round::Down).0
    }
    /// An upper bound of x, at the precision of the midpoint.
    #[must_use]
    pub fn upper(&self) -> Float {
        let sum = &self.midpoint + &self.radius;
        Float::with_val_round(self.midpoint.prec(), sum, Round::Up).0
    }
    /// Some k with r <= 2^-k |m|: `i64::MAX` for an exact ball, `i64::MIN` where nothing relative
    /// is known (midpoint 0 or infinite radius).
    #[must_use]
    pub fn relative_accuracy_bits(&self) -> i64 {
        if self.radius.is_zero() {
            return i64::MAX;
        }
        // |m| >= 2^(e-1) and r < 2^f give r/|m| < 2^(f-e+1).
        match (self.midpoint.get_exp(), self.radius.get_exp()) {
            (Some(e), Some(f)) => i64::from(e) - i64::from(f) - 1,
            _ => i64::MIN,
        }
    }
}

impl Balls {
    /// The context with midpoints of `bits` bits, clamped to 2..=2^26.
    #[must_use]
    pub fn new(bits: u32) -> Self {
        Self { bits: bits.clamp(MIN_BITS, MAX_BITS) }
    }
    /// The precision of the midpoints.
    #[must_use]
    pub fn bits(self) -> u32 {
        self.bits
    }
    /// The context with `extra` more bits (guard bits of a longer computation).
    #[must_use]
    pub fn with_guard(self, extra: u32) -> Self {
        Self::new(self.bits.saturating_add(extra))
    }

    /// Rounds `value` to the precision and adds the rounding error to the propagated radius.
    /// A result that is not finite tells nothing.
    pub(crate) fn enclose<T>(self, value: T, propagated: Float) -> Ball
    where
        Float: AssignRound<T, Round = Round, Ordering = Ordering>,
    {
        let (midpoint, order) = Float::with_val_round(self.bits, value, Round::Nearest);
        if !midpoint.is_finite() || !propagated.is_finite() {
            return self.indeterminate();
        }
        let radius = match order {
            Ordering::Equal => propagated,
            _ => add_up(&propagated, &half_ulp(&midpoint)),
        };
        if radius.is_finite() { Ball { midpoint, radius } } else { self.indeterminate() }
    }

    /// The ball of all real numbers: the answer where nothing is known.
    #[must_use]
    pub fn indeterminate(self) -> Ball {
        Ball {
            midpoint: Float::new(self.bits),
            radius: Float::with_val(RADIUS_BITS, Special::Infinity),
        }
    }
    /// 0, exactly.
    #[must_use]
    pub fn zero(self) -> Ball {
        self.enclose(0, radius_zero())
    }
    /// 1, exactly.
    #[must_use]
    pub fn one(self) -> Ball {
        self.enclose(1, radius_zero())
    }
    /// n, exact where n fits into the precision.
    #[must_use]
    pub fn from_i64(self, n: i64) -> Ball {
        self.enclose(n, radius_zero())
    }
    /// n, exact where n fits into the precision.
    #[must_use]
    pub fn from_integer(self, n: &Integer) -> Ball {
        self.enclose(n, radius_zero())
    }
    /// q within half an ulp.
    #[must_use]
    pub fn from_rational(self, q: &Rational) -> Ball {
        self.enclose(q, radius_zero())
    }
    /// The number that x is (exact for at least 53 bits); `None` for NaN and infinities.
    #[must_use]
    pub fn from_f64(self, x: f64) -> Option<Ball> {
        x.is_finite().then(|| self.enclose(x, radius_zero()))
    }
    /// The ball around `midpoint` with the given error bound (its absolute value, rounded up).
    #[must_use]
    pub fn from_parts(self, midpoint: &Float, error: &Float) -> Ball {
        self.enclose(midpoint, magnitude(error))
    }
    /// The same number at this precision.
    #[must_use]
    pub fn round(self, a: &Ball) -> Ball {
        self.enclose(&a.midpoint, a.radius.clone())
    }
    /// The same ball, widened by an error bound (its absolute value): for truncation errors.
    #[must_use]
    pub fn add_error(self, a: &Ball, error: &Float) -> Ball {
        self.enclose(&a.midpoint, up(&a.radius + &magnitude(error)))
    }

    /// a + b: the radii add.
    #[must_use]
    pub fn add(self, a: &Ball, b: &Ball) -> Ball {
        self.enclose(&a.midpoint + &b.midpoint, up(&a.radius + &b.radius))
    }
    /// a - b: the radii add.
    #[must_use]
    pub fn sub(self, a: &Ball, b: &Ball) -> Ball {
        self.enclose(&a.midpoint - &b.midpoint, up(&a.radius + &b.radius))
    }
    /// -a.
    #[must_use]
    pub fn neg(self, a: &Ball) -> Ball {
        self.enclose(-&a.midpoint, a.radius.clone())
    }
    /// |a|: the radius stays (| |x| - |m| | <= |x - m|).
    #[must_use]
    pub fn abs(self, a: &Ball) -> Ball {
        self.enclose(a.midpoint.abs_ref(), a.radius.clone())
    }
    /// a b: |(m+d)(n+e) - mn| <= |m| s + |n| r + r s = |m| s + r (|n| + s).
    #[must_use]
    pub fn mul(self, a: &Ball, b: &Ball) -> Ball {
        let mut radius = radius_zero();
        if !a.is_exact() || !b.is_exact() {
            let left = up(&magnitude(&a.midpoint) * &b.radius);
            let right = up(&a.radius * &b.abs_upper());
            radius = up(&left + &right);
        }
        self.enclose(&a.midpoint * &b.midpoint, radius)
    }
    /// a_1 b_1 + a_2 b_2 + ...: every product is added with one rounding, the radii as in [`Self::mul`].
    #[must_use]
    pub fn sum_of_products(self, pairs: &[(&Ball, &Ball)]) -> Ball {
        let mut midpoint = Float::new(self.bits);
        let (mut radius, mut part) = (radius_zero(), radius_zero());
        for (a, b) in pairs {
            let order = midpoint.add_assign_round(&a.midpoint * &b.midpoint, Round::Nearest);
            if !midpoint.is_finite() {
                return self.indeterminate();
            }
            if order != Ordering::Equal {
                radius.add_assign_round(&half_ulp(&midpoint), Round::Up);
            }
            if !a.is_exact() || !b.is_exact() {
                part.assign_round(a.midpoint.abs_ref(), Round::Up);
                part.mul_assign_round(&b.radius, Round::Up);
                radius.add_assign_round(&part, Round::Up);
                part.assign_round(b.midpoint.abs_ref(), Round::Up);
                part.add_assign_round(&b.radius, Round::Up);
                part.mul_assign_round(&a.radius, Round::Up);
                radius.add_assign_round(&part, Round::Up);
            }
        }
        if radius.is_finite() { Ball { midpoint, radius } } else { self.indeterminate() }
    }
    /// a q for a rational number q: the radius is r |q|.
    #[must_use]
    pub fn mul_rational(self, a: &Ball, q: &Rational) -> Ball {
        let size = Rational::from(q.abs_ref());
        self.enclose(&a.midpoint * q, up(&a.radius * &size))
    }
    /// a n for a small integer n: the radius is r |n|.
    #[must_use]
    pub fn mul_i64(self, a: &Ball, n: i64) -> Ball {
        self.enclose(&a.midpoint * n, up(&a.radius * n.unsigned_abs()))
    }
    /// a / n for a small integer n: the radius is r / |n|. `None` for n = 0.
    #[must_use]
    pub fn div_i64(self, a: &Ball, n: i64) -> Option<Ball> {
        (n != 0).then(|| self.enclose(&a.midpoint / n, up(&a.radius / n.unsigned_abs())))
    }
    /// a 2^k, exact up to overflow and underflow.
    #[must_use]
    pub fn mul_power_of_two(self, a: &Ball, k: i32) -> Ball {
        let factor = Float::with_val(MIN_BITS, Float::i_exp(1, k));
        if factor.is_zero() || !factor.is_finite() {
            return self.indeterminate();
        }
        self.enclose(&a.midpoint * &factor, up(&a.radius * &factor))
    }
    /// a^2: |(m+d)^2 - m^2| <= r (2|m| + r).
    #[must_use]
    pub fn square(self, a: &Ball) -> Ball {
        let twice = up(&magnitude(&a.midpoint) + &a.abs_upper());
        self.enclose(a.midpoint.square_ref(), up(&a.radius * &twice))
    }
    /// a / b, `None` where b contains 0.
    ///
    /// |(m+d)/(n+e) - m/n| = |d - (m/n) e| / |n+e| <= (r + |m/n| s) / (|n| - s).
    #[must_use]
    pub fn div(self, a: &Ball, b: &Ball) -> Option<Ball> {
        let denominator = b.abs_lower();
        if b.contains_zero() || denominator.is_zero() {
            return None;
        }
        let mut radius = radius_zero();
        if !a.is_exact() || !b.is_exact() {
            let quotient = up(&magnitude(&a.midpoint) / &down(b.midpoint.abs_ref()));
            let numerator = up(&a.radius + &up(&quotient * &b.radius));
            radius = up(&numerator / &denominator);
        }
        Some(self.enclose(&a.midpoint / &b.midpoint, radius))
    }
    /// a^n, `None` where n < 0 and a contains 0.
    ///
    /// By the mean value theorem |x^n - m^n| <= |n| r M with M the maximum of |x|^(n-1) over the
    /// ball, taken at the largest |x| for n >= 1 and at the smallest for n < 0.
    #[must_use]
    pub fn powi(self, a: &Ball, n: i64) -> Option<Ball> {
        if n == 0 {
            return Some(self.one());
        }
        let extreme = if n > 0 { a.abs_upper() } else { a.abs_lower() };
        if n < 0 && extreme.is_zero() {
            return None;
        }
        let mut radius = radius_zero();
        if !a.is_exact() {
            let power = up((&extreme).pow(&(Integer::from(n) - 1)));
            let slope = up(&power * &up(n.unsigned_abs()));
            radius = up(&a.radius * &slope);
        }
        Some(self.enclose((&a.midpoint).pow(&Integer::from(n)), radius))
    }
    /// The smallest ball of this context, up to rounding, that contains both balls.
    #[must_use]
    pub fn hull(self, a: &Ball, b: &Ball) -> Ball {
        let (low_a, low_b, high_a, high_b) = (a.lower(), b.lower(), a.upper(), b.upper());
        let low = if low_b < low_a { low_b } else { low_a };
        let high = if high_b > high_a { high_b } else { high_a };
        let middle = Float::with_val(self.bits, &low + &high) / 2u32;
        let (left, right) = (up(&middle - &low), up(&high - &middle));
        self.enclose(&middle, if left > right { left } else { right })
    }
    /// pi.
    #[must_use]
    pub fn pi(self) -> Ball {
        self.enclose(Constant::Pi, radius_zero())
    }
    /// ln 2.
    #[must_use]
    pub fn ln_2(self) -> Ball {
        self.enclose(Constant::Log2, radius_zero())
    }
    /// zeta(n) = sum_k k^-n, `None` for n < 2.
    #[must_use]
    pub fn zeta(self, n: u32) -> Option<Ball> {
        (n >= 2).then(|| self.enclose(Float::zeta_u(n), radius_zero()))
    }
}

#[cfg(test)]
mod tests;
