//! The question for an averaged motion, and its plain form.

use super::{AveragedMotion, Moment, Motion, ORDER};
use crate::evaluate::json::Digits;
use crate::oscillator::condition_name;
use crate::{Answer, Error, Kind, Number, Oscillator, Refusal, Remark, Standing, Work};
use lindstedt_equation::Condition;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::time::Instant;

/// Turns shown where no times are given.
const TURNS: f64 = 10.0;

impl Oscillator {
    /// The rates of an averaged motion at its start, and with times a(t), psi(t) and x(t).
    ///
    /// Everything is estimated. Stopped work leaves the orders and times that were reached; a motion
    /// that ends before the last time is no complete answer either, and says why it ends.
    ///
    /// # Errors
    /// [`Error::Unset`] for a parameter without a value; [`Error::NoSuchStart`]; a refusal where the
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
        let case = free.with_order_parameter();
        let mut remarks = self.remarks().to_vec();
        let from = match &question.start {
            Some(from) => from.clone(),
            None => {
                let (from, remark) = case.averaged_start(question.times.is_some())?;
                remarks.extend(remark);
                from
            }
        };
        let order = question.order.unwrap_or(ORDER);
        let motion = Motion::new(&case, order, &from, work);
        let mut value = motion.map_err(|error| case.unevaluated(error))?;
        let times = question.times.as_ref().map(|times| times.list(TURNS * value.turn()));
        value.moments = times.as_ref().map(|times| value.at(times, work));
        let wanted = times.map_or(0, |times| times.len());
        let standing = value.standing(order, wanted);
        let said = match (standing, &value.ended) {
            (Standing::Complete, _) => None,
            (_, Some(_)) => Some("the averaged motion ends; the times after that are missing"),
            (_, None) => Some("stopped; orders or times not reached are missing"),
        };
        remarks.extend(said.map(|words| Remark(words.to_owned())));
        let at = value.at.iter().map(|(name, value)| (name.clone(), value.to_string())).collect();
        let header = self.header(at, Some(value.order), "averaging", start);
        Ok(Answer { header, value, standing, remarks })
    }
}

impl Motion {
    /// How far the motion goes. No step short enough is no proof that there is no motion.
    fn standing(&self, order: usize, times: usize) -> Standing {
        let done = self.moments.as_ref().map_or(0, Vec::len);
        match &self.ended {
            _ if self.order == order && done == times => Standing::Complete,
            Some(reason) if reason.kind() == Kind::NoAnswer => Standing::NoAnswer,
            Some(_) => Standing::Undecided,
            None => Standing::Stopped { done },
        }
    }
}

#[derive(Serialize)]
struct At {
    a: f64,
    psi: f64,
}

#[derive(Serialize)]
struct Rates<'a> {
    amplitude: f64,
    phase: f64,
    amplitude_number: Digits<'a>,
    phase_number: Digits<'a>,
}

#[derive(Serialize)]
struct Moments<'a> {
    order: usize,
    resum: &'static str,
    values: &'a [Moment],
}

impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let linear = |k: usize| self.linear.as_ref().map(|numbers| Digits::of(numbers[k].as_ref()));
        let [a, psi] = self.start;
        let [amplitude, phase] = self.rates();
        let [amplitude_number, phase_number] =
            self.rate_numbers.each_ref().map(|number| Digits::of(number.as_ref()));
        let rates = Rates { amplitude, phase, amplitude_number, phase_number };
        let moments = self.moments.as_deref();
        let solution = moments.map(|values| Moments { order: self.order, resum: "none", values });
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("resum", "none")?;
        map.serialize_entry("normalisation", condition_name(Condition::FreeAmplitude))?;
        map.serialize_entry("period", &None::<Number>)?;
        map.serialize_entry("frequency", &linear(1))?;
        map.serialize_entry("growth_rate", &linear(0))?;
        map.serialize_entry("exact_period", &None::<Number>)?;
        map.serialize_entry("start", &At { a, psi })?;
        map.serialize_entry("rates", &rates)?;
        map.serialize_entry("term_ratio", &self.ratio)?;
        map.serialize_entry("integration_error", &self.integration_error)?;
        map.serialize_entry("verdict", &self.verdict())?;
        map.serialize_entry("solution", &solution)?;
        map.end()
    }
}

impl Serialize for Moment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.time.to_string())?;
        map.serialize_entry("a", &Digits::of(self.amplitude.value.as_ref()))?;
        map.serialize_entry("psi", &Digits::of(self.phase.value.as_ref()))?;
        map.serialize_entry("x", &Digits::of(self.displacement.value.as_ref()))?;
        map.end()
    }
}
