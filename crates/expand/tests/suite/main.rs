//! The engine's methods on whole equations.

mod clock;
mod resonance;
