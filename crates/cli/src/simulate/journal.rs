//! The file of a sweep: what was asked, then a line of JSON per finished value.
//!
//! Columns are written in order, each with one write, so whatever ends the program leaves whole lines
//! but for the last; what is not whole is computed again, with the same numbers.

use crate::failure::{FILE, Failure};
use crate::output::trouble;
use lindstedt::motion::{Column, Journal};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::path::Path;

/// A file that a sweep is kept in.
pub struct Kept<'a> {
    path: &'a Path,
    file: Option<File>,
    /// Why the file cannot be used.
    pub failure: Option<Failure>,
}

impl<'a> Kept<'a> {
    pub fn new(path: &'a Path) -> Self {
        Self { path, file: None, failure: None }
    }

    fn wrong(&self, error: &std::io::Error) -> Failure {
        trouble(&self.path.display().to_string(), error)
    }

    /// Reads the whole lines, cuts off the rest.
    fn open(&mut self, heading: &str) -> Result<Vec<Column>, Failure> {
        let text = match std::fs::read_to_string(self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            Err(error) => return Err(self.wrong(&error)),
        };
        // A heading that is cut short is one that the program did not finish writing.
        if !text.starts_with(heading) && !heading.starts_with(&text) {
            return Err(Failure {
                exit: FILE,
                code: "file",
                message: format!("{} belongs to another sweep", self.path.display()),
                hint: "give another file to --resume".into(),
            });
        }
        let (mut columns, mut length) = (Vec::new(), heading.len());
        for line in text.strip_prefix(heading).unwrap_or("").split_inclusive('\n') {
            let whole = line.ends_with('\n').then(|| serde_json::from_str(line).ok()).flatten();
            let Some(column) = whole else { break };
            columns.push(column);
            length += line.len();
        }
        let opened = || -> std::io::Result<File> {
            let options =
                OpenOptions::new().write(true).create(true).truncate(false).open(self.path);
            let mut file = options?;
            if !text.starts_with(heading) {
                file.write_all(heading.as_bytes())?;
            }
            file.set_len(length as u64)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        self.file = Some(opened().map_err(|error| self.wrong(&error))?);
        Ok(columns)
    }
}

impl Journal for Kept<'_> {
    fn begin(&mut self, identity: &str) -> Option<Vec<Column>> {
        let opened = self.open(&format!("# lindstedt bifurcation 4: {identity}\n"));
        opened.map_err(|failure| self.failure = Some(failure)).ok()
    }

    fn keep(&mut self, column: &Column) -> bool {
        let Some(file) = &mut self.file else { return true };
        let line = serde_json::to_string(column).map_err(std::io::Error::from);
        let written = line.and_then(|line| file.write_all((line + "\n").as_bytes()));
        self.failure = written.err().map(|error| self.wrong(&error));
        self.failure.is_none()
    }
}
