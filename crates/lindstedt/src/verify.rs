//! The expansion against the time domain: the observed order of accuracy.
//!
//! The expansion of order N, x_N(t), is compared with the solution x(t) of the equation by the
//! integrator of [`lindstedt_simulate`], which shares nothing with the expansion but the equation
//! as it was written (before values are put in, x is scaled or time is). On a fixed window
//!
//!   e(eps) = max_t |x_N(t; eps) - x(t; eps)| = C eps^(N+1) (1 + O(eps)),
//!
//! so d ln e/d ln eps tends to N + 1 if every order is right, and to n if order n is wrong: x_N
//! leaves a residual of order eps^(N+1) in the equation, and over a time that does not depend on
//! eps a solution answers to a residual and to a change of its start by as much (Gronwall), if its
//! start is that of x_N up to eps^(N+1). What the start is:
//!
//! - initial amplitude: x(0) = a, x'(0) = 0;
//! - limit cycle: its point of largest x, found by Newton's method on the return map (a start
//!   taken from the expansion would hide an error of the amplitude);
//! - fundamental amplitude: x_N(0), x_N'(0); that the first harmonic of x_N is a is checked
//!   exactly with the residual;
//! - free amplitude (averaging): x_N(0), x_N'(0) at psi(0) = 0 and a(0) = a, where
//!   da/dt = sum eps^n A_n(a), dpsi/dt = sum eps^n B_n(a) are truncated at N and integrated. With
//!   a delay T the start is a function: x_N(t) for -T <= t <= 0 by the same rates. Any other
//!   history excites other roots of the characteristic equation, which the expansion leaves out.
//!   A wall takes no part: the expansion is that of the flight.

mod cycle;
mod drifting;
mod periodic;

use crate::refusal::Refused;
use crate::start::Taken;
use crate::{
    Answer, Derivation, Error, Exact, Oscillator, Progress, Settings, Standing, Work, derive,
};
use crate::{Number, Status};
use drifting::Drifting;
use lindstedt_derivation::condition;
use lindstedt_equation::{AmplitudeRole, Condition, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_simulate::Parameters;
use periodic::Periodic;
use rug::{Float, Rational};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

/// The observed order may differ from N + 1 by so much.
pub const TOLERANCE: f64 = 0.05;

/// Integrations with more digits each, until the differences are resolved.
const MOST_TRIES: usize = 3;

/// What to verify.
#[derive(Clone, Debug)]
pub struct Verify {
    /// N.
    pub order: usize,
    /// Values of the small parameter, each smaller in modulus than the one before, none zero.
    pub small: Vec<Rational>,
    /// The window: so many periods 2 pi/omega_N (2 pi/omega_0 with a free amplitude).
    pub periods: u32,
    /// Points of the window.
    pub samples: u32,
    /// Digits of the integration; by default enough for the smallest error expected.
    pub digits: Option<u32>,
}

impl Default for Verify {
    /// Order 4 at 1/1000, 1/2000, 1/4000, 1/8000 on one period.
    fn default() -> Self {
        Self {
            order: 4,
            small: (0..4).map(|j| Rational::from((1, 1000 << j))).collect(),
            periods: 1,
            samples: 48,
            digits: None,
        }
    }
}

impl Verify {
    /// Reads values of the small parameter, `V1,V2,...`: 2 to 100 rational numbers that decrease in
    /// modulus.
    ///
    /// # Errors
    /// [`Refused`] with the value that does not fit.
    pub fn read_small(text: &str) -> Result<Vec<Rational>, Error> {
        let wrong = |message: String| Refused::usage("small", message, "1/100,1/200,1/400");
        let mut list: Vec<Rational> = Vec::new();
        for part in text.split(',') {
            let value = Exact::parse(part)?;
            let Some(q) = value.as_rational().filter(|q| !q.is_zero()) else {
                return Err(wrong(format!("{part:?} is no rational number other than zero")).into());
            };
            if list.last().is_some_and(|last| q.cmp_abs(last).is_ge()) {
                return Err(wrong(format!("{part} is not smaller than the value before")).into());
            }
            list.push(q.clone());
        }
        if list.len() < 2 || list.len() > 100 {
            return Err(wrong("2 to 100 values are needed".to_owned()).into());
        }
        Ok(list)
    }
}

/// The comparison at one value of the small parameter.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The value.
    pub small: Rational,
    /// max |x_N - x| on the points of the window.
    pub error: Float,
    /// The estimated error of the integration (against one with 8 digits more).
    pub simulation_error: Float,
    /// max |x| on the same points: no order is observed where the difference is as large.
    pub size: Float,
    /// ln(error/previous error)/ln(small/previous small); nothing for the first.
    pub slope: Option<f64>,
}

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let small = Number {
            exact: Some(self.small.to_string()),
            // The nearest double (`to_f64` cuts off), as short as it can be written.
            decimal: format!("{:e}", Float::with_val(53, &self.small).to_f64()),
            error: None,
            status: Status::Exact,
        };
        let difference = Number {
            exact: None,
            decimal: self.error.to_string_radix(10, Some(6)),
            error: Some(self.simulation_error.to_string_radix(10, Some(6))),
            status: Status::Estimated,
        };
        serializer.collect_map([
            ("small", Cell::Number(&small)),
            ("difference", Cell::Number(&difference)),
            ("slope", Cell::Slope(self.slope)),
        ])
    }
}

/// A value of a serialized comparison.
#[derive(Serialize)]
#[serde(untagged)]
enum Cell<'a> {
    Number(&'a Number),
    Slope(Option<f64>),
}

/// What the comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The observed order is N + 1 within [`TOLERANCE`], or it has settled there or at a whole
    /// number above: the terms that were left out begin later.
    Agrees,
    /// It has settled at a whole number below N + 1.
    Disagrees,
    /// The errors are not above those of the integration, or as large as the motion, there are
    /// fewer than two, or the slopes have not settled: the small parameter is not small enough.
    Undecided,
}

/// The result of [`Oscillator::verify`].
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// The name of the small parameter.
    pub parameter: String,
    /// The digits of the integration.
    pub digits: u32,
    /// The normalisation.
    pub normalisation: Condition,
    /// The window in periods.
    pub periods: u32,
    /// One line per value, in the order given.
    pub table: Vec<Comparison>,
    /// The slope between the last two values.
    pub observed_order: Option<f64>,
    /// N + 1.
    pub expected_order: usize,
    /// The last slope is within [`TOLERANCE`] of the limit that it and the one before extrapolate to
    /// (three values).
    pub settled: bool,
    /// [`TOLERANCE`].
    pub tolerance: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in words.
    pub reason: String,
    /// The errors of the last two values are above those of the integration.
    #[serde(skip)]
    pub resolved: bool,
    /// The last errors are smaller than the motion.
    #[serde(skip)]
    pub small_enough: bool,
}

impl Oscillator {
    /// Compares the expansion with the time domain on a window, at several values of the small
    /// parameter: with all orders right the observed order of accuracy is N + 1.
    ///
    /// With a free amplitude `amplitude` is a(0), by default 1. Estimated: the error of every
    /// integration is that against one with 8 digits more. Cost: two integrations per value.
    ///
    /// # Errors
    /// Those of the derivation; [`Error::Simulate`], [`Error::NoPeriodicOrbit`],
    /// [`Error::LongDelay`]; [`Refused`] where the work was stopped.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Verify, Work, verify::Verdict};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
    /// let found = duffing.verify(&Verify { order: 2, ..Verify::default() }, &Work::default())?;
    /// assert_eq!(found.value.verdict, Verdict::Agrees);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn verify(&self, question: &Verify, work: &Work) -> Result<Answer<Verification>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        self.check_free()?;
        self.check()?;
        if self.condition().is_none() {
            let message = format!("{} has no expansion that could be verified", self.origin());
            let hint = "`simulate` takes it, `problems --show` lists the methods";
            return Err(Refused::no_answer("no-expansion", message, hint).into());
        }
        let condition = condition(self.problem(), self.asked_condition())?;
        let found = if condition == Condition::FreeAmplitude {
            self.drifting(question, work)
        } else {
            self.derived(condition, question, work)
                .and_then(|derivation| self.against_time(&derivation, question, work))
        };
        let found = found.map_err(|error| match error {
            error if error.is_interrupted() => Refused::stopped(
                "stopped before the comparison was finished",
                "raise --limit-seconds, or shorten --periods",
            )
            .into(),
            error => self.refusal(error),
        })?;
        let at = self.given().iter().map(|(name, value)| (name.clone(), value.to_string()));
        let header = self.header(at.collect(), Some(question.order), "time domain", start);
        let standing = match found.verdict {
            Verdict::Agrees => Standing::Complete,
            Verdict::Disagrees => Standing::NoAnswer,
            Verdict::Undecided => Standing::Undecided,
        };
        let mut remarks = self.remarks().to_vec();
        if matches!(condition, Condition::InitialAmplitude | Condition::FreeAmplitude) {
            remarks.extend(self.start_remark(Taken::Amplitude));
        }
        Ok(Answer { header, value: found, standing, remarks })
    }

    /// As [`Oscillator::verify`], for an expansion that is there; its order and its condition count.
    ///
    /// # Errors
    /// As there.
    pub fn verify_derivation(
        &self,
        derivation: &Derivation,
        question: &Verify,
        work: &Work,
    ) -> Result<Answer<Verification>, Error> {
        let start = Instant::now();
        let value = self.against_time(derivation, question, work)?;
        let header = self.header(Vec::new(), Some(derivation.order), "time domain", start);
        let remarks = self.remarks().to_vec();
        Ok(Answer { header, value, standing: Standing::Complete, remarks })
    }

    fn derived(
        &self,
        condition: Condition,
        question: &Verify,
        work: &Work,
    ) -> Result<Derivation, Error> {
        let settings = Settings {
            order: question.order,
            condition: Some(condition),
            parameters: self.given().clone(),
            memory: work.memory,
            stop: work.stop.clone(),
            ..Settings::default()
        };
        let derivation = derive(self.problem(), &settings, &mut |p| work.goes_on(p))?;
        if derivation.order < question.order {
            return Err(ExpandError::Interrupted { order: derivation.order }.into());
        }
        Ok(derivation)
    }

    fn drifting(&self, question: &Verify, work: &Work) -> Result<Verification, Error> {
        with_digits(question.order, Condition::FreeAmplitude, question, &mut |digits| {
            let expansion = Drifting::new(self, question, digits, &mut |p| work.goes_on(p))?;
            let compare = |small: &Rational, goes_on: &dyn Fn() -> bool| {
                expansion.compare(small, digits, goes_on)
            };
            let found = compare_all(question, question.order, &compare, work)?;
            Ok(self.conclude((Condition::FreeAmplitude, question.order), question, digits, found))
        })
    }

    fn against_time(
        &self,
        derivation: &Derivation,
        question: &Verify,
        work: &Work,
    ) -> Result<Verification, Error> {
        let (order, condition) = (derivation.order, derivation.condition);
        with_digits(order, condition, question, &mut |digits| {
            let expansion = Periodic::new(self, derivation, question, digits)?;
            let compare = |small: &Rational, goes_on: &dyn Fn() -> bool| {
                expansion.compare(small, digits, goes_on)
            };
            let found = compare_all(question, order, &compare, work)?;
            Ok(self.conclude((condition, order), question, digits, found))
        })
    }

    /// Refuses a value that cannot be chosen: the small parameter and what is part of it are varied.
    fn check_free(&self) -> Result<(), Error> {
        let problem = self.problem();
        let Some(name) = self.given().keys().find(|name| !self.is_free(name)) else {
            return Ok(());
        };
        let small = &problem.small;
        if **name == **small || problem.parameters.iter().any(|card| card.name == **name) {
            let message = format!("{name} is not free here: {small} is varied");
            return Err(Refused::usage("parameter", message, "--small V1,V2,...").into());
        }
        let message = format!("{} has no parameter {name:?}", problem.name);
        let free = problem.parameters.iter().map(|card| &*card.name);
        let free: Vec<&str> = free.filter(|name| self.is_free(name)).collect();
        let hint = match free.as_slice() {
            [] => format!("it has none that is free; {small} is varied: --small V1,V2,..."),
            list => format!("free are {}", list.join(", ")),
        };
        Err(Refused::usage("unknown-parameter", message, hint).into())
    }

    /// Whether a parameter can be set: the equation mentions it, or it is the amplitude of the
    /// solution.
    fn is_free(&self, name: &str) -> bool {
        let problem = self.problem();
        if name == "amplitude" {
            let enters = matches!(
                problem.amplitude,
                AmplitudeRole::InSums
                    | AmplitudeRole::Scaled
                    | AmplitudeRole::ScalesFrequency { .. }
            );
            return self.condition() == Some(Condition::FreeAmplitude) || enters;
        }
        let is_card = problem.parameters.iter().any(|card| card.name == *name);
        let mentioned = problem.equation.parameters().iter().any(|known| known == name);
        let tie = problem.synchronous.as_ref();
        let tied = tie.is_some_and(|tie| tie.periods == *name);
        let determined = tie.is_some_and(|tie| tie.delay == *name);
        is_card && name != problem.small && (mentioned || tied) && !determined
    }

    /// Slopes and verdict.
    fn conclude(
        &self,
        (condition, order): (Condition, usize),
        question: &Verify,
        digits: u32,
        mut table: Vec<Comparison>,
    ) -> Verification {
        let limit = slopes(&mut table);
        let observed = table.last().and_then(|last| last.slope);
        let drowned = |c: &Comparison| c.simulation_error.clone() * 1000u32 > c.error;
        let resolved = !table.iter().rev().take(2).any(drowned);
        let small_enough = !table.iter().rev().take(2).any(|c| c.error >= c.size);
        let limit = limit.filter(|n| observed.is_some_and(|slope| (slope - n).abs() <= TOLERANCE));
        let expected = order as f64 + 1.0;
        // The error of a wrong order is C eps^n with a whole n: another limit is not one yet.
        let power = limit.filter(|n| (n - n.round()).abs() <= TOLERANCE);
        let near = |n: f64| (n - expected).abs() <= TOLERANCE;
        let verdict = match power {
            _ if !resolved || !small_enough => Verdict::Undecided,
            _ if observed.is_some_and(near) => Verdict::Agrees,
            Some(n) if n < expected && !near(n) => Verdict::Disagrees,
            Some(_) => Verdict::Agrees,
            None => Verdict::Undecided,
        };
        let mut found = Verification {
            parameter: self.problem().small.to_string(),
            digits,
            normalisation: condition,
            periods: question.periods,
            table,
            observed_order: observed,
            expected_order: order + 1,
            settled: limit.is_some(),
            tolerance: TOLERANCE,
            verdict,
            reason: String::new(),
            resolved,
            small_enough,
        };
        found.reason = found.words();
        found
    }
}

impl Verification {
    /// The verdict in words.
    fn words(&self) -> String {
        let expected = self.expected_order;
        let few = self.table.len() < 3;
        match (self.verdict, self.observed_order) {
            (Verdict::Agrees, Some(slope)) if slope > expected as f64 + TOLERANCE => format!(
                "agrees: observed order {slope:.4}, expected at least {expected}: the terms left out begin later"
            ),
            (Verdict::Agrees, Some(slope)) => {
                format!("agrees: observed order {slope:.4}, expected {expected}")
            }
            (Verdict::Disagrees, Some(slope)) => {
                format!(
                    "disagrees: observed order {slope:.4}, expected {expected} within {TOLERANCE}"
                )
            }
            (Verdict::Undecided, Some(_)) if self.resolved && !self.small_enough => {
                "undecided: the difference is as large as the motion; smaller --small".to_owned()
            }
            (Verdict::Undecided, Some(slope)) if self.resolved => format!(
                "undecided: observed order {slope:.4} has not settled, expected {expected}; smaller --small{}",
                if few { ", at least three of them" } else { "" }
            ),
            _ => "undecided: the error of the integration is not small against the difference; \
                  more --digits or larger --small"
                .to_owned(),
        }
    }
}

/// With the digits asked for; otherwise with so many that the errors of the size eps^(N+1) are
/// resolved, and with more where a small constant in front of it needs them.
fn with_digits(
    order: usize,
    condition: Condition,
    question: &Verify,
    run: &mut dyn FnMut(u32) -> Result<Verification, Error>,
) -> Result<Verification, Error> {
    if let Some(digits) = question.digits {
        return run(digits);
    }
    let mut digits = digits(order, condition, question);
    for _ in 1..MOST_TRIES {
        let found = run(digits)?;
        if found.resolved {
            return Ok(found);
        }
        digits = digits.saturating_add(digits / 2);
    }
    run(digits)
}

/// A comparison at one value, which asks now and then whether to go on.
type Compare<'a> = dyn Fn(&Rational, &dyn Fn() -> bool) -> Result<Comparison, Error> + Sync + 'a;

/// All comparisons, on as many threads as there are processors; the observer stays on this one.
fn compare_all(
    question: &Verify,
    order: usize,
    compare: &Compare<'_>,
    work: &Work,
) -> Result<Vec<Comparison>, Error> {
    let values = &question.small;
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(values.len());
    let (sender, receiver) = mpsc::channel::<Option<(usize, Result<Comparison, Error>)>>();
    let mut found: Vec<Option<Result<Comparison, Error>>> = values.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (sender, next, stopped) = (sender.clone(), &next, &stopped);
            scope.spawn(move || {
                // Every step of an integration wakes the observer.
                let goes_on = || sender.send(None).is_ok() && !stopped.load(Ordering::Relaxed);
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(value) = values.get(index).filter(|_| goes_on()) else { return };
                    let _ = sender.send(Some((index, compare(value, &goes_on))));
                }
            });
        }
        drop(sender);
        let mut done = 0;
        for message in receiver {
            if let Some((index, result)) = message {
                done += 1;
                // The others are of no use any more.
                stopped.fetch_or(result.is_err(), Ordering::Relaxed);
                if let Some(place) = found.get_mut(index) {
                    *place = Some(result);
                }
            }
            if !stopped.load(Ordering::Relaxed) && !work.goes_on(Progress::Integrating(done)) {
                stopped.store(true, Ordering::Relaxed);
            }
        }
    });
    let interrupted = || Error::from(ExpandError::Interrupted { order });
    let is_reason = |e: &Error| !e.is_interrupted();
    let reason = found.iter().flatten().find_map(|r| r.as_ref().err().filter(|e| is_reason(e)));
    if let Some(reason) = reason {
        return Err(reason.clone());
    }
    found.into_iter().map(|result| result.unwrap_or_else(|| Err(interrupted()))).collect()
}

/// The slope of every line but the first, and the limit that the last two extrapolate to.
fn slopes(comparisons: &mut [Comparison]) -> Option<f64> {
    let size = |c: &Comparison| Float::with_val(80, &c.small).abs().ln().to_f64();
    for i in 1..comparisons.len() {
        let log = |c: &Comparison| c.error.clone().ln().to_f64();
        let [before, after] = [&comparisons[i - 1], &comparisons[i]];
        let slope = (log(after) - log(before)) / (size(after) - size(before));
        comparisons[i].slope = slope.is_finite().then_some(slope);
    }
    // e = C eps^n (1 + c eps + ...) has ln e(eps_1)/e(eps_2) = n ln eps_1/eps_2 + c (eps_1 - eps_2):
    // from two slopes n and what the last slope lacks.
    match &comparisons[..] {
        [.., before, middle, last] => middle.slope.zip(last.slope).map(|(first, second)| {
            let steps = [size(before) - size(middle), size(middle) - size(last)];
            let falls = [steps[0].exp_m1(), -(-steps[1]).exp_m1()];
            let [far, near] = [falls[0] / steps[0], falls[1] / steps[1]];
            second - (second - first) * near / (near - far)
        }),
        _ => None,
    }
}

/// Enough for errors of the size eps^(N+1), and for the slow approach to a limit cycle, which
/// multiplies the errors of the return map by about 1/eps.
fn digits(order: usize, condition: Condition, question: &Verify) -> u32 {
    let sizes = question.small.iter().map(|q| -Float::with_val(80, q).abs().log10().to_f64());
    let decades = sizes.fold(0.0, f64::max).min(1e6);
    let cycle = if condition == Condition::LimitCycle { 2.0 * decades } else { 0.0 };
    ((order as f64 + 1.0) * decades + cycle).ceil() as u32 + 16
}

/// The parameters of a problem for the integrator: given, or by default, with the delay that is a
/// number of periods of the force. What has no value is left out.
#[must_use]
pub fn quantities(problem: &Problem, given: &BTreeMap<String, Exact>) -> Parameters {
    let mut parameters = Parameters::new();
    let value = |name: &str| {
        let card = problem.parameters.iter().find(|card| card.name == name);
        let default = || Exact::parse(&card?.default).ok();
        given.get(name).cloned().or_else(default)
    };
    for card in &problem.parameters {
        if let Some(value) = value(&card.name) {
            parameters.set(&card.name, value);
        }
    }
    if let Some(tie) = &problem.synchronous
        && let (Some(Exact::Rational(k)), Some(omega)) =
            (value(&tie.periods), value(&tie.frequency))
    {
        let two_k = k * 2u32;
        let period = match &omega {
            Exact::Rational(w) if !w.is_zero() => Some(Exact::pi_times(two_k / w)),
            Exact::PiTimes(w) if !w.is_zero() => Some(Exact::from(two_k / w)),
            _ => None,
        };
        if let Some(period) = period {
            parameters.set(&tie.delay, period);
        }
    }
    parameters
}
