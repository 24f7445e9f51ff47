//! Periodic orbits in Fourier space: Newton's method to any number of digits, and the proof that
//! exactly one orbit is within a radius of the numbers.
//!
//! x'' = g(x, x', t), one unknown or several, g made of polynomials, rational powers, sines, cosines and
//! exponentials ([`Field`]), tau = omega t, x = sum_k c_k e^(i k tau):
//!
//! F(omega, x) = omega^2 d^2x/dtau^2 - g(x, omega dx/dtau, tau) = 0.
//!
//! [`prove`] takes a guess ([`Start`]: an expansion's sum, a simulation, one harmonic), improves it by
//! Newton's method and checks the hypotheses of a contraction argument ([`Bounds`]). A [`Proof`]
//! encloses frequency, period, initial state, extrema, x(t) and the Floquet exponent; a
//! [`Failure`] names the bound that failed, with its number. Whether any expansion converges plays
//! no part.
//!
//! Three tiers of arithmetic. Coefficients of the solution are integers over a power of 2 and every
//! residual is formed *exactly*, by products of long integers: no rounding to argue about (functions of
//! the solution are enclosed by what ties them to their argument, formed exactly as well). The
//! linear algebra is in doubles with a-priori bounds of its rounding errors. What is enclosed at the end
//! is in balls.
//!
//! ```
//! use lindstedt_equation::Expression;
//! use lindstedt_number::digits::decimal;
//! use lindstedt_orbit::{Field, Kind, Request, Stability, Start, prove};
//! // Van der Pol, x'' + x + (x^2 - 1) x' = 0, from the guess 2 cos(0.94 t).
//! let (x, y) = (Expression::DISPLACEMENT, Expression::VELOCITY);
//! let field = Field::new(&(Expression::ACCELERATION + x.clone() + (x.pow(2) - 1) * y), "eps", &Default::default())?;
//! let start = Start { frequency: 0.94, cosines: vec![0.0, 2.0], sines: vec![] };
//! let request = Request { digits: 30, ..Request::default() };
//! let proof = prove(&field, &Kind::LimitCycle, &start, &request)?;
//! assert_eq!(decimal(&proof.period, 30).as_deref(), Some("6.66328685932313018969968203048"));
//! assert_eq!(proof.stability, Stability::Stable);
//! # Ok::<(), lindstedt_orbit::Failure>(())
//! ```

mod bounds;
mod centre;
mod doubles;
mod drift;
mod eigenvalues;
mod exact;
mod failure;
mod family;
mod field;
mod function;
mod guesses;
mod laurent;
mod linear;
mod modes;
mod newton;
mod operation;
mod orbit;
mod place;
mod polynomial;
mod product;
mod proof;
mod prove;
mod radii;
mod read;
mod reader;
mod sine;
mod space;
mod start;
pub mod steady;
mod sum;
mod task;
#[cfg(test)]
mod tests;
mod transform;
mod upward;
mod write;

pub use failure::Failure;
pub use family::{Branch, Cover, Member, branches, cover, family, prove_each};
pub use field::Field;
pub use guesses::guesses;
pub use modes::guesses_all;
pub use proof::{Motion, Proof, Stability, Status};
pub use prove::{Approximation, approximate, prove, prove_all};
pub use radii::Bounds;
pub use sine::Sine;
pub use space::Parity;
pub use start::Start;
pub use task::{Kind, Request};

pub(crate) use task::{Condition, Rows};
