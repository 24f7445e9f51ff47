//! Errors of the facade.

use crate::refusal::{Kind, Refusal, Refused};
use lindstedt_algebra::PhaseError;
use lindstedt_derivation::DerivationError;
use lindstedt_equation::UnknownName;
use lindstedt_equation::classify::ClassifyError;
use lindstedt_evaluation::EvaluationError;
use lindstedt_expand::ExpandError;
use lindstedt_number::NumberError;
use lindstedt_problem_file::{FileError, ParseError};
use thiserror::Error;

/// Why there is no answer. Each kind maps to one exit code of the command line.
///
/// ```
/// use lindstedt::{Error, Kind, Oscillator, Refusal, Work};
/// let missing = Oscillator::parse("x'' + k*x + eps*x' = 0")?.derive(2, &Work::default());
/// let error = missing.err().ok_or(Error::NoValue)?;
/// assert_eq!((error.code(), error.kind()), ("no-method", Kind::NoAnswer));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no expansion.
    #[error(transparent)]
    Derivation(DerivationError),
    /// The expansion has no value.
    #[error(transparent)]
    Evaluation(EvaluationError),
    /// The equation cannot be classified.
    #[error(transparent)]
    Classify(#[from] ClassifyError),
    /// A form of equations that a method needs is not that of this one.
    #[error(transparent)]
    Recognise(#[from] lindstedt_recognise::Refusal),
    /// The proof does not take the equation.
    #[error(transparent)]
    Orbit(#[from] lindstedt_orbit::Failure),
    /// A word that is not one of a closed list.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A refusal put together from several reasons.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// Melnikov's method has no value here.
    #[error(transparent)]
    Melnikov(#[from] lindstedt_melnikov::MelnikovError),
    /// There is no Hopf point, or no cycle there.
    #[error(transparent)]
    Hopf(#[from] lindstedt_hopf::HopfError),
    /// There is no impact orbit or prediction for these values.
    #[error(transparent)]
    Impact(#[from] lindstedt_impact::ImpactError),
    /// The integration in the time domain failed.
    #[error(transparent)]
    Simulate(#[from] lindstedt_simulate::SimulateError),
    /// Newton's method found no periodic orbit near the expansion's.
    #[error("no periodic orbit near the expansion's at {parameter} = {value}")]
    NoPeriodicOrbit {
        /// The small parameter.
        parameter: String,
        /// Its value.
        value: String,
    },
    /// The truncated series of omega^2 is not positive.
    #[error(
        "omega^2 of order {order} is {square} at {parameter} = {value}: the truncated expansion has \
         no period"
    )]
    NoTruncatedFrequency {
        /// N.
        order: usize,
        /// omega^2, rounded.
        square: String,
        /// The small parameter.
        parameter: String,
        /// Its value.
        value: String,
    },
    /// The averaged solution has no one Taylor polynomial over a delay.
    #[error("over the delay {delay} the slow motion has no single Taylor polynomial")]
    LongDelay {
        /// The delay.
        delay: String,
    },
    /// An equation cannot be read.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// A problem file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The value does not exist.
    #[error("the value does not exist")]
    NoValue,
}

impl From<DerivationError> for Error {
    fn from(error: DerivationError) -> Self {
        match error {
            DerivationError::NoValue => Self::NoValue,
            error => Self::Derivation(error),
        }
    }
}

impl From<EvaluationError> for Error {
    fn from(error: EvaluationError) -> Self {
        match error {
            EvaluationError::Derivation(error) => error.into(),
            error => Self::Evaluation(error),
        }
    }
}

impl From<ExpandError> for Error {
    fn from(error: ExpandError) -> Self {
        DerivationError::from(error).into()
    }
}

impl From<NumberError> for Error {
    fn from(error: NumberError) -> Self {
        DerivationError::from(error).into()
    }
}

impl Refusal for Error {
    fn parts(&self) -> (Kind, &'static str, String) {
        use Kind::{NoAnswer, Undecided, Usage};
        let (kind, code, hint) = match self {
            Self::Refused(refused) => return refused.parts(),
            Self::Derivation(error) => return error.parts(),
            Self::Evaluation(error) => return error.parts(),
            Self::Simulate(error) => return error.parts(),
            Self::Melnikov(error) => return error.parts(),
            Self::Impact(error) => return error.parts(),
            Self::Hopf(error) => return error.parts(),
            Self::Recognise(error) => return error.parts(),
            Self::Orbit(error) => return error.parts(),
            Self::Classify(ClassifyError::TooManyTerms { .. }) => {
                (Undecided, "too-large", crate::refusal::SHORTER)
            }
            Self::Classify(_) => (NoAnswer, "no-method", ""),
            Self::Name(error) => return (Usage, "usage", error.known.join(", ")),
            Self::File(error) => {
                let kind = if error.is_limit() { Undecided } else { Usage };
                return (kind, "problem-file", error.hint());
            }
            Self::Parse(error) => return (Usage, "problem-file", error.hint()),
            Self::NoPeriodicOrbit { .. } => (NoAnswer, "no-periodic-orbit", "smaller --small"),
            Self::NoTruncatedFrequency { .. } => {
                (NoAnswer, "no-truncated-frequency", "smaller --small, or another --order")
            }
            Self::NoValue => (NoAnswer, "no-value", ""),
            Self::LongDelay { .. } => (Undecided, "undecided", ""),
        };
        (kind, code, hint.to_owned())
    }
}

impl Error {
    /// Whether work was stopped before anything was finished.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        matches!(self.expand(), Some(ExpandError::Interrupted { .. }))
    }

    /// Whether a force in resonance is the reason.
    #[must_use]
    pub fn is_resonance(&self) -> bool {
        let source = self.expand();
        matches!(source, Some(ExpandError::Phase { source: PhaseError::Resonance { .. }, .. }))
    }

    /// Whether a frequency that is no formula in the coefficients is the reason.
    pub(crate) fn is_irrational_frequency(&self) -> bool {
        matches!(self.expand(), Some(ExpandError::StiffnessNotSquare))
    }

    /// What the driver said.
    #[must_use]
    pub fn expand(&self) -> Option<&ExpandError> {
        match self {
            Self::Derivation(DerivationError::Expand(error)) => Some(error),
            _ => None,
        }
    }
}
