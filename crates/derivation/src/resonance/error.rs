//! Why equations have no slow flow.

use thiserror::Error;

/// Why averaging at resonance does not take equations.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ResonanceError {
    /// A function of t that is no force cos(omega t) or sin(omega t).
    #[error("{term} is no force cos(omega*t) or sin(omega*t)")]
    NotAForce {
        /// The function.
        term: String,
    },
    /// Forces that are no harmonics of one phase.
    #[error(
        "the forces are no harmonics of one phase: the ratio of two frequencies is not rational, or they are detuned otherwise"
    )]
    SecondPhase,
    /// A term at order zero that is none of a linear oscillator.
    #[error(
        "without the small parameter no oscillators x'' + nu^2*x with a force are left: there is {term}"
    )]
    NotWeaklyNonlinear {
        /// The term.
        term: String,
    },
    /// x_k'' in another form than with a number as its factor.
    #[error("x'' must stand with a number as its factor, but the equation contains {term}")]
    Acceleration {
        /// The term.
        term: String,
    },
    /// A delay.
    #[error("{term} is a delay, which averaging at resonance does not take")]
    Delay {
        /// The term.
        term: String,
    },
    /// An unknown without an equation.
    #[error("{unknowns} unknowns, but {equations} equations")]
    Equations {
        /// The unknowns that occur.
        unknowns: usize,
        /// The equations there are.
        equations: usize,
    },
    /// A parameter that the frequencies depend on has no value.
    #[error("the frequencies depend on {name}, which has no value")]
    Unset {
        /// The parameter.
        name: String,
    },
    /// The squares of the frequencies are not those of rational numbers.
    #[error("the ratio of the frequencies is not rational: their squares are {squares}")]
    NoRationalModes {
        /// The squares, where they are rational.
        squares: String,
    },
    /// nu^2 <= 0.
    #[error("the linear part does not oscillate: the square of a frequency is {square}")]
    NoOscillation {
        /// The square.
        square: String,
    },
    /// The linear part has no complete set of modes.
    #[error("the linear part is not diagonalisable")]
    NotDiagonalisable,
    /// A divisor that is almost zero.
    #[error(
        "order {order}: the harmonic {harmonic:?} (multiples of the frequencies and of the force's) misses a resonance \
         by {size:e}"
    )]
    NearMiss {
        /// The order.
        order: usize,
        /// k_1, ..., k_M, m.
        harmonic: Vec<i32>,
        /// 1 - lambda^2/nu^2.
        size: f64,
    },
    /// The monomials have no place for so many symbols.
    #[error("{count} parameters without a value are too many: sixteen exponents in all")]
    TooManySymbols {
        /// How many there are.
        count: usize,
    },
    /// An exponent beyond 127.
    #[error("order {order} needs an exponent beyond 127")]
    TooHigh {
        /// The order.
        order: usize,
    },
    /// Multiplied out, the linear part is too long.
    #[error("multiplied out, the linear part has more than {limit} terms")]
    TooManyTerms {
        /// The limit.
        limit: usize,
    },
}
