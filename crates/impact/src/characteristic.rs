//! The exact characteristic function of the delayed impact system.
//!
//! Linearised about the orbit, flight l obeys y_l'' + c y_l' + alpha^2 y_l = A (y_l - y_(l-1)) +
//! B (y_l' - y_(l-1)') because the delay is exactly one flight. An eigenmode y_l = gamma y_(l-1)
//! turns it into an ordinary equation with kappa = 1 - w, w = 1/gamma:
//!
//! ```text
//! Y'' + (c - B kappa) Y' + (alpha^2 - A kappa) Y = 0
//! G(w) = 1 - w e (-2 R_r Ch + (sigma - chi B (1+R_r) kappa) Sc) + w^2 R_r^2 e^2
//! m^2 = (c - B kappa)^2/4 - alpha^2 + A kappa,  e = e^(-(c - B kappa)T/2),
//! Ch = cosh(mT),  Sc = sinh(mT)/m
//! ```
//!
//! G is entire; the Floquet multipliers are the inverses of its zeros, and the orbit is stable if
//! and only if G has no zero in |w| <= 1. For B = 0 this is the truth; for B != 0 the return map
//! is only piecewise linear (see [`crate::kick`]) and chi chooses the treatment of the kick.

use crate::error::ImpactError;
use crate::orbit::Orbit;
use crate::parameters::Parameters;
use crate::propagator::propagator;
use lindstedt_algebra::Stop;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// The velocity kick of the B term between an impact and its delayed image, as the factor chi.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kick {
    /// chi = 0.
    None,
    /// chi = (1 - R_r)/2, the mean of the two cases: the best choice for oscillating modes.
    Mean,
    /// chi = -R_r: every kick falls before the impact.
    Before,
    /// chi = 1: every kick falls after the impact.
    After,
}

impl Kick {
    /// chi.
    pub fn factor<S: Real>(self, restitution: &S) -> S {
        match self {
            Self::None => restitution.integer(0),
            Self::Mean => (restitution.integer(1) - restitution).halved(),
            Self::Before => -restitution.clone(),
            Self::After => restitution.integer(1),
        }
    }
}

/// The error of work that was stopped.
pub(crate) fn check(stop: &Stop) -> Result<(), ImpactError> {
    if stop.asked() { Err(ImpactError::Cancelled) } else { Ok(()) }
}

/// G(w) with its coefficients.
#[derive(Clone, Debug)]
pub struct Characteristic<S> {
    damping: S,
    displacement_gain: S,
    velocity_gain: S,
    restitution: S,
    saltation: S,
    /// chi B (1 + R_r)
    kick: S,
    period: S,
    /// m^2 = z_0 + z_1 w + z_2 w^2
    stiffness: [S; 3],
    stop: Stop,
}

impl<S: Real> Characteristic<S> {
    /// G for the true orbit of these parameters.
    pub fn new(parameters: &Parameters<S>, orbit: &Orbit<S>, kick: Kick) -> Self {
        let Parameters { alpha, damping: c, displacement_gain: a, velocity_gain: b, .. } =
            parameters;
        let restitution = &parameters.restitution;
        // kappa = 1 - w in c - B kappa = (c - B) + B w.
        let half = (c.clone() - b).halved();
        let half_gain = b.halved();
        let stiffness = [
            (half.clone() - alpha) * (half.clone() + alpha) + a,
            (half * &half_gain).doubled() - a,
            half_gain.square(),
        ];
        let jump = restitution.clone() + &restitution.integer(1);
        Self {
            damping: c.clone(),
            displacement_gain: a.clone(),
            velocity_gain: b.clone(),
            restitution: restitution.clone(),
            saltation: orbit.saltation.clone(),
            kick: kick.factor(restitution) * b * jump,
            period: orbit.period.clone(),
            stiffness,
            stop: Stop::default(),
        }
    }
    /// The same function, the search for whose zeros ends without a result when asked to stop.
    #[must_use]
    pub fn watched(self, stop: &Stop) -> Self {
        Self { stop: stop.clone(), ..self }
    }
    pub(crate) fn goes_on(&self) -> bool {
        !self.stop.asked()
    }
    /// T.
    pub fn period(&self) -> &S {
        &self.period
    }
    /// (G(w), G'(w)).
    pub fn value_and_slope(&self, w: &Complex<S>) -> (Complex<S>, Complex<S>) {
        let [z0, z1, z2] = &self.stiffness;
        let real = |x: &S| Complex::real(x.clone());
        let b = &self.velocity_gain;
        let kappa = real(&w.re.integer(1)) - w;
        let d = real(&self.damping) - kappa.scaled(b);
        let w_squared = w.clone() * w;
        let z = real(z0) + w.scaled(z1) + w_squared.scaled(z2);
        let z_slope = real(z1) + w.scaled(&z2.doubled());
        let flow = propagator(&d, &z, &self.period);
        let two_r = self.restitution.doubled();
        let sigma = real(&self.saltation) - kappa.scaled(&self.kick);
        // H = -2 R_r Ch + sigma Sc (with the factor e in it); derivatives by w
        let h = sigma.clone() * &flow.sinh - flow.cosh.scaled(&two_r);
        let by_z =
            sigma * &flow.sinh_slope - flow.sinh.scaled(&(self.restitution.clone() * &self.period));
        // d e/dw = -(B T/2) e
        let decay = b.clone() * &self.period;
        let h_slope = by_z * &z_slope + flow.sinh.scaled(&self.kick) - h.scaled(&decay.halved());
        let r2 = self.restitution.square();
        let last = (w_squared * &flow.contraction).scaled(&r2);
        let value = real(&w.re.integer(1)) - w.clone() * &h + &last;
        let last_slope = (w.clone() * &flow.contraction).scaled(&r2.doubled());
        let slope = last_slope - h - w.clone() * h_slope - last.scaled(&decay);
        (value, slope)
    }
    /// G(w) for real w.
    pub fn at(&self, w: &S) -> S {
        self.value_and_slope(&Complex::real(w.clone())).0.re
    }
    /// An upper bound of |G| on the disc of the given radius around `centre`.
    ///
    /// From |e| <= exp(Re), |cosh mT| <= exp(|Re m| T), |sinh(mT)/m| <= exp(|Re m| T) min(T, 1/|m|),
    /// with m^2 in the disc around its value at the centre.
    pub fn bound(&self, centre: &Complex<f64>, radius: f64) -> f64 {
        let [z0, z1, z2] = [0, 1, 2].map(|n| interval(&self.stiffness[n]));
        let (b, c) = (interval(&self.velocity_gain), interval(&self.damping));
        let time = self.period.magnitude_above();
        let (x, y) = (centre.re, centre.im);
        let z_re = z0.0 + z1.0 * x + z2.0 * (x * x - y * y);
        let z_im = z1.0 * y + 2.0 * z2.0 * x * y;
        let size = x.hypot(y);
        let uncertainty = z0.1 + z1.1 * size + z2.1 * size * size;
        let slope = (z1.0 + 2.0 * z2.0 * x).hypot(2.0 * z2.0 * y) + z1.1 + 2.0 * z2.1 * size;
        let delta = (slope * radius + (z2.0.abs() + z2.1) * radius * radius + uncertainty)
            * (1.0 + 1e-12)
            + 1e-14 * (z0.0.abs() + z1.0.abs() * size + z2.0.abs() * size * size);
        let (top, side) = (z_re + delta, z_im.abs() + delta);
        let modulus = top.hypot(side);
        let growth = if top > 0.0 {
            ((modulus + top) / 2.0).sqrt()
        } else {
            side / (2.0 * (modulus - top)).sqrt()
        };
        let growth = if side == 0.0 && top <= 0.0 { 0.0 } else { growth };
        let nearest = (z_re.hypot(z_im) - delta).max(0.0).sqrt();
        let sinh = time.min(1.0 / nearest);
        let damping = c.0 - b.0 + b.0 * x;
        let spread = b.0.abs() * radius + c.1 + b.1 * (1.0 + size + radius);
        let decay = (-(damping - spread) * time / 2.0 * (1.0 + 1e-12)).exp();
        let decay = decay.max((-(damping - spread) * time / 2.0 * (1.0 - 1e-12)).exp());
        let envelope = (growth * time * (1.0 + 1e-12)).exp();
        let reach = size + radius;
        let kick = self.kick.magnitude_above() * ((1.0 - x).hypot(y) + radius);
        let restitution = self.restitution.magnitude_above();
        let sigma = self.saltation.magnitude_above() + kick;
        let middle = reach * decay * envelope * (2.0 * restitution + sigma * sinh);
        (1.0 + middle + (reach * restitution * decay).powi(2)) * (1.0 + 1e-12)
    }
    /// A length over which G changes by a small factor, for the choice of steps only.
    pub(crate) fn scale(&self, w: &Complex<f64>) -> f64 {
        let [z0, z1, z2] = [0, 1, 2].map(|n| self.stiffness[n].to_f64());
        let time = self.period.to_f64();
        let z_slope = (z1 + 2.0 * z2 * w.re).hypot(2.0 * z2 * w.im);
        let z = (z0 + z1 * w.re + z2 * (w.re * w.re - w.im * w.im))
            .hypot(z1 * w.im + 2.0 * z2 * w.re * w.im);
        let rate = self.velocity_gain.to_f64().abs() * time / 2.0
            + z_slope * time / (2.0 * z.sqrt().max(1.0 / time));
        2.0 / (rate + 1.0 / w.modulus().max(0.5))
    }
    /// The same function at the midpoints in doubles.
    pub fn to_f64(&self) -> Characteristic<f64> {
        Characteristic {
            damping: self.damping.to_f64(),
            displacement_gain: self.displacement_gain.to_f64(),
            velocity_gain: self.velocity_gain.to_f64(),
            restitution: self.restitution.to_f64(),
            saltation: self.saltation.to_f64(),
            kick: self.kick.to_f64(),
            period: self.period.to_f64(),
            stiffness: [0, 1, 2].map(|n| self.stiffness[n].to_f64()),
            stop: self.stop.clone(),
        }
    }
}

/// Midpoint and a bound of the distance to the true value.
fn interval<S: Real>(x: &S) -> (f64, f64) {
    let middle = x.to_f64();
    (middle, (x.clone() - x.number(middle)).magnitude_above())
}
