//! `lindstedt stability`: what averaging predicts for the impact orbit, and the truth.

use crate::Outcome;
use crate::arguments::{Precision, one_of};
use crate::session::Session;
use clap::Args;
use lindstedt::Stability;
use lindstedt::choices::{KICKS, PREDICTORS, VARIANTS};
use lindstedt::unstable::impact::{characteristic::Kick, prediction::Variant};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct StabilityOptions {
    /// vibro-impact; or the path of a problem file (.toml) with a wall.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3); branch=+ or branch=-.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// NAME=LO..HI:COUNT; at most two, the first along the horizontal axis.
    #[arg(long, value_name = "NAME=LO..HI:COUNT")]
    pub sweep: Vec<String>,
    /// What to compute.
    #[arg(long, value_parser = one_of(PREDICTORS), default_value = "both")]
    pub predictor: (bool, bool),
    /// Which orbit meets which flow in the averaged prediction.
    #[arg(long, value_parser = one_of(VARIANTS), default_value = "E")]
    pub variant: (Variant, bool),
    /// The order of the averaged flow.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub order: u32,
    /// How the velocity kick of B is treated in the characteristic function.
    #[arg(long, value_parser = one_of(KICKS), default_value = "mean")]
    pub kick: Kick,
    /// A chart (.svg) or a table (.csv) of the sweeps; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    #[command(flatten)]
    pub precision: Precision,
}

pub fn run(options: &StabilityOptions, session: &Session<'_>) -> Outcome {
    let work = session.precise_work(&options.precision)?;
    let (branch, set) = Stability::read_branch(&options.set)?;
    let oscillator = session.oscillator(&options.problem, &set, None)?;
    let question = Stability {
        order: options.order as usize,
        variant: options.variant.0,
        impact_aware: options.variant.1,
        kick: options.kick,
        predict: options.predictor.0,
        exact: options.predictor.1,
        branch,
        sweep: options
            .sweep
            .iter()
            .map(|text| oscillator.axis_until(text, &session.work().stop))
            .collect::<Result<_, _>>()?,
        radius: false,
        part: None,
    };
    session.check_sweep(&options.plot, question.sweep.len(), 2)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.stability(&question, &work), &options.plot)
}
