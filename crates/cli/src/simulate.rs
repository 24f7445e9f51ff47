//! stub
use crate::Outcome;
use crate::arguments::SimulateOptions;
use crate::session::Session;
pub mod plot;
pub fn run(_options: &SimulateOptions, _session: &Session<'_>) -> Outcome {
    Ok(0)
}
