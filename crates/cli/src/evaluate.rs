//! `lindstedt evaluate`: numbers from the expansion.

use crate::Outcome;
use crate::arguments::{Precision, one_of};
use crate::failure::Failure;
use crate::session::Session;
use clap::Args;
use lindstedt::choices::{LANGUAGES, NORMALISATIONS, RESUMMATIONS};
use lindstedt::evaluate::averaged::{AveragedMotion, Start};
use lindstedt::evaluate::{Language, Times};
use lindstedt::grid::Axis;
use lindstedt::unstable::series::resummation::Method;
use lindstedt::{Condition, Error, Evaluate, Exact, Oscillator, Work};
use std::path::PathBuf;

/// A method; nothing is `auto`.
type Resum = Option<Method>;

#[derive(Debug, Args)]
pub struct EvaluateOptions {
    /// power-law, pendulum, duffing, van-der-pol, vibro-impact; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// The highest order; a quick one if not given.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000_000))]
    pub order: Option<u32>,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is: x(0), the first harmonic, or free to drift (averaging: a(t), psi(t)
    /// and x(t) at --times from --start or --state).
    #[arg(long, value_parser = one_of(NORMALISATIONS))]
    pub normalisation: Option<Condition>,
    /// How the series is summed; auto takes the least error estimate and says why.
    #[arg(long, value_parser = one_of(RESUMMATIONS), default_value = "auto")]
    pub resum: Resum,
    /// The solution x(t) at these times; x'(0) = 0, but for --phase, and x(0) or the first harmonic
    /// is the amplitude.
    #[arg(long, value_name = "LO..HI:COUNT or T1,T2,...", allow_hyphen_values = true)]
    pub times: Option<String>,
    /// The orbit as a theorem: period, frequency, amplitude and Floquet exponent enclosed, with the
    /// radius of the contraction proof; of a forced equation its responses with the force's period. With
    /// --times x(t) is enclosed; with --sweep every orbit of a family, and all values between where a
    /// uniform bound covers them.
    #[arg(long, conflicts_with_all = ["code", "start", "state"])]
    pub prove: bool,
    /// First-order averaging of any law g(x, x') of a linear spring, as numbers: the rates at this amplitude, the cycles
    /// up to it, the speed of a belt at which they begin to stick.
    #[arg(long, value_name = "AMPLITUDE", conflicts_with_all = ["prove", "sweep", "times", "code", "start", "state", "order", "plot"])]
    pub cycles: Option<String>,
    /// Period and frequency, of an averaged motion its rates at the start, over NAME=LO..HI:COUNT or NAME=V1,V2,...; at
    /// most two, the first along the horizontal axis.
    #[arg(long, value_name = "NAME=LO..HI:COUNT", conflicts_with_all = ["times", "code", "phase"])]
    pub sweep: Vec<String>,
    /// x(t) = X(omega t + PHASE).
    #[arg(long, value_name = "PHASE", default_value = "0", allow_hyphen_values = true)]
    pub phase: String,
    /// The averaged motion (free amplitude) from a(0) = A, psi(0) = PSI.
    #[arg(long, value_name = "A,PSI", allow_hyphen_values = true, conflicts_with = "state")]
    pub start: Option<String>,
    /// The averaged motion (free amplitude) from x(0) = X, x'(0) = V.
    #[arg(long, value_name = "X,V", allow_hyphen_values = true)]
    pub state: Option<String>,
    /// A figure of the solution (.svg) or a table (.csv); may be given twice. One period without
    /// --times, ten of an averaged motion.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    /// The solution as a function in this language instead of the report.
    #[arg(long, value_parser = one_of(LANGUAGES), conflicts_with = "plot")]
    pub code: Option<Language>,
    /// With --code: functions of the small parameter and, where a scaling carries it, the amplitude, too. The
    /// expansion of --order (8 without), cut off, not resummed.
    #[arg(long, requires = "code", conflicts_with_all = ["resum", "phase"])]
    pub functions: bool,
    /// Harmonics in the code.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=512))]
    pub harmonics: u32,
    #[command(flatten)]
    pub precision: Precision,
}

pub fn run(options: &EvaluateOptions, session: &Session<'_>) -> Outcome {
    let oscillator = session.oscillator(&options.problem, &options.set, options.normalisation)?;
    let work = session.precise_work(&options.precision)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    if let Some(largest) = &options.cycles {
        return session.show(oscillator.first_order(&Exact::parse(largest)?, &work), &[]);
    }
    let one = options.sweep.is_empty();
    let shown = one && !options.plot.is_empty() || options.code.is_some();
    let times = options.times.as_deref().map(Times::parse).transpose()?;
    let times = times.or_else(|| shown.then(Times::default));
    let drifts = oscillator.condition() == Some(Condition::FreeAmplitude);
    if drifts && !options.prove {
        return averaged(options, session, &oscillator, times, &work);
    }
    if options.start.is_some() || options.state.is_some() {
        let hint = "--normalisation free averages; else --set amplitude=A, --phase PHASE";
        let message = "--start and --state belong to averaged motions".to_owned();
        return Err(Failure::usage("start", message, hint));
    }
    let (order, method) = (options.order.map(|order| order as usize), options.resum);
    let question = Evaluate { order, method, times, phase: Exact::parse(&options.phase)? };
    if options.prove && options.sweep.is_empty() {
        return session.show(oscillator.prove(&question, &work), &options.plot);
    }
    let axes = options.sweep.iter().map(|text| oscillator.axis_until(text, &work.stop));
    if let (Some(columns), rows) = Axis::pair(axes)? {
        if options.prove {
            if rows.is_some() {
                let message = "a proved family is over one parameter".to_owned();
                return Err(Failure::usage("sweep", message, "one --sweep"));
            }
            return session.show(oscillator.prove_sweep(&question, columns, &work), &options.plot);
        }
        let swept = oscillator.evaluate_sweep(&question, columns, rows, &work);
        return session.show(swept, &options.plot);
    }
    if let Some(language) = options.code {
        let harmonics = options.harmonics as usize;
        if options.functions {
            let code = oscillator.expansion_code(&question, language, harmonics, &work);
            return session.show(code, &[]);
        }
        let code = oscillator.solution_code(&question, language, harmonics, &work);
        return session.show(code, &[]);
    }
    session.show(oscillator.evaluate(&question, &work), &options.plot)
}

fn averaged(
    options: &EvaluateOptions,
    session: &Session<'_>,
    oscillator: &Oscillator,
    times: Option<Times>,
    work: &Work,
) -> Outcome {
    let sums = !matches!(options.resum, None | Some(Method::PartialSum));
    for (asked, what, hint) in [
        (sums, "--resum", "the averaged series is broken off at --order"),
        (options.code.is_some(), "--code", "an averaged motion is no Fourier series in one phase"),
        (options.phase.trim() != "0", "--phase", "--start A,PSI has the phase"),
    ] {
        if asked {
            let message = format!("{what} does not belong to averaged motions");
            return Err(Failure::usage("averaged", message, hint));
        }
    }
    let start = options.start.as_deref().map(Start::parse_amplitude);
    let start = start.or_else(|| options.state.as_deref().map(Start::parse_state)).transpose();
    let start = start.map_err(Error::from)?;
    let order = options.order.map(|order| order as usize);
    let question = AveragedMotion { order, start, times };
    let axes = options.sweep.iter().map(|text| oscillator.axis_until(text, &work.stop));
    if let (Some(columns), rows) = Axis::pair(axes)? {
        return session
            .show(oscillator.averaged_sweep(&question, columns, rows, work), &options.plot);
    }
    session.show(oscillator.averaged_motion(&question, work), &options.plot)
}
