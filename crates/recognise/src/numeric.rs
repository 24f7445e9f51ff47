//! Orbits of a force without closed form, followed by Taylor series; every number is estimated.

use crate::bound::PI;
use crate::in_pi::InPi;
use crate::law::evaluate;
use crate::motion::Motion;
use crate::potential;
use crate::refusal::Refusal;
use crate::threshold::{OrbitValue, Perturbation};
use lindstedt_algebra::Stop;
use lindstedt_equation::Expression;
use lindstedt_equation::monomials::Monomials;
use lindstedt_melnikov::quadrature::tanh_sinh;
use lindstedt_melnikov::splitting::Connection;
use lindstedt_melnikov::{Class, MelnikovError, Threshold};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_simulate::{Digits, Integrator, Model, Parameters, Report, Settings, Trajectory};
use rug::{Float, Rational};
use std::ops::ControlFlow;

/// Half the width of the search where no bound of the zeros is known.
const REACH: f64 = 20.0;
/// Bits of the search.
pub(crate) const COARSE: u32 = 128;

/// One orbit from a saddle.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub name: &'static str,
    pub saddle: Float,
    /// Where the motion starts: the turning point, or the centre between two saddles.
    pub start: Float,
    /// The other saddle of a heteroclinic orbit.
    pub other: Option<Float>,
    /// +1: x' >= 0 on a heteroclinic orbit.
    pub sign: i32,
}

impl Path {
    fn named<T>(&self, value: T) -> OrbitValue<T> {
        OrbitValue { name: self.name, saddle: Some(self.saddle.to_f64()), value }
    }
}

/// The orbits of x'' = f(x) from its saddles: those of the saddle nearest to x = 0 first, of several
/// that are translations of each other (a periodic force) only one.
///
/// Found by the signs of f and of W(x) = int f from the saddle on a grid, W = x'^2/2: a zero of W
/// is a turning point, a double one another saddle. Refined, then followed in time from the middle
/// towards the saddle with twice the digits, which the instability of the saddle costs.
#[derive(Clone, Debug)]
pub struct NumericOrbit {
    force: Expression,
    paths: Vec<Path>,
    stop: Stop,
}

/// What is known of an orbit.
#[derive(Clone, Debug)]
pub struct OrbitCheck {
    /// Which.
    pub name: &'static str,
    /// Its saddle.
    pub saddle: f64,
    /// The turning point, or the other saddle.
    pub end: f64,
    /// Whether it returns.
    pub homoclinic: bool,
    /// max |x'^2/2 - W(x)| on the orbit, W by quadrature: two routes.
    pub energy_residual: f64,
    /// |x - saddle| where it was left.
    pub decay: f64,
}

impl NumericOrbit {
    /// The orbits of the force with these terms (in x alone, bound).
    pub(crate) fn find(force: &Monomials) -> Result<Self, Refusal> {
        let terms = force.terms.iter().map(|(m, q)| force.tree(m, q));
        let force_of_x = Expression::Sum(terms.collect()).canonical();
        let found = Self { force: force_of_x, paths: Vec::new(), stop: Stop::default() };
        let reach = potential::polynomial(force).map_or(REACH, |f| cauchy_bound(&f));
        let paths = found.search(reach).unwrap_or_default();
        if paths.is_empty() { Err(Refusal::NoOrbit) } else { Ok(Self { paths, ..found }) }
    }

    /// The same orbits, whose computation ends undecided when asked to stop.
    #[must_use]
    pub fn watched(self, stop: &Stop) -> Self {
        Self { stop: stop.clone(), ..self }
    }

    /// The orbits by name, each from the saddle that it leaves.
    pub(crate) fn connections(&self) -> impl Iterator<Item = (&'static str, Connection)> {
        self.paths.iter().map(|path| {
            let other = path.other.as_ref().unwrap_or(&path.saddle).to_f64();
            let mut saddles = [path.saddle.to_f64(), other];
            if (other - saddles[0]) * f64::from(path.sign) < 0.0 {
                saddles.reverse();
            }
            (path.name, Connection { saddles, middle: path.start.to_f64() })
        })
    }

    /// Whether f has a positive derivative at a zero: its difference quotients agree. Near other
    /// saddles nothing decays exponentially.
    pub(crate) fn is_hyperbolic(&self, x: &Float) -> bool {
        let quotient = |h: f64| -> Option<f64> {
            let ends = (Float::with_val(COARSE, x - h), Float::with_val(COARSE, x + h));
            Some(((self.f(&ends.1)? - self.f(&ends.0)?) / (2.0 * h)).to_f64())
        };
        match (quotient(1e-6), quotient(1e-9)) {
            (Some(a), Some(b)) => b > 0.0 && (a - b).abs() < 1e-2 * b,
            _ => false,
        }
    }

    /// f(x); nothing where it is not finite, and when the work was stopped.
    pub(crate) fn f(&self, x: &Float) -> Option<Float> {
        if self.stop.asked() {
            return None;
        }
        evaluate(&self.force, x).filter(Float::is_finite)
    }

    /// W between two points.
    pub(crate) fn work(&self, from: &Float, to: &Float, bits: u32) -> Option<Float> {
        let estimate = tanh_sinh(bits, from, to, |x| self.f(x)).ok()?;
        Some(Float::with_val(bits, &estimate.value))
    }

    /// W over one cell of the search: Gauss and Legendre with five points, exact to 1e-16 there.
    pub(crate) fn cell(&self, from: &Float, to: &Float) -> Option<Float> {
        const NODES: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let middle = Float::with_val(COARSE, from + to) / 2u32;
        let half = Float::with_val(COARSE, to - from) / 2u32;
        let mut sum = Float::new(COARSE);
        for (node, weight) in NODES {
            let x = Float::with_val(COARSE, &half * node) + &middle;
            sum += self.f(&x)? * weight;
        }
        Some(sum * half)
    }

    /// A zero of f between two points of opposite sign.
    pub(crate) fn zero(&self, low: &Float, high: &Float, bits: u32) -> Option<Float> {
        let (mut low, mut high) = (Float::with_val(bits, low), Float::with_val(bits, high));
        let rising = self.f(&high)? > 0;
        for _ in 0..bits + 8 {
            let middle = Float::with_val(bits, &low + &high) / 2u32;
            if (self.f(&middle)? > 0) == rising { high = middle } else { low = middle }
        }
        Some(Float::with_val(bits, &low + &high) / 2u32)
    }

    /// The simple zero of W near x, by Newton's method.
    pub(crate) fn turning_point(&self, saddle: &Float, near: &Float, bits: u32) -> Option<Float> {
        let mut x = Float::with_val(bits, near);
        for _ in 0..60 {
            let step = self.work(saddle, &x, bits)? / self.f(&x)?;
            x -= &step;
            let small = Float::with_val(53, x.abs_ref()) >> (bits.saturating_sub(12));
            if Float::with_val(53, step.abs_ref()) <= small {
                return Some(x);
            }
        }
        None
    }

    /// The motion with so many bits.
    fn motion(&self, path: &Path, bits: u32) -> Result<Motion, MelnikovError> {
        let undecided = || MelnikovError::Undecided { bits };
        self.try_motion(path, bits).ok_or_else(undecided)
    }

    fn try_motion(&self, path: &Path, bits: u32) -> Option<Motion> {
        let digits = (2.0 * f64::from(bits) * std::f64::consts::LOG10_2) as u32 + 20;
        let real = Digits::for_digits(digits);
        let work = (f64::from(digits) * std::f64::consts::LOG2_10) as u32 + 40;
        let margin = Float::with_val(work, 1) >> 30;
        let around =
            |x: &Float| (Float::with_val(work, x - &margin), Float::with_val(work, x + &margin));
        let (low, high) = around(&path.saddle);
        let saddle = self.zero(&low, &high, work)?;
        let start = if path.other.is_some() {
            let (low, high) = around(&path.start);
            self.zero(&low, &high, work)?
        } else {
            self.turning_point(&saddle, &path.start, work)?
        };
        let speed = if path.other.is_some() {
            let square = self.work(&saddle, &start, work)? * 2u32;
            (square > 0).then(|| square.sqrt())?
        } else {
            Float::new(work)
        };
        let h = Float::with_val(work, 1) >> (work / 3);
        let (left, right) = (
            self.f(&Float::with_val(work, &saddle - &h))?,
            self.f(&Float::with_val(work, &saddle + &h))?,
        );
        let rate = (Float::with_val(work, right - left) / h / 2u32).sqrt().to_f64();
        (rate > 0.0 && rate.is_finite()).then_some(())?;
        let equation = Expression::ACCELERATION - self.force.clone();
        let model = Model::second_order(&equation).ok()?;
        let parameters = Parameters::new().with(PI, Exact::PiTimes(Rational::from(1)));
        let system = model.compile(real, &parameters).ok()?;
        // e^(-rate t) = 2^-bits, and what it takes to come near the saddle.
        let end = (f64::from(bits) * std::f64::consts::LN_2 + 6.0) / rate;
        let end = Float::with_val(work, end);
        let run = |speed: Float| {
            let state = [start.clone(), speed];
            let zero = Float::new(work);
            let mut flow =
                Integrator::new(&system, &zero, &state, Settings::for_digits(digits)).ok()?;
            let mut trajectory = Trajectory::new(real);
            let mut keep = |report: &Report<'_, Digits>| {
                let _ = trajectory.record(report);
                if !self.stop.asked() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            };
            flow.advance(&end, &mut keep).ok()?;
            (!self.stop.asked()).then_some(trajectory)
        };
        let two = path.other.is_some();
        let forward = run(speed.clone() * path.sign)?;
        let backward = if two { Some(run(-speed * path.sign)?) } else { None };
        Some(Motion { forward, backward, end, rate, saddle, bits, work, stop: self.stop.clone() })
    }

    /// The thresholds of a perturbation on all orbits, each number with an estimated error in its radius.
    ///
    /// # Errors
    /// [`MelnikovError::Undecided`] where a quadrature does not settle, [`MelnikovError::NoForcing`].
    pub(crate) fn thresholds(
        &self,
        balls: Balls,
        perturbation: &Perturbation,
    ) -> Result<Vec<OrbitValue<Threshold>>, MelnikovError> {
        let one = |path: &Path| {
            let motion = self.motion(path, balls.bits())?;
            let dissipation = motion.dissipation(balls, perturbation)?;
            let forcing = motion.reach(balls, &perturbation.forcing, dissipation.is_negative())?;
            let undecided = MelnikovError::Undecided { bits: balls.bits() };
            let signed = balls.div(&dissipation, &forcing).ok_or(undecided)?;
            let gamma = balls.abs(&signed);
            let class = Class::Estimated;
            let threshold = Threshold { gamma, signed, dissipation, forcing, class };
            Ok(path.named(threshold))
        };
        self.paths.iter().map(one).collect()
    }

    /// D of two perturbations on all orbits, with its estimated error in the radius.
    ///
    /// # Errors
    /// [`MelnikovError::Undecided`] where a quadrature does not settle.
    pub(crate) fn dissipations(
        &self,
        balls: Balls,
        [one, other]: [&Perturbation; 2],
    ) -> Result<Vec<OrbitValue<[Ball; 2]>>, MelnikovError> {
        let both = |path: &Path| {
            let motion = self.motion(path, balls.bits())?;
            let of = |perturbation| motion.dissipation(balls, perturbation);
            Ok(path.named([of(one)?, of(other)?]))
        };
        self.paths.iter().map(both).collect()
    }

    /// V on the first orbit.
    #[must_use]
    pub fn largest_speed(&self, balls: Balls) -> Option<Ball> {
        let path = self.paths.first()?;
        let bits = balls.bits();
        // The speed is largest where f = 0: between the saddle and the turning point.
        let centre = if path.other.is_some() {
            path.start.clone()
        } else {
            self.centre(&path.saddle, &path.start)?
        };
        let margin = Float::with_val(bits, 1) >> 30;
        let at = |x: &Float| -> Option<Float> {
            self.zero(
                &Float::with_val(bits, x - &margin),
                &Float::with_val(bits, x + &margin),
                bits,
            )
        };
        let square = self.work(&at(&path.saddle)?, &at(&centre)?, bits)? * 2u32;
        let value = (square > 0).then(|| square.sqrt())?;
        let error = Float::with_val(53, value.abs_ref()) >> bits.saturating_sub(8);
        Some(balls.from_parts(&value, &error))
    }

    /// The zero of f next to the saddle on the way to the end.
    fn centre(&self, saddle: &Float, end: &Float) -> Option<Float> {
        let step = Float::with_val(COARSE, end - saddle) / 400u32;
        let at = |n: u32| Float::with_val(COARSE, saddle + Float::with_val(COARSE, &step * n));
        let side = self.f(&at(1))? > 0;
        let n = (1..400).find(|n| self.f(&at(n + 1)).is_some_and(|f| (f > 0) != side))?;
        self.zero(&at(n), &at(n + 1), COARSE)
    }

    /// Checks every orbit: the energy of the motion followed in time by a quadrature of the force, and
    /// the decay to the saddle.
    #[must_use]
    pub fn check(&self, bits: u32) -> Vec<OrbitCheck> {
        let one = |path: &Path| {
            let motion = self.try_motion(path, bits)?;
            let mut residual = 0.0f64;
            for n in 0..6 {
                let t = Float::with_val(motion.work, &motion.end * n) / 12u32;
                let (x, v) = motion.state(&t)?;
                let w = self.work(&motion.saddle, &x, bits)?;
                let energy = v.square() / 2u32;
                residual = residual.max(Float::with_val(53, energy - w).abs().to_f64());
            }
            let (last, _) = motion.state(&motion.end)?;
            let target = path.other.as_ref().filter(|o| (**o > path.saddle) == (path.sign > 0));
            let target = target.map_or(motion.saddle.to_f64(), Float::to_f64);
            Some(OrbitCheck {
                name: path.name,
                saddle: path.saddle.to_f64(),
                end: path.other.as_ref().unwrap_or(&path.start).to_f64(),
                homoclinic: path.other.is_none(),
                energy_residual: residual,
                decay: (last.to_f64() - target).abs(),
            })
        };
        self.paths.iter().filter_map(one).collect()
    }
}

/// Beyond 1 + max |f_k/f_n| a polynomial has no zeros.
fn cauchy_bound(f: &[InPi]) -> f64 {
    let size = |c: &InPi| -> f64 {
        c.terms().map(|(k, q)| q.to_f64() * std::f64::consts::PI.powi(k)).sum::<f64>().abs()
    };
    let last = f.last().map_or(1.0, size);
    let largest = f.iter().rev().skip(1).map(|c| size(c) / last).fold(0.0, f64::max);
    (1.0 + largest).min(1e6)
}
