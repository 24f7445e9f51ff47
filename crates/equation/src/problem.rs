//! A problem: an equation with what is needed to expand it and to talk about it.

use crate::Expression;
use serde::Serialize;
use std::borrow::Cow;

/// Text of a data card: a literal of a built-in problem or a string read from a problem file.
pub type Text = Cow<'static, str>;

/// What fixes the amplitude (and the phase) of the solution, order by order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Condition {
    /// x(0) = 1, x'(0) = 0: corrections start at rest at zero ("initial amplitude").
    InitialAmplitude,
    /// The first harmonic of x is cos psi: corrections have no first harmonic.
    FundamentalAmplitude,
    /// A limit cycle with x'(0) = 0; its amplitude x(0) is determined order by order.
    LimitCycle,
    /// A free amplitude a that drifts (Krylov, Bogoliubov, Mitropolsky): x = a cos psi + ...,
    /// corrections have no first harmonic, da/dt and dpsi/dt are functions of a.
    FreeAmplitude,
}

impl Condition {
    /// Its name in files and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::InitialAmplitude => "initial-amplitude",
            Self::FundamentalAmplitude => "fundamental-amplitude",
            Self::LimitCycle => "limit-cycle",
            Self::FreeAmplitude => "free-amplitude",
        }
    }
}

/// How the amplitude of the user's solution enters an equation written for amplitude one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmplitudeRole {
    /// omega^2 is multiplied by a^(exponent * small parameter), a > 0.
    ScalesFrequency {
        /// The exponent in units of the small parameter.
        exponent: i32,
    },
    /// The coefficients S_n of the formal function depend on it, 0 < a < pi.
    InSums,
    /// x = a y is substituted into the equation and the equation divided by a; a > 0 rational.
    Scaled,
    /// It is part of the small parameter; a is not zero.
    InSmallParameter,
    /// The equation determines it.
    Determined,
    /// It is a variable of the result.
    Free,
}

/// One line of a data card.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterCard {
    /// The name on the command line.
    pub name: Text,
    /// What it is, with its domain; all parameters are dimensionless unless a unit is given.
    pub meaning: Text,
    /// The default value, as the user would write it.
    pub default: Text,
}

impl ParameterCard {
    /// A line of a built-in problem.
    #[must_use]
    pub fn new(name: &'static str, meaning: &'static str, default: &'static str) -> Self {
        Self { name: name.into(), meaning: meaning.into(), default: default.into() }
    }
}

/// The direction in which x crosses a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// x' > 0: the wall is above.
    Rising,
    /// x' < 0: the wall is below.
    Falling,
}

/// A rigid wall: when x reaches `position` in the given direction, x' becomes -restitution x'.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// Where the wall stands; an expression in parameters.
    pub position: Expression,
    /// From which side the wall is reached.
    pub crossing: Crossing,
    /// The restitution coefficient, between 0 and 1; an expression in parameters.
    pub restitution: Expression,
}

/// A delay that is a whole number of periods of the force, T = 2 pi k/omega.
#[derive(Clone, Debug, PartialEq)]
pub struct Synchronous {
    /// The parameter T.
    pub delay: Text,
    /// The parameter k, a positive integer.
    pub periods: Text,
    /// The parameter omega.
    pub frequency: Text,
}

/// A built-in or user-defined oscillator, as data: the same tree is expanded, integrated, classified and
/// printed. Dimensionless; `notes` says how it follows from the physical one.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The name on the command line.
    pub name: Text,
    /// One line.
    pub title: Text,
    /// The left side of equation = 0, as it is expanded.
    pub equation: Expression,
    /// The same equation with its formal functions written out, for integration in time; nothing
    /// when `equation` has none.
    pub time_domain: Option<Expression>,
    /// A wall with an impact law.
    pub impact: Option<Impact>,
    /// A delay tied to the force.
    pub synchronous: Option<Synchronous>,
    /// The name of the small parameter.
    pub small: Text,
    /// The conditions that make sense, the default first.
    pub conditions: Vec<Condition>,
    /// How an amplitude other than one enters.
    pub amplitude: AmplitudeRole,
    /// The parameters.
    pub parameters: Vec<ParameterCard>,
    /// How the dimensionless equation follows from the physical one, and what is known.
    pub notes: Text,
    /// Where it comes from.
    pub source: Text,
}
