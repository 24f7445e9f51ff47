//! `lindstedt threshold`: the Melnikov threshold of homoclinic chaos, its zeros, curves, surfaces.

use crate::Outcome;
use crate::arguments::ThresholdOptions;
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::Threshold;
use lindstedt::grid::Axis;
use lindstedt::threshold::{Persistence, Persisting};

pub fn run(options: &ThresholdOptions, session: &Session<'_>) -> Outcome {
    let work = session.precise_work(&options.precision)?;
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    if let Some(name) = options.unknown.as_deref().or(oscillator.unknown()) {
        session.check_writable(&options.problem, &options.plot, None)?;
        let order = options.order.map(|order| order as usize);
        return match oscillator.persisting(name, order, &work) {
            Ok(Persisting::Series(answer)) => session.show(Ok(*answer), &options.plot),
            Ok(Persisting::First(answer)) => session.show(Ok(*answer), &options.plot),
            Err(error) => session.show::<Persistence>(Err(error), &options.plot),
        };
    }
    if options.order.is_some() {
        let message = "--order belongs to --unknown".to_owned();
        return Err(Failure::usage("order", message, "for example --unknown mu --order 4"));
    }
    let question = Threshold {
        sweep: options.sweep.iter().map(|text| oscillator.axis(text)).collect::<Result<_, _>>()?,
        zeros: options.zeros.as_deref().map(Axis::ends).transpose()?,
        subharmonics: options.subharmonics,
        second_order: options.second_order,
        part: None,
    };
    session.check_sweep(&options.plot, question.sweep.len(), 1)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.threshold(&question, &work), &options.plot)
}
