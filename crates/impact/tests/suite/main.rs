//! Periodic impact orbits and their stability against independent numbers and methods.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod agreement;
mod collocation;
mod doubles;
mod extremes;
mod growth;
mod oracles;
mod support;
mod truth;
mod winding;
