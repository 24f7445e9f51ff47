//! The gamma and the beta function of rational numbers.

use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

/// Gamma(x) for rational x > 0; `None` otherwise or where it overflows.
///
/// MPFR rounds Gamma correctly at the rounded argument x(1 + d), |d| <= 2^-p. From
/// ln x - 1/x < psi(x) < ln x - 1/(2x) the change is at most |Gamma| (x |ln x| + 1) |d| to first
/// order; twice that with 32 guard bits covers the rest.
#[must_use]
pub fn gamma(balls: Balls, x: &Rational) -> Option<Ball> {
    if *x <= 0 {
        return None;
    }
    let bits = balls.bits().saturating_add(32);
    let argument = Float::with_val(bits, x);
    let value = Float::with_val(bits, argument.gamma_ref());
    if !value.is_finite() || value.is_zero() {
        return None;
    }
    let weight = Float::with_val(53, argument.ln_ref()).abs() * &argument + 2u32;
    let error = (weight * Float::with_val(53, value.abs_ref())) >> (bits - 2);
    Some(balls.from_parts(&value, &error))
}

/// The beta function Gamma(x) Gamma(y) / Gamma(x+y) of positive rational numbers.
#[must_use]
pub fn beta(balls: Balls, x: &Rational, y: &Rational) -> Option<Ball> {
    let product = balls.mul(&gamma(balls, x)?, &gamma(balls, y)?);
    balls.div(&product, &gamma(balls, &Rational::from(x + y))?)
}
