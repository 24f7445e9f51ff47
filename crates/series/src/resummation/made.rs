//! What was made of one series, whatever the point, and the value by a method with it.

use super::borel::{Nodes, borel_transform, laplace};
use super::estimate::widest;
use super::once::Once;
use super::prepared::Prepared;
use super::staircase::Staircase;
use super::{Estimate, Method, Outcome, Pade, Picture, ResummationError, Sample, Singularity};
use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Special;
use std::sync::Arc;

/// A method's variable and sum, or why there is none.
type Way = Result<Arc<Prepared>, ResummationError>;
/// The approximants of the Borel transform.
type Transformed = Result<Arc<Staircase>, ResummationError>;

/// What was made of one series at one precision, whatever the point of its sample.
pub(super) struct Made {
    sample: Sample,
    accuracy: u32,
    singularity: Once<(), Option<Singularity>>,
    /// With the place and the exponent of the singularity that a map has.
    ways: Once<(Method, Option<(f64, f64)>), Way>,
    transformed: Once<(), Transformed>,
    nodes: Once<u32, Arc<Nodes>>,
    picture: Once<(), Option<Picture>>,
}

impl std::fmt::Debug for Made {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Made").field("bits", &self.sample.bits).finish_non_exhaustive()
    }
}

impl Made {
    pub fn new(sample: &Sample, accuracy: u32) -> Self {
        Self {
            sample: sample.clone(),
            accuracy,
            singularity: Once::new(),
            ways: Once::new(),
            transformed: Once::new(),
            nodes: Once::new(),
            picture: Once::new(),
        }
    }

    pub fn is_of(&self, sample: &Sample, accuracy: u32) -> bool {
        let own = &self.sample;
        (self.accuracy, own.bits, own.radius) == (accuracy, sample.bits, sample.radius)
            && own.map == sample.map
            && own.coefficients == sample.coefficients
    }

    pub fn singularity(&self, stop: &Stop) -> Option<Singularity> {
        self.singularity.get((), stop, || self.sample.singularity(stop))
    }

    /// As [`Sample::prepared`].
    pub fn way(&self, method: Method, singularity: Option<&Singularity>, stop: &Stop) -> Way {
        let conformal = singularity.filter(|_| method == Method::ConformalPade);
        let place = conformal.map(|found| (found.at.re.to_f64(), found.at.im.to_f64()));
        let make = || self.sample.prepared(method, singularity, stop).map(Arc::new);
        self.ways.get((method, place), stop, make)
    }

    /// The approximants of sum c_n y^n/n!.
    pub fn transformed(&self, stop: &Stop) -> Transformed {
        let bits = self.sample.bits;
        let make = || {
            let b = borel_transform(&self.sample.coefficients, &Float::with_val(bits, 1), bits);
            Staircase::new(&b, bits, stop).map(Arc::new)
        };
        self.transformed.get((), stop, make)
    }

    /// Nodes for so many bits of an integral.
    pub fn nodes(&self, asked: u32, stop: &Stop) -> Arc<Nodes> {
        self.nodes.get(asked, stop, || Arc::new(Nodes::new(asked, self.sample.bits, stop)))
    }

    pub fn picture(&self, stop: &Stop) -> Option<Picture> {
        let (list, bits) = (&self.sample.coefficients, self.sample.bits);
        let order = list.len().checked_sub(1).filter(|order| *order > 1)?;
        let half = order / 2;
        let make = || Pade::new(list, order - half, half, bits, stop)?.picture(stop);
        self.picture.get((), stop, make)
    }
}

impl Sample {
    /// The value by `method`.
    ///
    /// `singularity` is needed for [`Method::ConformalPade`] (see [`Self::singularity`]).
    /// `accuracy` is the number of bits beyond which a Laplace integral need not go.
    ///
    /// `stop` is asked in all long loops, and nothing that was computed with one broken off is returned.
    ///
    /// # Errors
    /// [`ResummationError`] where the method does not apply or gives no value.
    pub fn sum(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        self.sum_made(&Made::new(self, accuracy), (method, singularity), accuracy, stop)
    }

    /// The same with what was made of the coefficients.
    pub(super) fn sum_made(
        &self,
        made: &Made,
        way: (Method, Option<&Singularity>),
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        let found = self.judged(made, way, accuracy, stop);
        if stop.asked() { Err(ResummationError::Stopped) } else { found }
    }

    fn judged(
        &self,
        made: &Made,
        way: (Method, Option<&Singularity>),
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        let known = self.coefficients.len();
        if known < 3 {
            return Err(ResummationError::TooFewCoefficients { known, needed: 3 });
        }
        if self.point.is_zero() {
            let value = Float::with_val(self.bits, &self.coefficients[0]);
            let estimate = Estimate { value, error: Float::new(53) };
            let (degrees, tentative, smallest_term) = (None, None, None);
            return Ok(Outcome { estimate, order: 0, degrees, tentative, smallest_term });
        }
        let outcome = self.by(made, way, accuracy, stop)?;
        Ok(self.resolved(outcome))
    }

    fn by(
        &self,
        made: &Made,
        (method, singularity): (Method, Option<&Singularity>),
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        if method != Method::BorelPade {
            return made.way(method, singularity, stop)?.outcome(self, stop);
        }
        let stairs = made.transformed(stop)?;
        // The integral is no better than the approximants: many digits only where they
        // agree to as many.
        let mut asked = accuracy.min(128);
        loop {
            let nodes = made.nodes(asked, stop);
            let value = |pade: &Pade| Ok((laplace(pade, &self.point, &nodes)?, None));
            let mut outcome = stairs.judged(&widest, value, stop)?;
            // The line of its differences is no judgment of its own, its approximants are those of another method.
            if let Some(tentative) = &mut outcome.tentative {
                tentative.error = Float::with_val(53, Special::Infinity);
            }
            let size = Float::with_val(53, outcome.estimate.value.abs_ref());
            // What the integral was not asked for.
            let rest = size >> asked;
            let limited = outcome.estimate.error < Float::with_val(53, &rest << 16);
            outcome.estimate.error += rest;
            if !limited || asked >= accuracy {
                return Ok(outcome);
            }
            asked = asked.saturating_mul(4).min(accuracy);
        }
    }
}
