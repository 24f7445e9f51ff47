//! Perturbations of an orbit, and numbers with the orbit that they belong to.

use lindstedt_melnikov::{Damping, Forcing, Friction};
use lindstedt_number::Exact;

/// A number, or several, of one orbit.
#[derive(Clone, Debug)]
pub struct OrbitValue<T> {
    /// Which orbit.
    pub name: &'static str,
    /// The saddle it leaves, where it is followed numerically.
    pub saddle: Option<f64>,
    /// Of the threshold: gamma_c, D and F, in x.
    pub value: T,
}

/// eps (gamma forcing - T(y' - v*) - sum c g(y) y'^j).
#[derive(Clone, Debug)]
pub struct Perturbation {
    /// T.
    pub friction: Friction,
    /// Friction that depends on y.
    pub damping: Vec<Damping>,
    /// The force at unit amplitude of its lowest harmonic.
    pub forcing: Forcing,
    /// v*.
    pub belt_speed: Exact,
}
