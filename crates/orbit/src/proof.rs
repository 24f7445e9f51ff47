//! From a guess to a theorem.

use crate::bounds::{Frame, Measure, Weights};
use crate::centre::Centre;
use crate::field::Field;
use crate::linear::{Inverse, Linear};
use crate::newton::{balance, invert, refine};
use crate::orbit::Orbit;
use crate::radii::{Bounds, Radii, decide};
use crate::start::Start;
use crate::task::{Kind, Request, Task};
use crate::{Condition, Failure, Parity};
use lindstedt_number::ball::{Ball, Balls};
use rug::float::Round;
use rug::{Float, Rational};
use serde::Serialize;

/// The class of the numbers of a [`Proof`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Existence, uniqueness within a radius and every enclosure follow from a theorem whose
    /// hypotheses were checked with all rounding errors.
    Proved,
}

/// What the enclosed sum of the Floquet exponents says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stability {
    /// A limit cycle whose exponent is negative: neighbours approach it.
    Stable,
    /// The sum of the exponents is positive: neighbours leave it.
    Unstable,
    /// The sum does not decide.
    Undecided,
}

/// A proved orbit: the equation has exactly one periodic orbit (with the symmetry and the condition
/// of the question) whose frequency and Fourier coefficients are within `unique_within` of
/// the numerical ones, in the norm s |delta omega| + |x_0| + sum_k k nu^k (|a_k| + |b_k|), and it
/// is within `radius` of them.
#[derive(Clone, Debug, Serialize)]
pub struct Proof {
    /// Always [`Status::Proved`].
    pub status: Status,
    /// The largest mode of the inverse.
    pub modes: usize,
    /// The largest mode of the numerical solution.
    pub solution_modes: usize,
    /// nu.
    pub weight: f64,
    /// s.
    pub frequency_weight: f64,
    /// The symmetries of the orbit; uniqueness is among the functions with them.
    pub parity: Parity,
    /// The distance of the orbit from the numerical solution is at most this.
    #[serde(serialize_with = "crate::write::float")]
    pub radius: Float,
    /// There is no second orbit within this distance.
    #[serde(serialize_with = "crate::write::float")]
    pub unique_within: Float,
    /// The bounds that prove it.
    pub bounds: Bounds,
    /// omega in radians per unit of time; exact for a forced orbit.
    #[serde(serialize_with = "crate::write::ball")]
    pub frequency: Ball,
    /// 2 pi/omega.
    #[serde(serialize_with = "crate::write::ball")]
    pub period: Ball,
    /// x at tau = 0.
    #[serde(serialize_with = "crate::write::ball")]
    pub displacement: Ball,
    /// x' at tau = 0.
    #[serde(serialize_with = "crate::write::ball")]
    pub velocity: Ball,
    /// The largest x.
    #[serde(serialize_with = "crate::write::ball")]
    pub maximum: Ball,
    /// The least x.
    #[serde(serialize_with = "crate::write::ball")]
    pub minimum: Ball,
    /// The sum of the two Floquet exponents, the mean of dg/dx' over a period (Liouville). One
    /// exponent of an autonomous equation is 0: then this is the other one.
    #[serde(serialize_with = "crate::write::ball")]
    pub exponent: Ball,
    /// What the exponent says.
    pub stability: Stability,
    #[serde(skip)]
    orbit: Orbit,
}

/// Modes of the first balance.
const FIRST_MODES: usize = 10;
/// Beyond this fraction of a guess its highest modes are not worth a balance.
const GUESSED: f64 = 1e-3;
/// How far x(0) may be, relatively, from what it shall be, after a balance with the frequency of the guess.
const NEAR: f64 = 0.1;
/// The highest quarter of the modes carries less than this fraction when there are enough.
const RESOLVED: f64 = 1e-4;
const FINELY: f64 = 1e-9;
/// Bits beyond the digits: weights of the modes, sums.
const GUARD_BITS: u32 = 44;
/// The numerical solution has at most this many times the modes of the inverse.
const MOST_TIMES: usize = 40;
/// Weights that are tried: nu = 1 + c/N.
const WEIGHTS: [f64; 5] = [0.0, 0.5, 2.0, 6.0, 15.0];
/// Refinements until the radius confirms the digits.
const MOST_REFINEMENTS: u32 = 4;
/// A sum Z0 + Z1 with which no other weight is tried.
const GOOD: f64 = 0.5;

/// Proves that the field has a periodic orbit of this kind near the guess.
///
/// Newton's method from the guess, with as many modes as it takes; refinement until the radius is
/// below 10^-digits of the largest harmonic, every residual formed without rounding; the contraction test
/// with the modes of the inverse increased until it succeeds or the limit is reached.
///
/// # Errors
/// [`Failure`]: which bound failed, with its number. That says nothing against the orbit.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_number::digits::decimal;
/// use lindstedt_orbit::{Field, Kind, Request, Start, prove};
/// // x'' + x + x^3/2 = 0 with x(0) = 1; the guess is cos(1.17 t).
/// let x = Expression::DISPLACEMENT;
/// let cubic = Expression::Number((1, 2).into()) * x.clone().pow(3);
/// let field = Field::new(&(Expression::ACCELERATION + x + cubic), "eps", &Default::default())?;
/// let start = Start { frequency: 1.17, cosines: vec![0.0, 1.0], sines: vec![] };
/// let request = Request { digits: 20, ..Request::default() };
/// let proof = prove(&field, &Kind::InitialAmplitude(1.into()), &start, &request)?;
/// assert_eq!(decimal(&proof.period, 20).as_deref(), Some("5.3666593551917671037"));
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn prove(
    field: &Field,
    kind: &Kind,
    start: &Start,
    request: &Request,
) -> Result<Proof, Failure> {
    let (task, guess) = Task::new(field, kind, start)?;
    let (centre, mut modes) = resolved(&task, guess, request)?;
    let bits = (f64::from(request.digits) * std::f64::consts::LOG2_10) as u32 + GUARD_BITS;
    let mut centre = centre.with_bits(bits.max(crate::task::FAST_BITS));
    loop {
        let attempt = attempt(&task, &mut centre, modes, request);
        let more = match attempt {
            Ok(proof) => return Ok(proof),
            Err(Failure::NoContraction { z0, z1, .. }) => ((z0 + z1) / 0.7).clamp(1.25, 2.0),
            Err(Failure::NotConverged { .. } | Failure::Residual { .. }) => 1.5,
            Err(other) => return Err(other),
        };
        if modes >= request.modes_limit {
            return attempt;
        }
        modes = ((modes as f64 * more) as usize + 1).min(request.modes_limit);
    }
}

/// Harmonic balance with as many modes as resolve the orbit. Where x(0) is given, first with the
/// frequency of the guess in its place: near a separatrix the period hangs on the last digits of
/// x(0), not the other way round.
fn resolved(task: &Task, guess: Centre, request: &Request) -> Result<(Centre, usize), Failure> {
    if task.rows.condition == Some(Condition::AtZero) {
        let near = |c: &Centre| {
            let miss = task.condition(c).to_f64().abs();
            miss < NEAR * task.value.to_f64().abs()
        };
        let fixed = task.with_frequency_fixed();
        let mut start = guess.clone();
        for fraction in [RESOLVED, FINELY] {
            let Ok((centre, modes)) = balanced(&fixed, start, fraction, request) else { break };
            if !near(&centre) {
                break;
            }
            if let Ok(found) = balance(task, centre.clone(), modes, &request.stop) {
                return Ok((found, modes));
            }
            start = centre;
        }
    }
    balanced(task, guess, RESOLVED, request)
}

fn balanced(
    task: &Task,
    guess: Centre,
    fraction: f64,
    request: &Request,
) -> Result<(Centre, usize), Failure> {
    let sizes: Vec<f64> = guess.doubles().iter().map(|c| c.norm()).collect();
    let allowed = GUESSED * sizes.iter().sum::<f64>();
    let beyond = |k: &usize| sizes.iter().skip(*k).sum::<f64>() < allowed;
    let given = (0..sizes.len()).find(beyond).unwrap_or(sizes.len());
    let mut modes = given.max(FIRST_MODES).min(request.modes_limit);
    let mut centre = guess;
    loop {
        let found = balance(task, centre.clone(), modes, &request.stop);
        if let Ok(found) = &found {
            let sizes: Vec<f64> = found.doubles().iter().map(|c| c.norm()).collect();
            let highest: f64 = sizes.iter().skip(modes * 3 / 4).sum();
            if highest < fraction * sizes.iter().sum::<f64>() || modes >= request.modes_limit {
                return Ok((found.clone(), modes));
            }
            // A solution on very few modes need not be near the orbit; the guess may be better.
            if modes >= 4 * FIRST_MODES {
                centre = found.clone();
            }
        } else if modes >= request.modes_limit || matches!(found, Err(Failure::Stopped)) {
            return found.map(|centre| (centre, modes));
        }
        modes = (modes * 3 / 2).min(request.modes_limit);
    }
}

/// Refinement and proof with an inverse on `modes` modes.
fn attempt(
    task: &Task,
    centre: &mut Centre,
    modes: usize,
    request: &Request,
) -> Result<Proof, Failure> {
    let linear = |centre: &Centre| {
        let values = centre.values(&task.field);
        let linear = Linear::new(centre.frequency.to_f64(), &values, task.rows);
        (values, linear)
    };
    let inverse = invert(&linear(centre).1, modes)?;
    let goal = centre.largest() / Float::with_val(53, Float::i_pow_u(10, request.digits)) / 4u32;
    let mut target = Float::with_val(53, &goal / 16u32);
    let mut tries = MOST_REFINEMENTS;
    loop {
        let most = MOST_TIMES * modes;
        *centre = refine(task, centre.clone(), &inverse, &target, most, &request.stop)?;
        let (values, linear) = linear(centre);
        let frame = Frame::new(task, centre, &values, &linear, &inverse);
        let (weights, radii) = weighed(&frame, &inverse, request)?;
        tries -= 1;
        if radii.radius <= goal || tries == 0 {
            return conclude(task, &frame, centre.clone(), &weights, radii);
        }
        // The radius is larger than the last step: by |A|, by the weights, by 1 - Z0 - Z1.
        let excess = Float::with_val(53, &radii.radius / &goal) * 8u32;
        let bits = excess.get_exp().unwrap_or(0).unsigned_abs();
        target /= excess;
        *centre = centre.clone().with_bits(centre.bits + bits);
    }
}

/// The weight with the least radius.
fn weighed(
    frame: &Frame<'_>,
    inverse: &Inverse,
    request: &Request,
) -> Result<(Weights, Radii), Failure> {
    let modes = inverse.modes;
    let mut best: Result<(Weights, Radii), Failure> = Err(Failure::Stopped);
    for c in WEIGHTS {
        if request.stop.asked() {
            return Err(Failure::Stopped);
        }
        let weights = Weights::new(1.0 + c / modes as f64, frame.reach());
        let contraction = frame.contraction(Measure::Norm, &weights);
        let found = decide(&contraction, modes, |r| frame.z2(&contraction, &weights, r));
        let good = contraction.z0.0 + contraction.z1.0 < GOOD;
        let better = match (&best, &found) {
            (Ok((_, old)), Ok(new)) => new.radius < old.radius,
            (Err(_), Ok(_)) | (Err(Failure::Stopped), _) => true,
            _ => false,
        };
        if better {
            best = found.map(|radii| (weights, radii));
        }
        if good {
            break;
        }
    }
    best
}

/// Everything that follows.
fn conclude(
    task: &Task,
    frame: &Frame<'_>,
    centre: Centre,
    weights: &Weights,
    radii: Radii,
) -> Result<Proof, Failure> {
    let balls = Balls::new(centre.bits + 16);
    let radius = &radii.radius;
    let error =
        if task.is_free() { frequency_error(frame, weights, radius) } else { Float::new(53) };
    let frequency = balls.add_error(&balls.from_rational(&centre.frequency), &error);
    let no_value = || Failure::NoPeriod { radius: radius.to_f64() };
    let turn = balls.mul_i64(&balls.pi(), 2);
    // A radius as large as the frequency proves an orbit, but no period.
    let period = balls.div(&turn, &frequency).filter(|_| frequency.is_positive());
    let period = period.ok_or_else(no_value)?;
    let exponent = divergence(task, frame, &centre, weights, radius, balls);
    let cycle = task.rows.condition == Some(Condition::Sine);
    let orbit = Orbit { centre, radius: radius.clone(), frequency: frequency.clone(), balls };
    let (displacement, velocity) = orbit.at_phase(&balls.zero());
    let (minimum, maximum) = orbit.extrema(task.is_free() && task.rows.parity.even);
    Ok(Proof {
        status: Status::Proved,
        modes: frame.modes(),
        solution_modes: orbit.centre.modes.modes(),
        weight: weights.nu().0,
        frequency_weight: frame.scale(),
        parity: task.rows.parity,
        unique_within: radii.unique_within,
        bounds: radii.bounds,
        frequency,
        period,
        displacement,
        velocity,
        maximum,
        minimum,
        stability: match () {
            () if exponent.is_positive() => Stability::Unstable,
            () if cycle && exponent.is_negative() => Stability::Stable,
            () => Stability::Undecided,
        },
        exponent,
        radius: radii.radius,
        orbit,
    })
}

/// |delta omega| <= |A F|_omega + |1 - A DF|_omega r + |A|_omega Z2 r^2/2: the row of the frequency
/// alone, which is much smaller than the norm.
fn frequency_error(frame: &Frame<'_>, weights: &Weights, radius: &Float) -> Float {
    let row = frame.contraction(Measure::Frequency, weights);
    let up = |x: &Float, y: &Float| Float::with_val_round(53, x * y, Round::Up).0;
    let linear = up(radius, &Float::with_val(53, (row.z0 + row.z1).0));
    let curvature = Float::with_val(53, frame.z2(&row, weights, radius).0);
    let square = up(&up(radius, radius), &curvature) / 2u32;
    let sum = Float::with_val_round(53, &row.y0 + &linear, Round::Up).0;
    let sum = Float::with_val_round(53, &sum + &square, Round::Up).0;
    // The norm itself bounds s |delta omega|.
    let whole = Float::with_val_round(53, radius / frame.scale(), Round::Up).0;
    if whole < sum { whole } else { sum }
}

/// The mean of dg/dx' at the centre, exactly, and how far it can be from that of the orbit.
fn divergence(
    task: &Task,
    frame: &Frame<'_>,
    centre: &Centre,
    weights: &Weights,
    radius: &Float,
    balls: Balls,
) -> Ball {
    let by_velocity = task.field.by_velocity();
    let value = centre.mean(&by_velocity);
    let slope = frame.slope(&by_velocity, weights, radius);
    let error = Float::with_val_round(53, radius * slope.0, Round::Up).0;
    let unknown = frame.unknown(&by_velocity, weights);
    let error = Float::with_val_round(53, &error + unknown.0, Round::Up).0;
    balls.add_error(&balls.from_rational(&value), &error)
}

impl Proof {
    /// (x, x') at a time, tau = omega t being 0 at t = 0: cost one sum over the modes.
    #[must_use]
    pub fn at(&self, time: &Rational) -> (Ball, Ball) {
        self.orbit.at(time)
    }

    /// (x, x') at a phase tau in radians.
    #[must_use]
    pub fn at_phase(&self, phase: &Ball) -> (Ball, Ball) {
        self.orbit.at_phase(phase)
    }

    /// The coefficients of cos k tau and of sin k tau.
    #[must_use]
    pub fn harmonic(&self, k: usize) -> (Ball, Ball) {
        self.orbit.harmonic(k)
    }

    /// The numerical solution as a guess for a neighbouring problem.
    #[must_use]
    pub fn start(&self) -> Start {
        let modes = self.orbit.centre.doubles();
        Start {
            frequency: self.frequency.midpoint().to_f64(),
            cosines: modes
                .iter()
                .zip(0..)
                .map(|(c, k)| if k == 0 { c.re } else { 2.0 * c.re })
                .collect(),
            sines: modes.iter().map(|c| -2.0 * c.im).collect(),
        }
    }

    /// A lower bound of the distance between the numerical solutions of two proofs in the norm with
    /// weight 1 and s = 1: max over the coefficients.
    ///
    /// Where it is larger than the sum of the radii the orbits are different.
    #[must_use]
    pub fn is_separate_from(&self, other: &Self) -> bool {
        let modes = self.solution_modes.max(other.solution_modes);
        !self.frequency.overlaps(&other.frequency)
            || (0..=modes).any(|k| {
                let ((a, b), (c, d)) = (self.harmonic(k), other.harmonic(k));
                !a.overlaps(&c) || !b.overlaps(&d)
            })
    }
}
