//! The paper's prediction of stability: an impact map with the equivalent flow in place of the
//! delay loop.
//!
//! The equivalent flow replaces z(t-T) by e^(-lambda T) z(t), as if no impact lay in the delay
//! interval; exactly one does. These verdicts are predictions, not the stability of the delayed
//! system: see [`crate::characteristic`].

use crate::equivalent::{Drive, EquivalentOrbit, equivalent_orbit, equivalent_orbit_here};
use crate::error::ImpactError;
use crate::flow::{Flow, Rates};
use crate::map::{Amplitudes, ImpactMap, Polynomial, polynomial};
use crate::orbit::{Orbit, orbit};
use crate::parameters::Parameters;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// Which orbit meets which flow in the impact map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Orbit and map both of the equivalent flow (self-consistent).
    E,
    /// The paper's letter: amplitudes of the uncontrolled orbit, (R, alpha0) in (16).
    P,
    /// Saltation of the true orbit, equivalent flow between the impacts.
    S,
}

/// A predicted impact map.
#[derive(Clone, Debug)]
pub struct Prediction<S> {
    /// R and alpha0 used.
    pub flow: Flow<S>,
    /// The orbit of the equivalent flow (variant E), of the uncontrolled flow (P), none for S.
    pub orbit: Option<EquivalentOrbit<S>>,
    /// b_2, b_1, b_0 (variants E and P).
    pub polynomial: Option<Polynomial<S>>,
    /// Trace and determinant.
    pub map: ImpactMap<S>,
}

/// R and alpha0 at the given order, checked.
///
/// # Errors
/// [`ImpactError::OrderZero`], [`ImpactError::Overdamped`], [`ImpactError::NotApplicable`].
pub fn predicted_flow<S: Real>(
    parameters: &Parameters<S>,
    rates: &Rates<S>,
    order: usize,
) -> Result<Flow<S>, ImpactError> {
    Flow::uncontrolled(parameters)?;
    let flow = if order == 0 { None } else { rates.flow(order) }.ok_or(ImpactError::OrderZero)?;
    flow.validate()?;
    Ok(flow)
}

/// The prediction of a variant with the flow of some order.
///
/// For variant E the determinant is formed as (R_r E)^2 and the trace from the saltation, which
/// stays accurate where b_2 vanishes (grazing). Variant S computes the true orbit unless given.
///
/// # Errors
/// The errors of the orbit that the variant needs; [`ImpactError::Resonance`] for E and P at
/// alpha = omega, c = 0.
pub fn predict<S: Real>(
    variant: Variant,
    parameters: &Parameters<S>,
    flow: &Flow<S>,
    true_orbit: Option<&Orbit<S>>,
) -> Result<Prediction<S>, ImpactError> {
    flow.validate()?;
    let ground = Ground::new(variant, parameters, true_orbit)?;
    let form = match &ground {
        Ground::Own(drive) => Some((drive, equivalent_orbit(flow, drive)?)),
        Ground::Literal(drive, _) => Some((drive, uncontrolled_orbit(parameters, drive)?)),
        Ground::True(..) => None,
    };
    let polynomial = form.as_ref().map(|(drive, form)| form.polynomial(flow, drive));
    let map = ground.map(flow)?;
    Ok(Prediction { flow: flow.clone(), orbit: form.map(|(_, form)| form), polynomial, map })
}

fn uncontrolled_orbit<S: Real>(
    parameters: &Parameters<S>,
    drive: &Drive<S>,
) -> Result<EquivalentOrbit<S>, ImpactError> {
    equivalent_orbit(&Flow::uncontrolled(parameters)?, drive)
}

/// What a variant takes from the oscillator besides the flow: nothing of it depends on the gains A, B.
pub(crate) enum Ground<S> {
    /// E.
    Own(Drive<S>),
    /// P: the amplitudes of the orbit of the uncontrolled flow.
    Literal(Drive<S>, Amplitudes<S>),
    /// S: the saltation of the true orbit.
    True(Drive<S>, S),
}

impl<S: Real> Ground<S> {
    /// The errors of [`predict`] that do not depend on the flow.
    pub(crate) fn new(
        variant: Variant,
        parameters: &Parameters<S>,
        true_orbit: Option<&Orbit<S>>,
    ) -> Result<Self, ImpactError> {
        let of_orbit = |orbit: &Orbit<S>| {
            // F is not needed for the map.
            let drive = Drive {
                omega: parameters.omega.clone(),
                period: orbit.period.clone(),
                restitution: parameters.restitution.clone(),
                wall: parameters.wall.clone(),
                forced_amplitude: parameters.omega.integer(0),
                branch: parameters.branch,
            };
            Self::True(drive, orbit.saltation.clone())
        };
        Ok(match (variant, true_orbit) {
            (Variant::E, _) => Self::Own(Drive::new(parameters)?),
            (Variant::P, _) => {
                let drive = Drive::new(parameters)?;
                let amplitudes = Amplitudes::of(&uncontrolled_orbit(parameters, &drive)?);
                Self::Literal(drive, amplitudes)
            }
            (Variant::S, Some(orbit)) => of_orbit(orbit),
            (Variant::S, None) => of_orbit(&orbit(parameters)?),
        })
    }

    /// The same in other numbers.
    pub(crate) fn convert<T>(&self, number: impl Fn(&S) -> T + Copy) -> Ground<T> {
        match self {
            Self::Own(drive) => Ground::Own(drive.map(number)),
            Self::Literal(drive, form) => Ground::Literal(drive.map(number), form.map(number)),
            Self::True(drive, saltation) => Ground::True(drive.map(number), number(saltation)),
        }
    }

    /// The predicted map.
    #[inline(always)]
    pub(crate) fn map(&self, flow: &Flow<S>) -> Result<ImpactMap<S>, ImpactError> {
        flow.validate()?;
        Ok(match self {
            Self::Own(drive) => {
                ImpactMap::of_orbit(flow, drive, &equivalent_orbit_here(flow, drive)?)
            }
            Self::Literal(drive, form) => polynomial(flow, drive, form).map(),
            Self::True(drive, saltation) => ImpactMap::from_saltation(flow, drive, saltation),
        })
    }
}

/// The impact map of the uncontrolled oscillator (A = B = 0) on its true orbit; any damping.
pub fn uncontrolled_map<S: Real>(parameters: &Parameters<S>, orbit: &Orbit<S>) -> ImpactMap<S> {
    let (h, slope) = &orbit.response;
    let c = &parameters.damping;
    // tr(S Phi) = sigma h - R_r (2 h' + c h), det = R_r^2 e^(-cT)
    let free_trace = slope.doubled() + c.clone() * h;
    let contraction = (-(c.clone() * &orbit.period)).exp();
    ImpactMap {
        trace: orbit.saltation.clone() * h - parameters.restitution.clone() * free_trace,
        determinant: parameters.restitution.square() * contraction,
    }
}

/// m = max over +- of |1/gamma_0 - e^(+- i alpha T)| with gamma_0 the leading multiplier of the
/// uncontrolled map: how wrong e^(-lambda T) is in place of 1/gamma.
///
/// Measured: below 1 the predicted effect of A has the right sign in 98% of cases, above 2 the
/// wrong one in about 90%.
pub fn mismatch<S: Real>(parameters: &Parameters<S>, uncontrolled: &ImpactMap<S>, period: &S) -> S {
    let [leading, _] = uncontrolled.multipliers();
    let inverse = leading.inverse();
    let (sin, cos) = (parameters.alpha.clone() * period).sin_cos();
    let ahead = (inverse.clone() - Complex::new(cos.clone(), sin.clone())).modulus();
    let behind = (inverse - Complex::new(cos, -sin)).modulus();
    if ahead.to_f64() >= behind.to_f64() { ahead } else { behind }
}
