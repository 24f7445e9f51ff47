//! `lindstedt simulate`: the motion in the time domain, its events, sections and figures.

mod case;
mod figure;
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
use motion::{Motion, Plan};
use report::Answer;
use serde_json::json;
use setup::{Setup, Start};
use std::fmt::Write;

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
    if let Some(text) = &options.sweep {
        let text = request::sweep(text, &setup)?;
        return bifurcation(sweep::Diagram::read(options, setup, &text)?, options, session);
    }
    let mut plan = request::plan(options, setup)?;
    if figure == crate::arguments::Figure::Section && plan.section.is_none() {
        plan.section = request::section(options, &plan.setup)?;
    }
    let (motion, finer) = integrate(&plan, digits, doubles, session)?;
    session.done();
    let chaotic = finer.is_none();
    let finer = finer.as_ref().unwrap_or(&motion);
    let answer = Answer { plan: &plan, motion: &motion, finer, digits, chaotic };
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
    Ok(match (motion.complete, chaotic) {
        (false, _) => NO_ANSWER,
        (true, true) => UNDECIDED,
        (true, false) => 0,
    })
}

/// Two integrations, the second with more digits, both with so many that their difference leaves
/// the digits asked for. In doubles there is one try; no second motion where it met other events.
fn integrate(
    plan: &Plan,
    digits: u32,
    doubles: bool,
    session: &Session<'_>,
) -> Result<(Motion, Option<Motion>), Failure> {
    let mut working = if doubles { 16 } else { digits.saturating_add(4) };
    let undecided = |message: String, hint: &str| Failure {
        exit: UNDECIDED,
        code: "not-enough-digits",
        message,
        hint: hint.to_owned(),
    };
    let mut lost = 0.0;
    for _ in 0..TRIES {
        session.say(format!("{working} digits"));
        let goes_on = || session.goes_on();
        let motion = plan.run(working, doubles, &goes_on)?;
        let finer = plan.run(working + MORE, false, &goes_on)?;
        if !session.goes_on() {
            return Err(stopped(session));
        }
        let answer = Answer { plan, motion: &motion, finer: &finer, digits, chaotic: false };
        let comparable = answer.comparable();
        lost = answer.log10_error() + f64::from(digits);
        if comparable && (doubles || lost <= 0.0) {
            return Ok((motion, Some(finer)));
        }
        if doubles {
            return Ok((motion, None));
        }
        let more = if comparable { lost.ceil().clamp(1.0, 1e4) as u32 + 2 } else { digits };
        working = working.saturating_add(more);
    }
    let message =
        format!("{digits} digits were not reached, {:.0} are missing", lost.clamp(1.0, 1e6));
    Err(undecided(message, "a shorter time, or fewer --digits"))
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
    let failed = diagram.lines.iter().filter(|line| line.failure.is_some()).count();
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
        let column = |line: &sweep::Line| json!({"value": line.value, "points": line.points, "failure": line.failure});
        let result = json!({
            "problem": diagram.setup.name,
            "at": at,
            "digits": 16,
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
            "seconds": session.elapsed().as_secs_f64(),
        });
        format!("{result:#}\n")
    } else {
        let mut text = format!("{}: {verdict}\n", diagram.setup.name);
        for line in diagram.lines.iter().filter(|line| line.failure.is_some()) {
            let reason = line.failure.as_deref().unwrap_or_default();
            let _ = writeln!(text, "  {} = {}: {reason}", diagram.name, line.value);
        }
        text
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
        let (exit, code, hint) = match &error {
            SimulateError::Grazing { .. } | SimulateError::StepTooSmall { .. } => (
                UNDECIDED,
                "could-not-decide",
                "more --digits, or a start beside the degenerate one",
            ),
            SimulateError::MissingParameter { .. } | SimulateError::BadRestitution { .. } => {
                (NO_ANSWER, "outside-domain", "see `lindstedt problems`")
            }
            _ => (NO_ANSWER, "no-trajectory", "another start, or a shorter time"),
        };
        Self { exit, code, message: error.to_string(), hint: hint.to_owned() }
    }
}
