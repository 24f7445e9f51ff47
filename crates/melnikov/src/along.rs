//! Integrals along the unperturbed orbit: the moments int g(x0) v0^n dt of friction, and the transforms
//! int g(x0) v0 e^{i omega t} dt of forces.
//!
//! With x0 = X xi(z), z = kappa t, v0 = X kappa xi', a power g = x^m gives
//!
//!   int x0^m v0^n dt = X^(m+n) kappa^(n-1) int xi^m xi'^n dz,
//!
//! the integral of an element of Q\[sech, tanh\]: exact. The pendulum x0 = 2 gd z has
//! e^{i x0/2} = sech z + i tanh z, so that sin(k x) and cos(k x), k a multiple of 1/2, are elements, too; of a
//! power of x the moment is a polynomial in pi. phi^6, x0^2 = (1 + tanh z)/2, has
//! int x^m v^n dt = kappa^(n-1) B((m+n)/2, n)/2, and a certified trapezoidal rule for forces.

use crate::hyperbolic::{FourierForm, Hyperbolic, HyperbolicRing, PiPolynomial, beta};
use crate::quadrature::{Strip, trapezoid};
use crate::{Factor, Potential};
use lindstedt_algebra::{Ring, power};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Integer, Rational};

impl Potential {
    /// Whether the transform of a force with this factor is known in closed form or certified.
    #[must_use]
    pub fn takes_force(&self, factor: &Factor) -> bool {
        match self {
            Self::PhiSix { .. } => matches!(factor, Factor::Power(_)),
            _ => self.along(factor).is_some(),
        }
    }

    /// Whether the moments with this factor are.
    #[must_use]
    pub fn takes_damping(&self, factor: &Factor) -> bool {
        matches!(factor, Factor::Power(_)) || self.takes_force(factor)
    }

    /// g(X xi)/X^m for a power g = x^m, sin(k x) and cos(k x) as they are; nothing outside the algebra.
    fn along(&self, factor: &Factor) -> Option<Hyperbolic> {
        let ring = HyperbolicRing;
        match (self, factor) {
            (_, Factor::Power(0)) => Some(ring.one()),
            (Self::Pendulum { .. }, Factor::Sine(k)) => half_turns(k).map(|(_, sine)| sine),
            (Self::Pendulum { .. }, Factor::Cosine(k)) => half_turns(k).map(|(cosine, _)| cosine),
            (_, Factor::Power(m)) => Some(power(&ring, &self.description()?.shape, *m)),
            _ => None,
        }
    }

    /// int g(x0) v0^n dt on the positive branch, n >= 1; nothing for n = 0, or where it is not known in
    /// closed form ([`Potential::takes_damping`]).
    ///
    /// Exact up to the scale, but for phi^6 (Euler's beta function). Cost: O(n^2 + m^2) rational operations.
    #[must_use]
    pub fn moment(&self, balls: Balls, factor: &Factor, n: u32) -> Option<Ball> {
        if n == 0 {
            return None;
        }
        let rate = self.rate(balls)?;
        let by_rate = |value: &Ball| Some(balls.mul(&balls.powi(&rate, i64::from(n) - 1)?, value));
        match (self, factor) {
            (Self::PhiSix { .. }, Factor::Power(m)) => {
                let b = beta(balls, &Rational::from((m + n, 2)), &Rational::from(n))?;
                return by_rate(&balls.mul_power_of_two(&b, -1));
            }
            (Self::Pendulum { .. }, Factor::Power(m)) if *m > 0 => {
                return by_rate(&swing_moment(*m, n).ball(balls));
            }
            _ => {}
        }
        let ring = HyperbolicRing;
        let product = ring.mul(&self.along(factor)?, &power(&ring, &self.velocity_shape()?, n));
        let integral = product.integrate()?.ball(balls);
        let power = balls.powi(&self.velocity_scale(balls)?, i64::from(n))?;
        let value = balls.div(&balls.mul(&power, &integral), &rate)?;
        Some(balls.mul(&value, &self.size(balls, factor)?))
    }

    /// (C, S) with C + iS = int g(x0) v0 e^{i omega t} dt on the positive branch; nothing where it is not known
    /// in closed form ([`Potential::takes_force`]).
    ///
    /// In the algebra by exact J_{p,q}; for phi^6 by a certified trapezoidal rule (for g = 1,
    /// C + iS = Gamma(1 - i nu) Gamma(1/2 + i nu)/sqrt(pi), nu = omega/(2 kappa)).
    #[must_use]
    pub fn transform(&self, balls: Balls, factor: &Factor, omega: &Ball) -> Option<(Ball, Ball)> {
        let w = balls.div(omega, &self.rate(balls)?)?;
        if let (Self::PhiSix { .. }, Factor::Power(m)) = (self, factor) {
            return phi_six_transform(balls, *m, &w);
        }
        let product = HyperbolicRing.mul(&self.along(factor)?, &self.velocity_shape()?);
        let transform = product.fourier()?;
        let size = balls.mul(&self.amplitude(balls)?, &self.size(balls, factor)?);
        let scaled = |form: &FourierForm| Some(balls.mul(&size, &form.ball(balls, &w)?));
        Some((scaled(&transform.cosine)?, scaled(&transform.sine)?))
    }

    /// X^m for a power, 1 for the others.
    fn size(&self, balls: Balls, factor: &Factor) -> Option<Ball> {
        match factor {
            Factor::Power(m) => balls.powi(&self.amplitude(balls)?, i64::from(*m)),
            Factor::Sine(_) | Factor::Cosine(_) => Some(balls.one()),
        }
    }
}

/// cos(k x) and sin(k x) on the upper orbit of the pendulum, k a multiple of 1/2:
/// e^{i k x} = (sech z + i tanh z)^(2k).
fn half_turns(k: &Rational) -> Option<(Hyperbolic, Hyperbolic)> {
    /// Harmonics beyond are not formed.
    const MOST: u32 = 100;
    let twice = Rational::from(k * 2u32);
    let n = twice.is_integer().then(|| twice.numer().clone().abs().to_u32())??;
    if n > MOST {
        return None;
    }
    let ring = HyperbolicRing;
    let (sech, tanh) = (Hyperbolic::sech(1), Hyperbolic::tanh());
    let (mut cosine, mut sine) = (ring.one(), ring.zero());
    for _ in 0..n {
        let next = ring.sub(&ring.mul(&cosine, &sech), &ring.mul(&sine, &tanh));
        sine = ring.add(&ring.mul(&sine, &sech), &ring.mul(&cosine, &tanh));
        cosine = next;
    }
    if twice < 0 {
        sine = ring.neg(&sine);
    }
    Some((cosine, sine))
}

/// int x^m v^n dt/a^((n-1)/2) on the upper orbit of the pendulum, v = 2 sqrt(a) cos(x/2): with x = 2u,
///
///   2^(m+1) sum_j binomial(n-1, j) A_m(n-1-2j),   A_m(q) = int u^m cos(q u) du over |u| < pi/2,
///
/// because (2 cos u)^(n-1) = sum_j binomial(n-1, j) cos((n-1-2j) u). A polynomial in pi; 0 for odd m.
fn swing_moment(m: u32, n: u32) -> PiPolynomial {
    let mut coefficients = vec![Rational::new(); m as usize + 2];
    if m % 2 == 1 {
        return PiPolynomial::default();
    }
    for j in 0..n {
        let binomial = Integer::from(n - 1).binomial(j) << (m + 1);
        let q = i64::from(n) - 1 - 2 * i64::from(j);
        for (sum, c) in coefficients.iter_mut().zip(quarter_turns(m, q)) {
            *sum += c * &binomial;
        }
    }
    PiPolynomial { coefficients }
}

/// A_m(q) for even m, by parts twice:
/// A_m = 2 h^m sin(q h)/q + 2 m h^(m-1) cos(q h)/q^2 - m (m-1)/q^2 A_(m-2), h = pi/2;
/// A_m(0) = 2 h^(m+1)/(m+1). The coefficient of pi^k at index k.
fn quarter_turns(m: u32, q: i64) -> Vec<Rational> {
    let half_to = |k: u32| Rational::from((1, Integer::from(1) << k));
    let mut result = vec![Rational::new(); m as usize + 2];
    if q == 0 {
        result[m as usize + 1] = half_to(m) / (m + 1);
        return result;
    }
    // sin and cos of q pi/2.
    let quarter = |q: i64| [0, 1, 0, -1][q.rem_euclid(4) as usize];
    let (sine, cosine) = (quarter(q), quarter(q + 1));
    let mut factor = Rational::from(1);
    for k in (0..=m).rev().step_by(2) {
        result[k as usize] += Rational::from((2 * sine, q)) * half_to(k) * &factor;
        if k > 0 {
            factor /= q * q;
            factor *= k;
            result[k as usize - 1] += Rational::from(&factor * (2 * cosine)) * half_to(k - 1);
            factor *= -i64::from(k - 1);
        }
    }
    result
}

/// int x^m x' e^{iws} ds for x^2 = 1/(1 + u), u = e^{-2s}: the integrand without the phase is
/// u (1 + u)^(-(m+3)/2). On |Im s| <= c, |1 + u| >= cos c (1 + |u|), and on the line it is at most
/// e^{-|s|}, with integral 1/(m+1) <= 1.
fn phi_six_transform(balls: Balls, m: u32, w: &Ball) -> Option<(Ball, Ball)> {
    let half_width = Rational::from(1);
    let root_power = |x: &Ball| balls.powi(&balls.sqrt(x)?, i64::from(m) + 3);
    let power = root_power(&balls.cos(&balls.from_rational(&half_width)))?;
    let strip = Strip {
        edge_integral: balls.div(&balls.cosh(&balls.mul_rational(w, &half_width)), &power)?,
        half_width,
        decay: Rational::from(1),
        amplitude: balls.one(),
    };
    let part = |trig: fn(Balls, &Ball) -> Ball| {
        trapezoid(balls, &strip, |balls, s| {
            let u = balls.exp(&balls.mul_i64(s, -2));
            let speed = balls.div(&u, &root_power(&balls.add(&balls.one(), &u))?)?;
            Some(balls.mul(&speed, &trig(balls, &balls.mul(w, s))))
        })
    };
    Some((part(Balls::cos)?, part(Balls::sin)?))
}

#[cfg(test)]
mod tests;
