//! `lindstedt paper`: the paper, formula by formula, as a report.

mod data;
mod figures;
mod html;
mod latex;
mod markdown;
mod text;

use crate::Outcome;
use crate::arguments::{Format, PaperOptions};
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output::trouble;
use crate::session::Session;
use figures::Figure;
use lindstedt::paper::{Options, Paper, Section, Table, Verdict, read};
use serde_json::{Value as Json, json};
use std::fmt::Write;
use std::path::Path;

/// All verdicts, in the order of the summary.
const VERDICTS: [Verdict; 4] =
    [Verdict::Agrees, Verdict::Misprint, Verdict::Wrong, Verdict::NotReproducible];

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
                Format::Text => text::report(&paper),
                Format::Markdown => markdown::report(&paper, &[]),
                Format::Latex => latex::report(&paper),
                Format::Json => format!("{:#}\n", as_json(&paper, seconds)),
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

fn write_directory(directory: &Path, paper: &Paper, seconds: f64) -> Result<(), Failure> {
    let figures = figures::draw(&paper.trust)?;
    let mut files = vec![
        ("report.html".to_owned(), html::report(paper, &figures)),
        ("report.md".to_owned(), markdown::report(paper, &figures)),
        ("report.json".to_owned(), format!("{:#}\n", as_json(paper, seconds))),
    ];
    for section in &paper.sections {
        files.push((format!("section{}.csv", section.number), rows_csv(section)));
        for table in &section.tables {
            files.push((format!("section{}-{}.csv", section.number, table.name), csv(table)));
        }
    }
    for Figure { name, svg, .. } in figures {
        files.push((format!("{name}.svg"), svg));
    }
    files.extend(data::csv(&paper.trust));
    for (name, content) in files {
        let path = directory.join(name);
        std::fs::write(&path, content)
            .map_err(|error| trouble(&path.display().to_string(), &error))?;
    }
    Ok(())
}

fn as_json(paper: &Paper, seconds: f64) -> Json {
    let row = |row: &lindstedt::paper::Row| {
        json!({
            "label": row.label,
            "printed": row.printed,
            "derived": row.derived,
            "independent": row.independent,
            "verdict": row.verdict.name(),
            "evidence": row.evidence,
        })
    };
    let table = |table: &Table| {
        json!({
            "name": table.name,
            "title": table.title,
            "columns": table.columns,
            "rows": table.rows,
            "notes": table.notes,
        })
    };
    let section = |section: &Section| {
        json!({
            "section": section.number,
            "title": section.title,
            "rows": section.rows.iter().map(row).collect::<Vec<_>>(),
            "tables": section.tables.iter().map(table).collect::<Vec<_>>(),
        })
    };
    json!({
        "trust": data::json(&paper.trust),
        "sections": paper.sections.iter().map(section).collect::<Vec<_>>(),
        "complete": paper.complete,
        "seconds": seconds,
    })
}

/// Whether a cell of a table is a number and nothing else.
fn is_plain_number(cell: &str) -> bool {
    cell.chars().all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e'))
}

/// What the numbers of the report are worth.
const CLASSES: &str = "Every decimal is certified to the last digit shown, except in entries and tables that say estimated.";

/// What the verdicts mean.
const RULES: [(&str, &str); 4] = [
    (
        "agrees",
        "it holds as printed: exactly, or the printed decimals are the value, rounded or cut off",
    ),
    (
        "misprint",
        "a slip of the pen: one factor, sign, symbol, exponent, bracket or digit changed, two symbols \
     interchanged, or one term added or struck makes it hold, and nothing in the paper rests on the error; \
     where there are such slips at two places, both are named or have a row each",
    ),
    (
        "wrong",
        "it does not hold, and no slip of the pen explains it, or later statements rest on the error",
    ),
    ("not reproducible", "a number that follows from no formula, printed or corrected"),
];

/// What the letters of the derived formulas mean that the paper does not have.
const SYMBOLS: [(&str, &str); 6] = [
    ("v", "x'_-, the velocity before the impact"),
    (
        "E, theta, Delta",
        "E = exp(-beta c), theta = 2 beta lambda, Delta = E + 1/E - 2 cos(theta) in the rows C to sin phi; E = exp(2 beta R), theta = 2 beta alpha0 in (11) to (16)",
    ),
    (
        "G",
        "the characteristic function of the delayed system, with z(t)/gamma in the place of z(t - T)",
    ),
    (
        "l, mu_m, Lambda_m",
        "l = -ln|cos tau|, mu_m the mean of l^m/m! (mu_1 = ln 2), Lambda_m' = l^m/m! - mu_m, Lambda_m(0) = 0; Lambda_1 = L(tau) - tau ln 2",
    ),
    ("S_n", "sum_k (-1)^k k^n/(2k+1)!: S_0 = sin 1"),
    ("kappa", "the factor of x at order zero"),
];

/// "44 statements: 30 agrees, ..." in one line.
fn summary(section: &Section) -> String {
    let counts: Vec<String> =
        VERDICTS.iter().map(|v| format!("{} {}", section.count(*v), v.name())).collect();
    format!("{} statements: {}", section.rows.len(), counts.join(", "))
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

fn line(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|c| field(c)).collect();
    format!("{}\n", cells.join(","))
}

fn csv(table: &Table) -> String {
    let mut text = line(&table.columns);
    for row in &table.rows {
        text += &line(row);
    }
    text
}

fn rows_csv(section: &Section) -> String {
    let mut text = String::from("label,printed,derived,independent,verdict,evidence\n");
    for row in &section.rows {
        let cells = [
            row.label.clone(),
            row.printed.clone(),
            row.derived.clone(),
            row.independent.clone(),
            row.verdict.name().to_owned(),
            row.evidence.clone(),
        ];
        let _ = write!(text, "{}", line(&cells));
    }
    text
}
