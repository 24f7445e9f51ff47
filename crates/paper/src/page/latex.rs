//! The report as LaTeX, to be included in a document.

use super::{CLASSES, summary};
use crate::Paper;
use std::fmt::Write;

/// The report.
pub fn report(paper: &Paper) -> String {
    let mut text = trust(paper);
    for section in &paper.sections {
        let _ = writeln!(text, "\\section*{{Section {}: {}}}", section.number, section.title);
        let _ =
            writeln!(text, "{}. {CLASSES}\n\n\\begin{{description}}", escape(&summary(section)));
        for row in &section.rows {
            let _ = writeln!(
                text,
                "\\item[{}] \\textbf{{{}}}. Printed: \\texttt{{{}}}. Derived: \\texttt{{{}}}. \
                 Independent: {}. {}",
                escape(&row.label),
                row.verdict.name(),
                escape(&row.printed),
                escape(&row.derived),
                escape(&row.independent),
                escape(&row.evidence),
            );
        }
        text += "\\end{description}\n";
        for table in &section.tables {
            let _ = writeln!(text, "\n\\paragraph*{{{}}}", escape(&table.title));
            for note in &table.notes {
                let _ = writeln!(text, "{}.\\\\", escape(note));
            }
            let _ = writeln!(text, "\\begin{{tabular}}{{{}}}", "r".repeat(table.columns.len()));
            for row in std::iter::once(&table.columns).chain(&table.rows) {
                let cells: Vec<String> = row.iter().map(|c| escape(c)).collect();
                let _ = writeln!(text, "{} \\\\", cells.join(" & "));
            }
            text += "\\end{tabular}\n";
        }
    }
    text
}

/// Where the methods can be trusted, above the sections.
fn trust(paper: &Paper) -> String {
    let mut text = String::new();
    for finding in &paper.trust.findings {
        if text.is_empty() {
            text += "\\section*{Where the paper's methods can be trusted, and where not}\n";
        }
        let head = format!("Section {}: {}", finding.section, finding.method);
        let _ = writeln!(text, "\\paragraph*{{{}}}", escape(&head));
        for (name, list) in
            [("To be trusted", &finding.trusted), ("Not to be trusted", &finding.not_trusted)]
        {
            let items: Vec<String> = list.iter().map(|item| escape(item)).collect();
            let _ = writeln!(text, "{name}: {}.\\\\", items.join("; "));
        }
        let _ = writeln!(text, "{}.", escape(&finding.class));
    }
    text
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '%' | '&' | '#' | '_' | '{' | '}' | '$' => {
                escaped.push('\\');
                escaped.push(c);
            }
            '^' => escaped += "\\^{}",
            '~' => escaped += "\\~{}",
            '\\' => escaped += "\\textbackslash{}",
            '<' | '>' | '|' => {
                let _ = write!(escaped, "${c}$");
            }
            _ => escaped.push(c),
        }
    }
    escaped
}
