//! KBM that knows of the impact in the delay interval.
//!
//! On an eigenmode the delayed flight is y/gamma, so that kappa = 1 - 1/gamma replaces
//! 1 - e^(-lambda T): lambda^2 + alpha^2 = eps ((A + B lambda) kappa - c lambda). Its two roots are
//! expanded in eps to order N from +-i alpha with kappa fixed, and the resulting map is solved for
//! gamma together with kappa. At N = infinity this is the zero of [`crate::characteristic`] that
//! grows out of the uncontrolled multiplier.

use crate::characteristic::{Kick, check};
use crate::error::ImpactError;
use crate::map::{ImpactMap, Verdict};
use crate::orbit::Orbit;
use crate::parameters::Parameters;
use crate::prediction::uncontrolled_map;
use lindstedt_algebra::Stop;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// The impact-aware prediction.
#[derive(Clone, Debug)]
pub struct AwarePrediction<S> {
    /// The (one or two) multipliers continued from the nonzero ones of the uncontrolled map.
    /// Estimated: roots by iteration, no enclosure.
    pub multipliers: Vec<Complex<S>>,
}

impl<S: Real> AwarePrediction<S> {
    /// max |gamma|.
    pub fn spectral_radius(&self) -> f64 {
        self.multipliers.iter().map(|gamma| gamma.to_f64().modulus()).fold(0.0, f64::max)
    }
    /// Stable below 1, neutral within 10^-10 of 1.
    pub fn verdict(&self) -> Verdict {
        let excess = self.spectral_radius() - 1.0;
        if excess.abs() <= 1e-10 {
            Verdict::Neutral
        } else if excess < 0.0 {
            Verdict::Stable
        } else {
            Verdict::Unstable
        }
    }
}

/// The function whose zeros w = 1/gamma are sought, with the gains scaled by `gain`.
struct Truncated<'a, S> {
    parameters: &'a Parameters<S>,
    orbit: &'a Orbit<S>,
    chi: S,
    order: usize,
    stop: &'a Stop,
}

impl<S: Real> Truncated<'_, S> {
    /// sum_(n=0..order) lambda_n from `start` = +-i alpha: 2 lambda_0 lambda_m =
    /// A kappa delta_(m,1) + (B kappa - c) lambda_(m-1) - sum_(j=1..m-1) lambda_j lambda_(m-j).
    fn root(&self, start: Complex<S>, a: &Complex<S>, rate: &Complex<S>) -> Complex<S> {
        let inverse = start.scaled(&start.re.integer(2)).inverse();
        let mut sum = start.clone();
        let mut terms = vec![start];
        for m in 1..=self.order {
            let mut g = rate.clone() * &terms[m - 1];
            if m == 1 {
                g = g + a;
            }
            for j in 1..m {
                g = g - terms[j].clone() * &terms[m - j];
            }
            let next = g * &inverse;
            sum = sum + &next;
            terms.push(next);
        }
        sum
    }
    fn at(&self, w: &Complex<S>, gain: &Complex<S>) -> Complex<S> {
        let Parameters { alpha, damping, displacement_gain, velocity_gain, restitution, .. } =
            self.parameters;
        let one = Complex::real(alpha.integer(1));
        let kappa = one.clone() - w;
        let scaled = kappa.clone() * gain;
        let a = scaled.scaled(displacement_gain);
        let rate = scaled.scaled(velocity_gain) - Complex::real(damping.clone());
        let start = Complex::new(alpha.integer(0), alpha.clone());
        let upper = self.root(start.clone(), &a, &rate);
        let lower = self.root(-start, &a, &rate);
        let time = &self.orbit.period;
        let (forward, backward) = (upper.scaled(time).exp(), lower.scaled(time).exp());
        let response = (forward.clone() - &backward).over(&(upper - &lower));
        let jump = restitution.clone() + &restitution.integer(1);
        let kick = scaled.scaled(&(self.chi.clone() * velocity_gain * jump));
        let sigma = Complex::real(self.orbit.saltation.clone()) - kick;
        let trace = sigma * response - (forward.clone() + &backward).scaled(restitution);
        let determinant = (forward * &backward).scaled(&restitution.square());
        one - w.clone() * &trace + w.clone() * w * &determinant
    }
    /// The secant method from `start`.
    fn solve(
        &self,
        start: &Complex<S>,
        gain: &Complex<S>,
        limit: f64,
        rounds: usize,
    ) -> Option<Complex<S>> {
        let nudge = start.scaled(&start.re.number(1e-6));
        let (mut before, mut w) = (start.clone() + nudge, start.clone());
        let mut f_before = self.at(&before, gain);
        let mut last = f64::INFINITY;
        for _ in 0..rounds {
            if self.stop.asked() {
                return None;
            }
            let f = self.at(&w, gain);
            let slope = (f.clone() - &f_before).over(&(w.clone() - &before));
            let step = f.over(&slope).centre();
            let size = step.to_f64().modulus();
            if size == 0.0 || (!size.is_finite() && last < 1e-9 * start.to_f64().modulus()) {
                return Some(w);
            }
            if !size.is_finite() {
                return None;
            }
            if size >= last && size < 1e-11 * start.to_f64().modulus() {
                return Some(w);
            }
            last = size;
            (before, f_before) = (w.clone(), f);
            w = (w - &step).centre();
            if (w.clone() - start).to_f64().modulus() > limit * start.to_f64().modulus() {
                return None;
            }
        }
        (last < 1e-11 * start.to_f64().modulus()).then_some(w)
    }
    /// Follows a zero from gain 0 to gain 1 along t + i `bend` t (1 - t).
    fn follow(&self, start: &Complex<S>, bend: f64) -> Option<Complex<S>> {
        let unit = &self.orbit.period;
        let at = |t: f64| Complex::new(unit.number(t), unit.number(bend * t * (1.0 - t)));
        let (mut w, mut t, mut step) = (start.clone(), 0.0, 0.5_f64);
        while t < 1.0 {
            let target = (t + step).min(1.0);
            let rounds = if target < 1.0 { 30 } else { 60 };
            match self.solve(&w, &at(target), 0.3, rounds) {
                Some(next) => (w, t, step) = (next, target, step * 1.5),
                None if step > 1e-4 && !self.stop.asked() => step *= 0.5,
                None => return None,
            }
        }
        Some(w)
    }
}

/// The impact-aware prediction of the given order.
///
/// The multipliers are continued from those of the uncontrolled map while A and B grow from 0; a
/// collision of two real multipliers is passed through complex gains.
///
/// # Errors
/// [`ImpactError::OrderZero`]; [`ImpactError::NoConvergence`] where a multiplier is lost; [`ImpactError::Cancelled`].
pub fn impact_aware<S: Real>(
    parameters: &Parameters<S>,
    orbit: &Orbit<S>,
    kick: Kick,
    order: usize,
    stop: &Stop,
) -> Result<AwarePrediction<S>, ImpactError> {
    if order == 0 {
        return Err(ImpactError::OrderZero);
    }
    let chi = kick.factor(&parameters.restitution);
    let truncated = Truncated { parameters, orbit, chi, order, stop };
    // The way in doubles, its end in full precision: the multipliers are simple where they are
    // not lost, so the secant method needs no more than the place.
    let scout = (parameters.to_f64(), orbit.to_f64());
    let in_doubles = Truncated {
        parameters: &scout.0,
        orbit: &scout.1,
        chi: kick.factor(&scout.0.restitution),
        order,
        stop,
    };
    let map: ImpactMap<S> = uncontrolled_map(parameters, orbit);
    let mut multipliers = Vec::with_capacity(2);
    for gamma in map.multipliers() {
        if gamma.to_f64().modulus() == 0.0 {
            continue;
        }
        check(stop)?;
        let start = gamma.inverse().to_f64();
        let lost = ImpactError::NoConvergence { what: "the impact-aware multiplier" };
        let place = [0.0, 0.3, -0.7].iter().find_map(|&bend| in_doubles.follow(&start, bend));
        let number = |x| orbit.period.number(x);
        let place = place.map(|w| Complex::new(number(w.re), number(w.im)));
        let full = Complex::real(number(1.0));
        let w = place.and_then(|w| truncated.solve(&w, &full, 1e-3, 60)).ok_or(lost)?;
        multipliers.push(w.inverse());
    }
    multipliers.sort_by(|a, b| b.to_f64().norm_squared().total_cmp(&a.to_f64().norm_squared()));
    Ok(AwarePrediction { multipliers })
}
