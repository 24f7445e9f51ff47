//! Whether what varies is the frequency of the force, beside one resonance.

use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, Work};
use rug::Rational;

/// Most values of a range at which the resonance beside it is looked for.
const LOOKED_AT: usize = 41;

/// Whether an axis is the frequency of the force: a value of it beside a resonance, omega/rate, and the name
/// of the detuning.
///
/// # Errors
/// [`Refused`] where values lie beside different resonances, or the frequencies of the oscillator vary.
pub(super) fn forcing_frequency(
    case: &Oscillator,
    axis: &Axis,
    work: &Work,
) -> Result<Option<(Exact, Rational, String)>, Error> {
    let beside = |value: &Rational| {
        let with = case.clone().with(&axis.name, Exact::Rational(value.clone()));
        let system = with.flow(1, work).ok()?.value.system;
        Some(((system.force(), system.beside?), system.unit))
    };
    let stride = axis.values.len().div_ceil(LOOKED_AT).max(1);
    let ends = axis.values.iter().step_by(stride).chain(axis.values.last());
    let values = ends.filter_map(|value| value.as_rational().cloned());
    let found: Vec<_> = values.filter_map(|value| Some((beside(&value)?, value))).collect();
    if let Some(unit) = found.iter().find_map(|((_, unit), _)| unit.as_ref()) {
        let message = format!("{} is a frequency in multiples of {}", axis.name, unit.name);
        let hint = format!("a parameter for the detuning: cos(({} + eps*sigma)*t)", unit.name);
        return Err(Refused::no_answer("no-response", message, hint).into());
    }
    let found: Vec<_> = found.into_iter().map(|((beside, _), value)| (beside, value)).collect();
    let moves = found.first().map(|((_, first), value)| {
        let shifted = value * Rational::from((1001, 1000));
        let next = beside(&shifted).map(|((_, it), _)| Rational::from(&shifted / &it.rate));
        next == Some(Rational::from(value / &first.rate))
    });
    // Values that were not reached look as if they lay beside no resonance.
    if work.stop.asked() {
        let hint = "raise --limit-seconds, or lower --order";
        return Err(Refused::stopped("stopped before the resonances were found", hint).into());
    }
    let (Some(((force, first), value)), Some(moves)) = (found.first(), moves) else {
        return Ok(None);
    };
    let factor = Rational::from(value / &first.rate);
    if !moves {
        return Err(moving_frequency(&axis.name));
    }
    if let Some(((other, _), _)) = found.iter().find(|((other, _), _)| other != force) {
        let message = format!(
            "the range of {} passes two resonances, {force} and {other} as rates of the force's phase",
            axis.name
        );
        return Err(Refused::usage("sweep", message, "one resonance at a time").into());
    }
    Ok(Some((Exact::Rational(value.clone()), factor, first.symbol.clone())))
}

/// That frequencies of the oscillator do not vary.
pub(super) fn moving_frequency(name: &str) -> Error {
    let message = format!("a frequency of the oscillator depends on {name}");
    let hint = "only the frequency of the force varies; set others value by value";
    Refused::no_answer("no-response", message, hint).into()
}
