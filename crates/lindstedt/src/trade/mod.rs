//! Speed against accuracy: what every route to a period costs, and how wrong its result is.
//!
//! The period T of a problem is computed by every tier at every order and precision asked for, and
//! by the integrator in the time domain, which shares no code with them. Of each run are kept the
//! time, the memory, the true relative error, and the error that the run states without knowing
//! the truth: a closed form where there is one, a reference of many digits (van der Pol's
//! oscillator at eps = 1), else the period of the contraction test of [`lindstedt_orbit`], else the
//! integrator with more digits than any run. Where the test takes the equation, the true error is
//! proved as well.
//!
//! Every series is summed twice: as it stands (a partial sum, of a divergent series to its
//! smallest term), and by the resummation that [`lindstedt_series::resummation::resum`] chooses.

mod answer;
mod found;
mod front;
mod method;
mod proof;
mod run;
mod simulation;
mod sums;
mod truth;

use crate::evaluate::setting::Setting;
use crate::evaluate::source::Source;
use crate::evaluate::turn::TimeDomain;
use crate::refusal::Refused;
use crate::{
    Answer, DerivationError, Error, EvaluationError, Oscillator, Progress, Remark, Standing, Work,
};
pub use answer::{LeftOut, Reason, Recommendation, Row, Trade};
pub use front::{most_accurate, pareto, recommend, recommend_for_many};
use lindstedt_algebra::Stop;
use lindstedt_equation::Condition;
use lindstedt_number::ball::Ball;
use lindstedt_orbit::Failure;
pub use lindstedt_series::resummation::Method as Summation;
pub use method::Method;
#[doc(hidden)]
pub use method::predict;
use std::time::Instant;
use truth::Truth;

/// What is run.
///
/// ```
/// use lindstedt::{Oscillator, Work, trade::Plan};
/// let plan = Plan { orders: vec![4], digits: vec![16], harmonics: vec![], repeats: 1, ..Plan::default() };
/// let trade = Oscillator::builtin("duffing")?.set("eps", "1/10")?.trade(&plan, &Work::default())?.value;
/// assert!(trade.rows.iter().any(|row| row.true_error < 1e-6));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plan {
    /// Orders of the series.
    pub orders: Vec<usize>,
    /// Digits of the tiers that have them.
    pub digits: Vec<u32>,
    /// Harmonics of the Fourier tier.
    pub harmonics: Vec<usize>,
    /// A run that takes longer is broken off, and higher orders of its method are left out.
    pub run_seconds: f64,
    /// The time of a row is the least of so many runs; a run longer than 1 s is not repeated.
    pub repeats: u32,
    /// A relative error for which a row is recommended.
    pub error: Option<f64>,
    /// A time for which a row is recommended; with `error` also a limit for that.
    pub seconds: Option<f64>,
}

impl Default for Plan {
    /// Orders 2 to 32, 16, 30 and 50 digits, 16 and 64 harmonics, 5 s for a run, best of 3.
    fn default() -> Self {
        Self {
            orders: vec![2, 4, 8, 16, 32],
            digits: vec![16, 30, 50],
            harmonics: vec![16, 64],
            run_seconds: 5.0,
            repeats: 3,
            error: None,
            seconds: None,
        }
    }
}

impl Plan {
    fn most_digits(&self) -> u32 {
        self.digits.iter().copied().max().unwrap_or(16).max(16)
    }
}

impl Oscillator {
    /// Measures what every route to the period costs and how wrong it is. Values that are not set are
    /// those of [`Oscillator::evaluate`]; of `work` count the memory, when to stop, and whom to tell.
    ///
    /// Undecided where no row is what the recommendation asks for; stopped work leaves the rows that
    /// are finished. Cost: the runs of the plan, each at most [`Plan::run_seconds`] long.
    ///
    /// # Errors
    /// [`Refused`] for a problem without a periodic solution that is expanded, and where the true
    /// period is unknown; [`Error::Simulate`] where the integrator has to tell it and refuses; those of
    /// [`Oscillator::evaluate`] for parameters.
    ///
    /// ```
    /// use lindstedt::trade::{Plan, recommend};
    /// use lindstedt::{Oscillator, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?.set("eps", "1/4")?;
    /// let plan = Plan { orders: vec![2, 8], digits: vec![20], ..Plan::default() };
    /// let trade = duffing.trade(&plan, &Work::default())?.value;
    /// assert!(trade.rows.iter().all(|row| row.true_error <= row.stated_error));
    /// assert!(!trade.pareto.is_empty() && recommend(&trade.rows, 1e-3).is_some());
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn trade(&self, plan: &Plan, work: &Work) -> Result<Answer<Trade>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        // The numeric tiers take equations that the exact one refuses.
        if self.condition().is_none() {
            self.check()?;
        }
        let (case, mut remarks) = self.placed()?;
        let failed = |error| case.no_reference(error, work);
        let setting = case.setting().map_err(failed)?;
        let bench = Bench::new(&case, &setting, plan, work).map_err(failed)?;
        if let Some(failure) = &bench.failure {
            remarks.push(Remark(format!("the period is not proved: {failure}")));
        }
        let mut value = bench.truth.begin(&setting, plan.repeats);
        value.proved_period = bench.proved.as_ref().and_then(|period| bench.number(period));
        value.finished = bench.run_all(&mut value);
        value.pareto = pareto(&value.rows);
        for &index in &value.pareto {
            value.rows[index].pareto = true;
        }
        value.recommendation = plan.recommended(&value.rows);
        let standing = if !value.finished {
            remarks.push(Remark("not finished: the rows above are".to_owned()));
            Standing::Stopped { done: value.rows.len() }
        } else if value.recommendation.as_ref().is_none_or(Recommendation::is_met) {
            Standing::Complete
        } else {
            Standing::Undecided
        };
        let header = self.header(setting.at.clone(), None, "every tier", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// A refusal in the words of this question.
    fn no_reference(&self, error: Error, work: &Work) -> Error {
        if work.stop.asked() {
            let hint = "raise --limit-seconds, or ask for fewer --digits";
            return Refused::stopped("stopped before the true period was known", hint).into();
        }
        if !matches!(
            error,
            Error::NoValue | Error::Evaluation(EvaluationError::NotEvaluated { .. })
        ) {
            return self.unevaluated(error);
        }
        let name = &self.problem().name;
        let message = format!("{name}: the true period at these parameters is not known");
        let hint = match self.condition() {
            Some(Condition::FundamentalAmplitude) => {
                "it is sought from x(0), not from the first harmonic: --normalisation initial, where \
                 the problem offers it"
            }
            _ => {
                "oscillators with a periodic solution that starts at rest: power-law, pendulum, \
                 duffing, van-der-pol, files"
            }
        };
        Refused::no_answer("no-reference", message, hint).into()
    }
}

/// Orders that tell in which power of the small parameter the series is.
const FEW: usize = 4;

/// Digits of the truth beyond the most that are judged.
const MORE: u32 = 8;

/// A case with what all runs share.
struct Bench<'a> {
    plan: &'a Plan,
    work: &'a Work,
    setting: &'a Setting,
    /// What is known of the series; its own coefficients are not used.
    source: Source,
    motion: TimeDomain<'a>,
    /// The period by the contraction test, where it takes the equation, and why not where it failed.
    proved: Option<Ball>,
    failure: Option<Failure>,
    truth: Truth,
    bits: u32,
}

impl<'a> Bench<'a> {
    fn new(
        case: &Oscillator,
        setting: &'a Setting,
        plan: &'a Plan,
        work: &'a Work,
    ) -> Result<Self, Error> {
        let digits = plan.most_digits() + MORE;
        let bits = (f64::from(digits) * std::f64::consts::LOG2_10).ceil() as u32 + 40;
        let means = (work.memory, &work.stop);
        let source = match Source::new(setting, FEW, means, &mut |_| !work.stop.asked()) {
            Err(error @ DerivationError::OutsideDomain { .. }) => return Err(error.into()),
            // Nothing is known of an equation that the exact driver does not take.
            found => found.unwrap_or_else(|_| Source::plain(setting)),
        };
        let motion = TimeDomain::new(setting, &work.stop);
        let (proved, failure) = match proof::period(case, &motion, digits, stop(plan, work)) {
            Ok(proved) => (proved, None),
            Err(failure) => (None, Some(failure)),
        };
        let simulate = |digits| simulation::in_digits(&motion, digits, &work.stop);
        let truth = Truth::new(&source, (bits, digits), proved.as_ref(), &simulate)?;
        Ok(Self { plan, work, setting, source, motion, proved, failure, truth, bits })
    }

    fn stop(&self) -> Stop {
        stop(self.plan, self.work)
    }

    /// A proved period as it is printed.
    fn number(&self, period: &Ball) -> Option<crate::Number> {
        let digits = self.plan.most_digits() as usize;
        Some(crate::Number::of_ball(period, digits)?.weaken(crate::Status::Proved))
    }

    /// All runs; whether they were all made.
    fn run_all(&self, trade: &mut Trade) -> bool {
        let methods = Method::all(&self.setting.problem, self.plan);
        let all = methods.iter().map(|method| method.orders(self.plan).len()).sum();
        let mut done = 0;
        for method in methods {
            let mut times: Vec<(usize, f64)> = Vec::new();
            for order in method.orders(self.plan) {
                done += 1;
                let predicted = predict(&method, &times, order);
                if let Some(seconds) = predicted.filter(|s| *s > self.plan.run_seconds) {
                    let reason = Reason::Predicted(seconds);
                    trade.left_out.push(LeftOut { method, order, reason });
                    continue;
                }
                let time = self.run_one((method, order), trade);
                if !self.work.goes_on(Progress::Parts(done, all)) {
                    return false;
                }
                times.extend(time.map(|seconds| (order.unwrap_or(0), seconds)));
            }
        }
        true
    }

    /// The rows of one run, or why there is none; its time, infinite where it was too long.
    fn run_one(&self, (method, order): (Method, Option<usize>), trade: &mut Trade) -> Option<f64> {
        let limit = self.plan.run_seconds;
        let start = Instant::now();
        let outcome = self.run(&method, order.unwrap_or(0));
        let too_long = start.elapsed().as_secs_f64() > limit;
        match outcome {
            // What was stopped in its midst means nothing.
            _ if self.work.stop.asked() => None,
            Ok(list) => {
                let least = list.iter().map(|found| found.seconds).reduce(f64::min);
                let rows = list.into_iter().map(|found| {
                    let proved = self.proved.as_ref();
                    let proved_error = proved.and_then(|period| proof::error(period, &found));
                    Row { proved_error, ..self.truth.row(method, order, found) }
                });
                trade.rows.extend(rows);
                least
            }
            Err(error) => {
                let reason = if too_long { Reason::TooLong(limit) } else { Reason::Refused(error) };
                trade.left_out.push(LeftOut { method, order, reason });
                // Higher orders take longer still.
                too_long.then_some(f64::INFINITY)
            }
        }
    }
}

/// Says stop when the work shall stop, or after the seconds of a run from now.
fn stop(plan: &Plan, work: &Work) -> Stop {
    let (outer, start, seconds) = (work.stop.clone(), Instant::now(), plan.run_seconds);
    Stop::new(move || outer.asked() || start.elapsed().as_secs_f64() > seconds)
}
