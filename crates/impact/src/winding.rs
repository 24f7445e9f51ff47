//! Zeros of G in a disc, counted by the winding number of G along the circle.
//!
//! From a point w_0 of the circle, with |G| <= M on the disc of radius R around it, Cauchy's bounds
//! of the Taylor coefficients give |G(w) - G(w_0)| <= |G'(w_0)| h + M (h/R)^2/(1 - h/R) for
//! |w - w_0| <= h < R. A step h with this sum below |G(w_0)| keeps G in a disc without zero, so the
//! argument changes by its principal value: the sum of the steps is exact. G is real on the real
//! axis, half the circle suffices. Certified for balls; doubles ignore their rounding errors.

use crate::characteristic::Characteristic;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

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
/// For balls the count is proved: radius and angles are exact, every bound is rounded up. Doubles
/// walk ahead of them: where these run out of steps, more digits would not shorten the way.
pub fn zero_count<S: Real>(g: &Characteristic<S>, radius: f64) -> Option<ZeroCount> {
    if g.period().precision() > f64::MANTISSA_DIGITS
        && walk(&g.to_f64(), radius) == Walk::OutOfSteps
    {
        return None;
    }
    match walk(g, radius) {
        Walk::Around(count) => Some(count),
        Walk::Undecided | Walk::OutOfSteps | Walk::OutOfRange => None,
    }
}

/// How the way around the circle ended.
#[doc(hidden)]
#[derive(PartialEq, Eq)]
pub enum Walk {
    /// So many zeros.
    Around(ZeroCount),
    /// A zero on or near the circle.
    Undecided,
    /// Steps are too short.
    OutOfSteps,
    /// |G| leaves the range of doubles.
    OutOfRange,
}

/// The way around the circle.
#[doc(hidden)]
pub fn walk<S: Real>(g: &Characteristic<S>, radius: f64) -> Walk {
    let unit = g.period();
    let size = unit.number(radius);
    // The angle is a multiple of pi, exactly representable as a part of it: counted from w = radius
    // on the first quarter, from w = -radius on the second. Steps are short near a zero, flips and
    // tangent bifurcations lie on the axis, and near 0 a double resolves the shortest.
    let (mut part, mut left) = (0.0_f64, 1.0_f64);
    // Doubles do not know their error; balls do, and are cut where they have half their digits.
    let precision = unit.precision();
    let least = match precision > f64::MANTISSA_DIGITS {
        true => 0.5_f64.powi(i32::try_from(precision / 2).unwrap_or(i32::MAX)),
        false => 1e-12,
    };
    // Where |G| leaves the range of doubles the walk cannot go on. It is largest far from w = R,
    // where the walk starts: looked at first, not after thousands of steps.
    let zero = unit.integer(0);
    for far in [Complex::new(zero, size.clone()), Complex::real(-size.clone())] {
        if !g.value_and_slope(&far).0.to_f64().is_finite() {
            return Walk::OutOfRange;
        }
        if !g.goes_on() {
            return Walk::Undecided;
        }
    }
    let (mut value, mut slope) = g.value_and_slope(&Complex::real(size.clone()));
    let mut centre = Complex::new(radius, 0.0);
    let mut angle = 0.0_f64;
    for evaluations in 1..=STEPS {
        if !g.goes_on() {
            return Walk::Undecided;
        }
        let here = value.to_f64();
        let floor = value.magnitude_below();
        if !here.is_finite() || floor <= least * radius.min(1.0) * slope.magnitude_above() {
            return Walk::Undecided;
        }
        if left <= 0.0 {
            let turns = angle / std::f64::consts::PI;
            let zeros = turns.round();
            let whole = (turns - zeros).abs() < 1e-3 && zeros >= 0.0;
            let evaluations = u32::try_from(evaluations).unwrap_or(u32::MAX);
            return if whole {
                Walk::Around(ZeroCount { zeros: zeros as u32, evaluations })
            } else {
                Walk::Undecided
            };
        }
        let step = safe_step(g, &centre, floor, slope.magnitude_above());
        // The centre is known in doubles to a few ulp of the radius.
        let ahead = step * (1.0 - 1e-9) / (radius * std::f64::consts::PI);
        let before = (part, left);
        if part < 0.5 {
            part = (part + ahead).min(0.5);
            left = 1.0 - part;
        } else {
            left = (left - ahead).max(0.0);
        }
        if before == (part, left) {
            return Walk::Undecided;
        }
        let w = if left <= 0.0 {
            Complex::real(-size.clone())
        } else if part < 0.5 {
            let (sin, cos) = (unit.pi() * unit.number(part)).sin_cos();
            Complex::new(cos, sin).scaled(&size)
        } else {
            let (sin, cos) = (unit.pi() * unit.number(left)).sin_cos();
            Complex::new(-cos, sin).scaled(&size)
        };
        centre = w.to_f64();
        (value, slope) = g.value_and_slope(&w);
        // Of unit size, lest the product leave the range of doubles.
        let there = value.to_f64();
        let there = there.scaled(&there.re.hypot(there.im).recip());
        let turn = there * &here.conjugate();
        angle += turn.im.atan2(turn.re);
    }
    Walk::OutOfSteps
}

/// A length h with |G'| h + M (h/R)^2/(1 - h/R) <= 0.9 |G|, h <= R/2.
#[doc(hidden)]
pub fn safe_step<S: Real>(g: &Characteristic<S>, w: &Complex<f64>, floor: f64, slope: f64) -> f64 {
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
