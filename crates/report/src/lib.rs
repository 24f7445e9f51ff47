//! Answers as documents.
//!
//! A [`Document`] is made from an answer once ([`Present`]); text, LaTeX, Markdown and HTML are
//! readers of it ([`Format`]), JSON is what serde makes of the answer itself. A [`Figure`] is a list
//! of layers in one frame, a [`Table`] is printed in every format and as CSV. Nothing here computes
//! and nothing here opens a file.
//!
//! Words that come from outside (titles, names, notes of a problem file) are data: every reader
//! escapes them, and only a [`Formula`], which the engine prints, is markup.
#![warn(missing_docs, clippy::too_many_lines)]

mod document;
pub mod figure;
mod format;
mod mathml;
mod present;
mod table;
mod text;

/// What the tests of single rules reach: no part of the interface.
#[doc(hidden)]
pub mod rules {
    pub use crate::mathml::balanced;
    pub use crate::present::{angle, shade};
}

pub use document::{Block, Document, Part};
pub use figure::{Figure, FigureError};
pub use format::{Format, harmless, standalone};
pub use mathml::{MathError, mathml};
pub use present::{Pen, Present, json, json_line};
pub use table::Table;
pub use text::{Formula, Span, Text};
