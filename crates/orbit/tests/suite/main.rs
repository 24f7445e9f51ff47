//! Proved orbits against closed forms, Taylor integration and themselves.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod classics;
mod common;
mod families;
mod functions;
mod random;
mod several;
mod sharpness;
mod steady;
