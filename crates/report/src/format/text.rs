//! Plain text.

use super::Writer;
use crate::Formula;

/// Text for a terminal, in lines of at most so many characters where blanks allow it.
pub(super) struct Plain {
    pub width: usize,
}

/// Lines as long as they are.
pub(super) const UNLIMITED: Plain = Plain { width: usize::MAX };

impl Plain {
    /// A text after its first words, its further lines under it.
    fn hanging(&self, first: &str, text: &str) -> String {
        let hang = " ".repeat(width(first));
        let mut lines = vec![first.to_owned()];
        for (index, paragraph) in text.split('\n').enumerate() {
            if index > 0 {
                lines.push(hang.clone());
            }
            let mut used = width(&hang);
            for (index, word) in paragraph.split(' ').enumerate() {
                let wide = width(word);
                let full = index > 0 && used + 1 + wide > self.width;
                match lines.last_mut() {
                    Some(line) if !full => line.extend([if index > 0 { " " } else { "" }, word]),
                    _ => lines.push(format!("{hang}{word}")),
                }
                used = if full { width(&hang) } else { used + usize::from(index > 0) } + wide;
            }
        }
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }
}

/// Words without the characters that steer a terminal or turn the direction of reading; lines stay.
///
/// ```
/// assert_eq!(lindstedt_report::harmless("a\u{1b}[31m\nb"), "a\u{fffd}[31m\nb");
/// ```
#[must_use]
pub fn harmless(words: &str) -> String {
    // Long numbers are looked through by bytes, without a branch at each.
    if words.bytes().fold(true, |plain, b| plain & (b == b'\n' || (b' '..=b'~').contains(&b))) {
        return words.to_owned();
    }
    words.chars().map(|c| if steers(c) && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// Whether a character steers a terminal or the direction of reading.
pub(crate) fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
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
    fn strong(&self, words: &str, _class: &str) -> String {
        harmless(words)
    }
    fn link(&self, words: &str, _to: &str) -> String {
        harmless(words)
    }
    fn heading(&self, line: &str, _level: usize) -> String {
        format!("{line}\n")
    }
    fn formula(&self, formula: &Formula) -> String {
        // One that is not for text.
        if formula.text.is_empty() { String::new() } else { indented(&harmless(&formula.text)) }
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let widest = list.iter().map(|(name, _)| width(name)).max().unwrap_or(0) + 2;
        let line = |(name, value): &(String, String)| {
            self.hanging(&format!("  {}", padded(name, widest)), value)
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
        self.hanging("", line)
    }
    fn code(&self, code: &str) -> String {
        indented(code)
    }
    fn list(&self, items: &[String]) -> String {
        items.iter().map(|item| self.hanging("  - ", item)).collect()
    }
    fn picture(&self, _name: &str, _caption: &str, _svg: &str) -> String {
        String::new()
    }
}
