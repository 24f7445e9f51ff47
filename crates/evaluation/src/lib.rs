//! Derived series as numbers: the period by resummation beside its closed form, x(t) at given times,
//! averaged motions.
//!
//! | module | what |
//! |---|---|
//! | [`setting`] | a problem with a value for everything, and the form of its equation |
//! | [`source`] | the series of T/2pi at a point: coefficients, variable, closed form |
//! | [`period()`] | the sum of that series |
//! | [`Trajectory`] | x(t), summed phase by phase |
//! | [`compiled`] | the frequency as a function of the small parameter and the amplitude |
//! | [`SolutionFunction`] | x(t) as a function of them, too |
//! | [`Expansion`] | x(t) and omega as polynomials in them, cut off |
//! | [`PeriodicSolution`] | x(t) by its harmonics, for many times |
//! | [`averaged`] | a(t), psi(t), x(t) of an averaged oscillator |
//! | [`rotating`] | a slow flow at resonance in the frame in which it is autonomous |
//!
//! What is summed is estimated, with its error; closed forms ([`closed`]) are certified.

#![warn(clippy::too_many_lines)]

pub mod averaged;
pub mod closed;
pub mod coefficients;
pub mod compiled;
mod digits;
mod displacements;
mod error;
mod expansion;
pub mod few;
mod fourier;
mod json;
mod names;
mod period;
mod periodic;
mod phases;
pub mod rotating;
pub mod setting;
mod solution;
mod solution_function;
pub mod source;
pub mod tongue;
mod words;

pub use displacements::{Displacement, Displacements};
pub use error::EvaluationError;
pub use expansion::{Carried, Expansion};
pub use fourier::Fourier;
pub use json::Place;
pub use names::{kind_name, method_name, rounded, with_error};
pub use period::{Evaluation, Improved, Stability, default_order, period};
pub use periodic::PeriodicSolution;
pub use solution::{Question, Trajectory, default_solution_order};
pub use solution_function::SolutionFunction;
