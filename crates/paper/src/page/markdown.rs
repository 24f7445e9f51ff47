//! The report as Markdown.

use super::Figure;
use super::{CLASSES, SYMBOLS, summary};
use crate::{Paper, Text, Verdict};
use std::fmt::Write;

/// The report.
pub fn report(paper: &Paper, figures: &[Figure]) -> String {
    let mut text = format!(
        "Statements of J. Awrejcewicz and I. V. Andrianov, *Asymptotic approaches to analysis of strongly \
         non-linear and non-smooth systems*, re-read by machine (lindstedt {}).\n\n",
        env!("CARGO_PKG_VERSION")
    );
    for verdict in Verdict::ALL {
        let _ = writeln!(text, "- **{}**: {}", verdict.name(), cell(verdict.rule()));
    }
    text.push('\n');
    text += &trust(paper, figures);
    for section in &paper.sections {
        let _ = writeln!(text, "# Section {}: {}\n", section.number, section.title);
        let _ = writeln!(text, "{}. {CLASSES}\n", summary(section));
        text += "| | printed | derived | independent | verdict | evidence |\n";
        text += "|---|---|---|---|---|---|\n";
        for row in &section.rows {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | **{}** | {} |",
                cell(&row.label),
                code(&row.printed),
                code(&row.derived),
                cell(&row.independent),
                row.verdict.name(),
                cell(&row.evidence),
            );
        }
        for table in &section.tables {
            let _ = writeln!(text, "\n## {}\n", cell(&table.title));
            for note in &table.notes {
                let _ = writeln!(text, "- {}", cell(note));
            }
            let _ = writeln!(text, "\n| {} |", table.columns.join(" | "));
            let _ = writeln!(text, "|{}", "---:|".repeat(table.columns.len()));
            for row in &table.rows {
                let _ = writeln!(text, "| {} |", row.join(" | "));
            }
        }
    }
    text += "# Notes\n\n";
    for (letters, meaning) in SYMBOLS {
        let (letters, meaning) = (Text::from(letters), Text::from(meaning));
        let _ = writeln!(text, "- `{letters}`: {}", cell(&meaning));
    }
    text
}

/// Where the methods can be trusted, above the sections.
fn trust(paper: &Paper, figures: &[Figure]) -> String {
    let findings = &paper.trust.findings;
    if findings.is_empty() {
        return String::new();
    }
    let mut text = String::from("# Where the paper's methods can be trusted, and where not\n\n");
    for finding in findings {
        let _ = writeln!(text, "## Section {}: {}\n", finding.section, cell(&finding.method));
        for (name, list) in
            [("To be trusted", &finding.trusted), ("Not to be trusted", &finding.not_trusted)]
        {
            let _ = writeln!(text, "{name}:\n");
            for item in list {
                let _ = writeln!(text, "- {}", cell(item));
            }
            text.push('\n');
        }
        for figure in figures.iter().filter(|figure| figure.section == finding.section) {
            let _ = writeln!(text, "![{}]({}.svg)\n", cell(&figure.caption), figure.name);
        }
        let _ = writeln!(text, "{}.\n", cell(&finding.class));
    }
    text
}

fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}

/// Plain text: what Markdown would read as emphasis, a link, a column or HTML is escaped.
fn cell(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, '|' | '*' | '_' | '<' | '[' | ']' | '`' | '\\') {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}
