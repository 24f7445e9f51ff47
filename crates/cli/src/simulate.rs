//! `lindstedt simulate`: the motion in the time domain, its events, sections and figures.

mod journal;

use crate::Outcome;
use crate::arguments::{Figure, Section, SimulateOptions};
use crate::failure::Failure;
use crate::session::Session;
use journal::Kept;
use lindstedt::motion::{self, Bifurcation, Chaos, End, Start, View};
use lindstedt::{Exact, Oscillator, Simulate, Stability, Work};

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
        section: options.section.map(Section::asked),
        skip: options.skip,
        drawn: !options.plot.is_empty(),
        view: options.figure.and_then(Figure::view),
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
    let swept = options.figure == Some(Figure::Bifurcation);
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
        section: options.section.map(Section::asked),
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

impl Section {
    fn asked(self) -> motion::Section {
        match self {
            Self::Stroboscopic => motion::Section::Stroboscopic,
            Self::Impact => motion::Section::Impact,
            Self::Velocity => motion::Section::Velocity,
        }
    }
}

impl Figure {
    fn view(self) -> Option<View> {
        match self {
            Self::Phase => Some(View::Phase),
            Self::Time => Some(View::Time),
            Self::Section => Some(View::Section),
            Self::Bifurcation => None,
        }
    }
}
