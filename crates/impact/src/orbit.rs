//! The true periodic orbit with one impact per T, in a form regular at every parameter.
//!
//! The delayed terms vanish on a T-periodic motion, so the orbit does not depend on A, B. With
//! the force P0 cos(omega t + psi) (t from the impact), h the solution of the free flight with
//! h(0) = 0, h'(0) = 1 and J = P0 int_0^T h(T-u) e^(i omega u) du, the flight from (s, -R_r v)
//! closes if
//!
//! ```text
//! Re(e^(i psi) J)  = s - (h' + c h) s + R_r h v
//! Re(e^(i psi) J') = v + alpha^2 h s + R_r h' v,        J' = P0 h + i omega J   (omega T = 2 pi k)
//! ```
//!
//! This is linear in (cos psi, sin psi); their squares sum to 1, a quadratic for the impact
//! velocity v. Valid at alpha = omega, c = 0, c = 2 alpha and above.

use crate::error::ImpactError;
use crate::parameters::Parameters;
use crate::propagator::{Propagator, phi1, propagator};
use crate::velocity::{VelocityEquation, impact_velocity};
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// Delta (or the determinant over (P0 T)^2/omega) below which the free flow counts as T-periodic in doubles.
pub(crate) const PERIODIC: f64 = 1e-24;

/// Values of a periodic impact orbit that every variant shares.
#[derive(Clone, Debug)]
pub struct Orbit<S> {
    /// T.
    pub period: S,
    /// v = x'(T) > 0, velocity before the impact.
    pub velocity: S,
    /// (cos psi, sin psi): the force is P0 cos(omega t + psi), t from the impact.
    pub force_phase: (S, S),
    /// x''(T), acceleration before the impact.
    pub acceleration_before: S,
    /// x''(0), acceleration after the impact.
    pub acceleration_after: S,
    /// sigma = (x''(0) + R_r x''(T))/v, the lower left entry of the saltation matrix.
    pub saltation: S,
    /// Discriminant of the velocity equation divided by F^4: zero at the fold.
    pub discriminant: S,
    /// h(T) and h'(T) of the free flight (uncontrolled).
    pub(crate) response: (S, S),
}

/// h(t), h'(t) of the free flight and I = int_0^t h(u) e^(-i omega u) du.
struct Response<S> {
    h: S,
    slope: S,
    integral: Complex<S>,
}

fn response<S: Real>(parameters: &Parameters<S>, time: &S, full_period: bool) -> Response<S> {
    let Parameters { alpha, omega, damping: c, .. } = parameters;
    let half = c.halved();
    let z = (half.clone() - alpha) * (half.clone() + alpha);
    let z = Complex::real(z);
    let Propagator { cosh, sinh, .. } = propagator(&Complex::real(c.clone()), &z, time);
    let (h, slope) = (sinh.re.clone(), cosh.re - half.clone() * &sinh.re);
    // I = (1 - e^(-i omega t)(h' + (c + i omega) h))/(alpha^2 - omega^2 + i c omega)
    let (detuning, loss) = parameters.forced_denominator();
    let denominator = Complex::new(detuning, loss);
    let zero = alpha.integer(0);
    if denominator.to_f64().modulus() > 0.1 * omega.to_f64() * omega.to_f64() {
        let one = Complex::real(alpha.integer(1));
        let mut tail = Complex::new(slope.clone() + c.clone() * &h, omega.clone() * &h);
        if !full_period {
            tail = tail * Complex::new(zero, -(omega.clone() * time)).exp();
        }
        return Response { h, slope, integral: (one - tail).over(&denominator) };
    }
    // Near the resonance: t (phi1((l_1 - i omega) t) - phi1((l_2 - i omega) t))/(l_1 - l_2) with
    // l_1 - l_2 = 2 m ~ 2 i omega; e^(l t) needs no reduction of omega t.
    let m = z.sqrt();
    let root = |sign: &Complex<S>| {
        let exponent = Complex::new(-half.clone(), -omega.clone()) + sign;
        phi1(&exponent.scaled(time))
    };
    let difference = root(&m) - root(&-m.clone());
    let integral = difference.over(&m).scaled(&time.halved());
    Response { h, slope, integral }
}

/// The true orbit: one impact per T = 2 pi k/omega, T-periodic, so the loop is silent and A and B do not
/// enter.
///
/// Position and velocity after a flight are linear in cos psi, sin psi (the phase of the force at the
/// impact) and the impact velocity v; eliminating psi leaves a quadratic for v, whose root `branch` chooses.
/// Regular at alpha = omega, c = 0 and c >= 2 alpha. Whether the flight passes through the wall is another
/// question: [`crate::flight::clearance`].
///
/// Certified for balls; for doubles a relative error of some 10^-15 times the condition of the
/// velocity (large at the fold and towards grazing).
///
/// # Errors
/// Invalid parameters; [`ImpactError::PeriodicFreeFlow`], [`ImpactError::ImpactResonance`],
/// [`ImpactError::BeyondFold`], [`ImpactError::NoPositiveVelocity`], [`ImpactError::Grazing`],
/// [`ImpactError::Sticking`].
pub fn orbit<S: Real>(parameters: &Parameters<S>) -> Result<Orbit<S>, ImpactError> {
    parameters.validate()?;
    let Parameters { alpha, omega, damping: c, wall: s, restitution, force, .. } = parameters;
    let period = parameters.period();
    let Response { h, slope, integral } = response(parameters, &period, true);
    let j = integral.scaled(force);
    let j_slope = Complex::new(force.clone() * &h - omega.clone() * &j.im, omega.clone() * &j.re);
    // det [J.re, -J.im; J'.re, -J'.im] = +-E Delta omega F^2, finite at alpha = omega.
    let one = alpha.integer(1);
    let determinant = -(j.re.clone() * &j_slope.im) + j.im.clone() * &j_slope.re;
    let thrust = force.to_f64() * period.to_f64();
    let swing = omega.to_f64() * parameters.forced_amplitude().to_f64();
    let velocity_scale = if swing.is_finite() { swing.min(thrust) } else { thrust };
    // E Delta; where the force is near its resonance and F large, with P0 T for omega F.
    let relative = determinant.to_f64().abs() * omega.to_f64() / (velocity_scale * velocity_scale);
    let undecided = |what| ImpactError::Undecided { what, bits: alpha.precision() };
    if !relative.is_finite() {
        return Err(undecided("the impact orbit at values of this size"));
    }
    if relative < PERIODIC || determinant.sign().is_some_and(|sign| sign.is_eq()) {
        return Err(ImpactError::PeriodicFreeFlow { delta: relative });
    }
    if determinant.sign().is_none() {
        return Err(undecided("whether the free flow is T-periodic"));
    }
    // Solve [J.re, -J.im; J'.re, -J'.im](cos, sin) = right for the parts without and with v.
    let solve = |first: &S, second: &S| {
        let cos = -(first.clone() * &j_slope.im) + second.clone() * &j.im;
        let sin = second.clone() * &j.re - first.clone() * &j_slope.re;
        (cos / &determinant, sin / &determinant)
    };
    let (p_cos, p_sin) =
        solve(&((one.clone() - &slope - c.clone() * &h) * s), &(alpha.square() * &h * s));
    let (w_cos, w_sin) =
        solve(&(restitution.clone() * &h), &(one.clone() + restitution.clone() * &slope));
    let quadratic = w_cos.square() + w_sin.square();
    let half_linear = p_cos.clone() * &w_cos + p_sin.clone() * &w_sin;
    // |p.w|^2 - |w|^2(|p|^2 - 1) = |w|^2 - (p x w)^2
    let cross = p_cos.clone() * &w_sin - p_sin.clone() * &w_cos;
    let equation = VelocityEquation {
        discriminant: quadratic.clone() - cross.square(),
        constant: p_cos.square() + p_sin.square() - &one,
        quadratic,
        half_linear,
        resonance_scale: velocity_scale * velocity_scale,
        velocity_scale,
    };
    let velocity = impact_velocity(&equation, parameters.branch)?;
    let force_phase = (p_cos + w_cos * &velocity, p_sin + w_sin * &velocity);
    let drive = force.clone() * &force_phase.0 - alpha.square() * s;
    let acceleration_before = drive.clone() - c.clone() * &velocity;
    let acceleration_after = drive.clone() + c.clone() * restitution * &velocity;
    let saltation = (one + restitution) * drive / &velocity;
    refuse_sticking(restitution, &acceleration_after)?;
    Ok(Orbit {
        period,
        velocity,
        force_phase,
        acceleration_before,
        acceleration_after,
        saltation,
        discriminant: equation.discriminant,
        response: (h, slope),
    })
}

/// R_r = 0 leaves the wall only with a negative acceleration.
#[inline(always)]
pub(crate) fn refuse_sticking<S: Real>(restitution: &S, after: &S) -> Result<(), ImpactError> {
    if restitution.sign().is_some_and(|sign| sign.is_eq()) && !after.is_negative() {
        return Err(ImpactError::Sticking { acceleration: after.to_f64() });
    }
    Ok(())
}

impl<S: Real> Orbit<S> {
    /// The midpoints.
    pub fn to_f64(&self) -> Orbit<f64> {
        let pair = |(a, b): &(S, S)| (a.to_f64(), b.to_f64());
        Orbit {
            period: self.period.to_f64(),
            velocity: self.velocity.to_f64(),
            force_phase: pair(&self.force_phase),
            acceleration_before: self.acceleration_before.to_f64(),
            acceleration_after: self.acceleration_after.to_f64(),
            saltation: self.saltation.to_f64(),
            discriminant: self.discriminant.to_f64(),
            response: pair(&self.response),
        }
    }
    /// psi in (-pi, pi].
    pub fn force_angle(&self) -> S {
        self.force_phase.1.atan2(&self.force_phase.0)
    }
    /// State (x, x') at the time t after the impact.
    pub(crate) fn state(&self, parameters: &Parameters<S>, t: &S) -> (S, S) {
        let Parameters { alpha, omega, damping: c, wall: s, restitution, force, .. } = parameters;
        let Response { h, slope, integral } = response(parameters, t, false);
        let phase = Complex::new(self.force_phase.0.clone(), self.force_phase.1.clone());
        let turn = Complex::new(alpha.integer(0), omega.clone() * t).exp();
        let j = integral.scaled(force) * &turn * &phase;
        let start = -(restitution.clone() * &self.velocity);
        let x = (slope.clone() + c.clone() * &h) * s + h.clone() * &start + &j.re;
        // Re(e^(i psi) J'), J' = P0 h + i omega J
        let push = force.clone() * &h * &self.force_phase.0 - omega.clone() * &j.im;
        let velocity = -(alpha.square() * &h * s) + slope * &start + push;
        (x, velocity)
    }
}
