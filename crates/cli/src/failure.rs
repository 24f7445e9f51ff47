//! Failures: one clear line, a hint, and the exit code of the contract.

use crate::arguments::Format;
use crate::output::warn;
use lindstedt::algebra::PhaseError;
use lindstedt::expand::ExpandError;
use lindstedt::{Error, NumberError};
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
/// Interrupted.
pub const INTERRUPTED: u8 = 130;

/// Why a command failed.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: u8,
    /// A short name for programs.
    pub code: &'static str,
    /// One line for people.
    pub message: String,
    /// What to do about it.
    pub hint: String,
}

impl Failure {
    pub fn usage(code: &'static str, message: String, hint: &str) -> Self {
        Self { exit: USAGE, code, message, hint: hint.to_owned() }
    }

    /// Prints the failure; in JSON mode on standard output, where a program reads.
    pub fn report(&self, format: Format) -> ExitCode {
        if format == Format::Json {
            let error =
                json!({"error": {"code": self.code, "message": self.message, "hint": self.hint}});
            let _ = writeln!(std::io::stdout(), "{error}");
        } else if self.hint.is_empty() {
            warn(&self.message);
        } else {
            warn(&format!("{} ({})", self.message, self.hint));
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
        if let Error::Simulate(error) = error {
            return error.into();
        }
        let (exit, code, hint): (u8, &'static str, &str) = match &error {
            Error::BadValue { .. } => {
                (USAGE, "bad-value", "values are exact: 3, -1/3, 0.1, 2.5e-3, pi/4, 2*pi/3")
            }
            Error::Parse(_) | Error::File(_) => (USAGE, "problem-file", ""),
            Error::Irrational { .. } => (NO_ANSWER, "irrational", "set a rational value"),
            Error::UnknownParameter { .. } => {
                (USAGE, "unknown-parameter", "see `lindstedt problems --show NAME`")
            }
            Error::UnknownCondition { .. } => {
                (USAGE, "unknown-normalisation", "see `lindstedt problems --show NAME`")
            }
            Error::Unset { .. } => (USAGE, "no-value-set", "--set NAME=VALUE, for example 1/10"),
            Error::NotAmongSymbols { .. } => {
                (USAGE, "not-among-symbols", "set all parameters, or leave this one open")
            }
            Error::NoSuchRoute { .. } => (NO_ANSWER, "no-such-route", "use --route driver"),
            Error::OutsideDomain { .. } => (NO_ANSWER, "outside-domain", ""),
            Error::TooLarge { .. } => {
                (UNDECIDED, "too-large", "lower --order or raise --limit-memory")
            }
            Error::NotEnoughBits { .. } => (UNDECIDED, "not-enough-digits", "ask for fewer digits"),
            Error::NoSuchStart { .. } => {
                (NO_ANSWER, "no-start", "give amplitude and phase: --start")
            }
            Error::NoPeriodicOrbit { .. } => (NO_ANSWER, "no-periodic-orbit", "smaller --small"),
            Error::NoTruncatedFrequency { .. } => {
                (NO_ANSWER, "no-truncated-frequency", "smaller --small, or another --order")
            }
            Error::Resummation { .. } => {
                (NO_ANSWER, "no-such-resummation", "try --resum auto, or another order")
            }
            Error::NotEvaluated { .. } => (NO_ANSWER, "not-evaluated", ""),
            Error::MovingSingularity { .. } => (
                NO_ANSWER,
                "no-method",
                "`lindstedt simulate` takes it; here the equation would have to be odd in x, and \
                 the same backwards in time",
            ),
            Error::NoValue => (NO_ANSWER, "no-value", ""),
            Error::OutOfPrimes => (UNDECIDED, "out-of-primes", "lower --order"),
            Error::Expand(ExpandError::Interrupted { .. }) => (INTERRUPTED, "interrupted", ""),
            Error::Expand(ExpandError::Phase { source: PhaseError::Resonance { .. }, .. }) => {
                (NO_ANSWER, "resonance", "averaging needs a force off resonance")
            }
            Error::Expand(ExpandError::Phase { .. }) => {
                (UNDECIDED, "could-not-decide", "the orders below this one can be derived")
            }
            Error::Expand(_) => (NO_ANSWER, "no-expansion", ""),
            _ => (UNDECIDED, "undecided", ""),
        };
        Self { exit, code, message: error.to_string(), hint: hint.to_owned() }
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
    let wants_json = std::env::args().any(|a| a == "--format=json")
        || std::env::args()
            .zip(std::env::args().skip(1))
            .any(|(a, b)| a == "--format" && b == "json");
    let format = if wants_json { Format::Json } else { Format::Text };
    Failure::usage("usage", message, "see `lindstedt --help`").report(format)
}
