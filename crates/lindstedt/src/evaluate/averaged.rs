//! The question for an averaged motion.

use super::Times;
use crate::classification::hint::in_numbers;
use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Answer, Error, Exact, Kind, Oscillator, Refusal, Remark, Standing, Work};
use lindstedt_equation::Condition;
use lindstedt_equation::classify::{Method, Reason};
pub use lindstedt_evaluation::averaged::{Ended, Moment, Motion, Quantity, Start, SummedCycle};
use rug::Rational;
use std::time::Instant;

/// What to evaluate of an averaged motion.
#[derive(Clone, Debug, Default)]
pub struct AveragedMotion {
    /// N; 4 if nothing.
    pub order: Option<usize>,
    /// The start; if nothing that of the file, else the amplitude of the problem at phase 0.
    pub start: Option<Start>,
    /// The times at which the motion is asked for.
    pub times: Option<Times>,
}

/// The order if none is asked for.
const ORDER: usize = 4;

/// Turns shown where no times are given.
const TURNS: f64 = 10.0;

impl Oscillator {
    /// The rates of an averaged motion at its start, and with times a(t), psi(t) and x(t).
    ///
    /// Everything is estimated. Stopped work leaves the orders and times that were reached; a motion
    /// that ends before the last time is no complete answer either, and says why it ends.
    ///
    /// # Errors
    /// [`DerivationError::Unset`](crate::DerivationError::Unset) for a parameter without a value; [`EvaluationError::NoSuchStart`](crate::EvaluationError::NoSuchStart); a refusal where the
    /// motion has no start; those of [`Oscillator::average`].
    ///
    /// ```
    /// use lindstedt::evaluate::Times;
    /// use lindstedt::evaluate::averaged::{AveragedMotion, Start};
    /// use lindstedt::{Oscillator, Work};
    /// let cycle = Oscillator::builtin("van-der-pol")?.set("eps", "1/10")?;
    /// let question = AveragedMotion {
    ///     start: Some(Start::parse_amplitude("1,0")?),
    ///     times: Some(Times::parse("0..100:2")?),
    ///     ..AveragedMotion::default()
    /// };
    /// let work = Work { digits: 12, ..Work::default() };
    /// let far = cycle.averaged_motion(&question, &work)?.value.moments.unwrap_or_default();
    /// // The limit cycle has amplitude 2 + O(eps^2).
    /// assert!((far[1].amplitude.double - 2.0).abs() < 1e-3);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn averaged_motion(
        &self,
        question: &AveragedMotion,
        work: &Work,
    ) -> Result<Answer<Motion>, Error> {
        let start = Instant::now();
        self.without_pi()?;
        let free = self.clone().under(Condition::FreeAmplitude)?;
        free.check()?;
        let (case, remark) = free.with_order_parameter().with_powers_put_in()?;
        let mut remarks = self.remarks().to_vec();
        remarks.extend(remark);
        let from = match &question.start {
            Some(from) => from.clone(),
            None => {
                let (from, remark) = case.averaged_start(question.times.is_some())?;
                remarks.extend(remark);
                from
            }
        };
        let order = question.order.unwrap_or(ORDER);
        let motion = Motion::new(case.problem(), case.given(), order, &from, work);
        let mut value = motion.map_err(|error| case.not_averaged(error.into()))?;
        let times = question.times.as_ref().map(|times| times.list(TURNS * value.turn()));
        value.moments = times.as_ref().map(|times| value.at(times, work));
        let wanted = times.map_or(0, |times| times.len());
        let standing = standing(&value, order, wanted);
        let said = match (standing, &value.ended) {
            (Standing::Complete, _) => None,
            (_, Some(_)) => Some("the averaged motion ends; the times after that are missing"),
            (_, None) => Some("stopped; orders or times not reached are missing"),
        };
        remarks.extend(said.map(|words| Remark(words.to_owned())));
        remarks.extend(value.degenerate.iter().map(|amplitude| {
            let a = amplitude.exact.as_ref().unwrap_or(&amplitude.decimal);
            Remark(format!(
                "at the amplitude {a} the leading rate has a multiple zero: whether cycles are there, and how many, it does not decide"
            ))
        }));
        if value.not_looked_for {
            let words = "limit cycles are not listed: the coefficients are irrational";
            remarks.push(Remark(words.to_owned()));
        }
        let header = self.header(value.at.clone(), Some(value.order), "averaging", start);
        Ok(Answer { header, value, standing, remarks })
    }
}

impl Oscillator {
    /// A refusal; of a law that is not smooth with what takes it.
    fn not_averaged(&self, error: Error) -> Error {
        let (error, parts) = (self.unevaluated(error), self.classify().ok());
        let law = parts.as_ref().and_then(|parts| parts.non_smooth.first());
        let (Some(parts), Some(law), "no-expansion") = (&parts, law, error.code()) else {
            return error;
        };
        let reason = Reason::NonSmooth(law.clone());
        let mut hint = in_numbers(parts, self.problem_file(), &reason);
        if parts.takes(Method::Averaging) {
            hint = format!("`derive --normalisation free` has the slow flow; {hint}");
        }
        let (kind, code, message) = (error.kind(), error.code(), error.to_string());
        Refused { code, kind, message, hint }.into()
    }

    /// The start of the file, or the amplitude of the problem at phase 0; where no motion is asked for
    /// an amplitude 1 shows the rates. With what is to be said of it.
    pub(super) fn averaged_start(&self, needed: bool) -> Result<(Start, Option<Remark>), Error> {
        if let Some([x, v]) = self.problem_file().initial.as_ref() {
            let remark = self.start_remark(Taken::Initial("--start AMPLITUDE,0"));
            return Ok((Start::State(Exact::parse(x)?, Exact::parse(v)?), remark));
        }
        let number = |n: u32| Exact::Rational(Rational::from(n));
        match self.value("amplitude") {
            Some(a) => Ok((Start::Amplitude(a, number(0)), None)),
            None if needed => {
                let message = "the amplitude is free: where does the motion start?";
                Err(Refused::usage("start", message, "--start A,PSI or --state X,V").into())
            }
            None => Ok((Start::Amplitude(number(1), number(0)), None)),
        }
    }
}

/// How far a motion goes. No step short enough is no proof that there is no motion.
fn standing(motion: &Motion, order: usize, times: usize) -> Standing {
    let done = motion.moments.as_ref().map_or(0, Vec::len);
    match &motion.ended {
        _ if motion.order == order && done == times => Standing::Complete,
        Some(Ended::Integration(reason)) if reason.kind() == Kind::NoAnswer => Standing::NoAnswer,
        Some(_) => Standing::Undecided,
        None => Standing::Stopped { done },
    }
}
