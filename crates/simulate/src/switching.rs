//! Filippov's rules at the zero of the argument w of a sign: cross, slide, release.
//!
//! With h_1 = dw/dt in the field of either side: both positive or both negative, the solution
//! crosses; pointing at the surface from both sides, it slides with the convex combination of the
//! fields that keeps w = 0 (the sign takes the value u in [-1, 1]); pointing away on both sides,
//! its future is not unique. Where h_1 vanishes the first coefficient that does not decides.
//! Sliding ends when u exceeds 1 or -1, towards that side (Filippov 1988, section 15).

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Hit, Integrator};
use crate::report::EventKind;

impl<R: Real> Integrator<'_, R> {
    /// A switch has reached zero from one side.
    pub(crate) fn switch(
        &mut self,
        index: usize,
        hit: &Hit<R::Element>,
    ) -> Result<EventKind, SimulateError> {
        let system = self.system;
        let real = &system.real;
        let switch = &system.switches[index];
        if switch.branch {
            return Err(SimulateError::BranchPoint { switch: index, time: self.seconds() });
        }
        let from = self.phase.modes[index];
        let kind = |to| EventKind::Switching { switch: index, from, to };
        // The right side has jumped over the surface (a delayed argument): no zero here.
        if real.sign(&hit.at) == 0 {
            let h = self.series.rows.at(switch.row, 0);
            let scale = self.state.iter().map(|x| real.log2(x)).fold(0.0, f64::max);
            if real.log2(h) > scale + 12.0 - f64::from(real.bits()) {
                let to = real.sign(h);
                self.phase.modes[index] = to;
                self.interrupted(0, false)?;
                return Ok(kind(to));
            }
        }
        let incoming = self.incoming(&hit.at);
        let rate = self.series.slope(real, switch.row, &hit.at);
        let gradient: Vec<R::Element> = switch
            .tangents
            .iter()
            .map(|row| row.map_or_else(|| real.zero(), |row| self.series.value(real, row, &hit.at)))
            .collect();
        self.settle(index)?;
        self.interrupted(0, false)?;
        if self.phase.modes[index] != from {
            self.saltation(&incoming, &rate, &gradient, None)?;
        }
        Ok(kind(self.phase.modes[index]))
    }

    /// Chooses the sign of a switch whose argument is zero, by Filippov's rules.
    pub(crate) fn settle(&mut self, index: usize) -> Result<(), SimulateError> {
        let walls = self.system.walls.len();
        let from = self.phase.modes[index];
        let plus = self.leading(index, 1)?;
        let minus = self.leading(index, -1)?;
        let (mode, skip) = match (plus, minus) {
            ((1, _), (-1, _)) => {
                return Err(SimulateError::NotUnique { switch: index, time: self.seconds() });
            }
            ((1, skip), _) => (1, skip),
            (_, (-1, skip)) => (-1, skip),
            // Nothing moves: either side.
            ((0, _), _) | (_, (0, _)) => (if from == 0 { 1 } else { from }, 0),
            _ => (0, 0),
        };
        if mode == 0 {
            let other =
                (0..self.phase.modes.len()).find(|i| *i != index && self.phase.modes[*i] == 0);
            if let Some(other) = other {
                let (first, second, time) = (other, index, self.seconds());
                return Err(SimulateError::SimultaneousSwitches { first, second, time });
            }
        }
        self.phase.modes[index] = mode;
        self.vanishing[walls + index] = skip;
        Ok(())
    }

    /// The sign of the first coefficient of the switch, after the zeroth, that is not zero up to
    /// rounding errors, in the field of one side; and its order.
    fn leading(&mut self, index: usize, mode: i8) -> Result<(i8, usize), SimulateError> {
        let system = self.system;
        let real = &system.real;
        self.phase.modes[index] = mode;
        let row = system.switches[index].row;
        for levels in [1, self.series.order] {
            self.expand_to(levels)?;
            for k in 1..=levels {
                let c = self.series.rows.at(row, k);
                let norms = (0..system.variables).map(|i| real.log2(self.series.rows.at(i, k)));
                let scale = norms.fold(f64::NEG_INFINITY, f64::max);
                if real.sign(c) != 0 && real.log2(c) > scale + 10.0 - f64::from(real.bits()) {
                    return Ok((real.sign(c), k));
                }
            }
        }
        Ok((0, 0))
    }

    /// The control has reached its limit: on with the field of that side, w = O(s^2).
    pub(crate) fn release(
        &mut self,
        index: usize,
        hit: &Hit<R::Element>,
    ) -> Result<EventKind, SimulateError> {
        let real = &self.system.real;
        let row = self.control_row(index);
        let u = row.map(|row| self.series.value(real, row, &hit.at));
        let to = u.map_or(0, |u| real.sign(&u));
        self.phase.modes[index] = to;
        let mut skip = 2;
        if real.sign(&hit.at) == 0 {
            // The right side has jumped, and the control with it.
            self.expand_to(1)?;
            let rate = self.series.rows.at(self.system.switches[index].row, 1);
            let limit = -0.6 * f64::from(real.bits());
            skip = if real.sign(rate) == to && real.log2(rate) > limit { 1 } else { 2 };
        }
        let walls = self.system.walls.len();
        self.vanishing[walls + index] = skip;
        self.interrupted(0, false)?;
        Ok(EventKind::Switching { switch: index, from: 0, to })
    }
}
