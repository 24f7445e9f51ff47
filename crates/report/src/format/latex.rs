//! LaTeX for a document with `amsmath`.

use super::{Writer, harmless, steers};
use crate::Formula;

/// LaTeX.
pub(super) struct Latex;

/// Words as data: no character of theirs is a command.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => text.extend(['\\', c]),
            '\\' => text.push_str(r"\textbackslash{}"),
            // In the usual font these are other signs.
            '|' => text.push_str(r"\textbar{}"),
            '<' => text.push_str(r"\textless{}"),
            '>' => text.push_str(r"\textgreater{}"),
            '~' => text.push_str(r"\textasciitilde{}"),
            '^' => text.push_str(r"\textasciicircum{}"),
            c if steers(c) && c != '\n' => text.push('?'),
            c => text.push(c),
        }
    }
    text
}

impl Writer for Latex {
    fn words(&self, words: &str) -> String {
        escaped(words).replace(" +- ", r" $\pm$ ")
    }
    fn inline(&self, formula: &Formula) -> String {
        format!("${}$", formula.latex)
    }
    fn verbatim(&self, code: &str) -> String {
        format!("\\texttt{{{}}}", escaped(code))
    }
    fn strong(&self, words: &str, _class: &str) -> String {
        format!("\\textbf{{{}}}", escaped(words))
    }
    fn link(&self, words: &str, _to: &str) -> String {
        escaped(words)
    }
    fn heading(&self, line: &str, level: usize) -> String {
        let command = match level {
            1 => "section",
            2 => "paragraph",
            _ => "subparagraph",
        };
        format!("\\{command}*{{{line}}}\n")
    }
    fn formula(&self, formula: &Formula) -> String {
        format!("\\[ {} \\]\n", formula.latex)
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let item = |(name, value): &(String, String)| format!("\\item[{{{name}}}] {value}\n");
        let items: String = list.iter().map(item).collect();
        format!("\\begin{{description}}\n{items}\\end{{description}}\n")
    }
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String {
        let head = columns.join(" & ");
        let body: String = rows.iter().map(|row| format!("{} \\\\\n", row.join(" & "))).collect();
        let shape = "l".repeat(columns.len().max(1));
        format!("\\begin{{tabular}}{{{shape}}}\n{head} \\\\ \\hline\n{body}\\end{{tabular}}\n")
    }
    fn paragraph(&self, line: &str) -> String {
        format!("{line}\n")
    }
    fn code(&self, code: &str) -> String {
        // The only text that ends a verbatim environment.
        let code = harmless(code).replace("\\end{verbatim}", "\\end {verbatim}");
        format!("\\begin{{verbatim}}\n{}\n\\end{{verbatim}}\n", code.trim_end())
    }
    fn list(&self, items: &[String]) -> String {
        let items: String = items.iter().map(|item| format!("\\item {item}\n")).collect();
        format!("\\begin{{itemize}}\n{items}\\end{{itemize}}\n")
    }
    fn picture(&self, _name: &str, _caption: &str, _svg: &str) -> String {
        String::new()
    }
}
