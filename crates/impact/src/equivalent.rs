//! The periodic orbit of an equivalent flow (R, Omega) driven by the forced part of the true
//! equation: x = F cos(omega t + phi) + e^(R t)(C cos Omega t + D sin Omega t).
//!
//! With theta = Omega T, E = e^(R T), and everything divided by max(E, 1/E), so that nothing
//! overflows:
//!
//! ```text
//! Delta = E + 1/E - 2 cos theta
//! kappa = (1+R_r) sin theta/(Omega Delta)                  C = -kappa v
//! D     = -(1+R_r)(1/E - cos theta) v/(Omega Delta)
//! q     = (Omega (R_r (E - cos theta) - (1/E - cos theta)) - (1+R_r) R sin theta)/(omega Omega Delta)
//! F cos phi = s + kappa v,  F sin phi = q v
//! (kappa^2 + q^2) v^2 + 2 s kappa v + s^2 - F^2 = 0
//! ```
//!
//! Derived from x(0) = x(T) = s, x'(0) = -R_r v, x'(T) = v.

use crate::error::ImpactError;
use crate::flow::Flow;
use crate::orbit::{PERIODIC, refuse_sticking};
use crate::parameters::{Branch, Parameters};
use crate::velocity::{VelocityEquation, impact_velocity};
use lindstedt_number::real::Real;

/// An orbit in the form (8), of the true equation (flow R = -c/2) or of a prediction.
#[derive(Clone, Debug)]
pub struct EquivalentOrbit<S> {
    /// T.
    pub period: S,
    /// theta = Omega T.
    pub theta: S,
    /// E = e^(R T).
    pub growth: S,
    /// Delta = E + 1/E - 2 cos theta.
    pub delta: S,
    /// kappa = -C/v.
    pub kappa: S,
    /// q = F sin(phi)/v.
    pub q: S,
    /// F^2 (kappa^2 + q^2) - s^2 q^2: negative beyond the fold.
    pub discriminant: S,
    /// F, amplitude of the forced part.
    pub forced_amplitude: S,
    /// v = x'(T) > 0.
    pub velocity: S,
    /// C, coefficient of e^(R t) cos(Omega t).
    pub cosine: S,
    /// D, coefficient of e^(R t) sin(Omega t).
    pub sine: S,
    /// (cos phi, sin phi).
    pub phase: (S, S),
    /// x''(T).
    pub acceleration_before: S,
    /// x''(0).
    pub acceleration_after: S,
    /// sigma = (x''(0) + R_r x''(T))/v.
    pub saltation: S,
    /// (sin theta, cos theta).
    pub(crate) theta_sin_cos: (S, S),
}

/// The data besides the flow that the orbit needs: omega, k, R_r, s, F and the branch.
#[derive(Clone, Debug)]
pub struct Drive<S> {
    /// omega.
    pub omega: S,
    /// T.
    pub period: S,
    /// R_r.
    pub restitution: S,
    /// s.
    pub wall: S,
    /// F.
    pub forced_amplitude: S,
    /// Sign of the root.
    pub branch: Branch,
}

impl<S: Real> Drive<S> {
    /// The drive of an oscillator.
    ///
    /// # Errors
    /// Invalid parameters; [`ImpactError::Resonance`] for alpha = omega, c = 0.
    pub fn new(parameters: &Parameters<S>) -> Result<Self, ImpactError> {
        parameters.validate()?;
        let forced_amplitude = parameters.forced_amplitude();
        if !forced_amplitude.is_finite() {
            return Err(ImpactError::Resonance);
        }
        Ok(Self {
            omega: parameters.omega.clone(),
            period: parameters.period(),
            restitution: parameters.restitution.clone(),
            wall: parameters.wall.clone(),
            forced_amplitude,
            branch: parameters.branch,
        })
    }
    /// The same in other numbers.
    pub(crate) fn map<T>(&self, number: impl Fn(&S) -> T) -> Drive<T> {
        Drive {
            omega: number(&self.omega),
            period: number(&self.period),
            restitution: number(&self.restitution),
            wall: number(&self.wall),
            forced_amplitude: number(&self.forced_amplitude),
            branch: self.branch,
        }
    }
}

/// The orbit of `flow` under `drive`.
///
/// Certified for balls. Doubles lose digits where C, D and F cancel: F omega^2/P0 of them near
/// alpha = omega (use [`crate::orbit::orbit`] for the true orbit there).
///
/// # Errors
/// [`ImpactError::NotApplicable`] and the errors of [`crate::orbit::orbit`].
pub fn equivalent_orbit<S: Real>(
    flow: &Flow<S>,
    drive: &Drive<S>,
) -> Result<EquivalentOrbit<S>, ImpactError> {
    equivalent_orbit_here(flow, drive)
}

/// The same where a caller needs a few of its numbers, along a chart: the others are not computed.
#[inline(always)]
pub(crate) fn equivalent_orbit_here<S: Real>(
    flow: &Flow<S>,
    drive: &Drive<S>,
) -> Result<EquivalentOrbit<S>, ImpactError> {
    flow.validate()?;
    let Flow { growth_rate: rate, frequency } = flow;
    let Drive { omega, period, restitution, wall: s, forced_amplitude, branch } = drive;
    let theta = frequency.clone() * period;
    let (half_sin, half_cos) = theta.halved().sin_cos();
    let sin = (half_sin.clone() * half_cos).doubled();
    let versed_angle = half_sin.square().doubled(); // 1 - cos theta
    let exponent = rate.clone() * period;
    let undecided =
        || ImpactError::Undecided { what: "the orbit of the prediction", bits: s.precision() };
    let growing = exponent.holds(|x| x > 0.0).ok_or_else(undecided)?;
    let decay = if growing { -exponent.clone() } else { exponent.clone() };
    // All of E, 1/E, cos times e = min(E, 1/E).
    // One of e and 1 - e is small; it is the one computed.
    let one = s.integer(1);
    let (e, gap) = if decay.holds(|x| x > -0.5).ok_or_else(undecided)? {
        let gap = -decay.exp_m1();
        (one.clone() - &gap, gap)
    } else {
        let e = decay.exp();
        (e.clone(), one.clone() - &e)
    };
    let versed = e.clone() * &versed_angle; // e (1 - cos theta)
    let delta = gap.square() + versed.doubled();
    let large = gap.clone() + &versed; // 1 - e cos
    let small = versed - e.clone() * &gap; // e^2 - e cos
    let (e_minus, inverse_minus) = if growing { (large, small) } else { (small, large) };
    if !delta.is_finite() {
        return Err(undecided());
    }
    let true_delta = delta.clone() / &e;
    if true_delta.holds(|delta| delta < PERIODIC) != Some(false) || !delta.is_positive() {
        return Err(ImpactError::PeriodicFreeFlow { delta: true_delta.to_f64() });
    }
    let scaled = frequency.clone() * &delta;
    let jump = restitution.clone() + &restitution.integer(1);
    let jump_sin = jump.clone() * &sin * &e;
    let kappa = jump_sin.clone() / &scaled;
    let bounce = restitution.clone() * &e_minus - &inverse_minus;
    let q = (frequency.clone() * bounce - jump_sin * rate) / (scaled.clone() * omega);
    let square = kappa.square() + q.square();
    let f2 = forced_amplitude.square();
    let discriminant = f2.clone() * &square - (s.clone() * &q).square();
    let scale = omega.to_f64() * forced_amplitude.to_f64();
    let equation = VelocityEquation {
        quadratic: square,
        half_linear: s.clone() * &kappa,
        constant: s.clone().square() - &f2,
        discriminant: discriminant.clone(),
        resonance_scale: (omega.to_f64()).powi(2),
        velocity_scale: scale,
    };
    let velocity = impact_velocity(&equation, *branch)?;
    let cosine = -(kappa.clone() * &velocity);
    let sine = -(jump.clone() * inverse_minus * &velocity / &scaled);
    let (force_cos, force_sin) = (s.clone() - &cosine, q.clone() * &velocity);
    // x'' - 2 R x' + (R^2 + Omega^2) x = drive of the forced part at the impact phase
    let stiffness = rate.square() + frequency.square();
    let held = (stiffness.clone() - omega.square()) * &force_cos
        + (rate.clone() * omega * &force_sin).doubled()
        - stiffness * s;
    let drift = rate.doubled() * &velocity;
    let acceleration_before = held.clone() + &drift;
    let acceleration_after = held.clone() - drift * restitution;
    refuse_sticking(restitution, &acceleration_after)?;
    let saltation = jump * held / &velocity;
    let growth = if growing { one.clone() / &e } else { e.clone() };
    Ok(EquivalentOrbit {
        period: period.clone(),
        theta,
        growth,
        delta: true_delta,
        kappa,
        q,
        discriminant,
        forced_amplitude: forced_amplitude.clone(),
        velocity,
        cosine,
        sine,
        phase: (force_cos / forced_amplitude, force_sin / forced_amplitude),
        acceleration_before,
        acceleration_after,
        saltation,
        theta_sin_cos: (sin, one - versed_angle),
    })
}

impl<S: Real> EquivalentOrbit<S> {
    /// phi in (-pi, pi].
    pub fn phase_angle(&self) -> S {
        self.phase.1.atan2(&self.phase.0)
    }
}
