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

use crate::derivation::condition;
use crate::{Derivation, Error, Exact, Progress, Settings, derive};
use drifting::Drifting;
use lindstedt_equation::{Condition, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_simulate::Parameters;
use periodic::Periodic;
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

/// The observed order may differ from N + 1 by so much.
pub const TOLERANCE: f64 = 0.05;

/// Integrations with more digits each, until the differences are resolved.
const MOST_TRIES: usize = 3;

/// What to verify.
#[derive(Clone, Debug)]
pub struct VerifySettings {
    /// N.
    pub order: usize,
    /// The normalisation; the problem's default if nothing.
    pub condition: Option<Condition>,
    /// Values of the small parameter, each smaller in modulus than the one before, none zero.
    pub small: Vec<Rational>,
    /// The window: so many periods 2 pi/omega_N (2 pi/omega_0 with a free amplitude).
    pub periods: u32,
    /// Points of the window.
    pub samples: u32,
    /// Digits of the integration; by default enough for the smallest error expected.
    pub digits: Option<u32>,
    /// Values of parameters by name; with a free amplitude, `amplitude` is a(0), by default 1.
    pub parameters: BTreeMap<String, Exact>,
    /// The memory that may be used, in bytes.
    pub memory: u64,
}

impl Default for VerifySettings {
    /// Order 4 at 1/1000, 1/2000, 1/4000, 1/8000 on one period.
    fn default() -> Self {
        Self {
            order: 4,
            condition: None,
            small: (0..4).map(|j| Rational::from((1, 1000 << j))).collect(),
            periods: 1,
            samples: 48,
            digits: None,
            parameters: BTreeMap::new(),
            memory: 8 << 30,
        }
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

/// What the comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// The result of [`verify`].
#[derive(Clone, Debug)]
pub struct Verification {
    /// N.
    pub order: usize,
    /// The name of the small parameter.
    pub parameter: String,
    /// The normalisation.
    pub condition: Condition,
    /// One line per value, in the order given.
    pub comparisons: Vec<Comparison>,
    /// The slope between the last two values.
    pub observed: Option<f64>,
    /// The last slope is within [`TOLERANCE`] of the limit that it and the one before extrapolate to
    /// (three values).
    pub settled: bool,
    /// The errors of the last two values are above those of the integration.
    pub resolved: bool,
    /// The last errors are smaller than the motion.
    pub small_enough: bool,
    /// The verdict.
    pub verdict: Verdict,
    /// The digits of the integration.
    pub digits: u32,
}

/// Compares the expansion of a problem with the time domain.
///
/// `observer` is told the progress of the derivation and of the integrations; when it returns
/// `false` both stop, with [`ExpandError::Interrupted`].
///
/// Errors: those of [`derive()`] and [`crate::averaging::average`]; [`Error::Simulate`];
/// [`Error::NoPeriodicOrbit`]; [`Error::LongDelay`]. Cost: two integrations per value.
///
/// # Example
/// ```
/// use lindstedt::{problems, verify::{Verdict, VerifySettings, verify}};
/// let problem = problems::find("duffing").ok_or("no such problem")?;
/// let found = verify(&problem, &VerifySettings { order: 2, ..Default::default() }, &mut |_| true)?;
/// assert_eq!(found.verdict, Verdict::Agrees);
/// assert!(found.observed.is_some_and(|slope| (slope - 3.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn verify(
    problem: &Problem,
    settings: &VerifySettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Verification, Error> {
    let condition = condition(problem, settings.condition)?;
    if condition == Condition::FreeAmplitude {
        let order = settings.order;
        return with_digits(order, condition, settings, &mut |digits| {
            let expansion = Drifting::new(problem, settings, digits, observer)?;
            let compare = |small: &Rational, goes_on: &dyn Fn() -> bool| {
                expansion.compare(small, digits, goes_on)
            };
            let comparisons = compare_all(&settings.small, order, &compare, observer)?;
            Ok(conclude(problem, condition, order, digits, comparisons))
        });
    }
    let derived = Settings {
        order: settings.order,
        condition: Some(condition),
        parameters: settings.parameters.clone(),
        memory: settings.memory,
        ..Settings::default()
    };
    let derivation = derive(problem, &derived, observer)?;
    verify_derivation(problem, &derivation, settings, observer)
}

/// As [`verify`], for an expansion of the problem that is there; its order and its condition
/// count, not those of the settings.
///
/// # Errors
/// As [`verify`].
pub fn verify_derivation(
    problem: &Problem,
    derivation: &Derivation,
    settings: &VerifySettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Verification, Error> {
    let (order, condition) = (derivation.order, derivation.condition);
    with_digits(order, condition, settings, &mut |digits| {
        let expansion = Periodic::new(problem, derivation, settings, digits)?;
        let compare = |small: &Rational, goes_on: &dyn Fn() -> bool| {
            expansion.compare(small, digits, goes_on)
        };
        let comparisons = compare_all(&settings.small, order, &compare, observer)?;
        Ok(conclude(problem, condition, order, digits, comparisons))
    })
}

/// With the digits asked for; otherwise with so many that the errors of the size eps^(N+1) are
/// resolved, and with more where a small constant in front of it needs them.
fn with_digits(
    order: usize,
    condition: Condition,
    settings: &VerifySettings,
    run: &mut dyn FnMut(u32) -> Result<Verification, Error>,
) -> Result<Verification, Error> {
    if let Some(digits) = settings.digits {
        return run(digits);
    }
    let mut digits = digits(order, condition, settings);
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
    values: &[Rational],
    order: usize,
    compare: &Compare<'_>,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Vec<Comparison>, Error> {
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
            if !stopped.load(Ordering::Relaxed) && !observer(Progress::Integrating(done)) {
                stopped.store(true, Ordering::Relaxed);
            }
        }
    });
    let interrupted = || Error::from(ExpandError::Interrupted { order });
    let is_reason = |e: &Error| !matches!(e, Error::Expand(ExpandError::Interrupted { .. }));
    let reason = found.iter().flatten().find_map(|r| r.as_ref().err().filter(|e| is_reason(e)));
    if let Some(reason) = reason {
        return Err(reason.clone());
    }
    found.into_iter().map(|result| result.unwrap_or_else(|| Err(interrupted()))).collect()
}

/// Slopes and verdict.
fn conclude(
    problem: &Problem,
    condition: Condition,
    order: usize,
    digits: u32,
    mut comparisons: Vec<Comparison>,
) -> Verification {
    let size = |c: &Comparison| Float::with_val(80, &c.small).abs().ln().to_f64();
    for i in 1..comparisons.len() {
        let log = |c: &Comparison| c.error.clone().ln().to_f64();
        let [before, after] = [&comparisons[i - 1], &comparisons[i]];
        let slope = (log(after) - log(before)) / (size(after) - size(before));
        comparisons[i].slope = slope.is_finite().then_some(slope);
    }
    let observed = comparisons.last().and_then(|last| last.slope);
    let drowned = |c: &Comparison| c.simulation_error.clone() * 1000u32 > c.error;
    let resolved = !comparisons.iter().rev().take(2).any(drowned);
    let small_enough = !comparisons.iter().rev().take(2).any(|c| c.error >= c.size);
    // e = C eps^n (1 + c eps + ...) has ln e(eps_1)/e(eps_2) = n ln eps_1/eps_2 + c (eps_1 - eps_2):
    // from two slopes n and what the last slope lacks.
    let limit = match &comparisons[..] {
        [.., before, middle, last] => middle.slope.zip(last.slope).map(|(first, second)| {
            let steps = [size(before) - size(middle), size(middle) - size(last)];
            let falls = [steps[0].exp_m1(), -(-steps[1]).exp_m1()];
            let [far, near] = [falls[0] / steps[0], falls[1] / steps[1]];
            second - (second - first) * near / (near - far)
        }),
        _ => None,
    };
    let limit = limit.filter(|n| observed.is_some_and(|slope| (slope - n).abs() <= TOLERANCE));
    let settled = limit.is_some();
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
    let parameter = problem.small.to_string();
    Verification {
        order,
        parameter,
        condition,
        comparisons,
        observed,
        settled,
        resolved,
        small_enough,
        verdict,
        digits,
    }
}

/// Enough for errors of the size eps^(N+1), and for the slow approach to a limit cycle, which
/// multiplies the errors of the return map by about 1/eps.
fn digits(order: usize, condition: Condition, settings: &VerifySettings) -> u32 {
    let sizes = settings.small.iter().map(|q| -Float::with_val(80, q).abs().log10().to_f64());
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
