//! `lindstedt paper`: the paper, formula by formula, as a report.

use crate::arguments::Format;
use crate::failure::Failure;
use crate::output::trouble;
use crate::session::Session;
use crate::terminal::warn;
use crate::{Outcome, output};
use clap::Args;
use lindstedt_paper::{Options, page, read};
use lindstedt_report::Format as Written;
use std::path::Path;

/// With --out DIR the report and its data are written into that directory.
#[derive(Debug, Args)]
pub struct PaperOptions {
    /// Lower orders, some ten seconds.
    #[arg(long)]
    pub quick: bool,
}

pub fn run(options: &PaperOptions, session: &Session<'_>) -> Outcome {
    if let Some(directory) = session.out() {
        if session.format() != Format::Text {
            let message = "--out writes the page and its data: --format has no effect".to_owned();
            return Err(Failure::usage("format", message, "leave out --format, or --out"));
        }
        prepare(directory)?;
    }
    let depth = if options.quick { Options::QUICK } else { Options::FULL };
    session.expect_steps(depth.steps());
    let mut observer = |what: &str| {
        session.step(what.to_owned());
        true
    };
    let paper = read(depth, &session.watch.stop(), &mut observer)?;
    session.done();
    let seconds = session.watch.elapsed().as_secs_f64();
    if let Some(directory) = session.out() {
        let files = page::files(&paper, seconds).map_err(Failure::figure)?;
        session.watch.writing();
        for (name, content) in files {
            output::write_file(&directory.join(name), &content)?;
        }
        let main = directory.join(page::PAGE);
        let line = format!("wrote {} ({})\n", main.display(), page::tally(&paper));
        output::write(None, &line)?;
    } else {
        let report = match session.format() {
            Format::Text => page::write(&paper, Written::Text),
            Format::Markdown => page::write(&paper, Written::Markdown),
            Format::Latex => page::write(&paper, Written::Latex),
            Format::Json => page::json(&paper, seconds).map_err(Failure::figure)?,
        };
        session.watch.writing();
        output::write(None, &report)?;
    }
    let Some(why) = session.watch.reason().filter(|_| !paper.complete) else { return Ok(0) };
    let rows: usize = paper.sections.iter().map(|s| s.rows.len()).sum();
    warn(&format!("{}: {rows} rows are finished", why.words));
    Ok(why.exit)
}

/// The directory exists and can be written to; found out before the work.
fn prepare(directory: &Path) -> Result<(), Failure> {
    let failed = |error: std::io::Error| trouble(&directory.display().to_string(), &error);
    std::fs::create_dir_all(directory).map_err(failed)?;
    output::check_file(&directory.join(page::PAGE))
}
