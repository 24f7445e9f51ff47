//! The radii polynomial: from the bounds to a radius.
//!
//! T(c) = c - A F(c) maps the closed ball of radius r about cbar to itself if
//! Y0 + (Z0 + Z1) r + Z2 r^2/2 <= r, and contracts on it if Z0 + Z1 + Z2 r < 1. A is injective
//! (Z0 < 1 on its modes, a diagonal without zeros beyond), so that fixed points of T are the zeros
//! of F: there is exactly one. Every inequality is checked with the left side rounded up.

use crate::Failure;
use crate::bounds::Contraction;
use crate::upward::Up;
use rug::Float;
use rug::float::Round;
use serde::Serialize;

/// The bounds of the contraction test.
#[derive(Clone, Debug, Serialize)]
pub struct Bounds {
    /// Y0 >= |A F(cbar)|: how far one Newton step goes.
    #[serde(serialize_with = "crate::write::float")]
    pub y0: Float,
    /// Z0 >= |1 - A D| on the modes of the inverse.
    pub z0: f64,
    /// Z1: the same for all that the inverse neglects.
    pub z1: f64,
    /// Z2: the Lipschitz constant of A DF on the ball of the radius.
    pub z2: f64,
}

/// What the bounds prove.
#[derive(Clone, Debug)]
pub(crate) struct Radii {
    pub(crate) radius: Float,
    pub(crate) unique_within: Float,
    pub(crate) bounds: Bounds,
}

/// Existence is first looked for within this many times the root of the linear inequality.
const ROOM: u32 = 4;
/// The largest ball of uniqueness that is looked for.
const LARGEST: f64 = 1e9;
/// Shrinkings of the ball of uniqueness.
const MOST_TRIES: usize = 80;

impl Bounds {
    /// The least radius, up to a factor 1 + 2^-20, that the polynomial with these coefficients
    /// proves, checked; nothing where it proves none.
    ///
    /// ```
    /// use lindstedt_orbit::Bounds;
    /// use rug::Float;
    /// let mut bounds = Bounds { y0: Float::with_val(53, 1e-9), z0: 0.1, z1: 0.4, z2: 10.0 };
    /// assert!(bounds.radius().is_some_and(|r| r > 2e-9 && r < 2.001e-9));
    /// bounds.z1 = 0.9;
    /// assert!(bounds.radius().is_none());
    /// ```
    #[must_use]
    pub fn radius(&self) -> Option<Float> {
        let total = Up(self.z0) + Up(self.z1);
        let left = 1.0 - total.0;
        if left.is_nan() || left <= 0.0 || !self.y0.is_finite() || self.y0.is_sign_negative() {
            return None;
        }
        // 2 Z2 Y0/(1 - Z0 - Z1)^2, a number that may be far below the least double.
        let load = Float::with_val(53, &self.y0 * self.z2) * 2u32 / left / left;
        let root = (1.0 - load.to_f64()).sqrt();
        let radius = Float::with_val(53, &self.y0 * (1.0 + 1.0 / f64::from(1 << 20)));
        let radius = radius * 2u32 / (left * (1.0 + root));
        (root.is_finite() && self.maps_into(total, &radius) && self.contracts(total, &radius))
            .then_some(radius)
    }

    /// Y0 + (Z0 + Z1) r + Z2 r^2/2 <= r, the left side rounded up.
    fn maps_into(&self, total: Up, radius: &Float) -> bool {
        let up = |x: Float, y: &Float| Float::with_val_round(53, &x * y, Round::Up).0;
        let linear = up(Float::with_val(53, total.0), radius);
        let square = up(up(Float::with_val(53, self.z2), radius), radius) / 2u32;
        let sum = Float::with_val_round(53, &self.y0 + &linear, Round::Up).0;
        Float::with_val_round(53, &sum + &square, Round::Up).0 <= *radius
    }

    /// Z0 + Z1 + Z2 r < 1, the left side rounded up.
    fn contracts(&self, total: Up, radius: &Float) -> bool {
        let slope = Float::with_val_round(53, radius * self.z2, Round::Up).0;
        Float::with_val_round(53, &slope + total.0, Round::Up).0 < 1
    }
}

/// The radius and the ball of uniqueness from the bounds and Z2(r).
pub(crate) fn decide(
    contraction: &Contraction,
    modes: usize,
    z2: impl Fn(&Float) -> Up,
) -> Result<Radii, Failure> {
    let (z0, z1) = (contraction.z0.0, contraction.z1.0);
    let total = contraction.z0 + contraction.z1;
    let left = 1.0 - total.0;
    if left.is_nan() || left <= 0.0 {
        return Err(Failure::NoContraction { modes, z0, z1 });
    }
    let room = Float::with_val(53, &contraction.y0 * ROOM) / left;
    let bounds = Bounds { y0: contraction.y0.clone(), z0, z1, z2: z2(&room).0 };
    let refused = || Failure::Residual { modes, y0: bounds.y0.to_f64(), z2: bounds.z2 };
    let radius = bounds.radius().filter(|r| *r <= room).ok_or_else(refused)?;
    // Z2 grows with the ball: the largest one on which T still contracts.
    let mut unique_within = Float::with_val(53, left / bounds.z2.max(left / LARGEST));
    for _ in 0..MOST_TRIES {
        let wide = Bounds { z2: z2(&unique_within).0, ..bounds.clone() };
        if wide.contracts(total, &unique_within) {
            break;
        }
        // Sines and exponentials of a large ball have no bound in doubles.
        unique_within *= if wide.z2.is_finite() { 0.8 } else { 0.1 };
    }
    let wide = Bounds { z2: z2(&unique_within).0, ..bounds.clone() };
    if !wide.contracts(total, &unique_within) || unique_within < radius {
        unique_within = radius.clone();
    }
    Ok(Radii { radius, unique_within, bounds })
}
