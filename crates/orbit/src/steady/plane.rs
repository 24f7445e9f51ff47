//! Two parameters: curves of folds and of Hopf points, cusps and Bogdanov-Takens points.

use super::branch::{Branch, Course, follow};
use super::flow::{Change, Flow};
use super::krawczyk::{Zero, newton};
use super::search::Limits;
use super::survey::{Located, Survey};
use super::value::Value;
use lindstedt_number::Exact;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Plane<'a> {
    /// The vector field.
    pub flow: &'a Flow,
    /// The values of its parameters; nothing for two.
    pub values: Vec<Option<Value>>,
    /// The indices of these two.
    pub open: [usize; 2],
    /// The values of each at which branches over the other are followed.
    pub samples: [Vec<Exact>; 2],
    /// The range of the first parameter, the reach and the step.
    pub course: Course,
    /// The range of the second.
    pub second: [f64; 2],
    /// Of each search.
    pub limits: Limits,
}

/// A curve in the plane of the parameters; a point has w, then the two parameters in the order of the flow.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Of folds or of Hopf points.
    pub change: Change,
    /// Its points.
    pub branch: Branch,
}

/// The curves with the points on them.
#[derive(Clone, Debug, Default)]
pub struct Diagram {
    /// The curves.
    pub curves: Vec<Curve>,
    /// Cusps and Bogdanov-Takens points, proved.
    pub corners: Vec<(Change, Zero)>,
}

impl Plane<'_> {
    /// The curves that pass the values of one of the parameters; those of states that differ by their phases alone, as a
    /// symmetry of the flow makes them, once. Nothing where other parameters than the two are open. Cost: a survey per value,
    /// and some Newton steps per point.
    #[must_use]
    pub fn run(&self) -> Option<Diagram> {
        let mut diagram = Diagram::default();
        let mut vectors = Vec::new();
        let ranges = self.ranges();
        for (held, moves) in [(1, 0), (0, 1)] {
            for sample in &self.samples[held] {
                let mut values = self.values.clone();
                values[self.open[held]] = Some(sample.into());
                let survey = Survey {
                    flow: self.flow,
                    values,
                    samples: self.samples[moves].clone(),
                    course: Course { range: ranges[moves], ..self.course.clone() },
                    limits: self.limits.clone(),
                };
                for change in survey.run()?.changes {
                    self.through(&change, (held, sample), &mut vectors, &mut diagram);
                }
                if self.course.stop.asked() {
                    return Some(diagram);
                }
            }
        }
        Some(diagram)
    }

    /// The places of the two parameters among the variables of a curve.
    #[must_use]
    pub fn places(&self) -> [usize; 2] {
        let n = self.flow.unknowns();
        if self.open[0] < self.open[1] { [n, n + 1] } else { [n + 1, n] }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [self.course.range, self.second]
    }

    /// Follows the curve through a point unless it is known; of every curve the vector of its conditions is kept.
    fn through(
        &self,
        point: &Located,
        (held, sample): (usize, &Exact),
        vectors: &mut Vec<Vec<f64>>,
        diagram: &mut Diagram,
    ) -> Option<()> {
        if point.change == Change::Crossing {
            return None;
        }
        let n = self.flow.unknowns();
        let mut start = point.proved.as_ref()?.middle();
        start.insert(self.places()[held], sample.to_f64());
        let mut known = diagram.curves.iter().zip(&*vectors);
        if known.any(|(curve, l)| self.passes((curve, l), (held, sample), point.change, &start)) {
            return None;
        }
        let vector = &start[n + 2..2 * n + 2];
        let square: f64 = vector.iter().map(|x| x * x).sum();
        let l: Vec<f64> = vector.iter().map(|x| x / square).collect();
        let system = self.flow.conditions(point.change, &self.values, &l)?;
        let [first, second] = self.ranges();
        let swapped = self.places()[0] > n;
        let [range, other] = if swapped { [second, first] } else { [first, second] };
        let course = Course {
            parameter: n,
            unknowns: n,
            range,
            second: Some((n + 1, other)),
            // Beyond a Bogdanov-Takens point a curve of Hopf points runs back with the opposite rate.
            positive: (point.change == Change::Hopf).then_some(3 * n + 2),
            ..self.course.clone()
        };
        let branch = self.once(follow(&system, &start, &course)?);
        if point.change == Change::Fold {
            self.corners(&branch, diagram);
        }
        diagram.curves.push(Curve { change: point.change, branch });
        vectors.push(l);
        Some(())
    }

    fn corners(&self, folds: &Branch, diagram: &mut Diagram) {
        let n = self.flow.unknowns();
        for (change, zero) in self.flow.on_folds(&self.values, folds) {
            let same = |(other, known): &(Change, Zero)| {
                let parameters = (n..n + 2).map(|k| (known.enclosure[k], zero.enclosure[k]));
                let [a, b] = [known.middle(), zero.middle()];
                let moduli: Vec<_> = moduli(&a[..n]).zip(moduli(&b[..n])).collect();
                *other == change
                    && parameters.into_iter().all(|(a, b)| a.meet(b).is_some())
                    && moduli.into_iter().all(|(a, b)| (a - b).abs() < NEAR * self.course.reach)
            };
            let inside = |(place, [low, high]): (usize, [f64; 2])| {
                (low..=high).contains(&zero.enclosure[place].middle())
            };
            let inside = self.places().into_iter().zip(self.ranges()).all(inside);
            if inside && !diagram.corners.iter().any(same) {
                diagram.corners.push((change, zero));
            }
        }
    }

    /// Whether a curve passes a point with the same moduli, where one parameter has the value held: between two points of the curve
    /// on both sides of it Newton's method finds where.
    fn passes(
        &self,
        (curve, l): (&Curve, &[f64]),
        (held, sample): (usize, &Exact),
        change: Change,
        start: &[f64],
    ) -> bool {
        let n = self.flow.unknowns();
        let [place, other] = [held, 1 - held].map(|k| self.places()[k]);
        let widths = self.ranges().map(|[low, high]| high - low);
        let value = sample.to_f64();
        if curve.change != change {
            return false;
        }
        let mut values = self.values.clone();
        values[self.open[held]] = Some(sample.into());
        let Some(system) = self.flow.conditions(change, &values, l) else { return false };
        let same = |at: &[f64], near: f64| {
            moduli(&at[..n])
                .zip(moduli(&start[..n]))
                .all(|(a, b)| (a - b).abs() < near * self.course.reach)
                && (at[other] - start[other]).abs() < near * widths[1 - held]
        };
        curve.branch.points.windows(2).any(|two| {
            let [a, b] = [&two[0].at, &two[1].at];
            let [from, to] = [a[place] - value, b[place] - value];
            // A curve ends at the edge within rounding.
            if from.min(to) > 1e-9 * widths[held] || from.max(to) < -1e-9 * widths[held] {
                return false;
            }
            let share = if from == to { 0.5 } else { (from / (from - to)).clamp(0.0, 1.0) };
            let mut guess: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
            same(&guess, ROUGH) && {
                guess.remove(place);
                newton(&system, &guess).is_some_and(|mut found| {
                    found.insert(place, value);
                    same(&found, NEAR)
                })
            }
        })
    }

    /// The first half of a curve that comes back on itself with other phases, from an end that is its own image.
    fn once(&self, mut branch: Branch) -> Branch {
        let n = self.flow.unknowns();
        let places = self.places();
        let unit = |k: usize| match places.iter().position(|place| *place == k) {
            Some(which) => self.ranges()[which][1] - self.ranges()[which][0],
            None => self.course.reach,
        };
        let units: Vec<f64> = (0..n + 2).map(unit).collect();
        let scaled = |at: &[f64]| -> Vec<f64> {
            let of_state = moduli(&at[..n]).map(|a| a / self.course.reach);
            of_state.chain((n..n + 2).map(|k| at[k] / units[k])).collect()
        };
        let distance =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let images: Vec<Vec<f64>> = branch.points.iter().map(|point| scaled(&point.at)).collect();
        let mut lengths = vec![0.0];
        for two in images.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + distance(&two[0], &two[1]));
        }
        let whole = lengths[lengths.len() - 1];
        let at = |share: f64| lengths.partition_point(|length| *length < share * whole);
        let same = |share: f64| {
            let (i, j) = (at(share), at(1.0 - share));
            distance(&images[i], &images[j]) < 2.0 * self.course.step
        };
        if !branch.closed
            && distance(&images[0], &images[images.len() - 1]) < NEAR
            && whole > 8.0 * self.course.step
            && [0.1, 0.2, 0.3, 0.4].into_iter().all(same)
        {
            let half = at(0.5) + 1;
            branch.points.truncate(half);
        }
        branch
    }
}

/// |w_j|.
fn moduli(w: &[f64]) -> impl Iterator<Item = f64> {
    w.chunks(2).map(|pair| pair.iter().map(|x| x * x).sum::<f64>().sqrt())
}

/// Points this near in moduli and parameters, in parts of reach and range, are the same, ...
const NEAR: f64 = 1e-6;
/// ... and where two points of a curve are so far from another in the middle, it does not pass that.
const ROUGH: f64 = 0.05;
