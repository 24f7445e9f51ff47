//! What is asked of a derivation.

use crate::error::DerivationError as Error;
use lindstedt_algebra::Stop;
use lindstedt_equation::{Condition, Problem};
use lindstedt_number::Exact;
use std::collections::BTreeMap;

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
