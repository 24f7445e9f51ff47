//! Why there is no Hopf point, or no cycle.

use thiserror::Error;

/// Why there is no Hopf point, or no cycle.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HopfError {
    /// L(i omega_0; alpha_0) does not vanish.
    #[error("i*omega is no root of the characteristic function there")]
    NoRoot,
    /// The root stays on the imaginary axis to first order.
    #[error("the pair of roots does not cross the imaginary axis with a speed, or is not simple")]
    NoSpeed,
    /// A multiple of the frequency is a root as well.
    #[error(
        "resonance: {harmonic}*i*omega is a root of the characteristic function too, or cannot be told from one"
    )]
    Resonant {
        /// Which multiple.
        harmonic: usize,
    },
    /// A number is not in the field that is computed in.
    #[error("a constant of the equation has no value")]
    Field,
    /// No pair of roots crosses the axis in the interval that was searched.
    #[error(
        "at x = 0 no pair of roots of the characteristic function crosses the imaginary axis for {unknown} between {low} and {high}"
    )]
    NoPoint {
        /// The parameter.
        unknown: String,
        /// The lower end.
        low: String,
        /// The upper end.
        high: String,
    },
    /// The roots do not depend on the parameter.
    #[error(
        "the linear part does not depend on {unknown}: no root of the characteristic function moves with it"
    )]
    Still {
        /// The parameter.
        unknown: String,
    },
    /// The characteristic function is even: with a root lambda, -lambda is one.
    #[error(
        "the linear part has no damping and no delay: its roots are pairs lambda, -lambda, of which none crosses the imaginary axis alone"
    )]
    Even,
    /// A root at zero, which is no pair i omega, -i omega, is not told from one.
    #[error(
        "a root of the characteristic function at 0 near {unknown} = {at} is not told from a pair i*omega, -i*omega with a small omega"
    )]
    ZeroRoot {
        /// The parameter.
        unknown: String,
        /// Where.
        at: String,
    },
    /// A delay is not told from zero at a Hopf point.
    #[error("the sign of a delay is not decided at the Hopf point near {unknown} = {at}")]
    UndecidedDelay {
        /// The parameter.
        unknown: String,
        /// Where.
        at: String,
    },
    /// The boxes that may be looked at are used up.
    #[error(
        "the search for Hopf points between {unknown} = {low} and {high} is not finished after {boxes} boxes"
    )]
    TooManyBoxes {
        /// The parameter.
        unknown: String,
        /// The lower end.
        low: String,
        /// The upper end.
        high: String,
        /// The boxes.
        boxes: usize,
    },
    /// The smallest box of the search is not decided.
    #[error(
        "the search for Hopf points is not decided near {unknown} = {at}: a double root, or roots too close to tell apart"
    )]
    Undecided {
        /// The parameter.
        unknown: String,
        /// Where.
        at: String,
    },
    /// The frequencies have no bound.
    #[error(
        "the delayed terms of the highest derivative outweigh it: the frequencies of its Hopf points have no bound"
    )]
    Unbounded,
    /// Too few bits.
    #[error("{bits} bits do not give the digits asked for")]
    NotEnoughBits {
        /// Bits of the last attempt.
        bits: u32,
    },
    /// The series does not satisfy the equation.
    #[error("the series put into the equation leaves a residual")]
    Residual,
    /// Stopped before anything was finished.
    #[error("stopped before the first order was finished")]
    Stopped,
}
