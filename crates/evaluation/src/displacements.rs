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
    /// The methods that sum its series; none where Newton's method gave more digits.
    pub methods: Vec<Method>,
    /// The times that were reached.
    pub points: Vec<Displacement>,
    /// Whether these are all.
    pub complete: bool,
}

impl Displacement {
    /// x at a time, with its estimated error.
    #[must_use]
    pub fn new(time: Exact, value: Option<Number>, double: f64, error: f64) -> Self {
        Self { time, value, double, error }
    }
}

impl Displacements {
    /// x by Newton's method in Fourier space, where it gave more digits than the sum of this order.
    #[must_use]
    pub fn by_newton(order: usize, points: Vec<Displacement>, complete: bool) -> Self {
        Self { order, methods: Vec::new(), points, complete }
    }

    /// Whether no series was summed: by Newton's method.
    #[must_use]
    pub fn is_by_newton(&self) -> bool {
        self.methods.is_empty()
    }

    /// The methods as they are asked for.
    #[must_use]
    pub fn summed_by(&self) -> String {
        if self.is_by_newton() {
            return "newton".to_owned();
        }
        let methods: Vec<&str> = self.methods.iter().map(|m| m.name()).collect();
        methods.join(" or ")
    }
}
