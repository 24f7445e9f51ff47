//! Errors, estimated by integrating once more with more digits and a higher order.

use crate::digits::Digits;
use crate::error::SimulateError;
use crate::integrator::Settings;
use crate::integrator::real::Real;
use rug::Float;

/// Something computed from an integration, in any arithmetic.
pub trait Computation {
    /// The results.
    fn run<R: Real>(&self, real: &R, settings: Settings) -> Result<Vec<R::Element>, SimulateError>;
}

/// A result with its estimated error.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimated<E> {
    /// The value.
    pub value: E,
    /// |value - value with 8 digits more|, rounded up: an estimate, no bound.
    pub error: f64,
}

/// Runs a computation with `digits` in the arithmetic `real`, and again in floats with 8 digits
/// more (so with a higher order and shorter steps); the differences estimate the errors of the
/// first. Costs little more in floats than the computation alone; beside f64 it is the second
/// run that costs, some hundred times the first.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{
///     Computation, Doubles, Integrator, Model, Parameters, Real, Settings, SimulateError, estimate,
/// };
/// use std::ops::ControlFlow;
///
/// struct Cosine;
/// impl Computation for Cosine {
///     fn run<R: Real>(&self, real: &R, settings: Settings) -> Result<Vec<R::Element>, SimulateError> {
///         let x = Expression::DISPLACEMENT;
///         let model = Model::second_order(&(Expression::ACCELERATION + x))?;
///         let system = model.compile(real.clone(), &Parameters::new())?;
///         let start = [real.double(1.0), real.zero()];
///         let mut flow = Integrator::new(&system, &real.zero(), &start, settings)?;
///         flow.advance(&real.double(10.0), &mut |_| ControlFlow::Continue(()))?;
///         Ok(flow.state().to_vec())
///     }
/// }
/// let [x, _] = &estimate(&Cosine, &Doubles, 16)?[..] else { unreachable!() };
/// let error = (x.value - 10f64.cos()).abs();
/// assert!(x.error < 1e-14 && (error - x.error).abs() < 1e-16);
/// # Ok::<(), SimulateError>(())
/// ```
pub fn estimate<C: Computation, R: Real>(
    computation: &C,
    real: &R,
    digits: u32,
) -> Result<Vec<Estimated<R::Element>>, SimulateError> {
    let values = computation.run(real, Settings::for_digits(digits))?;
    let more = digits + 8;
    let finer = computation.run(&Digits::for_digits(more), Settings::for_digits(more))?;
    let pairs = values.into_iter().zip(finer);
    Ok(pairs
        .map(|(value, finer)| {
            let difference = Float::with_val(finer.prec(), &finer - real.to_float(&value));
            let error = difference.abs().to_f64_round(rug::float::Round::Up);
            Estimated { value, error }
        })
        .collect())
}
