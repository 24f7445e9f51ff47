//! The independent judge in the time domain: Taylor series of any order in f64 or at any
//! precision, events on the series to the last digits, impacts, sticking, constant delays and the
//! linearisation through all of them.
//!
//! It shares nothing with the expansions that it judges but the expression tree of the problem.

mod bifurcation;
mod branch;
mod compile;
mod digits;
mod error;
mod estimate;
mod events;
mod impact;
mod integrator;
mod linear;
mod past;
mod poincare;
mod power;
mod quantity;
mod real;
mod report;
mod roots;
mod second_order;
mod segment;
mod series;
mod switching;
mod system;
mod tangent;
mod tape;
mod trajectory;

pub use bifurcation::{Column, DiagramSettings, Sweep, diagram};
pub use digits::Digits;
pub use error::{SimulateError, Surface};
pub use estimate::{Computation, Estimated, estimate};
pub use integrator::{Integrator, Observer, Settings};
pub use linear::{Monodromy, monodromy};
pub use poincare::{PoincareMap, Point, Section};
pub use quantity::{Parameters, Quantity};
pub use real::{Doubles, Real};
pub use report::{Event, EventKind, Outcome, Report, Segment, Work};
pub use system::{Model, System};
pub use trajectory::{Occurrence, Trajectory};
