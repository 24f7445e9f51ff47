//! Errors of the facade.

use lindstedt_expand::ExpandError;
use thiserror::Error;

/// Why the engine has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The driver refused.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// No more primes of 61 bits with the roots of unity that the order needs.
    #[error("no more primes for this order")]
    OutOfPrimes,
}
