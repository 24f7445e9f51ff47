//! What holds across the crates. One binary: it is linked once, and its tests share what they compute.

mod averaging;
mod classics;
mod clock;
mod clock_expansion;
mod closed_forms;
mod estimates;
mod evaluate;
mod extremes;
mod facade;
mod friction;
mod homoclinic;
mod interruption;
mod lateness;
mod laws;
mod melnikov;
mod module_circles;
mod multimodular;
mod numeric;
mod paper;
mod paper_section_2;
mod problem_files;
mod respond;
mod slow_flows;
mod small_delta;
mod threads;
mod vibro_impact;
