//! The engine's methods on whole equations.

mod resonance;
