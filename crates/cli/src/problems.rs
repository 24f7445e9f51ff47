//! `lindstedt problems`: what is built in.

use crate::Outcome;
use crate::session::Session;
use clap::Args;
use lindstedt::catalogue::Catalogue;

#[derive(Debug, Args)]
pub struct ProblemsOptions {
    /// Show one problem as a problem file, with its classification.
    #[arg(long, value_name = "NAME|FILE")]
    pub show: Option<String>,
}

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
