//! What holds across the crates. One binary: it is linked once, and its tests share what they compute.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

mod averaging;
mod classics;
mod clock;
mod clock_expansion;
mod closed_forms;
mod delays;
mod estimates;
mod evaluate;
mod extremes;
mod facade;
mod friction;
mod homoclinic;
mod hopf;
mod interruption;
mod lateness;
mod laws;
mod melnikov;
mod module_circles;
mod multimodular;
mod numeric;
mod one_phase;
mod paper;
mod paper_section_2;
mod problem_files;
mod report;
mod respond;
mod slow_flows;
mod small_delta;
mod threads;
mod traps;
mod vibro_impact;
