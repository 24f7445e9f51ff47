//! Problems as data: an oscillator is an expression tree, a small parameter, a condition that
//! fixes the amplitude, and a data card.

mod at_point;
mod canonical;
mod classification;
pub mod classify;
pub mod description;
mod expression;
mod half_turn;
mod methods;
pub mod monomials;
pub mod near_rest;
pub mod print;
mod problem;
mod quantity;
mod roots;
mod saddle;
mod smooth;
pub mod symmetry;
pub mod taylor;
mod unknown;
mod walk;

pub use canonical::AccelerationFault;
pub use expression::{Expression, Function, Unknown};
pub use problem::{
    AmplitudeRole, Condition, Crossing, Impact, ParameterCard, Problem, Synchronous, Text,
};
pub use quantity::Quantity;
pub use unknown::UnknownName;
pub use walk::Operations;
