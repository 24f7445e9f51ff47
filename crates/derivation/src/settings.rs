//! What is asked of a derivation.

use crate::error::DerivationError as Error;
use lindstedt_algebra::Stop;
use lindstedt_equation::{Condition, Problem, UnknownName};
use lindstedt_number::Exact;
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

/// What to derive.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The highest order.
    pub order: usize,
    /// The normalisation; the problem's default if nothing.
    pub condition: Option<Condition>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, Exact>,
    /// The memory that may be used, in bytes.
    pub memory: u64,
    /// How the series are derived.
    pub route: Route,
    /// Asked within the orders, and from the threads of parallel loops, whether to stop.
    pub stop: Stop,
}

impl Default for Settings {
    /// Order 4, the problem's own normalisation and parameters, 8 GiB.
    fn default() -> Self {
        Self {
            order: 4,
            condition: None,
            parameters: BTreeMap::new(),
            memory: 8 << 30,
            route: Route::default(),
            stop: Stop::default(),
        }
    }
}

/// How the series are derived.
///
/// ```
/// use lindstedt_derivation::{Route, Settings, derive};
/// let problem = lindstedt_problems::find("duffing").ok_or("no such problem")?;
/// let settings = Settings { order: 2, route: "energy".parse()?, ..Settings::default() };
/// let found = derive(&problem, &settings, &mut |_| true)?;
/// assert_eq!((found.route, found.solved()), (Route::EnergyIntegral, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Route {
    /// By the clock where the equation allows it, else by the driver.
    #[default]
    Automatic,
    /// By the driver: solution and frequency, checked by the residual.
    Driver,
    /// By the still part of the solution and one shift of its clock: conservative equations with logarithms whose
    /// solution depends on the Lambda_m so. The residual is proved zero by that dependence and at Lambda = 0.
    Clock,
    /// By the energy integral: the frequency alone, to much higher order; for forces
    /// x F(small ln x^2), and for polynomial ones where x(0) is the amplitude.
    EnergyIntegral,
    /// The frequency alone, and to higher order than with the solution: by the energy integral where that
    /// applies, and else modulo primes, as many as bounds of its numbers ask for that are known in advance.
    Frequency,
}

impl Route {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Automatic, Self::Driver, Self::Clock, Self::EnergyIntegral, Self::Frequency];

    /// `auto`, `driver`, `clock`, `energy`, `frequency`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automatic => "auto",
            Self::Driver => "driver",
            Self::Clock => "clock",
            Self::EnergyIntegral => "energy",
            Self::Frequency => "frequency",
        }
    }
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Route {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        UnknownName::find("route", text, &Self::ALL, Self::name)
    }
}

/// The normalisation asked for, if the problem offers it; its own if none is.
///
/// # Errors
/// [`Error::UnknownCondition`].
pub fn condition(problem: &Problem, asked: Option<Condition>) -> Result<Condition, Error> {
    let condition = match asked {
        None => problem.conditions.first().copied(),
        Some(asked) => problem.conditions.iter().copied().find(|c| *c == asked),
    };
    condition.ok_or_else(|| Error::UnknownCondition { problem: problem.name.to_string() })
}
