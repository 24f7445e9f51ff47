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
use nalgebra::DMatrix;

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
    /// From the logarithms of the growths of single flights.
    fn of(logarithms: &[f64]) -> Self {
        let full = weighted_mean(logarithms);
        let part = |sixths: [usize; 2]| {
            let [from, to] = sixths.map(|k| k * logarithms.len() / 6);
            weighted_mean(logarithms.get(from..to).unwrap_or_default())
        };
        let change = |found: f64| (found - full).abs();
        let unsettled =
            [[0, 4], [1, 5], [2, 6]].map(part).map(change).into_iter().fold(0.0, f64::max);
        let rate = full.exp();
        let spread = (part([0, 3]).exp() - part([3, 6]).exp()).abs();
        Self { rate, spread, error: 2.0 * rate * unsettled }
    }

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
pub struct ReturnMap<const W: usize = 1> {
    restitution: f64,
    velocity_gain: f64,
    velocity: f64,
    saltation: f64,
    displacement_gain: f64,
    /// (y, y') at the nodes from what causes them: eight rows after the other, of each the columns.
    response: Vec<[f64; ROWS]>,
    /// y(0), y'(0) and -A y - B y' at the nodes of the flight before, of W perturbations side by side.
    causes: Vec<[f64; W]>,
    /// y at the nodes, then y', then zeros up to a multiple of eight.
    flight: Vec<[f64; W]>,
    late: [f64; W],
    arch: pulp::Arch,
}

/// Rows of a response that are formed at a time.
const ROWS: usize = 8;

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
    /// Starts with an unperturbed past and the perturbation (y(0), y'(0)).
    pub fn start(&mut self, entry: [f64; 2]) {
        self.start_all(&[entry]);
    }
    /// One flight and impact: returns by how much the impact comes late, delta_l.
    pub fn fly(&mut self) -> f64 {
        self.fly_all();
        self.late[0]
    }
}

impl<const W: usize> ReturnMap<W> {
    /// [`ReturnMap::new`] with so many points more.
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
        // y(0), y'(0), the force at the nodes.
        let mut causes = DMatrix::zeros(2 * n, 2 + n);
        system.view_mut((0, 0), (n, n)).copy_from(&d);
        system.view_mut((n, n), (n, n)).copy_from(&d);
        for j in 0..n {
            system[(j, n + j)] -= 1.0;
            system[(n + j, j)] += alpha * alpha - a;
            system[(n + j, n + j)] += damping - b;
            causes[(n + j, 2 + j)] = 1.0;
        }
        // Node 0 is t = 0: the start replaces the equation there.
        for (row, column) in [(0, 0), (n, 1)] {
            system.row_mut(row).fill(0.0);
            causes.row_mut(row).fill(0.0);
            system[(row, row)] = 1.0;
            causes[(row, column)] = 1.0;
        }
        let singular = ImpactError::NoConvergence { what: "the flight between two impacts" };
        let solved = system.lu().solve(&causes).ok_or(singular)?;
        let rows = (2 * n).next_multiple_of(ROWS);
        let entry = |row, column| if row < 2 * n { solved[(row, column)] } else { 0.0 };
        let eight = |row: usize, column| std::array::from_fn(|k| entry(row + k, column));
        let columns = |row| (0..2 + n).map(move |column| (row, column));
        let places = (0..rows).step_by(ROWS).flat_map(columns);
        Ok(Self {
            restitution: parameters.restitution,
            velocity_gain: b,
            velocity: orbit.velocity,
            saltation: orbit.saltation,
            displacement_gain: a,
            response: places.map(|(row, column)| eight(row, column)).collect(),
            causes: vec![[0.0; W]; 2 + n],
            flight: vec![[0.0; W]; rows],
            late: [0.0; W],
            arch: pulp::Arch::new(),
        })
    }
    fn points(&self) -> usize {
        self.causes.len() - 2
    }
    fn start_all(&mut self, entries: &[[f64; 2]; W]) {
        self.flight.fill([0.0; W]);
        self.set_entries(entries);
        self.late = [0.0; W];
    }
    fn set_entries(&mut self, entries: &[[f64; 2]; W]) {
        self.causes[0] = entries.map(|entry| entry[0]);
        self.causes[1] = entries.map(|entry| entry[1]);
    }
    /// One flight and impact of every perturbation.
    fn fly_all(&mut self) {
        let n = self.points();
        let (a, b) = (self.displacement_gain, self.velocity_gain);
        let (y, u) = self.flight.split_at(n);
        for (force, (y, u)) in self.causes[2..].iter_mut().zip(y.iter().zip(u)) {
            *force = std::array::from_fn(|w| -a * y[w] - b * u[w]);
        }
        let (response, causes) = (&self.response[..], &self.causes[..]);
        self.arch.dispatch(Flight { response, causes, flight: &mut self.flight });
        let (y, y_slope) = (self.flight[n - 1], self.flight[2 * n - 1]);
        let (r, v) = (self.restitution, self.velocity);
        let entries = std::array::from_fn(|w| {
            let late = -y[w] / v;
            let chi = if late > self.late[w] { -r } else { 1.0 };
            let kick = chi * b * (1.0 + r) * v * (late - self.late[w]);
            self.late[w] = late;
            [-r * y[w], self.saltation * y[w] - r * y_slope[w] + kick]
        });
        self.set_entries(&entries);
    }
    /// The sizes of the states; divides the states by them.
    fn normalise(&mut self) -> [f64; W] {
        let larger = |a: [f64; W], b: &[f64; W]| std::array::from_fn(|w| a[w].max(b[w].abs()));
        let sizes = self.flight.iter().chain(&self.causes[..2]).fold([0.0; W], larger);
        let divisor = sizes.map(|size| if size > 0.0 && size.is_finite() { size } else { 1.0 });
        let states = self.flight.iter_mut().chain(&mut self.causes[..2]).chain([&mut self.late]);
        states.for_each(|state| *state = std::array::from_fn(|w| state[w] / divisor[w]));
        sizes
    }
}

/// The flight from its causes, by the widest vectors that the processor has: the same sums by any.
struct Flight<'m, const W: usize> {
    response: &'m [[f64; ROWS]],
    causes: &'m [[f64; W]],
    flight: &'m mut [[f64; W]],
}

impl<const W: usize> pulp::NullaryFnOnce for Flight<'_, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let blocks = self.response.chunks_exact(self.causes.len());
        for (columns, rows) in blocks.zip(self.flight.as_chunks_mut::<ROWS>().0) {
            let mut sums = [[0.0; W]; ROWS];
            for (column, cause) in columns.iter().zip(self.causes) {
                for (sum, c) in sums.iter_mut().zip(column) {
                    sum.iter_mut().zip(cause).for_each(|(sum, x)| *sum += c * x);
                }
            }
            *rows = sums;
        }
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
/// As [`ReturnMap::new`]; [`ImpactError::NoConvergence`] where a state leaves the doubles; [`ImpactError::Cancelled`].
pub fn piecewise_growth(
    parameters: &Parameters<f64>,
    orbit: &Orbit<f64>,
    flights: usize,
    stop: &Stop,
) -> Result<Growth, ImpactError> {
    run(parameters, orbit, flights, stop)?.refined(parameters, orbit, flights, stop)
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
    let mut map = ReturnMap::finer(parameters, orbit, 0)?;
    let starts = [[1.0, 0.3], [-1.0, -0.3], [0.2, 1.0], [-0.2, -1.0]];
    let starts = starts.map(|start| start.map(|part| part * orbit.velocity));
    let mut largest = (starts[0], Growth { rate: 0.0, spread: 0.0, error: 0.0 });
    let (mut next, mut unsettled): (f64, f64) = (0.0, 0.0);
    for (start, found) in starts.iter().zip(growths(&mut map, &starts, flights, stop)?) {
        unsettled = unsettled.max(found.error);
        if found.rate >= largest.1.rate {
            next = largest.1.rate;
            largest = (*start, found);
        } else {
            next = next.max(found.rate);
        }
    }
    let (start, mut growth) = largest;
    let points = map.points() as f64;
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
            let [other] = growths(&mut map, &[self.start], flights, stop)?;
            change = change.max((other.rate - growth.rate).abs());
        }
        growth.error += change;
        Ok(growth)
    }
}

/// The growths from some starts, the first quarter of the runs left out; their errors are those of the runs alone.
fn growths<const W: usize>(
    map: &mut ReturnMap<W>,
    starts: &[[f64; 2]; W],
    flights: usize,
    stop: &Stop,
) -> Result<[Growth; W], ImpactError> {
    map.start_all(starts);
    let skip = flights / 4;
    let mut logarithms: [Vec<f64>; W] = std::array::from_fn(|_| Vec::with_capacity(flights));
    let mut vanished = [false; W];
    for l in 0..flights {
        check(stop)?;
        map.fly_all();
        for (w, size) in map.normalise().into_iter().enumerate() {
            if !size.is_finite() {
                return Err(ImpactError::NoConvergence { what: "the growth of the return map" });
            }
            vanished[w] |= size == 0.0;
            if l >= skip {
                logarithms[w].push(size.ln());
            }
        }
    }
    let none = Growth { rate: 0.0, spread: 0.0, error: 0.0 };
    let growth = |w: usize| if vanished[w] { none } else { Growth::of(&logarithms[w]) };
    Ok(std::array::from_fn(growth))
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
