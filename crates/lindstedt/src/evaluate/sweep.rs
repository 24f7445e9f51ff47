//! Period and frequency over one or two swept parameters.

use super::Evaluate;
use crate::grid::{Axis, Grid};
use crate::{Answer, Error, Exact, Number, Oscillator, Remark, Standing, Work};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::time::Instant;

/// The period at one point; what has not one digit is nothing.
#[derive(Clone, Debug, Serialize)]
pub struct SweptPeriod {
    /// The period by resummation.
    pub period: Option<Number>,
    /// 2 pi over it.
    pub frequency: Option<Number>,
    /// The period by the closed form.
    pub exact_period: Option<Number>,
}

/// The period at every point, or why there is none.
#[derive(Clone, Debug)]
pub struct EvaluationSweep {
    /// The points.
    pub grid: Grid<Result<SweptPeriod, String>>,
}

impl Oscillator {
    /// Period and frequency at every point of one or two axes, each as by [`Oscillator::evaluate`], on all
    /// cores. A point that is refused keeps the reason; points that stopped work did not reach are empty.
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
        let names = [Some(columns.name.clone()), rows.as_ref().map(|axis| axis.name.clone())];
        let silent = Work { progress: None, ..work.clone() };
        let point = |x: &Exact, y: Option<&Exact>| {
            let values = [Some(x), y].into_iter().zip(&names);
            let pairs = values.filter_map(|(value, name)| Some((name.as_deref()?, value?.clone())));
            let case = pairs.fold(self.clone(), |case, (name, value)| case.with(name, value));
            let (case, _) = case.settled()?;
            case.period(question, &silent)
        };
        let grid = Grid::compute(columns, rows, work, point);
        let order = grid.points.iter().flatten().find_map(|found| Some(found.as_ref().ok()?.order));
        let plain = |found: Result<super::Evaluation, Error>| match found {
            Ok(found) => Ok(SweptPeriod {
                period: found.period,
                frequency: found.frequency,
                exact_period: found.exact_period,
            }),
            Err(error) => Err(error),
        };
        let (done, complete) = (grid.done(), grid.is_complete());
        let mut points = Vec::with_capacity(grid.points.len());
        let mut refused: Option<Error> = None;
        let mut without = 0;
        for found in grid.points {
            let found = found.map(plain);
            without += usize::from(!matches!(&found, Some(Ok(found)) if found.period.is_some()));
            points.push(found.map(|found| {
                found.map_err(|error| {
                    let text = error.to_string();
                    refused.get_or_insert(error);
                    text
                })
            }));
        }
        if let Some(error) = refused.filter(|_| order.is_none()) {
            return Err(error);
        }
        let mut remarks = self.remarks().to_vec();
        if without > 0 {
            let all = points.len();
            remarks.push(Remark(format!("{without} of {all} points have no period with a digit")));
        }
        let standing = if complete { Standing::Complete } else { Standing::Stopped { done } };
        let grid = Grid { columns: grid.columns, rows: grid.rows, points };
        let header = self.header(self.given_text(), order, "resummation", start);
        Ok(Answer { header, value: EvaluationSweep { grid }, standing, remarks })
    }
}

#[derive(Serialize)]
struct Point<'a> {
    values: Vec<String>,
    #[serde(flatten)]
    found: Option<&'a SweptPeriod>,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<&'a str>,
}

impl<'a> Point<'a> {
    fn new(at: (&Exact, Option<&Exact>, Option<&'a Result<SweptPeriod, String>>)) -> Self {
        let (x, y, found) = at;
        let values = std::iter::once(x).chain(y).map(ToString::to_string).collect();
        let refused = found.and_then(|found| found.as_ref().err()).map(String::as_str);
        Self { values, found: found.and_then(|found| found.as_ref().ok()), refused }
    }
}

impl Serialize for EvaluationSweep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let points: Vec<Point<'_>> = self.grid.iter().map(Point::new).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("columns", &self.grid.columns)?;
        map.serialize_entry("rows", &self.grid.rows)?;
        map.serialize_entry("points", &points)?;
        map.end()
    }
}
