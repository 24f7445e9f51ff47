//! The solution x(t) at given times: the expansion at the phase omega t, order by order, and its
//! series in the small parameter summed there.

use crate::digits::bits_for;
use crate::displacements::{Displacement, Displacements};
use crate::error::EvaluationError as Error;
use crate::few;
use crate::fourier::{Fourier, harmonic};
use crate::period::Evaluation;
use crate::phases::{Phases, left_out};
use crate::setting::{Form, Setting};
use crate::source::remembered;
use lindstedt_algebra::Stop;
use lindstedt_derivation::{Derivation, DerivationError, Progress, Work};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number};
use lindstedt_phase::evaluate::PhaseFunctions;
use lindstedt_phase::lobachevsky_function::Point;
use lindstedt_series::resummation::{
    Estimate, Estimated, Method, Sample, UniformMap, partial_sums,
};
use rayon::prelude::*;
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::sync::{Arc, RwLock};

/// x(t), to be evaluated at any time.
pub struct Trajectory {
    derivation: Derivation,
    /// The frequency with its uncertainty.
    frequency: Ball,
    /// Whether anything is known about its error.
    is_estimated: bool,
    /// The small parameter, and a in x = a y (1 where the expansion contains its amplitude).
    setting: Setting,
    /// An estimated bound of |x'|, for the error that an uncertain frequency makes.
    speed: f64,
    /// x(t) = X(omega t + phase).
    phase: Exact,
    methods: Vec<Method>,
    digits: usize,
    /// The x_n with balls as coefficients, by their bits.
    functions: RwLock<BTreeMap<u32, Arc<PhaseFunctions>>>,
    /// Asked at every phase.
    stop: Stop,
    /// The period.
    pub period: f64,
}

/// The order of a solution that takes about a second.
#[must_use]
pub fn default_solution_order(form: &Form) -> usize {
    match form {
        Form::PowerLaw { .. } => 10,
        Form::Sums | Form::Logarithmic => 8,
        Form::Cubic { .. } => 24,
        Form::Relaxation { degree: 0..=3 } => 40,
        Form::Relaxation { degree } => (70 / degree).max(6),
        Form::Conservative | Form::Polynomial { degree: 0..=3 } => 20,
        Form::Polynomial { degree } => (50 / degree).max(6),
    }
}

/// Points at which a Fourier series is taken, at least; a multiple of 4.
const FEWEST_NODES: usize = 64;

/// Phases at which the speed is looked at, and its safety factor.
const PHASES: u32 = 64;
const SAFETY: f64 = 2.0;

/// Below this share of the size of a sum its harmonics in doubles are noise.
const ROUNDING: f64 = 1e-15;

/// Digits of a double.
const DOUBLE: usize = 16;
/// Times between two looks at the clock.
const BLOCK: usize = 16;

/// Doublings of the precision before the rounding is added to the error as it is.
const DOUBLINGS: u32 = 4;

/// One method at p and 2p bits, p doubled until the rounding does not matter; it is added to the
/// error. The same as [`lindstedt_series::resummation::resum`] without the search for the nearest
/// singularity, which would take most of the time at every phase anew.
fn settled(
    sample: &dyn Fn(u32) -> Option<Sample>,
    method: Method,
    known: usize,
    accuracy: u32,
    stop: &Stop,
) -> Option<(Estimate, u32)> {
    let loss = u32::try_from(known).ok()?.saturating_mul(4);
    let mut bits = accuracy.saturating_add(64).saturating_add(loss);
    let sum = |bits: u32| Some(sample(bits)?.sum(method, None, accuracy, stop).ok()?.estimate);
    let mut before = sum(bits)?;
    for last in (0..=DOUBLINGS).rev() {
        bits = bits.saturating_mul(2);
        let mut after = sum(bits)?;
        let rounding = Float::with_val(53, &after.value - &before.value).abs();
        let size = Float::with_val(53, after.value.abs_ref()) >> accuracy;
        if last == 0 || Float::with_val(53, &rounding * 8u32) <= after.error || rounding <= size {
            after.error += rounding.max(&size);
            return Some((after, bits));
        }
        before = after;
    }
    None
}

/// Which solution is asked for.
pub struct Question<'a> {
    /// The problem.
    pub setting: Setting,
    /// The order; one that takes about a second if nothing.
    pub order: Option<usize>,
    /// x(0) = a, x'(0) = 0 at phase 0.
    pub phase: &'a Exact,
    /// The period (by [`crate::period()`]), whose method sums x, too. The frequency is the closed form's
    /// where there is one, else the resummed one, with its error.
    pub evaluation: &'a Evaluation,
    /// In doubles, where a figure or a function is meant.
    pub in_doubles: bool,
}

impl Trajectory {
    /// Derives the solution.
    ///
    /// # Errors
    /// Those of [`lindstedt_derivation::derive()`].
    pub fn new(question: Question<'_>, work: &Work) -> Result<Self, Error> {
        let mut trajectory = Self::without_error(question, work)?;
        trajectory.speed = trajectory.largest_speed();
        Ok(trajectory)
    }

    /// The same without the bound of the speed that an error of x needs, which costs 64 phases.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn without_error(question: Question<'_>, work: &Work) -> Result<Self, Error> {
        let Question { setting, order, phase, evaluation, in_doubles } = question;
        let order = order.unwrap_or_else(|| default_solution_order(&setting.form));
        let digits = if in_doubles { DOUBLE } else { work.printed_digits().min(30) };
        let phase = phase.clone();
        let balls = Balls::new(bits_for(digits).saturating_add(64));
        let period = evaluation.best_period.clone();
        let two_pi = balls.mul_i64(&balls.pi(), 2);
        let frequency = balls.div(&two_pi, &period).ok_or(DerivationError::NoValue)?;
        let mut observer = |progress| work.goes_on(progress);
        let derivation = setting.derive(order, (work.memory, &work.stop), &mut observer)?;
        let few = few::is_few(derivation.order + 1);
        let methods = match evaluation.asked {
            Some(
                method @ (Method::PartialSum
                | Method::Pade
                | Method::Uniform
                | Method::UniformPade
                | Method::BorelPade),
            ) => vec![method],
            _ if few => vec![Method::PartialSum],
            _ => vec![Method::Pade, Method::UniformPade],
        };
        Ok(Self {
            derivation,
            frequency,
            is_estimated: evaluation.is_estimated || evaluation.exact_period.is_some(),
            setting,
            speed: f64::INFINITY,
            phase,
            methods,
            digits,
            functions: RwLock::default(),
            stop: work.stop.clone(),
            period: period.midpoint().to_f64(),
        })
    }

    /// x at times, those that are reached before the work is stopped; with the true x the errors are distances from it, not
    /// estimates.
    #[must_use]
    pub fn table(
        &self,
        times: &[Exact],
        truth: Option<&(impl Fn(&Exact) -> Option<Ball> + Sync)>,
        work: &Work,
    ) -> Displacements {
        let mut points = Vec::new();
        for block in times.chunks(BLOCK) {
            if !work.goes_on(Progress::Parts(points.len(), times.len())) {
                break;
            }
            let whole = points.len();
            points.par_extend(
                block.par_iter().map(|time| self.beside(time, truth.and_then(|x| x(time)))),
            );
            if work.stop.asked() {
                points.truncate(whole);
            }
        }
        let complete = points.len() == times.len();
        Displacements { order: self.order(), methods: self.methods.clone(), points, complete }
    }

    /// The largest difference quotient of x over neighbouring phases, times a safety factor.
    fn largest_speed(&self) -> f64 {
        let frequency = self.frequency.midpoint().to_f64();
        if self.frequency.relative_accuracy_bits() >= i64::from(bits_for(self.digits)) {
            // Known so well that no factor of this size matters.
            let balls = Balls::new(64);
            return 16.0 * frequency * self.setting.amplitude.ball(balls).abs_upper().to_f64();
        }
        let point = |k: u32| Point::PiTimes(Rational::from((2 * k + 1, PHASES)));
        let x: Vec<f64> = (0..PHASES)
            .into_par_iter()
            .map(|k| self.rough(&point(k)).unwrap_or(f64::NAN))
            .collect();
        let step = std::f64::consts::TAU / f64::from(PHASES);
        let next = x.iter().cycle().skip(1);
        let quotients = x.iter().zip(next).map(|(a, b)| (b - a).abs() / step);
        // Where the series has no value at some phase nothing bounds the speed.
        let top =
            quotients.fold(0.0, |top: f64, q| if q >= 0.0 { top.max(q) } else { f64::INFINITY });
        SAFETY * top * frequency
    }

    /// The methods that sum the series in the small parameter; at every phase the one with the
    /// least error estimate.
    #[must_use]
    pub fn methods(&self) -> &[Method] {
        &self.methods
    }

    /// The order of the solution.
    #[must_use]
    pub fn order(&self) -> usize {
        self.derivation.order
    }

    /// x(t).
    ///
    /// The error is estimated from neighbouring approximants; to it the effect of the uncertain
    /// frequency is added.
    #[must_use]
    pub fn at(&self, time: &Exact) -> Displacement {
        self.beside(time, None)
    }

    /// The same, its error the distance from the true x where that is known.
    fn beside(&self, time: &Exact, truth: Option<Ball>) -> Displacement {
        let nothing = || Displacement {
            time: time.clone(),
            value: None,
            double: f64::NAN,
            error: f64::INFINITY,
        };
        self.value(time, truth).unwrap_or_else(nothing)
    }

    fn value(&self, time: &Exact, truth: Option<Ball>) -> Option<Displacement> {
        let bits = self.frequency.midpoint().prec();
        let balls = Balls::new(bits);
        let t = time.ball(balls);
        let tau = balls.add(&balls.mul(&self.frequency, &t), &self.phase.ball(balls));
        let drift = balls.mul(&t, &self.frequency).radius().to_f64()
            / self.frequency.midpoint().to_f64().abs();
        let point = Point::Rational(tau.midpoint().to_rational()?);
        let (value, error) = self.sum(&point)?;
        let double = value.midpoint().to_f64();
        if let Some(truth) = truth {
            let balls = Balls::new(value.midpoint().prec());
            let sum = balls.from_parts(value.midpoint(), &Float::new(53));
            let ball = balls.add_error(&sum, &balls.sub(&sum, &truth).abs_upper());
            let (value, error) = (Number::estimated(&ball, self.digits), ball.radius().to_f64());
            return Some(Displacement { time: time.clone(), value, double, error });
        }
        if !self.is_estimated || !error.is_finite() && few::has_no_estimate(self.order() + 1) {
            let (value, error) = (few::plain(&value, self.digits, false), f64::INFINITY);
            return Some(Displacement { time: time.clone(), value, double, error });
        }
        let ball = Balls::new(value.midpoint().prec()).add_error(&value, &error);
        let ball = balls.add_error(&ball, &Float::with_val(53, drift * self.speed));
        let value = Number::estimated(&ball, self.digits);
        Some(Displacement { time: time.clone(), value, double, error: ball.radius().to_f64() })
    }

    /// X at a phase to some digits, by one sequence of Pade approximants or the partial sum.
    fn rough(&self, point: &Point) -> Option<f64> {
        let order = u32::try_from(self.order()).ok()?;
        let bits = 128 + 4 * order;
        let sample = self.sample(point, bits)?;
        let sum =
            sample.sum(Method::Pade, None, 53, &self.stop).map(|found| found.estimate.value).ok();
        let partial = || partial_sums(&sample.coefficients, &sample.point, bits).pop();
        let value = sum.or_else(partial)?;
        let balls = Balls::new(bits);
        let scaled = balls
            .mul(&balls.from_parts(&value, &Float::new(53)), &self.setting.amplitude.ball(balls));
        Some(scaled.midpoint().to_f64())
    }

    /// The coefficients of X at a phase and the small parameter; nothing when stopped.
    fn sample(&self, point: &Point, bits: u32) -> Option<Sample> {
        if self.stop.asked() {
            return None;
        }
        let balls = Balls::new(bits).with_guard(64);
        let scale = Float::with_val(bits, 1);
        let map = UniformMap { scale, prefactor: Float::new(bits), radius: None };
        let coefficients = self.coefficients(point, balls)?;
        let float = |c: &Ball| Float::with_val(bits, c.midpoint());
        Some(Sample {
            coefficients: coefficients.iter().map(float).collect(),
            point: Float::with_val(bits, self.setting.small(balls).midpoint()),
            map: Some(map),
            radius: None,
            bits,
        })
    }

    /// X at a phase, and its estimated error.
    fn sum(&self, point: &Point) -> Option<(Ball, Float)> {
        let source = remembered(|bits| self.sample(point, bits));
        let accuracy = bits_for(self.digits);
        let known = self.order() + 1;
        let (estimate, bits) = match few::partial_sum(&source, known, None, accuracy) {
            Some(few) => few.ok().map(|found| (found.outcome.estimate, found.bits))?,
            None => {
                let sum = |m: &Method| settled(&source, *m, known, accuracy, &self.stop);
                let sums = self.methods.iter().filter_map(sum);
                let found = sums.min_by(|a, b| a.0.error.total_cmp(&b.0.error));
                // Approximants at almost no distance from the origin may have singular equations at single phases.
                let known = |found: &(Estimate, u32)| found.0.error.is_finite();
                match found {
                    Some(found) if known(&found) || self.methods.len() == 1 => found,
                    found => sum(&Method::PartialSum).filter(known).or(found)?,
                }
            }
        };
        let balls = Balls::new(bits);
        let amplitude = self.setting.amplitude.ball(balls);
        let value = balls.from_parts(&estimate.value, &Float::new(53));
        let error = Float::with_val(53, &estimate.error * amplitude.abs_upper());
        Some((balls.mul(&value, &amplitude), error))
    }

    /// x_n at a phase.
    fn coefficients(&self, point: &Point, balls: Balls) -> Option<Vec<Ball>> {
        let known = self.functions.read().ok()?.get(&balls.bits()).cloned();
        let functions = match known {
            Some(functions) => functions,
            None => {
                let functions = Arc::new(self.derivation.phase_functions(false, balls)?);
                self.functions.write().ok()?.insert(balls.bits(), functions.clone());
                functions
            }
        };
        functions.at(point)
    }

    /// The Fourier coefficients (c_k, s_k), k = 0 .. `harmonics`, of x as a function of
    /// omega t, by the trapezoidal rule on 4 (harmonics + 1) phases, 64 at least, each sum once that a symmetry
    /// takes to another phase; and what the harmonics beyond them add at most, as far as these phases show it.
    /// Nothing where a phase has no value, and when stopped.
    #[must_use]
    pub fn fourier(&self, harmonics: usize) -> Option<Fourier> {
        let count = (4 * (harmonics + 1)).max(FEWEST_NODES);
        let balls = Balls::new(bits_for(self.digits)).with_guard(64);
        let phases =
            Phases::new(count, balls, &self.stop, |point| self.coefficients(point, balls))?;
        let sum = |(point, _): &(Point, _)| {
            let (value, error) = self.sum(point)?;
            let value = value.midpoint().to_f64();
            value.is_finite().then_some((value, error.to_f64()))
        };
        let sums: Vec<(f64, f64)> = phases.distinct.par_iter().map(sum).collect::<Option<_>>()?;
        let error_of = |error: f64| if self.is_estimated { error } else { f64::INFINITY };
        let errors = || sums.iter().map(|(_, error)| error_of(*error));
        let largest_error = errors().fold(0.0, f64::max);
        let [cosines, sines] = phases.weights();
        let of = |weights: Vec<f64>| -> Option<f64> {
            let products = weights.iter().zip(&sums).map(|(weight, (x, _))| weight * x);
            (!self.stop.asked()).then(|| products.sum())
        };
        let both = cosines.zip(sines).map(|(c, s)| of(c).zip(of(s)));
        let mut list: Vec<(f64, f64)> = both.collect::<Option<_>>()?;
        let rounding = ROUNDING * list.iter().map(|(c, s)| c.hypot(*s)).sum::<f64>();
        let noise = if largest_error.is_finite() { largest_error.max(rounding) } else { rounding };
        let deviation = left_out(&list, harmonics, noise);
        list.truncate(harmonics + 1);
        // |c_k| changes by less than the mean of |2 error cos|.
        let error = 2.0 * phases.mean(errors());
        let error = error.is_finite().then_some(error);
        let mut found = Fourier { coefficients: list, deviation, error, largest_error };
        if deviation.is_infinite() {
            found.deviation = self.measured(&found, count)?;
        }
        found.coefficients = self.started(found.coefficients);
        Some(found)
    }

    /// The largest deviation of a sum from X at phases between those that its harmonics are of, and near the largest of these:
    /// where the harmonics fall so slowly that they do not tell what lies beyond them.
    fn measured(&self, found: &Fourier, count: usize) -> Option<f64> {
        let deviation = |places: Vec<(u64, u64)>| -> Option<(f64, (u64, u64))> {
            let one = |place: (u64, u64)| {
                // Beside pi/2, where functions of ln |cos| have no value.
                let phase = place.0 as f64 / place.1 as f64 * std::f64::consts::TAU;
                let (value, _) = self.sum(&Point::Rational(Rational::from_f64(phase)?))?;
                Some(((found.at(phase) - value.midpoint().to_f64()).abs(), place))
            };
            let all: Vec<_> = places.into_par_iter().map(one).collect::<Option<_>>()?;
            all.into_iter().max_by(|a: &(f64, _), b| a.0.total_cmp(&b.0))
        };
        let fourth = 4 * count as u64;
        // The phases half a step off are known.
        let quarters = (0..fourth).filter(|i| i % 4 != 2).map(|i| (i, fourth)).collect();
        let (coarse, (place, _)) = deviation(quarters)?;
        let near = (0..=16).map(|i| ((8 * (place + fourth) + i - 8) % (8 * fourth), 8 * fourth));
        Some(coarse.max(deviation(near.collect())?.0))
    }

    /// The harmonics of X(s + phase) of those of X(s).
    fn started(&self, list: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
        let balls = Balls::new(128);
        let phase = self.phase.ball(balls);
        let turned = |(k, (c, s)): (i64, (f64, f64))| {
            let angle = balls.mul_i64(&phase, k);
            let [cosine, sine] =
                [balls.cos(&angle), balls.sin(&angle)].map(|x| x.midpoint().to_f64());
            (c * cosine + s * sine, s * cosine - c * sine)
        };
        (0..).zip(list).map(turned).collect()
    }

    /// The Fourier coefficients c_k, s_k, k = 0 .. `harmonics`, of one approximant at
    /// 2 (harmonics + 1) phases: a guess without an error.
    #[must_use]
    pub fn guess(&self, harmonics: usize) -> Option<(Vec<f64>, Vec<f64>)> {
        let count = 2 * (harmonics + 1);
        let node = |i: usize| {
            let phase = Point::PiTimes(Rational::from((2 * i as u64 + 1, count as u64)));
            self.rough(&phase).filter(|x| x.is_finite())
        };
        let nodes: Vec<f64> = (0..count).into_par_iter().map(node).collect::<Option<_>>()?;
        Some((0..=harmonics).map(|k| harmonic(&nodes, k)).unzip())
    }

    /// omega as a double.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.frequency.midpoint().to_f64()
    }

    /// The same with its estimated error; infinite where nothing is known of it.
    #[must_use]
    pub fn estimated_frequency(&self) -> Estimated {
        let error = self.frequency.radius().to_f64() + self.frequency().abs() * f64::EPSILON;
        Estimated {
            value: self.frequency(),
            error: if self.is_estimated { error } else { f64::INFINITY },
        }
    }

    /// 10^-digits (15 at most), below which a harmonic is not worth a line.
    #[must_use]
    pub fn negligible(&self) -> f64 {
        10f64.powi(-(self.digits.min(15) as i32))
    }
}
