//! x(t) as a function of the small parameter and the amplitude: derived once, evaluated often.
//!
//! x = a X(omega t; z), z = small a^w as in [`crate::compiled`]. The series of X in z is summed at phases
//! 2 pi (i + 1/2)/M; the harmonics follow by the trapezoidal rule, exactly but for those beyond M/2. Phase by phase,
//! because the harmonics themselves begin with a higher power of z each, and a series that begins with
//! zeros has no diagonal approximants. What is summed is S + X with S four times the size of x_0: approximants do
//! not notice a constant, errors are then those relative to the size of the motion also where x passes zero.

use crate::compiled::{FrequencyFunction, Varied, entry, points};
use crate::error::EvaluationError as Error;
use crate::few;
use crate::fourier::Fourier;
use crate::periodic::PeriodicSolution;
use crate::phases::{Phases, left_out};
use lindstedt_algebra::Stop;
use lindstedt_derivation::Work;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::resummation::{Compiled, Estimated, Method, Sample, UniformMap};
use rayon::prelude::*;
use rug::Float;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// S over the largest |x_0|.
const OFFSET: f64 = 4.0;
/// Bytes of the sum at one phase: some 40 factors of two with 16 nodes each, of two signs.
const SUM: usize = 1 << 16;

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
    /// [`Error::Resummation`] where no method has a formula; [`Error::TooManyPhases`]. A method that does not sum x is that of the frequency alone.
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
        let no_value = || Error::without_value(&setting.problem, &work.stop);
        let functions = derivation.phase_functions(false, balls).ok_or_else(no_value)?;
        let count = 4 * (harmonics + 1);
        // At least a fourth of the phases is left by two symmetries.
        check_room(count, count / 4, work.memory)?;
        let phases = Phases::new(count, balls, &work.stop, |point| functions.at(point));
        let phases = phases.ok_or_else(no_value)?;
        check_room(count, phases.distinct.len(), work.memory)?;
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
        let sums =
            phases.distinct.par_iter().map(|(_, list)| compile(list)).collect::<Result<_, _>>();
        let sums = sums.map_err(|reason| Error::Resummation {
            problem: setting.problem.name.to_string(),
            reason,
        })?;
        let [cosines, sines] = phases.weights().map(|rows| {
            let rows = rows.map(|row| (!work.stop.asked()).then_some(row));
            rows.collect::<Option<Vec<_>>>().ok_or_else(no_value)
        });
        let (cosines, sines) = (cosines?, sines?);
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
        let count = points(small, amplitude);
        let one = |i: usize| (!stop.asked()).then(|| self.at(entry(small, i), entry(amplitude, i)));
        let found: Vec<_> = (0..count).into_par_iter().map(one).collect();
        found.into_iter().map_while(|solution| solution).collect()
    }
}

/// Refuses so many distinct ones of `count` phases where their sums and weights need more memory than there is.
fn check_room(count: usize, phases: usize, limit: u64) -> Result<(), Error> {
    let each = count.saturating_mul(size_of::<f64>()).saturating_add(SUM);
    let needed = phases.saturating_mul(each) as u64;
    if needed <= limit { Ok(()) } else { Err(Error::TooManyPhases { phases, needed, limit }) }
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
