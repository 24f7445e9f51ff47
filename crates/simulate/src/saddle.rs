//! Saddle orbits of periodically forced systems of second order, and their unstable manifolds.

use crate::error::SimulateError;
use crate::integrator::real::Doubles;
use crate::integrator::{Settings, Tick};
use crate::linear::monodromy;
use crate::system::System;
use nalgebra::{DMatrix, DVector};

/// A periodic orbit of saddle type, seen once per period (at t = 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saddle {
    /// Its period.
    pub period: f64,
    /// (x, x') at t = 0.
    pub state: [f64; 2],
    /// The Floquet multipliers: unstable (> 1), stable (in (-1, 1); zero to rounding errors if the
    /// orbit sticks).
    pub multipliers: [f64; 2],
    /// The unstable and the stable direction at t = 0, of length 1 and with positive x.
    pub directions: [[f64; 2]; 2],
}

impl Saddle {
    /// (u, s) with state = saddle + u (unstable direction) + s (stable direction).
    #[must_use]
    pub fn coordinates(&self, state: &[f64]) -> [f64; 2] {
        let difference = [0, 1].map(|k| state.get(k).map_or(f64::NAN, |x| x - self.state[k]));
        self.components(difference)
    }

    /// The components of a vector along the unstable and the stable direction.
    #[must_use]
    pub fn components(&self, vector: [f64; 2]) -> [f64; 2] {
        let [u, s] = self.directions;
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let area = cross(u, s);
        [cross(vector, s) / area, cross(u, vector) / area]
    }

    /// A point of the unstable manifold: the saddle + `amount` (unstable direction), which is
    /// off the manifold by O(amount^2), less after every period.
    #[must_use]
    pub fn unstable(&self, amount: f64) -> [f64; 2] {
        [0, 1].map(|k| self.state[k] + amount * self.directions[0][k])
    }
}

/// The saddle orbit of the period-map of a linearised system with two states, by Newton's method
/// from `guess`, or, where that leads nowhere, from what multiple shooting makes of the guess; to
/// about 1e-15 times the condition.
///
/// `tick` is asked at every step of the integrations whether to go on. Errors:
/// [`SimulateError::Stopped`] then, [`SimulateError::NoSaddle`] without convergence or where the multipliers are not
/// -1 < stable < 1 < unstable.
pub fn saddle(
    system: &System<Doubles>,
    period: f64,
    guess: [f64; 2],
    settings: Settings,
    tick: &Tick<'_>,
) -> Result<Saddle, SimulateError> {
    match newton(system, period, guess, settings, tick) {
        Err(SimulateError::NoSaddle) => {
            let guess = shoot(system, period, guess, settings, tick)?;
            newton(system, period, guess, settings, tick)
        }
        outcome => outcome,
    }
}

fn newton(
    system: &System<Doubles>,
    period: f64,
    guess: [f64; 2],
    settings: Settings,
    tick: &Tick<'_>,
) -> Result<Saddle, SimulateError> {
    let mut state = guess;
    let (mut moved, mut reach) = (f64::INFINITY, None);
    for _ in 0..30 {
        let result = monodromy(system, (&0.0, &period), &state, settings, tick)?;
        let ([[a, b], [c, d]], [x, v]) = (square(&result.matrix)?, pair(&result.end)?);
        // (M - 1) delta = start - end.
        let [p, q] = [state[0] - x, state[1] - v];
        let determinant = (a - 1.0) * (d - 1.0) - b * c;
        let delta = [(p * (d - 1.0) - b * q) / determinant, ((a - 1.0) * q - c * p) / determinant];
        state = [state[0] + delta[0], state[1] + delta[1]];
        let size = delta[0].hypot(delta[1]);
        // Lost: a strongly nonlinear system far out is slow, too.
        let reach = *reach.get_or_insert(10.0 * (guess[0].hypot(guess[1]) + x.hypot(v)));
        if !(size.is_finite() && state[0].hypot(state[1]) <= reach) {
            break;
        }
        // Newton's steps no longer shrink: rounding errors.
        if size < 1e-12 && size >= 0.25 * moved || size == 0.0 {
            return classify(period, state, [[a, b], [c, d]]);
        }
        moved = size;
    }
    Err(SimulateError::NoSaddle)
}

/// Newton's method for the states at 8 equidistant times, all starting from the guess: a strong
/// instability acts over an eighth of the period only. To about 1e-6.
fn shoot(
    system: &System<Doubles>,
    period: f64,
    guess: [f64; 2],
    settings: Settings,
    tick: &Tick<'_>,
) -> Result<[f64; 2], SimulateError> {
    const PARTS: usize = 8;
    let mut states = [guess; PARTS];
    for _ in 0..30 {
        // M_k delta_k - delta_{k+1} = state_{k+1} - end_k.
        let mut matrix = DMatrix::zeros(2 * PARTS, 2 * PARTS);
        let mut right = DVector::zeros(2 * PARTS);
        for (k, state) in states.iter().enumerate() {
            let times = [k, k + 1].map(|k| period * k as f64 / PARTS as f64);
            let ends = (&times[0], &times[1]);
            let result = monodromy(system, ends, state, settings, tick)?;
            let (m, end) = (square(&result.matrix)?, pair(&result.end)?);
            let next = (k + 1) % PARTS;
            for i in 0..2 {
                for j in 0..2 {
                    matrix[(2 * k + i, 2 * k + j)] += m[i][j];
                }
                matrix[(2 * k + i, 2 * next + i)] -= 1.0;
                right[2 * k + i] = states[next][i] - end[i];
            }
        }
        let delta = matrix.lu().solve(&right).ok_or(SimulateError::NoSaddle)?;
        for (k, state) in states.iter_mut().enumerate() {
            *state = [state[0] + delta[2 * k], state[1] + delta[2 * k + 1]];
        }
        let size = delta.amax();
        if size < 1e-6 {
            return Ok(states[0]);
        }
        if size.is_nan() || size >= 1e3 {
            break;
        }
    }
    Err(SimulateError::NoSaddle)
}

fn classify(period: f64, state: [f64; 2], m: [[f64; 2]; 2]) -> Result<Saddle, SimulateError> {
    let [[a, b], [c, d]] = m;
    let (half, determinant) = ((a + d) / 2.0, a * d - b * c);
    let unstable = half + (half * half - determinant).sqrt();
    let stable = determinant / unstable;
    if !(unstable > 1.0 && stable.abs() < 1.0) {
        return Err(SimulateError::NoSaddle);
    }
    let directions = [unstable, stable].map(|multiplier| {
        // The longer of the two rows of M - multiplier gives the kernel.
        let (x, v) = if (a - multiplier).hypot(b) > c.hypot(d - multiplier) {
            (b, multiplier - a)
        } else {
            (multiplier - d, c)
        };
        let length = x.hypot(v).copysign(x);
        [x / length, v / length]
    });
    Ok(Saddle { period, state, multipliers: [unstable, stable], directions })
}

fn pair<T: Clone>(slice: &[T]) -> Result<[T; 2], SimulateError> {
    let given = slice.len();
    <&[T; 2]>::try_from(slice)
        .cloned()
        .map_err(|_| SimulateError::WrongDimension { states: 2, given })
}

fn square(matrix: &[Vec<f64>]) -> Result<[[f64; 2]; 2], SimulateError> {
    let [first, second] = pair(matrix)?;
    Ok([pair(&first)?, pair(&second)?])
}
