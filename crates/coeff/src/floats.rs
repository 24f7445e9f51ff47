//! Estimated real numbers: floating-point contexts without error bounds.
//!
//! [`Doubles`] and [`Floats`] round every operation (to nearest) and keep no account of it: their
//! numbers are *estimated*, and whoever prints them says how the error was found. Tests for zero
//! are exact. The laws of a ring hold up to rounding only.

use lindstedt_algebra::{Elementary, RationalAlgebra, Ring};
use rug::ops::{NegAssign, Pow};
use rug::{Float, Rational};

/// What numerical algebras need of real numbers.
pub trait Reals: RationalAlgebra {
    /// The precision in bits.
    fn bits(&self) -> u32;
    /// The nearest number.
    fn from_float(&self, x: &Float) -> Self::Element;
    /// The number at its own precision.
    fn to_float(&self, a: &Self::Element) -> Float;
    /// Whether a is neither infinite nor NaN.
    fn is_finite(&self, a: &Self::Element) -> bool;
    /// Whether a > 0.
    fn is_positive(&self, a: &Self::Element) -> bool;
    /// |a|.
    fn abs(&self, a: &Self::Element) -> Self::Element;
    /// ln |a|.
    fn log_abs(&self, a: &Self::Element) -> Self::Element;
    /// The function at a; NaN outside its domain.
    fn elementary(&self, function: &Elementary, a: &Self::Element) -> Self::Element;
    /// sum <- sum + a b.
    fn accumulate(&self, sum: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// sum_i a_i b_i over the shorter list.
    fn dot(&self, a: &[Self::Element], b: &[Self::Element]) -> Self::Element {
        let mut sum = self.zero();
        for (x, y) in a.iter().zip(b) {
            self.accumulate(&mut sum, x, y);
        }
        sum
    }
}

/// Double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Doubles;

/// Floating-point numbers with `bits` bits.
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Ring};
/// use lindstedt_coeff::floats::Floats;
/// use rug::Rational;
///
/// let floats = Floats::new(100);
/// let third = floats.rational(&Rational::from((1, 3)));
/// assert_eq!(floats.scale(&third, &Rational::from(3)), floats.one());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Floats {
    bits: u32,
}

impl Floats {
    /// The context with `bits` bits, at least 2 and at most 2^26.
    #[must_use]
    pub fn new(bits: u32) -> Self {
        Self { bits: bits.clamp(2, 1 << 26) }
    }
}

impl Ring for Doubles {
    type Element = f64;

    fn zero(&self) -> f64 {
        0.0
    }
    fn one(&self) -> f64 {
        1.0
    }
    fn is_zero(&self, a: &f64) -> bool {
        *a == 0.0
    }
    fn add_assign(&self, a: &mut f64, b: &f64) {
        *a += b;
    }
    fn neg(&self, a: &f64) -> f64 {
        -a
    }
    fn mul(&self, a: &f64, b: &f64) -> f64 {
        a * b
    }
}

impl RationalAlgebra for Doubles {
    /// Rounded to nearest (a conversion of GMP truncates).
    fn rational(&self, q: &Rational) -> f64 {
        Float::with_val(53, q).to_f64()
    }
    fn scale(&self, a: &f64, q: &Rational) -> f64 {
        // Small numerators and denominators are exact: one or two roundings.
        match (q.numer().to_i32(), q.denom().to_i32()) {
            (Some(n), Some(1)) => a * f64::from(n),
            (Some(n), Some(d)) => a * f64::from(n) / f64::from(d),
            _ => a * self.rational(q),
        }
    }
    fn reciprocal(&self, a: &f64) -> Option<f64> {
        (*a != 0.0).then(|| 1.0 / a)
    }
    /// The binary fraction that the number is.
    fn as_rational(&self, a: &f64) -> Option<Rational> {
        Rational::from_f64(*a)
    }
}

impl Reals for Doubles {
    fn bits(&self) -> u32 {
        f64::MANTISSA_DIGITS
    }
    fn from_float(&self, x: &Float) -> f64 {
        x.to_f64()
    }
    fn to_float(&self, a: &f64) -> Float {
        Float::with_val(f64::MANTISSA_DIGITS, *a)
    }
    fn is_finite(&self, a: &f64) -> bool {
        a.is_finite()
    }
    fn is_positive(&self, a: &f64) -> bool {
        *a > 0.0
    }
    fn abs(&self, a: &f64) -> f64 {
        a.abs()
    }
    fn log_abs(&self, a: &f64) -> f64 {
        a.abs().ln()
    }
    fn elementary(&self, function: &Elementary, a: &f64) -> f64 {
        match function {
            Elementary::Exp => a.exp(),
            Elementary::Sin => a.sin(),
            Elementary::Cos => a.cos(),
            Elementary::Power(q) => match q.numer().to_i32().filter(|_| q.is_integer()) {
                Some(n) => a.powi(n),
                None => a.powf(self.rational(q)),
            },
            _ => f64::NAN,
        }
    }
    fn accumulate(&self, sum: &mut f64, a: &f64, b: &f64) {
        *sum += a * b;
    }
}

impl Ring for Floats {
    type Element = Float;

    fn zero(&self) -> Float {
        Float::new(self.bits)
    }
    fn one(&self) -> Float {
        Float::with_val(self.bits, 1)
    }
    fn is_zero(&self, a: &Float) -> bool {
        a.is_zero()
    }
    fn add_assign(&self, a: &mut Float, b: &Float) {
        *a += b;
    }
    fn neg(&self, a: &Float) -> Float {
        let mut negative = a.clone();
        negative.neg_assign();
        negative
    }
    fn mul(&self, a: &Float, b: &Float) -> Float {
        Float::with_val(self.bits, a * b)
    }
}

impl RationalAlgebra for Floats {
    fn rational(&self, q: &Rational) -> Float {
        Float::with_val(self.bits, q)
    }
    fn scale(&self, a: &Float, q: &Rational) -> Float {
        match (q.numer().to_i32(), q.denom().to_i32()) {
            (Some(n), Some(1)) => Float::with_val(self.bits, a * n),
            (Some(n), Some(d)) => Float::with_val(self.bits, a * n) / d,
            _ => Float::with_val(self.bits, a * q),
        }
    }
    fn reciprocal(&self, a: &Float) -> Option<Float> {
        (!a.is_zero()).then(|| Float::with_val(self.bits, a.recip_ref()))
    }
    /// The binary fraction that the number is.
    fn as_rational(&self, a: &Float) -> Option<Rational> {
        a.to_rational()
    }
}

impl Reals for Floats {
    fn bits(&self) -> u32 {
        self.bits
    }
    fn from_float(&self, x: &Float) -> Float {
        Float::with_val(self.bits, x)
    }
    fn to_float(&self, a: &Float) -> Float {
        a.clone()
    }
    fn is_finite(&self, a: &Float) -> bool {
        a.is_finite()
    }
    fn is_positive(&self, a: &Float) -> bool {
        *a > 0
    }
    fn abs(&self, a: &Float) -> Float {
        Float::with_val(self.bits, a.abs_ref())
    }
    fn log_abs(&self, a: &Float) -> Float {
        Float::with_val(self.bits, a.abs_ref()).ln()
    }
    fn elementary(&self, function: &Elementary, a: &Float) -> Float {
        let a = a.clone();
        match function {
            Elementary::Exp => a.exp(),
            Elementary::Sin => a.sin(),
            Elementary::Cos => a.cos(),
            Elementary::Power(q) if q.is_integer() => a.pow(q.numer()),
            // A half-integer power has an exact exponent; others are rounded once more.
            Elementary::Power(q) => a.pow(&Float::with_val(self.bits + 32, q)),
            _ => Float::with_val(self.bits, rug::float::Special::Nan),
        }
    }
    fn accumulate(&self, sum: &mut Float, a: &Float, b: &Float) {
        *sum += a * b;
    }
    /// One temporary for all products: half the time of fused multiply-adds.
    fn dot(&self, a: &[Float], b: &[Float]) -> Float {
        let mut sum = self.zero();
        let mut product = self.zero();
        for (x, y) in a.iter().zip(b) {
            rug::Assign::assign(&mut product, x * y);
            sum += &product;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_contexts_agree() {
        let floats = Floats::new(80);
        let q = Rational::from((-7, 11));
        let functions = [
            Elementary::Exp,
            Elementary::Sin,
            Elementary::Cos,
            Elementary::Power(Rational::from(-3)),
            Elementary::Power(Rational::from((2, 3))),
        ];
        for function in functions {
            let x = Rational::from((9, 7));
            let double = Doubles.elementary(&function, &Doubles.scale(&1.0, &x));
            let wide = floats.elementary(&function, &floats.rational(&x));
            assert!((floats.to_float(&wide).to_f64() - double).abs() < 1e-15, "{function:?}");
        }
        let (a, b) = (Doubles.rational(&q), floats.rational(&q));
        assert!((Doubles.log_abs(&a) - floats.log_abs(&b).to_f64()).abs() < 1e-15);
        assert_eq!(Doubles.reciprocal(&0.0), None);
        assert_eq!(floats.reciprocal(&floats.zero()), None);
        let list = [floats.one(), b.clone()];
        let expected = floats.add(&floats.one(), &floats.mul(&b, &b));
        let difference = floats.sub(&floats.dot(&list, &list), &expected);
        assert!(floats.abs(&difference) < 1e-23);
        assert!(Doubles.elementary(&Elementary::Power(q), &-1.0).is_nan());
    }
}
