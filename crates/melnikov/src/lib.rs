//! Melnikov's method with dry friction: from a potential with a known homoclinic or heteroclinic
//! orbit, a friction law and a forcing to the threshold of transversal homoclinic points.
//!
//! With x'' = f(x) + eps (gamma g(x) cos(omega t) - T(x' - v*) - sum c g(x) x'^j) the Melnikov function of the orbit x0 is
//! M(t0) = gamma F(omega t0) - D, and M has simple zeros if and only if gamma exceeds
//! gamma_c = D/max F (D > 0) or D/min F (D < 0). Everything exact is computed in the algebra
//! Q[sech, tanh] or in closed form and evaluated in balls with proved radii; everything else
//! carries an estimated error. The mathematics is in `docs/src/melnikov.md`.

mod along;
mod crossing;
mod cycle;
mod dissipation;
mod elliptic;
mod error;
mod factor;
mod fast;
mod forcing;
mod friction;
mod homoclinic;
pub mod hyperbolic;
mod orbit;
mod parameters;
mod potential;
pub mod quadrature;
mod root;
pub mod splitting;
mod stick_slip;
mod subharmonic;
mod surface;
mod system;
mod zeros;

pub use cycle::{BeltCycle, belt_cycles, sticking_begins};
pub use dissipation::{damping_work, polynomial_dissipation, quadrature_dissipation};
pub use elliptic::Elliptic;
pub use error::MelnikovError;
pub use factor::{Damping, Factor, LARGEST_POWER};
pub use fast::FastThreshold;
pub use forcing::{Forcing, ForcingWork, Harmonic};
pub use friction::{Friction, LARGEST_DEGREE, Law, PolynomialFriction};
pub use homoclinic::{HomoclinicOrbit, PerturbationTerm, Saddle};
pub use orbit::{Monomial, OrbitDescription, check_pendulum, check_phi_six};
pub use parameters::{Axis, FastPoint, StickSlip};
pub use potential::{Branch, Potential};
pub use root::enclose_root;
pub use subharmonic::{Region, Subharmonic, subharmonic};
pub use surface::surface;
pub use system::{Class, System, Threshold, Validity, Verdict};
pub use zeros::ParameterZeros;
