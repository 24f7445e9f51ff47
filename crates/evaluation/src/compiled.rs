//! The frequency as a function of the small parameter and the amplitude: derived once, evaluated often.
//!
//! T/2pi = factor sum t_n x^n with x = (ratio small a^w)^step: where x -> a x, small -> a^-w small leaves
//! the equation as it is, the amplitude is carried by the small parameter, and where it scales the
//! frequency, by a^-small. Everything else is a number. omega = 1/(factor sum).

use crate::error::EvaluationError as Error;
use crate::setting::Setting;
use crate::source::Source;
use lindstedt_algebra::Stop;
use lindstedt_derivation::{DerivationError, Work};
use lindstedt_equation::AmplitudeRole;
use lindstedt_number::ball::Balls;
use lindstedt_series::resummation::{Compiled, Estimated, Method, ResummationError};
use rayon::prelude::*;
use rug::Float;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// Points that one core takes at a time.
const BLOCK: usize = 1024;

/// omega(small, amplitude) in doubles.
#[derive(Clone, Debug)]
pub struct FrequencyFunction {
    /// The order of the expansion.
    pub order: usize,
    /// The parameter that varies.
    pub small: String,
    /// Whether the amplitude does; where it does not it has the value of the problem.
    pub has_amplitude: bool,
    sum: Compiled,
    /// What the amplitude does.
    carried: Carried,
    /// The coefficient of small in x, without its power.
    ratio: f64,
    step: i32,
    factor: f64,
}

/// How the amplitude enters.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Carried {
    /// It is a number, or there is none.
    Not,
    /// small a^w.
    BySmall(i32),
    /// T ~ a^-small.
    ByScale,
}

/// Which values vary.
pub struct Varied<'a> {
    /// The problem at amplitude one where the amplitude varies.
    pub setting: &'a Setting,
    /// The parameter that is the small one, or its factor beside the amplitude.
    pub small: String,
    /// w in small a^w, where the amplitude varies and does not scale the frequency.
    pub weight: Option<u32>,
}

impl FrequencyFunction {
    /// Derives the series to an order and compiles its sum, by a method or the best at every point.
    ///
    /// # Errors
    /// Those of [`Source::new`]; [`Error::Resummation`] where no method has a formula.
    pub fn new(
        varied: &Varied<'_>,
        order: usize,
        method: Option<Method>,
        work: &Work,
    ) -> Result<Self, Error> {
        let setting = varied.setting;
        let mut observer = |progress| work.goes_on(progress);
        let source = Source::new(setting, order, (work.memory, &work.stop), &mut observer)?;
        let sum = compiled(&source, method, &work.stop).map_err(|reason| Error::Resummation {
            problem: setting.problem.name.to_string(),
            reason,
        })?;
        let scales = matches!(setting.problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        let carried = match varied.weight {
            _ if scales => Carried::ByScale,
            Some(weight) => Carried::BySmall(i32::try_from(weight).unwrap_or(i32::MAX)),
            None => Carried::Not,
        };
        let factor = (source.factor)(Balls::new(128)).ok_or(DerivationError::NoValue)?;
        Ok(Self {
            order,
            small: varied.small.clone(),
            has_amplitude: carried != Carried::Not,
            sum,
            carried,
            ratio: source.ratio.to_f64(),
            step: i32::try_from(source.step).unwrap_or(i32::MAX),
            factor: factor.midpoint().to_f64(),
        })
    }

    /// The methods that sum it.
    #[must_use]
    pub fn methods(&self) -> &[Method] {
        self.sum.methods()
    }

    /// What is known of it as data.
    pub(crate) fn fields<S: SerializeStruct>(&self, object: &mut S) -> Result<(), S::Error> {
        let amplitude = self.has_amplitude.then_some("amplitude");
        let names: Vec<&str> = [&*self.small].into_iter().chain(amplitude).collect();
        let methods: Vec<&str> = self.methods().iter().map(|method| method.name()).collect();
        object.serialize_field("parameters", &names)?;
        object.serialize_field("methods", &methods)
    }

    /// omega with its estimated error. The amplitude does not count where it does not vary; where it does, it is
    /// positive: with another sign x is -x, which is a motion of another equation.
    /// Nothing is allocated; some 100 ns.
    #[must_use]
    pub fn at(&self, small: f64, amplitude: f64) -> Estimated {
        let Some((x, rounded)) = self.variable(small, amplitude) else {
            return Estimated { value: f64::NAN, error: f64::INFINITY };
        };
        let scale = match self.carried {
            Carried::ByScale => amplitude.powf(-small),
            _ => 1.0,
        };
        let rounded = rounded * f64::from(self.step);
        let point = (self.ratio * x).powi(self.step);
        let Estimated { value, error } = self.sum.at_within(point, rounded);
        let omega = 1.0 / (self.factor * scale * value);
        // |1/(v + d) - 1/v| <= (1/v) r/(1 - r), r = |d/v|; rounding is some units in the last place, the
        // power's of small ln a more.
        let relative = error / value.abs();
        let logarithm = if scale == 1.0 { 0.0 } else { scale.ln().abs() };
        let rounding = (8.0 + logarithm) * f64::EPSILON;
        let resolved = relative < 0.5 && omega > 0.0 && omega.is_finite();
        let error = omega * (relative / (1.0 - relative) + rounding);
        Estimated { value: omega, error: if resolved { error } else { f64::INFINITY } }
    }

    /// small a^w, and the relative error by which it and its ratio are rounded; nothing where the amplitude varies and is
    /// not positive.
    pub(crate) fn variable(&self, small: f64, amplitude: f64) -> Option<(f64, f64)> {
        if self.has_amplitude && (amplitude.is_nan() || amplitude <= 0.0) {
            return None;
        }
        Some(match self.carried {
            Carried::BySmall(weight) => {
                (small * amplitude.powi(weight), (3.0 + f64::from(weight)) * f64::EPSILON)
            }
            Carried::Not | Carried::ByScale => (small, 2.0 * f64::EPSILON),
        })
    }

    /// omega at many points, on all cores; a list of one value is that value everywhere. Points that
    /// stopped work did not reach are missing.
    #[must_use]
    pub fn list(&self, small: &[f64], amplitude: &[f64], stop: &Stop) -> Vec<Estimated> {
        let count = points(small, amplitude);
        let mut values = vec![Estimated { value: f64::NAN, error: f64::INFINITY }; count];
        values.par_chunks_mut(BLOCK).enumerate().for_each(|(block, values)| {
            if stop.asked() {
                return;
            }
            for (value, i) in values.iter_mut().zip(block * BLOCK..) {
                *value = self.at(entry(small, i), entry(amplitude, i));
            }
        });
        values
    }
}

/// The number of points of two lists: one value is that value everywhere, an empty list has none.
pub(crate) fn points(small: &[f64], amplitude: &[f64]) -> usize {
    match (small.len(), amplitude.len()) {
        (0, _) | (_, 0) => 0,
        (small, amplitude) => small.max(amplitude),
    }
}

/// An entry of a list; of a list of one value that value.
pub(crate) fn entry(list: &[f64], index: usize) -> f64 {
    match list {
        [only] => *only,
        list => list.get(index).copied().unwrap_or(f64::NAN),
    }
}

/// As JSON the parameters that vary and the methods.
impl Serialize for FrequencyFunction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("FrequencyFunction", 2)?;
        self.fields(&mut object)?;
        object.end()
    }
}

/// The compiled sum of the series of T/2pi.
fn compiled(
    source: &Source,
    method: Option<Method>,
    stop: &Stop,
) -> Result<Compiled, ResummationError> {
    use ResummationError::{NoCoefficients, Stopped};
    let bits = Compiled::bits(source.known);
    let sample = source.sample(bits);
    let mut sample = sample.ok_or(if stop.asked() { Stopped } else { NoCoefficients { bits } })?;
    sample.point = Float::new(bits);
    Compiled::new(&sample, method.as_slice(), stop)
}
