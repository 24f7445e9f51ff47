//! One integration in one arithmetic, and what is kept of it.

use crate::course::{Course, Dot, End, Moment, Occurrence};
use crate::digits::Digits;
use crate::error::SimulateError;
use crate::integrator::real::{Doubles, Real};
use crate::integrator::{Integrator, Settings};
use crate::outcome::Outcome;
use crate::quantity::{Parameters, Quantity};
use crate::report::{EventKind, Report, Segment, Work};
use crate::system::Model;
use lindstedt_equation::Expression;
use rug::Float;
use serde::Serialize;
use std::ops::ControlFlow;

/// Points of a figure per step.
const DOTS: u32 = 24;
/// Impacts after which a motion is given up.
const MOST_IMPACTS: u64 = 1_000_000;

/// A motion: what is integrated, from where.
#[derive(Clone, Debug)]
pub struct Flow {
    /// The equation with its wall and its history.
    pub model: Model,
    /// The values of its parameters.
    pub parameters: Parameters,
    /// x(0), x'(0).
    pub start: [Quantity; 2],
    /// The same of further unknowns, one after the other.
    pub others: Vec<Quantity>,
    /// The period of the force.
    pub forcing: Option<Quantity>,
    /// Whether dry friction makes the body stick.
    pub sticks: bool,
}

/// Where a motion is cut for a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Cut {
    /// Once per period of the force, t = 2 pi n/omega.
    Stroboscopic,
    /// Just before each impact.
    Impact,
    /// x' = 0 from above: maxima of x.
    Velocity,
}

/// What of a motion is kept, and where it ends.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The motion.
    pub flow: &'a Flow,
    /// Its end.
    pub end: &'a End,
    /// Times of the samples, in order.
    pub times: &'a [Quantity],
    /// The section.
    pub section: Option<Cut>,
    /// Whether the line of a figure is kept.
    pub drawn: bool,
}

impl Flow {
    /// The states at t = 0.
    pub fn states(&self) -> impl Iterator<Item = &Quantity> {
        self.start.iter().chain(&self.others)
    }
}

impl Plan<'_> {
    /// The end, or a time that is long for the events that are to end it.
    fn target(&self) -> Quantity {
        let unit = self.flow.forcing.as_ref().map_or(10.0, |q| q.float(64).to_f64());
        match &self.end {
            End::Time(time) => time.clone(),
            End::Maxima(n) | End::Impacts(n) => {
                Quantity::Float(Float::with_val(64, 100.0 * unit * f64::from(n + 1)))
            }
        }
    }

    /// Integrates with so many digits, in doubles if `doubles`, until `stop` says so. Estimated: rounding
    /// errors are not bounded; compare with more digits.
    ///
    /// # Errors
    /// Those of [`Integrator::advance`].
    pub fn run(
        &self,
        digits: u32,
        doubles: bool,
        stop: &dyn Fn() -> bool,
    ) -> Result<Course, SimulateError> {
        if doubles {
            self.integrate(Doubles, 16, stop)
        } else {
            self.integrate(Digits::for_digits(digits), digits, stop)
        }
    }

    fn integrate<R: Real>(
        &self,
        real: R,
        digits: u32,
        stop: &dyn Fn() -> bool,
    ) -> Result<Course, SimulateError> {
        let mut model = self.flow.model.clone();
        if self.section == Some(Cut::Velocity) || matches!(self.end, End::Maxima(_)) {
            model = model.with_section(Expression::VELOCITY);
        }
        let system = model.compile(real.clone(), &self.flow.parameters)?;
        let bits = real.bits() + 64;
        let element = |q: &Quantity| real.float(&q.float(bits));
        let start: Vec<_> = self.flow.states().map(element).collect();
        let settings = Settings { most_impacts: MOST_IMPACTS, ..Settings::for_digits(digits) };
        let mut flow = Integrator::new(&system, &real.zero(), &start, settings)?;
        let mut keeper = Keeper::new(self, &real, bits, &start);
        let mut stopped = false;
        let outcome = flow.advance(&element(&self.target()), &mut |report| {
            stopped |= stop();
            if stopped || keeper.keep(report) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        let stuck = flow.contact().is_some() || flow.modes().contains(&0);
        keeper.rest(flow.time(), flow.state(), stuck);
        let (mut course, ended) = (keeper.course, keeper.ended);
        let reached = match self.end {
            End::Time(_) => outcome == Outcome::Reached,
            _ => ended.is_some(),
        };
        course.complete = !stopped && reached;
        course.last = moment(&real, flow.time(), flow.state(), stuck);
        if let Some(last) = ended {
            let end = last.time.to_f64();
            course.line.retain(|dot| dot.time <= end);
            course.samples.retain(|sample| sample.time <= last.time);
            course.points.retain(|point| point.time <= last.time);
            course.last = last;
        }
        course.work = flow.work();
        Ok(course)
    }
}

/// x, x' and the states of further unknowns.
fn split<R: Real>(real: &R, states: &[R::Element]) -> ([Float; 2], Vec<Float>) {
    let (first, others) = states.split_at(states.len().min(2));
    let pair = match first {
        [x, v] => [x, v].map(|x| real.to_float(x)),
        _ => [Float::new(2), Float::new(2)],
    };
    (pair, others.iter().map(|x| real.to_float(x)).collect())
}

fn moment<R: Real>(real: &R, time: &R::Element, states: &[R::Element], stuck: bool) -> Moment {
    let (state, others) = split(real, states);
    Moment { time: real.to_float(time), state, others, stuck }
}

/// Collects what is reported.
struct Keeper<'p, R: Real> {
    plan: &'p Plan<'p>,
    real: R,
    /// The times of samples.
    times: Vec<R::Element>,
    /// The period of the force, for the stroboscopic section.
    strobe: Option<Float>,
    bits: u32,
    /// Events that count towards the end.
    count: u32,
    /// The event that ended it; a section is crossed inside of a step, which goes on behind it.
    ended: Option<Moment>,
    course: Course,
}

impl<'p, R: Real> Keeper<'p, R> {
    fn new(plan: &'p Plan<'p>, real: &R, bits: u32, start: &[R::Element]) -> Self {
        let forcing = plan.flow.forcing.as_ref();
        let strobe = forcing.filter(|_| plan.section == Some(Cut::Stroboscopic));
        let course = Course {
            events: Vec::new(),
            samples: Vec::new(),
            points: Vec::new(),
            last: moment(real, &real.zero(), start, false),
            work: Work::default(),
            stuck_time: Float::new(real.bits()),
            line: Vec::new(),
            complete: false,
            points_at_impacts: plan.section == Some(Cut::Impact),
        };
        Self {
            plan,
            times: plan.times.iter().map(|q| real.float(&q.float(bits))).collect(),
            strobe: strobe.map(|q| q.float(bits)),
            bits,
            count: 0,
            ended: None,
            course,
            real: real.clone(),
        }
    }

    /// Keeps a report; whether the end is reached.
    fn keep(&mut self, report: &Report<'_, R>) -> bool {
        match report {
            Report::Segment(segment) => {
                self.segment(segment);
                return false;
            }
            Report::Busy => return false,
            Report::Event(_) if self.ended.is_some() => return true,
            Report::Event(event) => {
                let (before, _) = split(&self.real, event.before);
                let (after, others) = split(&self.real, event.after);
                let time = self.real.to_float(event.time);
                self.event(Occurrence { kind: event.kind, time, before, after }, others);
            }
        }
        self.ended.is_some()
    }

    /// An event with the states of further unknowns, which do not jump.
    fn event(&mut self, event: Occurrence, others: Vec<Float>) {
        let (section, end) = (self.plan.section, &self.plan.end);
        let maximum = matches!(event.kind, EventKind::Section { rising: false, .. });
        let impact = event.is_impact();
        let at = |state: &[Float; 2]| {
            let (time, state, others) = (event.time.clone(), state.clone(), others.clone());
            Moment { time, state, others, stuck: false }
        };
        if (maximum && section == Some(Cut::Velocity)) || (impact && section == Some(Cut::Impact)) {
            self.course.points.push(at(&event.before));
        }
        let (counts, most) = match end {
            End::Time(_) => (false, u32::MAX),
            End::Maxima(n) => (maximum, *n),
            End::Impacts(n) => (impact, *n),
        };
        self.count += u32::from(counts);
        // Infinitely many impacts: the one that is to end the motion is among them.
        let all =
            matches!(event.kind, EventKind::Accumulation { .. }) && matches!(end, End::Impacts(_));
        if all || counts && self.count >= most {
            self.ended = Some(at(&event.after));
        }
        // Where a fractional power passes zero nothing happens that could be told in time: the
        // integrator leaps over the branch point.
        let silent = match event.kind {
            EventKind::Section { .. } => true,
            EventKind::Switching { .. } => !self.plan.flow.sticks,
            _ => false,
        };
        if !silent {
            self.course.events.push(event);
        }
    }

    fn strobe_time(&self) -> Option<R::Element> {
        let n = u32::try_from(self.course.points.len()).ok()?.checked_add(1)?;
        let period = self.strobe.as_ref()?;
        Some(self.real.float(&Float::with_val(self.bits, period * n)))
    }

    fn segment(&mut self, segment: &Segment<'_, R>) {
        let real = self.real.clone();
        let stuck = segment.contact.is_some() || segment.modes.contains(&0);
        let states = 2 + self.plan.flow.others.len();
        let end = real.sum(segment.start, segment.length);
        let at = |time: &R::Element| {
            let mut s = real.difference(time, segment.start);
            if real.sign(&s) < 0 {
                // During an accumulation of impacts, which is jumped over.
                s = real.zero();
            }
            let states: Vec<_> = (0..states).map(|k| segment.value(k, &s)).collect();
            moment(&real, time, &states, stuck)
        };
        while let Some(time) = self.times.get(self.course.samples.len()).filter(|t| **t < end) {
            self.course.samples.push(at(time));
        }
        while let Some(time) = self.strobe_time().filter(|t| *t < end) {
            self.course.points.push(at(&time));
        }
        if stuck {
            self.course.stuck_time += real.to_float(segment.length);
        }
        if self.plan.drawn {
            let start = real.to_f64(segment.start);
            for k in 0..=DOTS {
                let part = real.double(f64::from(k) / f64::from(DOTS));
                let s = real.product(segment.length, &part);
                let value = |state| real.to_f64(&segment.value(state, &s));
                let time = start + real.to_f64(&s);
                self.course.line.push(Dot { time, x: value(0), v: value(1), stuck });
            }
        }
    }

    /// What falls on the end itself.
    fn rest(&mut self, time: &R::Element, state: &[R::Element], stuck: bool) {
        let real = self.real.clone();
        while let Some(t) = self.times.get(self.course.samples.len()).filter(|t| *t <= time) {
            self.course.samples.push(moment(&real, t, state, stuck));
        }
        while let Some(t) = self.strobe_time().filter(|t| t <= time) {
            self.course.points.push(moment(&real, &t, state, stuck));
        }
    }
}
