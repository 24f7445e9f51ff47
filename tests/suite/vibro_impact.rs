//! The averaged delay loop against the root that it expands, and the stability of the impact orbit
//! against the nonlinear delayed system in the time domain.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test fails by panicking

mod nonlinear;
mod series;
mod support;
