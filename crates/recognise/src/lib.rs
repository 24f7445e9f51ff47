//! From the equation of a problem to what a method needs: Melnikov's potential, friction, forcing
//! and belt speed ([`MelnikovProblem`]), a parameter that is sought to first order ([`PersistenceProblem`]) and to any
//! ([`SaddleProblem`]), an equation with delays about its equilibrium ([`delay_equation`]), the impact
//! oscillator of section 2 ([`ImpactProblem`]).
//!
//! Terms are matched by what they are, multiplied out with the values of the parameters, never by
//! their names. A term that does not fit is named; nothing is dropped.

#![warn(clippy::too_many_lines)]

mod bound;
mod factors;
mod forces;
mod hopf;
mod impact;
mod in_pi;
mod law;
mod local;
mod lowest;
mod melnikov;
mod motion;
mod numeric;
mod one_phase;
mod persistence;
mod potential;
mod reading;
mod refusal;
mod saddle;
mod search;
mod splitting;
mod threshold;

pub use hopf::delay_equation;
pub use impact::{ImpactProblem, linear_in_time};
pub use lowest::LowestHarmonic;
pub use melnikov::MelnikovProblem;
pub use numeric::{NumericOrbit, OrbitCheck};
pub use one_phase::{OnePhase, PhaseCycle, PhaseCycles, Rates, Sticking};
pub use persistence::{PersistenceProblem, Persistent};
pub use reading::Unperturbed;
pub use refusal::{Refusal, Why};
pub use saddle::SaddleProblem;
pub use splitting::{GAMMA, OrbitSplitting, SplittingProblem};
pub use threshold::{OrbitValue, Perturbation};
