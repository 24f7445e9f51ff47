//! Both sides of a comparison at sampled times, and the largest gap between them.

use super::{Comparison, Verify};
use crate::Error;
use lindstedt_expand::ExpandError;
use lindstedt_simulate::{
    Digits, Integrator, Outcome, Places, Real, Settings as Precision, System, Trajectory,
};
use rug::{Float, Rational};
use std::ops::ControlFlow;

/// Times on a window of so many periods, not at a whole part of the period, where delays end too.
pub(super) fn sample_times(question: &Verify, frequency: &Float) -> Vec<Float> {
    let (bits, samples) = (frequency.prec(), question.samples.max(2));
    let window =
        Float::with_val(bits, rug::float::Constant::Pi) * (2 * question.periods.max(1)) / frequency;
    let time = |j: u32| {
        let part = (1009 * u64::from(j) - 505, 1009 * u64::from(samples));
        Float::with_val(bits, &window * Rational::from(part))
    };
    (1..=samples).map(time).collect()
}

/// The largest differences from the expansion and between two integrations.
pub(super) fn largest_gaps(
    small: &Rational,
    expected: &[Float],
    coarse: &[Float],
    fine: &[Float],
) -> Comparison {
    let [mut error, mut simulation_error, mut size] = [0; 3].map(|_| Float::new(64));
    for ((x, coarse), fine) in expected.iter().zip(coarse).zip(fine) {
        error.max_mut(&Float::with_val(64, x - fine).abs());
        simulation_error.max_mut(&Float::with_val(64, fine - coarse).abs());
        size.max_mut(&Float::with_val(64, fine.abs_ref()));
    }
    Comparison { small: small.clone(), error, simulation_error, size, slope: None }
}

/// States at the times, place by place; stopped work says how many orders there are.
pub(super) fn states(
    system: &System<Digits>,
    start: &[Float],
    places: &[usize],
    (times, order): (&[Float], usize),
    digits: u32,
    goes_on: &dyn Fn() -> bool,
) -> Result<Vec<Vec<Float>>, Error> {
    let real = *system.real();
    let precision = Precision::for_digits(digits);
    let mut flow = Integrator::new(system, &real.zero(), start, precision)?;
    let mut trajectory = Trajectory::new(real);
    let end = times.last().map_or_else(|| real.zero(), |t| real.float(t));
    let outcome = flow.advance(&end, &mut |report| {
        if goes_on() { trajectory.record(report) } else { ControlFlow::Break(()) }
    })?;
    if outcome == Outcome::Stopped {
        return Err(ExpandError::Interrupted { order }.into());
    }
    let mut lists = vec![Vec::new(); places.len()];
    for t in times.iter().map(|t| real.float(t)) {
        for (list, place) in lists.iter_mut().zip(places) {
            let last = || flow.state().get(*place).cloned();
            let value = if t >= *flow.time() { last() } else { trajectory.value(*place, &t) };
            list.push(value.ok_or(Error::NoValue)?);
        }
    }
    Ok(lists)
}
