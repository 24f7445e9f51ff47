//! The page of the paper, a [`Document`]: text, Markdown, LaTeX and HTML are its readers, JSON is what
//! serde makes of [`Paper`], CSV is its tables.

mod data;
mod figures;
mod notation;
mod summary;

use crate::{Paper, Row, Section, Table, Text, Verdict};
use figures::Drawing;
use lindstedt_report::{Document, FigureError, Format, Text as Line, standalone};
use serde::Serialize;

pub use data::{PAGE, files};
#[doc(hidden)]
pub use {data::numeric, notation::latex, summary::numbers};

/// The width of the page as text.
const WIDTH: usize = 100;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The data cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
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

/// Everything as data; `seconds` is what the work took.
///
/// # Errors
/// None that can occur: all keys are text.
pub fn json(paper: &Paper, seconds: f64) -> Result<String, PageError> {
    #[derive(Serialize)]
    struct Run<'a> {
        #[serde(flatten)]
        paper: &'a Paper,
        seconds: f64,
    }
    Ok(lindstedt_report::json(&Run { paper, seconds })?)
}

/// The page in one format, to stand alone: no figures, no names of files beside it.
#[must_use]
pub fn write(paper: &Paper, format: Format) -> String {
    let linked = matches!(format, Format::Markdown | Format::Html);
    format.write_within(&document(paper, None, linked), WIDTH)
}

/// The page; with figures it is one of several [`files`], whose names it tells; `linked` where a reader
/// can follow links.
fn document(paper: &Paper, figures: Option<&[Drawing]>, linked: bool) -> Document {
    let rows: usize = paper.sections.iter().map(|s| s.rows.len()).sum();
    let rules = Verdict::ALL.map(|verdict| (stamp(verdict), verdict.rule()));
    let mut page = Document::titled(
        "Asymptotic approaches to strongly nonlinear and non-smooth systems, re-read by machine",
    )
    .words(format!(
        "{rows} statements of the paper by J. Awrejcewicz and I. V. Andrianov, \u{201c}Asymptotic approaches to \
         analysis of strongly non-linear and non-smooth systems\u{201d} (the copy that was read, a scan, names no journal \
         and no year): all of its formulas (1) to (51) and every number in its text, by lindstedt {}. For each: what is printed, what is derived from the \
         equations, what another route says where there is one, and the verdict that follows.",
        env!("CARGO_PKG_VERSION")
    ));
    if !paper.complete {
        page = page.words(
            Line::default()
                .strong("Unfinished: the work was stopped before its end.", "unfinished"),
        );
    }
    page = page.words(Line::default().strong(format!("{}.", tally(paper)), "tally"));
    let failing =
        paper.trust.findings.iter().filter_map(|found| Some((found, found.not_trusted.first()?)));
    let failing: Vec<Line> = failing
        .map(|(found, first)| {
            Line::words(format!("Section {}: ", found.section)).then(first.line())
        })
        .collect();
    if !failing.is_empty() {
        page = page.part(("fails", ""), "What fails", Document::default().list(failing));
    }
    if linked {
        page = page.words(contents(paper));
    }
    page = page.part(("verdicts", ""), "The verdicts", Document::default().lines(rules));
    if !paper.trust.findings.is_empty() {
        page = page.part(
            ("trust", ""),
            "Where the paper's methods can be trusted, and where not",
            summary::trust(paper, figures.unwrap_or_default()),
        );
    }
    page = page.part(("glance", ""), "The paper at a glance", summary::glance(paper, linked));
    for section in &paper.sections {
        let title = format!("Section {}: {}", section.number, section.title);
        let name = format!("section-{}", section.number);
        page = page.part((name, ""), title, section_page(section, figures.is_some()));
    }
    page.part(("notes", ""), "Notes", notes())
}

/// Where the parts of the page are.
fn contents(paper: &Paper) -> Line {
    let mut line = Line::default();
    if !paper.trust.findings.is_empty() {
        line = line.link("Where to trust", "#trust").and(", ");
    }
    line = line.link("At a glance", "#glance");
    for section in &paper.sections {
        let number = section.number;
        line = line.and(", ").link(format!("Section {number}"), format!("#section-{number}"));
    }
    line.and(", ").link("Notes", "#notes")
}

/// A verdict, as a class of the style sheet, too.
fn stamp(verdict: Verdict) -> Line {
    Line::default().strong(verdict.name(), verdict.class())
}

/// "44 statements: 30 agrees, ...", of one section or several.
fn counts(sections: &[Section]) -> String {
    let count = |v| sections.iter().map(|section| section.count(v)).sum::<usize>();
    let counts = Verdict::ALL.map(|v| format!("{} {}", count(v), v.name()));
    let all: usize = sections.iter().map(|section| section.rows.len()).sum();
    format!("{all} statements: {}", counts.join(", "))
}

/// The number of statements and how often each verdict is given, in one line.
#[must_use]
pub fn tally(paper: &Paper) -> String {
    counts(&paper.sections)
}

fn section_page(section: &Section, has_files: bool) -> Document {
    let mut line = Line::words(counts(std::slice::from_ref(section)) + ".");
    if has_files {
        let csv = data::rows_name(section);
        line = line.and(" Data: ").link(&csv, &csv).and(", ").link("report.json", "report.json");
        line = line.and(".");
    }
    let mut page = Document::default().words(line).words(CLASSES);
    for row in &section.rows {
        let class = format!("row {}", row.verdict.class());
        let title = row.label.line().and("  ").then(stamp(row.verdict));
        page = page.part((summary::anchor(section, row), class), title, row_page(row));
    }
    for table in &section.tables {
        let name = format!("table-{}-{}", section.number, table.name);
        let mut inner = Document::default();
        if has_files {
            let csv = data::table_name(section, table);
            inner = inner.words(Line::words("Data: ").link(&csv, &csv).and("."));
        }
        let inner = inner.table(table_of(table)).list(table.notes.iter().map(Text::line));
        page = page.part((name, "data"), table.title.line(), inner);
    }
    page
}

/// One statement; the evidence is open where the statement does not hold.
fn row_page(row: &Row) -> Document {
    let lines = |list: [(&'static str, &Text); 2]| {
        let some = list.into_iter().filter(|(_, value)| !value.is_empty());
        Document::default().lines(some.map(|(name, value)| (name, value.line())))
    };
    let page = lines([("printed", &row.printed), ("derived", &row.derived)]);
    let inner = lines([("independent", &row.independent), ("evidence", &row.evidence)]);
    page.folded("evidence", row.verdict != Verdict::Agrees, inner)
}

/// A table of the page as one of the report.
fn table_of(table: &Table) -> lindstedt_report::Table {
    let rows = table.rows.iter().map(|row| row.iter().map(Text::line).collect()).collect();
    lindstedt_report::Table { columns: table.columns.iter().map(Text::line).collect(), rows }
}

fn notes() -> Document {
    let lines =
        SYMBOLS.map(|(letters, meaning)| (Text::from(letters).line(), Text::from(meaning).line()));
    let about = "The independent route shares nothing with the derivation; where it is a residual, it shares the \
         algebra of functions. Certified numbers carry an enclosure: what is shown is right to one unit of its \
         last digit; estimated ones come from floating point or from differences, and their error is measured, \
         not proved.";
    let notation = "A formula is written as in the report's data: primes are derivatives, $xT$ is $x$ at $t - T$, \
         $dC$ a small change of $C$.";
    Document::default().words(about).lines(lines).words(Text::from(notation).line())
}
