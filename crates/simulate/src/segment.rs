//! The end of a step: the segment is reported and kept, sections are crossed.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Observer};
use crate::local::ShapeRef;
use crate::report::{Event, EventKind, Report, Segment};
use crate::roots::{AtCluster, Cluster};
use std::ops::ControlFlow;

impl<R: Real> Integrator<'_, R> {
    /// Reports the segment [0, h] and the crossings of sections in it, keeps it for delays.
    pub(crate) fn segment(
        &mut self,
        h: &R::Element,
        switches: bool,
        observer: &mut Observer<'_, R>,
    ) -> Result<ControlFlow<()>, SimulateError> {
        let system = self.system;
        if let Some(past) = &mut self.past {
            let how = (self.smooth, self.log2_tolerance);
            past.push(system, &self.clock, &self.series.rows, h, how);
        }
        self.smooth = true;
        let stride = self.series.rows.stride;
        let segment = Segment {
            real: &system.real,
            start: &self.clock.high,
            length: h,
            modes: &self.phase.modes,
            contact: self.phase.contact,
            shape: ShapeRef::Taylor {
                coefficients: &self.series.rows.data[..system.tape.states * stride],
                stride,
            },
        };
        let told = observer(&Report::Segment(segment));
        let crossed = self.cross_sections(h, switches, observer)?;
        Ok(if told.is_break() { told } else { crossed })
    }

    /// Crossings of the user's sections in (0, h]; at the end of a step that ends on a switch they are left to the next one.
    fn cross_sections(
        &mut self,
        h: &R::Element,
        switches: bool,
        observer: &mut Observer<'_, R>,
    ) -> Result<ControlFlow<()>, SimulateError> {
        let system = self.system;
        let offset = system.walls.len() + system.switches.len();
        let mut told = ControlFlow::Continue(());
        for (section, row) in system.sections.iter().enumerate() {
            // A section only looks on: where it is touched nothing happens.
            let _ = self.search(*row, offset + section, h, (usize::MAX, AtCluster::Pass));
            self.vanishing[offset + section] = 0;
            let end = system.real.log2(&self.series.value(&system.real, *row, h));
            if switches && end < self.rounding_errors() {
                self.finder.found.pop();
            }
            for index in 0..self.finder.found.len() {
                let root = self.finder.found[index].clone();
                if root.after == self.sides[section] {
                    continue;
                }
                // Within rounding errors of the end: the next step starts on the section.
                let rest = system.real.log2(&system.real.difference(h, &root.at));
                if rest < system.real.log2(h) - f64::from(system.real.bits()) + 8.0 {
                    self.vanishing[offset + section] = 1;
                }
                let mut time = self.clock.clone();
                time.advance(&system.real, &root.at);
                self.before.clear();
                for state in 0..system.tape.states {
                    self.before.push(self.series.value(&system.real, state, &root.at));
                }
                self.sides[section] = root.after;
                let kind = EventKind::Section { section, rising: root.after > 0 };
                let (before, after) = (&self.before[..], &self.before[..]);
                let log2_error = f64::NEG_INFINITY;
                let event = Event { time: &time.high, kind, before, after, log2_error };
                if observer(&Report::Event(event)).is_break() {
                    told = ControlFlow::Break(());
                }
            }
        }
        Ok(told)
    }

    /// Roots of a surface in (0, h], without those at the start.
    pub(crate) fn search(
        &mut self,
        row: usize,
        surface: usize,
        h: &R::Element,
        how: (usize, AtCluster),
    ) -> Result<(), Cluster<R::Element>> {
        self.finder.found.clear();
        let skip = self.vanishing[surface];
        let row = self.series.rows.row(row);
        if row.iter().skip(skip).all(|c| self.system.real.sign(c) == 0) {
            return Ok(());
        }
        self.finder.search(&self.system.real, row.get(skip..).unwrap_or_default(), h, how)
    }
}
