//! Problems as data: an oscillator is an expression tree, a small parameter, a condition that
//! fixes the amplitude, and a data card.

mod expression;
pub mod print;
mod problem;

pub use expression::{Expression, Function};
pub use problem::{
    AmplitudeRole, Condition, Crossing, Impact, ParameterCard, Problem, Synchronous, Text,
};
