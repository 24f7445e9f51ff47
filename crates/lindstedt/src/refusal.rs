//! Why there is no answer, for people and for programs.

mod engines;

pub(crate) use engines::averages;
use std::fmt;

/// What kind of refusal it is; one exit code each on the command line.
///
/// ```
/// use lindstedt::{Kind, Oscillator, Refusal};
/// let refused = Oscillator::parse("x'' + x + eps*y = 0").err().map(|error| error.kind());
/// assert_eq!(refused, Some(Kind::Usage));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The question makes no sense as it is put.
    Usage,
    /// There is no such value, with the reason.
    NoAnswer,
    /// It could not be decided, or not with the digits, the memory or the time given.
    Undecided,
    /// The work was stopped before anything was finished.
    Stopped,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Usage => "usage",
            Self::NoAnswer => "no answer",
            Self::Undecided => "undecided",
            Self::Stopped => "interrupted",
        })
    }
}

/// An error with a name for programs, its kind, and what to do about it. Its words are those of its
/// `Display`.
///
/// ```
/// use lindstedt::{Oscillator, Refusal};
/// let error = Oscillator::builtin("pendulun").err();
/// assert_eq!(error.as_ref().map(Refusal::code), Some("unknown-problem"));
/// assert!(error.is_some_and(|error| error.hint().contains("pendulum")));
/// ```
pub trait Refusal: fmt::Display {
    /// Kind, code and hint, side by side.
    fn parts(&self) -> (Kind, &'static str, String);
    /// A short name for programs; it does not change.
    fn code(&self) -> &'static str {
        self.parts().1
    }
    /// Which kind.
    fn kind(&self) -> Kind {
        self.parts().0
    }
    /// What to do about it.
    fn hint(&self) -> String {
        let (kind, code, hint) = self.parts();
        if hint.is_empty() { general_hint(kind, code).to_owned() } else { hint }
    }
}

/// About what is multiplied out to more terms than a fixed number.
pub(crate) const SHORTER: &str =
    "lower --order, --set more parameters, or write the equation shorter";

/// What to do about a refusal of which no more is known than its kind and its code.
///
/// ```
/// use lindstedt::{Kind, general_hint};
/// assert!(general_hint(Kind::Undecided, "no such code").contains("--digits"));
/// ```
#[must_use]
pub fn general_hint(kind: Kind, code: &str) -> &'static str {
    match (code, kind) {
        ("set", _) => "every name once, as in --set eps=1/10 --set amplitude=2",
        ("range" | "sweep" | "times", _) => {
            "NAME=LO..HI:COUNT, as in omega=0..1:11; at most two sweeps, of different parameters"
        }
        ("parameter" | "outside-domain", _) => {
            "`lindstedt problems` lists the parameters and what they mean"
        }
        ("no-expansion" | "no-method", _) => {
            "`lindstedt simulate` takes it; `lindstedt problems --show FILE` lists the methods of a file"
        }
        ("not-evaluated", _) => {
            "`lindstedt derive` expands it; `lindstedt threshold`, `stability`, `simulate` give its numbers"
        }
        ("no-orbit", _) => "`lindstedt simulate` shows what the motion does there",
        ("no-answer", _) => "other values of the parameters; --sweep shows where there is one",
        ("no-value", _) => "another value of the parameters, or `lindstedt simulate`",
        ("not-diagonalisable", _) => "frequencies that differ a little have modes",
        ("too-large", _) => "lower --order, set more parameters, or raise --limit-memory",
        ("problem-file", _) => "`lindstedt problems --show duffing` prints a file to begin with",
        ("file", _) => "look at the path, what is free on the disk, and the permissions",
        ("figure", _) => "another --figure, a longer motion, or --plot NAME.csv",
        (_, Kind::Usage) => "`lindstedt VERB --help` lists the options",
        (_, Kind::NoAnswer) => "other values of the parameters, or `lindstedt simulate`",
        (_, Kind::Undecided) => "more --digits, or values a little beside these",
        (_, Kind::Stopped) => "raise --limit-seconds, or ask for less: --order, --digits",
    }
}

/// A refusal that was put together where several reasons meet: the terms of an equation, the place
/// of the term in its file, the options of a question.
///
/// ```
/// use lindstedt::{Error, Refusal, Refused};
/// let refused = Refused::usage("set", "pi is a number: it has no other value", "leave it out");
/// assert_eq!(Error::from(refused).code(), "set");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Refused {
    /// The name for programs.
    pub code: &'static str,
    /// The kind.
    pub kind: Kind,
    /// One line for people.
    pub message: String,
    /// What to do about it; [`general_hint`] stands for an empty one.
    pub hint: String,
}

impl Refused {
    fn new(kind: Kind, code: &'static str, message: String, hint: String) -> Self {
        Self { code, kind, message, hint }
    }

    /// A question that makes no sense as it is put.
    pub fn usage(code: &'static str, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::new(Kind::Usage, code, message.into(), hint.into())
    }

    /// No such value.
    pub fn no_answer(
        code: &'static str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::new(Kind::NoAnswer, code, message.into(), hint.into())
    }

    /// Not decided.
    pub fn undecided(
        code: &'static str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::new(Kind::Undecided, code, message.into(), hint.into())
    }

    /// Stopped before anything was finished.
    pub fn stopped(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::new(Kind::Stopped, "interrupted", message.into(), hint.into())
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Refusal for Refused {
    fn parts(&self) -> (Kind, &'static str, String) {
        (self.kind, self.code, self.hint.clone())
    }
}

impl std::error::Error for Refused {}
