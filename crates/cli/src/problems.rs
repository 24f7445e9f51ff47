//! `lindstedt problems`: what is built in.

use crate::Outcome;
use crate::arguments::ProblemsOptions;
use crate::session::Session;
use lindstedt::catalogue::Catalogue;

pub fn run(options: &ProblemsOptions, session: &Session<'_>) -> Outcome {
    let Some(name) = &options.show else {
        session.print(&Catalogue::builtin())?;
        return Ok(0);
    };
    let oscillator = session.oscillator(name, &[], None)?;
    session.print(&oscillator.entry())?;
    session.say_remarks(oscillator.remarks());
    Ok(0)
}
