//! Poincare maps: the state once per forcing period, or at the crossings of a surface.

use crate::error::{SimulateError, Surface};
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Settings, Tick};
use crate::report::{EventKind, Report};
use crate::system::System;
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Where the state is looked at.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Section<E> {
    /// Stroboscopic: at start + k period, k = 1, 2, ...
    Period(E),
    /// Stroboscopic with another phase: at start + first + k period, k = 0, 1, 2, ...; first >= 0.
    /// Off the impacts of an orbit with the same period, where left and right limits differ.
    Strobe {
        /// When the first point is.
        first: E,
        /// Between the others.
        period: E,
    },
    /// At the events of a surface, the state after the event (and that before it): impacts for a wall, switchings
    /// (entry, release, crossing) for a switch, crossings for a section of the model.
    Events {
        /// The surface: [`Surface::Wall`], [`Surface::Switch`] or [`Surface::Section`].
        surface: Surface,
        /// Only crossings in this direction (the sign grows: true); walls have none.
        rising: Option<bool>,
        /// Give up when no event comes within this time.
        patience: E,
    },
}

impl<E> Section<E> {
    /// Whether the times of the points are known.
    pub(crate) fn is_strobe(&self) -> bool {
        matches!(self, Self::Period(_) | Self::Strobe { .. })
    }
}

/// A point of a Poincare section.
#[derive(Clone, Debug, PartialEq)]
pub struct Point<E> {
    /// When.
    pub time: E,
    /// The states, without the linearisation; after an event.
    pub state: Vec<E>,
    /// The states just before: others than `state` only at an impact.
    pub before: Vec<E>,
    /// The signs of the switches; 0: sliding.
    pub modes: Vec<i8>,
    /// The wall that the body rests at.
    pub contact: Option<usize>,
}

impl<E> Point<E> {
    /// Whether a switch slides (the mass sticks) or the body rests at a wall.
    #[must_use]
    pub fn stuck(&self) -> bool {
        self.contact.is_some() || self.modes.contains(&0)
    }
}

/// The orbit of a Poincare map.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{
///     Doubles, Model, Parameters, PoincareMap, Section, Settings, Surface, go_on,
/// };
///
/// let x = Expression::DISPLACEMENT;
/// let model = Model::second_order(&(Expression::ACCELERATION + x.clone()))?.with_section(x);
/// let system = model.compile(Doubles, &Parameters::new())?;
/// let surface = Surface::Section(0);
/// let section = Section::Events { surface, rising: Some(true), patience: 10.0 };
/// let settings = Settings::for_digits(16);
/// let mut map = PoincareMap::new(&system, &0.0, &[1.0, 0.0], section, settings)?;
/// let first = map.next_point(&go_on)?.map_or(0.0, |point| point.time);
/// assert!((first - 1.5 * std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PoincareMap<'s, R: Real> {
    flow: Integrator<'s, R>,
    section: Section<R::Element>,
    start: R::Element,
    count: i32,
    waiting: VecDeque<Point<R::Element>>,
}

impl<'s, R: Real> PoincareMap<'s, R> {
    /// Starts at `time`; errors as of [`Integrator::new`].
    pub fn new(
        system: &'s System<R>,
        time: &R::Element,
        state: &[R::Element],
        section: Section<R::Element>,
        settings: Settings,
    ) -> Result<Self, SimulateError> {
        let flow = Integrator::new(system, time, state, settings)?;
        Ok(Self { flow, section, start: time.clone(), count: 0, waiting: VecDeque::new() })
    }

    /// The next point, or nothing if the patience is at its end. Exact up to the errors of the
    /// integration; times of a stroboscopic map are rounded once, not summed. `tick` is asked at every step whether to
    /// go on ([`SimulateError::Stopped`]). Errors: as of [`Integrator::advance`].
    pub fn next_point(
        &mut self,
        tick: &Tick<'_>,
    ) -> Result<Option<Point<R::Element>>, SimulateError> {
        if let Section::Events { surface, rising, patience } = self.section.clone() {
            return self.event((surface, rising), &patience, tick);
        }
        let Some(target) = self.next_time() else { return Ok(None) };
        self.flow.advance_while(&target, tick)?;
        Ok(Some(self.point_at(target)))
    }

    /// The integration behind the map.
    #[must_use]
    pub fn flow(&self) -> &Integrator<'s, R> {
        &self.flow
    }

    /// The integration, to be advanced from outside.
    pub(crate) fn flow_mut(&mut self) -> &mut Integrator<'s, R> {
        &mut self.flow
    }

    /// When the next point of a stroboscopic map is; nothing for another.
    pub(crate) fn next_time(&mut self) -> Option<R::Element> {
        match self.section.clone() {
            Section::Period(period) => Some(self.strobe_time(&period.clone(), period)),
            Section::Strobe { first, period } => Some(self.strobe_time(&first, period)),
            Section::Events { .. } => None,
        }
    }

    fn strobe_time(&mut self, first: &R::Element, mut period: R::Element) -> R::Element {
        let real = &self.flow.system.real;
        // One rounding for k periods: first = period is the multiple k + 1.
        let same = *first == period;
        real.times_integer(&mut period, self.count + i32::from(same));
        self.count += 1;
        let since = if same { period } else { real.sum(first, &period) };
        real.sum(&self.start, &since)
    }

    /// The point where the integration is, at the time of a stroboscopic map.
    pub(crate) fn point_at(&self, time: R::Element) -> Point<R::Element> {
        let state = self.flow.state()[..self.flow.system.variables].to_vec();
        let (modes, contact) = (self.flow.modes().to_vec(), self.flow.contact());
        let before = state.clone();
        Point { time, state, before, modes, contact }
    }

    fn event(
        &mut self,
        wanted: (Surface, Option<bool>),
        patience: &R::Element,
        tick: &Tick<'_>,
    ) -> Result<Option<Point<R::Element>>, SimulateError> {
        if self.waiting.is_empty() {
            let (n, real) = (self.flow.system.variables, &self.flow.system.real);
            let limit = real.sum(self.flow.time(), patience);
            let (mut modes, mut contact) = (self.flow.modes().to_vec(), self.flow.contact());
            let waiting = &mut self.waiting;
            let mut stopped = false;
            // A step may cross a section several times: the step ends behind the last of them.
            self.flow.advance(&limit, &mut |report| match report {
                Report::Segment(segment) => {
                    modes = segment.modes.to_vec();
                    contact = segment.contact;
                    stopped |= tick().is_break();
                    if stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                }
                Report::Busy => {
                    stopped |= tick().is_break();
                    if stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                }
                Report::Event(event) => {
                    after(event.kind, &mut modes, &mut contact);
                    // A hit without rebound is an impact, too.
                    let hit = event.before.get(1) != event.after.get(1);
                    if !matches(event.kind, hit, wanted) {
                        return ControlFlow::Continue(());
                    }
                    waiting.push_back(Point {
                        time: event.time.clone(),
                        state: event.after[..n].to_vec(),
                        before: event.before[..n].to_vec(),
                        modes: modes.clone(),
                        contact,
                    });
                    ControlFlow::Break(())
                }
            })?;
            if stopped && self.waiting.is_empty() {
                return Err(SimulateError::Stopped);
            }
        }
        Ok(self.waiting.pop_front())
    }
}

/// What the event makes of the signs and of the contact.
fn after(kind: EventKind, modes: &mut [i8], contact: &mut Option<usize>) {
    match kind {
        EventKind::Switching { switch, to, .. } => {
            if let Some(mode) = modes.get_mut(switch) {
                *mode = to;
            }
        }
        EventKind::Accumulation { wall } | EventKind::Rest { wall } => *contact = Some(wall),
        EventKind::Departure { .. } => *contact = None,
        EventKind::Impact { .. } | EventKind::Section { .. } => {}
    }
}

fn matches(kind: EventKind, hit: bool, (surface, direction): (Surface, Option<bool>)) -> bool {
    let (found, upwards) = match kind {
        EventKind::Impact { wall } => (Surface::Wall(wall), direction),
        EventKind::Rest { wall } if hit => (Surface::Wall(wall), direction),
        EventKind::Switching { switch, from, to } => (Surface::Switch(switch), Some(to > from)),
        EventKind::Section { section, rising } => (Surface::Section(section), Some(rising)),
        _ => return false,
    };
    found == surface && (direction.is_none() || direction == upwards)
}
