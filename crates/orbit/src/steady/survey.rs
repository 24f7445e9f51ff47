//! Response curves: all branches of steady states over one parameter that pass a list of its values.
//!
//! At every value all states of a box are found, with proof of their number; each that no branch passes yet starts
//! one. A closed branch (an isola) between the values has folds where the parameter is least and largest on it: for one complex
//! unknown these are looked for themselves, as zeros of G and det G_w in the box and the range.

use super::System;
use super::balance::Balance;
use super::branch::{Branch, Course, Point, follow};
use super::flow::{Change, Flow};
use super::krawczyk::{Zero, newton};
use super::quiet::all_states;
use super::search::{Found, Limits, Places, modulus, zeros_at};
use super::value::Value;
use lindstedt_number::Exact;
use lindstedt_number::interval::Interval;
use nalgebra::DMatrix;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Survey<'a> {
    /// The vector field.
    pub flow: &'a Flow,
    /// The values of its parameters, in order; nothing for the one that varies, [`Course::parameter`].
    pub values: Vec<Option<Value>>,
    /// The values at which all states are looked for.
    pub samples: Vec<Exact>,
    /// The range, the reach (the half sides of the box) and the step.
    pub course: Course,
    /// Of each search.
    pub limits: Limits,
}

/// A change on a branch.
#[derive(Clone, Debug)]
pub struct Located {
    /// Which.
    pub change: Change,
    /// The index of the branch.
    pub branch: usize,
    /// The unknowns and the parameter.
    pub at: Vec<f64>,
    /// The same with proof, with the vectors that belong to it; of a crossing an enclosure, if it is one.
    pub proved: Option<Zero>,
}

impl Located {
    /// Whether this may be a crossing itself, seen from beside it: a branch that is born of another one turns where they cross, and
    /// continuation steps over to the other one there; the equations of a fold are singular, so that none is proved. `same` says
    /// whether two states are one within a distance.
    pub fn is_part_of(
        &self,
        crossing: &Self,
        course: &Course,
        same: impl Fn(&[f64], &[f64], f64) -> bool,
    ) -> bool {
        let wide = course.range[1] - course.range[0];
        let (Some((value, state)), Some((other, place))) =
            (self.at.split_last(), crossing.at.split_last())
        else {
            return false;
        };
        matches!(self.change, Change::Fold | Change::Crossing)
            && self.proved.is_none()
            && same(state, place, PITCHFORK * course.reach)
            && (value - other).abs() < PITCHFORK.powi(2) * wide
    }
}

/// The branches.
#[derive(Clone, Debug)]
pub struct Response {
    /// The branches.
    pub branches: Vec<Branch>,
    /// Where states change.
    pub changes: Vec<Located>,
    /// The states at the samples.
    pub searches: Vec<(Exact, Found)>,
    /// Whether it is proved that no closed branch in the box and the range is missing.
    pub no_closed_missing: bool,
    /// The boxes looked at for that.
    pub boxes: usize,
}

/// Boxes looked at for folds.
const MOST_BOXES: usize = 50_000;
/// Points this near in all unknowns, in parts of the reach, are the same.
const NEAR: f64 = 1e-4;
/// Changes this near to a crossing, in parts of the reach and in its square of the range, are the crossing's own unless proved.
const PITCHFORK: f64 = 0.03;
/// Where branches cross the derivative by all variables loses rank: the smallest of its singular values, in parts of the largest.
const SINGULAR: f64 = 1e-2;
/// A divergence that is zero, in parts of the derivative.
const FLAT: f64 = 1e-9;

impl Survey<'_> {
    /// The branches that pass the samples within the box. Nothing where `values` leaves other than one parameter open.
    /// Cost: a search per sample, and some Newton steps per point.
    #[must_use]
    pub fn run(&self) -> Option<Response> {
        let n = self.flow.unknowns();
        let open: Vec<usize> =
            (0..self.values.len()).filter(|i| self.values[*i].is_none()).collect();
        let [open] = open[..] else { return None };
        let course = Course { parameter: n, unknowns: n, ..self.course.clone() };
        let system = self.flow.system(&self.values);
        let mut response = Response {
            branches: Vec::new(),
            changes: Vec::new(),
            searches: Vec::new(),
            no_closed_missing: false,
            boxes: 0,
        };
        for sample in &self.samples {
            let mut values = self.values.clone();
            values[open] = Some(sample.into());
            let fixed = self.flow.system(&values);
            let found = all_states(self.flow, &values, course.reach, &self.limits)?;
            let value = sample.to_f64();
            for zero in &found.zeros {
                let known = |branch: &Branch| {
                    branch.points.windows(2).any(|two| {
                        let state = crossing(&two[0].at, &two[1].at, value);
                        let state = state.and_then(|guess| newton(&fixed, &guess));
                        state.is_some_and(|state| is_near(&state, zero, course.reach))
                    })
                };
                if response.branches.iter().any(known) {
                    continue;
                }
                let start: Vec<f64> = zero.middle().into_iter().chain([value]).collect();
                response.branches.extend(follow(&system, &start, &course));
            }
            response.searches.push((sample.clone(), found));
            if course.stop.asked() {
                break;
            }
        }
        if let Some(found) = self.between(&system, &course, &mut response.branches) {
            (response.no_closed_missing, response.boxes) = (found.is_proved(), found.boxes);
        }
        response.changes = self.changes(&response.branches);
        Some(response)
    }

    /// Adds the branches of folds that lie on none yet; nothing where folds are not looked for.
    fn between(
        &self,
        system: &System,
        course: &Course,
        branches: &mut Vec<Branch>,
    ) -> Option<Found> {
        let turning = self.flow.turning(&self.values)?;
        let range = Interval::new(course.range[0], course.range[1]);
        let mut region = vec![Interval::new(-course.reach, course.reach); self.flow.unknowns()];
        region.push(range);
        let boxes = self.limits.boxes.min(MOST_BOXES);
        let limits = Limits { boxes, modulus: None, ..self.limits.clone() };
        let moduli = vec![Interval::new(0.0, modulus(&region[..region.len() - 1]).high()), range];
        let (places, cells) = Balance::of_folds(self.flow, &self.values)
            .map_or((Places::Anywhere, 0), |balance| balance.places(moduli, &limits));
        let mut found = zeros_at(&turning, &region, &places, &limits)?;
        found.boxes += cells;
        let mut followed = true;
        for fold in found.zeros.iter().map(Zero::middle) {
            let is_here = |point: &Point| {
                point.change == Some(Change::Fold) && near(&point.at, &fold, course.reach)
            };
            if branches.iter().flat_map(|branch| &branch.points).any(is_here) {
                continue;
            }
            // From the fold itself it is not clear on which side of it a branch starts.
            let from = follow(system, &fold, course);
            let from = from.and_then(|branch| branch.points.get(branch.points.len() / 2).cloned());
            let branch = from.and_then(|point| follow(system, &point.at, course));
            followed &= branch.is_some();
            branches.extend(branch);
        }
        // A fold that no branch passes leaves its box open.
        if !followed {
            found.undecided.push(region);
        }
        Some(found)
    }

    /// What is marked on the branches: of several marks of one crossing that where the derivative is nearest to losing rank.
    fn changes(&self, branches: &[Branch]) -> Vec<Located> {
        let marked = branches.iter().enumerate().flat_map(|(index, branch)| {
            branch.points.iter().filter_map(move |point| Some((index, point, point.change?)))
        });
        let found = marked.map(|it| located(self.flow, &self.values, self.course.reach, it));
        let (crossings, mut list): (Vec<_>, Vec<_>) =
            found.partition(|it| it.change == Change::Crossing);
        let system = self.flow.system(&self.values);
        let loss =
            |it: &Located| if it.proved.is_some() { 0.0 } else { self.rank(&system, &it.at) };
        let mut crossings: Vec<_> = crossings.into_iter().map(|it| (loss(&it), it)).collect();
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut known: Vec<Located> = Vec::new();
        for (_, found) in crossings.into_iter().filter(|(loss, _)| *loss < SINGULAR) {
            // Each of two branches knows their crossing.
            let same = |other: &Located| {
                near(&other.at, &found.at, self.course.reach)
                    || found.is_part_of(other, &self.course, is_within)
            };
            if !known.iter().any(same) {
                known.push(found);
            }
        }
        list.retain(|it| match it.change {
            Change::Hopf => !self.conserves_area(&system, &it.at),
            _ => !known.iter().any(|other| it.is_part_of(other, &self.course, is_within)),
        });
        list.append(&mut known);
        list.sort_by(|a, b| a.at[a.at.len() - 1].total_cmp(&b.at[b.at.len() - 1]));
        list
    }

    /// The smallest singular value of the derivative by all variables, each in its unit, in parts of the largest.
    fn rank(&self, system: &System, at: &[f64]) -> f64 {
        let (n, [low, high]) = (at.len() - 1, self.course.range);
        let (_, slopes) = system.derivatives(at);
        let unit = |j: usize| if j < n { self.course.reach } else { high - low };
        let scaled = DMatrix::from_fn(n, n + 1, |i, j| slopes[i * (n + 1) + j] * unit(j));
        let values = scaled.singular_values();
        values.min() / values.max()
    }

    /// Whether a flow of two unknowns has the divergence zero everywhere at this value of the parameter: then a pair of exponents on
    /// the axis is that of a centre, of which no oscillation of one size is born.
    fn conserves_area(&self, system: &System, at: &[f64]) -> bool {
        let [_, _, value] = at[..] else { return false };
        let parts = [-0.9, -0.35, 0.2, 0.75];
        let places = parts.iter().flat_map(|x| parts.iter().map(move |y| [*x, *y]));
        places.into_iter().all(|[x, y]| {
            let reach = self.course.reach;
            let (_, slopes) = system.derivatives(&[reach * x, reach * y, value]);
            let size = [0, 1, 3, 4].iter().fold(0.0f64, |m, k| m.max(slopes[*k].abs()));
            (slopes[0] + slopes[4]).abs() <= FLAT * size
        })
    }
}

/// Whether two points are the same within a part of the reach.
fn near(a: &[f64], b: &[f64], reach: f64) -> bool {
    is_within(a, b, NEAR * reach)
}

/// Whether two points are the same within a distance, unknown by unknown.
fn is_within(a: &[f64], b: &[f64], distance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < distance)
}

/// A change that was found on a branch, with proof if there is one.
pub(super) fn located(
    flow: &Flow,
    values: &[Option<Value>],
    reach: f64,
    (branch, point, mut change): (usize, &Point, Change),
) -> Located {
    let proof = |change| flow.change_near(change, values, &point.at);
    let (mut at, mut proved) = (point.at.clone(), None);
    if change != Change::Crossing {
        proved = proof(change);
    }
    // Where branches cross one of them may turn back; and continuation ends a little before the point.
    if matches!(change, Change::Fold | Change::Crossing)
        && proved.is_none()
        && let Some(zero) = proof(Change::Crossing)
        && near(&zero.middle()[..at.len()], &at, reach)
    {
        (change, at) = (Change::Crossing, zero.middle()[..at.len()].to_vec());
        proved = Some(zero);
    }
    Located { change, branch, at, proved }
}

/// The unknowns between two points where the parameter, their last entry, has a value.
pub(super) fn crossing(a: &[f64], b: &[f64], value: f64) -> Option<Vec<f64>> {
    let ((last_a, a), (last_b, b)) = (a.split_last()?, b.split_last()?);
    if (last_a - value) * (last_b - value) > 0.0 {
        return None;
    }
    let share = if last_a == last_b { 0.0 } else { (value - last_a) / (last_b - last_a) };
    Some(a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect())
}

fn is_near(state: &[f64], zero: &Zero, reach: f64) -> bool {
    is_within(&zero.middle(), state, 1e-7 * reach)
}
