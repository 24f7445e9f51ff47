//! Errors of resummation.

use thiserror::Error;

/// Why a resummation gives no value.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ResummationError {
    /// Not enough coefficients for a value and an error estimate.
    #[error("{known} coefficients are too few, {needed} are needed")]
    TooFewCoefficients {
        /// The number there is.
        known: usize,
        /// The number needed.
        needed: usize,
    },
    /// The re-expanded series does not converge at the point.
    #[error("the series in u converges for |u| < {radius}, and u = {at}")]
    OutsideDisc {
        /// The radius of convergence in u.
        radius: f64,
        /// u.
        at: f64,
    },
    /// The map sends the point to infinity or beyond.
    #[error("the change of variable is not defined at the point")]
    OutsideMap,
    /// No change of variable is known for this series.
    #[error("no change of variable is known for this series")]
    NoMap,
    /// No singularity was found to build a conformal map on.
    #[error("no stable singularity was found in the coefficients")]
    NoSingularity,
    /// The Borel transform has a pole on the path of integration.
    #[error("the Borel transform has a pole on the positive axis")]
    PoleOnPath,
    /// The Borel integral did not settle.
    #[error("the Laplace integral did not settle")]
    NotSettled,
    /// A method whose values have no formula in the point was to be compiled.
    #[error("the values of {method:?} have no formula in the point, another one at each")]
    NoFormula {
        /// The method.
        method: &'static str,
    },
    /// The approximants have a pole at the point or do not exist.
    #[error("the approximants are not defined at the point")]
    Undefined,
    /// No method has this name.
    #[error("there is no method of resummation {found:?}")]
    UnknownMethod {
        /// The name, at most 60 characters of it.
        found: String,
    },
    /// It was told to stop.
    #[error("stopped before the sum was finished")]
    Stopped,
    /// The coefficients are not known to the precision needed.
    #[error("the coefficients are not known to {bits} bits")]
    NoCoefficients {
        /// The precision.
        bits: u32,
    },
}
