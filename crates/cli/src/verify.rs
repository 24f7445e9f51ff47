//! `lindstedt verify`: the expansion against the time domain.

use crate::Outcome;
use crate::arguments::VerifyOptions;
use crate::session::Session;
use lindstedt::Verify;

pub fn run(options: &VerifyOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let question = Verify {
        order: options.order as usize,
        small: Verify::read_small(&options.small)?,
        periods: options.periods,
        digits: options.digits,
        ..Verify::default()
    };
    session.check_writable(&options.problem, &options.plot, None)?;
    let answer = oscillator.verify(&question, &session.work());
    session.show(answer, &options.plot)
}
