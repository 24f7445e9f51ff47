//! Slow flows against the time domain: x_N(t) by the truncated flow.

use super::sampled::{largest_gaps, sample_times, states};
use super::{Comparison, Verify};
use crate::{Error, Oscillator, Progress, SlowFlow};
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Motion, slow_flow};
use lindstedt_derivation::{DerivationError, all_values};
use lindstedt_expand::ExpandError;
use lindstedt_simulate::{Digits, Model, Parameters, Real};
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// A slow flow and its judge.
pub(super) struct Resonant {
    flow: SlowFlow,
    values: BTreeMap<String, Rational>,
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
            let problem = problem.name.to_string();
            return Err(DerivationError::Unset { problem, name: name.clone() }.into());
        }
        let order = question.order;
        let asked = AveragingSettings { order, parameters, ..AveragingSettings::default() };
        let flow = slow_flow(problem, &asked, observer)?;
        if flow.order < order {
            return Err(ExpandError::Interrupted { order: flow.order }.into());
        }
        let slowest = flow.system.frequencies.iter().min().cloned().unwrap_or_default();
        let bits = Digits::for_digits(digits + 16).bits();
        let times = sample_times(question, &Float::with_val(bits, &slowest));
        let values = oscillator.rational_values();
        let amplitude = values.get("amplitude").cloned().unwrap_or_else(|| 1.into());
        Ok(Self { flow, values, times, amplitude })
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
        // x_j are the last states of the one, every second state of the other.
        let slow_places: Vec<_> = (2 * unknowns..3 * unknowns).collect();
        let places: Vec<_> = (0..unknowns).map(|j| 2 * j).collect();
        let expected = self.run(&slow, &slow_places, digits + 16, goes_on)?;
        let coarse = self.run(&full, &places, digits, goes_on)?;
        let fine = self.run(&full, &places, digits + 8, goes_on)?;
        Ok(largest_gaps(small, &expected, &coarse, &fine))
    }

    /// Some states at the times, one after the other.
    fn run(
        &self,
        motion: &Motion,
        places: &[usize],
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Float>, Error> {
        let real = Digits::for_digits(digits);
        let names: Vec<&str> = motion.names.iter().map(String::as_str).collect();
        let system =
            Model::first_order(&names, &motion.rates)?.compile(real, &Parameters::new())?;
        let start: Vec<_> = motion.start.iter().map(|q| Float::with_val(real.bits(), q)).collect();
        let order = self.flow.order;
        let lists = states(&system, &start, places, (&self.times, order), digits, goes_on)?;
        Ok(lists.concat())
    }
}
