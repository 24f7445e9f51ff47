//! The stability of an impact orbit with a delay loop: what averaging predicts, and the truth.
//!
//! Between impacts x'' + c x' + alpha^2 x = P0 cos(omega t) + A (x - x_T) + B (x' - x'_T) with
//! T = 2 pi k/omega, and x' -> -R_r x' at the wall x = s. An equation with a wall is brought to this
//! form ([`lindstedt_recognise::ImpactProblem`]), whoever wrote it; one impact in k periods of the force.

mod chart;
mod point;
mod reading;
mod subject;

use crate::choices::{Choice, VARIANTS};
use crate::grid::{Axis, Part};
use crate::refusal::Refused;
use crate::{Answer, Error, Number, Oscillator, Remark, Standing, Work};
use lindstedt_impact::ImpactError;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::parameters::Branch;
use lindstedt_impact::prediction::Variant;
use lindstedt_impact::report::{certified_stability, stability};
use lindstedt_number::as_map;
use lindstedt_number::real::Certified;
use serde::Serialize;
use std::cell::Cell;
use std::time::Instant;
use subject::Subject;

pub use chart::{Chart, LeftOutAndAgreement};
pub use point::{Aware, Found, Multiplier, Predicted, PredictedOrbit, ReturnMap, TrueOrbit, Truth};

/// What to ask about an impact orbit.
///
/// ```
/// use lindstedt::{Oscillator, Stability, Work};
/// let oscillator = Oscillator::builtin("vibro-impact")?.set("A", "1/5")?.set("omega", "33/10")?;
/// let oscillator = oscillator.set("k", "2")?.set("R_r", "4/5")?.set("s", "0")?.set("c", "1/20")?;
/// let answer = oscillator.stability(&Stability::default(), &Work { doubles: true, ..Work::default() })?;
/// let (predicted, truth) = (answer.value.kbm, answer.value.exact);
/// assert_eq!(predicted.and_then(|kbm| kbm.stable), Some(true));
/// assert_eq!(truth.and_then(|exact| exact.stable), Some(false));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stability {
    /// The order of the averaged flow, at least 1.
    pub order: usize,
    /// Which orbit meets which flow in the prediction.
    pub variant: Variant,
    /// Whether a chart takes the prediction that knows of the impact within the delay.
    pub impact_aware: bool,
    /// How the velocity kick of B is treated in the characteristic function.
    pub kick: Kick,
    /// Whether to predict by averaging.
    pub predict: bool,
    /// Whether to compute the truth.
    pub exact: bool,
    /// The root of the impact velocity; by default that of the problem.
    pub branch: Option<Branch>,
    /// No, one or two swept parameters; the first runs along the columns.
    pub sweep: Vec<Axis>,
    /// Whether the points of a sweep have the largest multipliers beside the verdicts, which cost more than these.
    pub radius: bool,
    /// Of the rows of a chart only these.
    pub part: Option<Part>,
}

impl Default for Stability {
    /// Prediction (variant E of order 1) and truth (mean kick) of one point.
    fn default() -> Self {
        Self {
            order: 1,
            variant: Variant::E,
            impact_aware: false,
            kick: Kick::Mean,
            predict: true,
            exact: true,
            branch: None,
            sweep: Vec::new(),
            radius: false,
            part: None,
        }
    }
}

impl Stability {
    /// Takes `branch=+` and `branch=-` out of a list of settings.
    ///
    /// # Errors
    /// [`Refused`] for another branch, or two of them.
    pub fn read_branch(set: &[String]) -> Result<(Option<Branch>, Vec<String>), Error> {
        let (branches, numbers): (Vec<String>, Vec<String>) =
            set.iter().cloned().partition(|item| item.trim().starts_with("branch="));
        let branch = match branches.as_slice() {
            [] => None,
            [only] => match only.trim().trim_start_matches("branch=").trim() {
                "+" | "plus" => Some(Branch::Plus),
                "-" | "minus" => Some(Branch::Minus),
                other => {
                    let message = format!("branch is + or -, not {other:?}");
                    return Err(Refused::usage("set", message, "--set branch=-").into());
                }
            },
            _ => return Err(Refused::usage("set", "branch is set twice", "").into()),
        };
        Ok((branch, numbers))
    }

    /// The name of the variant.
    #[must_use]
    pub fn variant_name(&self) -> &'static str {
        match self.impact_aware {
            true => "impact-aware",
            false => Choice::word(VARIANTS, (self.variant, false)),
        }
    }
}

/// The answer about an impact orbit. Certified, or estimated in doubles; what is estimated in both
/// says so.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct OrbitStability {
    /// The parameters of the form above, where they are not those of the problem.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "as_map")]
    pub canonical: Vec<(String, String)>,
    /// The orbit of the true system, for every A, B.
    pub orbit: Found<TrueOrbit>,
    /// What averaging predicts; not the stability of the delayed system.
    pub kbm: Option<Predicted>,
    /// Averaging that knows of the impact within the delay.
    pub impact_aware: Option<Aware>,
    /// The truth.
    pub exact: Option<Truth>,
    /// The chart of the sweeps.
    pub grid: Option<Chart>,
    /// What to beware of.
    pub warnings: Vec<Remark>,
    /// That there is no orbit, for programs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<NoOrbit>,
}

/// Why there is no stability to speak of.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct NoOrbit {
    /// `no-orbit`, or `undecided` where the flight touches the wall.
    pub code: &'static str,
    /// In words.
    pub message: Option<Remark>,
    /// What to do about it.
    pub hint: &'static str,
}

impl Oscillator {
    /// The impact orbit, its predicted and its true stability, and charts of both.
    ///
    /// Digits are those of `work`; charts are computed in doubles. Cost: milliseconds for a point,
    /// some microseconds for a point of a chart.
    ///
    /// # Errors
    /// [`Refused`] with the term that does not fit, [`Error::Impact`]. A missing orbit or prediction
    /// stands in the answer.
    pub fn stability(
        &self,
        question: &Stability,
        work: &Work,
    ) -> Result<Answer<OrbitStability>, Error> {
        let start = Instant::now();
        let subject = Subject::new(self, question)?;
        let sweep = subject.swept(&question.sweep)?;
        let parameters = &subject.found.parameters;
        let request = subject.request();
        let mut value = if work.doubles {
            let point = parameters.nearest();
            let report = stability(&point, &request, &work.stop).map_err(stopped)?;
            subject.answer(&report, &|x| Number::double(*x))
        } else {
            let report = certified_stability(parameters, &request, work.digits, &work.stop);
            let digits = work.printed_digits();
            let unknown = Cell::new(false);
            let number = |x: &Certified| {
                let number = Number::of_ball(x.ball(), digits);
                unknown.set(unknown.get() || number.is_none());
                number.unwrap_or_else(|| Number::double(f64::NAN))
            };
            let value = subject.answer(&report.map_err(stopped)?, &number);
            if unknown.get() {
                let message = format!("a number has no digit left of {}", work.digits);
                return Err(Refused::undecided("undecided", message, "more --digits").into());
            }
            value
        };
        value.grid = chart::compute(&subject, &sweep, work)?;
        let mut standing = match value.orbit.exists() {
            _ if value.grid.is_some() => Standing::Complete,
            Some(true) => Standing::Complete,
            Some(false) => Standing::NoAnswer,
            None => Standing::Undecided,
        };
        if standing != Standing::Complete {
            let code = if standing == Standing::NoAnswer { "no-orbit" } else { "undecided" };
            let message = value.warnings.first().cloned();
            let hint = match code {
                "no-orbit" => {
                    "`lindstedt simulate` shows what the motion does; --set branch=- is the other root"
                }
                _ => "more --digits, or other values",
            };
            value.error = Some(NoOrbit { code, message, hint });
        }
        let mut remarks = self.remarks().to_vec();
        remarks.extend(value.warnings.iter().cloned());
        if let Some(chart) = value.grid.as_ref().filter(|chart| !chart.finished) {
            standing = Standing::Stopped { done: chart.grid.done() };
            remarks.push(Remark("the chart is not finished".to_owned()));
        }
        let order = question.predict.then_some(question.order);
        let tier = if work.doubles { "doubles" } else { "certified" };
        let header = self.header(subject.at.clone(), order, tier, start);
        Ok(Answer { header, value, standing, remarks })
    }
}

/// An error of a point; of stopped work as such.
fn stopped(error: ImpactError) -> Error {
    match error {
        ImpactError::Cancelled => Refused::stopped(
            "stopped before the point was finished",
            "raise --limit-seconds, or fewer --digits, or --f64",
        )
        .into(),
        error => error.into(),
    }
}
