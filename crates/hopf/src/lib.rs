//! Hopf points of delay equations, and the cycle that is born there, to any order.

#![warn(clippy::too_many_lines)]

mod complex;
mod cycle;
mod equation;
mod error;
mod exact;
mod pi;
mod residual;
mod search;
mod series;
#[cfg(test)]
mod tests;
mod winding;

pub use complex::Pair;
pub use cycle::{Coefficient, HarmonicNumber, HopfCycle, HopfSettings, Law, Step, cycle};
pub use equation::{DelayEquation, Factor, Field, PI, Term};
pub use error::HopfError;
pub use pi::{InPi, PiField};
pub use search::{HopfPoint, HopfPoints};
pub use series::Cycle;
