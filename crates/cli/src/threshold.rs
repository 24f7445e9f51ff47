//! `lindstedt threshold`: the Melnikov threshold of homoclinic chaos, its zeros, curves, surfaces.

use crate::Outcome;
use crate::arguments::Precision;
use crate::failure::Failure;
use crate::session::Session;
use clap::Args;
use lindstedt::Threshold;
use lindstedt::grid::Axis;
use lindstedt::threshold::{Persistence, Persisting};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct ThresholdOptions {
    /// stick-slip; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// NAME=LO..HI:COUNT or NAME=V1,V2,...; at most two, the first along the horizontal axis.
    #[arg(long, value_name = "NAME=LO..HI:COUNT")]
    pub sweep: Vec<String>,
    /// All zeros of the signed threshold in this range of a parameter.
    #[arg(long, value_name = "NAME=LO..HI")]
    pub zeros: Option<String>,
    /// Thresholds of the resonances of period 2 pi m/omega, m = 1 ... M, in one well and around both.
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub subharmonics: Option<u32>,
    /// The threshold to second order in the small parameter on every orbit, by Melnikov's integral of second order; of
    /// loops also from the tangencies of their manifolds (some seconds).
    #[arg(long)]
    pub second_order: bool,
    /// The parameter for which an autonomous problem keeps its orbit between saddles, as a series in the small parameter
    /// (also `unknown` in the file); without --order, where no series is known, to first order.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["sweep", "zeros", "subharmonics", "second_order", "plot"])]
    pub unknown: Option<String>,
    /// The highest order of that series.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub order: Option<u32>,
    /// A figure (.svg) or a table (.csv) of the sweep; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    #[command(flatten)]
    pub precision: Precision,
}

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
        sweep: options
            .sweep
            .iter()
            .map(|text| oscillator.axis_until(text, &session.work().stop))
            .collect::<Result<_, _>>()?,
        zeros: options.zeros.as_deref().map(Axis::ends).transpose()?,
        subharmonics: options.subharmonics,
        second_order: options.second_order,
        part: None,
    };
    session.check_sweep(&options.plot, question.sweep.len(), 1)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.threshold(&question, &work), &options.plot)
}
