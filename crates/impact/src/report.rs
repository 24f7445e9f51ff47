//! One parameter point: the true orbit, the prediction and the truth side by side.

use crate::aware::{AwarePrediction, impact_aware};
use crate::characteristic::{Characteristic, Kick, check};
use crate::convergence::{Convergence, convergence};
use crate::equivalent::{Drive, equivalent_orbit};
use crate::error::ImpactError;
use crate::flight::{Clearance, clearance};
use crate::flow::{Flow, rates};
use crate::kick::{Growth, piecewise_growth};
use crate::map::Verdict;
use crate::orbit::{Orbit, orbit};
use crate::parameters::{ExactParameters, Parameters};
use crate::prediction::{Prediction, Variant, mismatch, predict, predicted_flow, uncontrolled_map};
use crate::zeros::{Multipliers, exact_verdict, multipliers};
use lindstedt_algebra::Stop;
use lindstedt_number::real::{Certified, Real};

/// Flights of the piecewise linear return map that decide for B != 0.
const FLIGHTS: usize = 800;

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// Variant of the paper's prediction.
    pub variant: Variant,
    /// Order of the flow, at least 1.
    pub order: usize,
    /// Treatment of the velocity kick in G; irrelevant for B = 0.
    pub kick: Kick,
    /// Multipliers of the delayed system are listed down to this modulus.
    pub least_modulus: f64,
    /// Whether to compute the impact-aware prediction too.
    pub impact_aware: bool,
}

impl Default for Request {
    /// Variant E, order 1, mean kick, multipliers down to 0.1, impact-aware.
    fn default() -> Self {
        Self {
            variant: Variant::E,
            order: 1,
            kick: Kick::Mean,
            least_modulus: 0.1,
            impact_aware: true,
        }
    }
}

/// The true orbit, for every A, B.
#[derive(Clone, Debug)]
pub struct OrbitReport<S> {
    /// Impact velocity, force phase, accelerations, saltation.
    pub orbit: Orbit<S>,
    /// phi, C, D of the form (8); `None` for alpha = omega without damping (F infinite) and for
    /// c >= 2 alpha (no oscillation).
    pub form: Option<FormReport<S>>,
    /// The largest interior local maximum of x - s, if there is one.
    pub clearance: Option<Clearance<S>>,
    /// Whether the flight passes through the wall; `None` if undecided (touching).
    pub penetrates: Option<bool>,
}

/// The orbit in the form (8): x = F cos(omega t + phi) + e^(R t)(C cos Omega t + D sin Omega t).
#[derive(Clone, Debug)]
pub struct FormReport<S> {
    /// phi.
    pub phase: S,
    /// C.
    pub cosine: S,
    /// D.
    pub sine: S,
}

/// The paper's prediction. Not the stability of the delayed system.
#[derive(Clone, Debug)]
pub struct PredictionReport<S> {
    /// Flow, orbit, polynomial, trace and determinant.
    pub prediction: Prediction<S>,
    /// Verdict of (17).
    pub verdict: Verdict,
}

/// The truth about the delayed system.
#[derive(Clone, Debug)]
pub struct ExactReport<S> {
    /// By the zeros of G in the unit disc for B = 0: exact; else by the growth of the piecewise linear
    /// return map, neutral where that is not told from 1.
    pub verdict: Verdict,
    /// The number of zeros of G in the unit disc; `None` if undecided.
    pub zeros_in_unit_disc: Option<u32>,
    /// Floquet multipliers 1/w, or why they could not be enclosed.
    pub multipliers: Result<Multipliers<S>, ImpactError>,
    /// Growth of the piecewise linear return map, for B != 0: it has no classical multipliers.
    pub growth: Option<Growth>,
}

/// Everything about one point.
#[derive(Clone, Debug)]
pub struct StabilityReport<S> {
    /// The true orbit or why there is none.
    pub orbit: Result<OrbitReport<S>, ImpactError>,
    /// R and alpha0 of the averaged flow, which may exist without an orbit of its own.
    pub flow: Option<Flow<S>>,
    /// The prediction or why there is none.
    pub kbm: Result<PredictionReport<S>, ImpactError>,
    /// The impact-aware prediction if asked for.
    pub impact_aware: Option<Result<AwarePrediction<S>, ImpactError>>,
    /// The truth, if the orbit exists.
    pub exact: Option<ExactReport<S>>,
    /// m: plain KBM can be believed below 1 and is mostly wrong above 2; `None` without an orbit.
    pub mismatch: Option<S>,
    /// Convergence of the KBM series at eps = 1. Estimated.
    pub convergence: Convergence,
    /// |lambda^2 + alpha^2 - g(lambda)| of the truncated series.
    pub residual: Option<S>,
}

/// The report for one point: the orbit, the averaged prediction in the variant and order of the request,
/// and the truth by the zeros of G(w). Certified over balls, estimated over doubles; see the fields for
/// what is estimated in both.
///
/// ```
/// use lindstedt_impact::map::Verdict;
/// use lindstedt_impact::parameters::{Branch, Parameters};
/// use lindstedt_algebra::Stop;
/// use lindstedt_impact::report::{Request, stability};
///
/// let parameters = Parameters {
///     alpha: 1.0, omega: 3.3, periods: 2, restitution: 0.8, wall: 0.0, damping: 0.05,
///     force: 1.0, displacement_gain: 0.2, velocity_gain: 0.0, branch: Branch::Plus,
/// };
/// let report = stability(&parameters, &Request::default(), &Stop::default()).unwrap();
/// assert_eq!(report.kbm.unwrap().verdict, Verdict::Stable); // the prediction
/// let exact = report.exact.unwrap();
/// assert_eq!(exact.verdict, Verdict::Unstable); // the truth
/// assert_eq!(exact.zeros_in_unit_disc, Some(2));
/// ```
///
/// # Errors
/// Invalid parameters, order 0 and [`ImpactError::Cancelled`] only; a missing orbit or prediction stands in the report.
pub fn stability<S: Real>(
    parameters: &Parameters<S>,
    request: &Request,
    stop: &Stop,
) -> Result<StabilityReport<S>, ImpactError> {
    parameters.validate()?;
    if request.order == 0 {
        return Err(ImpactError::OrderZero);
    }
    let rates = rates(parameters, request.order);
    let doubles: Vec<_> = rates.terms.iter().map(|term| term.to_f64()).collect();
    let midpoint = parameters.to_f64();
    let flow = predicted_flow(parameters, &rates, request.order);
    let found = orbit(parameters);
    check(stop)?;
    let map = found.as_ref().ok().map(|orbit| uncontrolled_map(parameters, orbit));
    let kbm = flow.clone().and_then(|flow| {
        let prediction = predict(request.variant, parameters, &flow, found.as_ref().ok())?;
        Ok(PredictionReport { verdict: prediction.map.verdict(), prediction })
    });
    check(stop)?;
    let aware =
        |orbit: &Orbit<S>| impact_aware(parameters, orbit, request.kick, request.order, stop);
    let report = StabilityReport {
        kbm,
        impact_aware: match &found {
            Ok(orbit) if request.impact_aware => Some(aware(orbit)),
            _ => None,
        },
        exact: found.as_ref().ok().map(|orbit| exact_report(parameters, orbit, request, stop)),
        mismatch: map.map(|map| mismatch(parameters, &map, &parameters.period())),
        convergence: convergence(&midpoint, &doubles),
        residual: flow.as_ref().ok().map(|flow| flow.residual(parameters)),
        flow: flow.ok(),
        orbit: found.and_then(|orbit| orbit_report(parameters, orbit, stop)),
    };
    // What was stopped on the way looks undecided.
    check(stop)?;
    Ok(report)
}

fn orbit_report<S: Real>(
    parameters: &Parameters<S>,
    orbit: Orbit<S>,
    stop: &Stop,
) -> Result<OrbitReport<S>, ImpactError> {
    let form = Flow::uncontrolled(parameters)
        .and_then(|flow| equivalent_orbit(&flow, &Drive::new(parameters)?))
        .ok()
        .map(|form| FormReport { phase: form.phase_angle(), cosine: form.cosine, sine: form.sine });
    let clearance = clearance(parameters, &orbit, stop);
    let penetrates = match &clearance {
        Ok(None) => Some(false),
        Ok(Some(found)) => found.margin.sign().and_then(|sign| match sign {
            std::cmp::Ordering::Equal => None,
            sign => Some(sign.is_gt()),
        }),
        Err(_) => None,
    };
    Ok(OrbitReport { orbit, form, clearance: clearance.ok().flatten(), penetrates })
}

fn exact_report<S: Real>(
    parameters: &Parameters<S>,
    orbit: &Orbit<S>,
    request: &Request,
    stop: &Stop,
) -> ExactReport<S> {
    let g = Characteristic::new(parameters, orbit, request.kick).watched(stop);
    let (mut verdict, zeros_in_unit_disc) = exact_verdict(&g);
    let mut growth = None;
    if !parameters.velocity_gain.sign().is_some_and(|sign| sign.is_eq()) {
        growth = piecewise_growth(&parameters.to_f64(), &orbit.to_f64(), FLIGHTS, stop).ok();
        verdict = growth.as_ref().map_or(Verdict::Neutral, Growth::verdict);
    }
    let multipliers = multipliers(&g, request.least_modulus);
    ExactReport { verdict, zeros_in_unit_disc, multipliers, growth }
}

/// The report with every number to `digits` digits where that is possible.
///
/// The precision is doubled until the radii are small enough, three times at most; numbers that
/// have fewer digits then (exact zeros, decisions on a boundary) show it in their radius.
///
/// # Errors
/// As [`stability`].
pub fn certified_stability(
    parameters: &ExactParameters,
    request: &Request,
    digits: u32,
    stop: &Stop,
) -> Result<StabilityReport<Certified>, ImpactError> {
    let wanted = digits.saturating_mul(4).saturating_add(8);
    let mut bits = wanted.saturating_add(64);
    let mut rounds = 0;
    loop {
        let report = stability(&parameters.certified(bits), request, stop)?;
        rounds += 1;
        if rounds > 3 || report.has_bits(i64::from(wanted) * 5 / 6) {
            return Ok(report);
        }
        bits = bits.saturating_mul(2);
    }
}

impl StabilityReport<Certified> {
    /// Whether every certified number has a relative radius below 2^-bits (exact ones count), and
    /// no verdict is open.
    fn has_bits(&self, bits: i64) -> bool {
        let good = |x: &Certified| x.ball().relative_accuracy_bits() >= bits;
        let orbit = self.orbit.as_ref().map_or_else(settled, |found| {
            let form = found
                .form
                .as_ref()
                .is_none_or(|form| good(&form.phase) && good(&form.cosine) && good(&form.sine));
            good(&found.orbit.velocity) && found.penetrates.is_some() && form
        });
        let kbm = self.kbm.as_ref().map_or_else(settled, |found| {
            let polynomial = found
                .prediction
                .polynomial
                .as_ref()
                .is_none_or(|b| good(&b.quadratic) && good(&b.linear) && good(&b.constant));
            polynomial && good(&found.prediction.map.trace) && found.verdict != Verdict::Neutral
        });
        let exact = self.exact.as_ref().is_none_or(|found| {
            found.verdict != Verdict::Neutral
                && found
                    .multipliers
                    .as_ref()
                    .is_ok_and(|list| list.values.iter().all(|gamma| good(&gamma.modulus())))
        });
        orbit && kbm && exact
    }
}

/// Whether more precision would not change this refusal.
fn settled(error: &ImpactError) -> bool {
    !matches!(
        error,
        ImpactError::Undecided { .. }
            | ImpactError::PeriodicFreeFlow { .. }
            | ImpactError::ImpactResonance { .. }
            | ImpactError::NoPositiveVelocity { .. }
            | ImpactError::NoConvergence { .. }
    )
}
