//! Linearisation: saltation at events, monodromy matrix, Floquet multipliers.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Settings, Tick};
use crate::system::System;
use nalgebra::{Complex, DMatrix};

impl<R: Real> Integrator<'_, R> {
    /// Component k of direction i.
    pub(crate) fn tangent(&self, direction: usize, k: usize) -> R::Element {
        let n = self.system.variables;
        self.state[n * (direction + 1) + k].clone()
    }

    /// x' just before the event, at s of the step; empty without linearisation.
    pub(crate) fn incoming(&mut self, s: &R::Element) -> Vec<R::Element> {
        if self.system.directions() == 0 {
            return Vec::new();
        }
        let real = &self.system.real;
        (0..self.system.variables).map(|k| self.series.slope(real, k, s)).collect()
    }

    /// delta -> D delta + (f_after - D f_before) (dh delta)/(dh/dt), D the derivative of the jump
    /// (identity, or diag(1, -R) at a wall); `gradient[i]` = dh delta_i, `rate` = dh/dt before.
    /// Source: di Bernardo, Budd, Champneys, Kowalczyk, Piecewise-smooth Dynamical Systems,
    /// Springer 2008, section 2.5.
    pub(crate) fn saltation(
        &mut self,
        incoming: &[R::Element],
        rate: &R::Element,
        gradient: &[R::Element],
        restitution: Option<&R::Element>,
    ) -> Result<(), SimulateError> {
        if incoming.is_empty() {
            return Ok(());
        }
        let system = self.system;
        let (real, n) = (&system.real, system.variables);
        self.expand_to(1)?;
        for (direction, gradient) in gradient.iter().enumerate() {
            let weight = real.quotient(gradient, rate);
            for (k, before) in incoming.iter().enumerate().take(n) {
                let place = n * (direction + 1) + k;
                let mut before = before.clone();
                if let (1, Some(restitution)) = (k, restitution) {
                    real.times_integer(&mut before, -1);
                    real.scale(&mut before, restitution);
                    real.times_integer(&mut self.state[place], -1);
                    real.scale(&mut self.state[place], restitution);
                }
                let jump = real.difference(self.series.rows.at(k, 1), &before);
                real.accumulate(&mut self.state[place], &jump, &weight);
            }
        }
        Ok(())
    }
}

/// The derivative of the flow from one time to another along a solution.
#[derive(Clone, Debug)]
pub struct Monodromy<R: Real> {
    /// The states at the end.
    pub end: Vec<R::Element>,
    /// The matrix, row by row: entry (k, i) is d(end_k)/d(start_i).
    pub matrix: Vec<Vec<R::Element>>,
}

impl<R: Real> Monodromy<R> {
    /// Floquet multipliers in f64, largest modulus first, as (real, imaginary): the eigenvalues
    /// of the matrix, with errors of about 1e-16 times its norm times their condition.
    pub fn multipliers(&self, real: &R) -> Result<Vec<(f64, f64)>, SimulateError> {
        let n = self.matrix.len();
        let entries = DMatrix::from_fn(n, n, |k, i| real.to_f64(&self.matrix[k][i]));
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Err(SimulateError::NoMultipliers);
        }
        let schur = nalgebra::Schur::try_new(entries, f64::EPSILON, 10_000);
        let schur = schur.ok_or(SimulateError::NoMultipliers)?;
        let mut values: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
        values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
        Ok(values.iter().map(|value| (value.re, value.im)).collect())
    }

    /// The trace.
    pub fn trace(&self, real: &R) -> R::Element {
        let mut trace = real.zero();
        for (k, row) in self.matrix.iter().enumerate() {
            real.increase(&mut trace, &row[k]);
        }
        trace
    }
}

/// The monodromy matrix of the linearised system from `start` to `end`, through impacts,
/// switchings and sliding; of a periodic orbit if the states at both ends agree.
///
/// Errors: as of [`Integrator::advance`]; the system must have been compiled from a model with
/// [`crate::Model::linearised`]. `tick` is asked at every step whether to go on ([`SimulateError::Stopped`]).
pub fn monodromy<R: Real>(
    system: &System<R>,
    (start, end): (&R::Element, &R::Element),
    state: &[R::Element],
    settings: Settings,
    tick: &Tick<'_>,
) -> Result<Monodromy<R>, SimulateError> {
    let n = system.variables;
    if system.directions() != n {
        let (states, given) = (n, system.directions());
        return Err(SimulateError::WrongDimension { states, given });
    }
    let mut flow = Integrator::new(system, start, state, settings)?;
    flow.advance_while(end, tick)?;
    let end = flow.state()[..n].to_vec();
    let matrix = (0..n).map(|k| (0..n).map(|i| flow.tangent(i, k)).collect()).collect();
    Ok(Monodromy { end, matrix })
}
