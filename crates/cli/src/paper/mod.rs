//! `lindstedt paper`: the paper, formula by formula, as a report.

use crate::Outcome;
use crate::arguments::{Format, PaperOptions};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output::trouble;
use crate::session::Session;
use lindstedt_paper::{Options, page, read};
use lindstedt_report::Format as Written;
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
    let unwritten = |error: page::PageError| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: error.to_string(),
        hint: String::new(),
    };
    match (session.out(), session.format()) {
        (Some(directory), _) => {
            for (name, content) in page::files(&paper, seconds).map_err(unwritten)? {
                let path = directory.join(name);
                std::fs::write(&path, content)
                    .map_err(|error| trouble(&path.display().to_string(), &error))?;
            }
            let main = directory.join(page::PAGE);
            let line = format!("wrote {} ({})\n", main.display(), page::tally(&paper));
            crate::output::write(None, &line)?;
        }
        (None, format) => {
            let report = match format {
                Format::Text => page::write(&paper, Written::Text),
                Format::Markdown => page::write(&paper, Written::Markdown),
                Format::Latex => page::write(&paper, Written::Latex),
                Format::Json => page::json(&paper, seconds).map_err(unwritten)?,
            };
            crate::output::write(session.out(), &report)?;
        }
    }
    if paper.complete {
        return Ok(0);
    }
    let reason = if session.interrupted() { "interrupted" } else { "time limit" };
    let rows: usize = paper.sections.iter().map(|s| s.rows.len()).sum();
    crate::terminal::warn(&format!("{reason}: {rows} rows are finished"));
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
