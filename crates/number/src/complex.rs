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
    #[must_use]
    pub fn new(re: S, im: S) -> Self {
        Self { re, im }
    }
    /// A real number.
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
    fn add(self, other: &Self) -> Self {
        Self::new(self.re + &other.re, self.im + &other.im)
    }
}

impl<S: Real> Sub<&Complex<S>> for Complex<S> {
    type Output = Self;
    fn sub(self, other: &Self) -> Self {
        Self::new(self.re - &other.re, self.im - &other.im)
    }
}

impl<S: Real> Mul<&Complex<S>> for Complex<S> {
    type Output = Self;
    fn mul(self, other: &Self) -> Self {
        let re = self.re.clone() * &other.re - self.im.clone() * &other.im;
        let im = self.re * &other.im + self.im * &other.re;
        Self::new(re, im)
    }
}

impl<S: Real> Add for Complex<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self + &other
    }
}

impl<S: Real> Sub for Complex<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self - &other
    }
}

impl<S: Real> Mul for Complex<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self * &other
    }
}

impl<S: Real> Neg for Complex<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}
