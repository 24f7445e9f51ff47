//! What every answer looks like: a file per verb.

mod motion;
mod stability;
mod threshold;
mod verify;

use crate::{Document, Figure, Table, Text};
use lindstedt::{Answer, Number, Status};
use serde::Serialize;

/// An answer that can be shown.
pub trait Present {
    /// The page.
    fn document(&self) -> Document;
    /// The figure, where there is something to draw.
    fn figure(&self) -> Option<Figure> {
        None
    }
    /// The table behind the figure, for CSV.
    fn table(&self) -> Option<Table> {
        self.figure().map(|figure| figure.table())
    }
}

/// An answer as JSON: the keys of its header, of its value, and its remarks.
///
/// # Errors
/// Those of serde: never for the answers of this workspace, whose keys are strings.
pub fn json<T: Serialize>(answer: &Answer<T>) -> serde_json::Result<String> {
    Ok(format!("{:#}\n", serde_json::to_value(answer)?))
}

impl Text {
    /// A number: its decimal, and its error where that is more than a rounding.
    #[must_use]
    pub fn number(number: &Number) -> Self {
        Self::words(match (&number.error, number.status) {
            (Some(error), Status::Estimated) => {
                format!("{} +- {error} (estimated)", number.decimal)
            }
            (None, Status::NoEstimate) => format!("{} (no estimate)", number.decimal),
            _ => number.decimal.clone(),
        })
    }
}
