//! Errors of the facade.

use lindstedt_expand::ExpandError;
use lindstedt_number::NumberError;
use lindstedt_problem_file::{FileError, ParseError};
use thiserror::Error;

/// Why the engine has no answer. Each kind maps to one exit code of the command line.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The driver refused.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// A refusal put together from several reasons.
    #[error(transparent)]
    Refused(#[from] crate::refusal::Refused),
    /// Melnikov's method has no value here.
    #[error(transparent)]
    Melnikov(#[from] lindstedt_melnikov::MelnikovError),
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
    /// No more primes of 61 bits with the roots of unity that the order needs.
    #[error("no more 61-bit primes for this order")]
    OutOfPrimes,
    /// An equation cannot be read.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// A problem file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A rational value is needed where the parameter stands.
    #[error("{name} = {value} is irrational, but exact derivations of this problem are over Q")]
    Irrational {
        /// The parameter.
        name: String,
        /// The value.
        value: String,
    },
    /// A value that cannot be read.
    #[error("cannot read the value {text:?}")]
    BadValue {
        /// The text, shortened.
        text: String,
    },
    /// A parameter the problem does not have.
    #[error("{problem} has no parameter {name:?}; it has {known}")]
    UnknownParameter {
        /// The problem.
        problem: String,
        /// The name.
        name: String,
        /// The parameters it has.
        known: String,
    },
    /// A value that cannot stand among symbols.
    #[error(
        "{name} can only be set when all parameters are{}: symbols take rational values",
        without(missing)
    )]
    NotAmongSymbols {
        /// The parameter.
        name: String,
        /// The parameters of the equation without a value.
        missing: Vec<String>,
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
    /// A parameter without a value.
    #[error("{name} has no value in {problem}: set it")]
    Unset {
        /// The problem.
        problem: String,
        /// The parameter.
        name: String,
    },
    /// A value outside the domain of a parameter.
    #[error("{name} = {value} is outside its domain {domain}")]
    OutsideDomain {
        /// The parameter.
        name: String,
        /// The value.
        value: String,
        /// The domain.
        domain: &'static str,
    },
    /// A condition that the problem does not offer.
    #[error("{problem} does not offer this normalisation")]
    UnknownCondition {
        /// The problem.
        problem: String,
    },
    /// The energy integral does not apply.
    #[error(
        "{problem}: the energy integral applies to conservative forces that are polynomial, from x(0) = A, or \
         x F(delta ln x^2)"
    )]
    NoSuchRoute {
        /// The problem.
        problem: String,
    },
    /// The work would need more memory than allowed.
    #[error(
        "order {order} is predicted to need 10^{exponent} bytes, above the limit of {limit} MiB"
    )]
    TooLarge {
        /// The order.
        order: usize,
        /// The prediction: the exponent of ten of the bytes, rounded.
        exponent: u64,
        /// The limit in MiB.
        limit: u64,
    },
    /// The digits were not reached.
    #[error("the digits asked for were not reached with {bits} bits")]
    NotEnoughBits {
        /// The largest precision tried.
        bits: u32,
        /// The best enclosure.
        best: Option<String>,
    },
    /// The series has no value by the method asked for.
    #[error("{problem}: {reason}")]
    Resummation {
        /// The problem.
        problem: String,
        /// Why.
        reason: lindstedt_series::resummation::ResummationError,
    },
    /// Period and solution are not summed for this problem.
    #[error("{problem}: no series of the period is known that can be summed")]
    NotEvaluated {
        /// The problem.
        problem: String,
    },
    /// A force whose derivatives hold delta functions at places that the motion passes at times that
    /// change from order to order: an expansion by values would drop them.
    #[error(
        "{term} is singular where the motion passes at times that change with the small parameter: the \
         expansion has terms there that values at nodes do not see"
    )]
    MovingSingularity {
        /// The function.
        term: String,
    },
    /// The value does not exist.
    #[error("the value does not exist")]
    NoValue,
}

impl From<NumberError> for Error {
    fn from(error: NumberError) -> Self {
        match error {
            NumberError::BadValue { text } => Self::BadValue { text },
            NumberError::NotEnoughBits { bits, best } => Self::NotEnoughBits { bits, best },
            _ => Self::NoValue,
        }
    }
}

impl From<lindstedt_multimodular::Error> for Error {
    fn from(error: lindstedt_multimodular::Error) -> Self {
        match error {
            lindstedt_multimodular::Error::Expand(error) => Self::Expand(error),
            _ => Self::OutOfPrimes,
        }
    }
}

/// Which values are missing.
fn without(missing: &[String]) -> String {
    match missing {
        [] => String::new(),
        names => format!(" (without a value: {})", names.join(", ")),
    }
}
