//! Borel summation: f(x) = int_0^infinity e^-s B(x s) ds, B(y) = sum c_n y^n/n!, with B continued
//! by its Pade approximants.

use super::estimate::distance;
use super::{Pade, ResummationError};
use rug::Float;
use rug::float::Constant;

/// Halvings of the step before the integral is given up.
const LEVELS: i32 = 9;

/// The coefficients of B(x s) in s.
#[must_use]
pub fn borel_transform(c: &[Float], x: &Float, bits: u32) -> Vec<Float> {
    let mut factor = Float::with_val(bits, 1);
    let term = |(n, c): (usize, &Float)| {
        if n > 0 {
            factor *= Float::with_val(bits, x / n as u64);
        }
        Float::with_val(bits, c * &factor)
    };
    c.iter().enumerate().map(term).collect()
}

/// int_0^infinity e^-s B(s) ds for a Pade approximant B, to about 2^-`accuracy` relative.
///
/// The exp-sinh rule s = exp((pi/2) sinh t) is exponentially convergent for an integrand that is
/// analytic near the positive axis; a zero of the denominator there is met as a change of its
/// sign between nodes.
///
/// # Errors
/// [`ResummationError::PoleOnPath`], [`ResummationError::NotSettled`] after nine halvings.
pub(super) fn laplace(pade: &Pade, accuracy: u32, bits: u32) -> Result<Float, ResummationError> {
    let half_pi = Float::with_val(bits, Constant::Pi) >> 1u32;
    let nats = f64::from(accuracy + 8) * std::f64::consts::LN_2;
    // e^-s < 2^-accuracy above, s < 2^-accuracy below.
    let high = (nats.ln() * std::f64::consts::FRAC_2_PI).asinh() + 0.3;
    let low = -(nats * std::f64::consts::FRAC_2_PI).asinh() - 0.1;
    let mut sum = Float::new(bits);
    let mut last: Option<Float> = None;
    let mut signs: Vec<(f64, bool)> = Vec::new();
    for level in 0..=LEVELS {
        let h = 0.5f64.powi(level + 1);
        let first = (low / h).floor() as i64;
        let end = (high / h).ceil() as i64;
        for k in (first..=end).filter(|k| level == 0 || k % 2 != 0) {
            let t = Float::with_val(bits, k as f64 * h);
            let exponent = Float::with_val(bits, t.sinh_ref()) * &half_pi;
            let s = exponent.exp();
            let slope = Float::with_val(bits, t.cosh_ref()) * &half_pi * &s;
            signs.push((s.to_f64(), pade.denominator_is_negative(&s)));
            let decay = Float::with_val(bits, -&s).exp();
            let value = pade.value(&s).ok_or(ResummationError::PoleOnPath)?;
            sum += value * decay * slope;
        }
        let value = Float::with_val(bits, &sum * h);
        signs.sort_by(|a, b| a.0.total_cmp(&b.0));
        if signs.windows(2).any(|pair| pair[0].1 != pair[1].1) {
            return Err(ResummationError::PoleOnPath);
        }
        if let Some(before) = &last {
            let size = Float::with_val(53, value.abs_ref());
            if level > 2 && distance(&value, before) <= size >> (accuracy / 2) {
                return Ok(value);
            }
        }
        last = Some(value);
    }
    Err(ResummationError::NotSettled)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

    use super::*;

    /// Euler's series sum (-1)^n n! x^n = int e^-s/(1 + x s) ds: e E_1(1) at x = 1 (A073003);
    /// with alternating signs removed there is a pole on the path.
    #[test]
    fn euler() {
        let bits = 300;
        let c = |sign: i32| -> Vec<Float> {
            let term = |n: u32| Float::with_val(bits, Float::factorial(n)) * sign.pow(n);
            (0..21).map(term).collect()
        };
        let one = Float::with_val(bits, 1);
        let sum = |sign: i32| {
            let b = borel_transform(&c(sign), &one, bits);
            laplace(&Pade::new(&b, 10, 10, bits).unwrap(), 200, bits)
        };
        let gompertz =
            Float::parse("0.596347362323194074341078499369279376074177860152548781573485").unwrap();
        let gompertz = Float::with_val(bits, gompertz);
        assert!((sum(-1).unwrap() - gompertz).abs() < 1e-40);
        assert_eq!(sum(1), Err(ResummationError::PoleOnPath));
    }
}
