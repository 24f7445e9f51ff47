//! Why an equation is refused, with the term.

use lindstedt_equation::Expression;
use lindstedt_melnikov::MelnikovError;
use std::fmt;

/// Why a term does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Why {
    /// It must vanish with the small parameter.
    NotSmall,
    /// It is of higher order than the first.
    HigherOrder,
    /// It is a force.
    Forced,
    /// An earlier time, in a law of one phase.
    Late,
    /// It is no linear spring.
    NotSpring,
    /// The small parameter stands inside a function.
    SmallInside,
    /// An earlier time.
    Delay,
    /// A formal function.
    Formal,
    /// A dissipative term that depends on x otherwise than by g(x) x'^j.
    DependsOnPosition,
    /// A function of t other than a harmonic force.
    NotHarmonic,
    /// A periodic force where none may be.
    Periodic,
    /// A factor of x other than x^n or sines and cosines of k x.
    PositionFactor,
    /// The lowest of several harmonics has a negative coefficient: the thresholds of the two signs
    /// differ.
    NegativeForce,
    /// It jumps at another speed than the jump before.
    OtherSpeed,
    /// A frequency that is neither rational nor a rational multiple of pi.
    IrrationalFrequency,
    /// A coefficient that is neither rational nor a rational multiple of pi.
    Irrational,
    /// It is not linear in x, x' and their delayed values.
    NotLinear,
    /// A second frequency.
    OtherFrequency,
    /// A delay that is not the period of the orbit.
    OtherDelay,
    /// It is no polynomial in x and x'.
    NotPolynomial,
    /// A coefficient that is not rational.
    NotRational,
    /// The parameter that is sought does not enter linearly.
    NotLinearUnknown,
    /// It depends on t.
    DependsOnTime,
    /// It has no power series in x, x' and their values at earlier times about x = 0.
    NotAnalyticAtRest,
    /// Abs or sign of what has no known sign at x = 0.
    UnknownSignAtRest,
    /// It divides by what vanishes at x = 0.
    SingularAtRest,
    /// With others it is not told from zero at x = 0.
    RestUndecided,
    /// It does not vanish at x = 0.
    NotAtRest,
    /// The parameter that is sought stands in a denominator, a power or a function.
    UnknownInside,
    /// Its delay is not positive, or depends on more than parameters.
    BadDelay,
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotSmall => "has no factor of the small parameter; only a force f(x) may have none",
            Self::HigherOrder => "is of higher order in the small parameter; the perturbation must be of first order",
            Self::Forced => "depends on t; averaging over one phase takes no force",
            Self::Late => "is a delay; `lindstedt derive --normalisation free` averages delays in polynomial laws",
            Self::NotSpring => "has no factor of the small parameter; only a linear spring may have none",
            Self::SmallInside => "has the small parameter in a function, a divisor or a power that is no whole one",
            Self::Delay => "is a delay; Melnikov's method has none",
            Self::Formal => "is a formal function",
            Self::DependsOnPosition => "depends on x and is no g(x)*x'^j with a power, or sines and cosines of k*x, for g",
            Self::NotHarmonic => "is no harmonic force cos(omega*t + phase), also times a power of x or sines and cosines of k*x",
            Self::Periodic => "is a periodic force; a parameter for which the orbit persists is sought without one",
            Self::PositionFactor => "has a factor of x that is neither a power nor a product of sin(k*x + phase), cos(k*x + phase) \
                                     with phases in quarter turns",
            Self::NegativeForce => "has a negative coefficient beside other harmonics; shift the time so that the lowest one is positive",
            Self::OtherSpeed => "jumps or bends elsewhere than at one speed x' = v*, the same for all terms",
            Self::IrrationalFrequency => "has a frequency that is neither rational nor a rational multiple of pi",
            Self::Irrational => "has a coefficient that is neither rational nor a rational multiple of pi",
            Self::NotLinear => "is not linear in x, x', x(t - T), x'(t - T)",
            Self::OtherFrequency => "is a second force",
            Self::OtherDelay => "has a delay that is no period 2*pi*k/omega of the force, k = 1, 2, ...",
            Self::NotPolynomial => "is no polynomial in x and x'; the orbit is known in closed form for those",
            Self::NotRational => "has a coefficient that is not rational",
            Self::NotLinearUnknown => "is not linear in the parameter that is sought",
            Self::DependsOnTime => "depends on t; Hopf points are those of an equilibrium",
            Self::NotAnalyticAtRest => "has no power series in x, x' and their values at earlier times about x = 0, the equilibrium that is looked at",
            Self::UnknownSignAtRest => "takes abs or sign of what has no known sign at x = 0, the equilibrium that is looked at: give its parameters values, or write it without",
            Self::SingularAtRest => "divides by what vanishes at x = 0, the equilibrium that is looked at",
            Self::RestUndecided => "with the other terms without x is not told from zero at x = 0: write constants that cancel alike",
            Self::NotAtRest => "does not vanish at x = 0, the equilibrium that is looked at",
            Self::UnknownInside => "is no polynomial in the parameter that is sought",
            Self::BadDelay => "has a delay that is not positive",
        })
    }
}

/// Why an equation is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// x'' is not free.
    #[error("x'' does not stand alone")]
    Acceleration,
    /// Multiplied out, the equation is too long.
    #[error("multiplied out, the equation has more than {limit} terms")]
    TooManyTerms {
        /// The limit.
        limit: usize,
    },
    /// Parameters of the equation without a value.
    #[error("without a value: {}", names.join(", "))]
    MissingValues {
        /// Their names.
        names: Vec<String>,
    },
    /// A term that does not fit.
    #[error("{}: {why}", term.print("eps", lindstedt_equation::print::Style::Text))]
    Term {
        /// The term, as it occurs multiplied out.
        term: Box<Expression>,
        /// Why.
        why: Why,
    },
    /// The forces have no common period.
    #[error("the forces have no common period, so there is no map whose manifolds could touch")]
    NoPeriod,
    /// The orbit touches the line where friction jumps.
    #[error("friction jumps at v*, and v* = 0 or |v*| = V: the expansion in eps fails there")]
    Tangent,
    /// No harmonic force.
    #[error("there is no harmonic force")]
    NoForce,
    /// Several forces, all zero.
    #[error("every harmonic force is zero at these values, and which of them grows is open")]
    SilentForces,
    /// The unperturbed equation has no hyperbolic saddle with an orbit that returns or leads to another.
    #[error(
        "no homoclinic or heteroclinic orbit of a hyperbolic saddle of the unperturbed equation was found"
    )]
    NoOrbit,
    /// The unperturbed orbit is no power of sech.
    #[error(
        "the unperturbed equation is not y'' = a*y + b*y^k with x = c + y, a > 0, and b < 0 where k is odd: \
         no orbit that returns to its saddle is known in closed form"
    )]
    NoSaddleForm,
    /// A constant term at the saddle.
    #[error("the perturbation does not vanish at the saddle x = {position}: it moves it")]
    MovesSaddle {
        /// Where the saddle is.
        position: String,
    },
    /// The unperturbed equation has no stiffness, or one of which the root is no exact number.
    #[error(
        "the free flight takes alpha^2 > 0 in x'' + alpha^2 x, rational or the square of a rational multiple of pi, not {value}"
    )]
    NoStiffness {
        /// alpha^2.
        value: String,
    },
    /// No linear spring.
    #[error("there is no spring: averaging over one phase needs x'' + omega^2*x with omega^2 > 0")]
    NoSpring,
    /// There is a wall.
    #[error("there is a wall; Melnikov's method has none")]
    Wall,
    /// There is a wall, and a Hopf point is asked for.
    #[error("there is a wall; Hopf points are those of the equation alone")]
    WallAtHopf,
    /// There is no wall.
    #[error("there is no wall: the file has no [impact]")]
    NoWall,
    /// k is not a positive whole number.
    #[error("the periods between impacts must be a positive whole number, not {value}")]
    Periods {
        /// k.
        value: String,
    },
    /// What Melnikov's method says.
    #[error(transparent)]
    Melnikov(#[from] MelnikovError),
}

impl Refusal {
    /// The term that the refusal is about.
    #[must_use]
    pub fn term(&self) -> Option<&Expression> {
        match self {
            Self::Term { term, .. } => Some(term),
            _ => None,
        }
    }
}
