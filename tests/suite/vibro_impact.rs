//! The averaged delay loop against the root that it expands, and the stability of the impact orbit
//! against the nonlinear delayed system in the time domain.

mod nonlinear;
mod series;
mod support;
