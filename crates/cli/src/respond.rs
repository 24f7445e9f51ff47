//! `lindstedt respond`: steady states at resonance.

use crate::Outcome;
use crate::session::Session;
use clap::Args;
use lindstedt::grid::Axis;
use lindstedt::{Error, Exact, Respond};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct RespondOptions {
    /// A built-in name, the path of a problem file (.toml), or an equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// The parameter that varies, in COUNT steps at least, with all states at up to 9 of them (3 of several unknowns) or at each of a list V1,V2,...; two: folds and Hopf points in their plane; none: all states at the
    /// values set.
    #[arg(long, value_name = "NAME=LO..HI[:COUNT]")]
    pub sweep: Vec<String>,
    /// Orders of the slow flow.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=60))]
    pub order: u32,
    /// The largest amplitude looked at; by default one that has all states of the first order in which the force acts.
    #[arg(long = "box", value_name = "AMPLITUDE")]
    pub amplitude: Option<String>,
    /// With --sweep: the equation itself integrated along the values, upwards and downwards, each from the end of the one
    /// before: where it jumps.
    #[arg(long, requires = "sweep")]
    pub follow: bool,
    /// x and x' at t = 0, of several unknowns one pair after the other: which state does the motion go to?
    #[arg(long, value_name = "X,V[,...]", allow_hyphen_values = true)]
    pub start: Option<String>,
    /// A figure (.svg) or a table (.csv) of the sweep; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
}

pub fn run(options: &RespondOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    let axes = options
        .sweep
        .iter()
        .map(|text| Respond::read_sweep(&oscillator, text, &session.work().stop));
    let (sweep, second) = Axis::pair(axes)?;
    let amplitude = options.amplitude.as_deref().map(Exact::parse);
    let question = Respond {
        order: Some(options.order as usize),
        sweep,
        second,
        amplitude: amplitude.transpose().map_err(Error::from)?,
        follow: options.follow,
        start: options.start.as_deref().map(Respond::read_start).transpose()?,
    };
    session.check_sweep(&options.plot, options.sweep.len(), 1)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.respond(&question, &session.work()), &options.plot)
}
