//! Tables as comma-separated values.

use super::Format;
use crate::Table;
use std::borrow::Cow;

impl Table {
    /// Comma-separated values by RFC 4180 with one line of names: readable without options.
    ///
    /// ```
    /// use lindstedt_report::Table;
    /// let table = Table::new(["n", "W_n"]).row(["1", "3/4"]).row(["2", "-3/128, proved"]);
    /// assert_eq!(table.csv(), "n,W_n\n1,3/4\n2,\"-3/128, proved\"\n");
    /// ```
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::new();
        self.csv_lines(&mut |line| {
            text += line;
            true
        });
        text
    }

    /// The same line by line, as long as `take` says so; whether it took all.
    pub fn csv_lines(&self, take: &mut dyn FnMut(&str) -> bool) -> bool {
        std::iter::once(&self.columns).chain(&self.rows).all(|row| {
            let cells: Vec<String> = row.iter().map(|cell| Format::Text.line(cell)).collect();
            take(&line(&cells))
        })
    }
}

/// A line of fields.
pub(crate) fn line<C: AsRef<str>>(cells: &[C]) -> String {
    let mut text = String::new();
    for (place, cell) in cells.iter().enumerate() {
        if place > 0 {
            text.push(',');
        }
        text += &field(cell.as_ref());
    }
    text.push('\n');
    text
}

/// A field, in quotation marks where it needs them.
fn field(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}
