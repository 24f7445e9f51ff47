//! What was measured, as plain data.

use super::{Method, Summation};
use crate::{Error, Number};
use lindstedt_equation::Problem;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// What [`Row::true_error`] and [`Row::stated_error`] are.
const ERRORS: &str = "relative errors of the period";
/// What [`Row::bytes`] is.
const MEMORY: &str = "estimated: numbers kept at once times their size";

/// The result of [`crate::Oscillator::trade`].
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Trade {
    /// The problem, whose equation is printed as a formula.
    #[serde(skip)]
    pub problem: Problem,
    /// The name of the small parameter.
    pub parameter: String,
    /// Its value in the series, exact where it is rational.
    pub small: String,
    /// The true period.
    pub period: String,
    /// Its relative error: rounding, the digits of a reference, the estimate of the integrator.
    pub period_error: f64,
    /// Its formula or source.
    pub source: String,
    /// The period by the contraction test, where it was proved.
    pub proved_period: Option<Number>,
    /// What the errors of the rows are.
    pub errors: &'static str,
    /// What the memory of the rows is.
    pub memory: &'static str,
    /// The time of a row is the least of so many runs.
    pub repeats: u32,
    /// The rows in the order of [`Method`], digits, order, summation.
    pub rows: Vec<Row>,
    /// The rows that no other row beats in both time and true error, from the fastest on.
    pub pareto: Vec<usize>,
    /// The runs that were not made, in the same order.
    pub left_out: Vec<LeftOut>,
    /// The rows recommended, where an error or a time was asked for.
    pub recommendation: Option<Recommendation>,
    /// Whether all runs were made.
    pub finished: bool,
}

impl Trade {
    /// Without rows.
    pub(super) fn begun(problem: &Problem, small: String, repeats: u32) -> Self {
        Self {
            problem: problem.clone(),
            parameter: problem.small.to_string(),
            small,
            period: String::new(),
            period_error: 0.0,
            source: String::new(),
            proved_period: None,
            errors: ERRORS,
            memory: MEMORY,
            repeats,
            rows: Vec::new(),
            pareto: Vec::new(),
            left_out: Vec::new(),
            recommendation: None,
            finished: true,
        }
    }
}

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The method.
    #[serde(flatten)]
    pub method: Method,
    /// The order of the series; nothing for the integrator.
    pub order: Option<usize>,
    /// How the series is summed; nothing for the integrator.
    #[serde(rename = "summed", serialize_with = "name")]
    pub summation: Option<Summation>,
    /// The time of the fastest run: derivation and summation, with the choice of the method.
    pub seconds: f64,
    /// The time for one more value of the small parameter: summing the series again by the same
    /// method; for the integrator the same as `seconds`.
    pub seconds_again: f64,
    /// Numbers kept at once times their size: an estimate of the memory in bytes.
    #[serde(rename = "memory_bytes")]
    pub bytes: u64,
    /// The period found: the digits that the stated error supports, and two more; without one, all.
    pub period: String,
    /// |period/T - 1|, up to [`Trade::period_error`].
    pub true_error: f64,
    /// The estimate of the relative error that the run gives without knowing T: of a sum that of
    /// the resummation, with what the errors of the coefficients make of it (four times the
    /// difference of two grids); four times the difference of two tolerances. Infinite where
    /// there is no estimate (too few orders, outside of the circle of convergence).
    pub stated_error: f64,
    /// |period/T - 1| is proved to be at most this: the distance from [`Trade::proved_period`] and the
    /// radius of that; nothing where that is not there.
    pub proved_error: Option<f64>,
    /// Whether the row is on the Pareto front.
    pub pareto: bool,
}

/// A run that was not made.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct LeftOut {
    /// The method.
    #[serde(flatten)]
    pub method: Method,
    /// The order.
    pub order: Option<usize>,
    /// Why.
    #[serde(serialize_with = "in_words")]
    pub reason: Reason,
}

/// Why a run was left out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// It took longer than so many seconds ([`super::Plan::run_seconds`]).
    #[error("longer than {0} s")]
    TooLong(f64),
    /// A lower order of the same method predicts so many seconds; infinitely many after one that was
    /// broken off.
    #[error("{}", predicted(*.0))]
    Predicted(f64),
    /// It was refused.
    #[error(transparent)]
    Refused(#[from] Error),
}

fn predicted(seconds: f64) -> String {
    match seconds {
        s if s.is_infinite() => "a lower order takes too long".to_owned(),
        s if s > 1e4 => "predicted to take hours".to_owned(),
        s => format!("predicted to take {s:.0} s"),
    }
}

fn name<S: Serializer>(by: &Option<Summation>, serializer: S) -> Result<S::Ok, S::Error> {
    by.map(Summation::name).serialize(serializer)
}

fn in_words<S: Serializer>(reason: &Reason, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(reason)
}

/// The rows for what was asked for.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Recommendation {
    /// The relative error asked for.
    pub error: Option<f64>,
    /// The time asked for.
    pub seconds: Option<f64>,
    /// The fastest row that states the error, if it is fast enough.
    pub row: Option<Row>,
    /// The same for one more value of the small parameter.
    pub for_many: Option<Row>,
    /// The row that states the least error in the time.
    pub within: Option<Row>,
    /// The fastest row that states an error at all.
    #[serde(skip)]
    pub fastest: Option<Row>,
}

impl Recommendation {
    /// Whether there is a row for all that was asked.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.error.is_none_or(|_| self.row.is_some())
            && self.seconds.is_none_or(|_| self.within.is_some())
    }
}

impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Method", 3)?;
        fields.serialize_field("tier", self.name())?;
        fields.serialize_field("digits", &self.digits())?;
        fields.serialize_field("harmonics", &self.harmonics())?;
        fields.end()
    }
}
