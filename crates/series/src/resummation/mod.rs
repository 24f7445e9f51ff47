//! Values of a function from the coefficients of its power series: partial sums, Pade, change
//! of variable, conformal map, Borel and Pade.
//!
//! Everything here is *estimated*: the error is measured by the agreement of neighbouring
//! approximants, not proved.

mod borel;
mod choose;
mod compiled;
pub mod complex;
mod error;
mod estimate;
mod formula;
mod fraction;
mod growth;
mod linear;
mod made;
mod maps;
mod method;
mod once;
mod pade;
mod partial;
mod prepared;
mod shared;
mod singularity;
mod staircase;

pub use borel::borel_transform;
pub use choose::{Resummed, resum, resum_with};
pub use compiled::{Compiled, Estimated};
pub use complex::Complex;
pub use error::ResummationError;
pub use estimate::{Estimate, Outcome, Tentative};
pub use growth::{Growth, growth};
pub use maps::Map;
pub use method::{Method, Sample, UniformMap};
pub use pade::{Pade, Picture, Pole, partial_sums};
pub use shared::Shared;
pub use singularity::{Kind, Singularity, nearest_singularity};
