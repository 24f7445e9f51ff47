//! Rows and tables.

use super::super::is_plain_number;
use super::mathml::escape;
use super::prose::{line, number};
use crate::{Row, Section, Table, Text, Verdict};
use std::fmt::Write;

/// The name of a verdict as a class of the style sheet.
pub fn class(verdict: &str) -> String {
    verdict.replace(' ', "-")
}

/// Where a row stands on the page.
pub fn anchor(section: &Section, row: &Row) -> String {
    let mut name = String::new();
    for c in row.label.chars() {
        match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' => name.push(c),
            '\'' => name.push_str("prime"),
            '+' => name.push_str("plus"),
            _ if name.ends_with('-') => {}
            _ => name.push('-'),
        }
    }
    format!("s{}-{}", section.number, name.trim_matches('-'))
}

fn field(name: &str, value: &Text) -> String {
    if value.is_empty() {
        return String::new();
    }
    format!("<dt>{name}</dt><dd>{}</dd>\n", line(value))
}

/// One statement; the evidence is open where the statement does not hold.
pub fn row(section: &Section, row: &Row) -> String {
    let anchor = anchor(section, row);
    let verdict = row.verdict.name();
    let class = class(verdict);
    let mut text = format!(
        "<article class=\"row {class}\" id=\"{anchor}\">\n<h3><a href=\"#{anchor}\">{}</a> \
         <span class=\"verdict {class}\">{verdict}</span></h3>\n<dl>\n{}{}</dl>\n",
        line(&row.label),
        field("printed", &row.printed),
        field("derived", &row.derived),
    );
    let open = if row.verdict == Verdict::Agrees { "" } else { " open" };
    let inner = [field("independent", &row.independent), field("remark", &row.evidence)].concat();
    if !inner.is_empty() {
        let _ = write!(
            text,
            "<details{open}><summary>evidence</summary>\n<dl>\n{inner}</dl>\n</details>\n"
        );
    }
    text + "</article>\n"
}

/// A table with its notes.
pub fn table(section: &Section, table: &Table) -> String {
    let mut text = format!(
        "<figure class=\"data\" id=\"table-{}-{}\">\n<figcaption>{}. <a href=\"section{}-{}.csv\">CSV</a></figcaption>\n\
         <div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>",
        section.number,
        escape(&table.name),
        line(&table.title),
        section.number,
        escape(&table.name)
    );
    for head in &table.columns {
        let _ = write!(text, "<th scope=\"col\">{}</th>", line(head));
    }
    text += "</tr></thead>\n<tbody>\n";
    for cells in &table.rows {
        text += "<tr>";
        for cell in cells {
            let shown = if is_plain_number(cell) { number(cell) } else { line(cell) };
            let _ = write!(text, "<td>{shown}</td>");
        }
        text += "</tr>\n";
    }
    text += "</tbody>\n</table></div>\n<ul class=\"remarks\">\n";
    for note in &table.notes {
        let _ = writeln!(text, "<li>{}</li>", line(note));
    }
    text + "</ul>\n</figure>\n"
}
