//! `lindstedt verify`: the expansion against the time domain.

use crate::Outcome;
use crate::arguments::one_of;
use crate::session::Session;
use clap::Args;
use lindstedt::choices::NORMALISATIONS;
use lindstedt::{Condition, Verify};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct VerifyOptions {
    /// power-law, pendulum, vibro-impact, duffing, van-der-pol; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// The order N; the observed order should be N + 1.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub order: u32,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is: x(0), the first harmonic, or free to drift (averaging).
    #[arg(long, value_parser = one_of(NORMALISATIONS))]
    pub normalisation: Option<Condition>,
    /// Values of the small parameter, decreasing in modulus.
    #[arg(
        long,
        value_name = "V1,V2,...",
        default_value = "1/1000,1/2000,1/4000,1/8000",
        allow_hyphen_values = true
    )]
    pub small: String,
    /// The window, in periods.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub periods: u32,
    /// Digits of the integration; by default enough for the smallest error.
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(5..=2000))]
    pub digits: Option<u32>,
    /// A figure (.svg) of the errors, or a table (.csv); may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
}

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
