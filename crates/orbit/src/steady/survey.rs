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

    fn changes(&self, branches: &[Branch]) -> Vec<Located> {
        let marked = branches.iter().enumerate().flat_map(|(index, branch)| {
            branch.points.iter().filter_map(move |point| Some((index, point, point.change?)))
        });
        let mut list: Vec<Located> = Vec::new();
        for (branch, point, change) in marked {
            let found =
                located(self.flow, &self.values, self.course.reach, (branch, point, change));
            let (change, at) = (found.change, &found.at);
            let same =
                |known: &Located| known.change == change && near(&known.at, at, self.course.reach);
            // Each of two branches knows their crossing.
            if change == Change::Crossing && list.iter().any(same) {
                continue;
            }
            list.push(found);
        }
        list.sort_by(|a, b| a.at[a.at.len() - 1].total_cmp(&b.at[b.at.len() - 1]));
        list
    }
}

/// Whether two points are the same within a part of the reach.
fn near(a: &[f64], b: &[f64], reach: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < NEAR * reach)
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
    zero.middle().iter().zip(state).all(|(a, b)| (a - b).abs() < 1e-7 * reach)
}
