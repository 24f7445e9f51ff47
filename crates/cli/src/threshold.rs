//! `lindstedt threshold`: the Melnikov threshold of homoclinic chaos, its zeros, curves, surfaces.

use crate::Outcome;
use crate::arguments::ThresholdOptions;
use crate::session::Session;
use lindstedt::Threshold;
use lindstedt::grid::Axis;

pub fn run(options: &ThresholdOptions, session: &Session<'_>) -> Outcome {
    let work = session.precise_work(&options.precision)?;
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    let question = Threshold {
        sweep: options.sweep.iter().map(|text| oscillator.axis(text)).collect::<Result<_, _>>()?,
        zeros: options.zeros.as_deref().map(Axis::ends).transpose()?,
        subharmonics: options.subharmonics,
    };
    session.check_sweep(&options.plot, question.sweep.len(), 1)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.threshold(&question, &work), &options.plot)
}
