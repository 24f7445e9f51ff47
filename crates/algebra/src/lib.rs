//! The interfaces of the engine: rings whose *value* owns the context (precision, names) and
//! whose elements are bare data, and algebras of functions of the fast phase.
//!
//! The laws that an implementation must satisfy are shipped beside the traits in [`laws`];
//! every ring of the workspace runs them with one call.
#![warn(missing_docs)]

mod amplitudes;
mod clock;
pub mod laws;
mod measure;
mod phase;
mod ring;
mod stop;
mod stopping;

pub use amplitudes::{AmplitudeAlgebra, LinearPart, LinearParts, Split};
pub use clock::{ClockAlgebra, StillAndClock};
pub use measure::common_measure;
pub use phase::{
    Elementary, ForcedAlgebra, FunctionAlgebra, NEAR_MISS, PhaseAlgebra, PhaseError, Resolution,
    combination,
};
pub use ring::{Products, RationalAlgebra, Rationals, Ring, power};
pub use stop::Stop;
pub use stopping::Stopping;
