//! Melnikov's method against the reference numbers of `tests/data/stick-slip`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

#[path = "melnikov/closed_forms.rs"]
mod closed_forms;
#[path = "melnikov/double.rs"]
mod double;
#[path = "melnikov/general.rs"]
mod general;
#[path = "melnikov/hyperbolic.rs"]
mod hyperbolic;
#[path = "melnikov/paper.rs"]
mod paper;
#[path = "melnikov/subharmonic.rs"]
mod subharmonic;
#[path = "melnikov/support.rs"]
mod support;
