//! work in progress
pub mod characteristic;
pub mod complex;
pub mod convergence;
pub mod equivalent;
pub mod error;
pub mod flight;
pub mod flow;
pub mod map;
pub mod orbit;
pub mod parameters;
pub mod propagator;
pub mod real;
pub mod prediction;
mod velocity;
pub mod winding;
