//! Proved orbits against closed forms, Taylor integration and themselves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test fails by panicking

mod classics;
mod common;
mod families;
mod functions;
mod random;
mod several;
mod sharpness;
