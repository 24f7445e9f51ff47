//! Failures: one clear line, a hint, and the exit code of the contract.

use crate::arguments::Format;
use crate::terminal::warn;
use lindstedt::unstable::simulate::SimulateError;
use lindstedt::{Error, Kind, NumberError, Refusal, Refused};
use lindstedt_report::json_line;
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

/// Usage: the arguments do not make sense.
pub const USAGE: u8 = 2;
/// The problem has no such answer.
pub const NO_ANSWER: u8 = 3;
/// Could not decide or reach the digits within the limits.
pub const UNDECIDED: u8 = 4;
/// File trouble.
pub const FILE: u8 = 5;
/// Stopped: what did it has the last word ([`crate::session::Session::failed`]).
pub const STOPPED: u8 = 130;

/// Why a command failed: a refusal, and what the program ends with.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: u8,
    /// The reason.
    pub refused: Refused,
}

impl Failure {
    pub fn usage(code: &'static str, message: String, hint: &str) -> Self {
        Refused::usage(code, message, hint).into()
    }

    /// File trouble.
    pub fn file(message: String, hint: &str) -> Self {
        Self { exit: FILE, refused: Refused::usage("file", message, hint) }
    }

    /// There is nothing to draw.
    pub fn figure(message: impl ToString) -> Self {
        Refused::no_answer("figure", message.to_string(), "").into()
    }

    /// A refusal of the library.
    pub fn of(refusal: &dyn Refusal) -> Self {
        let mut refused = Refused::usage(refusal.code(), refusal.to_string(), refusal.hint());
        refused.kind = refusal.kind();
        refused.into()
    }

    /// Prints the failure; in JSON mode on standard output, where a program reads.
    pub fn report(&self, format: Format) -> ExitCode {
        let Refused { code, message, .. } = &self.refused;
        let hint = self.refused.hint();
        if format == Format::Json {
            let error = json!({"error": {"code": code, "message": message, "hint": hint}});
            let _ = write!(std::io::stdout(), "{}", json_line(&error).unwrap_or_default());
        } else {
            warn(&format!("{message} ({hint})"));
        }
        ExitCode::from(self.exit)
    }
}

impl From<NumberError> for Failure {
    fn from(error: NumberError) -> Self {
        Error::from(error).into()
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::of(&error)
    }
}

impl From<SimulateError> for Failure {
    fn from(error: SimulateError) -> Self {
        Self::of(&error)
    }
}

impl From<Refused> for Failure {
    fn from(refused: Refused) -> Self {
        let exit = match refused.kind {
            Kind::Usage => USAGE,
            Kind::NoAnswer => NO_ANSWER,
            Kind::Undecided => UNDECIDED,
            Kind::Stopped => STOPPED,
        };
        Self { exit, refused }
    }
}

/// A command line that clap rejects: help and version are no errors; everything else is one
/// line (clap's first) with exit code 2, in JSON if the arguments ask for it.
pub fn usage(error: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind;
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    ) {
        let _ = error.print();
        let code = if error.use_stderr() { USAGE } else { 0 };
        return ExitCode::from(code);
    }
    let text = error.to_string();
    let first: Vec<&str> = text.lines().take_while(|line| !line.trim().is_empty()).collect();
    let message = first.join(" ").trim_start_matches("error: ").to_owned();
    let given: Vec<String> =
        std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect();
    let wants_json = given.iter().any(|argument| argument == "--format=json")
        || given.windows(2).any(|pair| pair[0] == "--format" && pair[1] == "json");
    let format = if wants_json { Format::Json } else { Format::Text };
    // What looks like options and has a prime is an equation.
    let equation = given.iter().any(|word| word.starts_with('-') && word.contains("''"));
    let hint = match equation {
        true => {
            "an equation that begins with - stands behind --: lindstedt derive -- \"-x'' - x = eps*x^3\""
        }
        false => "see `lindstedt --help`",
    };
    Failure::usage("usage", message, hint).report(format)
}
