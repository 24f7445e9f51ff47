//! Averaged expansions against the time domain: x_N(t) by the truncated rates of a and psi.

use super::resonant::in_time;
use super::sampled::{largest_gaps, sample_times, states};
use super::{Comparison, Verify};
use crate::{Error, Oscillator, Progress};
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::averaging::numbers::{Numbers, numbers};
use lindstedt_derivation::{DerivationError, all_values};
use lindstedt_equation::Expression;
use lindstedt_evaluation::averaged::Truncated;
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{
    Digits, Integrator, Model, Parameters, Places, Real, Report, Settings as Precision, System,
};
use rug::ops::Pow;
use rug::{Float, Rational};
use std::ops::ControlFlow;

/// An averaged expansion and its judge.
pub(super) struct Drifting {
    bits: u32,
    numbers: Numbers,
    /// a(0).
    start: Float,
    times: Vec<Float>,
    model: Model,
    parameters: Parameters,
    small: String,
}

impl Drifting {
    pub(super) fn new(
        oscillator: &Oscillator,
        question: &Verify,
        digits: u32,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Self, Error> {
        let problem = oscillator.problem();
        let bits = Digits::for_digits(digits + 16).bits();
        let balls = Balls::new(bits);
        let mut parameters = all_values(problem, oscillator.given());
        let start = match parameters.remove("amplitude") {
            Some(value) => Float::with_val(bits, value.ball(balls).midpoint()),
            None => Float::with_val(bits, 1),
        };
        if start <= 0 {
            let value = start.to_string_radix(10, Some(6));
            let domain = "amplitude > 0";
            let name = "amplitude".into();
            return Err(DerivationError::OutsideDomain { name, value, domain }.into());
        }
        let asked = AveragingSettings {
            order: question.order,
            parameters,
            digits: usize::try_from(digits).unwrap_or(usize::MAX),
            ..AveragingSettings::default()
        };
        // Half of the bits are sure.
        let numbers = numbers(problem, &asked, bits.saturating_mul(2), observer)?;
        let order = numbers.solution.len().saturating_sub(1);
        if order < question.order {
            return Err(ExpandError::Interrupted { order }.into());
        }
        let times = sample_times(question, &numbers.frequency);
        let mut judged = problem.clone();
        judged.impact = None;
        Ok(Self {
            bits,
            start,
            times,
            model: Model::of_problem(&judged)?,
            parameters: Parameters::of_problem(problem, oscillator.given()),
            small: problem.small.to_string(),
            numbers,
        })
    }

    fn truncated(&self, small: &Rational) -> Truncated {
        let order = self.numbers.solution.len().saturating_sub(1);
        Truncated::new(&self.numbers, &Float::with_val(self.bits, small), order)
    }

    pub(super) fn compare(
        &self,
        small: &Rational,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Comparison, Error> {
        let truncated = self.truncated(small);
        let expected = self.expansion(&truncated, digits + 16, goes_on)?;
        let start = truncated.state(&[self.start.clone(), Float::new(self.bits)]);
        let history = self.history(&truncated, digits + 16)?;
        let coarse = self.run(small, &start, history.as_ref(), digits, goes_on)?;
        let fine = self.run(small, &start, history.as_ref(), digits + 8, goes_on)?;
        Ok(largest_gaps(small, &expected, &coarse, &fine))
    }

    /// x_N at the times.
    fn expansion(
        &self,
        truncated: &Truncated,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Float>, Error> {
        let real = Digits::for_digits(digits);
        let system = truncated.system(real, false)?;
        let start = [real.float(&self.start), real.zero()];
        let lists = self.values(&system, &start, &[0, 1], digits, goes_on)?;
        let all = lists[0].iter().cloned().zip(lists[1].iter().cloned()).zip(&self.times);
        Ok(all.map(|((a, psi), t)| truncated.value(&[a, psi], t)).collect())
    }

    /// x_N(t) before t = 0 as an expression in t, where there is a delay: a and psi by their Taylor
    /// polynomials about 0, which converge on the slow scale 1/eps.
    fn history(&self, truncated: &Truncated, digits: u32) -> Result<Option<Expression>, Error> {
        let Some(longest) = self.numbers.delays.iter().max_by(|a, b| a.total_cmp(b)) else {
            return Ok(None);
        };
        let real = Digits::for_digits(digits);
        let system = truncated.system(real, true)?;
        let start = [real.float(&self.start), real.zero()];
        let precision = Precision::for_digits(digits);
        let mut flow = Integrator::new(&system, &real.zero(), &start, precision)?;
        let mut polynomials = None;
        let end = real.float(longest);
        flow.advance(&end, &mut |report| {
            let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
            let list = |state| segment.coefficients(state).map(<[Float]>::to_vec);
            polynomials = list(0).zip(list(1));
            ControlFlow::Break(())
        })?;
        let (Some((a, psi)), true) = (polynomials, *flow.time() >= end) else {
            let delay = longest.to_string_radix(10, Some(6));
            return Err(Error::LongDelay { delay });
        };
        let floor = Float::with_val(64, 2).pow(-i64::from(self.bits));
        let kept = |c: &[Float]| {
            let small = |(k, c): &(usize, &Float)| {
                Float::with_val(64, longest.pow(*k as u32)) * (*c).clone().abs() < floor
            };
            in_time(&c[..c.iter().enumerate().rev().skip_while(small).count()])
        };
        Ok(Some(truncated.history(&[kept(&a), kept(&psi)])))
    }

    /// x at the times.
    fn run(
        &self,
        small: &Rational,
        start: &[Float; 2],
        history: Option<&Expression>,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Float>, Error> {
        let real = Digits::for_digits(digits);
        let parameters = self.parameters.clone().with(&self.small, small.clone());
        let mut model = self.model.clone();
        if let Some(history) = history {
            model = model.with_history(std::slice::from_ref(history));
        }
        let system = model.compile(real, &parameters)?;
        let start = start.each_ref().map(|x| real.float(x));
        Ok(self.values(&system, &start, &[0], digits, goes_on)?.concat())
    }

    fn values(
        &self,
        system: &System<Digits>,
        start: &[Float],
        places: &[usize],
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Vec<Float>>, Error> {
        let order = self.numbers.solution.len().saturating_sub(1);
        states(system, start, places, (&self.times, order), digits, goes_on)
    }
}
