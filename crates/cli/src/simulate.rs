//! `lindstedt simulate`: the motion in the time domain, its events, sections and figures.

mod case;
mod chaos;
mod column;
mod figure;
mod growth;
mod history;
mod motion;
mod orbit;
pub mod plot;
mod report;
mod request;
mod setup;
mod sweep;

use crate::Outcome;
use crate::arguments::{Format, SimulateOptions};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::session::{Session, digits};
use lindstedt::simulate::SimulateError;
use motion::{Motion, Plan, align};
use report::Answer;
use serde_json::json;
use setup::{Setup, Start};

/// Digits more, in which the second integration is made.
const MORE: u32 = 8;
/// Integrations with more and more digits, until those asked for are there.
const TRIES: u32 = 4;

pub fn run(options: &SimulateOptions, session: &Session<'_>) -> Outcome {
    let digits = u32::try_from(digits(&options.precision)?).unwrap_or(u32::MAX);
    plot::check(&options.plot)?;
    let state = request::state(options)?;
    let perturbation = request::perturbation(options)?;
    let doubles = options.precision.f64;
    // Digits that are lost on the way are made up for: what is computed beforehand has them.
    let spare = if doubles { 40 } else { digits.saturating_add(40) };
    let start = Start {
        state,
        history: options.history.as_deref(),
        perturbation,
        sweep: options.sweep.is_some(),
    };
    let setup = Setup::read(&options.problem, &options.set, &start, digits + spare)?;
    let figure = request::figure(options, &setup)?;
    output::check_writable(session)?;
    if chaos::wanted(options) {
        return diagnose(options, setup, session);
    }
    if let Some(text) = &options.sweep {
        let text = request::sweep(text, &setup)?;
        return bifurcation(sweep::Diagram::read(options, setup, &text)?, options, session);
    }
    let mut plan = request::plan(options, setup)?;
    if figure == crate::arguments::Figure::Section && plan.section.is_none() {
        plan.section = request::section(options, &plan.setup)?;
    }
    let (motion, finer, working) = integrate(&mut plan, digits, doubles, session)?;
    let chaotic = finer.is_none();
    let half = if plan.perturbed() && !chaotic {
        let half = plan.run_half(working, doubles, &|| session.goes_on());
        half.map(|half| growth::shifts(&plan, &half))
    } else {
        None
    };
    session.done();
    if plan.skip > 0 && motion.points.is_empty() {
        output::warn(&format!("--skip {} leaves out every point of the section", plan.skip));
    }
    let finer = finer.as_ref().unwrap_or(&motion);
    let answer = Answer { plan: &plan, motion: &motion, finer, digits, chaotic, half };
    let text = match session.format() {
        Format::Json => format!("{:#}\n", answer.json(session)),
        Format::Text => answer.text(),
        Format::Latex => answer.latex(),
        Format::Markdown => answer.markdown(),
    };
    for path in &options.plot {
        plot::write(path, || Ok(answer.csv()), || figure::draw(figure, &plan, &motion))?;
    }
    output::write(session, &text)?;
    if chaotic {
        output::warn(
            "no digit is left in doubles (without --f64 there are some, over a shorter time; \
             --lyapunov and --zero-one tell how chaotic)",
        );
    }
    if let Some(reason) = &plan.cut {
        output::warn(&format!("{reason}: the motion up to there"));
    }
    Ok(match (motion.complete, chaotic) {
        (false, _) => NO_ANSWER,
        (true, true) => UNDECIDED,
        (true, false) => 0,
    })
}

/// The logarithm of an error that leaves not one digit.
const NOT_ONE_DIGIT: f64 = -1.0;

/// Two integrations, the second with more digits, both with so many that their difference leaves
/// the digits asked for. In doubles there is one try; no second motion where it has
/// not one digit or met other events.
///
/// Where the motion ends in a singularity, the plan is cut shortly before it.
fn integrate(
    plan: &mut Plan,
    digits: u32,
    doubles: bool,
    session: &Session<'_>,
) -> Result<(Motion, Option<Motion>, u32), Failure> {
    let mut working = if doubles { 16 } else { digits.saturating_add(4) };
    let undecided = |message: String, hint: &str| Failure {
        exit: UNDECIDED,
        code: "not-enough-digits",
        message,
        hint: hint.to_owned(),
    };
    let (mut lost, mut same) = (0.0, false);
    for left in (0..TRIES).rev() {
        session.say(format!("{working} digits"));
        let goes_on = || session.goes_on();
        let pair = plan.run(working, doubles, &goes_on).and_then(|motion| {
            let finer = plan.run(working.saturating_add(MORE), false, &goes_on)?;
            Ok((motion, finer))
        });
        let (mut motion, mut finer) = match pair {
            Err(error) if plan.cut.is_none() && singular(&error).is_some() => {
                plan.cut_before(singular(&error).unwrap_or_default(), error.to_string());
                continue;
            }
            // Near a branch point, or a double root to working precision: more digits may tell.
            Err(error) if !doubles && degenerate(&error) && left > 0 => {
                working = working.saturating_mul(2);
                continue;
            }
            pair => pair?,
        };
        align(&mut motion, &mut finer);
        for motion in [&mut motion, &mut finer] {
            motion.points.drain(..plan.skip.min(motion.points.len()));
        }
        if !session.goes_on() {
            return Err(stopped(session));
        }
        let answer =
            Answer { plan, motion: &motion, finer: &finer, digits, chaotic: false, half: None };
        let comparable = answer.comparable();
        same = comparable;
        lost = answer.log10_error() + f64::from(digits);
        let has_digits = if doubles { answer.log10_error() < NOT_ONE_DIGIT } else { lost <= 0.0 };
        if comparable && has_digits {
            return Ok((motion, Some(finer), working));
        }
        if doubles {
            return Ok((motion, None, working));
        }
        let more = if comparable { lost.ceil().clamp(1.0, 1e4) as u32 + 2 } else { digits };
        working = working.saturating_add(more);
    }
    let message = if same {
        format!("{digits} digits were not reached, {:.0} are missing", lost.clamp(1.0, 1e6))
    } else {
        format!("{digits} digits were not reached: with {MORE} more the events are others")
    };
    Err(undecided(message, "a shorter time, or more --digits; --f64 for a picture"))
}

/// The time of a singularity that ends the motion.
fn singular(error: &SimulateError) -> Option<f64> {
    match error {
        SimulateError::Escape { time, .. } | SimulateError::UnboundedVelocity { time, .. } => {
            Some(*time)
        }
        _ => None,
    }
}

fn degenerate(error: &SimulateError) -> bool {
    matches!(
        error,
        SimulateError::BranchPoint { .. }
            | SimulateError::StepTooSmall { .. }
            | SimulateError::Grazing { .. }
    )
}

/// `--lyapunov`, `--zero-one`.
fn diagnose(options: &SimulateOptions, setup: Setup, session: &Session<'_>) -> Outcome {
    let diagnosis = chaos::Diagnosis::compute(options, setup, session)?;
    session.done();
    let text = match session.format() {
        Format::Json => format!("{:#}\n", diagnosis.json(session)),
        _ => diagnosis.text(),
    };
    output::write(session, &text)?;
    Ok(0)
}

fn stopped(session: &Session<'_>) -> Failure {
    let (exit, code) = if session.interrupted() {
        (INTERRUPTED, "interrupted")
    } else {
        (UNDECIDED, "limit-seconds")
    };
    let message = "stopped before the end of the motion".to_owned();
    Failure { exit, code, message, hint: "a shorter time, or fewer --digits".into() }
}

fn bifurcation(
    mut diagram: sweep::Diagram,
    options: &SimulateOptions,
    session: &Session<'_>,
) -> Outcome {
    let complete = diagram.compute(options.resume.as_deref(), session)?;
    session.done();
    for path in &options.plot {
        plot::write(path, || Ok(diagram.csv()), || diagram.figure())?;
    }
    let failed = diagram.lines.iter().filter(|line| line.points.is_empty()).count();
    let verdict = format!(
        "{} of {} values of {}, {failed} without points, {} points in all",
        diagram.lines.len(),
        diagram.values.len(),
        diagram.name,
        diagram.lines.iter().map(|line| line.points.len()).sum::<usize>(),
    );
    let text = if session.format() == Format::Json {
        let at: serde_json::Map<_, _> =
            diagram.setup.at.iter().map(|(n, v)| (n.clone(), v.clone().into())).collect();
        let column = |line: &column::Line| json!({"value": line.value, "exact": line.exact, "points": line.points, "failure": line.failure});
        let result = json!({
            "problem": diagram.setup.name,
            "at": at,
            "digits": null,
            "tier": "doubles, without an error: a section of a motion with perturbations that grow is typical of it",
            "sweep": {
                "parameter": diagram.name,
                "section": format!("{:?}", diagram.section).to_lowercase(),
                "skip": diagram.transient,
                "kept": diagram.kept,
                "status": "estimated",
                "columns": diagram.lines.iter().map(column).collect::<Vec<_>>(),
            },
            "complete": complete,
            "verdict": verdict,
            "remarks": diagram.setup.remarks,
            "seconds": session.elapsed().as_secs_f64(),
        });
        format!("{result:#}\n")
    } else {
        diagram.text(&verdict)
    };
    output::write(session, &text)?;
    if complete {
        return Ok(0);
    }
    output::warn("stopped; with --resume FILE it can be continued");
    Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED })
}

impl From<SimulateError> for Failure {
    fn from(error: SimulateError) -> Self {
        Self::of(&error)
    }
}
