//! `lindstedt paper`: the paper, formula by formula, as a report.

mod figures;

use crate::Outcome;
use crate::arguments::{Format, PaperOptions};
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output::trouble;
use crate::session::Session;
use lindstedt_paper::{Options, Paper, page, read};
use std::path::Path;

pub fn run(options: &PaperOptions, session: &Session<'_>) -> Outcome {
    if let Some(directory) = session.out() {
        prepare(directory)?;
    }
    let depth = if options.quick { Options::QUICK } else { Options::FULL };
    session.expect_steps(depth.steps());
    let mut observer = |what: &str| {
        session.step(what.to_owned());
        session.goes_on()
    };
    let paper = read(depth, &mut observer)?;
    session.done();
    let seconds = session.elapsed().as_secs_f64();
    match session.out() {
        Some(directory) => write_directory(directory, &paper, seconds)?,
        None => {
            let report = match session.format() {
                Format::Text => page::text(&paper),
                Format::Markdown => page::markdown(&paper, &[]),
                Format::Latex => page::latex(&paper),
                Format::Json => page::json(&paper, seconds).map_err(unwritten)?,
            };
            crate::output::write(session, &report)?;
        }
    }
    if paper.complete {
        return Ok(0);
    }
    let reason = if session.interrupted() { "interrupted" } else { "time limit" };
    let rows: usize = paper.sections.iter().map(|s| s.rows.len()).sum();
    crate::output::warn(&format!("{reason}: {rows} rows are finished"));
    Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED })
}

/// The directory exists and can be written to; found out before the work.
fn prepare(directory: &Path) -> Result<(), Failure> {
    let failed = |error: std::io::Error| trouble(&directory.display().to_string(), &error);
    std::fs::create_dir_all(directory).map_err(failed)?;
    let probe = directory.join(".lindstedt-probe");
    std::fs::write(&probe, "").map_err(failed)?;
    std::fs::remove_file(&probe).map_err(failed)
}

/// Data that cannot be written as JSON.
fn unwritten(error: serde_json::Error) -> Failure {
    let message = format!("no JSON: {error}");
    Failure { exit: UNDECIDED, code: "undecided", message, hint: String::new() }
}

fn write_directory(directory: &Path, paper: &Paper, seconds: f64) -> Result<(), Failure> {
    let figures = figures::draw(&paper.trust)?;
    for (name, content) in page::files(paper, figures, seconds).map_err(unwritten)? {
        let path = directory.join(name);
        std::fs::write(&path, content)
            .map_err(|error| trouble(&path.display().to_string(), &error))?;
    }
    Ok(())
}
