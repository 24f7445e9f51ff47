//! What can be asked of an expansion.

use crate::Condition;
use crate::unknown::UnknownName;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// What can be asked of an expansion. Its text is the key in JSON and the word in `asked` of a file.
///
/// ```
/// use lindstedt_equation::Quantity;
/// assert_eq!("period_over_2pi".parse(), Ok(Quantity::Period));
/// assert_eq!(Quantity::FrequencySquared.to_string(), "frequency_squared");
/// assert!("phase".parse::<Quantity>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// omega.
    Frequency,
    /// omega^2.
    FrequencySquared,
    /// T/2pi = 1/omega.
    Period,
    /// x(0) of a limit cycle.
    Amplitude,
    /// x(0), where the first harmonic is fixed.
    InitialDisplacement,
    /// The Floquet exponent of a limit cycle that is not 0.
    FloquetExponent,
    /// a'/a of an averaged motion.
    GrowthRate,
    /// x as a function of the phase.
    Solution,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Frequency,
        Self::FrequencySquared,
        Self::Period,
        Self::Amplitude,
        Self::InitialDisplacement,
        Self::FloquetExponent,
        Self::GrowthRate,
        Self::Solution,
    ];
    /// omega^2, omega and T/2pi.
    pub const POWERS: [Self; 3] = [Self::FrequencySquared, Self::Frequency, Self::Period];

    /// `frequency`, `frequency_squared`, `period_over_2pi`, `amplitude`, `initial_displacement`,
    /// `floquet_exponent`, `growth_rate`, `solution`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::FrequencySquared => "frequency_squared",
            Self::Period => "period_over_2pi",
            Self::Amplitude => "amplitude",
            Self::InitialDisplacement => "initial_displacement",
            Self::FloquetExponent => "floquet_exponent",
            Self::GrowthRate => "growth_rate",
            Self::Solution => "solution",
        }
    }

    /// The power of 1/t that it is: 2, 1 or -1; 0 for what is none.
    #[must_use]
    pub const fn power(self) -> i32 {
        match self {
            Self::FrequencySquared => 2,
            Self::Frequency | Self::FloquetExponent => 1,
            Self::Period => -1,
            _ => 0,
        }
    }

    /// x(0), where the condition leaves it open.
    #[must_use]
    pub const fn start(condition: Condition) -> Option<Self> {
        match condition {
            Condition::InitialAmplitude => None,
            Condition::FundamentalAmplitude | Condition::FreeAmplitude => {
                Some(Self::InitialDisplacement)
            }
            Condition::LimitCycle => Some(Self::Amplitude),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Quantity {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        UnknownName::find("quantity", text, &Self::ALL, Self::name)
    }
}

impl Serialize for Quantity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
