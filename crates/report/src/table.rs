//! Tables: printed in every format, and as CSV.

use crate::{Format, Text};

/// A table with named columns.
///
/// ```
/// use lindstedt_report::Table;
/// let table = Table::new(["n", "W_n"]).row(["1", "3/4"]).row(["2", "-3/128, proved"]);
/// assert_eq!(table.csv(), "n,W_n\n1,3/4\n2,\"-3/128, proved\"\n");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The names of the columns.
    pub columns: Vec<Text>,
    /// The rows; each has a cell per column.
    pub rows: Vec<Vec<Text>>,
}

impl Table {
    /// A table without rows.
    pub fn new<T: Into<Text>>(columns: impl IntoIterator<Item = T>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// The table with one more row.
    #[must_use]
    pub fn row<T: Into<Text>>(mut self, cells: impl IntoIterator<Item = T>) -> Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    /// Comma-separated values by RFC 4180 with one line of names: readable without options.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.columns).chain(&self.rows) {
            let cells: Vec<String> =
                row.iter().map(|cell| field(&Format::Text.line(cell))).collect();
            text += &cells.join(",");
            text.push('\n');
        }
        text
    }
}

/// A field, in quotation marks where it needs them.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
