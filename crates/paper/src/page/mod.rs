//! The page of the paper: text, Markdown, LaTeX, HTML, JSON and CSV are readers of [`Paper`].

mod data;
mod html;
mod latex;
mod markdown;
mod text;

use crate::{Paper, Section, Table, Text, Verdict};
use serde::Serialize;
use std::fmt::Write;

pub use html::report as html;
pub use latex::report as latex;
pub use markdown::report as markdown;
pub use text::report as text;

/// A figure of the summary.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its name as a file, without ".svg".
    pub name: &'static str,
    /// The section of the paper it belongs to.
    pub section: u32,
    /// What it shows.
    pub caption: Text,
    /// The picture.
    pub svg: String,
}

/// All files of the report with their names: pages, data, figures. `seconds` is what the work took.
///
/// # Errors
/// As [`json`].
pub fn files(
    paper: &Paper,
    figures: Vec<Figure>,
    seconds: f64,
) -> Result<Vec<(String, String)>, serde_json::Error> {
    let mut files = vec![
        ("report.html".to_owned(), html(paper, &figures)),
        ("report.md".to_owned(), markdown(paper, &figures)),
        ("report.json".to_owned(), json(paper, seconds)?),
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
    Ok(files)
}

/// Everything as data; `seconds` is what the work took.
///
/// # Errors
/// None that can occur: all keys are text.
pub fn json(paper: &Paper, seconds: f64) -> Result<String, serde_json::Error> {
    #[derive(Serialize)]
    struct Run<'a> {
        #[serde(flatten)]
        paper: &'a Paper,
        seconds: f64,
    }
    Ok(format!("{}\n", serde_json::to_string_pretty(&Run { paper, seconds })?))
}

/// Whether a cell of a table is a number and nothing else.
fn is_plain_number(cell: &str) -> bool {
    cell.chars().all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e'))
}

/// What the numbers of the report are worth.
const CLASSES: &str = "Every decimal is certified to the last digit shown, except in entries and tables that say estimated.";

/// What the letters of the derived formulas mean that the paper does not have.
const SYMBOLS: [(&str, &str); 6] = [
    ("$v$", "$x'_-$, the velocity before the impact"),
    (
        "$E, theta, Delta$",
        "$E = exp(-beta c)$, $theta = 2 beta lambda$, $Delta = E + 1/E - 2 cos(theta)$ in the rows $C$ to \
         $sin phi$; $E = exp(2 beta R)$, $theta = 2 beta alpha0$ in (11) to (16)",
    ),
    (
        "$G$",
        "the characteristic function of the delayed system, with $z(t)/gamma$ in the place of $z(t - T)$",
    ),
    (
        "$l, mu_m, Lambda_m$",
        "$l = -ln|cos tau|$, $mu_m$ the mean of $l^m/m!$ ($mu_1 = ln 2$), $Lambda_m' = l^m/m! - mu_m$, \
         $Lambda_m(0) = 0$; $Lambda_1 = L(tau) - tau ln 2$",
    ),
    ("$S_n$", "$sum_k (-1)^k k^n/(2k+1)!$: $S_0 = sin 1$"),
    ("$kappa$", "the factor of $x$ at order zero"),
];

/// "44 statements: 30 agrees, ..." in one line.
fn summary(section: &Section) -> String {
    let counts: Vec<String> =
        Verdict::ALL.iter().map(|v| format!("{} {}", section.count(*v), v.name())).collect();
    format!("{} statements: {}", section.rows.len(), counts.join(", "))
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

fn line(cells: &[Text]) -> String {
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
            row.verdict.name().into(),
            row.evidence.clone(),
        ];
        let _ = write!(text, "{}", line(&cells));
    }
    text
}
