//! The driver and its judge within the algebra: expansions to any order, written once over
//! [`lindstedt_algebra::PhaseAlgebra`], and the residual check that shares no code with it.

mod ahead;
mod bound;
mod clock;
mod compile;
mod driver;
mod error;
mod evaluator;
mod excitation;
mod expansion;
mod limit_cycle;
mod period;
mod residual;
mod residual_bound;
pub mod resonance;
mod size;
mod trace;

pub use bound::{Degrees, degrees, equation_denominator};
pub use clock::{
    ClockExpansion, ClockFrequency, ClockMean, check_clock, clock_variable, expand_clock,
};
pub use compile::{Binding, Equation, compile, compile_system};
pub use driver::{Known, Request, amplitude_reaction, expand, extend, leading_amplitude};
pub use error::ExpandError;
pub use excitation::Excitation;
pub use expansion::{Expansion, OrderWork};
pub use period::{Period, conservative_period};
pub use residual::{check, check_from, check_normalisation};
pub use residual_bound::{Expected, FrequencyBound, OrderNumbers, ResidualBound};
pub use trace::{Trace, partial_sums, trace};
