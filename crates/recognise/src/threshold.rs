//! A threshold with the orbit that it is on.

use lindstedt_melnikov::Threshold;

/// The threshold on one orbit, in x.
#[derive(Clone, Debug)]
pub struct OrbitThreshold {
    /// Which orbit.
    pub name: &'static str,
    /// The saddle it leaves, where it is followed numerically.
    pub saddle: Option<f64>,
    /// gamma_c, D and F.
    pub threshold: Threshold,
}
