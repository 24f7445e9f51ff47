//! What a proof says.

use crate::bounds::{Frame, Measure, Weights};
use crate::centre::Centre;
use crate::orbit::Orbit;
use crate::place::Place;
use crate::radii::{Bounds, Radii};
use crate::start::{Start, in_phase};
use crate::task::Task;
use crate::upward::Up;
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
    /// Whether the period is proved to be the least one: the first harmonic is not 0.
    pub least_period: bool,
    /// x.
    #[serde(flatten)]
    pub motion: Motion,
    /// The second unknown and further ones.
    pub further: Vec<Motion>,
    /// The sum of the Floquet exponents, two for each unknown, the mean of sum dg_i/dx_i' over a period
    /// (Liouville). One exponent of an autonomous equation is 0: of one unknown, then, this is the other one.
    /// Of several unknowns the exponents themselves are not enclosed.
    #[serde(serialize_with = "crate::write::ball")]
    pub exponent: Ball,
    /// What the exponent says.
    pub stability: Stability,
    /// By unknowns.
    #[serde(skip)]
    orbits: Vec<Orbit>,
    /// The numbers within the radius of which they are.
    #[serde(skip)]
    centre: Centre,
    /// The condition, its value and the error of that; nothing of a forced orbit.
    #[serde(skip)]
    condition: Option<(Condition, Rational, Up)>,
}

/// What is proved of one unknown.
#[derive(Clone, Debug, Serialize)]
pub struct Motion {
    /// x_i at tau = 0.
    #[serde(serialize_with = "crate::write::ball")]
    pub displacement: Ball,
    /// x_i' at tau = 0.
    #[serde(serialize_with = "crate::write::ball")]
    pub velocity: Ball,
    /// The largest x_i.
    #[serde(serialize_with = "crate::write::ball")]
    pub maximum: Ball,
    /// The least x_i.
    #[serde(serialize_with = "crate::write::ball")]
    pub minimum: Ball,
}

impl Motion {
    fn of(orbit: &Orbit, even_and_autonomous: bool, odd: bool) -> Self {
        let (displacement, velocity) = orbit.at_phase(&orbit.balls.zero());
        let (minimum, maximum) = orbit.extrema(even_and_autonomous, odd);
        Self { displacement, velocity, maximum, minimum }
    }
}

/// Bits behind the point of a guess.
const EXACT_BITS: u32 = 256;

/// Everything that follows.
pub(crate) fn conclude(
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
    let exponent = divergence(task, frame, weights, radius, balls);
    let cycle = task.rows.condition == Some(Condition::Sine);
    let one = |i: usize| {
        let (centre, frequency) = (centre.component(i), frequency.clone());
        Orbit { centre, radius: radius.clone(), frequency, balls }
    };
    let orbits: Vec<Orbit> = (0..centre.unknowns.len()).map(one).collect();
    let single = orbits.len() == 1;
    let planar = single && task.is_free() && task.rows.parity.even;
    let Parity { odd, keeping, .. } = task.rows.parity;
    let mut motions = orbits.iter().enumerate().map(|(i, orbit)| {
        let mirrored = odd && keeping.checked_shr(i as u32).unwrap_or(1) & 1 == 0;
        Motion::of(orbit, planar, mirrored)
    });
    let motion = motions.next().ok_or(Failure::NoStart)?;
    let further = motions.collect();
    // Where any unknown has a first harmonic.
    let waves = |orbit: &Orbit| {
        let (a, b) = orbit.harmonic(1);
        !a.contains_zero() || !b.contains_zero()
    };
    Ok(Proof {
        status: Status::Proved,
        modes: frame.modes(),
        solution_modes: centre.modes(),
        weight: weights.nu().0,
        frequency_weight: frame.scale(),
        parity: task.rows.parity,
        unique_within: radii.unique_within,
        bounds: radii.bounds,
        frequency,
        period,
        least_period: orbits.iter().any(waves),
        motion,
        further,
        stability: match () {
            () if exponent.is_positive() => Stability::Unstable,
            () if cycle && single && exponent.is_negative() => Stability::Stable,
            () => Stability::Undecided,
        },
        exponent,
        radius: radii.radius,
        orbits,
        centre,
        condition: task.asked(),
    })
}

/// |delta omega| <= |A F|_omega + |1 - A DF|_omega r + |A|_omega Z2 r^2/2: the row of the frequency
/// alone, which is much smaller than the norm.
pub(crate) fn frequency_error(frame: &Frame<'_>, weights: &Weights, radius: &Float) -> Float {
    let row = frame.contraction(Measure::Frequency, weights);
    let up = |x: &Float, y: &Float| Float::with_val_round(53, x * y, Round::Up).0;
    let linear = up(radius, &Float::with_val(53, (row.z0 + row.z1).0));
    let curvature = Float::with_val(53, frame.z2(&row, weights, &frame.around(weights, radius)).0);
    let square = up(&up(radius, radius), &curvature) / 2u32;
    let sum = Float::with_val_round(53, &row.y0 + &linear, Round::Up).0;
    let sum = Float::with_val_round(53, &sum + &square, Round::Up).0;
    // The norm itself bounds s |delta omega|.
    let whole = Float::with_val_round(53, radius / frame.scale(), Round::Up).0;
    if whole < sum { whole } else { sum }
}

/// The mean of dg/dx' at the centre, exactly, and how far it can be from that of the orbit.
pub(crate) fn divergence(
    task: &Task,
    frame: &Frame<'_>,
    weights: &Weights,
    radius: &Float,
    balls: Balls,
) -> Ball {
    let by_velocity = task.field.divergence();
    let value = frame.mean(&by_velocity);
    let of_functions = frame.error_of(&by_velocity, weights);
    let slope = frame.slope(&by_velocity, weights, radius);
    let error = Float::with_val_round(53, radius * slope.0, Round::Up).0;
    let unknown = frame.unknown(&by_velocity, weights);
    let error = Float::with_val_round(53, &error + unknown.0, Round::Up).0;
    let error = Float::with_val_round(53, &error + &of_functions, Round::Up).0;
    balls.add_error(&balls.from_rational(&value), &error)
}

impl Proof {
    /// (x, x') at a time, tau = omega t being 0 at t = 0: cost one sum over the modes.
    #[must_use]
    pub fn at(&self, time: &Rational) -> (Ball, Ball) {
        self.orbits[0].at(time)
    }

    /// (x, x') at a phase tau in radians.
    #[must_use]
    pub fn at_phase(&self, phase: &Ball) -> (Ball, Ball) {
        self.orbits[0].at_phase(phase)
    }

    /// The coefficients of cos k tau and of sin k tau.
    #[must_use]
    pub fn harmonic(&self, k: usize) -> (Ball, Ball) {
        self.orbits[0].harmonic(k)
    }

    /// (x_i, x_i') of the unknown i, from 0, at a phase tau in radians; nothing where there are fewer.
    #[must_use]
    pub fn unknown_at_phase(&self, i: usize, phase: &Ball) -> Option<(Ball, Ball)> {
        Some(self.orbits.get(i)?.at_phase(phase))
    }

    /// The product of all Floquet multipliers, e^(sum of the exponents times the period) (Liouville).
    #[must_use]
    pub fn multiplier_product(&self) -> Ball {
        let balls = self.orbits[0].balls;
        balls.exp(&balls.mul(&self.exponent, &self.period))
    }

    /// The numerical solution as a guess for a neighbouring problem.
    #[must_use]
    pub fn start(&self) -> Start {
        self.starts().into_iter().next().unwrap_or_default()
    }

    /// The same of all unknowns.
    #[must_use]
    pub fn starts(&self) -> Vec<Start> {
        let one = |i: usize| Start::of(&self.centre.frequency, &self.centre.component(i));
        (0..self.orbits.len()).map(one).collect()
    }

    /// The distance of a guess for x (of one unknown), its doubles cut below 10^-70, from the numerical solution in the norm of the
    /// proof, rounded up; of a limit cycle with its phase moved so that the first harmonic has no sine. Where
    /// it is at most `unique_within`, no other orbit is in a ball with the guess.
    #[must_use]
    pub fn distance_from(&self, start: &Start) -> Float {
        let is_free = self.condition.is_some();
        let modes = vec![start.complex()];
        let modes = if is_free { in_phase(modes) } else { modes };
        let centre = Centre::from_doubles(EXACT_BITS, start.frequency, &modes);
        let scale = is_free.then_some(self.frequency_weight);
        Float::with_val(53, self.centre.distance(&centre, Up(self.weight), scale).0)
    }

    /// Whether it is proved that this and another proof of the same question speak of one orbit: the ball in which
    /// the one is has no point outside the ball in which the other is alone. Where coefficients are known
    /// within balls: at every value that both contain.
    ///
    /// `false` says nothing; that they are different orbits is [`Self::is_separate_from`].
    #[must_use]
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.place().is_same_as(&other.place())
    }

    pub(crate) fn place(&self) -> Place {
        Place {
            parity: self.parity,
            weight: self.weight,
            scale: self.frequency_weight,
            centre: self.centre.clone(),
            slack: Up::ZERO,
            radius: self.radius.clone(),
            unique_within: self.unique_within.clone(),
            condition: self.condition.clone(),
        }
    }

    /// The precision of the numbers.
    pub(crate) fn balls(&self) -> Balls {
        self.orbits[0].balls
    }

    /// A lower bound of the distance between the numerical solutions of two proofs in the norm with
    /// weight 1 and s = 1: max over the coefficients.
    ///
    /// Where it is larger than the sum of the radii the orbits are different.
    #[must_use]
    pub fn is_separate_from(&self, other: &Self) -> bool {
        let modes = self.solution_modes.max(other.solution_modes);
        !self.frequency.overlaps(&other.frequency)
            || self.orbits.iter().zip(&other.orbits).any(|(one, two)| {
                (0..=modes).any(|k| {
                    let ((a, b), (c, d)) = (one.harmonic(k), two.harmonic(k));
                    !a.overlaps(&c) || !b.overlaps(&d)
                })
            })
    }
}
