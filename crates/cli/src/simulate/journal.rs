//! The file of a sweep: what was asked, then a line per finished value, each with its checksum, then, when all
//! are there, a line that says so.
//!
//! Lines are added with one write each, so whatever ends the program leaves whole lines but for the last.
//! What is not whole, or not what was written, is computed again, with the same numbers.

use crate::failure::Failure;
use crate::output::{open_to_append, trouble, write_file};
use crate::terminal::warn;
use lindstedt::motion::{Column, Journal};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// What the last line of a whole file begins with.
const WHOLE: &str = "# whole: ";

/// A file that a sweep is kept in.
pub struct Kept<'a> {
    path: &'a Path,
    file: Option<File>,
    /// What determines every number, and enters every checksum.
    identity: String,
    /// How many lines are there, and the checksum of their checksums.
    lines: (usize, u32),
    /// Whether the last line is there.
    ended: bool,
    /// Why the file cannot be used.
    pub failure: Option<Failure>,
}

/// What a file was found to hold.
struct Found {
    columns: Vec<Column>,
    /// The lines that are as they were written.
    good: String,
    /// The numbers of those that are not.
    damaged: Vec<usize>,
}

impl<'a> Kept<'a> {
    pub fn new(path: &'a Path) -> Self {
        let (identity, lines) = (String::new(), (0, 0));
        Self { path, file: None, identity, lines, ended: false, failure: None }
    }

    fn wrong(&self, error: &std::io::Error) -> Failure {
        trouble(&self.path.display().to_string(), error)
    }

    /// A line with its checksum.
    fn line(&mut self, text: &str) -> String {
        let sum = checksum(&self.identity, text);
        self.lines = (self.lines.0 + 1, checksum(&self.lines.1.to_string(), &sum.to_string()));
        format!("{sum:08x} {text}\n")
    }

    /// The last line.
    fn last(&self) -> String {
        format!("{WHOLE}{} values, {:08x}\n", self.lines.0, self.lines.1)
    }

    /// Reads the lines, and leaves those out that are not what was written.
    fn read(&mut self, text: &str, heading: usize) -> Found {
        let (mut columns, mut good, mut damaged) = (Vec::new(), String::new(), Vec::new());
        for (place, line) in text.split_inclusive('\n').enumerate().skip(heading) {
            let Some(whole) = line.strip_suffix('\n') else { break };
            let body = whole.split_once(' ').map_or("", |(_, body)| body);
            let before = self.lines;
            if line == self.last() {
                self.ended = true;
            } else if let Ok(column) = serde_json::from_str(body)
                && self.line(body) == line
            {
                columns.push(column);
                good += line;
            } else {
                self.lines = before;
                damaged.push(place + 1);
            }
        }
        Found { columns, good, damaged }
    }

    fn open(&mut self) -> Result<Vec<Column>, Failure> {
        // Held until the file that may take its place is.
        let there = self.path.exists().then(|| open_to_append(self.path)).transpose();
        let before = there.map_err(|error| self.wrong(&error))?;
        let text = match std::fs::read(self.path) {
            // What is no UTF-8 is no line of ours, either.
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            Err(error) => return Err(self.wrong(&error)),
        };
        let first = format!("# lindstedt bifurcation 5: {}\n", self.identity);
        if !text.is_empty() && !text.starts_with(&first) {
            let message = format!("{} belongs to another sweep", self.path.display());
            return Err(Failure::file(message, "give another file to --resume"));
        }
        let found = self.read(&text, 2);
        if !found.damaged.is_empty() {
            let shown: Vec<String> = found.damaged.iter().take(5).map(usize::to_string).collect();
            let more = if found.damaged.len() > 5 { ", ..." } else { "" };
            let (path, shown) = (self.path.display(), shown.join(", "));
            warn(&format!("{path} is damaged in line {shown}{more}: computed again"));
        }
        let command = text.lines().nth(1).filter(|line| line.starts_with(COMMAND));
        let command = command.map_or_else(command_line, str::to_owned);
        let last = if self.ended { self.last() } else { String::new() };
        let whole = format!("{first}{command}\n{}{last}", found.good);
        if whole != text {
            write_file(self.path, &whole)?;
            self.file = Some(open_to_append(self.path).map_err(|error| self.wrong(&error))?);
        } else {
            self.file = before;
        }
        Ok(found.columns)
    }

    /// Adds a line; whether that went well.
    fn add(&mut self, line: &str) -> bool {
        let Some(file) = &mut self.file else { return true };
        let written = file.write_all(line.as_bytes());
        self.failure = written.err().map(|error| self.wrong(&error));
        self.failure.is_none()
    }
}

impl Journal for Kept<'_> {
    fn begin(&mut self, identity: &str) -> Option<Vec<Column>> {
        identity.clone_into(&mut self.identity);
        self.open().map_err(|failure| self.failure = Some(failure)).ok()
    }

    fn keep(&mut self, column: &Column) -> bool {
        match serde_json::to_string(column) {
            Ok(text) => {
                let line = self.line(&text);
                self.add(&line)
            }
            Err(error) => {
                self.failure = Some(self.wrong(&error.into()));
                false
            }
        }
    }

    fn complete(&mut self) {
        if !std::mem::replace(&mut self.ended, true) {
            let last = self.last();
            self.add(&last);
        }
    }
}

/// The checksum of a text that stands under another one.
fn checksum(above: &str, text: &str) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(above.as_bytes());
    sum.update(text.as_bytes());
    sum.finalize()
}

/// What the line of the command begins with.
const COMMAND: &str = "# lindstedt ";

/// The command that this is, in one line as a shell takes it.
fn command_line() -> String {
    let quoted = |argument: std::ffi::OsString| {
        let text = argument.to_string_lossy().replace(['\n', '\r'], " ");
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
        if !text.is_empty() && text.chars().all(plain) {
            return text;
        }
        format!("'{}'", text.replace('\'', r"'\''"))
    };
    let arguments: Vec<String> = std::env::args_os().skip(1).map(quoted).collect();
    format!("{COMMAND}{}", arguments.join(" "))
}
