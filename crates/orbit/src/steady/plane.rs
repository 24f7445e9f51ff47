//! Two parameters: curves of folds and of Hopf points, cusps and Bogdanov-Takens points.

use super::branch::{Branch, Course, follow};
use super::flow::{Change, Flow};
use super::krawczyk::Zero;
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
    /// The indices of these two: along the branches, and across.
    pub open: [usize; 2],
    /// The values of the first at which states are looked for, and those of the second at which branches are followed.
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
    /// The curves that pass the values of the second parameter. Nothing where other parameters than the two are open.
    /// Cost: a survey per value, and some Newton steps per point.
    #[must_use]
    pub fn run(&self) -> Option<Diagram> {
        let mut diagram = Diagram::default();
        for sample in &self.samples[1] {
            let mut values = self.values.clone();
            values[self.open[1]] = Some(sample.into());
            let survey = Survey {
                flow: self.flow,
                values,
                samples: self.samples[0].clone(),
                course: self.course.clone(),
                limits: self.limits.clone(),
            };
            for change in survey.run()?.changes {
                self.through(&change, sample.to_f64(), &mut diagram);
            }
            if self.course.stop.asked() {
                break;
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

    /// Follows the curve through a point unless it is known.
    fn through(&self, point: &Located, sample: f64, diagram: &mut Diagram) -> Option<()> {
        if point.change == Change::Crossing {
            return None;
        }
        let n = self.flow.unknowns();
        let [along, across] = self.places();
        let mut start = point.proved.as_ref()?.middle();
        start.insert(across, sample);
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < NEAR * self.course.reach;
        let passes = |two: &[super::Point]| {
            let [a, b] = [&two[0].at, &two[1].at];
            let share = (sample - a[across]) / (b[across] - a[across]);
            let place: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
            (0.0..=1.0).contains(&share) && place.iter().zip(&start).take(n).all(near)
        };
        let known = |curve: &Curve| {
            curve.change == point.change && curve.branch.points.windows(2).any(passes)
        };
        if diagram.curves.iter().any(known) {
            return None;
        }
        let vector = &start[n + 2..2 * n + 2];
        let square: f64 = vector.iter().map(|x| x * x).sum();
        let l: Vec<f64> = vector.iter().map(|x| x / square).collect();
        let system = self.flow.conditions(point.change, &self.values, &l)?;
        let course = Course {
            parameter: along,
            unknowns: n,
            second: Some((across, self.second)),
            ..self.course.clone()
        };
        let branch = follow(&system, &start, &course)?;
        if point.change == Change::Fold {
            for (change, zero) in self.flow.on_folds(&self.values, &branch) {
                let same = |(other, known): &(Change, Zero)| {
                    let pairs = known.enclosure.iter().zip(&zero.enclosure).take(n + 2);
                    *other == change && pairs.into_iter().all(|(a, b)| a.meet(*b).is_some())
                };
                let inside = zero.enclosure[across].middle();
                if (self.second[0]..=self.second[1]).contains(&inside)
                    && !diagram.corners.iter().any(same)
                {
                    diagram.corners.push((change, zero));
                }
            }
        }
        diagram.curves.push(Curve { change: point.change, branch });
        Some(())
    }
}

/// Curves this near in all unknowns, in parts of the reach, are the same.
const NEAR: f64 = 1e-2;
