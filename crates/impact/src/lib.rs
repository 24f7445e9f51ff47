//! work in progress
pub mod aware;
pub mod characteristic;
pub mod chart;
pub mod complex;
pub mod convergence;
pub mod equivalent;
pub mod error;
pub mod flight;
pub mod flip;
pub mod flow;
pub mod kick;
pub mod map;
pub mod orbit;
pub mod parameters;
pub mod prediction;
pub mod propagator;
pub mod real;
pub mod report;
mod velocity;
pub mod winding;
pub mod zeros;

pub use error::ImpactError;
