//! The quadratic equation for the impact velocity, with every way it can fail.

use crate::error::ImpactError;
use crate::parameters::Branch;
use lindstedt_number::real::Real;

/// Relative size of |kappa + i q| omega below which the orbit is at an impact resonance (doubles).
const RESONANCE: f64 = 1e-12;
/// Relative velocity below which the impact grazes.
const GRAZING: f64 = 1e-8;

/// a v^2 + 2 h v + g = 0 with a >= 0, all divided by F^2: a = (kappa^2 + q^2)/F^2, h = s kappa/F^2,
/// g = (s^2 - F^2)/F^2.
pub(crate) struct VelocityEquation<S> {
    pub(crate) quadratic: S,
    pub(crate) half_linear: S,
    pub(crate) constant: S,
    /// h^2 - a g, formed without cancellation by the caller.
    pub(crate) discriminant: S,
    /// (kappa^2 + q^2) omega^2 has the size of this number times `quadratic`.
    pub(crate) resonance_scale: f64,
    /// min(omega F, P0 T).
    pub(crate) velocity_scale: f64,
}

/// v = (-h +- sqrt(disc))/a, by g/(-h -+ sqrt(disc)) where that does not cancel.
#[inline(always)]
pub(crate) fn impact_velocity<S: Real>(
    equation: &VelocityEquation<S>,
    branch: Branch,
) -> Result<S, ImpactError> {
    let VelocityEquation { quadratic: a, half_linear: h, constant: g, discriminant, .. } = equation;
    let size = |a: f64| a * equation.resonance_scale;
    let out_of_range =
        || ImpactError::Undecided { what: "the impact velocity", bits: a.precision() };
    if a.holds(|a| size(a).is_finite()) != Some(true) {
        return Err(out_of_range());
    }
    if a.sign().is_none_or(|sign| sign.is_eq())
        || a.holds(|a| size(a).sqrt() < RESONANCE) != Some(false)
    {
        return Err(ImpactError::ImpactResonance { size: size(a.to_f64()) });
    }
    if discriminant.is_negative() {
        return Err(ImpactError::BeyondFold { discriminant: discriminant.to_f64() });
    }
    let root = discriminant.sqrt();
    let h_positive = h.holds(|h| h > 0.0).ok_or_else(out_of_range)?;
    let velocity = match (branch, h_positive) {
        (Branch::Plus, false) => (root - h) / a,
        (Branch::Plus, true) => -(g.clone() / (root + h)),
        (Branch::Minus, true) => -((root + h) / a),
        (Branch::Minus, false) => g.clone() / (root - h),
    };
    if !velocity.is_finite() {
        return Err(out_of_range());
    }
    if !velocity.is_positive() {
        let undecided = velocity.sign().is_none();
        if undecided && velocity.to_f64().abs() < GRAZING * equation.velocity_scale {
            return Err(grazing(&velocity, equation.velocity_scale));
        }
        return Err(ImpactError::NoPositiveVelocity { velocity: velocity.to_f64() });
    }
    if velocity.holds(|v| v < GRAZING * equation.velocity_scale) != Some(false) {
        return Err(grazing(&velocity, equation.velocity_scale));
    }
    Ok(velocity)
}

fn grazing<S: Real>(velocity: &S, scale: f64) -> ImpactError {
    ImpactError::Grazing { velocity: velocity.to_f64(), threshold: GRAZING * scale }
}
