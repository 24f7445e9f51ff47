//! What a method makes of the coefficients alone, whatever the point: the series in its variable and
//! the approximants. The rest is a value at a point.

use super::partial::{convergent, disc, partial_sum};
use super::staircase::Staircase;
use super::{Map, Method, Outcome, ResummationError, Sample, Singularity};
use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Special;

/// A method with its variable w and f = (x/(x'(0) w))^p g(w).
pub(super) struct Prepared {
    /// x(w) and p; nothing for w = x.
    pub map: Option<(Map, Float)>,
    /// How g is summed.
    pub way: Way,
}

/// How a series is summed.
pub(super) enum Way {
    /// The series in x itself, up to its smallest term.
    Series,
    /// A series in w that converges.
    InVariable(Vec<Float>),
    /// Diagonal Pade approximants.
    Approximants(Staircase),
}

impl Sample {
    /// A value that has a digit, or one without an estimate.
    pub(super) fn resolved(&self, mut outcome: Outcome) -> Outcome {
        // An error as large as half the value leaves not one digit, and is no estimate.
        let half = Float::with_val(53, outcome.estimate.value.abs_ref()) / 2u32;
        if self.is_unresolved() || outcome.estimate.error > half {
            outcome.estimate.error = Float::with_val(53, Special::Infinity);
            outcome.tentative = None;
        }
        outcome
    }

    /// A method without its point.
    ///
    /// # Errors
    /// [`ResummationError::NoMap`], [`ResummationError::NoSingularity`];
    /// [`ResummationError::NoFormula`] for Borel's, whose integral is another one at every point.
    pub(super) fn prepared(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        stop: &Stop,
    ) -> Result<Prepared, ResummationError> {
        let map = match method {
            Method::PartialSum | Method::Pade => None,
            Method::Uniform | Method::UniformPade => {
                let map = self.map.as_ref().ok_or(ResummationError::NoMap)?;
                Some((Map::Rational { scale: map.scale.clone() }, map.prefactor.clone()))
            }
            Method::ConformalPade => {
                let singularity = singularity.ok_or(ResummationError::NoSingularity)?;
                let p = self.map.as_ref().map_or_else(|| Float::new(53), |m| m.prefactor.clone());
                Some((wedge(singularity, self.bits), p))
            }
            Method::BorelPade => {
                return Err(ResummationError::NoFormula { method: method.name() });
            }
        };
        let own = &self.coefficients;
        let expand = |(map, p): &(Map, Float)| map.expand(own, p, self.bits, stop);
        let series = || map.as_ref().map_or_else(|| own.clone(), expand);
        let way = match method {
            Method::PartialSum => Way::Series,
            Method::Uniform => Way::InVariable(series()),
            _ => {
                let stairs = Staircase::new(&series(), self.bits, stop)?;
                Way::Approximants(match self.radius == Some(0.0) {
                    true => stairs.with_neighbours(stop),
                    false => stairs,
                })
            }
        };
        Ok(Prepared { map, way })
    }
}

impl Prepared {
    /// The same to fewer bits, for many points.
    pub fn rounded(self, bits: u32) -> Self {
        let way = match self.way {
            Way::Approximants(stairs) => Way::Approximants(stairs.rounded(bits)),
            other => other,
        };
        Self { way, ..self }
    }

    /// The value at the point of a sample of the same coefficients.
    pub fn outcome(&self, sample: &Sample, stop: &Stop) -> Result<Outcome, ResummationError> {
        let (point, bits) = (&sample.point, sample.bits);
        let mut w = point.clone();
        let mut factor = None;
        if let Some((map, p)) = &self.map {
            w = map.inverse(point, bits, stop)?;
            factor = Some(map.factor(point, &w, p, bits));
        }
        let outcome = match &self.way {
            Way::Series => partial_sum(sample),
            Way::InVariable(c) => {
                let known = sample.map.as_ref().and_then(|map| map.radius);
                let radius = disc(c, known);
                if let Some(radius) = radius.filter(|radius| w.clone().abs() >= *radius) {
                    return Err(ResummationError::OutsideDisc { radius, at: w.to_f64() });
                }
                convergent(c, &w, (radius, known.is_some()), bits)
            }
            Way::Approximants(stairs) => stairs.at(&w, stop),
        };
        Ok(match factor {
            Some(factor) => scaled(outcome?, &factor),
            None => outcome?,
        })
    }
}

/// The wedge whose tips are the singularity and its conjugate.
fn wedge(singularity: &Singularity, bits: u32) -> Map {
    // The same map at every precision: the tips need not be right to all bits, so they are
    // rounded to doubles, and rounding is then what the comparison of two precisions measures.
    let modulus = Float::with_val(bits, singularity.at.abs().to_f64());
    let fraction = singularity.at.arg().to_f64().abs() / std::f64::consts::PI;
    // A real singularity has an imaginary part from rounding only.
    let nearest = fraction.round();
    let fraction = if (fraction - nearest).abs() < 1e-12 { nearest } else { fraction };
    Map::Wedge { modulus, fraction: Float::with_val(bits, fraction) }
}

fn scaled(mut outcome: Outcome, factor: &Float) -> Outcome {
    outcome.estimate.value *= factor;
    let size = Float::with_val(53, factor.abs_ref());
    outcome.estimate.error *= &size;
    outcome.tentative = outcome.tentative.map(|tentative| tentative.scaled(factor));
    outcome
}
