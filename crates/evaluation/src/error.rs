//! Why an expansion has no value.

use lindstedt_algebra::Stop;
use lindstedt_derivation::DerivationError;
use lindstedt_equation::Problem;
use lindstedt_expand::ExpandError;
use lindstedt_number::NumberError;
use lindstedt_series::resummation::ResummationError;
use thiserror::Error;

/// Why an expansion has no value at the parameters given.
///
/// ```
/// use lindstedt_evaluation::EvaluationError;
/// let error = EvaluationError::NotPositive { amplitude: "-1".to_owned() };
/// assert_eq!(error.to_string(), "the amplitude -1 is not positive");
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// There is no expansion.
    #[error(transparent)]
    Derivation(#[from] DerivationError),
    /// Period and solution are not summed for this problem.
    #[error("{problem}: no series of the period is known that can be summed")]
    NotEvaluated {
        /// The problem.
        problem: String,
    },
    /// The series has no value by the method asked for.
    #[error("{problem}: {reason}")]
    Resummation {
        /// The problem.
        problem: String,
        /// Why.
        #[source]
        reason: ResummationError,
    },
    /// The weights and sums of so many phases would need more memory than allowed.
    #[error("{phases} phases need {} MiB, the limit is {} MiB", needed >> 20, limit >> 20)]
    TooManyPhases {
        /// Those that no symmetry takes to each other.
        phases: usize,
        /// Bytes.
        needed: u64,
        /// The same.
        limit: u64,
    },
    /// Newton's method found no amplitude and phase for the state asked for.
    #[error(
        "{problem}: no amplitude and phase were found with x(0) = {displacement}, x'(0) = {velocity}"
    )]
    NoSuchStart {
        /// The problem.
        problem: String,
        /// x(0).
        displacement: String,
        /// x'(0).
        velocity: String,
    },
    /// A start that is not two values separated by a comma.
    #[error("--{option} {text:?} is not two values")]
    NotTwoValues {
        /// `start` or `state`.
        option: &'static str,
        /// The text, shortened.
        text: String,
    },
    /// An averaged motion starts at a positive amplitude.
    #[error("the amplitude {amplitude} is not positive")]
    NotPositive {
        /// The amplitude.
        amplitude: String,
    },
}

impl EvaluationError {
    /// Why there is no value at some phase: there is none, or the work was stopped.
    pub(crate) fn without_value(problem: &Problem, stop: &Stop) -> Self {
        match stop.asked() {
            true => Self::Resummation {
                problem: problem.name.to_string(),
                reason: ResummationError::Stopped,
            },
            false => DerivationError::NoValue.into(),
        }
    }
}

impl From<ExpandError> for EvaluationError {
    fn from(error: ExpandError) -> Self {
        Self::Derivation(error.into())
    }
}

impl From<NumberError> for EvaluationError {
    fn from(error: NumberError) -> Self {
        Self::Derivation(error.into())
    }
}
