//! The same integrals in f64.

use std::f64::consts::{FRAC_PI_2, PI};

/// pi/2 - FRAC_PI_2, the second word of pi/2 in double-double.
pub(crate) const FRAC_PI_2_LOW: f64 = 6.123_233_995_736_766e-17;

/// pi w/2 as the unevaluated sum of two doubles (a two-product and the second word of pi/2).
pub(crate) fn half_pi_times(w: f64) -> (f64, f64) {
    let high = w * FRAC_PI_2;
    let low = w.mul_add(FRAC_PI_2, -high) + w * FRAC_PI_2_LOW;
    (high, low)
}

/// sech(pi w/2), relative error at most a few 1e-16 for every w (0 where it underflows).
///
/// The exponential of a rounded argument z has the relative error z eps, 1e-13 at z = 700; with
/// z = zh + zl it is e^{-zh} (1 - zl).
#[must_use]
pub fn sech_half_pi(w: f64) -> f64 {
    let (high, low) = half_pi_times(w.abs());
    if high > 750.0 {
        return 0.0;
    }
    // Two halves of the exponential: the first does not underflow where the product is subnormal.
    let half = (-high / 2.0).exp();
    2.0 * half * (1.0 - low) / (1.0 + (-2.0 * high).exp()) * half
}

/// I_{p,q} for real p > 0 given I_{p,0} where p is no integer; integer p needs no seed.
///
/// `None` for p <= 0 or p not an integer. Only products of positive numbers: the relative error
/// is below (p + q) eps.
#[must_use]
pub fn integral_f64(p: u32, q: u32) -> Option<f64> {
    if p == 0 {
        return None;
    }
    if q % 2 == 1 {
        return Some(0.0);
    }
    let start = if p.is_multiple_of(2) { 2 } else { 1 };
    let mut value = if start == 1 { PI } else { 2.0 };
    for n in (start..p).step_by(2) {
        value *= f64::from(n) / (f64::from(n) + 1.0);
    }
    for n in (2..=q).step_by(2) {
        value *= (f64::from(n) - 1.0) / (f64::from(p) + f64::from(n) - 1.0);
    }
    Some(value)
}

/// J_{p,q}(w) for integer p >= 1 in f64, by the three-term recurrence; `None` for p = 0 or a w
/// that is not finite.
///
/// The expansion of tanh^2 = 1 - sech^2 loses every digit at q = 100; the recurrence keeps an
/// absolute error of a few eps times the largest |J_{p,j}|, j <= q.
#[must_use]
pub fn line_fourier_f64(p: u32, q: u32, w: f64) -> Option<f64> {
    if p == 0 || !w.is_finite() {
        return None;
    }
    let start = if p.is_multiple_of(2) { 2 } else { 1 };
    let mut value = if start == 1 { PI * sech_half_pi(w) } else { second_kernel(w) };
    for n in (start..p).step_by(2) {
        let n = f64::from(n);
        value *= (n * n + w * w) / (n * (n + 1.0));
    }
    let (mut before, p) = (0.0, f64::from(p));
    for j in 1..=q {
        let j = f64::from(j);
        let next = (w * value - (j - 1.0) * before) / (p + j - 1.0);
        before = std::mem::replace(&mut value, next);
    }
    Some(if (q / 2) % 2 == 1 { -value } else { value })
}

/// pi w / sinh(pi w/2).
fn second_kernel(w: f64) -> f64 {
    let (high, low) = half_pi_times(w.abs());
    if high < 1.0 {
        // sinh has a relative error of a few eps here, and x/sinh x is 1 at 0.
        return if high == 0.0 { 2.0 } else { 2.0 * high / high.sinh() };
    }
    if high > 760.0 {
        return 0.0;
    }
    let half = (-high / 2.0).exp();
    4.0 * high * half * (1.0 - low) / (-(-2.0 * high).exp_m1()) * half
}
