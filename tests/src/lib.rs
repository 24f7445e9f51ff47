//! Shared helpers of the integration tests.

pub mod budget;
pub mod examples;
pub mod mathematics;
pub mod measure;
mod random;

use lindstedt::{
    Derivation, Quantity, unstable::derivation::Settings, unstable::derivation::derive,
    unstable::problems,
};
pub use random::Random;

/// The checked expansion of a built-in problem with its default settings, to an order.
///
/// # Panics
/// When the derivation fails: a test without its expansion has nothing to test.
#[allow(clippy::panic)]
pub fn expansion(name: &str, order: usize) -> Derivation {
    with(name, Settings { order, ..Settings::default() })
}

/// The checked expansion of a built-in problem.
///
/// # Panics
/// When the derivation fails.
#[allow(clippy::panic)]
pub fn with(name: &str, settings: Settings) -> Derivation {
    let Some(problem) = problems::find(name) else { panic!("no problem {name}") };
    match derive(&problem, &settings, &mut |_| true) {
        Ok(result) => result,
        Err(error) => panic!("{name}: {error}"),
    }
}

/// Coefficient n of a series as a decimal.
///
/// # Panics
/// When the series or the digits do not exist.
#[allow(clippy::panic)]
pub fn decimal(result: &Derivation, series: Quantity, n: usize, digits: usize) -> String {
    match result.number(series, n, digits) {
        Ok(number) => number.decimal,
        Err(error) => panic!("{series} {n}: {error}"),
    }
}
