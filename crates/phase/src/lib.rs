//! Algebras of functions of the fast phase: trigonometric polynomials, the Lobachevsky ring, and
//! the Lobachevsky functions as numbers.

pub mod lobachevsky;
pub mod print;
pub mod trigonometric;

pub use lobachevsky::Lobachevsky;
pub use trigonometric::Trigonometric;
