//! Real exponents: I_{p,q} through the gamma function, J_{p,q} by a certified trapezoidal rule.

use super::fourier::tanh_recurrence;
use crate::quadrature::{Strip, trapezoid};
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

/// I_{p,q} = B((q+1)/2, p/2) for rational p > 0 and even q, 0 for odd q.
///
/// Computed from I_{p,0} = B(1/2, p/2) by I_{p,q} = (q-1)/(p+q-1) I_{p,q-2}.
#[must_use]
pub fn line_integral_real(balls: Balls, p: &Rational, q: u32) -> Option<Ball> {
    if *p <= 0 {
        return None;
    }
    if q % 2 == 1 {
        return Some(balls.zero());
    }
    let half = Rational::from((1, 2));
    let mut value = beta(balls, &half, &Rational::from(p * &half))?;
    for n in (2..=q).step_by(2) {
        let ratio = Rational::from(n - 1) / (p + Rational::from(n - 1));
        value = balls.mul_rational(&value, &ratio);
    }
    Some(value)
}

/// J_{p,q}(w) for rational p > 0 (the integral as in [`super::line_fourier`]).
///
/// C_p(w) = int sech^p cos(wz) dz by the trapezoidal rule with a proved error: in the strip
/// |Im z| <= c < pi/2 one has |cosh(x+ic)|^2 = cosh^2 x - sin^2 c >= cos^2 c cosh^2 x, so the
/// integral of |f| on its edges is at most cosh(wc) cos^-p c I_{p,0}. The powers of tanh follow by
/// the three-term recurrence. Cost: about bits^2/p elementary functions.
#[must_use]
pub fn line_fourier_real(balls: Balls, p: &Rational, q: u32, w: &Ball) -> Option<Ball> {
    if *p <= 0 || !w.is_finite() {
        return None;
    }
    let half_width = Rational::from(1);
    let power = |x: &Ball, p: &Rational| Some(balls.exp(&balls.mul_rational(&balls.ln(x)?, p)));
    let edge = balls.cos(&balls.from_rational(&half_width));
    let growth = balls.cosh(&balls.mul_rational(w, &half_width));
    let size = balls.mul(&growth, &line_integral_real(balls, p, 0)?);
    let strip = Strip {
        edge_integral: balls.div(&size, &power(&edge, p)?)?,
        half_width,
        // sech^p z <= 2^p e^{-p|z|}.
        decay: p.clone(),
        amplitude: power(&balls.from_i64(2), p)?,
    };
    let c_p = trapezoid(balls, &strip, |balls, z| {
        let sech_power = balls.exp(&balls.neg(&balls.mul_rational(&balls.ln(&balls.cosh(z))?, p)));
        Some(balls.mul(&sech_power, &balls.cos(&balls.mul(w, z))))
    })?;
    tanh_recurrence(balls, p, q, w, c_p)
}
