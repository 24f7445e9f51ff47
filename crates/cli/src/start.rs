//! The starts that a file may give twice, for the verbs that still load a problem by themselves.

use crate::session::note;
use lindstedt::equation::Problem;
use lindstedt::{Exact, Oscillator, ProblemFile};
use std::collections::BTreeMap;

pub use lindstedt::start::Taken;

/// Says which start is taken where `[initial]` and the amplitude contradict each other.
pub fn compare(
    _problem: &Problem,
    file: Option<&ProblemFile>,
    given: &BTreeMap<String, Exact>,
    taken: Taken,
) {
    let Some(Ok(mut oscillator)) = file.map(|file| Oscillator::file(file.source())) else {
        return;
    };
    for (name, value) in given {
        oscillator = oscillator.with(name, value.clone());
    }
    if let Some(remark) = oscillator.start_remark(taken) {
        note(remark.0);
    }
}
