//! Why there is no derivation.

use lindstedt_equation::Problem;
use lindstedt_equation::classify::Reason;
use lindstedt_equation::description::reason_text;
use lindstedt_expand::ExpandError;
use lindstedt_number::NumberError;
use thiserror::Error;

/// Why the engine has no expansion.
///
/// ```
/// use lindstedt_derivation::{DerivationError, Settings, derive};
/// use lindstedt_number::Exact;
/// let problem = lindstedt_problems::find("pendulum").ok_or("no such problem")?;
/// let parameters = [("amplitude".to_owned(), Exact::from(4))].into();
/// let error = derive(&problem, &Settings { parameters, ..Settings::default() }, &mut |_| true);
/// assert!(matches!(error, Err(DerivationError::OutsideDomain { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DerivationError {
    /// The driver refused.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// Averaging at resonance does not take the equations.
    #[error(transparent)]
    Resonance(#[from] crate::resonance::ResonanceError),
    /// No more primes of 30 bits with the roots of unity that the order needs.
    #[error("no more 30-bit primes for this order")]
    OutOfPrimes,
    /// A rational value is needed where the parameter stands.
    #[error(
        "{value} is irrational{}, and the equation is brought into its form over Q",
        for_parameter(name, value)
    )]
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
    /// A parameter without a value, named like what the answer is written with.
    #[error(
        "the answer is written with {name}, {meaning}: no parameter of that name can stay a symbol"
    )]
    SymbolTaken {
        /// The name.
        name: String,
        /// What it means there.
        meaning: &'static str,
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
        "order {order} is predicted to need {}, the limit is {}",
        mebibytes(*needed),
        mebibytes(*limit)
    )]
    TooLarge {
        /// The order.
        order: usize,
        /// log2 of the bytes that are predicted.
        needed: f64,
        /// log2 of the limit in bytes.
        limit: f64,
    },
    /// The digits were not reached.
    #[error("the digits asked for were not reached with {bits} bits")]
    NotEnoughBits {
        /// The largest precision tried.
        bits: u32,
        /// The best enclosure.
        best: Option<String>,
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
    /// What is against averaging between turning points, which takes laws that jump with the velocity.
    #[error("{}", reason_text(reason, small))]
    BetweenTurningPoints {
        /// What is against it.
        reason: Box<Reason>,
        /// The small parameter.
        small: String,
        /// Whether the law depends on t, or on values at earlier times.
        late_or_forced: bool,
    },
    /// The value does not exist.
    #[error("the value does not exist")]
    NoValue,
}

impl DerivationError {
    /// A name of the equation without a value; the number pi has one, which is none of Q.
    #[must_use]
    pub fn without_value(problem: &Problem, name: &str) -> Self {
        let name = name.to_owned();
        match &*name {
            "pi" => Self::Irrational { value: name.clone(), name },
            _ => Self::Unset { problem: problem.name.to_string(), name },
        }
    }
}

impl From<NumberError> for DerivationError {
    fn from(error: NumberError) -> Self {
        match error {
            NumberError::BadValue { text } => Self::BadValue { text },
            NumberError::NotEnoughBits { bits, best } => Self::NotEnoughBits { bits, best },
            _ => Self::NoValue,
        }
    }
}

impl From<lindstedt_multimodular::Error> for DerivationError {
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

/// Whose value it is; the number pi is its own.
fn for_parameter(name: &str, value: &str) -> String {
    if name == value { String::new() } else { format!(" ({name})") }
}

/// 2^`log2` bytes in MiB: a number of which a few digits mean something, a power of ten where it is large.
fn mebibytes(log2: f64) -> String {
    let mebibytes = (log2 - 20.0).exp2();
    match mebibytes {
        few if few < 10.0 => format!("{few:.1} MiB"),
        some if some < 1e6 => format!("{some:.0} MiB"),
        _ => format!("10^{:.0} MiB", (log2 - 20.0) * 2f64.log10()),
    }
}
