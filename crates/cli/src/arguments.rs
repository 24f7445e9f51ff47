//! The arguments. Names are part of the public interface: add, do not rename.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Perturbation expansions of strongly nonlinear and non-smooth oscillators, to any order.
#[derive(Debug, Parser)]
#[command(name = "lindstedt", version, max_term_width = 100)]
#[command(about = "Perturbation expansions of strongly nonlinear and non-smooth oscillators")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// What is built in, with equation, parameters and defaults.
    Problems(ProblemsOptions),
    /// Derive the expansion of a problem, order by order, and check it.
    Derive(DeriveOptions),
    /// The period and the solution at given parameters, by resummation of the expansion.
    Evaluate(EvaluateOptions),
    /// The Melnikov threshold of homoclinic chaos: value, zeros, cusps, curves, surfaces.
    Threshold(ThresholdOptions),
    /// Read the paper: derive it, compare it with the print, tabulate what is true.
    Paper(PaperOptions),
}

/// How results are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Text,
    Json,
    Latex,
    Markdown,
}

#[derive(Debug, Args)]
pub struct Common {
    /// The form of the result.
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write the result to this file instead of standard output.
    #[arg(long, global = true, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// No progress on standard error.
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Stop after so many seconds with what is finished (exit code 4).
    #[arg(long, global = true, value_name = "S", value_parser = seconds)]
    pub limit_seconds: Option<f64>,
    /// Refuse work that is predicted to need more memory (512M, 8G).
    #[arg(long, global = true, value_name = "SIZE", default_value = "8G", value_parser = memory_size)]
    pub limit_memory: u64,
}

#[derive(Debug, Args)]
pub struct ProblemsOptions {
    /// Show one problem in full.
    #[arg(long, value_name = "NAME")]
    pub show: Option<String>,
}

#[derive(Debug, Args)]
pub struct DeriveOptions {
    /// power-law, pendulum, vibro-impact, duffing or van-der-pol.
    pub problem: String,
    /// The highest order.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000_000))]
    pub order: u32,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is: x(0), the first harmonic, or free to drift (averaging).
    #[arg(long, value_enum)]
    pub normalisation: Option<Normalisation>,
    /// The driver, or the energy integral (frequency alone; power-law and pendulum).
    #[arg(long, value_enum, default_value_t = Route::Driver)]
    pub route: Route,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Debug, Args)]
pub struct EvaluateOptions {
    /// power-law, pendulum, duffing or van-der-pol.
    pub problem: String,
    /// The highest order; a quick one if not given.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000_000))]
    pub order: Option<u32>,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// How the series is summed; auto takes the least error estimate and says why.
    #[arg(long, value_enum, default_value_t = Resum::Auto)]
    pub resum: Resum,
    /// The solution x(t) at these times, x(0) = amplitude, x'(0) = 0 but for --phase.
    #[arg(long, value_name = "LO..HI:COUNT", allow_hyphen_values = true)]
    pub times: Option<String>,
    /// x(t) = X(omega t + PHASE).
    #[arg(long, value_name = "PHASE", default_value = "0", allow_hyphen_values = true)]
    pub phase: String,
    /// A figure of the solution (.svg) or a table (.csv); may be given twice. One period without
    /// --times.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    /// The solution as a function in this language instead of the report.
    #[arg(long, value_enum)]
    pub code: Option<Language>,
    /// Harmonics in the code.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=512))]
    pub harmonics: u32,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    Rust,
    Python,
    Latex,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Resum {
    /// The partial sum; of a divergent series up to the smallest term.
    None,
    /// Diagonal Pade approximants.
    Pade,
    /// The series in u = x/(1 + x) with a prefactor.
    Uniform,
    /// Pade approximants in u.
    UniformPade,
    /// A conformal map of the plane cut at the nearest singularities, then Pade.
    Conformal,
    /// Pade approximants of the Borel transform.
    BorelPade,
    /// The least error estimate of all.
    Auto,
}

#[derive(Debug, Args)]
pub struct ThresholdOptions {
    /// stick-slip.
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
    /// A figure (.svg) or a table (.csv) of the sweep; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Route {
    /// Solution and frequency, checked by substitution.
    Driver,
    /// The frequency alone, exact and to much higher order.
    Energy,
}

/// With --out DIR the report and its data are written into that directory.
#[derive(Debug, Args)]
pub struct PaperOptions {
    /// Lower orders, a few seconds.
    #[arg(long)]
    pub quick: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Normalisation {
    /// x(0) = A, x'(0) = 0.
    Initial,
    /// The first harmonic of x is A cos.
    Fundamental,
    /// The first harmonic is a cos(psi), a drifts: averaging (KBM).
    Free,
}

#[derive(Debug, Args)]
pub struct Precision {
    /// Correct digits of every decimal.
    #[arg(long, default_value_t = 30, value_name = "D", allow_negative_numbers = true)]
    #[arg(conflicts_with = "f64")]
    pub digits: u64,
    /// 17 digits, the precision of a double.
    #[arg(long)]
    pub f64: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("not a number: {text}"))?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err("not a positive time".to_owned()) }
}

fn memory_size(text: &str) -> Result<u64, String> {
    let (number, shift) = match text.trim_end_matches(['b', 'B']).split_at_checked(text.len() - 1) {
        Some((number, "K" | "k")) => (number, 10),
        Some((number, "M" | "m")) => (number, 20),
        Some((number, "G" | "g")) => (number, 30),
        _ => (text, 0),
    };
    let value: u64 = number.trim().parse().map_err(|_| format!("not a size: {text}"))?;
    value.checked_shl(shift).filter(|v| v >> shift == value).ok_or_else(|| "too large".to_owned())
}
