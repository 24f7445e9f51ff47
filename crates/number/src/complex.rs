//! Complex numbers as pairs of reals: rectangles in the certified path.

use crate::real::Real;
use std::ops::{Add, Mul, Neg, Sub};

/// re + i im.
#[derive(Clone, Debug)]
pub struct Complex<S> {
    /// Real part.
    pub re: S,
    /// Imaginary part.
    pub im: S,
}

impl<S: Real> Complex<S> {
    /// re + i im.
    #[inline(always)]
    #[must_use]
    pub fn new(re: S, im: S) -> Self {
        Self { re, im }
    }
    /// A real number.
    #[inline(always)]
    #[must_use]
    pub fn real(re: S) -> Self {
        let im = re.integer(0);
        Self { re, im }
    }
    /// The conjugate number.
    #[must_use]
    pub fn conjugate(&self) -> Self {
        Self::new(self.re.clone(), -self.im.clone())
    }
    /// The product with a real number.
    #[inline(always)]
    #[must_use]
    pub fn scaled(&self, factor: &S) -> Self {
        Self::new(self.re.clone() * factor, self.im.clone() * factor)
    }
    /// |z|^2.
    #[must_use]
    pub fn norm_squared(&self) -> S {
        self.re.square() + self.im.square()
    }
    /// |z|.
    #[must_use]
    pub fn modulus(&self) -> S {
        self.norm_squared().sqrt()
    }
    /// z + z_1 w_1 + z_2 w_2 + ...
    #[inline(always)]
    #[must_use]
    pub fn plus_products<'a>(self, pairs: impl Iterator<Item = (&'a Self, &'a Self)>) -> Self
    where
        S: 'a,
    {
        let parts = pairs.map(|(z, w)| [[&z.re, &z.im], [&w.re, &w.im]]);
        let [re, im] = S::add_products([self.re, self.im], parts);
        Self { re, im }
    }
    /// 1/z; not finite where z may be zero.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let norm = self.norm_squared();
        Self::new(self.re.clone() / &norm, -(self.im.clone() / &norm))
    }
    /// `self`/`other`.
    #[must_use]
    pub fn over(&self, other: &Self) -> Self {
        self.clone() * &other.inverse()
    }
    /// e^z.
    #[must_use]
    pub fn exp(&self) -> Self {
        let size = self.re.exp();
        let (sin, cos) = self.im.sin_cos();
        Self::new(size.clone() * cos, size * sin)
    }
    /// A square root, for functions that are even in it: the real part is not negative, except
    /// that the sign on the negative axis is arbitrary.
    ///
    /// Either formula holds wherever its denominator is not zero; the larger one is taken.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        let modulus = self.modulus();
        if self.re.to_f64() >= 0.0 {
            let re = (modulus + &self.re).halved().sqrt();
            let im = self.im.clone() / re.doubled();
            return Self::new(re, im);
        }
        let im = (modulus - &self.re).halved().sqrt();
        let re = self.im.clone() / im.doubled();
        Self::new(re, im)
    }
    /// The midpoint.
    #[must_use]
    pub fn to_f64(&self) -> Complex<f64> {
        Complex::new(self.re.to_f64(), self.im.to_f64())
    }
    /// Whether anything is known about both parts.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
    /// The midpoint as an exact number.
    #[must_use]
    pub fn centre(&self) -> Self {
        Self::new(self.re.centre(), self.im.centre())
    }
    /// An upper bound of |z|.
    #[must_use]
    pub fn magnitude_above(&self) -> f64 {
        self.re.magnitude_above().hypot(self.im.magnitude_above()) * (1.0 + 4.0 * f64::EPSILON)
    }
    /// A lower bound of |z|.
    #[must_use]
    pub fn magnitude_below(&self) -> f64 {
        self.re.magnitude_below().hypot(self.im.magnitude_below()) * (1.0 - 4.0 * f64::EPSILON)
    }
}

impl<S: Real> Add<&Complex<S>> for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: &Self) -> Self {
        Self::new(self.re + &other.re, self.im + &other.im)
    }
}

impl<S: Real> Sub<&Complex<S>> for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: &Self) -> Self {
        Self::new(self.re - &other.re, self.im - &other.im)
    }
}

impl<S: Real> Mul<&Complex<S>> for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: &Self) -> Self {
        let re = self.re.clone() * &other.re - self.im.clone() * &other.im;
        let im = self.re * &other.im + self.im * &other.re;
        Self::new(re, im)
    }
}

impl<S: Real> Add for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + &other
    }
}

impl<S: Real> Sub for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - &other
    }
}

impl<S: Real> Mul for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * &other
    }
}

impl<S: Real> Neg for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ball::Balls;
    use crate::real::Certified;
    use rug::Rational;

    /// Every operation on z = 3 + 4 i and w = 1 - 2 i against what it is by hand.
    fn values<S: Real>(one: &S) -> Vec<(Complex<S>, [f64; 2])> {
        let of = |re: i64, im: i64| Complex::new(one.integer(re), one.integer(im));
        let (z, w) = (of(3, 4), of(1, -2));
        let (sine, cosine) = 4f64.sin_cos();
        vec![
            (Complex::real(one.integer(7)), [7.0, 0.0]),
            (z.conjugate(), [3.0, -4.0]),
            (z.scaled(&one.integer(5)), [15.0, 20.0]),
            (Complex::real(z.norm_squared()), [25.0, 0.0]),
            (Complex::real(z.modulus()), [5.0, 0.0]),
            (z.inverse(), [0.12, -0.16]),
            (z.over(&w), [-1.0, 2.0]),
            (z.exp(), [3f64.exp() * cosine, 3f64.exp() * sine]),
            (z.sqrt(), [2.0, 1.0]),
            (of(-3, 4).sqrt(), [1.0, 2.0]),
            (of(-3, -4).sqrt(), [-1.0, 2.0]),
            (z.clone() + &w, [4.0, 2.0]),
            (z.clone() + w.clone(), [4.0, 2.0]),
            (z.clone() - &w, [2.0, 6.0]),
            (z.clone() - w.clone(), [2.0, 6.0]),
            (z.clone() * &w, [11.0, -2.0]),
            (z.clone() * w, [11.0, -2.0]),
            (-z.clone(), [-3.0, -4.0]),
            (z.centre(), [3.0, 4.0]),
        ]
    }

    #[test]
    fn doubles_and_rectangles_agree() {
        let certified = |n: i32| Certified::from_rational(Balls::new(100), &Rational::from(n));
        let pairs = values(&1.0).into_iter().zip(values(&certified(1)));
        for (n, ((double, [re, im]), (ball, _))) in pairs.enumerate() {
            for z in [double, ball.to_f64()] {
                let gap = (z.re - re).hypot(z.im - im);
                assert!(gap <= 4.0 * f64::EPSILON * re.hypot(im), "{n}: {z:?}");
            }
            assert!(*ball.re.ball().radius() < 1e-27 && *ball.im.ball().radius() < 1e-27);
        }
        let z = Complex::new(3.0, -4.0);
        assert!((5.0..5.0 + 1e-14).contains(&z.magnitude_above()));
        assert!((5.0 - 1e-14..=5.0).contains(&z.magnitude_below()));
        assert!(z.is_finite() && !Complex::new(f64::NAN, 0.0).is_finite());
        assert!(!Complex::new(0.0, f64::NAN).is_finite());
    }
}
