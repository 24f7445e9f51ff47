//! Why there is no answer, for people and for programs.

use crate::Error;
use lindstedt_algebra::PhaseError;
use lindstedt_expand::ExpandError;
use lindstedt_impact::ImpactError;
use lindstedt_melnikov::MelnikovError;
use lindstedt_simulate::SimulateError;
use std::fmt;

/// What kind of refusal it is; one exit code each on the command line.
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

/// An error with a name for programs, its kind, and what to do about it. Its words are those of its
/// `Display`.
pub trait Refusal: fmt::Display {
    /// A short name for programs; it does not change.
    fn code(&self) -> &'static str;
    /// Which kind.
    fn kind(&self) -> Kind;
    /// What to do about it; empty where nothing helps.
    fn hint(&self) -> String;
}

/// A refusal that was put together where several reasons meet: the terms of an equation, the place
/// of the term in its file, the options of a question.
#[derive(Clone, Debug, PartialEq, Eq)]
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

impl Refusal for Error {
    fn code(&self) -> &'static str {
        self.parts().1
    }
    fn kind(&self) -> Kind {
        self.parts().0
    }
    fn hint(&self) -> String {
        self.parts().2
    }
}

impl Error {
    /// Kind, code and hint, side by side.
    fn parts(&self) -> (Kind, &'static str, String) {
        use Kind::{NoAnswer, Stopped, Undecided, Usage};
        let (kind, code, hint) = match self {
            Self::Refused(it) => return (it.kind, it.code, it.hint.clone()),
            Self::Simulate(error) => return (error.kind(), error.code(), error.hint()),
            Self::Melnikov(error) => return (error.kind(), error.code(), error.hint()),
            Self::Impact(error) => return (error.kind(), error.code(), error.hint()),
            Self::File(error) if error.is_limit() => {
                return (Undecided, "problem-file", error.hint());
            }
            Self::File(error) => return (Usage, "problem-file", error.hint()),
            Self::BadValue { .. } => {
                (Usage, "bad-value", "values are exact: 3, -1/3, 0.1, 2.5e-3, pi/4, 2*pi/3")
            }
            Self::Parse(_) => (Usage, "problem-file", ""),
            Self::Irrational { .. } => (NoAnswer, "irrational", "set a rational value"),
            Self::UnknownParameter { .. } => {
                (Usage, "unknown-parameter", "see `lindstedt problems --show NAME`")
            }
            Self::UnknownCondition { .. } => {
                (Usage, "unknown-normalisation", "see `lindstedt problems --show NAME`")
            }
            Self::Unset { .. } => (Usage, "no-value-set", "--set NAME=VALUE, for example 1/10"),
            Self::NotAmongSymbols { .. } => {
                (Usage, "not-among-symbols", "set all parameters, or leave this one open")
            }
            Self::NoSuchRoute { .. } => (NoAnswer, "no-such-route", "use --route driver"),
            Self::OutsideDomain { .. } => (NoAnswer, "outside-domain", ""),
            Self::TooLarge { .. } => {
                (Undecided, "too-large", "lower --order or raise --limit-memory")
            }
            Self::NotEnoughBits { .. } => (Undecided, "not-enough-digits", "ask for fewer digits"),
            Self::NoSuchStart { .. } => (NoAnswer, "no-start", "give amplitude and phase: --start"),
            Self::NoPeriodicOrbit { .. } => (NoAnswer, "no-periodic-orbit", "smaller --small"),
            Self::NoTruncatedFrequency { .. } => {
                (NoAnswer, "no-truncated-frequency", "smaller --small, or another --order")
            }
            Self::Resummation { .. } => {
                (NoAnswer, "no-such-resummation", "try --resum auto, or another order")
            }
            Self::NotEvaluated { .. } => (NoAnswer, "not-evaluated", ""),
            Self::MovingSingularity { .. } => (
                NoAnswer,
                "no-method",
                "`lindstedt simulate` takes it; here the equation would have to be odd in x, and \
                 the same backwards in time",
            ),
            Self::NoValue => (NoAnswer, "no-value", ""),
            Self::OutOfPrimes => (Undecided, "out-of-primes", "lower --order"),
            Self::Expand(ExpandError::Interrupted { .. }) => (Stopped, "interrupted", ""),
            Self::Expand(ExpandError::Phase { source: PhaseError::Resonance { .. }, .. }) => {
                (NoAnswer, "resonance", "averaging needs a force off resonance")
            }
            Self::Expand(ExpandError::Phase { .. }) => {
                (Undecided, "could-not-decide", "the orders below this one can be derived")
            }
            Self::Expand(error) if averages(error) => {
                (NoAnswer, "no-expansion", "averaging takes it: --normalisation free")
            }
            Self::Expand(_) => (NoAnswer, "no-expansion", ""),
            _ => (Undecided, "undecided", ""),
        };
        (kind, code, hint.to_owned())
    }
}

/// Whether averaging takes what no constant amplitude, or none that is known exactly, satisfies.
pub(crate) fn averages(error: &ExpandError) -> bool {
    matches!(
        error,
        ExpandError::AmplitudeDrifts { .. }
            | ExpandError::NoLimitCycle
            | ExpandError::AmplitudeOfHigherOrder
            | ExpandError::IrrationalAmplitude
            | ExpandError::SeveralLimitCycles { .. }
            | ExpandError::DegenerateLimitCycle
    )
}

impl Refusal for SimulateError {
    fn code(&self) -> &'static str {
        match self {
            Self::BranchPoint { .. } | Self::Grazing { .. } | Self::StepTooSmall { .. } => {
                "could-not-decide"
            }
            Self::DenseBranchPoint { .. } => "too-large",
            Self::MissingParameter { .. } | Self::BadRestitution { .. } => "outside-domain",
            _ => "no-trajectory",
        }
    }
    fn kind(&self) -> Kind {
        match self.code() {
            "could-not-decide" | "too-large" => Kind::Undecided,
            _ => Kind::NoAnswer,
        }
    }
    fn hint(&self) -> String {
        let hint = match self {
            Self::BranchPoint { .. } => {
                "more --digits; not at all where w reaches zero without speed, or for p near -1"
            }
            Self::DenseBranchPoint { .. } => "fewer --digits, or a power farther from -1",
            Self::Grazing { .. } | Self::StepTooSmall { .. } => {
                "more --digits, or a start beside the degenerate one"
            }
            Self::MissingParameter { .. } | Self::BadRestitution { .. } => {
                "see `lindstedt problems`"
            }
            _ => "another start, or a shorter time",
        };
        hint.to_owned()
    }
}

impl Refusal for ImpactError {
    fn code(&self) -> &'static str {
        match self {
            Self::NotFinite { .. }
            | Self::NotPositive { .. }
            | Self::OutOfRange { .. }
            | Self::Negative { .. }
            | Self::OrderZero
            | Self::BadAxes => "parameter",
            Self::NoConvergence { .. } | Self::Undecided { .. } => "undecided",
            Self::Cancelled => "interrupted",
            _ => "no-orbit",
        }
    }
    fn kind(&self) -> Kind {
        match self.code() {
            "parameter" => Kind::Usage,
            "undecided" => Kind::Undecided,
            "interrupted" => Kind::Stopped,
            _ => Kind::NoAnswer,
        }
    }
    fn hint(&self) -> String {
        String::new()
    }
}

impl Refusal for MelnikovError {
    fn code(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } | Self::NotPositive { .. } => "outside-domain",
            Self::Undecided { .. } | Self::Digits(_) => "could-not-decide",
            _ => "no-answer",
        }
    }
    fn kind(&self) -> Kind {
        if self.code() == "could-not-decide" { Kind::Undecided } else { Kind::NoAnswer }
    }
    fn hint(&self) -> String {
        let hint = match self.code() {
            "outside-domain" => "see `lindstedt threshold --help`",
            "could-not-decide" => "move off the degenerate point",
            _ => "",
        };
        hint.to_owned()
    }
}
