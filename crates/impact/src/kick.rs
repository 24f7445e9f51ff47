//! The return map of the delayed impact system for B != 0: only piecewise linear.
//!
//! Impact l comes delta_l = -y_l(T)/v late. Between an impact and its delayed image the velocity
//! difference x' - x'_T is of order one, and B turns it into a kick of the velocity:
//!
//! ```text
//! y_(l+1)(0)  = -R_r y_l(T)
//! y_(l+1)'(0) = sigma y_l(T) - R_r y_l'(T) + chi B (1+R_r) v (delta_l - delta_(l-1))
//! chi = -R_r if delta_l > delta_(l-1) (kick before the impact), 1 otherwise (after it)
//! ```
//!
//! Such a map has no Floquet multipliers; its growth rate over many flights decides.

use crate::error::ImpactError;
use crate::map::Verdict;
use crate::orbit::Orbit;
use crate::parameters::Parameters;
use nalgebra::{DMatrix, DVector};

/// Half width of the band around 1 in which a growth rate counts as neutral.
const BAND: f64 = 1e-3;

/// Growth per flight of the piecewise linear return map.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// The largest geometric mean of |state_(l+1)|/|state_l| over the starts. Estimated.
    pub rate: f64,
    /// Difference of the rate between the two halves of the run: how settled it is.
    pub spread: f64,
}

impl Growth {
    /// Stable or unstable; neutral within 10^-3 of 1.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match self.rate - 1.0 {
            excess if excess < -BAND => Verdict::Stable,
            excess if excess > BAND => Verdict::Unstable,
            _ => Verdict::Neutral,
        }
    }
}

/// One flight as a matrix: (y, y') at the nodes from (y, y') of the flight before and the start.
struct Flight {
    /// 2 n x 2 n
    memory: DMatrix<f64>,
    /// 2 n x 2, columns for y(0), y'(0)
    start: DMatrix<f64>,
}

/// Iterates the return map over `flights` flights from four starts and measures its growth.
///
/// Flights are Chebyshev polynomials (degree by alpha T), accurate to some 10^-12. Estimated: a
/// finite run; different cones may have different rates, the largest found is returned.
///
/// # Errors
/// [`ImpactError::NoConvergence`] if the linear system of the flight is singular.
pub fn piecewise_growth(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
) -> Result<Growth, ImpactError> {
    let flight = Flight::new(parameters, orbit.period)
        .ok_or(ImpactError::NoConvergence { what: "the flight between two impacts" })?;
    let v = orbit.velocity;
    let mut growth = Growth { rate: 0.0, spread: 0.0 };
    for start in [[1.0, 0.3], [-1.0, -0.3], [0.2, 1.0], [-0.2, -1.0]] {
        let found = flight.growth(parameters, orbit, [start[0] * v, start[1] * v], flights);
        if found.rate > growth.rate {
            growth = found;
        }
    }
    Ok(growth)
}

impl Flight {
    /// y' = v, v' = -(c - B) v - (alpha^2 - A) y - A y_before - B v_before at Chebyshev points.
    fn new(parameters: &Parameters<f64>, period: f64) -> Option<Self> {
        let &Parameters { alpha, damping, displacement_gain: a, velocity_gain: b, .. } = parameters;
        let rate = (alpha * alpha + a.abs()).sqrt() + damping + b.abs();
        let n = 20 + (rate * period) as usize;
        let d = differentiation(n) * (2.0 / period);
        let mut system = DMatrix::zeros(2 * n, 2 * n);
        let mut memory = DMatrix::zeros(2 * n, 2 * n);
        let mut start = DMatrix::zeros(2 * n, 2);
        system.view_mut((0, 0), (n, n)).copy_from(&d);
        system.view_mut((n, n), (n, n)).copy_from(&d);
        for j in 0..n {
            system[(j, n + j)] -= 1.0;
            system[(n + j, j)] += alpha * alpha - a;
            system[(n + j, n + j)] += damping - b;
            memory[(n + j, j)] = -a;
            memory[(n + j, n + j)] = -b;
        }
        // Node 0 is t = 0: the start replaces the equation there.
        for (row, column) in [(0, 0), (n, 1)] {
            system.row_mut(row).fill(0.0);
            memory.row_mut(row).fill(0.0);
            system[(row, row)] = 1.0;
            start[(row, column)] = 1.0;
        }
        let factors = system.lu();
        Some(Self { memory: factors.solve(&memory)?, start: factors.solve(&start)? })
    }

    fn growth(
        &self,
        parameters: &Parameters<f64>,
        orbit: &Orbit<f64>,
        start: [f64; 2],
        flights: usize,
    ) -> Growth {
        let &Parameters { restitution: r, velocity_gain: b, .. } = parameters;
        let n = self.memory.nrows() / 2;
        let v = orbit.velocity;
        let mut state = DVector::zeros(2 * n);
        let mut next = DVector::zeros(2 * n);
        let (mut entry, mut late_before) = (DVector::from_row_slice(&start), 0.0);
        let skip = flights / 4;
        let mut logarithms = [0.0, 0.0];
        for l in 0..flights {
            next.gemv(1.0, &self.memory, &state, 0.0);
            next.gemv(1.0, &self.start, &entry, 1.0);
            std::mem::swap(&mut state, &mut next);
            let (y, y_slope) = (state[n - 1], state[2 * n - 1]);
            let late = -y / v;
            let chi = if late > late_before { -r } else { 1.0 };
            let kick = chi * b * (1.0 + r) * v * (late - late_before);
            entry[0] = -r * y;
            entry[1] = orbit.saltation * y - r * y_slope + kick;
            late_before = late;
            let size = state.amax().max(entry.amax());
            if size == 0.0 || !size.is_finite() {
                return Growth { rate: if size == 0.0 { 0.0 } else { size }, spread: 0.0 };
            }
            state /= size;
            entry /= size;
            late_before /= size;
            if l >= skip {
                logarithms[usize::from(l >= skip + (flights - skip) / 2)] += size.ln();
            }
        }
        let count = (flights - skip).max(2) as f64;
        let rate = ((logarithms[0] + logarithms[1]) / count).exp();
        let halves = logarithms.map(|sum| (2.0 * sum / count).exp());
        Growth { rate, spread: (halves[0] - halves[1]).abs() }
    }
}

/// The derivative of the interpolating polynomial at the Chebyshev points -cos(pi j/(n-1)).
fn differentiation(n: usize) -> DMatrix<f64> {
    let last = (n - 1) as f64;
    // x_i - x_j = 2 sin((t_i + t_j)/2) sin((t_i - t_j)/2), x = -cos t
    let gap = |i: usize, j: usize| {
        let half = std::f64::consts::PI / (2.0 * last);
        2.0 * ((i + j) as f64 * half).sin() * ((i as f64 - j as f64) * half).sin()
    };
    let weight = |j: usize| {
        let sign = if j.is_multiple_of(2) { 1.0 } else { -1.0 };
        if j == 0 || j == n - 1 { 0.5 * sign } else { sign }
    };
    let mut d = DMatrix::zeros(n, n);
    for i in 0..n {
        let mut diagonal = 0.0;
        for j in 0..n {
            if i != j {
                d[(i, j)] = weight(j) / weight(i) / gap(i, j);
                diagonal -= d[(i, j)];
            }
        }
        d[(i, i)] = diagonal;
    }
    d
}
