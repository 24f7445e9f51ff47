//! `lindstedt evaluate`: numbers from the expansion.

use crate::Outcome;
use crate::arguments::{EvaluateOptions, Resum};
use crate::failure::Failure;
use crate::session::Session;
use lindstedt::evaluate::Times;
use lindstedt::evaluate::averaged::{AveragedMotion, Start};
use lindstedt::grid::Axis;
use lindstedt::unstable::equation::Condition;
use lindstedt::{Error, Evaluate, Exact, Oscillator, Work};

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
    let (order, method) = (options.order.map(|order| order as usize), options.resum.into());
    let question = Evaluate { order, method, times, phase: Exact::parse(&options.phase)? };
    if options.prove && options.sweep.is_empty() {
        return session.show(oscillator.prove(&question, &work), &options.plot);
    }
    let axes = options.sweep.iter().map(|text| oscillator.axis(text));
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
            let code = oscillator.expansion_code(&question, language.into(), harmonics, &work);
            return session.show(code, &[]);
        }
        let code = oscillator.solution_code(&question, language.into(), harmonics, &work);
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
    let sums = !matches!(options.resum, Resum::None | Resum::Auto);
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
    let axes = options.sweep.iter().map(|text| oscillator.axis(text));
    if let (Some(columns), rows) = Axis::pair(axes)? {
        return session
            .show(oscillator.averaged_sweep(&question, columns, rows, work), &options.plot);
    }
    session.show(oscillator.averaged_motion(&question, work), &options.plot)
}
