//! The program as it is run: what it prints, writes and refuses.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod averaging;
mod book;
mod browser;
mod derive;
mod determinism;
mod errors;
mod evaluate;
mod faults;
mod file_motions;
mod foreign_text;
mod fuzz;
mod interrupt;
mod journal;
mod known_digits;
mod one_path;
mod outputs;
mod problem_files;
mod program;
mod proof;
mod simulate;
mod simulate_files;
mod stability;
mod threshold;
mod tiers;
mod trade;
mod verify;
mod written_code;
