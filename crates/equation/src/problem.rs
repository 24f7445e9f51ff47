//! A problem: an equation with what is needed to expand it and to talk about it.

use crate::Expression;

/// What fixes the amplitude (and the phase) of the solution, order by order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// x(0) = 1, x'(0) = 0: corrections start at rest at zero ("initial amplitude").
    InitialAmplitude,
    /// The first harmonic of x is cos psi: corrections have no first harmonic.
    FundamentalAmplitude,
    /// A limit cycle with x'(0) = 0; its amplitude x(0) is determined order by order.
    LimitCycle,
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
    /// It is part of the small parameter; a is not zero.
    InSmallParameter,
    /// The equation determines it.
    Determined,
}

/// One line of a data card.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterCard {
    /// The name on the command line.
    pub name: &'static str,
    /// What it is, with its domain; all parameters are dimensionless unless a unit is given.
    pub meaning: &'static str,
    /// The default value, as the user would write it.
    pub default: &'static str,
}

/// A built-in or user-defined oscillator.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The name on the command line.
    pub name: &'static str,
    /// One line.
    pub title: &'static str,
    /// The left side of equation = 0.
    pub equation: Expression,
    /// The name of the small parameter.
    pub small: &'static str,
    /// The conditions that make sense, the default first.
    pub conditions: Vec<Condition>,
    /// How an amplitude other than one enters.
    pub amplitude: AmplitudeRole,
    /// The parameters.
    pub parameters: Vec<ParameterCard>,
    /// How the dimensionless equation follows from the physical one, and what is known.
    pub notes: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}
