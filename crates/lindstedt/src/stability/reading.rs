//! From a report of the engine to plain data, and what to beware of.

use super::OrbitStability;
use super::point::{
    Aware, Found, Multiplier, Predicted, PredictedOrbit, ReturnMap, TrueOrbit, Truth,
};
use super::subject::Subject;
use crate::choices::{Choice, KICKS};
use crate::{Number, Remark, Status};
use lindstedt_impact::ImpactError;
use lindstedt_impact::aware::AwarePrediction;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::equivalent::EquivalentOrbit;
use lindstedt_impact::map::Verdict;
use lindstedt_impact::report::{ExactReport, OrbitReport, StabilityReport};
use lindstedt_impact::{Radius, divergence};
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// What the multipliers are for B != 0, whatever is known of their digits.
const ROOTS_OF_G: &str = "zeros of G, which approximates the return map; their digits are those of \
                          the zeros, not of multipliers of the map";
const PENETRATES: &str = "no orbit: the flight passes through the wall";
/// B is not 0, as zeros of G would have decided.
const NO_GROWTH: &str = "undecided: the return map could not be followed";
const GROWTH_NEAR_ONE: &str = "undecided: the growth per impact is not told from 1";

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Neutral => "undecided: a multiplier is not told from the unit circle",
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
        // The multipliers of a flight through the wall are those of a system without wall on the way.
        let (stable, words) = match exists {
            Some(true) => match (found.verdict, growth) {
                (Verdict::Neutral, Some(_)) => (None, GROWTH_NEAR_ONE),
                (Verdict::Neutral, None) if found.zeros_in_unit_disc.is_some() => (None, NO_GROWTH),
                (verdict, _) => (stable(verdict), word(verdict)),
            },
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
            kick: Some(Choice::word(KICKS, growth.map_or(Kick::None, |_| subject.question.kick))),
            return_map: growth.map(|growth| ReturnMap {
                growth_per_impact: growth.rate,
                spread: growth.spread,
                error: growth.error,
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
        let exists = orbit.exists();
        let verdict = if exists.is_none() { "undecided: no orbit was found" } else { "no orbit" };
        let none = || Truth { verdict, ..Truth::default() };
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
            (Found::Missing { reason, .. }, Some(_)) => list.push(format!("no orbit: {reason}")),
            (Found::Missing { reason, .. }, None) => list.push(reason.clone()),
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
