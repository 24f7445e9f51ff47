//! Tables as comma-separated values.

use super::Format;
use crate::Table;

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
