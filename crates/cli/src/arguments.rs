//! The arguments. Names are part of the public interface: add, do not rename.

use clap::{Args, Parser, Subcommand, ValueEnum};
use lindstedt::unstable::series::resummation::Method;
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
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt problems --show duffing")]
    Problems(ProblemsOptions),
    /// Derive the expansion of a problem, order by order, and check it.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt derive duffing --order 3\n\
        \x20 lindstedt derive \"x'' + x = eps*(1 - x^4)*x'\" --normalisation free --order 3")]
    Derive(DeriveOptions),
    /// The period and the solution at given parameters, by resummation of the expansion.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt evaluate duffing --set eps=1/2 --order 12 --digits 12\n\
        \x20 lindstedt evaluate duffing --order 4 --sweep eps=0..1:3 --digits 8")]
    Evaluate(EvaluateOptions),
    /// The Melnikov threshold of homoclinic chaos: value, zeros, cusps, curves, surfaces.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt threshold stick-slip --digits 10\n\
        \x20 lindstedt threshold stick-slip --sweep vstar=0..1:5 --digits 8")]
    Threshold(ThresholdOptions),
    /// Steady states at resonance: response curves, folds, stability; all states, their number proved.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt respond \"x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)\" --set eps=1/10 --set F=1/2 --sweep sigma=-1..3")]
    Respond(RespondOptions),
    /// Stability of the vibro-impact orbit: the averaged prediction beside the exact truth, charts.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt stability vibro-impact --f64\n\
        \x20 lindstedt stability vibro-impact --sweep A=-0.3..0.3:5 --sweep B=-0.3..0.3:5 --f64")]
    Stability(StabilityOptions),
    /// Speed against accuracy: every tier at every order and precision, timed, beside the truth.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt trade power-law --set n=3/2 --orders 4,16 --digits 30 --harmonics 16 --repeats 1")]
    Trade(TradeOptions),
    /// The motion in the time domain, with impacts, sticking and delay: events, sections, figures.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt simulate duffing --periods 1 --digits 20\n\
        \x20 lindstedt simulate vibro-impact --impacts 3 --digits 12")]
    Simulate(SimulateOptions),
    /// The expansion against the time domain: observed order of accuracy, verdict.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt verify duffing --order 3")]
    Verify(VerifyOptions),
    /// Read the paper: derive it, compare it with the print, tabulate what is true.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt paper --quick")]
    Paper(PaperOptions),
    /// A script with which a shell completes commands and options.
    Completions(CompletionsOptions),
    /// The manual page of the program, or of one of its commands.
    Man(ManOptions),
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
    /// Stop before more memory is taken (512M, 8G), with what is finished (exit code 4).
    #[arg(long, global = true, value_name = "SIZE", default_value = "8G", value_parser = memory_size)]
    pub limit_memory: u64,
    /// Threads for what runs on several cores; by default RAYON_NUM_THREADS, else all cores. The results are the same.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct ProblemsOptions {
    /// Show one problem as a problem file, with its classification.
    #[arg(long, value_name = "NAME|FILE")]
    pub show: Option<String>,
}

#[derive(Debug, Args)]
pub struct DeriveOptions {
    /// power-law, pendulum, vibro-impact, duffing, van-der-pol; a problem file (.toml); or an equation in quotes.
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
    /// A parameter that is sought as a series: for which a forced motion stays periodic (edges of tongues), or at a Hopf point,
    /// in the size of the cycle born there.
    #[arg(long, value_name = "NAME")]
    pub unknown: Option<String>,
    /// A nonlinear normal mode by its number (1, 2, ...): backbone and shape.
    #[arg(long, value_name = "K", conflicts_with = "unknown")]
    pub mode: Option<u32>,
    /// By the clock where the equation allows it and else by the driver; one of them; or the energy
    /// integral (frequency alone: conservative forces that are polynomial, the power law, the pendulum).
    #[arg(long, value_enum, default_value_t = Route::Auto)]
    pub route: Route,
    /// The frequency and the period alone, to higher order: by the energy integral where it applies, and else modulo
    /// primes (limit cycles, forces with velocities).
    #[arg(long, value_enum, value_name = "WHAT")]
    pub only: Option<Only>,
    /// Exact, or numbers with an estimated error: collocation (--digits or --f64) or a truncated
    /// Fourier series in doubles (--harmonics).
    #[arg(long, value_enum, default_value_t = TierName::Exact)]
    pub tier: TierName,
    /// Harmonics of each symmetry class in the Fourier tier.
    #[arg(long, default_value_t = 64, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=16384))]
    pub harmonics: u32,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TierName {
    /// Exact rings; every order substituted back.
    Exact,
    /// Values at double-exponential nodes.
    Collocation,
    /// A truncated Fourier series.
    Fourier,
}

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
    #[arg(long, value_enum)]
    pub normalisation: Option<Normalisation>,
    /// How the series is summed; auto takes the least error estimate and says why.
    #[arg(long, value_enum, default_value_t = Resum::Auto)]
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
    #[arg(long, value_enum, conflicts_with = "plot")]
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    Rust,
    Python,
    C,
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
    /// The least error estimate, or a simpler method within a factor ten of it.
    Auto,
}

impl From<Resum> for Option<Method> {
    fn from(resum: Resum) -> Self {
        Some(match resum {
            Resum::None => Method::PartialSum,
            Resum::Pade => Method::Pade,
            Resum::Uniform => Method::Uniform,
            Resum::UniformPade => Method::UniformPade,
            Resum::Conformal => Method::ConformalPade,
            Resum::BorelPade => Method::BorelPade,
            Resum::Auto => return None,
        })
    }
}

impl From<Language> for lindstedt::evaluate::Language {
    fn from(language: Language) -> Self {
        match language {
            Language::Rust => Self::Rust,
            Language::Python => Self::Python,
            Language::C => Self::C,
            Language::Latex => Self::Latex,
        }
    }
}

#[derive(Debug, Args)]
pub struct CompletionsOptions {
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManOptions {
    /// A command; without it the program.
    #[arg(value_name = "COMMAND")]
    pub of: Option<String>,
}

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

#[derive(Debug, Args)]
pub struct RespondOptions {
    /// A built-in name, the path of a problem file (.toml), or an equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// The parameter that varies, in COUNT steps at least; two: folds and Hopf points in their plane; none: all states at the
    /// values set.
    #[arg(long, value_name = "NAME=LO..HI[:COUNT]")]
    pub sweep: Vec<String>,
    /// Orders of the slow flow.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=60))]
    pub order: u32,
    /// The largest amplitude looked at; by default one that has all states of the first order.
    #[arg(long = "box", value_name = "AMPLITUDE")]
    pub amplitude: Option<String>,
    /// With --sweep: the equation itself integrated along the values, upwards and downwards, each from the end of the one
    /// before: where it jumps.
    #[arg(long, requires = "sweep")]
    pub follow: bool,
    /// x and x' at t = 0, of several unknowns one pair after the other: which state does the motion go to?
    #[arg(long, value_name = "X,V[,...]", allow_hyphen_values = true)]
    pub start: Option<String>,
    /// A figure (.svg) or a table (.csv) of the sweep; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
}

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
    #[arg(long, value_enum, default_value_t = PredictorChoice::Both)]
    pub predictor: PredictorChoice,
    /// Which orbit meets which flow in the averaged prediction.
    #[arg(long, value_enum, default_value_t = VariantChoice::E)]
    pub variant: VariantChoice,
    /// The order of the averaged flow.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub order: u32,
    /// How the velocity kick of B is treated in the characteristic function.
    #[arg(long, value_enum, default_value_t = KickChoice::Mean)]
    pub kick: KickChoice,
    /// A chart (.svg) or a table (.csv) of the sweeps; may be given twice.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    #[command(flatten)]
    pub precision: Precision,
}

#[derive(Debug, Args)]
pub struct TradeOptions {
    /// power-law, pendulum, duffing, van-der-pol; a problem file (.toml); or an equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// What the amplitude is; the true period is sought from x(0).
    #[arg(long, value_enum)]
    pub normalisation: Option<Normalisation>,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PredictorChoice {
    /// The averaged prediction (KBM) alone.
    Kbm,
    /// The exact characteristic function alone.
    Exact,
    /// Both, with their agreement.
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "kebab-case")]
pub enum VariantChoice {
    /// Orbit and map of the equivalent flow.
    #[value(name = "E")]
    E,
    /// The true orbit's saltation with the equivalent flow.
    #[value(name = "S")]
    S,
    /// The paper's letter.
    #[value(name = "P")]
    P,
    /// The averaging that knows of the impact within the delay.
    ImpactAware,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KickChoice {
    None,
    Mean,
    Before,
    After,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Route {
    /// The clock where the equation allows it, else the driver.
    Auto,
    /// Solution and frequency order by order, checked by substitution.
    Driver,
    /// Solution and frequency from the still part of the solution and one shift of its clock.
    Clock,
    /// The frequency alone, exact and to much higher order.
    Energy,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Only {
    /// The series of omega^2, omega and T.
    Frequency,
}

/// With --out DIR the report and its data are written into that directory.
#[derive(Debug, Args)]
pub struct PaperOptions {
    /// Lower orders, some ten seconds.
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
pub struct SimulateOptions {
    /// power-law, pendulum, duffing, van-der-pol, vibro-impact, stick-slip; a problem file (.toml); or an
    /// equation in quotes.
    pub problem: String,
    /// A parameter: NAME=VALUE with an exact value (1/3, 0.1, pi/4, 2.5e-3).
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// x(0) and x'(0), with several unknowns X,V,Y,W,...; by default those of the file, else at rest at the amplitude, on the
    /// orbit (vibro-impact), 1/10 and 0 (stick-slip).
    #[arg(long, value_name = "X,V", allow_hyphen_values = true)]
    pub state: Option<String>,
    /// The motion before t = 0, for an equation with a delay: constant, free-flight (without
    /// delay, through the start), or an expression in t.
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub history: Option<String>,
    /// The end.
    #[arg(long, value_name = "T", allow_hyphen_values = true, conflicts_with_all = ["periods", "impacts"])]
    pub until: Option<String>,
    /// The end: periods of the force, or without one maxima of x after the start; with --sweep the
    /// points kept after --skip.
    #[arg(long, value_name = "N", conflicts_with = "impacts")]
    pub periods: Option<u32>,
    /// The end: the N-th impact.
    #[arg(long, value_name = "N")]
    pub impacts: Option<u32>,
    /// Times at which the state is given; by default 21 of equal distance. Without an end the last of
    /// them is the end.
    #[arg(long, value_name = "LO..HI:COUNT", allow_hyphen_values = true)]
    pub times: Option<String>,
    /// The section whose points are listed.
    #[arg(long, value_enum)]
    pub section: Option<Section>,
    /// Bifurcation diagram over a parameter: the points of the section after --skip. NAME alone
    /// has the range that a problem file says (swept).
    #[arg(long, value_name = "NAME=LO..HI:COUNT", allow_hyphen_values = true)]
    pub sweep: Option<String>,
    /// With --sweep: every value starts from the last point of the one before, upwards and then downwards.
    #[arg(long, requires = "sweep")]
    pub follow: bool,
    /// Points of the section that are left out at the beginning [default: 200 with --sweep, 500
    /// periods with --lyapunov and --zero-one, else 0].
    #[arg(long, value_name = "N")]
    pub skip: Option<u32>,
    /// Velocity added at the start, in units of the impact velocity: growth ratios per impact
    /// (vibro-impact, on the orbit).
    #[arg(long, value_name = "DELTA", allow_hyphen_values = true)]
    pub perturb: Option<String>,
    /// The largest Lyapunov exponent instead of the motion, over --periods [default: 2000] periods
    /// of the force (units of time without one) after --skip [default: 500].
    #[arg(long, conflicts_with = "sweep")]
    pub lyapunov: bool,
    /// The 0-1 test for chaos instead of the motion, of x once per period of the force (of the
    /// maxima of x without one), over --periods after --skip.
    #[arg(long, conflicts_with = "sweep")]
    pub zero_one: bool,
    /// What a figure shows.
    #[arg(long, value_enum)]
    pub figure: Option<Figure>,
    /// A figure (.svg) or a table (.csv); may be given several times.
    #[arg(long, value_name = "FILE")]
    pub plot: Vec<PathBuf>,
    /// Keeps the finished parameters of a sweep in this file and continues from it.
    #[arg(long, value_name = "FILE", requires = "sweep")]
    pub resume: Option<PathBuf>,
    #[command(flatten)]
    pub precision: Precision,
}

/// A Poincare section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Section {
    /// Once per period of the force, t = 2 pi n/omega.
    Stroboscopic,
    /// Just before each impact.
    Impact,
    /// x' = 0 from above: maxima of x.
    Velocity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Figure {
    /// x' over x, sticking marked.
    Phase,
    /// x over t with impacts and sticking.
    Time,
    /// The points of the section.
    Section,
    /// The points of the section over the swept parameter.
    Bifurcation,
}

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
    #[arg(long, value_enum)]
    pub normalisation: Option<Normalisation>,
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
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("not a positive number".to_owned())
    }
}

fn memory_size(text: &str) -> Result<u64, String> {
    let size = text.trim_end_matches(['b', 'B']);
    let (number, shift) = match size.split_at_checked(size.len().saturating_sub(1)) {
        Some((number, "K" | "k")) => (number, 10),
        Some((number, "M" | "m")) => (number, 20),
        Some((number, "G" | "g")) => (number, 30),
        _ => (size, 0),
    };
    let value: u64 = number.trim().parse().map_err(|_| format!("not a size: {text}"))?;
    value.checked_shl(shift).filter(|v| v >> shift == value).ok_or_else(|| "too large".to_owned())
}
