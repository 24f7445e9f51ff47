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

use crate::characteristic::check;
use crate::error::ImpactError;
use crate::map::Verdict;
use crate::orbit::Orbit;
use crate::parameters::Parameters;
use lindstedt_algebra::Stop;
use nalgebra::{DMatrix, DVector};

/// Within this of 1 a rate is looked at with finer flights.
const BAND: f64 = 1e-3;
/// By how many points of a flight the rate is tried again: not by as many twice, so that an error which
/// alternates with the parity of the number or is of slow decay shows in one of them.
const MORE_POINTS: [usize; 2] = [5, 11];
/// Chebyshev points of a flight at most.
const LARGEST: f64 = 500.0;

/// Growth per flight of the piecewise linear return map.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// rho, the largest weighted geometric mean of |state_(l+1)|/|state_l| over the starts. Estimated.
    pub rate: f64,
    /// Difference of the rate between the two halves of the run: how settled it is.
    pub spread: f64,
    /// Of `rate`: what the run has not settled, what more points of the flight change, and rounding.
    /// Estimated, never 0. See [`piecewise_growth`].
    pub error: f64,
}

impl Growth {
    /// Stable or unstable; neutral within the error of 1.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match self.rate - 1.0 {
            excess if excess < -self.error => Verdict::Stable,
            excess if excess > self.error => Verdict::Unstable,
            _ => Verdict::Neutral,
        }
    }
}

/// The piecewise linear return map with its state: one perturbed flight after the other.
///
/// ```
/// use lindstedt_impact::kick::ReturnMap;
/// use lindstedt_impact::orbit::orbit;
/// use lindstedt_impact::parameters::{Branch, Parameters};
///
/// let parameters = Parameters {
///     alpha: 1.0, omega: 2.6, periods: 1, restitution: 0.8, wall: 0.0, damping: 0.05,
///     force: 1.0, displacement_gain: 0.08, velocity_gain: 0.0, branch: Branch::Plus,
/// };
/// let orbit = orbit(&parameters).unwrap();
/// let mut map = ReturnMap::new(&parameters, &orbit).unwrap();
/// map.start([0.0, 1e-3 * orbit.velocity]);
/// let delays: Vec<f64> = (0..20).map(|_| map.fly()).collect();
/// // An unstable flip: every impact is off by -1.455 times the error of the one before.
/// assert!((delays[19] / delays[18] + 1.4555).abs() < 1e-3);
/// ```
pub struct ReturnMap {
    restitution: f64,
    velocity_gain: f64,
    velocity: f64,
    saltation: f64,
    displacement_gain: f64,
    /// (y, y') at the nodes from a force at the nodes: 2 n x n.
    force_response: DMatrix<f64>,
    /// (y, y') at the nodes from y(0), y'(0): 2 n x 2.
    entry_response: DMatrix<f64>,
    flight: DVector<f64>,
    /// -A y - B y' at the nodes of the flight before.
    force: DVector<f64>,
    entry: DVector<f64>,
    late: f64,
}

impl ReturnMap {
    /// y' = u, u' = -(c - B) u - (alpha^2 - A) y - A y_before - B u_before, at Chebyshev points of
    /// the flight (20 + rate T of them, accurate to some 10^-12).
    ///
    /// # Errors
    /// [`ImpactError::OutOfRange`] for a period that needs more than 500 points,
    /// [`ImpactError::NoConvergence`] if the linear system of the flight is singular.
    pub fn new(parameters: &Parameters<f64>, orbit: &Orbit<f64>) -> Result<Self, ImpactError> {
        Self::finer(parameters, orbit, 0)
    }

    /// [`Self::new`] with so many points more.
    fn finer(
        parameters: &Parameters<f64>,
        orbit: &Orbit<f64>,
        more: usize,
    ) -> Result<Self, ImpactError> {
        let &Parameters { alpha, damping, displacement_gain: a, velocity_gain: b, .. } = parameters;
        let rate = (alpha * alpha + a.abs()).sqrt() + damping + b.abs();
        let points = 20.0 + rate * orbit.period;
        if points.is_nan() || points > LARGEST {
            let (value, high) = (orbit.period, (LARGEST - 20.0) / rate);
            return Err(ImpactError::OutOfRange { name: "T", value, low: 0.0, high });
        }
        let n = points as usize + more;
        let d = differentiation(n) * (2.0 / orbit.period);
        let mut system = DMatrix::zeros(2 * n, 2 * n);
        let mut force = DMatrix::zeros(2 * n, n);
        let mut start = DMatrix::zeros(2 * n, 2);
        system.view_mut((0, 0), (n, n)).copy_from(&d);
        system.view_mut((n, n), (n, n)).copy_from(&d);
        for j in 0..n {
            system[(j, n + j)] -= 1.0;
            system[(n + j, j)] += alpha * alpha - a;
            system[(n + j, n + j)] += damping - b;
            force[(n + j, j)] = 1.0;
        }
        // Node 0 is t = 0: the start replaces the equation there.
        for (row, column) in [(0, 0), (n, 1)] {
            system.row_mut(row).fill(0.0);
            force.row_mut(row).fill(0.0);
            system[(row, row)] = 1.0;
            start[(row, column)] = 1.0;
        }
        let factors = system.lu();
        let singular = ImpactError::NoConvergence { what: "the flight between two impacts" };
        let solved = factors.solve(&force).zip(factors.solve(&start));
        let (force_response, entry_response) = solved.ok_or(singular)?;
        Ok(Self {
            restitution: parameters.restitution,
            velocity_gain: b,
            velocity: orbit.velocity,
            saltation: orbit.saltation,
            displacement_gain: a,
            force_response,
            entry_response,
            flight: DVector::zeros(2 * n),
            force: DVector::zeros(n),
            entry: DVector::zeros(2),
            late: 0.0,
        })
    }
    /// Starts with an unperturbed past and the perturbation (y(0), y'(0)).
    pub fn start(&mut self, entry: [f64; 2]) {
        self.flight.fill(0.0);
        self.entry.copy_from_slice(&entry);
        self.late = 0.0;
    }
    /// One flight and impact: returns by how much the impact comes late, delta_l.
    pub fn fly(&mut self) -> f64 {
        let n = self.flight.nrows() / 2;
        let (a, b) = (self.displacement_gain, self.velocity_gain);
        let (y, u) = self.flight.as_slice().split_at(n);
        for (force, (y, u)) in self.force.iter_mut().zip(y.iter().zip(u)) {
            *force = -a * y - b * u;
        }
        self.flight.gemv(1.0, &self.entry_response, &self.entry, 0.0);
        self.flight.gemv(1.0, &self.force_response, &self.force, 1.0);
        let (y, y_slope) = (self.flight[n - 1], self.flight[2 * n - 1]);
        let (r, v) = (self.restitution, self.velocity);
        let late = -y / v;
        let chi = if late > self.late { -r } else { 1.0 };
        let kick = chi * self.velocity_gain * (1.0 + r) * v * (late - self.late);
        self.entry[0] = -r * y;
        self.entry[1] = self.saltation * y - r * y_slope + kick;
        self.late = late;
        late
    }
    /// The size of the state; divides the state by it.
    fn normalise(&mut self) -> f64 {
        let size = self.flight.amax().max(self.entry.amax());
        if size > 0.0 && size.is_finite() {
            self.flight /= size;
            self.entry /= size;
            self.late /= size;
        }
        size
    }
}

/// Iterates the return map over `flights` flights from four starts and measures its growth.
///
/// Estimated: a finite run; different cones of perturbations may have different rates, the largest
/// found is returned. ln rho is a weighted mean of s_l = ln(|state_(l+1)|/|state_l|) over the last three
/// quarters of the flights, and the error of rho the sum of
///
/// * the run: twice the largest difference to the means over its first, middle and last two thirds, of all four starts
///   (a cone that one of them leaves late the others may have left), and the distance to the next largest rate;
/// * the flight: the largest difference to the rates of the same start with 5 and with 11 points more;
/// * rounding, with u = 2^-51: in a flight of n points u n^2, the size of the elements of the
///   differentiation matrix, independently in N flights: u n^2/sqrt N, and u n that all flights share.
///
/// # Errors
/// As [`ReturnMap::new`]; [`ImpactError::NoConvergence`] where a state leaves the doubles.
pub fn piecewise_growth(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
) -> Result<Growth, ImpactError> {
    watched_growth(parameters, orbit, flights, &Stop::default())
}

/// Whether the rate of [`piecewise_growth`] is below 1; nothing where it is within its error of 1. Finer flights are
/// looked at only near 1: the error of a flight is some 10^-12.
///
/// # Errors
/// As [`piecewise_growth`].
pub fn piecewise_stable(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
) -> Result<Option<bool>, ImpactError> {
    let stop = Stop::default();
    let run = run(parameters, orbit, flights, &stop)?;
    let far = |found: &Growth, least: f64| (found.rate - 1.0).abs() > least + found.error;
    let below = |found: &Growth| Some(found.rate < 1.0);
    if far(&run.growth, BAND) {
        return Ok(below(&run.growth));
    }
    let found = run.refined(parameters, orbit, flights, &stop)?;
    Ok(below(&found).filter(|_| far(&found, 0.0)))
}

/// [`piecewise_growth`], that can be stopped.
pub(crate) fn watched_growth(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
    stop: &Stop,
) -> Result<Growth, ImpactError> {
    run(parameters, orbit, flights, stop)?.refined(parameters, orbit, flights, stop)
}

/// The largest rate of four starts.
struct Run {
    start: [f64; 2],
    /// With the error of the run and of rounding.
    growth: Growth,
}

fn run(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
    stop: &Stop,
) -> Result<Run, ImpactError> {
    let mut map = ReturnMap::new(parameters, orbit)?;
    let starts = [[1.0, 0.3], [-1.0, -0.3], [0.2, 1.0], [-0.2, -1.0]];
    let starts = starts.map(|start| start.map(|part| part * orbit.velocity));
    let mut largest = (starts[0], Growth { rate: 0.0, spread: 0.0, error: 0.0 });
    let (mut next, mut unsettled): (f64, f64) = (0.0, 0.0);
    for start in starts {
        let found = growth_of_run(&mut map, start, flights, stop)?;
        unsettled = unsettled.max(found.error);
        if found.rate >= largest.1.rate {
            next = largest.1.rate;
            largest = (start, found);
        } else {
            next = next.max(found.rate);
        }
    }
    let (start, mut growth) = largest;
    let points = map.force.len() as f64;
    let unit = 2.0 * f64::EPSILON;
    let rounding = unit * points * (1.0 + points / (flights.max(1) as f64).sqrt());
    growth.error = unsettled + (growth.rate - next) + rounding * growth.rate.max(1.0);
    Ok(Run { start, growth })
}

impl Run {
    /// With the error of the flight.
    fn refined(
        self,
        parameters: &Parameters<f64>,
        orbit: &Orbit<f64>,
        flights: usize,
        stop: &Stop,
    ) -> Result<Growth, ImpactError> {
        let mut growth = self.growth;
        let mut change: f64 = 0.0;
        for more in MORE_POINTS {
            let mut map = ReturnMap::finer(parameters, orbit, more)?;
            let other = growth_of_run(&mut map, self.start, flights, stop)?;
            change = change.max((other.rate - growth.rate).abs());
        }
        growth.error += change;
        Ok(growth)
    }
}

/// The growth from one start, the first quarter of the run left out; its error is that of the run alone.
fn growth_of_run(
    map: &mut ReturnMap,
    start: [f64; 2],
    flights: usize,
    stop: &Stop,
) -> Result<Growth, ImpactError> {
    map.start(start);
    let skip = flights / 4;
    let mut logarithms = Vec::with_capacity(flights);
    for l in 0..flights {
        check(stop)?;
        map.fly();
        let size = map.normalise();
        if !size.is_finite() {
            return Err(ImpactError::NoConvergence { what: "the growth of the return map" });
        }
        if size == 0.0 {
            return Ok(Growth { rate: 0.0, spread: 0.0, error: 0.0 });
        }
        if l >= skip {
            logarithms.push(size.ln());
        }
    }
    let full = weighted_mean(&logarithms);
    let part = |sixths: [usize; 2]| {
        let [from, to] = sixths.map(|k| k * logarithms.len() / 6);
        weighted_mean(logarithms.get(from..to).unwrap_or_default())
    };
    let change = |found: f64| (found - full).abs();
    let unsettled = [[0, 4], [1, 5], [2, 6]].map(part).map(change).into_iter().fold(0.0, f64::max);
    let rate = full.exp();
    let spread = (part([0, 3]).exp() - part([3, 6]).exp()).abs();
    Ok(Growth { rate, spread, error: 2.0 * rate * unsettled })
}

/// The mean with the weights e^(-1/(t (1 - t))), 0 < t < 1: of a quasiperiodic sequence (a complex pair)
/// it converges faster than any power of the length, where the plain mean has an error of 1/length.
/// Das, Saiki, Sander, Yorke, Nonlinearity 30 (2017) 4111.
fn weighted_mean(list: &[f64]) -> f64 {
    let weight = |l: usize| {
        let t = (l as f64 + 0.5) / list.len() as f64;
        (-1.0 / (t * (1.0 - t))).exp()
    };
    let [sum, weights] = list.iter().enumerate().fold([0.0, 0.0], |[sum, weights], (l, x)| {
        let w = weight(l);
        [sum + w * x, weights + w]
    });
    if weights > 0.0 { sum / weights } else { 0.0 }
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
