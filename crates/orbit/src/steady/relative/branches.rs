//! Branches of motions, followed by w and the rate of the free phase.

use super::super::branch::follow;
use super::super::krawczyk::newton;
use super::super::survey::{Located, crossing, located};
use super::super::{
    Branch, Change, ComplexTerm, Course, Flow, Point, Polynomial, System, Value, Zero,
};
use super::{FreePhase, Turning, square, square_of};
use rug::Rational;

/// Motions with so small a part of the largest amplitude of a branch are not told from rest.
const NEAR_REST: f64 = 2e-3;
/// An amplitude that is zero, in parts of the reach.
const SMALL: f64 = 1e-6;

impl FreePhase {
    /// G_j - (i d_j delta + beta E_j) w_j, Im w_c, and of families the condition of the energy, in w, delta (and beta): all of them
    /// vanish at motions, isolated where w_c is not zero.
    fn unfolded(&self, c: usize) -> Flow {
        let extra = 1 + usize::from(self.energy.is_some());
        let equation = |j: usize| -> Vec<ComplexTerm> {
            let shifted = |term: &ComplexTerm| ComplexTerm {
                parameters: vec![0; extra].into_iter().chain(term.parameters.clone()).collect(),
                ..term.clone()
            };
            let mut amplitudes = vec![0; 4];
            amplitudes[2 * j] = 1;
            let turn = ComplexTerm {
                amplitudes: amplitudes.clone(),
                parameters: vec![1],
                re: Rational::new(),
                im: Rational::from(-&self.weights[j]),
                radius: 0.0,
            };
            let energy = self.energy.iter().flat_map(|energy| &energy[j].terms);
            let growth = energy.map(|(exponents, c)| ComplexTerm {
                amplitudes: amplitudes.clone(),
                parameters: [0, 1].into_iter().chain(exponents.iter().copied()).collect(),
                re: Rational::from(-&c.middle),
                im: Rational::new(),
                radius: c.radius,
            });
            self.equations[j].iter().map(shifted).chain([turn]).chain(growth).collect()
        };
        let names: Vec<&str> = [""; 2][..extra]
            .iter()
            .copied()
            .chain(self.parameters.iter().map(String::as_str))
            .collect();
        let mut rows = Flow::of_complex(&[equation(0), equation(1)], &names).rows;
        rows.push(Polynomial::variable(2 * c + 1));
        let squares = [0, 1].map(square_of);
        let size = self.measure().map(|e| self.size(&e, 4 + extra, squares.each_ref()));
        rows.extend(size);
        Flow::of_rows(rows, self.parameters.clone())
    }

    /// The branches over the parameter without a value, [`Course::parameter`] counted among the parameters, that pass motions
    /// at values of it.
    #[must_use]
    pub fn branches(
        &self,
        values: &[Option<Value>],
        found: &[(Value, Vec<Vec<f64>>)],
        course: &Course,
    ) -> Vec<Turning> {
        let flow = self.flow().system(values);
        let mut raw: Vec<(Flow, Branch)> = Vec::new();
        for (value, motions) in found {
            let at = value.interval().middle();
            let mut fixed = values.to_vec();
            fixed[course.parameter] = Some(value.clone());
            for motion in motions {
                let known = |(own, branch): &(Flow, Branch)| {
                    let (system, n) = (own.system(&fixed), own.unknowns());
                    let is_here = |guess: Vec<f64>| {
                        let found = newton(&system, &guess);
                        found.is_some_and(|it| self.same(&it[..4], motion, 1e-7 * course.reach))
                    };
                    // An end of the range is met within rounding.
                    let wide = course.range[1] - course.range[0];
                    let at_end = |point: &&Point| (point.at[n] - at).abs() < 1e-9 * wide;
                    let ends = [branch.points.first(), branch.points.last()];
                    let mut ends = ends.into_iter().flatten().filter(at_end);
                    let mut pairs = branch.points.windows(2);
                    ends.any(|end| is_here(end.at[..n].to_vec()))
                        || pairs
                            .any(|two| crossing(&two[0].at, &two[1].at, at).is_some_and(is_here))
                };
                if raw.iter().any(known) || course.stop.asked() {
                    continue;
                }
                let point: Vec<f64> = motion.iter().copied().chain([at]).collect();
                raw.extend(self.branch(&flow, values, &point, course));
            }
        }
        let reach = course.reach;
        let all = raw.into_iter().enumerate();
        all.map(|(k, (own, branch))| self.turning(&flow, (&own, values), k, branch, reach))
            .collect()
    }

    /// The branch through a motion in w, delta (and beta), with the equations it was followed by: that of the w_c that stays away
    /// from zero along it.
    fn branch(
        &self,
        flow: &System,
        values: &[Option<Value>],
        point: &[f64],
        course: &Course,
    ) -> Option<(Flow, Branch)> {
        let moduli = [0, 1].map(|j| square(point, j).sqrt());
        let first = usize::from(moduli[1] > moduli[0]);
        let mut best: Option<(f64, (Flow, Branch))> = None;
        for c in [first, 1 - first].into_iter().filter(|c| moduli[*c] > SMALL * course.reach) {
            let own = self.unfolded(c);
            let n = own.unknowns();
            let angle = -point[2 * c + 1].atan2(point[2 * c]) / self.weights[c].to_f64();
            let turned = |j: usize| {
                let (sin, cos) = (angle * self.weights[j].to_f64()).sin_cos();
                [
                    point[2 * j] * cos - point[2 * j + 1] * sin,
                    point[2 * j] * sin + point[2 * j + 1] * cos,
                ]
            };
            let mut start = [turned(0), turned(1)].concat();
            start.push(self.drift(flow, point).0);
            start.resize(n, 0.0);
            start.push(point[4]);
            let unknowns = if self.energy.is_some() { 0 } else { 4 };
            let course = Course { parameter: n, unknowns, ..course.clone() };
            let Some(branch) = follow(&own.system(values), &start, &course) else { continue };
            let branch = beside_rest(branch, &start);
            let size = |point: &Point| point.at[2 * c].abs();
            let least = branch.points.iter().map(size).fold(f64::INFINITY, f64::min);
            if best.as_ref().is_none_or(|(other, _)| least > *other) {
                best = Some((least, (own, branch)));
            }
            if least > 0.05 * course.reach {
                break;
            }
        }
        best.map(|(_, found)| found)
    }

    /// Whether all E_j w_j vanish at a point of a branch: no condition is left that beta = 0.
    fn is_level(&self, own: &Flow, values: &[Option<Value>], at: &[f64]) -> bool {
        let Some(energy) = &self.energy else { return false };
        let open = at[own.unknowns()..].iter().map(|s| Rational::from_f64(*s).map(Value::Rational));
        let mut open = open;
        let given: Vec<_> =
            values.iter().map(|value| value.clone().or_else(|| open.next().flatten())).collect();
        let rows = System::new(energy, &given).values(&[] as &[f64]);
        let slope: f64 = (0..2).map(|j| rows[j].powi(2) * square(at, j)).sum();
        let most =
            rows.iter().fold(0.0f64, |m, e| m.max(e.powi(2))) * (square(at, 0) + square(at, 1));
        slope <= SMALL.powi(2) * most
    }

    /// A branch in w alone.
    fn turning(
        &self,
        flow: &System,
        (own, values): (&Flow, &[Option<Value>]),
        index: usize,
        mut branch: Branch,
        reach: f64,
    ) -> Turning {
        let (mut rates, mut changes) = (Vec::new(), Vec::new());
        for point in &mut branch.points {
            let unfolded = point.clone();
            shorten(&mut point.at, own.unknowns());
            let (delta, exponents) = self.drift(flow, &point.at);
            point.exponents = exponents;
            rates.push(delta);
            // The exponent 0 along the phase makes the sum with another vanish at folds.
            point.change = point.change.filter(|it| *it != Change::Hopf || oscillates(point));
            let Some(change) = point.change else { continue };
            let found = match change {
                Change::Hopf => Located { change, branch: index, at: unfolded.at, proved: None },
                _ => located(own, values, reach, (index, &unfolded, change)),
            };
            // Noise beside a degenerate motion is no crossing; nor is one where the energy has no slope, so that beta is free.
            let is_crossing = found.change == Change::Crossing;
            if is_crossing && (found.proved.is_none() || self.is_level(own, values, &found.at)) {
                continue;
            }
            let mut found = found;
            shorten(&mut found.at, own.unknowns());
            let shortened = |mut zero: Zero| {
                shorten(&mut zero.enclosure, own.unknowns());
                shorten(&mut zero.unique_within, own.unknowns());
                zero
            };
            found.proved = found.proved.map(shortened);
            changes.push(found);
        }
        Turning { branch, rates, changes }
    }
}

/// A branch followed through rest goes on as the same motions, -w in the place of w, so that rest looks like a fold; and at rest
/// every delta solves the equations, so that the curve is lost. The part of it, from rest to rest, that has a point.
fn beside_rest(branch: Branch, start: &[f64]) -> Branch {
    let size = |point: &Point| point.at[..4].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let most = branch.points.iter().map(size).fold(0.0, f64::max);
    let is_rest = |point: &Point| size(point) < NEAR_REST * most;
    let cut = |a: &Point, b: &Point| is_rest(a) || is_rest(b);
    let Branch { mut points, mut closed, complete } = branch;
    let mut cuts = points.windows(2);
    if let Some(first) = cuts.position(|two| cut(&two[0], &two[1])).filter(|_| closed) {
        points.pop();
        points.rotate_left(first + 1);
        closed = false;
    }
    let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
    for mut point in points {
        let part =
            parts.last_mut().filter(|part| part.last().is_none_or(|last| !cut(last, &point)));
        match part {
            Some(part) => part.push(point),
            None => {
                // The turn of the parameter at rest is no fold.
                point.change = None;
                parts
                    .last_mut()
                    .and_then(|part| part.last_mut())
                    .into_iter()
                    .for_each(|it| it.change = None);
                parts.push(vec![point]);
            }
        }
    }
    let away =
        |point: &Point| point.at.iter().zip(start).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    let nearest = |part: &Vec<Point>| part.iter().map(away).fold(f64::INFINITY, f64::min);
    let points = parts.into_iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
    Branch { points: points.unwrap_or_default(), closed, complete }
}

/// w and the parameter, of w, delta (beta), the parameter.
fn shorten<T>(all: &mut Vec<T>, unknowns: usize) {
    all.drain(4..unknowns);
    all.truncate(5);
}

/// Whether exponents lie on the imaginary axis, not at 0.
fn oscillates(point: &Point) -> bool {
    let size = point.exponents.iter().fold(0.0f64, |m, x| m.max(x.norm()));
    point.exponents.iter().any(|x| x.re.abs() < 1e-6 * size && x.im.abs() > 1e-6 * size)
}
