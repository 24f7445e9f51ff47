//! Melnikov's method against the reference numbers of `tests/data/stick-slip`.

mod closed_forms;
mod cycle;
mod double;
mod equations;
mod general;
mod hyperbolic;
mod paper;
mod second_order;
mod subharmonic;
mod support;
