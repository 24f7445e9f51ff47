//! The independent judge in the time domain: Taylor series of any order in f64 or at any
//! precision, events on the series to the last digits, impacts, sticking, constant delays and the
//! linearisation through all of them.
//!
//! It shares nothing with the expansions that it judges but the expression tree of the problem.
//!
//! A [`Model`] (expressions, walls, sections, history) is compiled for one arithmetic
//! ([`Doubles`] or [`Digits`]) and one set of [`Parameters`] into a [`System`]; an [`Integrator`]
//! runs on it and tells an observer of every [`Segment`] (a Taylor polynomial per state) and every
//! [`Event`]. [`Trajectory`] keeps the polynomials, [`monodromy`] returns the derivative of the flow,
//! [`estimate`] the error of anything by a run with more digits. All results are estimated: the
//! truncation error of every step is kept at the tolerance by the last two coefficients and
//! checked by the residual at its end, rounding errors are not bounded.
//!
//! ```
//! use lindstedt_equation::{Crossing, Expression, Impact};
//! use lindstedt_simulate::{
//!     Doubles, Integrator, Model, Parameters, Quantity, Report, Settings, go_on,
//! };
//!
//! // x'' = -x with a wall at x = -1/2 that gives back R of the speed.
//! let wall = Impact {
//!     position: Expression::parameter("s"),
//!     crossing: Crossing::Falling,
//!     restitution: Expression::parameter("R"),
//! };
//! let equation = Expression::ACCELERATION + Expression::DISPLACEMENT;
//! let model = Model::second_order(&equation)?.with_wall(wall);
//! let value = |text| Quantity::parse(text).unwrap_or(Quantity::from(0));
//! let parameters = Parameters::new().with("s", value("-1/2")).with("R", value("0.999"));
//! let system = model.compile(Doubles, &parameters)?;
//! let mut flow = Integrator::new(&system, &0.0, &[1.0, 0.0], Settings::for_digits(16))?;
//! let mut times = Vec::new();
//! flow.advance(&3.0, &mut |report| {
//!     if let Report::Event(event) = report {
//!         times.push(*event.time);
//!     }
//!     go_on()
//! })?;
//! assert!((times[0] - 2.0 * std::f64::consts::PI / 3.0).abs() < 1e-15);
//! # Ok::<(), lindstedt_simulate::SimulateError>(())
//! ```

mod bifurcation;
mod branch;
mod compile;
mod continuation;
mod course;
mod crossing;
mod digits;
mod error;
mod estimate;
mod events;
mod impact;
mod integrator;
mod keeper;
mod linear;
mod local;
mod lyapunov;
mod onset;
mod outcome;
mod past;
mod poincare;
mod power;
mod probe;
mod puiseux;
mod quantity;
mod report;
mod roots;
mod saddle;
mod second_order;
mod segment;
mod series;
mod switching;
mod system;
mod tangency;
mod tangent;
mod tape;
mod trajectory;
mod zero_one;

pub use bifurcation::{Column, DiagramSettings, Sweep, diagram};
pub use continuation::continue_tangency;
pub use course::{Course, Dot, End, Moment, Occurrence, align, cut};
pub use digits::Digits;
pub use error::{SimulateError, Surface};
pub use estimate::{Computation, Estimated, estimate};
pub use integrator::real::{Doubles, Places, Real};
pub use integrator::{Integrator, Next, Observer, Settings, Tick, Together, go_on};
pub use keeper::{Cut, Flow, Plan};
pub use linear::{Monodromy, monodromy};
pub use lyapunov::{
    LyapunovExponent, LyapunovSettings, largest_lyapunov_exponent, largest_lyapunov_exponents,
};
pub use poincare::{PoincareMap, Point, Section};
pub use quantity::{Parameters, Quantity};

pub use onset::TangencyLine;
pub use outcome::Outcome;
pub use report::{Event, EventKind, Report, Segment, Work};
pub use saddle::{Saddle, saddle};
pub use system::{Model, System};
pub use tangency::{Homoclinic, Loop, Return, Tangency};
pub use trajectory::Trajectory;
pub use zero_one::{ZeroOne, is_in_bands, is_stationary, recurs, zero_one};
