//! The starts that a file may give twice: `[initial]` and `amplitude`.

use crate::session::note;
use lindstedt::equation::Problem;
use lindstedt::number::ball::Balls;
use lindstedt::{Exact, ProblemFile};
use std::collections::BTreeMap;

/// Which of the two a command takes.
pub enum Taken {
    /// The amplitude, also where it is the default one.
    Amplitude,
    /// x and velocity of `[initial]`; the option that gives the other start, with
    /// AMPLITUDE in place of the value.
    Initial(&'static str),
}

/// Says which start is taken where `[initial]` and the amplitude contradict each other.
pub fn compare(
    problem: &Problem,
    file: Option<&ProblemFile>,
    given: &BTreeMap<String, Exact>,
    taken: Taken,
) {
    let Some(file) = file else { return };
    let Some([x, velocity]) = &file.initial else { return };
    let value = |text: &String| Exact::parse(text).ok();
    let card = problem.parameters.iter().find(|card| card.name == "amplitude");
    let default = || card.and_then(|card| Exact::parse(&card.default).ok());
    let written = file.names.parameters.iter().any(|names| names.contains("amplitude"));
    let amplitude = match (given.get("amplitude"), &taken) {
        (Some(value), _) => Some(value.clone()),
        // A default that nobody wrote contradicts nothing that is taken.
        (None, Taken::Initial(_)) if !written => None,
        (None, _) => default(),
    };
    let Some(amplitude) = amplitude else { return };
    let same = value(x).as_ref() == Some(&amplitude);
    let rests = value(velocity).and_then(|v| Some(v.as_rational()?.is_zero())) == Some(true);
    // An amplitude that is refused is no advice.
    let advice = |value: Option<Exact>, option: &str| match value {
        Some(value) if value.ball(Balls::new(64)).is_positive() => {
            format!(" ({})", option.replace("AMPLITUDE", &value.to_string()))
        }
        _ => String::new(),
    };
    match (taken, same, rests) {
        (_, true, true) => {}
        (Taken::Amplitude, false, _) => note(format!(
            "x = {x} of [initial] has no effect here: the amplitude is {amplitude}{}",
            advice(value(x), "--set amplitude=AMPLITUDE")
        )),
        (Taken::Amplitude, true, false) => note(format!(
            "velocity = {velocity} of [initial] has no effect here: the expansion starts at rest"
        )),
        (Taken::Initial(option), ..) => note(format!(
            "amplitude = {amplitude} is not the start here: x = {x}, velocity = {velocity} of \
             [initial] is{}",
            advice(Some(amplitude.clone()), option)
        )),
    }
}
