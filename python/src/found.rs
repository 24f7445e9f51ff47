//! An answer in every form that the program prints.

use lindstedt::Answer;
use lindstedt_report::{Document, Format, Present, json};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;

/// As JSON.
pub fn written<T: Serialize>(value: &T) -> PyResult<String> {
    json(value).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// What can be read off an answer.
pub trait Shown: Send + Sync {
    /// As JSON.
    fn json(&self) -> Result<String, String>;
    /// As a page.
    fn document(&self) -> Document;
    /// Its figure as SVG.
    fn svg(&self) -> Option<Result<String, String>>;
    /// The table behind the figure.
    fn csv(&self) -> Option<String>;
}

impl<T: Serialize + Send + Sync> Shown for Answer<T>
where
    Self: Present,
{
    fn json(&self) -> Result<String, String> {
        json(self).map_err(|error| error.to_string())
    }

    fn document(&self) -> Document {
        Present::document(self)
    }

    fn svg(&self) -> Option<Result<String, String>> {
        Some(self.figure()?.svg().map_err(|error| error.to_string()))
    }

    fn csv(&self) -> Option<String> {
        Some(self.table()?.csv())
    }
}

/// An answer.
#[pyclass(frozen, module = "lindstedt._native")]
pub struct Found(pub Box<dyn Shown>);

#[pymethods]
impl Found {
    /// As JSON.
    fn json(&self) -> PyResult<String> {
        self.0.json().map_err(PyValueError::new_err)
    }

    /// As `text`, `latex`, `markdown` or `html`.
    fn page(&self, format: &str) -> PyResult<String> {
        let format = match format {
            "text" => Format::Text,
            "latex" => Format::Latex,
            "markdown" => Format::Markdown,
            "html" => Format::Html,
            other => return Err(PyValueError::new_err(format!("there is no format {other:?}"))),
        };
        Ok(format.write(&self.0.document()))
    }

    /// The figure, where there is something to draw.
    fn svg(&self) -> PyResult<Option<String>> {
        self.0.svg().transpose().map_err(PyValueError::new_err)
    }

    /// The table behind it.
    fn csv(&self) -> Option<String> {
        self.0.csv()
    }
}
