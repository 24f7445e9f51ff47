//! The judge against closed forms, published orbits and itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test fails by panicking

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
