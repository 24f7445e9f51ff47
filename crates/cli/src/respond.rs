//! `lindstedt respond`: steady states at resonance.

use crate::Outcome;
use crate::arguments::RespondOptions;
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::{Error, Exact, Respond};

pub fn run(options: &RespondOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    let mut axes = options.sweep.iter().map(|text| Respond::read_sweep(&oscillator, text));
    let amplitude = options.amplitude.as_deref().map(Exact::parse);
    let question = Respond {
        order: Some(options.order as usize),
        sweep: axes.next().transpose()?,
        second: axes.next().transpose()?,
        amplitude: amplitude.transpose().map_err(Error::from)?,
        follow: options.follow,
        start: options.start.as_deref().map(Respond::read_start).transpose()?,
    };
    if axes.next().is_some() {
        let message = "at most two parameters vary".to_owned();
        return Err(Failure::usage("sweep", message, "one --sweep or two"));
    }
    session.check_sweep(&options.plot, options.sweep.len(), 1)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.respond(&question, &session.work()), &options.plot)
}
