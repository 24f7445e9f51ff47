//! The condition asked for, for the verbs that still load a problem by themselves.

pub use lindstedt::classification::{check, of};
use lindstedt::condition_name;
use lindstedt::equation::Condition;

use crate::arguments::Normalisation;
use crate::failure::Failure;
use crate::session::Loaded;

/// The condition asked for. Averaging needs nothing of a file that was written for a constant amplitude,
/// so a free one need not be listed; what an amplitude is under the other conditions only the file can
/// say.
pub fn condition(
    asked: Option<Normalisation>,
    loaded: &mut Loaded,
    path: &str,
) -> Result<Option<Condition>, Failure> {
    let condition = asked.map(|normalisation| match normalisation {
        Normalisation::Initial => Condition::InitialAmplitude,
        Normalisation::Fundamental => Condition::FundamentalAmplitude,
        Normalisation::Free => Condition::FreeAmplitude,
    });
    let conditions = &mut loaded.problem.conditions;
    match condition.filter(|asked| loaded.file.is_some() && !conditions.contains(asked)) {
        None => Ok(condition),
        Some(Condition::FreeAmplitude) => {
            conditions.push(Condition::FreeAmplitude);
            Ok(condition)
        }
        Some(other) => {
            let line = format!("condition = \"{}\" in the file asks for it", condition_name(other));
            let message = format!("{path} does not offer this normalisation");
            Err(Failure::usage("unknown-normalisation", message, &line))
        }
    }
}
