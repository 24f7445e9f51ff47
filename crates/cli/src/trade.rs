//! `lindstedt trade`: what every tier costs, and how wrong it is.

use crate::Outcome;
use crate::arguments::{one_of, seconds};
use crate::session::Session;
use clap::Args;
use lindstedt::Condition;
use lindstedt::choices::NORMALISATIONS;
use lindstedt::trade::Plan;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct TradeOptions {
    /// power-law, pendulum, duffing, van-der-pol; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is; the true period is sought from x(0).
    #[arg(long, value_parser = one_of(NORMALISATIONS))]
    pub normalisation: Option<Condition>,
    /// Orders of the series.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = [2, 4, 8, 16, 32])]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub orders: Vec<u32>,
    /// Digits of the tiers that have them.
    #[arg(long, value_name = "D,...", value_delimiter = ',', default_values_t = [16, 30, 50])]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub digits: Vec<u32>,
    /// Harmonics of the Fourier tier.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = [16, 64])]
    #[arg(value_parser = clap::value_parser!(u32).range(4..=16384))]
    pub harmonics: Vec<u32>,
    /// A run that takes longer is broken off, and higher orders of its tier are left out.
    #[arg(long, value_name = "S", default_value = "5", value_parser = seconds)]
    pub limit_run: f64,
    /// Runs per row; the fastest counts.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
    /// Recommend the fastest run that states at most this relative error.
    #[arg(long = "for", value_name = "ERROR", value_parser = seconds)]
    pub wanted: Option<f64>,
    /// Recommend the run that states the least error in at most this time; with --for also a
    /// limit for that.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub within: Option<f64>,
    /// A figure (.svg) or a table (.csv); may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
}

pub fn run(options: &TradeOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let sizes = |list: &[u32]| list.iter().map(|&n| n as usize).collect();
    let plan = Plan {
        orders: sizes(&options.orders),
        digits: options.digits.clone(),
        harmonics: sizes(&options.harmonics),
        run_seconds: options.limit_run,
        repeats: options.repeats,
        error: options.wanted,
        seconds: options.within,
    };
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.trade(&plan, &session.work()), &options.plot)
}
