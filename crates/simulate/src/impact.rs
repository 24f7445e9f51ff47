//! Walls: impacts, their accumulation, rest and departure.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Hit, Integrator, Observer};
use crate::report::EventKind;
use std::ops::ControlFlow;

impl<R: Real> Integrator<'_, R> {
    /// x = wall exactly, x' -> -R x'; with R = 0 or at rest the force decides.
    pub(crate) fn impact(
        &mut self,
        index: usize,
        hit: &Hit<R::Element>,
    ) -> Result<EventKind, SimulateError> {
        let system = self.system;
        let real = &system.real;
        let wall = &system.walls[index];
        let rest = hit.after == 0;
        let incoming = self.incoming(&hit.at);
        let rate = self.state[1].clone();
        self.state[0] = wall.position.clone();
        self.before[0] = wall.position.clone();
        let mut outgoing = real.product(&rate, &wall.restitution);
        real.times_integer(&mut outgoing, -1);
        self.state[1] = if rest { real.zero() } else { outgoing };
        self.interrupted(u64::from(!rest), true)?;
        self.vanishing.iter_mut().for_each(|skip| *skip = 0);
        self.classify(8.0 - f64::from(real.bits()))?;
        if real.sign(&self.state[1]) != 0 {
            self.vanishing[index] = 1;
            self.rebound = Some(index);
            let gradient: Vec<R::Element> =
                (0..system.directions()).map(|i| self.tangent(i, 0)).collect();
            self.saltation(&incoming, &rate, &gradient, Some(&wall.restitution))?;
            return Ok(EventKind::Impact { wall: index });
        }
        self.expand()?;
        let force = self.series.rows.row(system.right_sides[1]);
        let force = force.iter().map(|c| real.sign(c)).find(|s| *s != 0).unwrap_or(0);
        if force * wall.direction >= 0 {
            self.rest(index);
            return Ok(EventKind::Rest { wall: index });
        }
        self.vanishing[index] = 2;
        let gradient: Vec<R::Element> =
            (0..system.directions()).map(|i| self.tangent(i, 0)).collect();
        self.saltation(&incoming, &rate, &gradient, Some(&wall.restitution))?;
        Ok(EventKind::Impact { wall: index })
    }

    /// The body stays at the wall: no perturbation survives.
    fn rest(&mut self, index: usize) {
        let system = self.system;
        self.phase.contact = Some(index);
        self.rebound = None;
        for tangent in self.state.iter_mut().skip(system.variables) {
            system.real.set_zero(tangent);
        }
    }

    /// The force changes its direction: a free flight begins, x - wall = O(s^3).
    pub(crate) fn depart(
        &mut self,
        index: usize,
        hit: &Hit<R::Element>,
    ) -> Result<EventKind, SimulateError> {
        let real = &self.system.real;
        self.phase.contact = None;
        let force = self.series.rows.row(self.system.right_sides[1]);
        let zeros = force.iter().take_while(|c| real.sign(c) == 0).count();
        self.vanishing[index] = if real.sign(&hit.at) == 0 { 2 + zeros } else { 3 };
        self.interrupted(0, false)?;
        Ok(EventKind::Departure { wall: index })
    }

    /// Whether the impacts that follow are a geometric sequence to the tolerance: with a constant
    /// acceleration a against the wall the flights last 2 v/a, 2 R v/a, ... and add up to
    /// tau = 2 v/(a (1 - R)). A varying acceleration changes them by the relative amount
    /// eta = sum_{k>2} k (k-1) |x_k| tau^{k-2}/(2 |x_2|); the error of tau is about eta tau.
    /// Returns tau and log2 of this error, relative to the time.
    ///
    /// Nothing as long as the velocity of the impact is above the tolerance relative to the start:
    /// the flights before are part of the motion, however exactly their sum is known.
    pub(crate) fn accumulation(&self, remaining: &R::Element) -> Option<(R::Element, f64)> {
        let real = &self.system.real;
        let wall = &self.system.walls[self.rebound?];
        let row = self.series.rows.row(0);
        let mut loss = real.double(1.0);
        real.subtract(&mut loss, &real.double(1.0), &wall.restitution);
        let jumps = self.system.switches.iter().any(|switch| switch.jumps);
        if real.sign(&row[2]) != wall.direction || real.sign(&loss) <= 0 {
            return None;
        }
        real.scale(&mut loss, &real.absolute(&row[2]));
        let duration = real.quotient(&real.absolute(&row[1]), &loss);
        if duration >= *remaining {
            return None;
        }
        let log = real.log2(&duration);
        let time = log.max(real.log2(&self.clock.high));
        let mut worst = f64::NEG_INFINITY;
        for (k, c) in row.iter().enumerate().skip(3) {
            let k = k as f64;
            let size = (k * (k - 1.0) / 2.0).log2() + real.log2(c) - real.log2(&row[2]);
            worst = worst.max(size + (k - 2.0) * log);
        }
        let error = log + worst + 1.0 - time;
        // The state is taken to rest at the wall meanwhile: what a delayed term sees is wrong by
        // the velocity for this time.
        let seen = if self.past.is_some() { real.log2(&row[1]) + log } else { f64::NEG_INFINITY };
        let unresolved = log < time - f64::from(real.bits());
        let settled = real.log2(&row[1]) <= self.log2_tolerance + self.log2_start;
        let accurate =
            settled && !jumps && error <= self.log2_tolerance && seen <= self.log2_tolerance;
        (accurate || unresolved)
            .then_some((duration, error.max(if unresolved { log - time } else { error })))
    }

    /// Jumps to the limit of the impacts.
    pub(crate) fn accumulate(
        &mut self,
        duration: &R::Element,
        log2_error: f64,
        observer: &mut Observer<'_, R>,
    ) -> Result<ControlFlow<()>, SimulateError> {
        let Some(index) = self.rebound else { return Ok(ControlFlow::Continue(())) };
        let system = self.system;
        self.before.clear();
        self.before.extend_from_slice(&self.state);
        self.state[0] = system.walls[index].position.clone();
        system.real.set_zero(&mut self.state[1]);
        if let Some(past) = &mut self.past {
            let rows = &mut self.series.rows;
            for state in 0..system.variables {
                rows.row_mut(state).iter_mut().for_each(|c| system.real.set_zero(c));
                system.real.set(rows.at_mut(state, 0), &self.state[state]);
            }
            past.push(system, &self.clock, rows, duration, (false, self.log2_tolerance));
        }
        self.clock.advance(&system.real, duration);
        self.rebound = None;
        self.vanishing.iter_mut().for_each(|skip| *skip = 0);
        self.classify(8.0 - f64::from(system.real.bits()))?;
        self.vanishing[index] = 2;
        self.interrupted(0, true)?;
        self.expand()?;
        let force = self.series.rows.row(system.right_sides[1]);
        let force = force.iter().map(|c| system.real.sign(c)).find(|s| *s != 0).unwrap_or(0);
        if force * system.walls[index].direction >= 0 {
            self.rest(index);
        }
        Ok(self.tell(EventKind::Accumulation { wall: index }, log2_error, observer))
    }
}
