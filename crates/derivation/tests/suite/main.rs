//! What is derived against numbers from elsewhere.

mod cycles;
mod delays;
mod limits;
mod normal_mode;
mod resonance;
mod sought;
