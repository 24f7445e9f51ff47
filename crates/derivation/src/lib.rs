//! From a problem with its values to checked series: the driver over its concrete algebras.
//!
//! | module | what | numbers |
//! |---|---|---|
//! | [`derive()`] | omega^2, omega, T/2pi and x_n, substituted back into the equation | exact |
//! | [`energy`] | the frequency alone, by the energy integral | exact |
//! | [`averaging`] | rates of amplitude and phase (Krylov, Bogoliubov, Mitropolsky) | exact, certified |
//! | [`resonance`] | slow flows at resonance and of several unknowns | exact |
//! | [`numeric`] | the same recursion over functions known by their values | estimated |
//! | [`constants`] | the constants of exact coefficients as balls | certified |
//!
//! A problem is prepared ([`prepare`]): values put in, x scaled by the amplitude, time by the linear
//! frequency. What is told and asked while it goes on is [`Work`] and [`Progress`].

pub mod averaging;
mod binding;
mod clock;
pub mod constants;
mod derivation;
mod derive;
pub mod energy;
mod error;
mod exponent;
mod found;
mod json;
mod limits;
pub mod numeric;
mod phase_functions;
pub mod prepare;
pub mod resonance;
mod series;
mod settings;
mod values;
mod work;

pub use binding::FORMAL;
pub use clock::ClockSolution;
pub use derivation::{Derivation, Solution};
pub use derive::derive;
pub use error::DerivationError;
pub use limits::{check_delays, check_parameters, has_logarithms, refuse_above};
pub use series::NamedSeries;
pub use settings::{Route, Settings, condition};
pub use values::{all_values, known_values, value};
pub use work::{Progress, Work};
