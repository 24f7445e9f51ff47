//! Which surface is met first, and what happens there.

use crate::error::{SimulateError, Surface};
use crate::integrator::arithmetic::LEAP;
use crate::integrator::real::Real;
use crate::integrator::{Hit, Integrator, Observer};
use crate::report::{Event, EventKind, Report};
use crate::roots::AtCluster;
use crate::tape::Op;
use std::ops::ControlFlow;

/// The first root, and no cluster before it.
const FIRST: (usize, AtCluster) = (1, AtCluster::Stop);
/// All roots, past clusters where the sign stays.
const CHANGES: (usize, AtCluster) = (usize::MAX, AtCluster::Pass);

impl<R: Real> Integrator<'_, R> {
    /// The classification of the start: signs of the switches, walls.
    pub(crate) fn begin_here(&mut self) -> Result<(), SimulateError> {
        let system = self.system;
        self.expand_to(0)?;
        for (index, wall) in system.walls.iter().enumerate() {
            let side = system.real.sign(self.series.rows.at(wall.row, 0));
            if side * wall.direction > 0 {
                let position = system.real.to_f64(&wall.position);
                return Err(SimulateError::BehindWall { wall: index, position });
            }
        }
        self.classify(f64::NEG_INFINITY)
    }

    /// The signs of all switches from the state; those within the noise (log2, relative to the
    /// state) of zero are settled by the fields on both sides.
    pub(crate) fn classify(&mut self, noise: f64) -> Result<(), SimulateError> {
        let system = self.system;
        self.expand_to(0)?;
        let real = &system.real;
        let scale = self.state.iter().map(|x| real.log2(x)).fold(f64::NEG_INFINITY, f64::max);
        let mut open: Vec<usize> = Vec::new();
        for (index, switch) in system.switches.iter().enumerate() {
            let h = self.series.rows.at(switch.row, 0);
            if real.sign(h) == 0 && switch.branch {
                // It is carried away from zero by a leap.
                self.phase.modes[index] = 1;
                continue;
            }
            if real.sign(h) == 0 || real.log2(h) <= scale + noise {
                if let Some(first) =
                    open.iter().find(|i| switch.jumps && system.switches[**i].jumps)
                {
                    let (first, second, time) = (*first, index, self.seconds());
                    return Err(SimulateError::SimultaneousSwitches { first, second, time });
                }
                open.push(index);
                self.phase.modes[index] = if self.phase.modes[index] < 0 { -1 } else { 1 };
            } else {
                self.phase.modes[index] = real.sign(h);
                self.vanishing[system.walls.len() + index] = 0;
            }
        }
        for index in open {
            self.settle(index)?;
        }
        self.sides.iter_mut().for_each(|side| *side = 0);
        Ok(())
    }

    /// The row of the sign of a sliding switch.
    pub(crate) fn control_row(&self, switch: usize) -> Option<usize> {
        let control = Op::Control { switch, part: 0 };
        let index = self.system.tape.ops.iter().position(|op| *op == control);
        index.map(|index| self.system.tape.states + index)
    }

    /// A surface on whose wrong side the series starts, by rounding errors or because the right
    /// side has jumped (delayed terms, impacts).
    pub(crate) fn hit_at_start(&mut self) -> Option<Hit<R::Element>> {
        let system = self.system;
        let real = &system.real;
        let hit = |surface, after| Some(Hit { at: real.zero(), surface, after });
        let leading = |row: &[R::Element]| row.iter().map(|c| real.sign(c)).find(|s| *s != 0);
        for (index, wall) in system.walls.iter().enumerate() {
            let d = wall.direction;
            if self.phase.contact == Some(index) {
                let errors = self.rounding_errors();
                let force = self.series.rows.row(system.force()).iter();
                let force = force.map(|c| (real.log2(c) > errors).then(|| real.sign(c)));
                if force.flatten().next() == Some(-d) {
                    return hit(Surface::Contact(index), -d);
                }
                continue;
            }
            if self.phase.contact.is_some() {
                continue;
            }
            let row = self.series.rows.row(wall.row);
            if self.vanishing[index] == 0 && real.sign(&row[0]) * d >= 0 {
                match real.sign(&row[1]) * d {
                    1 => return hit(Surface::Wall(index), d),
                    0 => self.vanishing[index] = 2,
                    _ => self.vanishing[index] = 1,
                }
            }
            let skip = self.vanishing[index];
            if skip >= 2 && leading(&row[skip..]) == Some(d) {
                // At rest at the wall, and pushed against it.
                return hit(Surface::Wall(index), 0);
            }
        }
        for (index, switch) in system.switches.iter().enumerate() {
            let mode = self.phase.modes[index];
            if mode == 0 {
                let u = self.control_row(index).map(|row| self.series.rows.at(row, 0));
                let excess = u.map(|u| real.to_f64(&real.absolute(u)) - 1.0);
                let limit = (12.0 - f64::from(real.bits().min(53))).exp2();
                if self.phase.contact.is_none() && excess.is_some_and(|excess| excess > limit) {
                    let after = u.map_or(0, |u| real.sign(u));
                    return hit(Surface::Limit(index), after);
                }
                continue;
            }
            let sign = real.sign(self.series.rows.at(switch.row, 0));
            let leaps = switch.branch && sign == 0;
            if self.vanishing[system.walls.len() + index] == 0 && sign != mode && !leaps {
                let row = self.series.rows.row(switch.row);
                if leading(row).is_some() {
                    return hit(Surface::Switch(index), -mode);
                }
            }
        }
        self.section_at_start()
    }

    /// A section whose function begins the step with another sign than it had.
    ///
    /// Where a switch has just been met or slides, a function that vanishes with the switch's argument is zero but for
    /// rounding errors: after the switch its sign is that of its first coefficient beyond them, and while
    /// function and derivative are within them the section sleeps.
    fn section_at_start(&mut self) -> Option<Hit<R::Element>> {
        let system = self.system;
        let real = &system.real;
        let sliding = self.phase.modes.contains(&0);
        if sliding && !system.sections.is_empty() {
            self.rounding = Some(self.rounding_errors());
        }
        let leading = |row: &[R::Element], skip: usize| {
            let mut signs = row.iter().skip(skip).map(|c| real.sign(c));
            signs.find(|sign| *sign != 0).unwrap_or(0)
        };
        let offset = system.walls.len() + system.switches.len();
        for (index, row) in system.sections.iter().enumerate() {
            let row = self.series.rows.row(*row);
            let exact = || row.iter().take_while(|c| real.sign(c) == 0).count();
            let beyond = self.rounding.map(|log2| row.iter().position(|c| real.log2(c) > log2));
            let (skip, side) = (&mut self.vanishing[offset + index], &mut self.sides[index]);
            if sliding && beyond.is_some_and(|first| first.is_none_or(|first| first > 1)) {
                *skip = row.len();
                continue;
            }
            // What ends a step on the section within rounding errors was told, but for that on a switch.
            let told = *skip > 0;
            if !told {
                *skip = beyond.flatten().unwrap_or_else(exact);
            }
            let ahead = if told { *side } else { leading(row, *skip) };
            let known = std::mem::replace(side, if ahead == 0 { *side } else { ahead });
            if known != 0 && ahead == -known {
                return Some(Hit {
                    at: real.zero(),
                    surface: Surface::Section(index),
                    after: ahead,
                });
            }
        }
        None
    }

    /// log2 of the errors, of rounding and of the step, of all functions of the state at the start of the step.
    pub(crate) fn rounding_errors(&self) -> f64 {
        let real = &self.system.real;
        let rows = (0..self.system.tape.rows()).flat_map(|row| &self.series.rows.row(row)[..2]);
        let scale = rows.map(|c| real.log2(c)).filter(|log2| *log2 < f64::INFINITY);
        scale.fold(f64::NEG_INFINITY, f64::max) + self.relative_error() + 12.0
    }

    /// log2 of the relative error of a step.
    fn relative_error(&self) -> f64 {
        self.log2_tolerance.max(-f64::from(self.system.real.bits()))
    }

    /// The first surface met in (0, h].
    pub(crate) fn next_hit(
        &mut self,
        h: &R::Element,
    ) -> Result<Option<Hit<R::Element>>, SimulateError> {
        let system = self.system;
        let mut first: Option<Hit<R::Element>> = None;
        let mut cluster: Option<(Surface, R::Element)> = None;
        let walls = system.walls.len();
        if let Some(wall) = self.phase.contact {
            let row = system.force();
            // The force itself starts anywhere, not on the surface.
            let skip = std::mem::replace(&mut self.vanishing[wall], 0);
            let outcome = self.search(row, wall, h, CHANGES);
            // A force that touches zero ends no rest.
            self.finder.drop_pairs(&system.real, h, self.relative_error() / 2.0);
            self.finder.found.retain(|root| root.after == -system.walls[wall].direction);
            self.vanishing[wall] = skip;
            self.keep(Surface::Contact(wall), outcome.err(), &mut first, &mut cluster)?;
        } else {
            for wall in 0..walls {
                let outcome = self.search(system.walls[wall].row, wall, h, FIRST);
                self.keep(Surface::Wall(wall), outcome.err(), &mut first, &mut cluster)?;
            }
        }
        for switch in 0..system.switches.len() {
            if self.phase.modes[switch] == LEAP {
                continue;
            }
            if self.phase.modes[switch] != 0 {
                let row = system.switches[switch].row;
                let outcome = self.search(row, walls + switch, h, FIRST);
                self.keep(Surface::Switch(switch), outcome.err(), &mut first, &mut cluster)?;
                continue;
            }
            let Some(row) = self.control_row(switch).filter(|_| self.phase.contact.is_none())
            else {
                continue;
            };
            for limit in [1.0, -1.0] {
                let known = self.series.order;
                self.polynomial.clear();
                self.polynomial.extend_from_slice(&self.series.rows.row(row)[..known]);
                let shifted =
                    system.real.difference(&self.polynomial[0], &system.real.double(limit));
                // Released when it grows beyond the limit; exactly on it: skip the zero.
                let start = usize::from(system.real.sign(&shifted) == 0);
                self.polynomial[0] = shifted;
                let outcome = self.finder.search(&system.real, &self.polynomial[start..], h, FIRST);
                self.keep(Surface::Limit(switch), outcome.err(), &mut first, &mut cluster)?;
            }
        }
        match (cluster, &first) {
            (Some((surface, at)), Some(hit)) if at < hit.at => Err(self.grazing(surface, &at)),
            (Some((surface, at)), None) => Err(self.grazing(surface, &at)),
            _ => Ok(first),
        }
    }

    /// Keeps the earliest root or cluster found so far.
    fn keep(
        &self,
        surface: Surface,
        failed: Option<crate::roots::Cluster<R::Element>>,
        first: &mut Option<Hit<R::Element>>,
        cluster: &mut Option<(Surface, R::Element)>,
    ) -> Result<(), SimulateError> {
        let real = &self.system.real;
        if let Some(root) = self.finder.found.first() {
            if let Some(known) = first {
                let gap = real.log2(&real.difference(&root.at, &known.at));
                let both = real.log2(&root.at).max(real.log2(&self.clock.high));
                if let (Surface::Switch(a), Surface::Switch(b)) = (known.surface, surface)
                    && gap <= both + 6.0 - f64::from(real.bits())
                    && self.system.switches[a].jumps
                    && self.system.switches[b].jumps
                {
                    let time = self.seconds() + real.to_f64(&root.at);
                    return Err(SimulateError::SimultaneousSwitches { first: a, second: b, time });
                }
            }
            if first.as_ref().is_none_or(|known| root.at < known.at) {
                *first = Some(Hit { at: root.at.clone(), surface, after: root.after });
            }
        } else if let Some(found) = failed
            && cluster.as_ref().is_none_or(|(_, at)| found.at < *at)
        {
            *cluster = Some((surface, found.at));
        }
        Ok(())
    }

    /// The state is on the surface: jumps, changes of the right side, report.
    pub(crate) fn arrive(
        &mut self,
        hit: &Hit<R::Element>,
        observer: &mut Observer<'_, R>,
    ) -> Result<ControlFlow<()>, SimulateError> {
        self.before.clear();
        self.before.extend_from_slice(&self.state);
        let kind = match hit.surface {
            Surface::Wall(wall) => self.impact(wall, hit)?,
            Surface::Contact(wall) => self.depart(wall)?,
            Surface::Switch(switch) => self.switch(switch, hit)?,
            Surface::Limit(switch) => self.release(switch, hit)?,
            Surface::Section(section) => {
                let offset = self.system.walls.len() + self.system.switches.len();
                let skip = &mut self.vanishing[offset + section];
                *skip = (*skip).max(1);
                EventKind::Section { section, rising: hit.after > 0 }
            }
        };
        if let EventKind::Switching { from, to, .. } = kind
            && from == to
        {
            return Ok(ControlFlow::Continue(()));
        }
        let starts = matches!(kind, EventKind::Switching { .. } | EventKind::Departure { .. });
        if starts && !self.system.sections.is_empty() {
            self.rounding = Some(self.rounding_errors());
        }
        Ok(self.tell(kind, f64::NEG_INFINITY, observer))
    }

    pub(crate) fn tell(
        &self,
        kind: EventKind,
        log2_error: f64,
        observer: &mut Observer<'_, R>,
    ) -> ControlFlow<()> {
        let (time, before, after) = (&self.clock.high, &self.before[..], &self.state[..]);
        observer(&Report::Event(Event { time, kind, before, after, log2_error }))
    }
}
