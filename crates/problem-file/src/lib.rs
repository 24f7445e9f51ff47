//! Problem files: an oscillator from its equation, written as on paper.
//!
//! [`parse_equation`] reads `x'' + x + eps*x^3 = 0` into the tree that the engine works with;
//! [`ProblemFile::parse`] reads a TOML file with the equation and everything that is to be said
//! about it; [`write`](write()) writes such a file. Text in, trees out: no file is opened here.

#![warn(clippy::too_many_lines)]

mod declared;
mod error;
mod file;
mod file_error;
mod grammar;
mod history;
mod lexer;
mod meaning;
mod names;
mod operands;
mod reader;
mod reading;
mod schema;
mod taylor;
mod text;
mod trees;
mod write;

pub use error::{Expectation, Limit, ParseError, ParseErrorKind, position};
pub use file::{AMPLITUDES, LARGEST_FILE, ProblemFile};
pub use file_error::{FileError, FileErrorKind, RoleReason};
pub use grammar::{locate, parse_equation, parse_expression};
pub use history::History;
pub use names::{Names, PI, canonical_name, is_parameter_name};
pub use write::write;
