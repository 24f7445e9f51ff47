//! The judge against closed forms, published orbits and itself.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod bifurcation;
mod bouncing;
mod common;
mod delay;
mod dense;
mod events;
mod linearisation;
mod periods;
mod poincare;
mod recurrences;
mod section_three;
mod stick_slip;
mod tangency;
mod zero_one;
