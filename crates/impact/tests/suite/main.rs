//! Periodic impact orbits and their stability against independent numbers and methods.
#![allow(clippy::unwrap_used, clippy::panic)]

mod collocation;
mod oracles;
mod support;
