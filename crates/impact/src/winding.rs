//! Zeros of G in a disc, counted by the winding number of G along the circle.
//!
//! From a point w_0 of the circle, with |G| <= M on the disc of radius R around it, Cauchy's bounds
//! of the Taylor coefficients give |G(w) - G(w_0)| <= |G'(w_0)| h + M (h/R)^2/(1 - h/R) for
//! |w - w_0| <= h < R. A step h with this sum below |G(w_0)| keeps G in a disc without zero, so the
//! argument changes by its principal value: the sum of the steps is exact. G is real on the real
//! axis, half the circle suffices. Certified for balls; doubles ignore their rounding errors.

use crate::characteristic::Characteristic;
use crate::complex::Complex;
use crate::real::Real;

/// Steps before giving up: a zero on the circle, or too near it for the precision.
const STEPS: usize = 20_000;
/// Part of |G(w_0)| that a step may use.
const SAFETY: f64 = 0.9;

/// The number of zeros in |w| < radius, and what it took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ZeroCount {
    /// Zeros with multiplicity.
    pub zeros: u32,
    /// Evaluations of G.
    pub evaluations: u32,
}

/// Counts the zeros of G in |w| < radius; `None` where a zero on or near the circle leaves the
/// count undecided.
///
/// For balls the count is proved: radius and angles are exact, every bound is rounded up.
pub fn zero_count<S: Real>(g: &Characteristic<S>, radius: f64) -> Option<ZeroCount> {
    let unit = g.period();
    let size = unit.number(radius);
    // The angle is a multiple of pi, exactly representable as a part of it.
    let mut part = 0.0_f64;
    let (mut value, mut slope) = g.value_and_slope(&Complex::real(size.clone()));
    let mut centre = Complex::new(radius, 0.0);
    let mut angle = 0.0_f64;
    for evaluations in 1..=STEPS {
        let here = value.to_f64();
        let floor = value.magnitude_below();
        if !here.is_finite() || floor <= 1e-12 * radius.min(1.0) * slope.magnitude_above() {
            return None;
        }
        if part >= 1.0 {
            let turns = angle / std::f64::consts::PI;
            let zeros = turns.round();
            let whole = (turns - zeros).abs() < 1e-3 && zeros >= 0.0;
            let evaluations = u32::try_from(evaluations).unwrap_or(u32::MAX);
            return whole.then_some(ZeroCount { zeros: zeros as u32, evaluations });
        }
        let step = safe_step(g, &centre, floor, slope.magnitude_above());
        // The centre is known in doubles to a few ulp of the radius.
        let next = (part + step * (1.0 - 1e-9) / (radius * std::f64::consts::PI)).min(1.0);
        if next <= part {
            return None;
        }
        part = next;
        let w = if part >= 1.0 {
            Complex::real(-size.clone())
        } else {
            let (sin, cos) = (unit.pi() * unit.number(part)).sin_cos();
            Complex::new(cos, sin).scaled(&size)
        };
        centre = w.to_f64();
        (value, slope) = g.value_and_slope(&w);
        let there = value.to_f64();
        let turn = there * &here.conjugate();
        angle += turn.im.atan2(turn.re);
    }
    None
}

/// A length h with |G'| h + M (h/R)^2/(1 - h/R) <= 0.9 |G|, h <= R/2.
fn safe_step<S: Real>(g: &Characteristic<S>, w: &Complex<f64>, floor: f64, slope: f64) -> f64 {
    let mut reach = g.scale(w);
    loop {
        // The centre is rounded to doubles.
        let bound = g.bound(w, reach * (1.0 + 1e-12) + 1e-14 * w.modulus());
        let budget = SAFETY * floor / 2.0;
        let step = (budget / slope).min(reach * (budget / (2.0 * bound)).sqrt()).min(reach / 2.0);
        if bound.is_finite() || reach < 1e-12 {
            return step;
        }
        reach /= 2.0;
    }
}
