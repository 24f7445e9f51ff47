//! Plain text.

use super::Writer;
use crate::Formula;

/// Text for a terminal.
pub(super) struct Plain;

/// Without the characters that steer a terminal.
pub(super) fn harmless(words: &str) -> String {
    words.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// The width in characters.
fn width(text: &str) -> usize {
    text.chars().count()
}

fn padded(text: &str, to: usize) -> String {
    format!("{text}{}", " ".repeat(to.saturating_sub(width(text))))
}

/// Every line with two blanks before it.
fn indented(text: &str) -> String {
    let line = |line: &str| if line.is_empty() { "\n".to_owned() } else { format!("  {line}\n") };
    text.lines().map(line).collect()
}

impl Writer for Plain {
    fn words(&self, words: &str) -> String {
        harmless(words)
    }
    fn inline(&self, formula: &Formula) -> String {
        harmless(&formula.text)
    }
    fn verbatim(&self, code: &str) -> String {
        harmless(code)
    }
    fn heading(&self, line: &str, _level: usize) -> String {
        format!("{line}\n")
    }
    fn formula(&self, formula: &Formula) -> String {
        indented(&harmless(&formula.text))
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let widest = list.iter().map(|(name, _)| width(name)).max().unwrap_or(0) + 2;
        let hang = " ".repeat(widest + 2);
        let line = |(name, value): &(String, String)| {
            let value = value.replace('\n', &format!("\n{hang}"));
            format!("  {}{value}", padded(name, widest)).trim_end().to_owned() + "\n"
        };
        list.iter().map(line).collect()
    }
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String {
        let all = || std::iter::once(columns).chain(rows.iter().map(Vec::as_slice));
        let widest = |column: usize| {
            all().filter_map(|row| row.get(column)).map(|cell| width(cell)).max().unwrap_or(0) + 2
        };
        let widths: Vec<usize> = (0..columns.len()).map(widest).collect();
        let line = |row: &[String]| {
            let cells = row.iter().zip(&widths).map(|(cell, width)| padded(cell, *width));
            format!("  {}", cells.collect::<String>()).trim_end().to_owned() + "\n"
        };
        all().map(line).collect()
    }
    fn paragraph(&self, line: &str) -> String {
        format!("{line}\n")
    }
    fn code(&self, code: &str) -> String {
        indented(code)
    }
}
