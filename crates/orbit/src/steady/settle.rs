//! Where a state of a vector field goes.

use super::System;
use super::krawczyk::newton;
use lindstedt_algebra::Stop;

/// What became of a start state.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// It came to a steady state.
    Steady(Vec<f64>),
    /// It still moves, here; near a cycle of the vector field it would for ever.
    Moving(Vec<f64>),
    /// It left every bound.
    Away,
}

/// Relative error of a step.
const TOLERANCE: f64 = 1e-9;
const MOST_STEPS: usize = 1_000_000;

/// Integrates w' = G(w) in doubles until time `end` (Bogacki and Shampine's pair of orders 3 and 2), or until Newton's
/// method finds a steady state so near that the rest of the way is decided; `reach` is the unit of w.
#[must_use]
pub fn settle(system: &System, start: &[f64], reach: f64, end: f64, stop: &Stop) -> Fate {
    let size = |w: &[f64]| w.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let (mut w, mut time) = (start.to_vec(), 0.0);
    let mut step = 1e-3 * reach / (size(&system.values(&w)) + 1e-12 * reach);
    for count in 0..MOST_STEPS {
        if time >= end || stop.asked() {
            break;
        }
        let k1 = system.values(&w);
        if size(&w) > 1e3 * reach {
            return Fate::Away;
        }
        if count % 16 == 0
            && let Some(state) = newton(system, &w)
            && distance(&state, &w) < 1e-6 * reach
        {
            return Fate::Steady(state);
        }
        step = step.min(end - time).max(1e-12 * end);
        let at = |parts: &[(&[f64], f64)]| -> Vec<f64> {
            (0..w.len())
                .map(|i| w[i] + step * parts.iter().map(|(k, c)| c * k[i]).sum::<f64>())
                .collect()
        };
        let k2 = system.values(&at(&[(&k1, 0.5)]));
        let k3 = system.values(&at(&[(&k2, 0.75)]));
        let next = at(&[(&k1, 2.0 / 9.0), (&k2, 1.0 / 3.0), (&k3, 4.0 / 9.0)]);
        let k4 = system.values(&next);
        let lower = at(&[(&k1, 7.0 / 24.0), (&k2, 0.25), (&k3, 1.0 / 3.0), (&k4, 0.125)]);
        let error = distance(&next, &lower) / (TOLERANCE * reach);
        if error <= 1.0 {
            time += step;
            w = next;
        }
        step *= (0.9 / error.max(1e-9).cbrt()).clamp(0.2, 4.0);
        if !error.is_finite() {
            return Fate::Away;
        }
    }
    Fate::Moving(w)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
