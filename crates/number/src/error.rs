//! What can go wrong with a number.

/// Why there is no number, or not so many digits of it.
///
/// ```
/// use lindstedt_number::{Exact, NumberError};
/// assert!(matches!("1/0".parse::<Exact>(), Err(NumberError::BadValue { .. })));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NumberError {
    /// The text is no exact number.
    #[error("cannot read the value {text:?}")]
    BadValue {
        /// The text, shortened.
        text: String,
    },
    /// Could not decide: the radius at the largest precision allowed is still too large. A value
    /// that is exactly 0 but computed with a rounding error ends here at every precision.
    #[error("not decided with {bits} bits; best enclosure: {}", best.as_deref().unwrap_or("none"))]
    NotEnoughBits {
        /// The precision of the last attempt.
        bits: u32,
        /// What is known, as `digits +/- error`.
        best: Option<String>,
    },
    /// No such value, at the largest precision allowed.
    #[error("the value is undefined")]
    Undefined,
}
