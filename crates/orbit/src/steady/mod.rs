//! Steady states of polynomial vector fields w' = G(w; p): slow flows of oscillators at resonance, whose steady states are
//! periodic responses.
//!
//! * **All** of them in a box, with proof of their number: subdivision with an interval test ([`all_zeros`]); a box
//!   that has them all ([`bound`]).
//! * Branches over any parameter, with the exponents of every point ([`follow`]); all that pass given values, closed ones
//!   too ([`Survey`]).
//! * Folds, Hopf points, cusps, Bogdanov-Takens points: zeros of larger polynomial systems, proved by the same test
//!   ([`Flow::change_near`]); their curves over two parameters ([`Plane`]).
//! * Motions that are steady but for a phase that the flow leaves free, and their families ([`FreePhase`]).
//! * Where a start state goes ([`settle`]).
//!
//! ```
//! use lindstedt_number::interval::Interval;
//! use lindstedt_orbit::steady::{ComplexTerm, Flow, Limits, all_zeros};
//! use rug::Rational;
//! // Primary resonance of Duffing's oscillator, w' = -(i/4) F - mu w - i s w + (3/2) i w^2 conj w,
//! // at mu = 1/10, s = 1, F = 1: three steady states.
//! let term = |powers: [u32; 2], re: (i32, i32), im: (i32, i32)| ComplexTerm {
//!     amplitudes: powers.to_vec(), parameters: vec![], re: re.into(), im: im.into(), radius: 0.0,
//! };
//! let flow = Flow::of_complex(&[vec![
//!     term([0, 0], (0, 1), (-1, 4)),
//!     term([1, 0], (-1, 10), (-1, 1)),
//!     term([2, 1], (0, 1), (3, 2)),
//! ]], &[]);
//! let found = all_zeros(&flow.system(&[]), &[Interval::new(-2.0, 2.0); 2], &Limits::default()).ok_or("shape")?;
//! assert!(found.is_proved());
//! assert_eq!(found.zeros.len(), 3);
//! # Ok::<(), &str>(())
//! ```

mod balance;
mod branch;
mod change;
mod flow;
mod krawczyk;
mod plane;
mod polynomial;
mod quiet;
mod relative;
mod search;
mod settle;
mod survey;
mod value;

pub use balance::outermost;
pub use branch::{Branch, Course, Point, follow, state_at};
pub use flow::{Change, ComplexTerm, Flow};
pub use krawczyk::{Region, Zero, zero_near};
pub use plane::{Curve, Diagram, Plane};
pub use polynomial::{Polynomial, System};
pub use quiet::all_states;
pub use relative::{FreePhase, Turning};
pub use search::{Found, Limits, all_zeros, bound};
pub use settle::{Fate, settle};
pub use survey::{Located, Response, Survey};
pub use value::Value;
