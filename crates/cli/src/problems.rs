//! `lindstedt problems`: what is built in.

use crate::Outcome;
use crate::arguments::ProblemsOptions;
use crate::session::Session;
use lindstedt::catalogue::Catalogue;

pub fn run(options: &ProblemsOptions, session: &Session<'_>) -> Outcome {
    let catalogue = match &options.show {
        Some(name) => session.oscillator(name, &[], None)?.entry(),
        None => Catalogue::builtin(),
    };
    session.print(&catalogue)?;
    Ok(0)
}
