//! What is derived against numbers from elsewhere.

mod resonance;
