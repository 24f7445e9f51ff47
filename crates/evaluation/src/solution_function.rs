//! x(t) as a function of the small parameter and the amplitude: derived once, evaluated often.
//!
//! x = a X(omega t; z), z = small a^w as in [`crate::compiled`]. The series of X in z is summed at phases
//! 2 pi (i + 1/2)/M; the harmonics follow by the trapezoidal rule, exactly but for those beyond M/2. Phase by phase,
//! because the harmonics themselves begin with a higher power of z each, and a series that begins with
//! zeros has no diagonal approximants. What is summed is S + X with S four times the size of x_0: approximants do
//! not notice a constant, errors are then those relative to the size of the motion also where x passes zero.

use crate::compiled::{FrequencyFunction, Varied, entry};
use crate::error::EvaluationError as Error;
use crate::few;
use crate::fourier::Fourier;
use crate::periodic::PeriodicSolution;
use lindstedt_algebra::Stop;
use lindstedt_derivation::{DerivationError, Work};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::lobachevsky_function::Point;
use lindstedt_series::resummation::{Compiled, Estimated, Method, Sample, UniformMap};
use rayon::prelude::*;
use rug::{Float, Rational};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// S over the largest |x_0|.
const OFFSET: f64 = 4.0;
/// Times the geometric series of what lies beyond the harmonics that are seen: it covers
/// harmonics that fall like k^-4, too.
const SAFETY: f64 = 4.0;

/// Below this a weight is zero.
const ROUNDING: f64 = 1e-14;

/// x(t; small, amplitude) in doubles.
#[derive(Clone, Debug)]
pub struct SolutionFunction {
    /// omega(small, amplitude).
    pub frequency: FrequencyFunction,
    /// The order of the expansion.
    pub order: usize,
    /// The harmonics of a solution, beside the constant.
    pub harmonics: usize,
    /// S + X at the phases that no symmetry takes to each other.
    sums: Vec<Compiled>,
    offset: f64,
    /// c_k and s_k as sums over these phases, k < M/2.
    cosines: Vec<Vec<f64>>,
    sines: Vec<Vec<f64>>,
    /// a where it does not vary.
    amplitude: f64,
}

impl SolutionFunction {
    /// Derives the solution to an order and compiles its sum, with so many harmonics.
    ///
    /// # Errors
    /// Those of [`FrequencyFunction::new`] and [`lindstedt_derivation::derive()`];
    /// [`Error::Resummation`] where no method has a formula. A method that does not sum x is that of the frequency alone.
    pub fn new(
        varied: &Varied<'_>,
        (order, harmonics): (usize, usize),
        method: Option<Method>,
        work: &Work,
    ) -> Result<Self, Error> {
        let setting = varied.setting;
        let frequency = FrequencyFunction::new(varied, order, method, work)?;
        let mut observer = |progress| work.goes_on(progress);
        let derivation = setting.derive(order, (work.memory, &work.stop), &mut observer)?;
        let bits = Compiled::bits(order + 1);
        let balls = Balls::new(bits).with_guard(64);
        let functions = derivation.phase_functions(false, balls).ok_or(DerivationError::NoValue)?;
        let phases = Phases::new(4 * (harmonics + 1), balls, |point| functions.at(point));
        let phases = phases.ok_or(DerivationError::NoValue)?;
        let methods = match method {
            Some(
                method
                @ (Method::PartialSum | Method::Pade | Method::Uniform | Method::UniformPade),
            ) => vec![method],
            _ if few::is_few(order + 1) => vec![Method::PartialSum],
            _ => vec![Method::PartialSum, Method::Pade, Method::Uniform, Method::UniformPade],
        };
        let offset = OFFSET * phases.size();
        let compile = |coefficients: &Vec<Ball>| {
            let float = |c: &Ball| Float::with_val(bits, c.midpoint());
            let mut coefficients: Vec<Float> = coefficients.iter().map(float).collect();
            if let Some(first) = coefficients.first_mut() {
                *first += offset;
            }
            let scale = Float::with_val(bits, 1);
            let map = Some(UniformMap { scale, prefactor: Float::new(bits), radius: None });
            let sample = Sample { coefficients, point: Float::new(bits), map, radius: None, bits };
            Compiled::new(&sample, &methods, &work.stop)
        };
        let sums = phases.distinct.par_iter().map(compile).collect::<Result<_, _>>();
        let sums = sums.map_err(|reason| Error::Resummation {
            problem: setting.problem.name.to_string(),
            reason,
        })?;
        let (cosines, sines) = phases.weights();
        let amplitude = setting.amplitude.ball(Balls::new(64)).midpoint().to_f64();
        Ok(Self { frequency, order, harmonics, sums, offset, cosines, sines, amplitude })
    }

    /// The solution at a point, whose errors are infinite where nothing is known.
    ///
    /// Cost: some 100 ns per phase, of which there are harmonics + 1 in a motion with both symmetries, four times as
    /// many in one without.
    #[must_use]
    pub fn at(&self, small: f64, amplitude: f64) -> PeriodicSolution {
        let omega = self.frequency.at(small, amplitude);
        let point = self.frequency.variable(small, amplitude);
        let (z, rounded) = point.unwrap_or((f64::NAN, f64::INFINITY));
        let sums: Vec<Estimated> = self.sums.iter().map(|sum| sum.at_within(z, rounded)).collect();
        let largest = sums.iter().map(|sum| sum.error).fold(0.0, f64::max);
        let values: Vec<f64> = sums.iter().map(|sum| sum.value - self.offset).collect();
        let scale = if self.frequency.has_amplitude { amplitude } else { self.amplitude };
        let sum = |weights: &Vec<f64>| -> f64 {
            weights.iter().zip(&values).map(|(weight, x)| weight * x).sum::<f64>() * scale
        };
        let mut coefficients: Vec<(f64, f64)> =
            self.cosines.iter().zip(&self.sines).map(|(c, s)| (sum(c), sum(s))).collect();
        let largest_error = scale.abs() * largest;
        let deviation = left_out(&coefficients, self.harmonics, largest_error);
        coefficients.truncate(self.harmonics + 1);
        let error = largest_error.is_finite().then_some(2.0 * largest_error);
        let fourier = Fourier { coefficients, deviation, error, largest_error };
        PeriodicSolution::new(fourier, omega, "expansion")
    }

    /// The solutions at many points, on all cores; a list of one value is that value everywhere. The points that stopped
    /// work did not reach are missing at the end.
    #[must_use]
    pub fn list(&self, small: &[f64], amplitude: &[f64], stop: &Stop) -> Vec<PeriodicSolution> {
        let count = small.len().max(amplitude.len());
        let one = |i: usize| (!stop.asked()).then(|| self.at(entry(small, i), entry(amplitude, i)));
        let found: Vec<_> = (0..count).into_par_iter().map(one).collect();
        found.into_iter().map_while(|solution| solution).collect()
    }
}

/// As JSON the parameters that vary, the methods of the frequency and the harmonics.
impl Serialize for SolutionFunction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("SolutionFunction", 3)?;
        self.frequency.fields(&mut object)?;
        object.serialize_field("harmonics", &self.harmonics)?;
        object.end()
    }
}

/// What the harmonics beyond `kept` add at most: those that are seen, and what they let expect of those that are not
/// seen, which are left out and fold onto the ones that are. Sizes below the errors of the values show
/// nothing.
fn left_out(harmonics: &[(f64, f64)], kept: usize, error: f64) -> f64 {
    let size = |from: usize, to: usize| -> f64 {
        harmonics.iter().take(to).skip(from).map(|(c, s)| c.hypot(*s)).sum()
    };
    let count = harmonics.len();
    let middle = count.div_ceil(4) * 3;
    let (inner, outer) = (size(count / 2, middle), size(middle, count));
    let beyond = match outer / inner {
        _ if outer <= error => 0.0,
        ratio if ratio < 0.5 => SAFETY * outer * ratio / (1.0 - ratio),
        _ => f64::INFINITY,
    };
    size(kept + 1, count) + 2.0 * beyond
}

/// The coefficients x_n at the phases 2 pi (i + 1/2)/M, each sequence once: x(-s) = x(s) of a motion that starts at rest,
/// x(s + pi) = -x(s) under an odd force.
struct Phases {
    distinct: Vec<Vec<Ball>>,
    /// The index in `distinct` and the sign of every phase.
    images: Vec<(usize, f64)>,
}

impl Phases {
    fn new(count: usize, balls: Balls, at: impl Fn(&Point) -> Option<Vec<Ball>>) -> Option<Self> {
        let (mut distinct, mut images): (Vec<Vec<Ball>>, Vec<_>) = (Vec::new(), Vec::new());
        for i in 0..count {
            let list = at(&Point::PiTimes(Rational::from((2 * i as u64 + 1, count as u64))))?;
            let negative: Vec<Ball> = list.iter().map(|c| balls.neg(c)).collect();
            let is = |other: &[Ball], list: &[Ball]| {
                list.iter().zip(other).all(|(one, other)| one.overlaps(other))
            };
            let known = distinct.iter().enumerate().find_map(|(index, known)| {
                let sign = if is(known, &list) { 1.0 } else { -1.0 };
                (sign > 0.0 || is(known, &negative)).then_some((index, sign))
            });
            images.push(known.unwrap_or((distinct.len(), 1.0)));
            if known.is_none() {
                distinct.push(list);
            }
        }
        Some(Self { distinct, images })
    }

    /// The largest |x_0|.
    fn size(&self) -> f64 {
        let first = self.distinct.iter().filter_map(|list| list.first());
        first.map(|x| x.midpoint().to_f64().abs()).fold(0.0, f64::max)
    }

    /// The weights of the distinct phases in c_k and s_k, k < M/2.
    fn weights(&self) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let count = self.images.len();
        let row = |k: usize, of: fn(f64) -> f64| {
            let mut row = vec![0.0; self.distinct.len()];
            let weight = if k == 0 { 1.0 } else { 2.0 } / count as f64;
            for (i, (index, sign)) in self.images.iter().enumerate() {
                // Reduced before it is rounded.
                let turns = (k * (2 * i + 1)) % (2 * count);
                row[*index] +=
                    sign * weight * of(turns as f64 * std::f64::consts::PI / count as f64);
            }
            // Weights that cancel.
            row.iter_mut().filter(|w| w.abs() < ROUNDING).for_each(|w| *w = 0.0);
            row
        };
        let rows = |of| (0..count / 2).map(|k| row(k, of)).collect();
        (rows(f64::cos), rows(f64::sin))
    }
}
