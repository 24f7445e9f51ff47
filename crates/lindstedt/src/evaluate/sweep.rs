//! Period and frequency over one or two swept parameters.

use super::Evaluate;
use crate::grid::{Axis, Grid, check_room};
use crate::{Answer, Error, Exact, Kind, Number, Oscillator, Refusal, Remark, Standing, Work};
use serde::{Serialize, Serializer};
use std::time::Instant;

/// The period at one point; what has not one digit is nothing.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SweptPeriod {
    /// The period by resummation.
    pub period: Option<Number>,
    /// 2 pi over it.
    pub frequency: Option<Number>,
    /// The period by the closed form.
    pub exact_period: Option<Number>,
    /// The order of the expansion.
    #[serde(skip)]
    pub order: usize,
    /// The values that enter.
    #[serde(skip)]
    at: Vec<(String, Exact)>,
}

/// The period at every point, or why there is none.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EvaluationSweep {
    /// The points.
    pub grid: Grid<Result<SweptPeriod, Error>>,
}

impl Oscillator {
    /// Period and frequency at every point of one or two axes, each as by [`Oscillator::evaluate`], on all
    /// cores. A point that is refused keeps the reason; points that stopped work did not reach are empty. Where a point
    /// has not one digit the answer stands as [`Standing::Undecided`].
    ///
    /// # Errors
    /// Those of the first point, if no point has a value.
    ///
    /// ```
    /// use lindstedt::grid::Axis;
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::builtin("duffing")?;
    /// let question = Evaluate { order: Some(6), ..Evaluate::default() };
    /// let axis = Axis::parse("eps=0..1:3")?;
    /// let found = duffing.evaluate_sweep(&question, axis, None, &Work::default())?.value;
    /// assert!(found.grid.is_complete());
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn evaluate_sweep(
        &self,
        question: &Evaluate,
        columns: Axis,
        rows: Option<Axis>,
        work: &Work,
    ) -> Result<Answer<EvaluationSweep>, Error> {
        let start = Instant::now();
        let points = rows.as_ref().map_or(1, |rows| rows.values.len()) * columns.values.len();
        check_room(points, size_of::<Option<Result<SweptPeriod, Error>>>(), work)?;
        let mut grid: Grid<Result<_, Error>> =
            Grid::of_cases(self, columns, rows, work, |case, work| {
                let found = case.settled()?.0.period(question, work)?;
                let (period, frequency) = (found.period, found.frequency);
                let (exact_period, order, at) = (found.exact_period, found.order, found.at);
                Ok(SweptPeriod { period, frequency, exact_period, order, at })
            });
        let stopped = |error: &Error| error.kind() == Kind::Stopped;
        for point in &mut grid.points {
            point.take_if(|point| point.as_ref().is_err_and(stopped));
        }
        let found = || grid.points.iter().flatten();
        let first = found().find_map(|point| point.as_ref().ok());
        if let (None, Some(Err(error))) = (first, found().next()) {
            return Err(error.clone());
        }
        // What all points share: derived values may vary with those that are swept.
        let swept = |name: &str| grid.axes().any(|axis| axis.name == name);
        let shared = |pair| found().flatten().all(|point| point.at.contains(pair));
        let at = first.iter().flat_map(|point| &point.at);
        let at = at.filter(|pair| !swept(&pair.0) && shared(pair));
        let at = at.map(|(name, value)| (name.clone(), value.to_string())).collect();
        let with = found().filter(|point| matches!(point, Ok(point) if point.period.is_some()));
        let (done, without) = (grid.done(), grid.done() - with.count());
        let mut remarks = self.remarks().to_vec();
        if without > 0 {
            remarks.push(Remark(format!("{without} of {done} points have no period with a digit")));
        }
        let undecided = found().any(|point| match point {
            Ok(point) => point.period.is_none(),
            Err(error) => error.kind() == Kind::Undecided,
        });
        let standing = match grid.standing() {
            Standing::Complete if undecided => Standing::Undecided,
            standing => standing,
        };
        let header = self.header(at, first.map(|point| point.order), "resummation", start);
        Ok(Answer { header, value: EvaluationSweep { grid }, standing, remarks })
    }
}

impl Serialize for EvaluationSweep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Point<'a> {
            values: Vec<&'a Exact>,
            #[serde(flatten)]
            found: Option<&'a SweptPeriod>,
            #[serde(skip_serializing_if = "Option::is_none")]
            refused: Option<String>,
        }
        self.grid.serialize_with(serializer, |x, y, point| {
            let refused = point.and_then(|point| Some(point.as_ref().err()?.to_string()));
            let found = point.and_then(|point| point.as_ref().ok());
            Point { values: [x].into_iter().chain(y).collect(), found, refused }
        })
    }
}
