//! Speed against accuracy: what every route to a period costs, and how wrong its result is.
//!
//! The period T of a problem is computed by every tier at every order and precision asked for, and
//! by the integrator in the time domain, which shares no code with them. Of each run are kept the
//! time, the memory, the true relative error, and the error that the run states without knowing
//! the truth: a closed form where there is one, a reference of many digits (van der Pol's
//! oscillator at eps = 1), else the integrator with more digits than any run.
//!
//! Every series is summed twice: as it stands (a partial sum, of a divergent series to its
//! smallest term), and by the resummation that [`lindstedt_series::resummation::resum`] chooses.

mod front;
mod run;
mod simulation;
mod sums;
mod truth;

use crate::evaluate::method_flag;
use crate::evaluate::setting::Setting;
use crate::evaluate::source::Source;
use crate::{Error, Exact};
pub use front::{most_accurate, pareto, recommend, recommend_for_many};
use lindstedt_algebra::Stop;
use lindstedt_equation::{Condition, Problem};
use lindstedt_series::resummation;
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::time::Instant;
pub use truth::Truth;

/// How a period is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Method {
    /// Derived in exact rings, then evaluated to `digits` digits.
    Exact {
        /// Digits of the evaluation.
        digits: u32,
    },
    /// The exact energy integral (power law and pendulum), then evaluated.
    Energy {
        /// Digits of the evaluation.
        digits: u32,
    },
    /// [`crate::numeric::Tier::Collocation`].
    Collocation {
        /// Correct digits of the coefficients.
        digits: u32,
    },
    /// [`crate::numeric::Tier::Doubles`].
    Doubles,
    /// [`crate::numeric::Tier::Fourier`].
    Fourier {
        /// Harmonics of each symmetry class.
        harmonics: usize,
    },
    /// Integrated in the time domain in double precision.
    SimulationInDoubles {
        /// Digits of one step.
        digits: u32,
    },
    /// Integrated in the time domain in floats of so many digits.
    Simulation {
        /// Digits of one step.
        digits: u32,
    },
}

impl Method {
    /// `exact`, `energy`, `collocation`, `collocation-f64`, `fourier`, `simulation-f64`,
    /// `simulation`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Exact { .. } => "exact",
            Self::Energy { .. } => "energy",
            Self::Collocation { .. } => "collocation",
            Self::Doubles => "collocation-f64",
            Self::Fourier { .. } => "fourier",
            Self::SimulationInDoubles { .. } => "simulation-f64",
            Self::Simulation { .. } => "simulation",
        }
    }

    /// Digits computed with; 16 for the tiers in doubles.
    #[must_use]
    pub fn digits(&self) -> u32 {
        match *self {
            Self::Exact { digits }
            | Self::Energy { digits }
            | Self::Collocation { digits }
            | Self::SimulationInDoubles { digits }
            | Self::Simulation { digits } => digits,
            Self::Doubles | Self::Fourier { .. } => 16,
        }
    }

    /// Whether a series is summed, to an order; otherwise the equation is integrated.
    #[must_use]
    pub fn has_order(&self) -> bool {
        !matches!(self, Self::SimulationInDoubles { .. } | Self::Simulation { .. })
    }
}

/// How a series is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Summation {
    /// As it stands; of a divergent series to its smallest term.
    PartialSum,
    /// By the method with the least error estimate.
    Resummed(resummation::Method),
}

impl Summation {
    /// As after `--resum`: `none`, `pade`, `uniform`, `uniform-pade`, `conformal`, `borel-pade`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::PartialSum => "none",
            Self::Resummed(method) => method_flag(*method),
        }
    }
}

/// What is run.
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
    /// The memory that may be used, in bytes.
    pub memory: u64,
    /// What the amplitude is; the first condition of the problem if not given. The true period is
    /// sought from the initial amplitude and on the limit cycle.
    pub condition: Option<Condition>,
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
            memory: 8 << 30,
            condition: None,
        }
    }
}

/// One run.
#[derive(Clone, Debug)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// The order of the series; nothing for the integrator.
    pub order: Option<usize>,
    /// How the series is summed; nothing for the integrator.
    pub summation: Option<Summation>,
    /// The time of the fastest run: derivation and summation, with the choice of the method.
    pub seconds: f64,
    /// The time for one more value of the small parameter: summing the series again by the same
    /// method; for the integrator the same as `seconds`.
    pub seconds_again: f64,
    /// Numbers kept at once times their size: an estimate of the memory in bytes.
    pub bytes: u64,
    /// The period found.
    pub period: Float,
    /// |period/T - 1|, up to [`Truth::uncertainty`].
    pub true_error: f64,
    /// The estimate of the relative error that the run gives without knowing T: of a sum that of
    /// the resummation, with what the errors of the coefficients make of it (four times the
    /// difference of two grids); four times the difference of two tolerances. Infinite where
    /// there is no estimate (too few orders, outside of the circle of convergence).
    pub stated_error: f64,
}

/// A run that was not made.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// The method.
    pub method: Method,
    /// The order.
    pub order: Option<usize>,
    /// Why.
    pub reason: Reason,
}

/// Why a run was left out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// It took longer than [`Plan::run_seconds`].
    TooLong,
    /// A lower order of the same method predicts so many seconds.
    Predicted(f64),
    /// It was refused.
    Refused(Error),
    /// The integrator refused.
    NotIntegrated(lindstedt_simulate::SimulateError),
}

/// What was measured.
#[derive(Clone, Debug)]
pub struct Trade {
    /// The problem.
    pub problem: Problem,
    /// The true period and where it is from.
    pub truth: Truth,
    /// The rows in the order of [`Method`], digits, order, summation.
    pub rows: Vec<Row>,
    /// The runs that were not made, in the same order.
    pub left_out: Vec<LeftOut>,
    /// Whether the observer let all runs finish.
    pub finished: bool,
}

/// Measures a problem, of the library or of a file, with a periodic solution that is expanded.
///
/// Parameters that are not given have the defaults of [`crate::evaluate`], but delta = 1/4 for the
/// power law and eps = 1/4 for Duffing's oscillator, where the series itself converges fast.
///
/// `observer` is asked before every run and at every order of it; when it returns `false`, the
/// rows finished so far are returned. It is told the run and the rows so far.
///
/// # Errors
/// [`Error::NotEvaluated`] for a problem without such a solution, [`Error::NoValue`] where the true
/// period is unknown, [`Error::Simulate`] where the integrator has to tell it and refuses;
/// [`Error::UnknownParameter`], [`Error::Unset`] and [`Error::OutsideDomain`] for parameters.
///
/// ```
/// use lindstedt::problems;
/// use lindstedt::trade::{Plan, measure, pareto, recommend};
/// let problem = problems::find("duffing").ok_or("no such problem")?;
/// let plan = Plan { orders: vec![2, 8], digits: vec![20], ..Plan::default() };
/// let trade = measure(&problem, &Default::default(), &plan, &mut |_, _| true)?;
/// assert!(trade.rows.iter().all(|row| row.true_error <= row.stated_error));
/// assert!(!pareto(&trade.rows).is_empty() && recommend(&trade.rows, 1e-3).is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn measure(
    problem: &Problem,
    parameters: &BTreeMap<String, Exact>,
    plan: &Plan,
    observer: &mut dyn FnMut(&Method, &[Row]) -> bool,
) -> Result<Trade, Error> {
    let setting = Setting::new(problem, plan.condition, &defaults(problem, parameters))?;
    let most = plan.digits.iter().copied().max().unwrap_or(16).max(16);
    let bits = (f64::from(most) * std::f64::consts::LOG2_10).ceil() as u32 + 64;
    let source = template(&setting, plan.memory)?;
    let first = Method::Simulation { digits: most };
    let mut goes_on = || observer(&first, &[]);
    let truth = truth::truth(&setting, &source, bits, most, &mut goes_on);
    let truth = truth.map_err(|reason| match reason {
        Reason::Refused(error) => error,
        Reason::NotIntegrated(error) => error.into(),
        _ => Error::NoValue,
    })?;
    let methods = methods(problem, plan, most);
    let mut trade = Trade {
        problem: problem.clone(),
        truth,
        rows: Vec::new(),
        left_out: Vec::new(),
        finished: true,
    };
    for method in methods {
        let mut orders: Vec<Option<usize>> = vec![None];
        if method.has_order() {
            orders = plan.orders.iter().copied().map(Some).collect();
            orders.sort_unstable();
            orders.dedup();
        }
        let mut times: Vec<(usize, f64)> = Vec::new();
        for order in orders {
            if let Some(seconds) = predict(&method, &times, order).filter(|s| *s > plan.run_seconds)
            {
                let reason = Reason::Predicted(seconds);
                trade.left_out.push(LeftOut { method, order, reason });
                continue;
            }
            if !observer(&method, &trade.rows) {
                trade.finished = false;
                return Ok(trade);
            }
            let mut cancelled = false;
            let start = Instant::now();
            let mut goes_on = || {
                cancelled |= !observer(&method, &trade.rows);
                !cancelled && start.elapsed().as_secs_f64() <= plan.run_seconds
            };
            let (memory, seconds) = (plan.memory, plan.run_seconds);
            let job = run::Job { setting: &setting, source: &source, memory, bits, seconds };
            let outcome = job.run(&method, order.unwrap_or(0), plan.repeats, &mut goes_on);
            if cancelled {
                trade.finished = false;
                return Ok(trade);
            }
            match outcome {
                Ok(list) => {
                    let least = list.iter().map(|found| found.seconds).reduce(f64::min);
                    times.push((order.unwrap_or(0), least.unwrap_or(0.0)));
                    for found in list {
                        trade.rows.push(trade.truth.row(method, order, found));
                    }
                }
                Err(reason) => {
                    let reason = match reason {
                        _ if start.elapsed().as_secs_f64() > plan.run_seconds => Reason::TooLong,
                        other => other,
                    };
                    let ends = reason == Reason::TooLong;
                    trade.left_out.push(LeftOut { method, order, reason });
                    if ends {
                        // Higher orders take longer still.
                        times.push((order.unwrap_or(0), f64::INFINITY));
                    }
                }
            }
        }
    }
    Ok(trade)
}

/// Values that are set where nothing is given.
const DEFAULTS: [(&str, &str, [&str; 2]); 2] =
    [("power-law", "delta", ["delta", "n"]), ("duffing", "eps", ["eps", "eps"])];

fn defaults(problem: &Problem, given: &BTreeMap<String, Exact>) -> BTreeMap<String, Exact> {
    let mut all = given.clone();
    for (name, parameter, others) in DEFAULTS {
        if *problem.name == *name && !others.iter().any(|other| given.contains_key(*other)) {
            all.insert(parameter.to_owned(), Exact::Rational(Rational::from((1, 4))));
        }
    }
    all
}

/// Orders that tell in which power of the small parameter the series is.
const FEW: usize = 4;

/// What is known of the series without its coefficients; nothing for an equation that the exact
/// driver does not take.
fn template(setting: &Setting, memory: u64) -> Result<Source, Error> {
    match Source::new(setting, FEW, (memory, &Stop::default()), &mut |_| true) {
        Err(error @ Error::OutsideDomain { .. }) => Err(error),
        found => Ok(found.unwrap_or_else(|_| Source::plain(setting))),
    }
}

/// All methods in the order of the rows.
fn methods(problem: &Problem, plan: &Plan, most: u32) -> Vec<Method> {
    let mut digits = plan.digits.clone();
    let mut harmonics = plan.harmonics.clone();
    digits.sort_unstable();
    digits.dedup();
    harmonics.sort_unstable();
    harmonics.dedup();
    // The digits of an evaluation cost nothing beside an exact derivation.
    let mut list = vec![Method::Exact { digits: most }];
    if run::has_energy_route(problem) {
        list.push(Method::Energy { digits: most });
    }
    list.extend(digits.iter().map(|&digits| Method::Collocation { digits }));
    list.push(Method::Doubles);
    list.extend(harmonics.into_iter().map(|harmonics| Method::Fourier { harmonics }));
    list.extend([8, 12, 16].map(|digits| Method::SimulationInDoubles { digits }));
    list.extend(digits.into_iter().map(|digits| Method::Simulation { digits }));
    list
}

/// Shorter times are mostly noise: nothing is extrapolated from them.
const MEASURABLE: f64 = 0.05;

/// The seconds of an order from those of the two before, if both are long enough to mean anything.
/// Exact derivations grow exponentially, and running into the limit at every order would take as
/// many times the limit; the numeric ones are broken off when their time is over.
#[doc(hidden)]
pub fn predict(method: &Method, times: &[(usize, f64)], order: Option<usize>) -> Option<f64> {
    let &(last, seconds) = times.last()?;
    if seconds == f64::INFINITY || !matches!(method, Method::Exact { .. } | Method::Energy { .. }) {
        return seconds.is_infinite().then_some(seconds);
    }
    let &(before, less) = times.iter().rev().nth(1).filter(|(_, less)| *less >= MEASURABLE)?;
    let steps = (order? - last) as f64 / (last - before) as f64;
    Some(seconds * (seconds / less).max(1.0).powf(steps))
}
