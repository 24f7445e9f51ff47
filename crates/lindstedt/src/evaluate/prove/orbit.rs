//! What is known of a proved orbit, as plain data.

use crate::evaluate::wanted::Wanted;
use crate::evaluate::{Evaluate, Evaluation};
use crate::{Exact, Number, Status};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Failure, Kind, Motion, Proof, Stability};
use rug::Float;
use rug::float::Round;
use serde::Serialize;

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
    /// The sum of the two exponents of a response to a force (Liouville); of several unknowns that of all
    /// exponents, of a limit cycle, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent_sum: Option<Number>,
    /// The product of its two Floquet multipliers: e to the sum times the period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier_product: Option<Number>,
    /// What the exponents prove.
    pub stable: Option<bool>,
    /// The proof, or what it failed on.
    pub proof: Verdict,
    /// Of several limit cycles, that of the expansion: how far its sum is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expansion: Option<Expansion>,
    /// x and x' at the times asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub solution: Vec<ProvedState>,
    /// Other orbits at the same values: a force may have several responses, an equation several limit
    /// cycles (the first is the one that the motion from x = 2 approaches). The list need not be complete.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<ProvedOrbit>,
}

/// x and x' at a time, enclosed.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ProvedState {
    /// The time.
    pub t: Exact,
    /// x.
    pub x: Number,
    /// x'.
    pub velocity: Number,
    /// The same of further unknowns, where there are several equations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unknowns: Vec<UnknownState>,
}

/// A further unknown and its derivative at a time.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct UnknownState {
    /// Its name.
    pub name: String,
    /// Its value.
    pub displacement: Number,
    /// Its derivative.
    pub velocity: Number,
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

/// What ties an expansion to a proved orbit.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Expansion {
    /// How far its sum, as computed, is from the numerical orbit in the norm of the proof.
    pub distance: Number,
    /// Whether that is within the ball in which the orbit is the only one; else Newton's method leads from the
    /// sum to this orbit.
    pub alone: bool,
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

impl UnknownOrbit {
    fn new(motion: &Motion, name: String, digits: usize) -> Self {
        Self {
            name,
            displacement: proved(&motion.displacement, digits),
            velocity: proved(&motion.velocity, digits),
            maximum: proved(&motion.maximum, digits),
            minimum: proved(&motion.minimum, digits),
        }
    }
}

impl Verdict {
    fn of(proof: &Proof) -> Self {
        Self::Proved {
            modes: proof.modes,
            weight: proof.weight,
            radius: Box::new(above(&proof.radius)),
            unique_within: Box::new(below(&proof.unique_within)),
            among: match (proof.parity.odd, proof.parity.even) {
                (false, false) => None,
                _ if !proof.further.is_empty() => Some("motions with the symmetries of this one"),
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
        }
    }
}

impl ProvedOrbit {
    /// This orbit and the others at the same values.
    pub fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.further)
    }

    /// The radius of the proof; nothing where it failed.
    #[must_use]
    pub fn radius(&self) -> Option<&Number> {
        match &self.proof {
            Verdict::Proved { radius, .. } => Some(radius),
            Verdict::Failed { .. } => None,
        }
    }

    pub(super) fn new(
        proof: &Proof,
        wanted: &Wanted,
        digits: usize,
        name: &dyn Fn(usize) -> String,
    ) -> Self {
        let number = |ball: &Ball| Some(proved(ball, digits));
        let further = proof.further.iter().enumerate();
        let unknowns = further.map(|(k, motion)| UnknownOrbit::new(motion, name(k + 1), digits));
        let (cycle, forced) = (wanted.kind == Kind::LimitCycle, wanted.is_forced());
        // Of several unknowns the sum of the exponents is no exponent.
        let planar = proof.further.is_empty();
        let exponent = || number(&proof.exponent);
        let sum = forced || cycle && !planar;
        let state =
            wanted.state((proof.motion.displacement.clone(), proof.motion.velocity.clone()));
        let (amplitude, velocity) = state.unzip();
        let zero = || Balls::new(proof.motion.maximum.midpoint().prec()).zero();
        let extremum = |u: &Ball| Some(wanted.state((u.clone(), zero()))?.0);
        let product = Some(proof.multiplier_product()).filter(|_| sum);
        let known = |ball: Option<Ball>| ball.as_ref().and_then(number);
        Self {
            period: number(&proof.period),
            frequency: number(&proof.frequency),
            amplitude: known(amplitude),
            velocity: known(velocity),
            maximum: known(extremum(&proof.motion.maximum)),
            minimum: known(extremum(&proof.motion.minimum)),
            unknowns: unknowns.collect(),
            floquet_exponent: exponent().filter(|_| cycle && planar).into_iter().collect(),
            exponent_sum: exponent().filter(|_| sum),
            multiplier_product: known(product),
            stable: match proof.stability {
                Stability::Unstable if cycle || forced => Some(false),
                Stability::Stable if cycle => Some(true),
                _ => None,
            },
            proof: Verdict::of(proof),
            expansion: None,
            solution: Vec::new(),
            further: Vec::new(),
        }
    }

    /// x and x' at the times asked for, x(t) = X(omega t + phase).
    pub(super) fn states(
        proof: &Proof,
        wanted: &Wanted,
        question: &Evaluate,
        digits: usize,
        name: &dyn Fn(usize) -> String,
    ) -> Vec<ProvedState> {
        let Some(times) = &question.times else { return Vec::new() };
        let balls = Balls::new(proof.frequency.midpoint().prec());
        let phase = question.phase.ball(balls);
        let state = |t: Exact| {
            let turned = balls.mul(&proof.frequency, &t.ball(balls));
            let turned = balls.add(&turned, &phase);
            let (x, velocity) = wanted.state(proof.at_phase(&turned))?;
            let further = |k: usize| {
                let (x, velocity) = proof.unknown_at_phase(k, &turned)?;
                let (displacement, velocity) = (proved(&x, digits), proved(&velocity, digits));
                Some(UnknownState { name: name(k), displacement, velocity })
            };
            let unknowns = (1..=proof.further.len()).filter_map(further).collect();
            let (x, velocity) = (proved(&x, digits), proved(&velocity, digits));
            Some(ProvedState { t, x, velocity, unknowns })
        };
        let last = proof.period.midpoint().to_f64();
        times.list(last).into_iter().filter_map(state).collect()
    }

    pub(super) fn estimated(found: Option<Evaluation>, failure: &Failure) -> Self {
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
            expansion: None,
            solution: Vec::new(),
            further: Vec::new(),
        }
    }
}

fn proved(ball: &Ball, digits: usize) -> Number {
    Number::of_ball(ball, digits).unwrap_or_else(Number::undefined).weaken(Status::Proved)
}

/// A bound, rounded up to four digits.
pub(super) fn above(x: &Float) -> Number {
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
