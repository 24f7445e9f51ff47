//! What is derived against numbers from elsewhere.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod cycles;
mod delays;
mod enclosed_flows;
mod invariants;
mod limits;
mod normal_mode;
mod resonance;
mod sought;
mod symbols;
mod unit;
