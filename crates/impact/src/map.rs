//! The linear impact map: characteristic polynomial, multipliers, conditions of stability.

use crate::equivalent::{Drive, EquivalentOrbit};
use crate::flow::Flow;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// Stability of a fixed point of a linear map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every multiplier lies inside the unit circle.
    Stable,
    /// Some multiplier lies outside.
    Unstable,
    /// A multiplier lies on the circle, within the tolerance of doubles or the radius of balls.
    Neutral,
}

/// gamma^2 - trace gamma + determinant, the characteristic polynomial of the impact map.
#[derive(Clone, Debug)]
pub struct ImpactMap<S> {
    /// Sum of the multipliers.
    pub trace: S,
    /// Product of the multipliers.
    pub determinant: S,
}

/// b_2 gamma^2 + b_1 gamma + b_0, equation (16).
#[derive(Clone, Debug)]
pub struct Polynomial<S> {
    /// b_2 = -(Omega/omega) v on a periodic orbit.
    pub quadratic: S,
    /// b_1.
    pub linear: S,
    /// b_0.
    pub constant: S,
}

/// What goes into (16): amplitudes and phase of an orbit. In the paper-literal variant they belong
/// to another flow than the one in the coefficients.
pub(crate) struct Amplitudes<S> {
    pub(crate) cosine: S,
    pub(crate) sine: S,
    pub(crate) force_cos: S,
    pub(crate) force_sin: S,
}

impl<S: Real> Amplitudes<S> {
    pub(crate) fn of(orbit: &EquivalentOrbit<S>) -> Self {
        Self {
            cosine: orbit.cosine.clone(),
            sine: orbit.sine.clone(),
            force_cos: orbit.forced_amplitude.clone() * &orbit.phase.0,
            force_sin: orbit.forced_amplitude.clone() * &orbit.phase.1,
        }
    }
    /// The same in other numbers.
    pub(crate) fn map<T>(&self, number: impl Fn(&S) -> T) -> Amplitudes<T> {
        Amplitudes {
            cosine: number(&self.cosine),
            sine: number(&self.sine),
            force_cos: number(&self.force_cos),
            force_sin: number(&self.force_sin),
        }
    }
}

/// (16), the determinant of the linearised equations of one flight and impact: with
/// p = Omega D + R C, r = R D - Omega C, K = F cos phi, Z = F sin phi
///
/// ```text
/// b_2 = Omega (Z - (E/omega)(p cos theta + r sin theta))
/// b_1 = E ((Omega/omega)(p (cos theta - R_r E) + r sin theta) - (R_r+1) omega K sin theta
///          + Z ((R_r-1) Omega cos theta + (R_r+1) R sin theta))
/// b_0 = R_r Omega E^2 (p/omega - Z)
/// ```
#[inline(always)]
pub(crate) fn polynomial<S: Real>(
    flow: &Flow<S>,
    drive: &Drive<S>,
    amplitudes: &Amplitudes<S>,
) -> Polynomial<S> {
    let Flow { growth_rate: rate, frequency } = flow;
    let Drive { omega, period, restitution, .. } = drive;
    let Amplitudes { cosine, sine, force_cos, force_sin } = amplitudes;
    let (sin, cos) = (frequency.clone() * period).sin_cos();
    let growth = (rate.clone() * period).exp();
    let p = frequency.clone() * sine + rate.clone() * cosine;
    let r = rate.clone() * sine - frequency.clone() * cosine;
    let one = omega.integer(1);
    let (more, less) = (restitution.clone() + &one, restitution.clone() - &one);
    let ratio = frequency.clone() / omega;
    let turned = p.clone() * &cos + r.clone() * &sin;
    let quadratic = frequency.clone() * force_sin - ratio.clone() * &growth * turned;
    let bounced = p.clone() * (cos.clone() - restitution.clone() * &growth) + r * &sin;
    let held = less * frequency * &cos + more.clone() * rate * &sin;
    let linear = ratio * bounced - more * omega * force_cos * &sin + held * force_sin;
    let constant = restitution.clone() * frequency * growth.square() * (p / omega - force_sin);
    Polynomial { quadratic, linear: linear * growth, constant }
}

impl<S: Real> EquivalentOrbit<S> {
    /// b_2, b_1, b_0 of (16) for this orbit and its own flow.
    pub fn polynomial(&self, flow: &Flow<S>, drive: &Drive<S>) -> Polynomial<S> {
        polynomial(flow, drive, &Amplitudes::of(self))
    }
}

impl<S: Real> Polynomial<S> {
    /// The map with this characteristic polynomial; not finite where b_2 may be zero.
    #[inline(always)]
    pub fn map(&self) -> ImpactMap<S> {
        ImpactMap {
            trace: -(self.linear.clone() / &self.quadratic),
            determinant: self.constant.clone() / &self.quadratic,
        }
    }
    /// |b_0/b_2| and |b_1/(b_0 + b_2)|: both below 1 is condition (17), which is exactly the
    /// condition of Jury for |gamma| < 1.
    pub fn conditions(&self) -> (S, S) {
        let absolute = |x: S| if x.to_f64() < 0.0 { -x } else { x };
        let first = self.constant.clone() / &self.quadratic;
        let sum = self.constant.clone() + &self.quadratic;
        (absolute(first), absolute(self.linear.clone() / &sum))
    }
}

impl<S: Real> ImpactMap<S> {
    /// The map of a free flow between impacts with saltation sigma:
    /// trace = E (sigma sin(theta)/Omega - 2 R_r cos theta), determinant = (R_r E)^2.
    #[inline(always)]
    pub fn from_saltation(flow: &Flow<S>, drive: &Drive<S>, saltation: &S) -> Self {
        let angle = (flow.frequency.clone() * &drive.period).sin_cos();
        let growth = (flow.growth_rate.clone() * &drive.period).exp();
        Self::compose(&angle, &growth, &flow.frequency, &drive.restitution, saltation)
    }
    /// The map of an orbit with the flow it belongs to.
    #[inline(always)]
    pub fn of_orbit(flow: &Flow<S>, drive: &Drive<S>, orbit: &EquivalentOrbit<S>) -> Self {
        let angle = &orbit.theta_sin_cos;
        Self::compose(angle, &orbit.growth, &flow.frequency, &drive.restitution, &orbit.saltation)
    }
    #[inline(always)]
    fn compose(
        (sin, cos): &(S, S),
        growth: &S,
        frequency: &S,
        restitution: &S,
        saltation: &S,
    ) -> Self {
        let shear = saltation.clone() * sin / frequency;
        let bounce = (restitution.clone() * cos).doubled();
        Self {
            trace: (shear - bounce) * growth,
            determinant: (restitution.clone() * growth).square(),
        }
    }
    /// The multipliers, larger modulus first; a complex pair with the positive imaginary part
    /// first. The smaller real root is determinant/larger, without cancellation.
    ///
    /// Where the ball of the discriminant trace^2/4 - determinant contains zero both are the
    /// rectangle around trace/2 that holds either case.
    pub fn multipliers(&self) -> [Complex<S>; 2] {
        let half = self.trace.halved();
        let discriminant = half.square() - &self.determinant;
        let zero = half.integer(0);
        if discriminant.sign().is_none() {
            let reach = undecided_root(&discriminant);
            let either = Complex::new(half.widened(&reach), zero.widened(&reach));
            return [either.clone(), either];
        }
        if discriminant.is_negative() {
            let im = (-discriminant).sqrt();
            return [Complex::new(half.clone(), im.clone()), Complex::new(half, -im)];
        }
        let root = discriminant.sqrt();
        let larger = if half.to_f64() < 0.0 { half - root } else { half + root };
        if larger.sign().is_some_and(|sign| sign.is_eq()) {
            return [Complex::real(zero.clone()), Complex::real(zero)];
        }
        let smaller = self.determinant.clone() / &larger;
        [Complex::new(larger, zero.clone()), Complex::new(smaller, zero)]
    }
    /// max |gamma|.
    pub fn spectral_radius(&self) -> S {
        let half = self.trace.halved();
        let discriminant = half.square() - &self.determinant;
        if discriminant.is_negative() {
            return self.determinant.sqrt();
        }
        if discriminant.sign().is_none() {
            let size = if half.to_f64() < 0.0 { -half } else { half };
            return size.widened(&undecided_root(&discriminant));
        }
        let size = if half.to_f64() < 0.0 { -half } else { half };
        size + discriminant.sqrt()
    }
    /// Jury's conditions for a real quadratic: stable if and only if |det| < 1 and
    /// |trace| < 1 + det. Neutral where one of them holds with equality within [`Real::neutral_width`]
    /// (doubles) or is not decided (balls) and none is violated.
    pub fn verdict(&self) -> Verdict {
        let one = self.trace.integer(1);
        let sum = one.clone() + &self.determinant;
        let conditions =
            [one - &self.determinant, sum.clone(), sum.clone() - &self.trace, sum + &self.trace];
        let mut verdict = Verdict::Stable;
        for condition in conditions {
            let clear = condition.to_f64().abs() > condition.neutral_width();
            match condition.sign() {
                Some(sign) if sign.is_gt() && clear => {}
                Some(sign) if sign.is_lt() && clear => return Verdict::Unstable,
                _ => verdict = Verdict::Neutral,
            }
        }
        verdict
    }
}

/// A bound of sqrt|x| for a ball x that contains zero (NaN for a NaN).
fn undecided_root<S: Real>(x: &S) -> S {
    x.number(x.magnitude_above()).sqrt().doubled()
}
