//! Oscillations that are one function of a clock.

use crate::{FunctionAlgebra, PhaseAlgebra, Ring};

/// A phase algebra C\[f, Lambda_1, Lambda_2, ...\] over an algebra of *still* functions f with the logarithm l of
/// the secant, in which Lambda_m' = l^m/m! - mu_m: what it takes to expand an oscillation that depends on all
/// Lambda_m through one shift of the clock.
///
/// Laws: `pace` is linear and still, its value at psi = 0 is 0; `split_clock` undoes
/// f -> f + sin psi sum c_m Lambda_m for a still f and nothing else.
pub trait ClockAlgebra: PhaseAlgebra {
    /// sum_m c_m l^m/m! for the numbers c_1, c_2, ...
    fn pace(&self, numbers: &[<Self::Constants as Ring>::Element]) -> Self::Element;
    /// (f, \[c_1, c_2, ...\]) for f + sin psi sum_m c_m Lambda_m with a still f, without trailing zeros;
    /// nothing for any other function.
    fn split_clock(&self, f: &Self::Element) -> Option<StillAndClock<Self>>;
}

/// A still function and the numbers of the clock beside it.
pub type StillAndClock<A> =
    (<A as Ring>::Element, Vec<<<A as FunctionAlgebra>::Constants as Ring>::Element>);
