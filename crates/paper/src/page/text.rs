//! The report as text, at most 100 columns wide.

use super::{CLASSES, summary};
use crate::{Paper, Row, Table};
use std::fmt::Write;

const WIDTH: usize = 100;
const INDENT: usize = 15;

/// The report.
pub fn report(paper: &Paper) -> String {
    let mut text = trust(paper);
    for section in &paper.sections {
        let _ = writeln!(text, "Section {}: {}", section.number, section.title);
        let _ = writeln!(text, "{}\n{CLASSES}\n", summary(section));
        for row in &section.rows {
            text += &entry(row);
        }
        for table in &section.tables {
            text += &aligned(table);
        }
    }
    text
}

/// Where the methods can be trusted, above the sections.
fn trust(paper: &Paper) -> String {
    let findings = &paper.trust.findings;
    if findings.is_empty() {
        return String::new();
    }
    let mut text = String::from("Where the paper's methods can be trusted, and where not\n\n");
    for finding in findings {
        let _ = writeln!(text, "Section {}: {}", finding.section, finding.method);
        for (name, list) in [("trusted", &finding.trusted), ("not trusted", &finding.not_trusted)] {
            for (n, item) in list.iter().enumerate() {
                text += &wrapped(if n == 0 { name } else { "" }, item);
            }
        }
        text += &wrapped("class", &finding.class);
        text.push('\n');
    }
    text
}

fn entry(row: &Row) -> String {
    let verdict = row.verdict.name().to_uppercase();
    let gap = WIDTH.saturating_sub(row.label.len() + verdict.len()).max(1);
    let mut text = format!("{}{}{verdict}\n", row.label, " ".repeat(gap));
    for (name, value) in [
        ("printed", &row.printed),
        ("derived", &row.derived),
        ("independent", &row.independent),
        ("evidence", &row.evidence),
    ] {
        if !value.is_empty() {
            text += &wrapped(name, value);
        }
    }
    text.push('\n');
    text
}

/// A named paragraph with hanging indentation; a word longer than the line stands alone.
fn wrapped(name: &str, value: &str) -> String {
    let mut text = String::new();
    let mut line = format!("  {name:<width$}", width = INDENT - 2);
    let mut is_empty = true;
    for word in value.split_whitespace() {
        if !is_empty && line.len() + 1 + word.len() > WIDTH {
            let _ = writeln!(text, "{}", line.trim_end());
            line = " ".repeat(INDENT);
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(word);
        is_empty = false;
    }
    let _ = writeln!(text, "{}", line.trim_end());
    text
}

fn aligned(table: &Table) -> String {
    let mut text = format!("{}\n", table.title);
    for note in &table.notes {
        text += &wrapped("", note).replacen(&" ".repeat(INDENT), "  ", 1);
    }
    let width = |column: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(column));
        cells.chain(table.columns.get(column)).map(|cell| cell.len()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    for row in std::iter::once(&table.columns).chain(&table.rows) {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        let _ = writeln!(text, "  {}", cells.collect::<Vec<_>>().join("  "));
    }
    text.push('\n');
    text
}
