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
    /// What to do about it; empty where nothing helps.
    fn hint(&self) -> String {
        self.parts().2
    }
}

/// A refusal that was put together where several reasons meet: the terms of an equation, the place
/// of the term in its file, the options of a question.
///
/// ```
/// use lindstedt::{Error, Refusal, Refused};
/// let refused = Refused::usage("set", "pi is a number: it has no other value", "");
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
    /// What to do about it.
    pub hint: String,
}

impl Refused {
    /// A question that makes no sense as it is put.
    pub fn usage(code: &'static str, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { code, kind: Kind::Usage, message: message.into(), hint: hint.into() }
    }

    /// No such value.
    pub fn no_answer(
        code: &'static str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { code, kind: Kind::NoAnswer, message: message.into(), hint: hint.into() }
    }

    /// Not decided.
    pub fn undecided(
        code: &'static str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { code, kind: Kind::Undecided, message: message.into(), hint: hint.into() }
    }

    /// Stopped before anything was finished.
    pub fn stopped(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self {
            code: "interrupted",
            kind: Kind::Stopped,
            message: message.into(),
            hint: hint.into(),
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Refused {}
