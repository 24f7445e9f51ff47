//! `lindstedt threshold`: the Melnikov threshold of homoclinic chaos, its zeros, curves, surfaces.

use crate::Outcome;
use crate::arguments::ThresholdOptions;
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::grid::Axis;
use lindstedt::{Kind, Refusal, Threshold};

/// The order of a series that is not asked for.
const ORDER: u32 = 2;

pub fn run(options: &ThresholdOptions, session: &Session<'_>) -> Outcome {
    let work = session.precise_work(&options.precision)?;
    let oscillator = session.oscillator(&options.problem, &options.set, None)?;
    if let Some(name) = options.unknown.as_deref().or(oscillator.unknown()) {
        session.check_writable(&options.problem, &options.plot, None)?;
        let order = options.order.unwrap_or(ORDER) as usize;
        let series = oscillator.homoclinic(name, order, &work);
        let first = options.order.unwrap_or(0) == 0;
        if first && series.as_ref().is_err_and(|error| error.kind() == Kind::NoAnswer) {
            return session.show(oscillator.persistence(name, &work), &options.plot);
        }
        return session.show(series, &options.plot);
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
