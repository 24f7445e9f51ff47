//! Coefficients of expansions: polynomials in named constants over Q, their closed forms, and
//! real balls (midpoint and rigorous radius) that evaluate them to any number of digits.

pub mod amplitude;
pub mod ball;
pub mod closed_forms;
pub mod digits;
pub mod floats;
pub mod parameters;
pub mod polynomial;
pub mod print;
pub mod sparse;

pub use polynomial::{Polynomial, PolynomialRing, PowerProduct, Symbol};
