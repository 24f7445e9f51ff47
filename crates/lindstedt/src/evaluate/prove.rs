//! The orbit as a theorem: exactly one periodic orbit within a radius of the numbers, whether or not
//! the series converges, which gives no more than the guess ([`lindstedt_orbit`]).

use super::turn::TimeDomain;
use super::wanted::Wanted;
use super::{Evaluate, Evaluation, Question, Trajectory};
use crate::refusal::Refused;
use crate::{Answer, Error, Number, Oscillator, Remark, Standing, Status, Work};
use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{
    Failure, Kind, Motion, Proof, Request, Stability, Start, guesses, guesses_all, prove, prove_all,
};
use rug::Float;
use rug::float::Round;
use serde::Serialize;
use std::time::Instant;

/// Harmonics of the guess from the expansion; Newton's method finds the others.
const GUESSED: usize = 11;

/// The largest mode of the inverse from a guess of the second rank.
const MODES_OF_A_GUESS: usize = 120;

/// An orbit and what else was found, or why there is none.
type Outcome = Result<(Proof, Vec<Proof>), Failure>;

/// Digits of the expansion's sum for it.
const DIGITS_OF_A_GUESS: u32 = 16;

/// A periodic orbit, proved or as it was estimated before.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
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
    /// The same of further unknowns, where there are several equations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unknowns: Vec<UnknownOrbit>,
    /// The exponent of a limit cycle that is not zero (Liouville); empty for a member of a family.
    pub floquet_exponent: Vec<Number>,
    /// The sum of the two exponents of a response to a force (Liouville).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent_sum: Option<Number>,
    /// The product of its two Floquet multipliers: e to the sum times the period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier_product: Option<Number>,
    /// What the exponents prove.
    pub stable: Option<bool>,
    /// The proof, or what it failed on.
    pub proof: Verdict,
    /// Other orbits at the same values: a force may have several responses, an equation several limit
    /// cycles (the first is the one that the motion from x = 2 approaches). The list need not be complete.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<ProvedOrbit>,
}

/// What is proved of a further unknown.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct UnknownOrbit {
    /// Its name.
    pub name: String,
    /// Its value at phase 0.
    pub displacement: Number,
    /// Its derivative there.
    pub velocity: Number,
    /// The largest value.
    pub maximum: Number,
    /// The least value.
    pub minimum: Number,
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
        /// The functions among which there is no second one; nothing where these are all.
        #[serde(skip_serializing_if = "Option::is_none")]
        among: Option<&'static str>,
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
#[non_exhaustive]
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
    /// Proves the periodic orbit at the values set: a limit cycle, the member of a family with the
    /// amplitude given, or the responses to a force with its period. Period, frequency, x at phase 0, extrema and the Floquet exponent are enclosed
    /// to `work.digits` digits ([`Status::Proved`]); the guess is the motion in the time domain, else
    /// the sum of the expansion, else harmonic balance (of responses the only one). For one equation or
    /// several, made of polynomials, rational powers, sines, cosines and exponentials of the unknowns and
    /// their velocities with rational coefficients; a small parameter is not needed. Of several
    /// unknowns the guesses are the normal modes continued in the amplitude of the first, or the motion
    /// once it repeats itself.
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
        self.values_without_pi()?;
        let (case, mut remarks) = self.placed()?;
        let wanted = case.wanted(work.digits)?;
        let (mut found, outcome) = match self.problem().others.is_empty() {
            true => case.attempt(&wanted, question, work)?,
            false => (None, all_of(&wanted, &case.request(work))),
        };
        if outcome.is_err() && case.has_expansion() {
            found = case.period(question, work).ok().or(found);
        }
        if wanted.is_substituted() {
            let what = "proved for u = sin(q x/2), q the factor of x in the sine: u is polynomial";
            remarks.push(Remark(what.to_owned()));
        }
        let order = found.as_ref().map(|found| found.order);
        let (value, standing) = match outcome {
            Ok((first, others)) => {
                let digits = work.printed_digits();
                let names = |k: usize| self.problem().unknown(k);
                let orbit = |proof: &Proof| ProvedOrbit::new(proof, &wanted, digits, &names);
                let further = others.iter().map(orbit).collect();
                (ProvedOrbit { further, ..orbit(&first) }, Standing::Complete)
            }
            Err(failure) => {
                remarks.push(Remark(format!("not proved: {failure}")));
                (ProvedOrbit::estimated(found, &failure), Standing::Undecided)
            }
        };
        let at = case.values_of_proof()?.into_iter();
        let at = at.map(|(name, value)| (name, value.to_string())).collect();
        let header = self.header(at, order, "contraction proof", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// The proof from the first guess that leads to one: the motion in the time domain, then those of the
    /// expansion, which is made only then, then harmonic balance.
    fn attempt(
        &self,
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Result<(Option<Evaluation>, Outcome), Error> {
        let request = self.request(work);
        // Some guesses belong to no orbit.
        let guessed = Request { modes_limit: MODES_OF_A_GUESS, ..request.clone() };
        let mut outcome = Err(Failure::NoStart);
        let mut found = None;
        if !wanted.is_forced() {
            if let Some(start) = self.by_motion(wanted, &work.stop) {
                outcome = prove(&wanted.field, &wanted.kind, &start, &request);
            }
            // With too few modes no other guess is better.
            let ends = |found: &Result<_, _>| matches!(found, Ok(_) | Err(Failure::Stopped));
            if !ends(&outcome) && !matches!(outcome, Err(Failure::NoContraction { .. })) {
                let rough = Work { digits: DIGITS_OF_A_GUESS.min(work.digits), ..work.clone() };
                found = self.period(question, &rough).ok();
                for start in self.starts(found.as_ref(), wanted, question, &rough) {
                    outcome = prove(&wanted.field, &wanted.kind, &start, &guessed);
                    if ends(&outcome) {
                        break;
                    }
                }
            }
        }
        if work.stop.asked() && outcome.is_err() {
            let hint = "raise --limit-seconds, or ask for fewer --digits";
            return Err(Refused::stopped("stopped before the proof was finished", hint).into());
        }
        Ok((found, with_others(wanted, outcome, &guessed)))
    }

    fn request(&self, work: &Work) -> Request {
        Request { digits: work.digits, stop: work.stop.clone(), ..Request::default() }
    }

    /// A guess from the closed form or from the motion in the time domain.
    pub(super) fn by_motion(&self, wanted: &Wanted, stop: &Stop) -> Option<Start> {
        let moving = || {
            let setting = self.setting().ok()?;
            wanted.start(&TimeDomain::new(&setting, stop), stop).ok()
        };
        wanted.closed.clone().or_else(moving)
    }

    /// A guess from the expansion's sum, where it has a digit.
    pub(super) fn by_sum(
        &self,
        found: Option<&Evaluation>,
        question: &Evaluate,
        work: &Work,
    ) -> Option<Start> {
        let found = found.filter(|f| f.period.is_some() || f.exact_period.is_some())?;
        let (order, phase) = (question.order, &question.phase);
        let setting = self.setting().ok()?;
        let asked = Question { setting, order, phase, evaluation: found, in_doubles: true };
        let path = Trajectory::without_error(asked, work).ok()?;
        let (cosines, sines) = path.guess(GUESSED)?;
        Some(Start { frequency: path.frequency(), cosines, sines })
    }

    /// Guesses: the expansion's sum, then one harmonic, then harmonic balance.
    fn starts(
        &self,
        found: Option<&Evaluation>,
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Vec<Start> {
        let balanced = guesses(&wanted.field, &wanted.kind, &work.stop).unwrap_or_default();
        if wanted.is_substituted() {
            return balanced;
        }
        let mut starts: Vec<Start> = self.by_sum(found, question, work).into_iter().collect();
        let amplitude = match &wanted.kind {
            Kind::InitialAmplitude(a) | Kind::FundamentalAmplitude(a) => a.to_f64(),
            // That of van der Pol's equation: one harmonic is a guess for weak cycles only.
            _ => 2.0,
        };
        let period = found.map(|found| found.best_period.midpoint().to_f64());
        let guessed = period.map(|period| std::f64::consts::TAU / period);
        let guessed = guessed.filter(|omega| omega.is_finite() && *omega > 0.0);
        starts.extend(balanced);
        for frequency in guessed.into_iter().chain([1.0]) {
            starts.push(Start { frequency, cosines: vec![0.0, amplitude], sines: Vec::new() });
        }
        starts
    }
}

/// A response, or a limit cycle where more than one is likely, with the others that are proved from the guesses
/// of harmonic balance, the smallest first; there may be more.
fn with_others(wanted: &Wanted, first: Result<Proof, Failure>, request: &Request) -> Outcome {
    let mut proofs: Vec<Proof> = Vec::new();
    let several = wanted.is_forced() || wanted.kind == Kind::LimitCycle;
    let starts = match several {
        true => guesses(&wanted.field, &wanted.kind, &request.stop)?,
        false => Vec::new(),
    };
    let mut failure = match first {
        Ok(proof) if starts.len() < 2 => return Ok((proof, proofs)),
        Ok(proof) => {
            proofs.push(proof);
            Failure::NoStart
        }
        Err(failure) if wanted.is_forced() => failure,
        Err(failure) => return Err(failure),
    };
    for start in starts {
        match prove(&wanted.field, &wanted.kind, &start, request) {
            Ok(proof) if proofs.iter().all(|other| other.is_separate_from(&proof)) => {
                proofs.push(proof);
            }
            Ok(_) => {}
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(other) => failure = other,
        }
    }
    let mut proofs = proofs.into_iter();
    let first = proofs.next().ok_or(failure)?;
    Ok((first, proofs.collect()))
}

/// Of several unknowns: the orbits that are proved from all guesses.
fn all_of(wanted: &Wanted, request: &Request) -> Outcome {
    let (field, kind) = (&wanted.field, &wanted.kind);
    let mut proofs: Vec<Proof> = Vec::new();
    let mut failure = Failure::NoStart;
    for starts in guesses_all(field, kind, &request.stop)? {
        match prove_all(field, kind, &starts, request) {
            Ok(proof) if proofs.iter().all(|other| other.is_separate_from(&proof)) => {
                proofs.push(proof);
            }
            Ok(_) => {}
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(other) => failure = other,
        }
    }
    let mut proofs = proofs.into_iter();
    Ok((proofs.next().ok_or(failure)?, proofs.collect()))
}

impl UnknownOrbit {
    fn new(motion: &Motion, name: String, number: &dyn Fn(&Ball) -> Number) -> Self {
        Self {
            name,
            displacement: number(&motion.displacement),
            velocity: number(&motion.velocity),
            maximum: number(&motion.maximum),
            minimum: number(&motion.minimum),
        }
    }
}

impl ProvedOrbit {
    fn new(proof: &Proof, wanted: &Wanted, digits: usize, name: &dyn Fn(usize) -> String) -> Self {
        let number = |ball: &Ball| Some(Number::of_ball(ball, digits).weaken(Status::Proved));
        let plain = |ball: &Ball| Number::of_ball(ball, digits).weaken(Status::Proved);
        let further = proof.further.iter().enumerate();
        let unknowns = further.map(|(k, motion)| UnknownOrbit::new(motion, name(k + 1), &plain));
        let (cycle, forced) = (wanted.kind == Kind::LimitCycle, wanted.is_forced());
        // Of several unknowns the sum of the exponents is no exponent.
        let planar = proof.further.is_empty();
        let state = wanted.state((proof.displacement.clone(), proof.velocity.clone()));
        let (amplitude, velocity) = state.unzip();
        let zero = || Balls::new(proof.maximum.midpoint().prec()).zero();
        let extremum = |u: &Ball| Some(wanted.state((u.clone(), zero()))?.0);
        let product = Some(proof.multiplier_product()).filter(|_| forced || cycle && !planar);
        let known = |ball: Option<Ball>| ball.as_ref().and_then(number);
        Self {
            period: number(&proof.period),
            frequency: number(&proof.frequency),
            amplitude: known(amplitude),
            velocity: known(velocity),
            maximum: known(extremum(&proof.maximum)),
            minimum: known(extremum(&proof.minimum)),
            unknowns: unknowns.collect(),
            floquet_exponent: number(&proof.exponent)
                .filter(|_| cycle && planar)
                .into_iter()
                .collect(),
            exponent_sum: number(&proof.exponent).filter(|_| forced || cycle && !planar),
            multiplier_product: known(product),
            stable: match proof.stability {
                Stability::Unstable if cycle || forced => Some(false),
                Stability::Stable if cycle => Some(true),
                _ => None,
            },
            proof: Verdict::Proved {
                modes: proof.modes,
                weight: proof.weight,
                radius: Box::new(above(&proof.radius)),
                unique_within: Box::new(below(&proof.unique_within)),
                among: match (proof.parity.odd, proof.parity.even) {
                    (false, false) => None,
                    _ if !planar => Some("motions with the symmetries of this one"),
                    (true, true) => Some("even functions of the phase of odd harmonics"),
                    (true, false) => Some("functions of odd harmonics, x(t + T/2) = -x(t)"),
                    (false, true) => Some("even functions of the phase"),
                },
                bounds: Box::new(Bounds {
                    y0: above(&proof.bounds.y0),
                    z0: proof.bounds.z0,
                    z1: proof.bounds.z1,
                    z2: proof.bounds.z2,
                }),
            },
            further: Vec::new(),
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
            Failure::NoFunction { .. } => "function",
            _ => "guess",
        };
        Self {
            period,
            frequency,
            amplitude: None,
            velocity: None,
            maximum: None,
            minimum: None,
            unknowns: Vec::new(),
            floquet_exponent: Vec::new(),
            exponent_sum: None,
            multiplier_product: None,
            stable: None,
            proof: Verdict::Failed { failed, why: failure.to_string() },
            further: Vec::new(),
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
