//! Coefficients of expansions: polynomials in named constants over Q and their closed forms.

pub mod amplitude;
pub mod closed_forms;
mod constant;
pub mod floats;
pub mod packed;
pub mod parameters;
pub mod polynomial;
mod power_product;
pub mod print;
mod product;
pub mod quotient;
pub mod sparse;

pub use constant::constant;
pub use polynomial::{Polynomial, PolynomialRing, PowerProduct, Symbol};
