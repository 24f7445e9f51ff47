//! The distance of the manifolds to second order in eps, and the slope of the threshold.
//!
//!   x'' = f(x) + eps g(t, x, x'),   g = gamma d - h,   H = x'^2/2 - int f,   dH/dt = eps x' g.
//!
//! On either manifold x = x_h + eps x_1 + ..., with both in the section x' = 0 (loops) or x = const (from one saddle
//! to another) at the time t_0:
//!
//!   H_u - H_s = eps M_1(t_0) + eps^2 M_2(t_0) + O(eps^3),
//!   M_1 = int x_h' g dt,   M_2 = int x_1' g + x_h' (g_x x_1 + g_x' x_1') dt,   x_1'' = f'(x_h) x_1 + g,
//!
//! x_1 bounded towards its saddle, the integral without its end terms x_1'^2/2 - f'(saddle) x_1^2/2, which have no
//! limit. Where g jumps by J at x' = k, g_x' holds J delta(x' - k). The manifolds touch where the distance has a
//! double zero, at the extremum t_0 of the work F of d, so that with gamma_0 = D/F(t_0)
//!
//!   gamma_c(eps) = gamma_0 + gamma_1 eps + O(eps^2),   gamma_1 = -M_2(t_0)/F(t_0) at gamma_0.

mod waves;

use crate::{Branch, StickSlip};
use lindstedt_algebra::Stop;
use std::f64::consts::PI;
use waves::Waves;

/// A function of (x, x') with its derivatives by x and by x'.
pub type Local = [f64; 3];

/// What the distance needs to be known of the equation; functions return nothing where they are undefined.
#[derive(Clone, Copy)]
pub struct Splitting<'a> {
    /// f and f' at x.
    pub force: &'a dyn Fn(f64) -> Option<[f64; 2]>,
    /// d at t, x, x': the periodic force at gamma = 1.
    pub drive: &'a dyn Fn(f64, f64, f64) -> Option<Local>,
    /// h at x, x'.
    pub friction: &'a dyn Fn(f64, f64) -> Option<Local>,
    /// The period of d.
    pub period: f64,
    /// The highest harmonic of d.
    pub harmonics: u32,
    /// k: where h jumps or bends.
    pub kink: Option<f64>,
    /// Asked at every step along an orbit.
    pub stop: &'a Stop,
}

/// An orbit of x'' = f(x) from a saddle to a saddle.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Where it comes from and where it goes to.
    pub saddles: [f64; 2],
    /// The turning point of a loop, else a point between the saddles.
    pub middle: f64,
}

/// The threshold of an orbit to second order. Estimated.
#[derive(Clone, Copy, Debug)]
pub struct SecondOrder {
    /// gamma_0, Melnikov's threshold, with the sign of D.
    pub signed: f64,
    /// Its estimated error, from two steps of integration.
    pub signed_error: f64,
    /// gamma_1: the threshold is |gamma_0| + gamma_1 eps for eps > 0.
    pub slope: f64,
    /// gamma_1 for eps < 0: another one where several extrema of the work are equal, each of which has a tangency. The
    /// threshold is the first of these.
    pub slope_below: f64,
    /// The estimated error of the slope, from two steps of integration.
    pub error: f64,
    /// max |g|/max |f| on the orbit: eps is small against its reciprocal.
    pub strength: f64,
}

/// The distance from the saddle at which an orbit begins.
const START: f64 = 1e-11;
/// Steps per unit of the fastest time.
const STEPS: f64 = 16.0;
const MOST_STEPS: usize = 200_000;
/// Gauss's method with three stages, of order 6: no stage lies at an end of a step, where g may jump.
const ROOT: f64 = 3.872_983_346_207_417;
const NODES: [f64; 3] = [0.5 - ROOT / 10.0, 0.5, 0.5 + ROOT / 10.0];
const WEIGHTS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
const MATRIX: [[f64; 3]; 3] = [
    [5.0 / 36.0, 2.0 / 9.0 - ROOT / 15.0, 5.0 / 36.0 - ROOT / 30.0],
    [5.0 / 36.0 + ROOT / 24.0, 2.0 / 9.0, 5.0 / 36.0 - ROOT / 24.0],
    [5.0 / 36.0 + ROOT / 30.0, 2.0 / 9.0 + ROOT / 15.0, 5.0 / 36.0],
];

type State = [f64; 2];

/// The states of the stages and that at the end of a step of y'' = acceleration(stage, y), by iteration.
fn step(
    state: State,
    h: f64,
    acceleration: &dyn Fn(usize, f64) -> Option<f64>,
) -> Option<([State; 3], State)> {
    let mut rates = [[state[1], acceleration(1, state[0])?]; 3];
    let mut stages = [state; 3];
    for _ in 0..60 {
        let before = stages;
        for (stage, row) in stages.iter_mut().zip(MATRIX) {
            let sum = |k: usize| row.iter().zip(&rates).map(|(a, rate)| a * rate[k]).sum::<f64>();
            *stage = [state[0] + h * sum(0), state[1] + h * sum(1)];
        }
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate = [stages[k][1], acceleration(k, stages[k][0])?];
        }
        let moved =
            |k: usize| (stages[k][0] - before[k][0]).abs() + (stages[k][1] - before[k][1]).abs();
        let size = state[0].abs() + state[1].abs();
        if (0..3).all(|k| moved(k) <= 4.0 * f64::EPSILON * size) {
            break;
        }
    }
    let sum = |k: usize| WEIGHTS.iter().zip(&rates).map(|(b, rate)| b * rate[k]).sum::<f64>();
    Some((stages, [state[0] + h * sum(0), state[1] + h * sum(1)]))
}

/// A step along the orbit of eps = 0.
struct Step {
    /// When it begins; 0 is in the section.
    time: f64,
    h: f64,
    stages: [State; 3],
    end: State,
    /// Whether it ends where x' = k.
    at_kink: bool,
}

/// The way from a saddle to the section: forwards from the first, backwards from the second.
struct Side {
    saddle: f64,
    rate: f64,
    steps: Vec<Step>,
}

impl Splitting<'_> {
    /// gamma_0 and gamma_1 of an orbit; nothing where a function is undefined on it, where D = 0, where the
    /// saddle lies where h jumps, where x' = k is not passed with a speed, or when stopped.
    ///
    /// Cost: some thousand evaluations of the functions for every maximum of the work of d.
    ///
    /// x'' = x - x^3 + eps (gamma cos t - x'): 4 cosh(pi/2)/(3 sqrt 2 pi).
    /// ```
    /// use lindstedt_melnikov::splitting::{Connection, Splitting};
    /// let splitting = Splitting {
    ///     force: &|x| Some([x - x.powi(3), 1.0 - 3.0 * x * x]),
    ///     drive: &|t, _, _| Some([t.cos(), 0.0, 0.0]),
    ///     friction: &|_, v| Some([v, 0.0, 1.0]),
    ///     period: 2.0 * std::f64::consts::PI,
    ///     harmonics: 1,
    ///     kink: None,
    ///     stop: &Default::default(),
    /// };
    /// let right = Connection { saddles: [0.0, 0.0], middle: 2f64.sqrt() };
    /// let found = splitting.second_order(&right).expect("a loop");
    /// assert!((found.signed - 0.753_017_7).abs() < 1e-6 && found.error < 1e-6);
    /// ```
    #[must_use]
    pub fn second_order(&self, orbit: &Connection) -> Option<SecondOrder> {
        let coarse = self.with_steps(orbit, STEPS)?;
        let fine = self.with_steps(orbit, 2.0 * STEPS)?;
        // Of order 6 the finer one has a 63rd of the difference left, less regularly where it is cut at kinks; a work that
        // cancels to rounding errors is not better with finer steps.
        let noise = (fine.0 - coarse.0).abs();
        let share = if noise > 1e-9 * fine.0.abs() { 4.0 } else { 0.125 };
        let change = |k: usize| (fine.1[k] - coarse.1[k]).abs();
        let size = fine.1[0].abs().max(fine.1[1].abs()).max(fine.0.abs());
        let error = share * change(0).max(change(1)) + 1e-10 * size;
        let signed_error = 4.0 * noise + 1e-10 * fine.0.abs();
        let known =
            fine.1.iter().all(|slope| slope.is_finite()) && signed_error < 1e-3 * fine.0.abs();
        known.then_some(SecondOrder {
            signed: fine.0,
            signed_error,
            slope: fine.1[0],
            slope_below: fine.1[1],
            error,
            strength: fine.2,
        })
    }

    /// gamma_0, gamma_1 for eps > 0 and for eps < 0, and the strength with so many steps per unit of the fastest time.
    fn with_steps(&self, orbit: &Connection, steps: f64) -> Option<(f64, [f64; 2], f64)> {
        let sides = [self.side(orbit, 1.0, steps)?, self.side(orbit, -1.0, steps)?];
        let dissipation = first_order(&sides, &|_, x, v| Some((self.friction)(x, v)?[0]))?;
        let count = 2 * self.harmonics as usize + 2;
        let times: Vec<f64> = (0..count).map(|j| self.period * j as f64 / count as f64).collect();
        let works = times
            .iter()
            .map(|shift| first_order(&sides, &|t, x, v| Some((self.drive)(t + shift, x, v)?[0])));
        let work = Waves::new(self.period, &works.collect::<Option<Vec<f64>>>()?);
        let places = work.largest(dissipation.signum());
        let slopes = places.iter().map(|(time, size)| {
            let gamma = dissipation / size;
            let second = |side| self.second(side, orbit, gamma, *time);
            Some((gamma, -(second(&sides[0])? - second(&sides[1])?) / size, *time))
        });
        let slopes = slopes.collect::<Option<Vec<_>>>()?;
        let below = slopes.iter().map(|(_, slope, _)| *slope).reduce(f64::max)?;
        let (gamma, slope, time) = slopes.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let strength = self.strength(&sides, gamma, time)?;
        (dissipation != 0.0).then_some((gamma.copysign(dissipation), [slope, below], strength))
    }

    /// max |g|/max |f| on the orbit.
    fn strength(&self, sides: &[Side; 2], gamma: f64, shift: f64) -> Option<f64> {
        let (mut force, mut perturbation) = (0.0f64, 0.0f64);
        for step in sides.iter().flat_map(|side| &side.steps) {
            let g = self.perturbation(gamma, step.time + shift, step.stages[1])?;
            force = force.max((self.force)(step.stages[1][0])?[0].abs());
            perturbation = perturbation.max(g[0].abs());
        }
        Some(perturbation / force)
    }

    /// From the saddle to the section, forwards (1) or backwards (-1) in time.
    fn side(&self, orbit: &Connection, sense: f64, steps: f64) -> Option<Side> {
        let saddle = orbit.saddles[usize::from(sense < 0.0)];
        let is_loop = orbit.saddles[0] == orbit.saddles[1];
        let away = (orbit.middle - saddle).signum();
        let rate = (self.force)(saddle)?[1].sqrt();
        let fastest = rate.max(2.0 * PI * f64::from(self.harmonics) / self.period);
        let h = sense / (steps * fastest);
        let mut state = [saddle + START * away, sense * rate * START * away];
        let mut side = Side { saddle, rate, steps: Vec::new() };
        let force = |_: usize, x: f64| Some((self.force)(x)?[0]);
        let (mut time, mut above) = (0.0, self.kink.map(|k| 0.0 > k));
        while side.steps.len() < MOST_STEPS && !self.stop.asked() {
            let (mut stages, mut end) = step(state, h, &force)?;
            let arrived = |end: &State| {
                if is_loop {
                    end[1] * sense * away <= 0.0
                } else {
                    (end[0] - orbit.middle) * away >= 0.0
                }
            };
            let kink = self.kink.filter(|k| above.is_some_and(|above| (end[1] > *k) != above));
            let last = kink.is_none() && arrived(&end);
            let mut length = h;
            if kink.is_some() || last {
                // x' changes by f, x by x': Newton's method for the length of the step.
                for _ in 0..8 {
                    let distance = match kink {
                        Some(k) => (end[1] - k) / (self.force)(end[0])?[0],
                        None if is_loop => end[1] / (self.force)(end[0])?[0],
                        None => (end[0] - orbit.middle) / end[1],
                    };
                    length -= distance;
                    (stages, end) = step(state, length, &force)?;
                }
            }
            let at_kink = kink.is_some();
            above = above.map(|above| above != at_kink);
            side.steps.push(Step { time, h: length, stages, end, at_kink });
            time += length;
            state = end;
            if last {
                side.steps.iter_mut().for_each(|step| step.time -= time);
                return Some(side);
            }
        }
        None
    }

    /// g at a time, x, x'.
    fn perturbation(&self, gamma: f64, t: f64, [x, v]: State) -> Option<Local> {
        let (drive, friction) = ((self.drive)(t, x, v)?, (self.friction)(x, v)?);
        Some([0, 1, 2].map(|k| gamma * drive[k] - friction[k]))
    }

    /// The energy of a manifold in the section at t_0 = shift, of second order.
    fn second(&self, side: &Side, orbit: &Connection, gamma: f64, shift: f64) -> Option<f64> {
        let (Some(begin), Some(end)) = (side.steps.first(), side.steps.last()) else { return None };
        let mut first = self.bounded(side, gamma, begin.time + shift)?;
        // Of x_1 and of x_h', which x_1 may hold any multiple of.
        let mut energy = (first[1].powi(2) - (side.rate * first[0]).powi(2)) / 2.0;
        let mut along = 0.0;
        for step in &side.steps {
            if self.stop.asked() {
                return None;
            }
            let mut local = [([0.0; 2], [0.0; 3]); 3];
            for (k, local) in local.iter_mut().enumerate() {
                let t = step.time + NODES[k] * step.h + shift;
                let state = step.stages[k];
                *local = ((self.force)(state[0])?, self.perturbation(gamma, t, state)?);
            }
            let rate = |k: usize, x: f64| Some(local[k].0[1] * x + local[k].1[0]);
            let (stages, next) = self::step(first, step.h, &rate)?;
            for (k, ([f, _], [g, by_x, by_v])) in local.into_iter().enumerate() {
                let v = step.stages[k][1];
                let part =
                    |[x, rate]: State| WEIGHTS[k] * step.h * (rate * (g + v * by_v) + v * by_x * x);
                energy += part(stages[k]);
                along += part([v, f]);
            }
            first = next;
            if let Some(k) = self.kink.filter(|_| step.at_kink) {
                let f = (self.force)(step.end[0])?[0];
                let jump = self.jump(step.end[0], k)?;
                energy += k * jump * first[1] / f.abs() * step.h.signum();
                along += k * jump * f.signum() * step.h.signum();
            }
        }
        let [x, v] = end.end;
        let multiple = if orbit.saddles[0] == orbit.saddles[1] {
            first[1] / (self.force)(x)?[0]
        } else {
            first[0] / v
        };
        Some(energy - multiple * along)
    }

    /// g just above x' = k less g just below.
    fn jump(&self, x: f64, k: f64) -> Option<f64> {
        let near = 1e-6 * (1.0 + k.abs());
        let (above, below) = ((self.friction)(x, k + near)?, (self.friction)(x, k - near)?);
        Some(-(above[0] - near * above[2]) + (below[0] + near * below[2]))
    }

    /// x_1 and x_1' at a time where x_h rests at the saddle: the bounded solution of x_1'' = f' x_1 + g.
    fn bounded(&self, side: &Side, gamma: f64, time: f64) -> Option<State> {
        let count = 2 * self.harmonics as usize + 2;
        let at = |j: usize| self.period * j as f64 / count as f64;
        let values =
            (0..count).map(|j| Some(self.perturbation(gamma, at(j), [side.saddle, 0.0])?[0]));
        let force = Waves::new(self.period, &values.collect::<Option<Vec<f64>>>()?);
        let response = |w: f64| -1.0 / (side.rate.powi(2) + w * w);
        Some([force.value(time, 0, &response), force.value(time, 1, &response)])
    }
}

impl StickSlip {
    /// gamma_0 and gamma_1 on the right (positive) or the left loop. Estimated.
    ///
    /// ```
    /// use lindstedt_melnikov::{Branch, StickSlip};
    /// use lindstedt_number::Exact;
    /// let (a, b, omega, belt_speed) = (1.into(), 1.into(), 2.into(), Exact::from((2, 5)));
    /// let [dry, alpha, beta] = [(); 3].map(|()| Exact::from((3, 10)));
    /// let point = StickSlip { a, b, dry, alpha, beta, omega, belt_speed };
    /// let right = point.second_order(Branch::Positive).expect("v* is neither 0 nor V");
    /// assert!((right.slope - 0.199_320_25).abs() < 1e-8);
    /// ```
    #[must_use]
    pub fn second_order(&self, branch: Branch) -> Option<SecondOrder> {
        let [a, b, dry, alpha, beta, omega, belt] =
            [&self.a, &self.b, &self.dry, &self.alpha, &self.beta, &self.omega, &self.belt_speed]
                .map(|value| value.to_f64());
        let friction = |_: f64, v: f64| {
            let w = v - belt;
            let law = dry * w.signum() - alpha * w + beta * w.powi(3);
            Some([law, 0.0, 3.0 * beta * w * w - alpha])
        };
        let splitting = Splitting {
            force: &|x| Some([x * (a - b * x * x), a - 3.0 * b * x * x]),
            drive: &|t, _, _| Some([(omega * t).cos(), 0.0, 0.0]),
            friction: &friction,
            period: 2.0 * PI / omega,
            harmonics: 1,
            kink: (dry != 0.0).then_some(belt),
            stop: &Stop::default(),
        };
        let middle = branch.sign() as f64 * (2.0 * a / b).sqrt();
        splitting.second_order(&Connection { saddles: [0.0, 0.0], middle })
    }
}

/// int x_h' g dt.
fn first_order(sides: &[Side; 2], g: &dyn Fn(f64, f64, f64) -> Option<f64>) -> Option<f64> {
    let mut sum = 0.0;
    for (side, sense) in sides.iter().zip([1.0, -1.0]) {
        for step in &side.steps {
            for (k, [x, v]) in step.stages.into_iter().enumerate() {
                let t = step.time + NODES[k] * step.h;
                sum += sense * WEIGHTS[k] * step.h * v * g(t, x, v)?;
            }
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests;
