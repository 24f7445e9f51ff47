//! The resonance that a force is at or around, and whether what varies is its frequency.

use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, SlowFlow, Work};
use lindstedt_derivation::resonance::Detuned;
use lindstedt_evaluation::rotating::rotating;
use rug::Rational;

/// Most values of a range at which the resonance beside it is looked for.
const LOOKED_AT: usize = 41;

/// Whether the flow couples a force to an amplitude.
fn couples(slow: &SlowFlow, small: &str, order: usize) -> bool {
    rotating(slow, small, order).is_ok_and(|found| found.fixed > 0)
}

/// The slow flow of values. Where it couples no force to an amplitude, that which is detuned from the resonance of the
/// lowest order around the force's frequency that does, if there is one: it counts at a single value as in a range.
pub(super) fn resonant(case: &Oscillator, order: usize, work: &Work) -> Result<SlowFlow, Error> {
    let small = &case.problem().small;
    let slow = case.flow(order, work)?.value;
    if slow.system.forces.is_empty() || couples(&slow, small, order) {
        return Ok(slow);
    }
    for rate in slow.system.resonances_around() {
        let other = case.flow_detuned(Detuned::From(&rate), order, work)?.value;
        if couples(&other, small, order) {
            return Ok(other);
        }
    }
    Ok(slow)
}

/// A force whose frequency varies: omega = factor (Omega + eps symbol).
pub(super) struct Varying {
    pub slow: SlowFlow,
    pub factor: Rational,
    pub symbol: String,
}

/// A value of the frequency, and the slow flow there.
struct Beside {
    value: Rational,
    slow: SlowFlow,
}

impl Beside {
    fn new(slow: SlowFlow, value: &Rational) -> Option<Self> {
        slow.system.beside.is_some().then(|| Self { value: value.clone(), slow })
    }

    fn factor(&self) -> Option<Rational> {
        Some(Rational::from(&self.value / &self.slow.system.beside.as_ref()?.rate))
    }
}

/// Whether an axis is the frequency of the force; nothing where no value of it is around a resonance.
///
/// # Errors
/// [`Refused`] where values lie beside different resonances that couple the force to an amplitude, or the frequencies of the
/// oscillator vary.
pub(super) fn forcing_frequency(
    case: &Oscillator,
    axis: &Axis,
    order: usize,
    work: &Work,
) -> Result<Option<Varying>, Error> {
    let small = &case.problem().small;
    let at = |value: &Rational| case.clone().with(&axis.name, Exact::Rational(value.clone()));
    let stride = axis.values.len().div_ceil(LOOKED_AT).max(1);
    let ends = axis.values.iter().step_by(stride).chain(axis.values.last());
    let values: Vec<&Rational> = ends.filter_map(Exact::as_rational).collect();
    let beside = |value: &&Rational| Beside::new(at(value).flow(1, work).ok()?.value, value);
    let mut found: Vec<Beside> = values.iter().filter_map(beside).collect();
    let mut known: Vec<Rational> = Vec::new();
    found.retain(|it| {
        let rate = it.slow.system.force();
        let new = !known.contains(&rate);
        known.extend(new.then_some(rate));
        new
    });
    let whole =
        |it: Beside| Some(Beside { slow: at(&it.value).flow(order, work).ok()?.value, ..it });
    let mut found: Vec<Beside> = found.into_iter().filter_map(whole).collect();
    let first = found.first().map(|it| it.value.clone());
    found.retain(|it| couples(&it.slow, small, order));
    if found.is_empty() {
        // From the middle of the range, or beside a resonance that a higher order meets.
        let middle = values.get(values.len() / 2).copied();
        for value in middle.into_iter().chain(&first) {
            if found.is_empty() {
                found.extend(Beside::new(resonant(&at(value), order, work)?, value));
            }
        }
    }
    // Values that were not reached look as if they lay beside no resonance.
    if work.stop.asked() {
        let hint = "raise --limit-seconds, or lower --order";
        return Err(Refused::stopped("stopped before the resonances were found", hint).into());
    }
    if let Some(unit) = found.iter().find_map(|it| it.slow.system.unit.as_ref()) {
        let message = format!("{} is a frequency in multiples of {}", axis.name, unit.name);
        let hint = format!("a parameter for the detuning: cos(({} + eps*sigma)*t)", unit.name);
        return Err(Refused::no_answer("no-response", message, hint).into());
    }
    let Some(first) = found.first() else { return Ok(None) };
    let (factor, rate) = (first.factor(), first.slow.system.force());
    let shifted = &first.value * Rational::from((1001, 1000));
    let next = at(&shifted).flow_detuned(Detuned::From(&rate), 1, work)?.value;
    if Beside::new(next, &shifted).and_then(|next| next.factor()) != factor {
        return Err(moving_frequency(&axis.name));
    }
    if let Some(other) = found.get(1) {
        let [rate, other] = [(&first.slow, &rate), (&other.slow, &other.slow.system.force())]
            .map(|(slow, rate)| slow.size(rate));
        let message = format!(
            "the range of {} passes two resonances, {rate} and {other} as rates of the force's phase",
            axis.name,
        );
        return Err(Refused::usage("sweep", message, "one resonance at a time").into());
    }
    let symbol = first.slow.system.beside.as_ref().map(|it| it.symbol.clone());
    let whole = |(factor, symbol)| Varying { slow: first.slow.clone(), factor, symbol };
    Ok(factor.zip(symbol).map(whole))
}

/// That frequencies of the oscillator do not vary.
pub(super) fn moving_frequency(name: &str) -> Error {
    let message = format!("a frequency of the oscillator depends on {name}");
    let hint = "only the frequency of the force varies; set others value by value";
    Refused::no_answer("no-response", message, hint).into()
}
