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
//!   A wall takes no part: the expansion is that of the flight;
//! - slow flow (averaging at resonance): the same with z_j(0) = a/2 in place of a and psi, for all unknowns
//!   at once, those of the modes where the linear part couples them.
//!
//! The steady states of a slow flow are compared with the periodic orbits of the equation as well: over a time of order 1/eps
//! an error of order eps^(N+1) in z' moves them by eps^N.

mod cycle;
mod drifting;
mod periodic;
mod resonant;
mod run;
mod sampled;
mod steady;
mod verdict;

use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Answer, Derivation, Error, Exact, Oscillator, Standing, Work};
use drifting::Drifting;
use lindstedt_derivation::condition;
use lindstedt_derivation::{Settings, derive};
use lindstedt_equation::{AmplitudeRole, Condition};
use lindstedt_expand::ExpandError;
use periodic::Periodic;
use resonant::Resonant;
use rug::Rational;
use run::{Compare, compare_all, with_digits};
use serde::Serialize;
use std::time::Instant;
pub use steady::{SteadyDifference, SteadyState, SteadyStates};
pub use verdict::{Comparison, TOLERANCE, Verification};

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

/// What to verify.
///
/// ```
/// use lindstedt::{Oscillator, Verify, Work, verify::Verdict};
/// let small = Verify::read_small("1/100,1/200,1/400")?;
/// let question = Verify { order: 1, small, ..Verify::default() };
/// let cycle = Oscillator::builtin("van-der-pol")?;
/// assert_eq!(cycle.verify(&question, &Work::default())?.value.verdict, Verdict::Agrees);
/// # Ok::<(), lindstedt::Error>(())
/// ```
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
        let mut list: Vec<Rational> = Vec::new();
        for part in text.split(',') {
            let value = Exact::parse(part)?;
            let rational = value.as_rational().cloned();
            list.push(rational.ok_or_else(|| Self::wrong(format!("{part:?} is irrational")))?);
        }
        let question = Self { small: list, ..Self::default() };
        question.check_small()?;
        Ok(question.small)
    }

    fn wrong(message: String) -> Refused {
        Refused::usage("small", message, "1/100,1/200,1/400")
    }

    /// 2 to 100 values that decrease in modulus, none zero.
    fn check_small(&self) -> Result<(), Refused> {
        if self.small.iter().any(Rational::is_zero) {
            return Err(Self::wrong("0 is no value of a small parameter".to_owned()));
        }
        if let Some(pair) = self.small.windows(2).find(|pair| pair[1].cmp_abs(&pair[0]).is_ge()) {
            let message = format!("{} is not smaller than the value before", pair[1]);
            return Err(Self::wrong(message));
        }
        if self.small.len() < 2 || self.small.len() > 100 {
            return Err(Self::wrong("2 to 100 values are needed".to_owned()));
        }
        Ok(())
    }
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
        question.check_small()?;
        self.values_without_pi()?;
        self.check_free()?;
        self.check_frequencies()?;
        let flows = self.has_flow_alone();
        if !flows {
            self.check()?;
        }
        if self.condition().is_none() {
            let message = format!("{} has no expansion that could be verified", self.origin());
            let hint = "`simulate` takes it, `problems --show` lists the methods";
            return Err(Refused::no_answer("no-expansion", message, hint).into());
        }
        let condition = condition(self.problem(), self.asked_condition())?;
        let found = if condition == Condition::FreeAmplitude {
            match flows {
                true => self.resonant(question, work),
                false => match self.drifting(question, work) {
                    Err(error) if error.is_resonance() => self.resonant(question, work),
                    other => other,
                },
            }
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
        let header = self.header(self.given(), Some(question.order), "time domain", start);
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
    ///
    /// ```
    /// use lindstedt::{Oscillator, Verify, Work, verify::Verdict};
    /// let (duffing, work) = (Oscillator::parse("x'' + x + eps*x^3 = 0")?, Work::default());
    /// let expansion = duffing.derive(1, &work)?.value;
    /// let found = duffing.verify_derivation(&expansion, &Verify::default(), &work)?.value;
    /// assert!(found.observed_order.is_some_and(|slope| (slope - 2.0).abs() < 0.01));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn verify_derivation(
        &self,
        derivation: &Derivation,
        question: &Verify,
        work: &Work,
    ) -> Result<Answer<Verification>, Error> {
        let start = Instant::now();
        question.check_small()?;
        let value = self.against_time(derivation, question, work)?;
        let header = self.header([("", ""); 0], Some(derivation.order), "time domain", start);
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
        self.free(question, work, &|digits| {
            let expansion = Drifting::new(self, question, digits, &mut |p| work.goes_on(p))?;
            Ok(Box::new(move |value, goes_on| expansion.compare(value, digits, goes_on)))
        })
    }

    fn resonant(&self, question: &Verify, work: &Work) -> Result<Verification, Error> {
        let mut found = self.free(question, work, &|digits| {
            let expansion = Resonant::new(self, question, digits, &mut |p| work.goes_on(p))?;
            Ok(Box::new(move |value, goes_on| expansion.compare(value, digits, goes_on)))
        })?;
        found.steady = Some(SteadyStates::of(self, question, work));
        Ok(found)
    }

    /// All comparisons of an expansion with free amplitude.
    fn free(
        &self,
        question: &Verify,
        work: &Work,
        judge: &dyn Fn(u32) -> Result<Box<Compare<'static>>, Error>,
    ) -> Result<Verification, Error> {
        let (small, order) = (&*self.problem().small, question.order);
        with_digits(order, Condition::FreeAmplitude, question, &mut |digits| {
            let found = compare_all(question, order, &*judge(digits)?, work)?;
            let what = (Condition::FreeAmplitude, order);
            Ok(Verification::new(small, what, question, digits, found))
        })
    }

    fn against_time(
        &self,
        derivation: &Derivation,
        question: &Verify,
        work: &Work,
    ) -> Result<Verification, Error> {
        let (order, condition) = (derivation.order, derivation.condition);
        let small = &*self.problem().small;
        with_digits(order, condition, question, &mut |digits| {
            let expansion = Periodic::new(self, derivation, question, digits)?;
            let compare = |value: &Rational, goes_on: &dyn Fn() -> bool| {
                expansion.compare(value, digits, goes_on)
            };
            let found = compare_all(question, order, &compare, work)?;
            Ok(Verification::new(small, (condition, order), question, digits, found))
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
        let mentioned =
            problem.equations().any(|e| e.parameters().iter().any(|known| known == name));
        let tie = problem.synchronous.as_ref();
        let tied = tie.is_some_and(|tie| tie.periods == *name);
        let determined = tie.is_some_and(|tie| tie.delay == *name);
        is_card && name != problem.small && (mentioned || tied) && !determined
    }
}
