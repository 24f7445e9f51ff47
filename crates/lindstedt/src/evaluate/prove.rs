//! The orbit as a theorem: exactly one periodic orbit within a radius of the numbers, whether or not
//! the series converges, which gives no more than the guess ([`lindstedt_orbit`]).

use super::turn::TimeDomain;
use super::{Evaluate, Evaluation, Trajectory};
use crate::refusal::Refused;
use crate::{Answer, DerivationError, Error, Number, Oscillator, Remark, Standing, Status, Work};
use lindstedt_equation::{AmplitudeRole, Condition};
use lindstedt_number::ball::Ball;
use lindstedt_orbit::{Failure, Field, Kind, Proof, Request, Stability, Start, prove};
use rug::float::Round;
use rug::{Float, Rational};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Harmonics of the guess from the expansion; Newton's method finds the others.
const GUESSED: usize = 11;

/// Digits of the expansion's sum for it.
const DIGITS_OF_A_GUESS: u32 = 16;

/// A periodic orbit, proved or as it was estimated before.
#[derive(Clone, Debug, Serialize)]
pub struct ProvedOrbit {
    /// The period.
    pub period: Option<Number>,
    /// 2 pi over it.
    pub frequency: Option<Number>,
    /// x at phase 0, where the first harmonic has no sine or x' = 0.
    pub amplitude: Option<Number>,
    /// x' there.
    pub velocity: Option<Number>,
    /// The largest x.
    pub maximum: Option<Number>,
    /// The least x.
    pub minimum: Option<Number>,
    /// The exponent of a limit cycle that is not zero (Liouville); empty for a member of a family.
    pub floquet_exponent: Vec<Number>,
    /// What the exponent proves of a limit cycle.
    pub stable: Option<bool>,
    /// The proof, or what it failed on.
    pub proof: Verdict,
}

/// How the contraction test ended.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Verdict {
    /// There is exactly one orbit within `radius`, and no second one within `unique_within`.
    Proved {
        /// The largest mode of the numerical inverse.
        modes: usize,
        /// nu of the norm.
        weight: f64,
        /// The distance of the orbit from the numerical one, in the norm of the proof.
        radius: Box<Number>,
        /// The distance within which there is no second orbit.
        unique_within: Box<Number>,
        /// The bounds of the test.
        bounds: Box<Bounds>,
    },
    /// Not proved; this says nothing against the orbit.
    Failed {
        /// The bound or the step.
        failed: &'static str,
        /// Its numbers.
        why: String,
    },
}

/// The bounds of the contraction test.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub struct Bounds {
    /// How far one Newton step goes.
    pub y0: Number,
    /// The defect of the inverse on its modes.
    pub z0: f64,
    /// What the inverse neglects.
    pub z1: f64,
    /// The Lipschitz constant of the derivative.
    pub z2: f64,
}

impl Oscillator {
    /// Proves the periodic orbit at the values set: a limit cycle, or the member of a family with the
    /// amplitude given. Period, frequency, x at phase 0, extrema and the Floquet exponent are enclosed
    /// to `work.digits` digits ([`Status::Proved`]); the guess is the motion in the time domain, else
    /// the sum of the expansion, else one harmonic. For equations that are polynomial in x and x' with rational coefficients.
    ///
    /// Where the proof fails the estimated period stands as before, and what failed is said
    /// ([`Standing::Undecided`]). Cost: third power of the modes (400: a second).
    ///
    /// # Errors
    /// Those of [`Oscillator::evaluate`] but for a series without a digit; [`Refused`] where the
    /// equation is not of the form.
    ///
    /// ```
    /// use lindstedt::{Evaluate, Oscillator, Status, Work};
    /// let cycle = Oscillator::builtin("van-der-pol")?.set("eps", "1")?;
    /// let proved = cycle.prove(&Evaluate::default(), &Work::default())?.value;
    /// let period = proved.period.ok_or(lindstedt::Error::NoValue)?;
    /// // Integration with 34 digits; the proof does not know it.
    /// assert!(period.decimal.starts_with("6.663286859323130189699682"));
    /// assert_eq!(period.status, Status::Proved);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn prove(&self, question: &Evaluate, work: &Work) -> Result<Answer<ProvedOrbit>, Error> {
        let start = Instant::now();
        let (case, mut remarks) = self.settled()?;
        let (mut found, outcome) = case.attempt(question, work)?;
        if outcome.is_err() {
            found = case.period(question, work).ok().or(found);
        }
        let order = found.as_ref().map(|found| found.order);
        let (value, standing) = match outcome {
            Ok(proof) => {
                let cycle = case.condition() == Some(Condition::LimitCycle);
                let digits = work.printed_digits();
                (ProvedOrbit::new(&proof, cycle, digits), Standing::Complete)
            }
            Err(failure) => {
                remarks.push(Remark(format!("not proved: {failure}")));
                (ProvedOrbit::estimated(found, &failure), Standing::Undecided)
            }
        };
        let at = case.setting()?.at.into_iter().map(|(name, value)| (name, value.to_string()));
        let header = self.header(at.collect(), order, "contraction proof", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// The proof from the first guess that leads to one: the motion in the time domain, then those of the
    /// expansion, which is made only then.
    fn attempt(
        &self,
        question: &Evaluate,
        work: &Work,
    ) -> Result<(Option<Evaluation>, Result<Proof, Failure>), Error> {
        let (field, kind) = self.field()?;
        let request =
            Request { digits: work.digits, stop: work.stop.clone(), ..Request::default() };
        let moving = self
            .setting()
            .and_then(|setting| TimeDomain::new(&setting, &work.stop).start(&work.stop));
        let mut outcome = Err(Failure::NoStart);
        if let Ok(start) = moving {
            outcome = prove(&field, &kind, &start, &request);
        }
        let mut found = None;
        // With too few modes no other guess is better.
        if !matches!(outcome, Ok(_) | Err(Failure::NoContraction { .. } | Failure::Stopped)) {
            let rough = Work { digits: DIGITS_OF_A_GUESS.min(work.digits), ..work.clone() };
            found = self.period(question, &rough).ok();
            for start in self.starts(found.as_ref(), &kind, question, &rough) {
                outcome = prove(&field, &kind, &start, &request);
                if matches!(outcome, Ok(_) | Err(Failure::Stopped)) {
                    break;
                }
            }
        }
        if work.stop.asked() && outcome.is_err() {
            let hint = "raise --limit-seconds, or ask for fewer --digits";
            return Err(Refused::stopped("stopped before the proof was finished", hint).into());
        }
        Ok((found, outcome))
    }

    /// The vector field with its values, and which orbit of it is meant. A small parameter that has the
    /// amplitude in it is, in the equation of x itself, its other part.
    pub(crate) fn field(&self) -> Result<(Field, Kind), Error> {
        if !matches!(self.condition(), Some(condition) if condition != Condition::FreeAmplitude) {
            let message = "an amplitude that drifts belongs to no periodic orbit";
            return Err(Refused::no_answer("no-proof", message, "`evaluate --start`").into());
        }
        // With what the values set determine: n of a power law gives delta.
        let known = self.setting()?.at.into_iter();
        let mut values: BTreeMap<String, Rational> =
            known.filter_map(|(name, value)| Some((name, value.as_rational()?.clone()))).collect();
        let small = &self.problem().small;
        if self.problem().amplitude == AmplitudeRole::InSmallParameter {
            let cards = self.problem().parameters.iter().filter(|card| card.name != "amplitude");
            let part = cards.filter_map(|card| values.get(&*card.name)).next().cloned();
            if let Some(part) = part {
                values.entry(small.to_string()).or_insert(part);
            }
        }
        let amplitude = || values.get("amplitude").cloned().unwrap_or_else(|| Rational::from(1));
        let kind = match self.condition() {
            Some(Condition::LimitCycle) => Kind::LimitCycle,
            Some(Condition::FundamentalAmplitude) => Kind::FundamentalAmplitude(amplitude()),
            _ => Kind::InitialAmplitude(amplitude()),
        };
        let problem = || self.problem().name.to_string();
        let field =
            Field::of_problem(self.problem(), &values).map_err(|failure| match failure {
                Failure::NoValue(name) => {
                    Error::from(DerivationError::Unset { problem: problem(), name })
                }
                other => {
                    let hint =
                        "`evaluate` without --prove estimates it; a closed form is certified there";
                    Refused::no_answer("no-proof", other.to_string(), hint).into()
                }
            })?;
        Ok((field, kind))
    }

    /// Guesses: the expansion's sum, then one harmonic.
    fn starts(
        &self,
        found: Option<&Evaluation>,
        kind: &Kind,
        question: &Evaluate,
        work: &Work,
    ) -> Vec<Start> {
        let mut starts = Vec::new();
        let path = found.filter(|f| f.period.is_some() || f.exact_period.is_some());
        let path = path.zip(self.setting().ok()).and_then(|(f, setting)| {
            let (order, phase) = (question.order, &question.phase);
            Trajectory::without_error(setting, order, phase, f, true, work).ok()
        });
        if let Some((path, (cosines, sines))) = path.and_then(|p| p.guess(GUESSED).map(|g| (p, g)))
        {
            starts.push(Start { frequency: path.frequency(), cosines, sines });
        }
        let amplitude = match kind {
            Kind::InitialAmplitude(a) | Kind::FundamentalAmplitude(a) => a.to_f64(),
            // That of van der Pol's equation: one harmonic is a guess for weak cycles only.
            _ => 2.0,
        };
        let period = found.map(|found| found.best_period.midpoint().to_f64());
        let guessed = period.map(|period| std::f64::consts::TAU / period);
        let guessed = guessed.filter(|omega| omega.is_finite() && *omega > 0.0);
        for frequency in guessed.into_iter().chain([1.0]) {
            starts.push(Start { frequency, cosines: vec![0.0, amplitude], sines: Vec::new() });
        }
        starts
    }
}

impl ProvedOrbit {
    fn new(proof: &Proof, cycle: bool, digits: usize) -> Self {
        let number = |ball: &Ball| Some(Number::of_ball(ball, digits).weaken(Status::Proved));
        let exponent = number(&proof.exponent).filter(|_| cycle);
        Self {
            period: number(&proof.period),
            frequency: number(&proof.frequency),
            amplitude: number(&proof.displacement),
            velocity: number(&proof.velocity),
            maximum: number(&proof.maximum),
            minimum: number(&proof.minimum),
            floquet_exponent: exponent.into_iter().collect(),
            stable: match proof.stability {
                Stability::Stable if cycle => Some(true),
                Stability::Unstable if cycle => Some(false),
                _ => None,
            },
            proof: Verdict::Proved {
                modes: proof.modes,
                weight: proof.weight,
                radius: Box::new(above(&proof.radius)),
                unique_within: Box::new(below(&proof.unique_within)),
                bounds: Box::new(Bounds {
                    y0: above(&proof.bounds.y0),
                    z0: proof.bounds.z0,
                    z1: proof.bounds.z1,
                    z2: proof.bounds.z2,
                }),
            },
        }
    }

    fn estimated(found: Option<Evaluation>, failure: &Failure) -> Self {
        let (period, frequency) = found.map_or((None, None), |f| (f.period, f.frequency));
        let failed = match failure {
            Failure::NoContraction { .. } => "Z1",
            Failure::Residual { .. } => "Y0",
            Failure::Singular { .. } => "inverse",
            Failure::NotConverged { .. } => "Newton",
            Failure::NoPeriod { .. } => "radius",
            _ => "guess",
        };
        Self {
            period,
            frequency,
            amplitude: None,
            velocity: None,
            maximum: None,
            minimum: None,
            floquet_exponent: Vec::new(),
            stable: None,
            proof: Verdict::Failed { failed, why: failure.to_string() },
        }
    }
}

/// A bound, rounded up to four digits.
fn above(x: &Float) -> Number {
    rounded(x, Round::Up)
}

/// The same rounded down.
fn below(x: &Float) -> Number {
    rounded(x, Round::Down)
}

fn rounded(x: &Float, round: Round) -> Number {
    let decimal = x.to_string_radix_round(10, Some(4), round);
    Number { exact: None, decimal, error: None, status: Status::Proved }
}
