//! `lindstedt simulate`: the motion in the time domain, its events, sections and figures.

mod journal;

use crate::Outcome;
use crate::arguments::{Precision, one_of};
use crate::failure::Failure;
use crate::session::Session;
use clap::Args;
use journal::Kept;
use lindstedt::choices::{FIGURES, SECTIONS};
use lindstedt::motion::{Bifurcation, Chaos, End, Section, Start, View};
use lindstedt::{Exact, Oscillator, Simulate, Stability, Work};
use std::path::PathBuf;

/// What a figure shows: a motion, or nothing but the diagram of a sweep.
type Figure = Option<View>;

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
    #[arg(long, value_parser = one_of(SECTIONS))]
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
    #[arg(long, value_parser = one_of(FIGURES))]
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

pub fn run(options: &SimulateOptions, session: &Session<'_>) -> Outcome {
    let (branch, set) = Stability::read_branch(&options.set)?;
    let oscillator = session.oscillator(&options.problem, &set, None)?;
    let work = session.precise_work(&options.precision)?;
    session.check_writable(&options.problem, &options.plot, options.resume.as_deref())?;
    check(options)?;
    let perturbation = options.perturb.as_deref().map(Start::read_perturbation).transpose()?;
    let state = options.state.as_deref().map(Start::read_state).transpose()?;
    let start = Start { state, history: options.history.clone(), branch, perturbation };
    if options.lyapunov || options.zero_one {
        let question = Chaos { start, lyapunov: options.lyapunov, ..Chaos::default() };
        let question = Chaos {
            zero_one: options.zero_one,
            kept: options.periods.unwrap_or(question.kept),
            skipped: options.skip.unwrap_or(question.skipped),
            ..question
        };
        return session.show(oscillator.chaos(&question, &work), &[]);
    }
    if let Some(sweep) = &options.sweep {
        let question = Bifurcation { start, follow: options.follow, ..Bifurcation::over(sweep) };
        return diagram(options, session, &oscillator, &work, question);
    }
    let question = Simulate {
        start,
        end: end(options)?,
        times: options.times.as_deref().map(Simulate::read_times).transpose()?,
        section: options.section,
        skip: options.skip,
        drawn: !options.plot.is_empty(),
        view: options.figure.flatten(),
    };
    session.show(oscillator.motion(&question, &work), &options.plot)
}

/// Refuses options that do not go together.
fn check(options: &SimulateOptions) -> Result<(), Failure> {
    let usage = |code, message: &str, hint| Err(Failure::usage(code, message.to_owned(), hint));
    let counted = options.until.is_some() || options.times.is_some();
    let drawn = options.figure.is_some() || !options.plot.is_empty();
    let shown = drawn || options.section.is_some() || options.impacts.is_some();
    if (options.lyapunov || options.zero_one) && (counted || shown) {
        let message = "--lyapunov and --zero-one count periods and have no figure";
        return usage("chaos", message, "--periods 2000 --skip 500");
    }
    if options.figure.is_some() && options.plot.is_empty() {
        return usage("figure", "a figure needs a file", "--plot FILE.svg");
    }
    let swept = options.figure == Some(None);
    if options.figure.is_some() && swept != options.sweep.is_some() {
        let message = "a bifurcation diagram needs --sweep, and --sweep is one";
        return usage("figure", message, "--sweep gamma=0.5..1:400");
    }
    if options.sweep.is_some() && counted {
        return usage("sweep", "a sweep counts points: --periods or --impacts, and --skip", "");
    }
    Ok(())
}

fn end(options: &SimulateOptions) -> Result<Option<End>, Failure> {
    let time = options.until.as_deref().map(Exact::parse).transpose()?.map(End::Time);
    let periods = options.periods.map(End::Periods);
    Ok(time.or(periods).or(options.impacts.map(End::Impacts)))
}

fn diagram(
    options: &SimulateOptions,
    session: &Session<'_>,
    oscillator: &Oscillator,
    work: &Work,
    question: Bifurcation,
) -> Outcome {
    let question = Bifurcation {
        section: options.section,
        kept: options.periods.or(options.impacts).unwrap_or(question.kept),
        skipped: options.skip.unwrap_or(question.skipped),
        ..question
    };
    let Some(path) = &options.resume else {
        return session.show(oscillator.bifurcation(&question, work), &options.plot);
    };
    let mut kept = Kept::new(path);
    let answer = oscillator.bifurcation_resumed(&question, work, &mut kept);
    match kept.failure {
        Some(failure) => Err(failure),
        None => session.show(answer, &options.plot),
    }
}
