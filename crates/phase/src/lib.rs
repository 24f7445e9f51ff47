//! Algebras of functions of the fast phase: trigonometric polynomials, the Lobachevsky ring, and
//! the Lobachevsky functions as numbers.

pub mod amplitudes;
pub mod collocation;
pub mod evaluate;
pub mod fourier;
pub mod half_turn;
pub mod lobachevsky;
pub mod lobachevsky_function;
pub mod modular;
pub mod print;
pub mod trigonometric;

pub use amplitudes::Amplitudes;
pub use collocation::Collocation;
pub use lobachevsky::Lobachevsky;
pub use modular::Modular;
pub use trigonometric::Trigonometric;
