//! Why an oscillator has no response: the reason, and the verb that serves.

use super::Respond;
use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Kind, Oscillator, Refusal, SlowFlow, Work};
use lindstedt_equation::Expression;
use lindstedt_equation::classify::Method;
use lindstedt_evaluation::rotating::NoFrame;

/// A slow flow that was stopped at a lower order is that of other states; one that was stopped before the energy was
/// looked for, which comes last, may have families of states.
pub(super) fn whole(slow: SlowFlow, order: usize, work: &Work) -> Result<SlowFlow, Error> {
    let sought = slow.system.forces.is_empty() && slow.energy.is_empty();
    let message = if slow.order < order {
        format!("stopped at order {} of the slow flow of order {order}", slow.order)
    } else if sought && work.stop.asked() {
        "stopped before it was known whether the slow flow conserves an energy".to_owned()
    } else {
        return Ok(slow);
    };
    Err(Refused::stopped(message, "raise --limit-seconds or lower --order").into())
}

/// Whether an error says that this name has no value.
pub(super) fn is_unset(error: &Error, name: &str) -> bool {
    let ratio = "the ratio of ".to_owned() + name;
    let text = error.to_string();
    error.code() == "no-value-set" && text.contains(name) || text.starts_with(&ratio)
}

pub(super) fn no_frame(why: NoFrame) -> Error {
    let (message, hint) = match why {
        NoFrame::NoForce(1) => (
            "without a force the phase of a motion is free, and no state is steady",
            "`lindstedt evaluate` has the periodic motions, `derive --normalisation free` the slow flow with its limit cycles",
        ),
        NoFrame::NoForce(_) => (
            "without a force the phases of motions are free: those that lock are looked for of two unknowns",
            "`lindstedt derive` has the slow flow, `derive --mode` normal modes, `simulate` the motions",
        ),
        _ => (
            "forces of different detunings act on the same amplitudes: these are steady in no frame, they beat",
            "`lindstedt simulate` shows the motion, `derive --normalisation free` the slow flow",
        ),
    };
    Refused::no_answer("no-response", message, hint).into()
}

/// Branches of less than the slow flow would be those of another one.
pub(super) fn not_whole() -> Error {
    let message =
        "a frequency is irrational, and coefficients of the slow flow cannot be told from zero";
    let hint = "without --sweep: the states at one value, their number estimated; more --digits";
    Refused::no_answer("no-rational-modes", message, hint).into()
}

/// Refuses a slow flow that depends on frequencies without a value.
pub(super) fn has_numbers(oscillator: &Oscillator, slow: &SlowFlow) -> Result<(), Error> {
    slow.system.open_frequency().map_or(Ok(()), |name| Err(oscillator.unset(name)))
}

/// Whether all frequencies are multiples of this name.
pub(super) fn is_unit(slow: &SlowFlow, name: &str) -> bool {
    slow.system.unit.as_ref().is_some_and(|unit| unit.name == name)
}

pub(super) fn no_amplitude(what: &str) -> Error {
    let message = format!(
        "energy is conserved: normal modes are families over their amplitude, which {what}"
    );
    Refused::usage("no-value-set", message, "--set amplitude=1, or --sweep amplitude=0.1..2").into()
}

pub(super) fn no_bound() -> Error {
    let message = "no bound of the steady states follows from the slow flow";
    Refused::undecided("box", message, "--box AMPLITUDE says how far to look").into()
}

/// Of motions that are not isolated: nothing that is conserved by the equations tells those of a family apart.
pub(super) fn no_energy() -> Error {
    let message = "the slow flow of this order keeps a quadratic form, so that its motions form families, and no energy is \
                   known that all orders conserve";
    let hint = "`lindstedt derive` has the slow flow, `lindstedt simulate` motions";
    Refused::no_answer("no-response", message, hint).into()
}

/// Of a conserved energy with products of velocities whose factors are parameters: the modes that are free of them would depend
/// on these.
pub(super) fn no_squares() -> Error {
    let message = "an energy is conserved, with products of velocities whose factors are parameters without a value";
    Refused::no_answer("no-response", message, "--set values of these parameters").into()
}

pub(super) fn uncoupled(slow: &SlowFlow, order: usize) -> Error {
    if slow.system.forces.is_empty() {
        let message = format!("up to order {order} no resonance ties the phases of the unknowns");
        let hint = "`lindstedt derive --mode 1` has normal modes, `derive --normalisation free` the slow flow; a higher --order";
        return Refused::no_answer("no-response", message, hint).into();
    }
    let message = format!("up to order {order} no resonance couples the force to an amplitude");
    let hint =
        "a frequency nearer to a resonance (or the detuning as a parameter), a higher --order";
    Refused::no_answer("no-response", message, hint).into()
}

pub(super) fn no_resonance(name: &str) -> Error {
    let message = format!(
        "no value of {name} lies around a resonance that couples the force to an amplitude"
    );
    let hint = "a range about a resonance, or the detuning as a parameter of its own";
    Refused::no_answer("no-response", message, hint).into()
}

/// The code of a force of order one at a resonance.
const RESONANT: &str = "resonance";
/// Values of a frequency at which it is looked for.
const PROBED: usize = 41;

/// The refusal of a force of order one that a value of its frequency brings beside a resonance.
pub(super) fn strong_force(case: &Oscillator, axis: &Axis, work: &Work) -> Option<Error> {
    let stride = axis.values.len().div_ceil(PROBED).max(1);
    axis.values.iter().step_by(stride).find_map(|value| {
        let found = case.clone().with(&axis.name, value.clone()).flow(1, work);
        found.err().filter(|error| error.code() == RESONANT)
    })
}

pub(super) fn no_polynomial(symbol: &str, name: &str) -> Error {
    let message = format!("the slow flow contains {symbol}: over {name} it is no polynomial");
    let hint = format!("--set {name}=VALUE, and another parameter varies");
    Refused::no_answer("no-response", message, hint).into()
}

pub(super) fn no_part(name: &str) -> Error {
    let message = format!("the slow flow does not depend on {name}");
    Refused::no_answer("no-response", message, "a parameter of the equation varies").into()
}

/// The refusal of a problem that has no slow flow, with the verb that serves.
pub(super) fn not_weak(oscillator: &Oscillator, error: Error) -> Error {
    let (kind, code, hint) = error.parts();
    if kind != Kind::NoAnswer || code == RESONANT {
        return error;
    }
    let message = format!("no response from a slow flow: {error}");
    let other = other_verb(oscillator);
    let nothing_small = !oscillator.problem().equation.contains(&Expression::Small);
    let hint = match hint.is_empty() || nothing_small {
        true => other,
        false => format!("{hint}; {other}"),
    };
    Refused { code, kind, message, hint }.into()
}

/// What takes a problem without a slow flow.
fn other_verb(oscillator: &Oscillator) -> String {
    let problem = oscillator.problem();
    let contains = |part: &Expression| problem.equation.contains(part);
    let takes = |method| oscillator.classify().is_ok_and(|parts| parts.takes(method));
    if takes(Method::Melnikov) {
        return "`lindstedt threshold` and `lindstedt simulate` take motions beside a saddle"
            .into();
    }
    if contains(&Expression::Time) {
        let small = &problem.small;
        return match contains(&Expression::Small) {
            true => "`lindstedt simulate` takes it as it is".into(),
            false => format!(
                "{small}* before each of the small terms, the force too, and --set {small}=1; `lindstedt simulate` takes it as it is"
            ),
        };
    }
    // What has no expansion is refused with what takes it.
    oscillator.check().map_or_else(
        |error| error.hint(),
        |()| "`lindstedt evaluate` has the periods of strongly nonlinear motions".into(),
    )
}

/// Refuses a range of the small parameter that holds 0: there w' = 0 for every w, and branches would run through that.
pub(super) fn refuse_zero(question: &Respond, small: &str) -> Result<(), Error> {
    let mut axes = [&question.sweep, &question.second].into_iter().flatten();
    let Some(axis) = axes.find(|axis| axis.name == small) else { return Ok(()) };
    let values = || axis.values.iter().map(Exact::to_f64);
    if values().any(|value| value <= 0.0) && values().any(|value| value >= 0.0) {
        let message = format!("a range of {small} that holds 0, where every amplitude is steady");
        let hint = format!("values of one sign: --sweep {small}=1/100..1/10");
        return Err(Refused::usage("parameter", message, hint).into());
    }
    Ok(())
}
