//! Tables.

use crate::Text;

/// A table with named columns.
///
/// ```
/// use lindstedt_report::Table;
/// let table = Table::new(["n", "W_n"]).row(["1", "3/4"]).row(["2", "-3/128"]);
/// assert_eq!((table.columns.len(), table.rows.len()), (2, 2));
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
}
