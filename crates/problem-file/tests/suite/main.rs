//! Equations and problem files, read and refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod equations;
mod follows;
