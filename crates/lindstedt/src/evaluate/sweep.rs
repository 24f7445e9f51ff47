//! Over one or two swept parameters: the period and 2 pi over it, or the averaged rates a' and psi' at a start.

use super::Evaluate;
use super::averaged::AveragedMotion;
use super::setting::Known;
use crate::grid::{Axis, Grid, check_room};
use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Kind, Number, Oscillator, Refusal, Remark, Standing, Work};
use serde::{Serialize, Serializer};
use std::time::Instant;

/// What is computed at one point of a sweep.
pub trait SweptPoint: Serialize + Send {
    /// How it is computed.
    const TIER: &'static str;
    /// What a point without a value has not.
    const WITHOUT: &'static str;
    /// The order of the expansion.
    fn order(&self) -> usize;
    /// The values that enter.
    fn at(&self) -> &[(String, Exact)];
    /// Whether there is a digit.
    fn has_value(&self) -> bool;
}

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

impl SweptPoint for SweptPeriod {
    const TIER: &'static str = "resummation";
    const WITHOUT: &'static str = "no period with a digit";

    fn order(&self) -> usize {
        self.order
    }

    fn at(&self) -> &[(String, Exact)] {
        &self.at
    }

    fn has_value(&self) -> bool {
        self.period.is_some()
    }
}

/// The averaged rates at the start, one point of a sweep; what has not one digit is nothing.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SweptRates {
    /// a at the start.
    pub amplitude: f64,
    /// a' there, estimated.
    pub amplitude_rate: Option<Number>,
    /// psi' there, estimated.
    pub phase_rate: Option<Number>,
    /// The order of the averaged series.
    #[serde(skip)]
    pub order: usize,
    /// The values that enter.
    #[serde(skip)]
    at: Vec<(String, Exact)>,
}

impl SweptPoint for SweptRates {
    const TIER: &'static str = "averaging";
    const WITHOUT: &'static str = "not both rates with a digit";

    fn order(&self) -> usize {
        self.order
    }

    fn at(&self) -> &[(String, Exact)] {
        &self.at
    }

    fn has_value(&self) -> bool {
        self.amplitude_rate.is_some() && self.phase_rate.is_some()
    }
}

/// What there is at every point, or why there is nothing.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Swept<P> {
    /// The points.
    pub grid: Grid<Result<P, Error>>,
}

/// Period and frequency over parameters.
pub type EvaluationSweep = Swept<SweptPeriod>;
/// The averaged rates over parameters.
pub type RatesSweep = Swept<SweptRates>;

impl Oscillator {
    /// Period and frequency at every point of one or two axes, each as by [`Oscillator::evaluate`], on all
    /// cores. A point that is refused keeps the reason; points that stopped work did not reach are empty. Where a point
    /// has not one digit the answer stands as [`Standing::Undecided`]. What differs in the
    /// value of the small parameter alone is derived once.
    ///
    /// # Errors
    /// Those of the first point, if no point has a value; [`Refused`] where both axes are one parameter.
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
        let known = Known::default();
        self.over(columns, rows, work, |case, work| {
            let case = case.settled()?.0;
            let setting = case.setting()?;
            // With powers put in every value has an equation of its own.
            let own = self.high_power()?.is_some();
            let setting = if own { setting } else { setting.sharing(&known) };
            let found = case.period_of(setting, question, work)?;
            let (period, frequency) = (found.period, found.frequency);
            let (exact_period, order, at) = (found.exact_period, found.order, found.at);
            Ok(SweptPeriod { period, frequency, exact_period, order, at })
        })
    }

    /// a' and psi' of the averaged motion at its start, at every point of one or two axes, each as by
    /// [`Oscillator::averaged_motion`]; times do not count. Points as in [`Oscillator::evaluate_sweep`].
    ///
    /// # Errors
    /// As [`Oscillator::evaluate_sweep`].
    ///
    /// ```
    /// use lindstedt::evaluate::averaged::AveragedMotion;
    /// use lindstedt::{Oscillator, Work, grid::Axis};
    /// let loops = Oscillator::builtin("vibro-impact")?;
    /// let axis = Axis::parse("A=0,1/10")?;
    /// let found = loops.averaged_sweep(&AveragedMotion::default(), axis, None, &Work::default())?;
    /// // Without the loop a' = -c a/2, c = 1/5, a = 1.
    /// let first = found.value.grid.points[0].as_ref().and_then(|point| point.as_ref().ok());
    /// let rate = first.and_then(|point| point.amplitude_rate.clone()).map(|rate| rate.decimal);
    /// assert!(rate.is_some_and(|rate| rate.starts_with("-0.1000")));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn averaged_sweep(
        &self,
        question: &AveragedMotion,
        columns: Axis,
        rows: Option<Axis>,
        work: &Work,
    ) -> Result<Answer<RatesSweep>, Error> {
        let question = AveragedMotion { times: None, ..question.clone() };
        self.over(columns, rows, work, |case, work| {
            let found = case.averaged_motion(&question, work)?;
            if let Standing::Stopped { .. } = found.standing {
                return Err(Refused::stopped("stopped before all orders", "").into());
            }
            let motion = found.value;
            let ([amplitude, _], [amplitude_rate, phase_rate]) =
                (motion.start, motion.rate_numbers);
            let (order, at) = (motion.order, motion.at);
            Ok(SweptRates { amplitude, amplitude_rate, phase_rate, order, at })
        })
    }

    /// A question asked at every point.
    fn over<P: SweptPoint>(
        &self,
        columns: Axis,
        rows: Option<Axis>,
        work: &Work,
        ask: impl Fn(&Self, &Work) -> Result<P, Error> + Sync,
    ) -> Result<Answer<Swept<P>>, Error> {
        let start = Instant::now();
        if rows.as_ref().is_some_and(|rows| rows.name == columns.name) {
            let message = format!("{} is swept twice", columns.name);
            return Err(Refused::usage("sweep", message, "two parameters, or one --sweep").into());
        }
        let points = rows.as_ref().map_or(1, |rows| rows.values.len()) * columns.values.len();
        check_room(points, size_of::<Option<Result<P, Error>>>(), work)?;
        let mut grid = Grid::of_cases(self, columns, rows, work, ask);
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
        let shared = |pair| found().flatten().all(|point| point.at().contains(pair));
        let at = first.iter().flat_map(|point| point.at());
        let at = at.filter(|pair| !swept(&pair.0) && shared(pair));
        let with = found().filter(|point| matches!(point, Ok(point) if point.has_value()));
        let (done, without) = (grid.done(), grid.done() - with.count());
        let mut remarks = self.remarks().to_vec();
        if without > 0 {
            remarks.push(Remark(format!("{without} of {done} points have {}", P::WITHOUT)));
        }
        let undecided = found().any(|point| match point {
            Ok(point) => !point.has_value(),
            Err(error) => error.kind() == Kind::Undecided,
        });
        let standing = match grid.standing() {
            Standing::Complete if undecided => Standing::Undecided,
            standing => standing,
        };
        let header = self.header(at.cloned(), first.map(SweptPoint::order), P::TIER, start);
        Ok(Answer { header, value: Swept { grid }, standing, remarks })
    }
}

impl<P: Serialize> Serialize for Swept<P> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Point<'a, P> {
            values: Vec<&'a Exact>,
            #[serde(flatten)]
            found: Option<&'a P>,
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
