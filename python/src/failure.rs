//! Refusals as exceptions of the package.

use lindstedt::{Error, Refusal, Refused};
use pyo3::prelude::*;

/// The exception for a refusal: its kind chooses the class, code and hint are attributes.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let (kind, code) = (error.kind().to_string(), error.code());
    let made = py
        .import("lindstedt._errors")
        .and_then(|module| module.getattr("refusal"))
        .and_then(|class| class.call1((kind, code, error.to_string(), error.hint())));
    made.map_or_else(|failure| failure, PyErr::from_value)
}

/// An option that does not fit.
pub fn usage(message: impl Into<String>, hint: &str) -> Error {
    Refused::usage("usage", message, hint).into()
}
