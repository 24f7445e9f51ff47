//! Markdown with formulas between dollar signs.

use super::{Writer, harmless, steers};
use crate::Formula;

/// Markdown.
pub(super) struct Markdown;

/// Words as data: nothing of theirs is markup, neither of Markdown nor of HTML.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '#' | '|' | '$' | '~' => text.extend(['\\', c]),
            c if steers(c) && c != '\n' => text.push('\u{fffd}'),
            c => text.push(c),
        }
    }
    text
}

/// A fence longer than every run of backticks inside.
fn fence(code: &str) -> String {
    let longest = code.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    "`".repeat((longest + 1).max(3))
}

impl Writer for Markdown {
    fn words(&self, words: &str) -> String {
        escaped(words)
    }
    fn inline(&self, formula: &Formula) -> String {
        format!("${}$", formula.latex)
    }
    fn verbatim(&self, code: &str) -> String {
        let code = harmless(code);
        let fence = "`".repeat(fence(&code).len() - 2);
        format!("{fence}{code}{fence}")
    }
    fn strong(&self, words: &str, _class: &str) -> String {
        format!("**{}**", escaped(words))
    }
    fn link(&self, words: &str, to: &str) -> String {
        format!("[{}]({to})", escaped(words))
    }
    fn heading(&self, line: &str, level: usize) -> String {
        format!("{} {}\n", "#".repeat(level + 1), line.replace('\n', " "))
    }
    fn formula(&self, formula: &Formula) -> String {
        format!("$$ {} $$\n", formula.latex)
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let item = |(name, value): &(String, String)| {
            format!("- {name}: {}\n", value.replace('\n', "\n  "))
        };
        list.iter().map(item).collect()
    }
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String {
        let line = |row: &[String]| format!("| {} |\n", row.join(" | ").replace('\n', " "));
        let rule = format!("|{}\n", "---|".repeat(columns.len()));
        let body: String = rows.iter().map(|row| line(row)).collect();
        line(columns) + &rule + &body
    }
    fn paragraph(&self, line: &str) -> String {
        format!("{line}\n")
    }
    fn code(&self, code: &str) -> String {
        let fence = fence(code);
        format!("{fence}text\n{}\n{fence}\n", harmless(code).trim_end())
    }
    fn list(&self, items: &[String]) -> String {
        items.iter().map(|item| format!("- {}\n", item.replace('\n', "\n  "))).collect()
    }
    fn picture(&self, name: &str, caption: &str, _svg: &str) -> String {
        format!("![{caption}]({name}.svg)\n")
    }
}
