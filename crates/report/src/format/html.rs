//! The body of an HTML page.

use super::Writer;
use crate::{Formula, mathml};

/// HTML.
pub(super) struct Html;

/// Words as data.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '"' => text.push_str("&quot;"),
            c if c.is_control() && c != '\n' => text.push('\u{fffd}'),
            c => text.push(c),
        }
    }
    text
}

/// A formula as MathML; one that is not understood stands as it was printed, never half drawn.
fn drawn(formula: &Formula, display: bool) -> String {
    mathml(&formula.latex, display)
        .unwrap_or_else(|_| format!("<code>{}</code>", escaped(&formula.text)))
}

fn cells(row: &[String], tag: &str) -> String {
    row.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect()
}

impl Writer for Html {
    fn words(&self, words: &str) -> String {
        escaped(words)
    }
    fn inline(&self, formula: &Formula) -> String {
        drawn(formula, false)
    }
    fn verbatim(&self, code: &str) -> String {
        format!("<code>{}</code>", escaped(code))
    }
    fn heading(&self, line: &str, level: usize) -> String {
        format!("<h{level}>{line}</h{level}>\n")
    }
    fn formula(&self, formula: &Formula) -> String {
        format!("<div class=\"formula\">{}</div>\n", drawn(formula, true))
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let item = |(name, value): &(String, String)| format!("<dt>{name}</dt><dd>{value}</dd>\n");
        format!("<dl>\n{}</dl>\n", list.iter().map(item).collect::<String>())
    }
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String {
        let body: String =
            rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(row, "td"))).collect();
        let head = cells(columns, "th");
        format!("<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>\n")
    }
    fn paragraph(&self, line: &str) -> String {
        format!("<p>{line}</p>\n")
    }
    fn code(&self, code: &str) -> String {
        format!("<pre>{}</pre>\n", escaped(code))
    }
}
