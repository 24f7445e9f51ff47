//! From the equation of a problem to what a method needs: Melnikov's potential, friction, forcing
//! and belt speed ([`MelnikovProblem`]), a saddle with a parameter that is sought ([`SaddleProblem`]), the impact
//! oscillator of section 2 ([`ImpactProblem`]).
//!
//! Terms are matched by what they are, multiplied out with the values of the parameters, never by
//! their names. A term that does not fit is named; nothing is dropped.

#![warn(clippy::too_many_lines)]

mod bound;
mod forces;
mod impact;
mod in_pi;
mod law;
mod local;
mod lowest;
mod melnikov;
mod motion;
mod numeric;
mod one_phase;
mod potential;
mod refusal;
mod saddle;
mod search;
mod splitting;
mod threshold;

pub use impact::{ImpactProblem, linear_in_time};
pub use lowest::LowestHarmonic;
pub use melnikov::{MelnikovProblem, Unperturbed};
pub use numeric::{NumericOrbit, OrbitCheck};
pub use one_phase::{OnePhase, PhaseCycle, Rates, Sticking};
pub use refusal::{Refusal, Why};
pub use saddle::SaddleProblem;
pub use splitting::{GAMMA, OrbitSplitting, SplittingProblem};
pub use threshold::OrbitThreshold;
