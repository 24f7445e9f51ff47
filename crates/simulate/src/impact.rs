//! Walls: impacts, their accumulation, rest and departure.

use crate::compile::Switch;
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
        if self.stays(index)? {
            self.rest(index);
            return Ok(EventKind::Rest { wall: index });
        }
        self.vanishing[index] = 2;
        let gradient: Vec<R::Element> =
            (0..system.directions()).map(|i| self.tangent(i, 0)).collect();
        self.saltation(&incoming, &rate, &gradient, Some(&wall.restitution))?;
        Ok(EventKind::Impact { wall: index })
    }

    /// Whether a body without velocity at the wall stays there: the force that it would leave with does not point away.
    /// Dry friction, which may hold the body as the wall does, acts against that motion.
    fn stays(&mut self, index: usize) -> Result<bool, SimulateError> {
        let system = self.system;
        self.turn_away(index)?;
        self.expand()?;
        let force = self.series.rows.row(system.force());
        let force = force.iter().map(|c| system.real.sign(c)).find(|sign| *sign != 0).unwrap_or(0);
        Ok(force * system.walls[index].direction >= 0)
    }

    /// Gives the switches that are zero for a body without velocity at the wall the signs of the motion that leaves it,
    /// x = wall - d s^2 for small s and the wall's direction d; which ones.
    fn turn_away(&mut self, index: usize) -> Result<Vec<usize>, SimulateError> {
        let system = self.system;
        let real = &system.real;
        let signs = |flow: &mut Self| -> Result<Vec<i8>, SimulateError> {
            flow.expand_to(0)?;
            let sign = |row| real.sign(flow.series.rows.at(row, 0));
            Ok(system.switches.iter().map(|switch| sign(switch.row)).collect())
        };
        let here = signs(self)?;
        let mut zero: Vec<usize> = (0..here.len()).filter(|switch| here[*switch] == 0).collect();
        if !zero.is_empty() {
            let rest = self.state.clone();
            let s = real.double((-f64::from(real.bits()) / 4.0).exp2());
            for (state, mut change) in self.state.iter_mut().zip([real.product(&s, &s), s]) {
                real.times_integer(&mut change, -i32::from(system.walls[index].direction));
                real.increase(state, &change);
            }
            let away = signs(self)?;
            self.state = rest;
            zero.retain(|switch| away[*switch] != 0);
            zero.iter().for_each(|switch| self.phase.modes[*switch] = away[*switch]);
        }
        Ok(zero)
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
    pub(crate) fn depart(&mut self, index: usize) -> Result<EventKind, SimulateError> {
        let system = self.system;
        let real = &system.real;
        self.phase.contact = None;
        self.expand()?;
        // Of x'', which has just been zero, as of what else is zero but for rounding errors.
        let errors = self.rounding_errors();
        let switches = system.switches.iter().map(|switch| switch.row);
        let rows = [system.walls[index].row].into_iter().chain(switches);
        for (row, place) in rows.zip([index].into_iter().chain(system.walls.len()..)) {
            let row = self.series.rows.row(row);
            let first = row.iter().position(|c| real.log2(c) > errors);
            match first.unwrap_or(row.len()) {
                0 => {}
                // The rate of a switch is another than at rest: it may turn.
                1 => self.vanishing[place] = 0,
                zeros => self.vanishing[place] = zeros,
            }
        }
        self.interrupted(0, false)?;
        Ok(EventKind::Departure { wall: index })
    }

    /// Whether the impacts that follow are a geometric sequence to the tolerance: with a constant
    /// acceleration a against the wall, b with the signs of the way back (dry friction), a flight takes v (1/a + 1/sqrt(a b))
    /// and ends with v sqrt(b/a), so those that follow add up to
    ///
    /// tau = v (1/a + 1/sqrt(a b))/(1 - R sqrt(b/a)),
    ///
    /// 2 v/(a (1 - R)) for b = a. A varying acceleration changes them by the relative amount
    /// eta = sum_{k>2} k (k-1) |x_k| tau^{k-2}/(2 |x_2|); the error of tau is about eta tau.
    /// Returns tau and log2 of this error, relative to the time.
    ///
    /// Nothing as long as the velocity of the impact is above the tolerance relative to the start:
    /// the flights before are part of the motion, however exactly their sum is known.
    pub(crate) fn accumulation(
        &mut self,
        remaining: &R::Element,
    ) -> Result<Option<(R::Element, f64)>, SimulateError> {
        let Some(index) = self.rebound else { return Ok(None) };
        let system = self.system;
        let real = &system.real;
        let wall = &system.walls[index];
        if real.sign(self.series.rows.at(0, 2)) != wall.direction {
            return Ok(None);
        }
        let jumps = system.switches.iter().any(|switch| switch.jumps);
        let back = if jumps { self.way_back(index)? } else { Some(real.double(1.0)) };
        let row = self.series.rows.row(0);
        let mut ratio = real.double(1.0);
        if let Some(back) = &back {
            real.power(&mut ratio, back, &real.double(0.5));
        }
        let mut loss = real.double(1.0);
        real.subtract(&mut loss, &real.double(1.0), &real.product(&wall.restitution, &ratio));
        if real.sign(&loss) <= 0 {
            return Ok(None);
        }
        real.scale(&mut loss, &real.absolute(&row[2]));
        // (1 + sqrt(a/b))/2 flights of a alone.
        let mean = real.sum(&real.double(0.5), &real.quotient(&real.double(0.5), &ratio));
        let speed = real.product(&real.absolute(&row[1]), &mean);
        let duration = real.quotient(&speed, &loss);
        if duration >= *remaining {
            return Ok(None);
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
        // A flight that turns within rounding errors of the wall: x begins anew at the switch.
        let height = 2.0 * real.log2(&row[1]) - real.log2(&row[2]) - 2.0;
        let flat = jumps
            && back.is_some()
            && height < real.log2(&wall.position) + 8.0 - f64::from(real.bits());
        let unresolved = flat || log < time - f64::from(real.bits());
        let settled = real.log2(&row[1]) <= self.log2_tolerance + self.log2_start;
        let accurate = settled
            && back.is_some()
            && error <= self.log2_tolerance
            && seen <= self.log2_tolerance;
        let error = if unresolved && !flat { error.max(log - time) } else { error };
        Ok((accurate || unresolved).then_some((duration, error)))
    }

    /// b/a of a flight from the wall, where no switch is met but at its turning point; nothing where it does not come back
    /// so.
    fn way_back(&mut self, index: usize) -> Result<Option<R::Element>, SimulateError> {
        let system = self.system;
        let real = &system.real;
        let (state, modes) = (self.state.clone(), self.phase.modes.clone());
        real.set_zero(&mut self.state[1]);
        let turning = self.turn_away(index)?;
        let stays = |flow: &Self| {
            let sign = |row| real.sign(flow.series.rows.at(row, 0));
            let kept = |(i, switch): (usize, &Switch)| {
                turning.contains(&i) || sign(switch.row) == flow.phase.modes[i]
            };
            system.switches.iter().enumerate().all(kept)
        };
        self.expand_to(0)?;
        let passes = self.phase.modes == modes && stays(self);
        let away = self.series.rows.at(system.force(), 0).clone();
        turning.iter().for_each(|switch| self.phase.modes[*switch] *= -1);
        self.expand_to(0)?;
        let back = real.quotient(self.series.rows.at(system.force(), 0), &away);
        (self.state, self.phase.modes) = (state, modes);
        self.expand()?;
        Ok((passes && real.sign(&back) > 0).then_some(back))
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
        if self.stays(index)? {
            self.rest(index);
        }
        Ok(self.tell(EventKind::Accumulation { wall: index }, log2_error, observer))
    }
}
