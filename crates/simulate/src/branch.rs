//! Branch points: |w|^p with p no integer where w passes zero.
//!
//! The solution has no Taylor series there. Steps come closer geometrically (a step is a fixed
//! part of the distance) until the series in fractional powers about the branch point converges
//! fast (`crossing`). Where there is none of the kind known there (a delay, two different
//! exponents), they go on until what the terms in |w| do from there to the mirror image behind
//! the zero is below the tolerance; that short way is made without them (a leap). With w = O(s)
//! the terms contribute O(s^(p+1)), so p > -1 is needed, and about 10 digits/(p+1) steps on either
//! side. Where w does not pass zero with a speed the branch point is refused.

use crate::error::SimulateError;
use crate::integrator::arithmetic::LEAP;
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Observer};
use crate::report::EventKind;
use std::ops::ControlFlow;

/// A branch point ahead.
pub(crate) struct Branch<E> {
    pub(crate) switch: usize,
    /// When, to first order; zero: it is here.
    pub(crate) after: E,
}

/// What the terms in |w| do in a time, all as log2.
pub(crate) struct Influence<E> {
    /// The largest change of a state by them, relative to the state.
    pub(crate) change: f64,
    /// The largest change of a state without them, relative to the state.
    pub(crate) duration: f64,
    /// The rates of all states without them.
    pub(crate) rates: Vec<E>,
}

impl<R: Real> Integrator<'_, R> {
    /// The nearest branch point that the solution moves towards.
    pub(crate) fn branch_ahead(&self) -> Option<Branch<R::Element>> {
        let real = &self.system.real;
        let mut nearest: Option<Branch<R::Element>> = None;
        for (index, switch) in self.system.switches.iter().enumerate().filter(|s| s.1.branch) {
            let row = self.series.rows.row(switch.row);
            let after = match real.sign(&row[0]) {
                0 => real.zero(),
                side if real.sign(&row[1]) == -side => {
                    real.absolute(&real.quotient(&row[0], &row[1]))
                }
                _ => continue,
            };
            if nearest.as_ref().is_none_or(|known| after < known.after) {
                nearest = Some(Branch { switch: index, after });
            }
        }
        nearest
    }

    /// The leap over a branch point, if it is near enough; nothing otherwise.
    pub(crate) fn leap(
        &mut self,
        branch: &Branch<R::Element>,
        remaining: &R::Element,
        observer: &mut Observer<'_, R>,
    ) -> Result<Option<ControlFlow<()>>, SimulateError> {
        if let Some(told) = self.cross(branch, remaining, observer)? {
            return Ok(Some(told));
        }
        self.expand()?;
        let system = self.system;
        let real = &system.real;
        let index = branch.switch;
        let refused = SimulateError::BranchPoint { switch: index, time: self.seconds() };
        let mode = self.phase.modes[index];
        let here = real.sign(&branch.after) == 0;
        let mut length = real.sum(&branch.after, &branch.after);
        if !here {
            // Coefficients that overflow are those of a point very near.
            let longest = self.series.step(system, self.log2_tolerance).unwrap_or(f64::INFINITY);
            if real.to_f64(&length) > longest || !self.negligible(index, &length)? {
                self.expand()?;
                return Ok(None);
            }
        }
        self.phase.modes[index] = LEAP;
        self.expand()?;
        let direction = real.sign(self.series.rows.at(system.switches[index].row, 1));
        if direction == 0 {
            return Err(refused);
        }
        if here {
            length = self.first_leap(index, direction, remaining)?.ok_or(refused.clone())?;
        }
        let last = length >= *remaining;
        if last {
            length = remaining.clone();
        }
        if self.next_hit(&length)?.is_some() {
            return Err(refused);
        }
        self.phase.modes[index] = mode;
        let told = self.segment(&length, false, observer)?;
        self.work.steps += 1;
        self.move_by(&length);
        self.vanishing
            .iter_mut()
            .take(system.walls.len() + system.switches.len())
            .for_each(|skip| *skip = 0);
        self.before.clear();
        self.before.extend_from_slice(&self.state);
        self.phase.modes[index] = direction;
        self.expand_to(0)?;
        let side = real.sign(self.series.rows.at(system.switches[index].row, 0));
        if side != 0 {
            self.phase.modes[index] = side;
        }
        if here || side == mode {
            return Ok(Some(told));
        }
        let kind = EventKind::Switching { switch: index, from: mode, to: direction };
        let event = self.tell(kind, f64::NEG_INFINITY, observer);
        Ok(Some(if told.is_break() { told } else { event }))
    }

    /// Whether the terms in |w|, as large as they are now, change no state by more than the
    /// tolerance in the time `length`.
    fn negligible(&mut self, index: usize, length: &R::Element) -> Result<bool, SimulateError> {
        Ok(self.influence(index, length)?.change <= self.log2_tolerance)
    }

    /// What the terms in |w|, as large as they are now, do in the time `length`.
    pub(crate) fn influence(
        &mut self,
        index: usize,
        length: &R::Element,
    ) -> Result<Influence<R::Element>, SimulateError> {
        let system = self.system;
        let (real, n) = (&system.real, system.variables);
        let mode = self.phase.modes[index];
        let rates = |this: &Self| -> Vec<R::Element> {
            (0..system.tape.states).map(|k| this.series.rows.at(k, 1).clone()).collect()
        };
        self.expand_to(1)?;
        let with = rates(self);
        let without = self.rates_without(index)?;
        self.phase.modes[index] = mode;
        let largest = |list: &mut dyn Iterator<Item = f64>| {
            list.fold(
                f64::NEG_INFINITY,
                |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) },
            )
        };
        let log = real.log2(length);
        let (mut change, mut duration) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for group in [0..n, n..system.tape.states] {
            let pairs = with[group.clone()].iter().zip(&without[group.clone()]);
            let jump = largest(&mut pairs.map(|(a, b)| real.log2(&real.difference(a, b))));
            let rate = largest(&mut without[group.clone()].iter().map(|x| real.log2(x)));
            let scale = largest(&mut self.state[group].iter().map(|x| real.log2(x)));
            let worse = |known: f64, rate: f64| match rate {
                f64::NEG_INFINITY => known,
                _ => largest(&mut [known, rate + log - scale].into_iter()),
            };
            (change, duration) = (worse(change, jump), worse(duration, rate));
        }
        Ok(Influence { change, duration, rates: without })
    }

    /// The rates of all states without the terms in |w|.
    pub(crate) fn rates_without(&mut self, index: usize) -> Result<Vec<R::Element>, SimulateError> {
        let mode = std::mem::replace(&mut self.phase.modes[index], LEAP);
        let outcome = self.expand_to(1);
        self.phase.modes[index] = mode;
        outcome?;
        let states = 0..self.system.tape.states;
        Ok(states.map(|k| self.series.rows.at(k, 1).clone()).collect())
    }

    /// The length of a leap away from w = 0: as long as the terms in |w| are negligible at its
    /// end.
    fn first_leap(
        &mut self,
        index: usize,
        direction: i8,
        remaining: &R::Element,
    ) -> Result<Option<R::Element>, SimulateError> {
        let real = &self.system.real;
        let longest = self.series.step(self.system, self.log2_tolerance).unwrap_or(0.0);
        let mut length = real.double(longest.min(1.0));
        if length > *remaining {
            length = remaining.clone();
        }
        let (state, clock) = (self.state.clone(), self.clock.clone());
        for _ in 0..4 * real.bits() {
            self.phase.modes[index] = LEAP;
            self.expand()?;
            self.move_by(&length);
            self.phase.modes[index] = direction;
            let enough = self.negligible(index, &length)?;
            self.state.clone_from(&state);
            self.clock = clock.clone();
            if enough {
                self.phase.modes[index] = LEAP;
                self.expand()?;
                return Ok(Some(length));
            }
            real.scale(&mut length, &real.double(0.25));
        }
        Ok(None)
    }
}
