//! A solution that is kept.

use crate::integrator::real::Real;
use crate::local::Shape;
use crate::report::Report;

#[derive(Clone, Debug)]
struct Piece<R: Real> {
    start: R::Element,
    length: R::Element,
    shape: Shape<R>,
}

/// Dense output: the polynomials of all steps.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{Doubles, Integrator, Model, Parameters, Settings, Trajectory};
///
/// let x = Expression::DISPLACEMENT;
/// let model = Model::second_order(&(Expression::ACCELERATION + x))?;
/// let system = model.compile(Doubles, &Parameters::new())?;
/// let mut flow = Integrator::new(&system, &0.0, &[1.0, 0.0], Settings::for_digits(16))?;
/// let mut trajectory = Trajectory::new(Doubles);
/// flow.advance(&10.0, &mut |report| trajectory.record(report))?;
/// let x = trajectory.value(0, &7.5).unwrap_or(f64::NAN);
/// assert!((x - 7.5f64.cos()).abs() < 1e-14);
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trajectory<R: Real> {
    real: R,
    pieces: Vec<Piece<R>>,
}

impl<R: Real> Trajectory<R> {
    /// An empty one.
    pub fn new(real: R) -> Self {
        Self { real, pieces: Vec::new() }
    }

    /// Keeps a report; for use as an observer, never breaks off.
    pub fn record(&mut self, report: &Report<'_, R>) -> std::ops::ControlFlow<()> {
        if let Report::Segment(segment) = report {
            self.pieces.push(Piece {
                start: segment.start.clone(),
                length: segment.length.clone(),
                shape: segment.shape.keep(),
            });
        }
        std::ops::ControlFlow::Continue(())
    }

    fn piece(&self, time: &R::Element) -> Option<&Piece<R>> {
        let next = self.pieces.partition_point(|piece| piece.start <= *time);
        let piece = self.pieces.get(next.checked_sub(1)?)?;
        // The last piece includes its end; so does one before the gap of an accumulation.
        let end = self.real.sum(&piece.start, &piece.length);
        // Start and length are rounded: the end that was asked for may lie just beyond their sum.
        let beyond = self.real.to_f64(&self.real.difference(time, &end));
        let rounding = 1e-6 * self.real.to_f64(&piece.length);
        (beyond <= rounding || next < self.pieces.len()).then_some(piece)
    }

    /// A state at a time (after the jump, at a jump); nothing outside of what was kept or for a
    /// state that does not exist. During an accumulation of impacts, which is jumped over, the
    /// value at the impact before. Cost: a binary search and one evaluation.
    #[must_use]
    pub fn value(&self, state: usize, time: &R::Element) -> Option<R::Element> {
        let piece = self.piece(time)?;
        let mut s = self.real.difference(time, &piece.start);
        if s > piece.length {
            s = piece.length.clone();
        }
        piece.shape.borrow().value(&self.real, state, &s)
    }
}
