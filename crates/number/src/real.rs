//! Real numbers for both paths: doubles for charts, certified balls for digits.

use crate::ball::{Ball, Balls};
use rug::{Float, Rational};
use std::cmp::Ordering;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number: an `f64` (rounding errors not tracked) or a [`Certified`] ball.
///
/// The formulas of impact orbits and of their stability are written once over this trait. Division by zero, roots of negative
/// numbers and the like give a number that is not finite (NaN or a ball of infinite radius), which
/// survives every operation, and are refused at the end.
pub trait Real:
    Clone
    + Debug
    + Send
    + Sync
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + for<'a> Add<&'a Self, Output = Self>
    + for<'a> Sub<&'a Self, Output = Self>
    + for<'a> Mul<&'a Self, Output = Self>
    + for<'a> Div<&'a Self, Output = Self>
{
    /// The integer n in the context (precision) of `self`.
    fn integer(&self, n: i64) -> Self;
    /// The double x in the context of `self`; not finite where x is not.
    fn number(&self, x: f64) -> Self;
    /// pi in the context of `self`.
    fn pi(&self) -> Self;
    /// x^2.
    fn square(&self) -> Self;
    /// sqrt(x) for x >= 0; a ball reaching below zero is cut there, a negative number gives a value
    /// that is not finite.
    fn sqrt(&self) -> Self;
    /// e^x.
    fn exp(&self) -> Self;
    /// e^x - 1 without cancellation for small x.
    fn exp_m1(&self) -> Self;
    /// (sin x, cos x).
    fn sin_cos(&self) -> (Self, Self);
    /// The angle of the point (x, y) = (`x`, `self`) in (-pi, pi].
    fn atan2(&self, x: &Self) -> Self;
    /// The sign; `None` where the ball contains zero without being zero, or for NaN.
    fn sign(&self) -> Option<Ordering>;
    /// The midpoint.
    fn to_f64(&self) -> f64;
    /// An upper bound of |x| (for doubles |x| itself).
    fn magnitude_above(&self) -> f64;
    /// A lower bound of |x| (for doubles |x| itself).
    fn magnitude_below(&self) -> f64;
    /// Whether anything is known: a finite double, a finite radius.
    fn is_finite(&self) -> bool;
    /// The midpoint as an exact number (for Newton's method).
    fn centre(&self) -> Self;
    /// x with the error bound |e| added (nothing happens to doubles).
    fn widened(&self, error: &Self) -> Self;
    /// Half width of the band around zero in which a condition of stability counts as neutral:
    /// 10^-10 for doubles, 0 for balls, whose radius decides.
    fn neutral_width(&self) -> f64;
    /// Bits of the midpoint.
    fn precision(&self) -> u32;

    /// Twice x.
    #[inline(always)]
    fn doubled(&self) -> Self {
        self.clone() + self
    }
    /// Half of x.
    #[inline(always)]
    fn halved(&self) -> Self {
        self.clone() / self.integer(2)
    }
    /// Whether the midpoint has a property that a formula chooses its way by; nothing where several numbers that are
    /// computed side by side would go different ways.
    #[inline(always)]
    fn holds(&self, property: impl Fn(f64) -> bool) -> Option<bool> {
        Some(property(self.to_f64()))
    }
    /// z + z_1 w_1 + z_2 w_2 + ..., complex numbers by their real and imaginary parts; balls are added with one rounding per
    /// product of parts.
    #[inline(always)]
    fn add_products<'a>(
        [mut re, mut im]: [Self; 2],
        pairs: impl Iterator<Item = [[&'a Self; 2]; 2]>,
    ) -> [Self; 2]
    where
        Self: 'a,
    {
        for [[a, b], [c, d]] in pairs {
            re = re + (a.clone() * c - b.clone() * d);
            im = im + (a.clone() * d + b.clone() * c);
        }
        [re, im]
    }
    /// Whether x is proved positive.
    #[inline(always)]
    fn is_positive(&self) -> bool {
        self.sign() == Some(Ordering::Greater)
    }
    /// Whether x is proved negative.
    #[inline(always)]
    fn is_negative(&self) -> bool {
        self.sign() == Some(Ordering::Less)
    }
}

impl Real for f64 {
    #[inline]
    fn integer(&self, n: i64) -> Self {
        n as f64
    }
    #[inline]
    fn number(&self, x: f64) -> Self {
        x
    }
    #[inline]
    fn pi(&self) -> Self {
        std::f64::consts::PI
    }
    #[inline]
    fn square(&self) -> Self {
        self * self
    }
    #[inline]
    fn sqrt(&self) -> Self {
        f64::sqrt(*self)
    }
    #[inline]
    fn exp(&self) -> Self {
        f64::exp(*self)
    }
    #[inline]
    fn exp_m1(&self) -> Self {
        f64::exp_m1(*self)
    }
    #[inline]
    fn sin_cos(&self) -> (Self, Self) {
        f64::sin_cos(*self)
    }
    #[inline]
    fn atan2(&self, x: &Self) -> Self {
        f64::atan2(*self, *x)
    }
    #[inline]
    fn sign(&self) -> Option<Ordering> {
        self.partial_cmp(&0.0)
    }
    #[inline]
    fn to_f64(&self) -> f64 {
        *self
    }
    #[inline]
    fn magnitude_above(&self) -> f64 {
        self.abs()
    }
    #[inline]
    fn magnitude_below(&self) -> f64 {
        self.abs()
    }
    #[inline]
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
    #[inline]
    fn centre(&self) -> Self {
        *self
    }
    #[inline]
    fn widened(&self, _error: &Self) -> Self {
        *self
    }
    #[inline]
    fn neutral_width(&self) -> f64 {
        1e-10
    }
    #[inline]
    fn precision(&self) -> u32 {
        f64::MANTISSA_DIGITS
    }
    #[inline]
    fn halved(&self) -> Self {
        0.5 * self
    }
}

/// A ball together with its context: |x - midpoint| <= radius, always.
#[derive(Clone, Debug)]
pub struct Certified {
    value: Ball,
    balls: Balls,
}

impl Certified {
    /// The ball in the context `balls`.
    #[must_use]
    pub fn new(balls: Balls, value: Ball) -> Self {
        Self { value, balls }
    }
    /// The rational number q.
    #[must_use]
    pub fn from_rational(balls: Balls, q: &Rational) -> Self {
        Self::new(balls, balls.from_rational(q))
    }
    /// The ball.
    #[must_use]
    pub fn ball(&self) -> &Ball {
        &self.value
    }
    /// The context.
    #[must_use]
    pub fn balls(&self) -> Balls {
        self.balls
    }
    fn with(&self, value: Ball) -> Self {
        Self { value, balls: self.balls }
    }
    fn or_nothing(&self, value: Option<Ball>) -> Self {
        self.with(value.unwrap_or_else(|| self.balls.indeterminate()))
    }
}

macro_rules! operators {
    ($($trait:ident $name:ident |$balls:ident, $a:ident, $b:ident| $value:expr;)*) => { $(
        impl $trait<&Certified> for Certified {
            type Output = Certified;
            fn $name(self, other: &Certified) -> Certified {
                let ($balls, $a, $b) = (self.balls, &self.value, &other.value);
                let value = $value;
                self.with(value)
            }
        }
        impl $trait for Certified {
            type Output = Certified;
            fn $name(self, other: Certified) -> Certified {
                $trait::$name(self, &other)
            }
        }
    )* };
}

operators! {
    Add add |balls, a, b| balls.add(a, b);
    Sub sub |balls, a, b| balls.sub(a, b);
    Mul mul |balls, a, b| balls.mul(a, b);
    Div div |balls, a, b| balls.div(a, b).unwrap_or_else(|| balls.indeterminate());
}

impl Neg for Certified {
    type Output = Self;
    fn neg(self) -> Self {
        self.with(self.balls.neg(&self.value))
    }
}

impl Real for Certified {
    fn add_products<'a>(
        [re, im]: [Self; 2],
        pairs: impl Iterator<Item = [[&'a Self; 2]; 2]>,
    ) -> [Self; 2] {
        let (mut squares, mut minus, mut mixed) = (Vec::new(), Vec::new(), Vec::new());
        for [[a, b], [c, d]] in pairs {
            squares.push((&a.value, &c.value));
            minus.push((&b.value, &d.value));
            mixed.extend([(&a.value, &d.value), (&b.value, &c.value)]);
        }
        let of = |pairs: &[_]| re.with(re.balls.sum_of_products(pairs));
        let [squares, minus, mixed] = [of(&squares), of(&minus), of(&mixed)];
        [re + (squares - minus), im + mixed]
    }
    fn integer(&self, n: i64) -> Self {
        self.with(self.balls.from_i64(n))
    }
    fn number(&self, x: f64) -> Self {
        self.or_nothing(self.balls.from_f64(x))
    }
    fn pi(&self) -> Self {
        self.with(self.balls.pi())
    }
    fn square(&self) -> Self {
        self.with(self.balls.square(&self.value))
    }
    fn sqrt(&self) -> Self {
        if let Some(root) = self.balls.sqrt(&self.value) {
            return self.with(root);
        }
        if self.value.is_negative() || !self.value.is_finite() {
            return self.with(self.balls.indeterminate());
        }
        // The ball reaches below zero: [0, sqrt(upper end)].
        let upper = self.balls.from_parts(&self.value.abs_upper(), &Float::new(53));
        let root = self.balls.sqrt(&upper).map(|top| self.balls.hull(&self.balls.zero(), &top));
        self.or_nothing(root)
    }
    fn exp(&self) -> Self {
        self.with(self.balls.exp(&self.value))
    }
    fn exp_m1(&self) -> Self {
        // 2 e^(x/2) sinh(x/2)
        let half = self.balls.mul_power_of_two(&self.value, -1);
        let product = self.balls.mul(&self.balls.exp(&half), &self.balls.sinh(&half));
        self.with(self.balls.mul_power_of_two(&product, 1))
    }
    fn sin_cos(&self) -> (Self, Self) {
        (self.with(self.balls.sin(&self.value)), self.with(self.balls.cos(&self.value)))
    }
    fn atan2(&self, x: &Self) -> Self {
        let (balls, y) = (self.balls, &self.value);
        let by = |n: &Ball, d: &Ball| balls.div(n, d).map(|t| balls.atan(&t));
        if x.value.abs_lower() >= y.abs_lower() {
            let angle = by(y, &x.value);
            if !x.value.midpoint().is_sign_negative() {
                return self.or_nothing(angle);
            }
            let turn = match self.sign() {
                Some(Ordering::Less) => balls.neg(&balls.pi()),
                Some(_) => balls.pi(),
                None => balls.indeterminate(),
            };
            return self.or_nothing(angle.map(|angle| balls.add(&angle, &turn)));
        }
        let quarter = balls.mul_power_of_two(&balls.pi(), -1);
        let quarter = if y.is_negative() { balls.neg(&quarter) } else { quarter };
        self.or_nothing(by(&x.value, y).map(|angle| balls.sub(&quarter, &angle)))
    }
    fn sign(&self) -> Option<Ordering> {
        if self.value.is_positive() {
            Some(Ordering::Greater)
        } else if self.value.is_negative() {
            Some(Ordering::Less)
        } else if self.value.is_exact() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }
    fn to_f64(&self) -> f64 {
        if self.value.is_finite() { self.value.midpoint().to_f64() } else { f64::NAN }
    }
    fn magnitude_above(&self) -> f64 {
        // Rounded to nearest from 53 bits: exact; only the smallest numbers are pushed up.
        let above = self.value.abs_upper().to_f64();
        if above == 0.0 && !(self.value.is_exact() && self.value.contains_zero()) {
            return f64::MIN_POSITIVE;
        }
        above
    }
    fn magnitude_below(&self) -> f64 {
        self.value.abs_lower().to_f64_round(rug::float::Round::Down)
    }
    fn is_finite(&self) -> bool {
        self.value.is_finite()
    }
    fn centre(&self) -> Self {
        if !self.value.is_finite() {
            return self.clone();
        }
        self.with(self.balls.from_parts(self.value.midpoint(), &Float::new(53)))
    }
    fn widened(&self, error: &Self) -> Self {
        self.with(self.balls.add_error(&self.value, &error.value.abs_upper()))
    }
    fn neutral_width(&self) -> f64 {
        0.0
    }
    fn precision(&self) -> u32 {
        self.balls.bits()
    }
    fn doubled(&self) -> Self {
        self.with(self.balls.mul_power_of_two(&self.value, 1))
    }
    fn halved(&self) -> Self {
        self.with(self.balls.mul_power_of_two(&self.value, -1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(middle: f64, radius: f64) -> Certified {
        let balls = Balls::new(100);
        let ball = balls.from_parts(&Float::with_val(53, middle), &Float::with_val(53, radius));
        Certified::new(balls, ball)
    }

    /// What every kind of number computes, at 1/2.
    fn values<R: Real>(half: &R) -> Vec<(R, f64)> {
        let (sine, cosine) = half.sin_cos();
        vec![
            (half.integer(-7), -7.0),
            (half.number(0.375), 0.375),
            (half.pi(), std::f64::consts::PI),
            (half.square(), 0.25),
            (half.sqrt(), std::f64::consts::FRAC_1_SQRT_2),
            (half.exp(), 1.648_721_270_700_128),
            (half.exp_m1(), 0.648_721_270_700_128_2),
            (sine, 0.479_425_538_604_203),
            (cosine, 0.877_582_561_890_372_8),
            (half.doubled(), 1.0),
            (half.halved(), 0.25),
            (half.centre(), 0.5),
            (half.widened(&half.integer(0)), 0.5),
        ]
    }

    /// The sign, the magnitudes and whether anything is known.
    fn properties<R: Real>(half: &R) {
        let (minus, zero) = (-half.clone(), half.integer(0));
        assert_eq!((half.to_f64(), minus.to_f64(), zero.to_f64()), (0.5, -0.5, 0.0));
        assert_eq!((half.sign(), minus.sign()), (Some(Ordering::Greater), Some(Ordering::Less)));
        assert_eq!(zero.sign(), Some(Ordering::Equal));
        assert!(half.is_positive() && !half.is_negative() && !zero.is_positive());
        assert!(minus.is_negative() && !minus.is_positive() && !zero.is_negative());
        assert_eq!((minus.magnitude_above(), minus.magnitude_below()), (0.5, 0.5));
        assert_eq!((zero.magnitude_above(), zero.magnitude_below()), (0.0, 0.0));
        let nothing = half.number(f64::INFINITY) - half.number(f64::INFINITY);
        assert!(half.is_finite() && !nothing.is_finite() && nothing.sign().is_none());
        assert!(nothing.to_f64().is_nan() && !nothing.centre().is_finite());
        assert!(!minus.sqrt().is_finite() && !(half.clone() / zero).is_finite());
    }

    /// The angles of points in all quadrants and on the axes, by the angles of their squares' halves.
    fn angles<R: Real>(half: &R) {
        for (y, x) in [(1, 2), (2, 1), (2, -1), (1, -2), (-1, -2), (-2, -1), (-2, 1), (-1, 2)] {
            let angle = half.integer(y).atan2(&half.integer(x)).to_f64();
            let expected = f64::atan2(y as f64, x as f64);
            assert!((angle - expected).abs() < 1e-15, "{y} {x}: {angle}");
        }
        let of = |y, x| half.integer(y).atan2(&half.integer(x)).to_f64();
        let pi = std::f64::consts::PI;
        assert_eq!((of(0, 1), of(0, -1), of(1, 0), of(-1, 0)), (0.0, pi, pi / 2.0, -pi / 2.0));
    }

    #[test]
    fn doubles_and_balls_agree() {
        let half = ball(0.5, 0.0);
        for ((double, value), (ball, _)) in values(&0.5).into_iter().zip(values(&half)) {
            assert!((double - value).abs() <= f64::EPSILON * value.abs(), "{double} {value}");
            assert!((ball.to_f64() - value).abs() <= f64::EPSILON * value.abs(), "{ball:?}");
            assert!(*ball.ball().radius() < 1e-29);
        }
        properties(&0.5);
        properties(&half);
        angles(&0.5);
        angles(&half);
        assert_eq!((0.5.precision(), half.precision()), (53, 100));
        assert_eq!((0.5.neutral_width(), half.neutral_width()), (1e-10, 0.0));
    }

    #[test]
    fn balls_know_what_they_do_not_know() {
        let around = ball(0.0, 1.0);
        assert!(around.sign().is_none() && !around.is_positive() && !around.is_negative());
        assert_eq!((around.magnitude_above(), around.magnitude_below()), (1.0, 0.0));
        // Cut at zero: [0, sqrt 3].
        let root = ball(1.0, 2.0).sqrt();
        assert!(root.ball().contains(&Rational::from((173, 100))) && root.ball().contains_zero());
        assert!(*root.ball().radius() < 0.8661);
        assert!(ball(1.0, 0.5).centre().ball().is_exact());
        let wide = ball(1.0, 0.5).widened(&ball(-2.0, 0.25));
        assert!(wide.ball().upper() >= 3.75 && wide.ball().upper() < 3.751);
        // Across the cut at -pi nothing is said, nor of a point that may be the origin.
        assert!(!around.atan2(&ball(-2.0, 0.0)).is_finite() && !around.atan2(&around).is_finite());
        let least = ball(0.0, 0.0).with(around.balls.mul_power_of_two(&around.balls.one(), -5000));
        assert!(least.magnitude_above() > 0.0 && least.magnitude_below() == 0.0);
    }
}
