//! Periodic orbits of the vibro-impact oscillator with a delay loop, the paper's prediction of
//! their stability by the Krylov-Bogoliubov-Mitropolsky method, and the truth.
//!
//! x'' + c x' + alpha^2 x = P0 cos(omega t) + A (x - x_T) + B (x' - x'_T), x <= s, x' -> -R_r x' at
//! x = s; x_T = x(t - T), T = 2 pi k/omega; one impact per T. All numbers are dimensionless.
//!
//! | module | what |
//! |---|---|
//! | [`parameters`] | the parameters, over doubles, balls, exact numbers |
//! | [`orbit`] | the true orbit, regular at every parameter |
//! | [`flow`], [`convergence`] | lambda_n = R_n + i alpha0_n of any order, the full root, the radius of convergence |
//! | [`equivalent`] | the orbit of an equivalent flow (8) |
//! | [`flight`] | penetration of the wall during the flight |
//! | [`map`], [`prediction`] | (16), (17), multipliers; variants E, P, S; the mismatch m |
//! | [`aware`] | KBM with kappa = 1 - 1/gamma |
//! | [`characteristic`], [`winding`], [`zeros`], [`flip`] | G(w), its zeros counted and enclosed, the flip boundary |
//! | [`linearised`] | the map of one flight and impact in symbols, linearised by formal differentiation |
//! | [`kick`] | the piecewise linear return map for B != 0 |
//! | [`report`], [`chart`] | one point, many points |
//!
//! Every formula is written once over [`Real`](lindstedt_number::real::Real) and runs in doubles (estimated: rounding errors
//! are not tracked) and in balls (certified: the radius bounds every error). What is estimated in
//! both says so.
//!
//! KBM replaces the delayed signal by e^(-lambda T) times the present one, as in free flight;
//! because an impact lies in every delay interval its region of stability is a prediction that
//! agrees with the truth in 58 to 69% of the points of eight orbits ([`characteristic`] decides).
//!
//! ```
//! use lindstedt_algebra::Stop;
//! use lindstedt_impact::parameters::{Branch, ExactParameters};
//! use lindstedt_number::Exact;
//! use lindstedt_impact::report::{Request, certified_stability};
//!
//! let number = |n, d| Exact::from((n, d));
//! let parameters = ExactParameters {
//!     alpha: number(1, 1), omega: number(13, 5), periods: 1, restitution: number(4, 5),
//!     wall: number(0, 1), damping: number(1, 20), force: number(1, 1),
//!     displacement_gain: number(2, 25), velocity_gain: number(0, 1), branch: Branch::Plus,
//! };
//! let report = certified_stability(&parameters, &Request::default(), 30, &Stop::default()).unwrap();
//! let velocity = report.orbit.unwrap().orbit.velocity;
//! assert!((velocity.ball().midpoint().to_f64() - 0.503_527_207_501_491_3).abs() < 1e-15);
//! assert!(velocity.ball().relative_accuracy_bits() > 100);
//! assert_eq!(report.exact.unwrap().zeros_in_unit_disc, Some(1)); // unstable
//! ```

pub mod aware;
pub mod characteristic;
pub mod chart;
pub mod convergence;
pub mod equivalent;
mod error;
pub mod flight;
pub mod flip;
pub mod flow;
pub mod kick;
mod lanes;
pub mod linearised;
pub mod map;
pub mod orbit;
pub mod parameters;
pub mod prediction;
pub mod propagator;
mod radius;
pub mod report;
mod velocity;
pub mod winding;
pub mod zeros;

pub use error::ImpactError;
pub use radius::{Finite, Radius, divergence};
