//! Slow flows against the time domain: x_N(t) by the truncated flow.

use super::sampled::{largest_gaps, sample_times, states};
use super::{Comparison, Verify};
use crate::{Error, Oscillator, Progress, SlowFlow};
use lindstedt_derivation::all_values;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Detuned, Motion, slow_flow};
use lindstedt_equation::Expression;
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{
    Digits, Integrator, Model, Parameters, Places, Real, Report, Settings as Precision,
};
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::ops::{Add, ControlFlow, Mul};

/// The derivative by t of a series in -t.
fn derivative(c: &[Float]) -> Vec<Float> {
    c.iter().enumerate().skip(1).map(|(k, c)| Float::with_val(c.prec(), c * -(k as i64))).collect()
}

/// A series in -t as a polynomial, by Horner's rule.
pub(super) fn in_time(c: &[Float]) -> Expression {
    let number = |(k, c): (usize, &Float)| {
        let q = c.to_rational().unwrap_or_default();
        Expression::Number(if k.is_multiple_of(2) { q } else { -q })
    };
    let mut all = c.iter().enumerate().rev().map(number);
    let last = all.next().unwrap_or_else(|| 0.into());
    all.fold(last, |sum, c| Expression::Time * sum + c)
}

/// A slow flow and its judge.
pub(super) struct Resonant {
    flow: SlowFlow,
    values: BTreeMap<String, Rational>,
    parameters: Parameters,
    times: Vec<Float>,
    /// 2 |z_j| at t = 0.
    amplitude: Rational,
}

impl Resonant {
    pub(super) fn new(
        oscillator: &Oscillator,
        question: &Verify,
        digits: u32,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Self, Error> {
        let problem = oscillator.problem();
        let mut parameters = all_values(problem, oscillator.given());
        parameters.remove("amplitude");
        let mentioned: Vec<String> = problem.equations().flat_map(|e| e.parameters()).collect();
        if let Some(name) = mentioned.iter().find(|name| !parameters.contains_key(*name)) {
            return Err(oscillator.unset(name));
        }
        let order = question.order;
        let asked = AveragingSettings { order, parameters, ..AveragingSettings::default() };
        let flow = slow_flow(problem, &asked, Detuned::Not, observer)?;
        if flow.order < order {
            return Err(ExpandError::Interrupted { order: flow.order }.into());
        }
        let slowest = flow.system.frequencies.iter().min().cloned().unwrap_or_default();
        let bits = Digits::for_digits(digits + 16).bits();
        let unit = flow.system.unit_value(&|_| None, Balls::new(bits)).ok_or(Error::NoValue)?;
        let times = sample_times(question, &(Float::with_val(bits, &slowest) * unit.midpoint()));
        let values = oscillator.rational_values();
        let amplitude = values.get("amplitude").cloned().unwrap_or_else(|| 1.into());
        let parameters = Parameters::of_problem(problem, oscillator.given());
        Ok(Self { flow, values, parameters, times, amplitude })
    }

    pub(super) fn compare(
        &self,
        small: &Rational,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Comparison, Error> {
        let value = |name: &str| self.values.get(name).cloned();
        let motions = self.flow.motions(small, &value, &self.amplitude);
        let [slow, full] = motions.ok_or(Error::NoValue)?;
        let unknowns = self.flow.unknowns();
        let model = |motion: &Motion| {
            let names: Vec<&str> = motion.names.iter().map(String::as_str).collect();
            Model::first_order(&names, &motion.rates)
        };
        let places: Vec<_> = (0..2 * unknowns).collect();
        let states = (&slow.start[..], &places[..]);
        let found = self.run((&model(&slow)?, &Parameters::new()), states, digits + 16, goes_on)?;
        let positions = self.flow.positions(small, &value).ok_or(Error::NoValue)?;
        let expected = found.iter().zip(&self.times);
        let expected = expected.map(|(state, time)| self.of_unknowns(&positions.at(state, time)));
        let expected: Vec<_> = expected.collect();
        let written = self.flow.system.shapes.is_some() || full.rates.is_empty();
        let (mut full, parameters, start) = match written {
            false => (model(&full)?, Parameters::new(), full.start),
            true => self.as_written(small, &full)?,
        };
        if let Some(longest) = self.flow.longest_delay(&value) {
            let slow = self.flow.with_positions(small, &value, &slow).ok_or(Error::NoValue)?;
            let histories = self.history(&slow, longest, digits + 16)?;
            let states = histories.iter().flat_map(|c| [in_time(c), in_time(&derivative(c))]);
            let states: Vec<_> =
                states.take(if unknowns == 1 { 1 } else { 2 * unknowns }).collect();
            full = full.with_history(&states);
        }
        // Every second state.
        let places: Vec<_> = (0..unknowns).map(|j| 2 * j).collect();
        let run = |digits| {
            self.run((&full, &parameters), (&start, &places), digits, goes_on).map(|x| x.concat())
        };
        Ok(largest_gaps(small, &expected.concat(), &run(digits)?, &run(digits + 8)?))
    }

    /// Taylor coefficients in -t of the unknowns of the user before t = 0, along the slow flow: with more of them the
    /// polynomials reach further back, as far as the slow flow has no singularity.
    fn history(
        &self,
        slow: &Motion,
        longest: Rational,
        digits: u32,
    ) -> Result<Vec<Vec<Float>>, Error> {
        let backwards = |e: &Expression| {
            let time = |e: &Expression| (*e == Expression::Time).then(|| -Expression::Time);
            (-e.clone()).map(&time).canonical()
        };
        let names: Vec<&str> = slow.names.iter().map(String::as_str).collect();
        let rates: Vec<_> = slow.rates.iter().map(backwards).collect();
        let real = Digits::for_digits(digits);
        let system = Model::first_order(&names, &rates)?.compile(real, &Parameters::new())?;
        let start: Vec<_> = slow.start.iter().map(|q| Float::with_val(real.bits(), q)).collect();
        let end = Float::with_val(real.bits(), &longest);
        for order in [64, 128, 256] {
            let precision = Precision { order: Some(order), ..Precision::for_digits(digits) };
            let mut flow = Integrator::new(&system, &real.zero(), &start, precision)?;
            let mut modes: Vec<Vec<Float>> = Vec::new();
            flow.advance(&end, &mut |report| {
                let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
                let unknowns = self.flow.unknowns();
                let places = 2 * unknowns..3 * unknowns;
                modes = places.filter_map(|k| Some(segment.coefficients(k)?.to_vec())).collect();
                ControlFlow::Break(())
            })?;
            if *flow.time() >= end && modes.len() == self.flow.unknowns() {
                let at =
                    |k: usize| modes.iter().filter_map(|c| c.get(k).cloned()).collect::<Vec<_>>();
                let longest = modes.iter().map(Vec::len).min().unwrap_or(0);
                let orders: Vec<_> =
                    (0..longest).map(|k| self.of_unknowns::<Float>(&at(k))).collect();
                let unknown =
                    |i: usize| orders.iter().filter_map(|all| all.get(i).cloned()).collect();
                return Ok((0..self.flow.unknowns()).map(unknown).collect());
            }
        }
        Err(Error::LongDelay { delay: end.to_string_radix(10, Some(6)) })
    }

    /// The equations of the user, which know nothing of the modes, from the start of these.
    fn as_written(
        &self,
        small: &Rational,
        modes: &Motion,
    ) -> Result<(Model, Parameters, Vec<Rational>), Error> {
        let problem = &self.flow.problem;
        let equations: Vec<_> = problem.equations().collect();
        let model = Model::of_unknowns(&equations)?.with_small(&problem.small);
        let name = problem.small.to_string();
        let parameters = self.parameters.clone().with(&name, small.clone());
        let every_second = |k: usize| -> Vec<Rational> {
            self.of_unknowns(&modes.start.iter().skip(k).step_by(2).cloned().collect::<Vec<_>>())
        };
        let pairs = every_second(0).into_iter().zip(every_second(1));
        Ok((model, parameters, pairs.flat_map(<[_; 2]>::from).collect()))
    }

    /// The unknowns of the user from those of the modes.
    fn of_unknowns<T>(&self, modes: &[T]) -> Vec<T>
    where
        for<'a> T: Clone + Mul<&'a Rational, Output = T> + Add<Output = T>,
    {
        let Some(shapes) = &self.flow.system.shapes else { return modes.to_vec() };
        let row = |row: &Vec<Rational>| {
            let parts = row.iter().zip(modes).map(|(p, q)| q.clone() * p);
            parts.reduce(|a, b| a + b)
        };
        shapes.iter().filter_map(row).collect()
    }

    /// Some states at the times, a list for every time.
    fn run(
        &self,
        (model, parameters): (&Model, &Parameters),
        (start, places): (&[Rational], &[usize]),
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Vec<Float>>, Error> {
        let real = Digits::for_digits(digits);
        let system = model.compile(real, parameters)?;
        let start: Vec<_> = start.iter().map(|q| Float::with_val(real.bits(), q)).collect();
        let order = self.flow.order;
        let lists = states(&system, &start, places, (&self.times, order), digits, goes_on)?;
        let at = |k: usize| lists.iter().filter_map(|list| list.get(k).cloned()).collect();
        Ok((0..self.times.len()).map(at).collect())
    }
}
