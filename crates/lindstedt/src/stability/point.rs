//! One point as plain data: the true orbit, the prediction and the truth.

use super::OrbitStability;
use super::subject::Subject;
use crate::averaging::{Radius, divergence};
use crate::{Number, Remark, Status};
use lindstedt_impact::ImpactError;
use lindstedt_impact::aware::AwarePrediction;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::equivalent::EquivalentOrbit;
use lindstedt_impact::kick::Growth;
use lindstedt_impact::map::Verdict;
use lindstedt_impact::report::{ExactReport, OrbitReport, StabilityReport};
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;
use serde::Serialize;

/// What the multipliers are for B != 0, whatever is known of their digits.
const ROOTS_OF_G: &str = "zeros of G, which approximates the return map; their digits are those of \
                          the zeros, not of multipliers of the map";
const PENETRATES: &str = "no orbit: the flight passes through the wall";

/// Something that may not exist.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Found<T> {
    /// It does.
    There(T),
    /// It does not.
    Missing {
        /// No.
        exists: bool,
        /// Why.
        reason: String,
    },
}

impl<T> Found<T> {
    fn missing(error: &ImpactError) -> Self {
        Self::Missing { exists: false, reason: error.to_string() }
    }
}

impl Found<TrueOrbit> {
    /// Whether the orbit exists: not with a flight through the wall, undecided with one that
    /// touches it.
    #[must_use]
    pub fn exists(&self) -> Option<bool> {
        match self {
            Self::There(orbit) => orbit.exists,
            Self::Missing { .. } => Some(false),
        }
    }
}

/// A multiplier: real and imaginary part.
pub type Multiplier = [Number; 2];

/// The orbit of the true system.
#[derive(Clone, Debug, Serialize)]
pub struct TrueOrbit {
    /// Whether it exists; nothing where the flight touches the wall.
    pub exists: Option<bool>,
    /// v, the velocity before the impact.
    pub impact_velocity: Number,
    /// phi of F cos(omega t + phi) + e^(R t) (C cos Omega t + D sin Omega t), where this form exists.
    pub phase: Option<Number>,
    /// C.
    #[serde(rename = "C")]
    pub cosine: Option<Number>,
    /// D.
    #[serde(rename = "D")]
    pub sine: Option<Number>,
    /// Whether the flight passes through the wall; nothing where it touches.
    pub penetrates: Option<bool>,
    /// The largest x - s inside the flight, if x has a maximum there.
    pub clearance: Option<Number>,
    /// The phase of the force at the impact.
    pub force_phase: Number,
    /// x'' before the impact.
    pub acceleration_before: Number,
    /// x'' after it.
    pub acceleration_after: Number,
    /// The lower left entry of the saltation matrix.
    pub saltation: Number,
    /// Of the equation for v; zero at the fold.
    pub discriminant: Number,
}

/// The orbit of the averaged flow.
#[derive(Clone, Debug, Serialize)]
pub struct PredictedOrbit {
    /// Yes.
    pub exists: bool,
    /// v.
    pub impact_velocity: Number,
    /// phi.
    pub phase: Number,
    /// C.
    #[serde(rename = "C")]
    pub cosine: Number,
    /// D.
    #[serde(rename = "D")]
    pub sine: Number,
}

/// What averaging predicts.
#[derive(Clone, Debug, Serialize)]
pub struct Predicted {
    /// The order of the flow.
    pub order: usize,
    /// The variant.
    pub variant: &'static str,
    /// R, the growth rate of the flow.
    #[serde(rename = "R")]
    pub growth_rate: Option<Number>,
    /// alpha_0, its frequency.
    pub alpha0: Option<Number>,
    /// b_2, b_1, b_0 of the characteristic polynomial (variants E and P).
    pub b2: Option<Number>,
    /// b_1.
    pub b1: Option<Number>,
    /// b_0.
    pub b0: Option<Number>,
    /// The trace of the map.
    pub trace: Option<Number>,
    /// Its determinant.
    pub determinant: Option<Number>,
    /// Its multipliers.
    pub multipliers: Option<[Multiplier; 2]>,
    /// The verdict; nothing where undecided.
    pub stable: Option<bool>,
    /// The verdict in words.
    pub verdict: Option<&'static str>,
    /// The orbit of the flow (not of variant S).
    pub orbit: Option<Found<PredictedOrbit>>,
    /// m: averaging can be believed below 1.
    pub mismatch: Option<Number>,
    /// |lambda^2 + alpha^2 - g(lambda)| of the truncated series.
    pub residual: Option<Number>,
    /// Where the averaged series converges.
    pub convergence: Radius,
}

/// Averaging that knows of the impact within the delay.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Aware {
    /// Estimated.
    There {
        /// The multipliers in doubles.
        multipliers: Vec<Multiplier>,
        /// The verdict.
        stable: Option<bool>,
        /// The order.
        order: usize,
        /// Estimated.
        status: Status,
    },
    /// None.
    Missing {
        /// Why.
        reason: String,
    },
}

/// The truth about the delayed system.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Truth {
    /// The verdict; nothing where undecided or neutral.
    pub stable: Option<bool>,
    /// The verdict in words.
    pub verdict: &'static str,
    /// The multipliers: exact for B = 0, else zeros of G.
    pub multipliers: Vec<Multiplier>,
    /// What they are, for B != 0.
    pub multipliers_of: Option<&'static str>,
    /// All multipliers of a larger modulus are listed.
    pub complete_to_modulus: Option<f64>,
    /// Why there are none.
    pub multipliers_missing: Option<String>,
    /// The number of zeros of G in the unit disc; nothing where undecided.
    pub zeros_in_unit_disc: Option<u32>,
    /// How the kick of B was treated.
    pub kick: Option<&'static str>,
    /// Growth of the piecewise linear return map, which decides for B != 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub return_map: Option<ReturnMap>,
}

/// Growth of the return map by iteration.
#[derive(Clone, Debug, Serialize)]
pub struct ReturnMap {
    /// The factor per impact.
    pub growth_per_impact: f64,
    /// The difference between two starts.
    pub spread: f64,
    /// The same.
    pub error: f64,
    /// Estimated.
    pub status: Status,
    /// The verdict.
    pub verdict: &'static str,
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Neutral => "undecided: a multiplier on or near the unit circle",
    }
}

/// A verdict as a truth value.
pub(super) fn stable(verdict: Verdict) -> Option<bool> {
    match verdict {
        Verdict::Stable => Some(true),
        Verdict::Unstable => Some(false),
        Verdict::Neutral => None,
    }
}

fn kick_name(kick: Kick) -> &'static str {
    match kick {
        Kick::None => "none",
        Kick::Mean => "mean",
        Kick::Before => "before",
        Kick::After => "after",
    }
}

/// Numbers of one report as they are printed.
struct Writer<'a, S>(&'a dyn Fn(&S) -> Number);

impl<S: Real> Writer<'_, S> {
    fn number(&self, x: &S) -> Number {
        (self.0)(x)
    }

    fn pair(&self, z: &Complex<S>) -> Multiplier {
        [self.number(&z.re), self.number(&z.im)]
    }

    fn orbit(&self, found: &OrbitReport<S>) -> TrueOrbit {
        let (orbit, form) = (&found.orbit, found.form.as_ref());
        TrueOrbit {
            exists: found.penetrates.map(|penetrates| !penetrates),
            impact_velocity: self.number(&orbit.velocity),
            phase: form.map(|form| self.number(&form.phase)),
            cosine: form.map(|form| self.number(&form.cosine)),
            sine: form.map(|form| self.number(&form.sine)),
            penetrates: found.penetrates,
            clearance: found.clearance.as_ref().map(|c| self.number(&c.margin)),
            force_phase: self.number(&orbit.force_angle()),
            acceleration_before: self.number(&orbit.acceleration_before),
            acceleration_after: self.number(&orbit.acceleration_after),
            saltation: self.number(&orbit.saltation),
            discriminant: self.number(&orbit.discriminant),
        }
    }

    fn predicted_orbit(&self, orbit: &EquivalentOrbit<S>) -> PredictedOrbit {
        PredictedOrbit {
            exists: true,
            impact_velocity: self.number(&orbit.velocity),
            phase: self.number(&orbit.phase_angle()),
            cosine: self.number(&orbit.cosine),
            sine: self.number(&orbit.sine),
        }
    }

    fn predicted(&self, subject: &Subject<'_>, report: &StabilityReport<S>) -> Predicted {
        let kbm = report.kbm.as_ref().map(|found| (&found.prediction, found.verdict));
        let prediction = kbm.as_ref().ok().map(|(prediction, _)| *prediction);
        let verdict = kbm.as_ref().ok().map(|(_, verdict)| *verdict);
        let polynomial = prediction.and_then(|p| p.polynomial.as_ref());
        let map = prediction.map(|p| &p.map);
        let flow = report.flow.as_ref();
        Predicted {
            order: subject.question.order,
            variant: subject.question.variant_name(),
            growth_rate: flow.map(|flow| self.number(&flow.growth_rate)),
            alpha0: flow.map(|flow| self.number(&flow.frequency)),
            b2: polynomial.map(|b| self.number(&b.quadratic)),
            b1: polynomial.map(|b| self.number(&b.linear)),
            b0: polynomial.map(|b| self.number(&b.constant)),
            trace: map.map(|map| self.number(&map.trace)),
            determinant: map.map(|map| self.number(&map.determinant)),
            multipliers: map.map(|map| map.multipliers().map(|z| self.pair(&z))),
            stable: verdict.and_then(stable),
            verdict: verdict.map(word),
            orbit: match kbm {
                Ok((p, _)) => p.orbit.as_ref().map(|o| Found::There(self.predicted_orbit(o))),
                Err(error) => Some(Found::missing(error)),
            },
            mismatch: report.mismatch.as_ref().map(|m| self.number(m)),
            residual: report.residual.as_ref().map(|r| self.number(r)),
            convergence: Radius::new(&report.convergence),
        }
    }

    fn truth(&self, subject: &Subject<'_>, found: &ExactReport<S>, exists: Option<bool>) -> Truth {
        let growth = found.growth.as_ref();
        let verdict = match growth.map(Growth::verdict) {
            Some(Verdict::Neutral) | None => found.verdict,
            Some(decided) => decided,
        };
        // The multipliers of a flight through the wall are those of a system without wall on the way.
        let (stable, words) = match exists {
            Some(true) => (stable(verdict), word(verdict)),
            Some(false) => (None, PENETRATES),
            None => (None, "undecided: the flight touches the wall"),
        };
        let list = found.multipliers.as_ref();
        let pairs = |values: &Vec<Complex<S>>| values.iter().map(|z| self.pair(z)).collect();
        Truth {
            stable,
            verdict: words,
            multipliers: list.map(|list| pairs(&list.values)).unwrap_or_default(),
            multipliers_of: growth.filter(|_| list.is_ok()).map(|_| ROOTS_OF_G),
            complete_to_modulus: list.ok().map(|list| list.complete_to),
            multipliers_missing: list.err().map(ToString::to_string),
            zeros_in_unit_disc: found.zeros_in_unit_disc,
            kick: Some(kick_name(growth.map_or(Kick::None, |_| subject.question.kick))),
            return_map: growth.map(|growth| ReturnMap {
                growth_per_impact: growth.rate,
                spread: growth.spread,
                error: growth.spread,
                status: Status::Estimated,
                verdict: word(growth.verdict()),
            }),
        }
    }
}

fn aware<S: Real>(found: &Result<AwarePrediction<S>, ImpactError>, order: usize) -> Aware {
    let double = |z: &Complex<S>| {
        let z = z.to_f64();
        [Number::double(z.re), Number::double(z.im)]
    };
    match found {
        Ok(found) => Aware::There {
            multipliers: found.multipliers.iter().map(double).collect(),
            stable: stable(found.verdict()),
            order,
            status: Status::Estimated,
        },
        Err(error) => Aware::Missing { reason: error.to_string() },
    }
}

impl Subject<'_> {
    /// The answer about one point.
    pub fn answer<S: Real>(
        &self,
        report: &StabilityReport<S>,
        number: &dyn Fn(&S) -> Number,
    ) -> OrbitStability {
        let writer = Writer(number);
        let orbit = match &report.orbit {
            Ok(found) => Found::There(writer.orbit(found)),
            Err(error) => Found::missing(error),
        };
        let none = || Truth { verdict: "no orbit", ..Truth::default() };
        let exists = orbit.exists();
        let exact = report.exact.as_ref();
        let truth = || exact.map_or_else(none, |found| writer.truth(self, found, exists));
        let beside = report.impact_aware.as_ref().filter(|_| self.question.predict);
        OrbitStability {
            canonical: self.canonical(),
            kbm: self.question.predict.then(|| writer.predicted(self, report)),
            impact_aware: beside.map(|found| aware(found, self.question.order)),
            exact: self.question.exact.then(truth),
            grid: None,
            warnings: self.warnings(report, &orbit).into_iter().map(Remark).collect(),
            error: None,
            orbit,
        }
    }

    /// What to beware of.
    fn warnings<S: Real>(
        &self,
        report: &StabilityReport<S>,
        orbit: &Found<TrueOrbit>,
    ) -> Vec<String> {
        let mut list = Vec::new();
        match (orbit, orbit.exists()) {
            (Found::Missing { reason, .. }, _) => list.push(format!("no orbit: {reason}")),
            (_, Some(true)) => {}
            (_, Some(false)) => list.push(PENETRATES.to_owned()),
            (_, None) => {
                list.push("it is not decided whether the flight passes the wall".to_owned());
            }
        }
        let at = &self.found.parameters;
        // Without gains there is no loop whose delay an impact could fall in.
        let has_loop = [&at.displacement_gain, &at.velocity_gain].iter().any(|k| k.sign().is_ne());
        let mismatch = report.mismatch.as_ref().map(Real::to_f64);
        if self.question.predict {
            if report.convergence.diverges() {
                list.push(divergence(&report.convergence));
            }
            if has_loop && mismatch.is_some_and(|m| m > 1.0) {
                list.push(
                    "the mismatch is above 1: averaging ignores the impact within the delay and is \
                     not to be believed here"
                        .to_owned(),
                );
            }
        }
        if self.found.other_orders {
            list.push(
                "the averaged prediction counts damping and delay loop as of order 1 in the small \
                 parameter, whatever their order in the file"
                    .to_owned(),
            );
        }
        list
    }
}
