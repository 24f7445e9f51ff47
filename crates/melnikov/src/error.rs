//! Errors of the crate.

use lindstedt_number::{Exact, NumberError};
use rug::Rational;
use thiserror::Error;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MelnikovError {
    /// No such value: a parameter is NaN or infinite.
    #[error("{name} is not a finite number")]
    NotFinite {
        /// The parameter.
        name: &'static str,
    },
    /// No such value: without a positive parameter there is no homoclinic loop, or no forcing.
    #[error("{name} must be positive")]
    NotPositive {
        /// The parameter.
        name: &'static str,
    },
    /// The orbit does not satisfy the equation of motion.
    #[error("not an orbit: xi'' - sum c_k xi^k = {residual}")]
    WrongOrbit {
        /// What is left of the scaled equation, in the hyperbolic algebra.
        residual: String,
    },
    /// The relations between the parameters leave the scaled force coefficients undetermined.
    #[error("the scaled coefficient of x^{power} depends on the parameters")]
    NotScaled {
        /// The power of x.
        power: usize,
    },
    /// The frequency of the unperturbed orbit is irrational: another unit of time makes it rational.
    #[error(
        "the slope of the force at the saddle, {slope}, is not the square of a rational number"
    )]
    NotSquare {
        /// The slope.
        slope: Rational,
    },
    /// A term of the perturbation is not rational in sech and tanh on the orbit.
    #[error("y^{position} y'^{velocity} leaves the ring of sech and tanh on this orbit")]
    LeavesRing {
        /// The power of y.
        position: u32,
        /// The power of y'.
        velocity: u32,
    },
    /// The unknown parameter does no work along the unperturbed orbit, so nothing fixes it.
    #[error("the unknown parameter does no work along the orbit")]
    UnknownWithoutWork,
    /// The potential is not symmetric: there is no mirror image of its orbit.
    #[error("this potential has one orbit only, no mirror image")]
    NoMirrorImage,
    /// The forcing vanishes on the orbit, so no amplitude reaches the threshold.
    #[error("the forcing vanishes on the orbit")]
    NoForcing,
    /// No closed form here: the work of incommensurate frequencies as a function of one phase, or a
    /// factor g(x) of a force or of friction that leaves the hyperbolic algebra.
    #[error("this perturbation has no closed form on this orbit")]
    NoClosedForm,
    /// The friction does no work at any belt speed: every v* is a zero.
    #[error("the friction does no work at any belt speed")]
    IdenticallyZero,
    /// No periodic orbit in resonance with the forcing.
    #[error("no orbit of period 2 pi {m}/omega in this region")]
    NoResonance {
        /// The order of the resonance.
        m: u32,
    },
    /// A degree beyond what is computed.
    #[error("the degree {degree} is larger than {limit}")]
    DegreeTooLarge {
        /// The degree asked for.
        degree: usize,
        /// The largest one.
        limit: usize,
    },
    /// No such value: the friction law is not defined at a speed that the orbit reaches.
    #[error("the friction law is undefined on the orbit")]
    UndefinedFriction,
    /// No such value: the two grids of a sweep do not fill the table.
    #[error("the table needs {expected} entries, not {found}")]
    WrongTableSize {
        /// The product of the axes.
        expected: usize,
        /// The entries given.
        found: usize,
    },
    /// Could not decide at this precision: a sign, an order, or a convergence.
    #[error("not decided with {bits} bits")]
    Undecided {
        /// The precision of the attempt.
        bits: u32,
    },
    /// The digits could not be certified.
    #[error(transparent)]
    Digits(#[from] NumberError),
}

/// Refuses a parameter that is not positive.
pub(crate) fn positive(x: &Exact, name: &'static str) -> Result<(), MelnikovError> {
    if x.sign().is_gt() { Ok(()) } else { Err(MelnikovError::NotPositive { name }) }
}
