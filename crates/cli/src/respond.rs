//! `lindstedt respond`: steady states at resonance.

use crate::Outcome;
use crate::arguments::RespondOptions;
use crate::session::Session;
use lindstedt::grid::Axis;
use lindstedt::{Error, Exact, Respond};

pub fn run(options: &RespondOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    let axes = options.sweep.iter().map(|text| Respond::read_sweep(&oscillator, text));
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
