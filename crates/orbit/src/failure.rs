//! Why an orbit is not proved.

use lindstedt_equation::{AccelerationFault, Expression};
use rug::Rational;
use thiserror::Error;

/// Why an orbit is not proved: the question does not fit the equation, or a bound failed, with its
/// number. That a bound failed says nothing against the orbit.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Failure {
    /// No such value: x'' does not stand alone with a constant factor.
    #[error("x'' does not stand alone with a constant factor")]
    Acceleration(AccelerationFault),
    /// No such value: a name without a value.
    #[error("the name {0} has no value")]
    NoValue(String),
    /// No such value: not made of the unknowns, their velocities and rational numbers by sums, products,
    /// rational powers, sines, cosines and exponentials, with a force of cosines and sines with rational
    /// frequencies.
    #[error("not made of polynomials, rational powers, sines, cosines and exponentials")]
    NotPolynomial(Expression),
    /// No such value: a force that is not smooth where the orbit passes, so that its Fourier coefficients decay
    /// too slowly for any of the bounds.
    #[error("a force that is not smooth at x = 0")]
    NotSmooth(Expression),
    /// Could not decide: a function of the orbit is not enclosed: its argument, of norm `argument`, is too
    /// large for an exponential, or vanishes on the orbit or near it, where a root has no value.
    #[error("a function of the orbit is not enclosed (norm of its argument {argument:.3e})")]
    NoFunction {
        /// The norm.
        argument: f64,
    },
    /// A power that is not taken.
    #[error(
        "the exponent {exponent} is too large for a proof: it takes powers up to {most} and roots up to the {root}th"
    )]
    Exponent {
        /// The exponent.
        exponent: Rational,
        /// The largest power.
        most: u32,
        /// The largest denominator.
        root: u32,
    },
    /// A degree that is not taken.
    #[error(
        "a term of degree {degree} in x and x' is too large for a proof: it takes degrees up to {most}"
    )]
    Degree {
        /// The degree.
        degree: u32,
        /// The largest degree.
        most: u32,
    },
    /// A harmonic of the force that is not taken.
    #[error(
        "the frequencies of the force are up to {harmonic} times their common measure: a proof takes multiples up to {most}"
    )]
    Harmonic {
        /// The harmonic.
        harmonic: u32,
        /// The largest harmonic.
        most: u32,
    },
    /// Multiplied out, the equation or a derivative has more terms, or it has more functions, than are taken.
    #[error(
        "multiplied out, the equation or its derivatives have too many terms or functions for a proof"
    )]
    TooManyTerms,
    /// The field has a force: [`Kind::Forced`](crate::Kind::Forced) is the question.
    #[error("the equation is forced")]
    Forced,
    /// The field has no force.
    #[error("the equation has no force")]
    NotForced,
    /// A family needs an equation that is even in x'.
    #[error("the equation is not even in x'")]
    NotReversible,
    /// The guess has no harmonic, no positive frequency or values that are not finite.
    #[error("no guess was found that oscillates")]
    NoStart,
    /// No such value: a pendulum with q x(0) at 0, or at pi and beyond, where it does not swing but stands or
    /// turns over.
    #[error("a pendulum does not swing at this amplitude: its angle must lie between 0 and pi")]
    NotSwinging,
    /// Could not decide: of all values between two a field is known only where one number of the equation varies
    /// and is the parameter itself (of a pendulum, the amplitude).
    #[error(
        "no one number of the equation alone varies with the parameter (of a pendulum, the amplitude)"
    )]
    NotOneNumber,
    /// DF has no inverse in doubles.
    #[error("the linearised equation has no inverse on {modes} modes")]
    Singular {
        /// The modes.
        modes: usize,
    },
    /// Newton's method found no solution near the guess.
    #[error("Newton's method did not converge on {modes} modes")]
    NotConverged {
        /// The modes.
        modes: usize,
    },
    /// Could not decide: the orbit found is not the one that was followed, as far as its size says.
    #[error("the orbit found is far from its prediction: a fold, or a step that is too large")]
    Jump,
    /// Could not decide: the ball of a part of an interval does not meet that of its neighbour.
    #[error(
        "the ball of radius {radius:.3e} of a part of the interval does not meet that of its neighbour"
    )]
    Apart {
        /// The radius.
        radius: f64,
    },
    /// Could not decide: Z0 + Z1 >= 1 with as many modes as were allowed. Z0 is the defect of the inverse
    /// on its modes, Z1 what it neglects.
    #[error("no contraction on {modes} modes: Z0 = {z0:.3e}, Z1 = {z1:.3e}")]
    NoContraction {
        /// The modes.
        modes: usize,
        /// |1 - A D|.
        z0: f64,
        /// The rest of |1 - A DF|.
        z1: f64,
    },
    /// Could not decide: Y0 is too large for the curvature, 2 Z2 Y0 > (1 - Z0 - Z1)^2.
    #[error(
        "on {modes} modes the residual Y0 = {y0:.3e} is too large for the curvature Z2 = {z2:.3e}"
    )]
    Residual {
        /// The modes.
        modes: usize,
        /// |A F|.
        y0: f64,
        /// The Lipschitz constant of A DF.
        z2: f64,
    },
    /// Could not decide: an orbit is proved, but within a radius as large as its frequency.
    #[error("proved within {radius:.3e} only, which leaves no period")]
    NoPeriod {
        /// The radius.
        radius: f64,
    },
    /// Stopped by the [`Stop`](lindstedt_algebra::Stop) of the request.
    #[error("stopped")]
    Stopped,
}
