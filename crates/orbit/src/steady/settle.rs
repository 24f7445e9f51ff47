//! Where a state of a vector field goes.

use super::System;
use super::krawczyk::newton;
use lindstedt_algebra::Stop;

/// What became of a start state.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// It came to a steady state.
    Steady(Vec<f64>),
    /// It goes round a cycle of the vector field, and is here.
    Cycle(Vec<f64>),
    /// It still moves, here, and what becomes of it is not known.
    Moving(Vec<f64>),
    /// It left every bound.
    Away,
}

/// A motion goes round a cycle if it comes back so near to a point of it, in parts of the way it goes from it, ...
const RETURN: f64 = 1e-6;
/// ... and so long after it, in units of time: an exponent -r of a steady state beside which it turns would move it by more, r
/// being above 1e-8.
const LATE: f64 = 100.0;
/// Units of time after which what still moves is not followed further.
const LONG: f64 = 1e4;
/// Relative error of a step.
const TOLERANCE: f64 = 1e-9;
const MOST_STEPS: usize = 1_000_000;

/// Integrates w' = G(w) in doubles (Dormand and Prince's pair of orders 5 and 4) for at least the time that `slow` decays
/// take, or until Newton's method finds a steady state so near that the rest of the way is decided, or until it is seen to
/// go round a cycle; `reach` is the unit of w, `reach`/|G| on its axes there that of the time.
#[must_use]
pub fn settle(system: &System, start: &[f64], reach: f64, slow: f64, stop: &Stop) -> Fate {
    let size = |w: &[f64]| w.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let (mut w, mut time) = (start.to_vec(), 0.0);
    let axis = |k: usize, end: f64| {
        let mut at = vec![0.0; start.len()];
        at[k] = end;
        size(&system.values(&at)) / reach
    };
    let axes = (0..start.len()).flat_map(|k| [axis(k, reach), axis(k, -reach)]);
    let fast = axes.fold(0.0, f64::max);
    let unit = if fast > 0.0 { fast.recip() } else { 1.0 };
    let end = slow.max(LONG * unit);
    let mut step = 1e-3 * reach / (size(&system.values(&w)) + 1e-12 * reach / unit);
    let (mut section, mut accepted): (Option<Section>, usize) = (None, 0);
    for count in 0..MOST_STEPS {
        if time >= end || stop.asked() {
            break;
        }
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
        let (next, error) = advance(system, &w, step);
        let error = error / (TOLERANCE * reach);
        if error <= 1.0 {
            time += step;
            if let Some(section) = &mut section {
                section.pass(system, time, [&w, &next], step);
            }
            w = next;
            accepted += 1;
            if accepted.is_power_of_two() {
                if section.is_some_and(|section| section.recurs(reach, unit)) {
                    return Fate::Cycle(w);
                }
                section = Some(Section::new(time, &w, system.values(&w)));
            }
        }
        step *= (0.9 / error.max(1e-9).powf(0.2)).clamp(0.2, 4.0);
        if !error.is_finite() {
            return Fate::Away;
        }
    }
    Fate::Moving(w)
}

/// The rows of the pair, and what its weights of order 4 differ by from those of order 5, which are the last row.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// A step, and an estimate of its error.
fn advance(system: &System, w: &[f64], step: f64) -> (Vec<f64>, f64) {
    let mut slopes = vec![system.values(w)];
    let sum = |slopes: &[Vec<f64>], weights: &[f64], i: usize| -> f64 {
        step * weights.iter().zip(slopes).map(|(c, k)| c * k[i]).sum::<f64>()
    };
    let mut next = w.to_vec();
    for row in STAGES {
        next = (0..w.len()).map(|i| w[i] + sum(&slopes, row, i)).collect();
        slopes.push(system.values(&next));
    }
    let error = (0..w.len()).map(|i| sum(&slopes, &ERROR, i).abs()).fold(0.0, f64::max);
    (next, error)
}

/// The plane through a point of the motion across its direction, and how the motion came back to it.
struct Section {
    point: Vec<f64>,
    across: Vec<f64>,
    time: f64,
    /// The largest distance from the point since.
    away: f64,
    /// How often it came back near the point, and when last.
    returns: (usize, f64),
}

impl Section {
    fn new(time: f64, point: &[f64], across: Vec<f64>) -> Self {
        Self { point: point.to_vec(), across, time, away: 0.0, returns: (0, time) }
    }

    fn side(&self, w: &[f64]) -> f64 {
        w.iter().zip(&self.point).zip(&self.across).map(|((w, p), n)| (w - p) * n).sum()
    }

    /// A step between two points: where it passes the section by secants on its length.
    fn pass(&mut self, system: &System, time: f64, [from, to]: [&[f64]; 2], step: f64) {
        self.away = self.away.max(distance(&self.point, to));
        let [mut before, mut now] = [(0.0, self.side(from)), (step, self.side(to))];
        if before.1 >= 0.0 || now.1 < 0.0 {
            return;
        }
        let mut place = to.to_vec();
        for _ in 0..8 {
            let length = now.0 - now.1 * (now.0 - before.0) / (now.1 - before.1);
            if !(0.0..=step).contains(&length) || now.1 == before.1 {
                break;
            }
            place = advance(system, from, length).0;
            (before, now) = (now, (length, self.side(&place)));
        }
        if distance(&place, &self.point) < RETURN * self.away {
            self.returns = (self.returns.0 + 1, time);
        }
    }

    fn recurs(&self, reach: f64, unit: f64) -> bool {
        let (count, last) = self.returns;
        count > 2 && last - self.time > LATE * unit && self.away > 1e-3 * reach
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
