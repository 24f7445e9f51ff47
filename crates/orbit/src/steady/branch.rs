//! Branches of solutions of n polynomials in n + 1 unknowns, by continuation in arclength (Keller 1977): a step along
//! the tangent, Newton's method on the hyperplane across it, steps as long as the direction turns little.
//!
//! Where one of three functions along the branch changes its sign, the point is located by bisection and secants:
//! the parameter's share of the tangent (folds), prod_(i<j) (lambda_i + lambda_j) (Hopf points), and the determinant of the
//! derivative with the tangent below it (crossings of branches).

use super::System;
use super::flow::Change;
use crate::eigenvalues::eigenvalues;
use lindstedt_algebra::Stop;
use nalgebra::Complex;

/// Where a branch is followed.
#[derive(Clone, Debug)]
pub struct Course {
    /// Which of the variables is the parameter.
    pub parameter: usize,
    /// Its range.
    pub range: [f64; 2],
    /// Another variable with a range.
    pub second: Option<(usize, [f64; 2])>,
    /// Another one, below whose zero the branch ends.
    pub positive: Option<usize>,
    /// The first so many rows and variables are a vector field: its eigenvalues are the exponents.
    pub unknowns: usize,
    /// The branch ends where the modulus of a pair of unknowns (x_0, x_1), (x_2, x_3), ... exceeds this; their unit, too.
    pub reach: f64,
    /// The longest step, as a fraction of the range and of the reach.
    pub step: f64,
    /// The most points.
    pub most: usize,
    /// Asked between points.
    pub stop: Stop,
}

/// A point of a branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The variables.
    pub at: Vec<f64>,
    /// The eigenvalues of the vector field there.
    pub exponents: Vec<Complex<f64>>,
    /// The point is one of these.
    pub change: Option<Change>,
}

impl Point {
    /// Whether all exponents have negative real parts; nothing within rounding.
    #[must_use]
    pub fn is_stable(&self) -> Option<bool> {
        let size = self.exponents.iter().fold(0.0f64, |m, x| m.max(x.norm()));
        let largest = self.exponents.iter().map(|x| x.re).fold(f64::NEG_INFINITY, f64::max);
        (largest.abs() > 1e-9 * size).then_some(largest < 0.0)
    }
}

/// A piece of a solution curve.
#[derive(Clone, Debug)]
pub struct Branch {
    /// The points in order, those of changes among them.
    pub points: Vec<Point>,
    /// Whether the last point is the first.
    pub closed: bool,
    /// Whether it was followed to the ends of the range or the reach on both sides.
    pub complete: bool,
}

/// A solution of a square system with its exponents.
#[must_use]
pub fn state_at(system: &System, at: &[f64]) -> Point {
    let (_, slopes) = system.derivatives(at);
    Point { at: at.to_vec(), exponents: eigenvalues(at.len(), &slopes), change: None }
}

/// prod_(i<j) (lambda_i + lambda_j).
fn sums(exponents: &[Complex<f64>]) -> f64 {
    let pairs = exponents.iter().enumerate();
    let product = pairs.flat_map(|(i, a)| exponents[..i].iter().map(move |b| a + b));
    product.fold(Complex::new(1.0, 0.0), |p, sum| p * sum).re
}

#[derive(Clone, Debug)]
struct State {
    /// The variables in their units.
    scaled: Vec<f64>,
    tangent: Vec<f64>,
    orientation: f64,
    point: Point,
}

/// A function whose zero is a change.
type Test<'a> = &'a dyn Fn(&State) -> f64;

struct Tracer<'a> {
    system: &'a System,
    course: &'a Course,
    units: Vec<f64>,
}

enum End {
    Closed,
    Edge,
    Lost,
}

/// The branch through a solution near `start`, in both directions. Nothing where no solution is near.
#[must_use]
pub fn follow(system: &System, start: &[f64], course: &Course) -> Option<Branch> {
    let n = system.variables();
    if system.rows() + 1 != n || start.len() != n || course.parameter >= n {
        return None;
    }
    let units = (0..n).map(|i| match course.second {
        _ if i == course.parameter => course.range[1] - course.range[0],
        Some((other, [low, high])) if i == other => high - low,
        _ => course.reach,
    });
    let tracer = Tracer { system, course, units: units.collect() };
    let first = tracer.first(start)?;
    let (mut points, end) = tracer.trace(&first, course.most);
    if matches!(end, End::Closed) {
        return Some(Branch { points, closed: true, complete: true });
    }
    let opposite = State { tangent: first.tangent.iter().map(|t| -t).collect(), ..first };
    let opposite = State { orientation: -opposite.orientation, ..opposite };
    let (back, other) = tracer.trace(&opposite, course.most.saturating_sub(points.len()).max(2));
    let mut all: Vec<Point> = back.into_iter().skip(1).rev().collect();
    all.append(&mut points);
    let complete = matches!((end, other), (End::Edge, End::Edge));
    Some(Branch { points: all, closed: false, complete })
}

impl Tracer<'_> {
    fn derivatives(&self, scaled: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let at: Vec<f64> = scaled.iter().zip(&self.units).map(|(y, unit)| y * unit).collect();
        self.system.derivatives(&at)
    }

    /// The derivative in units with a row below it: the solution for a right side, and its determinant.
    fn bordered(&self, slopes: &[f64], below: &[f64], right: &mut [f64]) -> Option<f64> {
        let n = below.len();
        let units = slopes.chunks_exact(n).flat_map(|row| row.iter().zip(&self.units));
        let mut matrix = Vec::with_capacity(n * n);
        matrix.extend(units.map(|(slope, unit)| slope * unit));
        matrix.extend(below);
        solve(&mut matrix, right)
    }

    fn state(&self, scaled: Vec<f64>, previous: &[f64]) -> Option<State> {
        let n = scaled.len();
        let (_, slopes) = self.derivatives(&scaled);
        let mut tangent = vec![0.0; n];
        tangent[n - 1] = 1.0;
        let determinant = self.bordered(&slopes, previous, &mut tangent)?;
        let length = tangent.iter().map(|t| t * t).sum::<f64>().sqrt();
        tangent.iter_mut().for_each(|t| *t /= length);
        if tangent.iter().any(|t| !t.is_finite()) {
            return None;
        }
        // A determinant is linear in its last row, and the solution is tau = |tau| t with J tau = 0: with t in the place of
        // the row below it is the one here times t tau.
        let orientation = determinant * length;
        let m = self.course.unknowns;
        let mut rows = Vec::with_capacity(m * m);
        slopes.chunks_exact(n).take(m).for_each(|row| rows.extend_from_slice(&row[..m]));
        let at = scaled.iter().zip(&self.units).map(|(y, unit)| y * unit).collect();
        let point = Point { at, exponents: eigenvalues(m, &rows), change: None };
        Some(State { scaled, tangent, orientation, point })
    }

    /// Newton's method across a direction; with the number of steps.
    fn correct(&self, guess: &[f64], across: &[f64]) -> Option<(Vec<f64>, usize)> {
        let mut at = guess.to_vec();
        let mut before = f64::INFINITY;
        for steps in 1..=12 {
            let (mut step, slopes) = self.derivatives(&at);
            step.push(across.iter().zip(&at).zip(guess).map(|((t, y), g)| t * (y - g)).sum());
            self.bordered(&slopes, across, &mut step)?;
            at.iter_mut().zip(&step).for_each(|(y, d)| *y -= d);
            let change = step.iter().fold(0.0f64, |m, d| m.max(d.abs()));
            if !change.is_finite() || change > 10.0 {
                return None;
            }
            // Errors are squared: what is left of a step that small is of the size of rounding.
            let squared = change < 1e-8 && change < 1e-3 * before && before < f64::INFINITY;
            if squared || change < 1e-13 || (change < 1e-9 && change > 0.2 * before) {
                return Some((at, steps));
            }
            before = change;
        }
        None
    }

    fn first(&self, start: &[f64]) -> Option<State> {
        let scaled: Vec<f64> = start.iter().zip(&self.units).map(|(x, unit)| x / unit).collect();
        let n = scaled.len();
        let axis = |k: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == k))).collect() };
        let order = std::iter::once(self.course.parameter).chain(0..n);
        order.into_iter().find_map(|k| {
            let (at, _) = self.correct(&scaled, &axis(k))?;
            let state = self.state(at, &axis(k))?;
            let off = state.scaled.iter().zip(&scaled).all(|(a, b)| (a - b).abs() < 0.05);
            off.then_some(state)
        })
    }

    fn step(&self, from: &State, length: f64) -> Option<(State, usize)> {
        let ahead = from.scaled.iter().zip(&from.tangent).map(|(y, t)| y + length * t);
        let (at, steps) = self.correct(&ahead.collect::<Vec<_>>(), &from.tangent)?;
        Some((self.state(at, &from.tangent)?, steps))
    }

    fn trace(&self, first: &State, most: usize) -> (Vec<Point>, End) {
        let longest = self.course.step;
        let mut points = vec![first.point.clone()];
        let mut from = first.clone();
        let mut length = 0.25 * longest;
        while points.len() < most && !self.course.stop.asked() {
            let turned = |to: &State| {
                from.tangent.iter().zip(&to.tangent).map(|(a, b)| a * b).sum::<f64>() < 0.95
            };
            let Some((to, steps)) = self.step(&from, length).filter(|(to, _)| !turned(to)) else {
                length *= 0.5;
                if length < 1e-9 {
                    return (points, End::Lost);
                }
                continue;
            };
            if points.len() > 3 && self.passes(&from, length, first) {
                points.extend(self.changes(&from, length, &to));
                points.push(first.point.clone());
                return (points, End::Closed);
            }
            if let Some(edge) = self.edge(&to) {
                let last = match edge {
                    Some(edge) => self.at_edge(&from, &to, edge),
                    None if self.beyond(&from) >= 0.0 => from.clone(),
                    None => self
                        .locate(&from, length, &|state| self.beyond(state))
                        .map_or_else(|| from.clone(), |(_, state)| state),
                };
                // A start at the edge is its own end.
                let moved =
                    last.scaled.iter().zip(&from.scaled).any(|(a, b)| (a - b).abs() > 1e-12);
                if moved {
                    points.extend(self.changes(&from, length, &last));
                    points.push(last.point);
                }
                return (points, End::Edge);
            }
            points.extend(self.changes(&from, length, &to));
            points.push(to.point.clone());
            from = to;
            if steps <= 2 {
                length = (1.5 * length).min(longest);
            }
        }
        (points, End::Lost)
    }

    /// Whether a step passes the first state in its direction.
    fn passes(&self, from: &State, length: f64, first: &State) -> bool {
        let away: Vec<f64> = first.scaled.iter().zip(&from.scaled).map(|(a, b)| a - b).collect();
        let along: f64 = away.iter().zip(&from.tangent).map(|(a, t)| a * t).sum();
        let across: f64 =
            away.iter().zip(&from.tangent).map(|(a, t)| (a - along * t).powi(2)).sum();
        let same: f64 = first.tangent.iter().zip(&from.tangent).map(|(a, b)| a * b).sum();
        along > 0.0 && along <= length && across.sqrt() < 0.3 * length && same > 0.9
    }

    /// What has left its range: a variable with the value at which it did, or nothing for the modulus of a pair.
    fn edge(&self, state: &State) -> Option<Option<(usize, f64)>> {
        let course = self.course;
        let parameter = state.point.at[course.parameter];
        let [low, high] = course.range;
        if !(low..=high).contains(&parameter) {
            return Some(Some((course.parameter, parameter.clamp(low, high))));
        }
        if let Some((other, [low, high])) = course.second
            && !(low..=high).contains(&state.point.at[other])
        {
            return Some(Some((other, state.point.at[other].clamp(low, high))));
        }
        if let Some(other) = course.positive
            && state.point.at[other] < 0.0
        {
            return Some(Some((other, 0.0)));
        }
        (self.beyond(state) > 0.0).then_some(None)
    }

    /// By how much the largest modulus of a pair of unknowns exceeds the reach.
    fn beyond(&self, state: &State) -> f64 {
        let square = |pair: &[f64]| pair.iter().map(|x| x * x).sum::<f64>();
        let pairs = state.point.at[..self.course.unknowns].chunks(2);
        pairs.map(square).fold(0.0, f64::max).sqrt() - self.course.reach
    }

    /// The point of the branch at the edge.
    fn at_edge(&self, from: &State, to: &State, (variable, value): (usize, f64)) -> State {
        let target = value / self.units[variable];
        let (a, b) = (from.scaled[variable], to.scaled[variable]);
        let share = if a == b { 1.0 } else { (target - a) / (b - a) };
        let mut guess: Vec<f64> =
            from.scaled.iter().zip(&to.scaled).map(|(a, b)| a + share * (b - a)).collect();
        guess[variable] = target;
        let across: Vec<f64> =
            (0..guess.len()).map(|i| f64::from(u8::from(i == variable))).collect();
        let landed = self.correct(&guess, &across);
        let landed = landed.and_then(|(at, _)| self.state(at, &from.tangent));
        landed.unwrap_or_else(|| to.clone())
    }

    /// The changes between two states, in order.
    fn changes(&self, from: &State, length: f64, to: &State) -> Vec<Point> {
        let parameter = self.course.parameter;
        let fold = move |state: &State| state.tangent[parameter];
        let hopf = |state: &State| sums(&state.point.exponents);
        let crossing = |state: &State| state.orientation;
        let tests: [(Change, Test<'_>); 3] =
            [(Change::Crossing, &crossing), (Change::Fold, &fold), (Change::Hopf, &hopf)];
        let mut found: Vec<(f64, Change, State)> = Vec::new();
        for (change, test) in tests {
            if test(from) * test(to) >= 0.0 {
                continue;
            }
            let Some((at, state)) = self.locate(from, length, test) else { continue };
            let near = |(other, ..): &(f64, Change, State)| (other - at).abs() < 1e-4 * length;
            // A crossing of branches makes the tangent turn; a real pair of opposite exponents is no oscillation.
            let apparent = change == Change::Fold && found.iter().any(near);
            if apparent || (change == Change::Hopf && !oscillates(&state.point.exponents)) {
                continue;
            }
            found.push((at, change, state));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let marked = |(_, change, state): (f64, Change, State)| Point {
            change: Some(change),
            ..state.point
        };
        found.into_iter().map(marked).collect()
    }

    /// The zero of a function along a step, by regula falsi (Illinois) on its length.
    fn locate(&self, from: &State, length: f64, test: Test<'_>) -> Option<(f64, State)> {
        let (mut low, mut high) = (0.0, length);
        let far = self.step(from, length)?.0;
        let (mut at_low, mut at_high) = (test(from), test(&far));
        let mut last = Some((length, far));
        let mut kept = 0i32;
        for _ in 0..60 {
            let middle = (low * at_high - high * at_low) / (at_high - at_low);
            let middle = if middle > low && middle < high { middle } else { 0.5 * (low + high) };
            // Where branches cross, Newton's method ends a little before the point.
            let Some((state, _)) = self.step(from, middle) else { break };
            let value = test(&state);
            last = Some((middle, state));
            if value == 0.0 || high - low < 1e-13 * length {
                break;
            }
            if value * at_low > 0.0 {
                (low, at_low) = (middle, value);
                if kept > 0 {
                    at_high *= 0.5;
                }
                kept = 1;
            } else {
                (high, at_high) = (middle, value);
                if kept < 0 {
                    at_low *= 0.5;
                }
                kept = -1;
            }
            if value.abs() < 1e-14 * (test(from).abs() + 1e-300) {
                break;
            }
        }
        last
    }
}

/// Elimination with row pivots: the right side becomes the solution; with the determinant. Nothing where that is zero.
fn solve(matrix: &mut [f64], right: &mut [f64]) -> Option<f64> {
    let n = right.len();
    let mut determinant = 1.0;
    for k in 0..n {
        let size = |i: &usize| matrix[i * n + k].abs();
        let pivot = (k..n).max_by(|i, j| size(i).total_cmp(&size(j)))?;
        if pivot != k {
            (0..n).for_each(|j| matrix.swap(k * n + j, pivot * n + j));
            right.swap(k, pivot);
            determinant = -determinant;
        }
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let row = &above[k * n..];
        if row[k] == 0.0 {
            return None;
        }
        determinant *= row[k];
        for (i, other) in (k + 1..n).zip(below.chunks_exact_mut(n)) {
            let factor = other[k] / row[k];
            other[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(x, y)| *x -= factor * y);
            right[i] -= factor * right[k];
        }
    }
    for k in (0..n).rev() {
        let row = &matrix[k * n..(k + 1) * n];
        let known: f64 = row[k + 1..].iter().zip(&right[k + 1..]).map(|(x, y)| x * y).sum();
        right[k] = (right[k] - known) / row[k];
    }
    Some(determinant)
}

/// Whether the pair of exponents with the smallest sum is complex.
fn oscillates(exponents: &[Complex<f64>]) -> bool {
    let pairs = exponents.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| exponents[..i].iter().map(move |b| (*a, *b)));
    let least = pairs.min_by(|(a, b), (c, d)| (a + b).norm().total_cmp(&(c + d).norm()));
    least.is_some_and(|(a, _)| a.im.abs() > 1e-6 * a.norm() && a.im != 0.0)
}
