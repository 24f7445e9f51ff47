//! x(t) as data.

use lindstedt_number::{Exact, Number};
use lindstedt_series::resummation::Method;

/// x at one time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Displacement {
    /// The time.
    pub time: Exact,
    /// x(t); nothing where not one digit is supported (or x vanishes within the error).
    pub value: Option<Number>,
    /// x(t) as a double, for pictures.
    pub double: f64,
    /// The estimated error as a double; infinite where there is no estimate.
    pub error: f64,
}

/// x(t) at the times asked for.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Displacements {
    /// The order of the solution.
    pub order: usize,
    /// The methods that sum its series.
    pub methods: Vec<Method>,
    /// The times that were reached.
    pub points: Vec<Displacement>,
    /// Whether these are all.
    pub complete: bool,
}

impl Displacements {
    /// The methods as they are asked for.
    #[must_use]
    pub fn summed_by(&self) -> String {
        let methods: Vec<&str> = self.methods.iter().map(|m| m.name()).collect();
        methods.join(" or ")
    }
}
