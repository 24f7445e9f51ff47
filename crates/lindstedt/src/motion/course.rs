//! One integration: what happens on the way from the start to the end.

use super::setup::Setup;
use super::{Section, View, difference, event_name};
use crate::Work as Means;
use lindstedt_equation::Expression;
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Outcome, Quantity, Real, Report, Segment, Settings,
    SimulateError, Work,
};
use rug::Float;
use std::ops::ControlFlow;

/// Points of a figure per step.
const DOTS: u32 = 24;
/// Impacts after which a motion is given up.
const MOST_IMPACTS: u64 = 1_000_000;

/// Where an integration ends.
#[derive(Clone)]
pub(super) enum End {
    Time(Quantity),
    /// The N-th maximum of x.
    Maxima(u32),
    Impacts(u32),
}

/// What to integrate.
pub(super) struct Plan {
    pub setup: Setup,
    pub end: End,
    /// Times of the samples, in order.
    pub times: Vec<Quantity>,
    pub section: Option<Section>,
    /// Points of the section left out at the beginning.
    pub skip: usize,
    /// Whether the line of a figure is kept.
    pub drawn: bool,
    pub view: View,
    /// Why the motion ends before it should.
    pub cut: Option<String>,
}

/// A state at a time.
#[derive(Clone)]
pub(super) struct Moment {
    pub time: Float,
    pub state: [Float; 2],
    /// Sticking, or resting at the wall.
    pub stuck: bool,
}

/// An event.
pub(super) struct Happening {
    pub kind: EventKind,
    pub time: Float,
    pub before: [Float; 2],
    pub after: [Float; 2],
}

impl Happening {
    /// An impact, or a hit without rebound.
    pub fn is_impact(&self) -> bool {
        match self.kind {
            EventKind::Impact { .. } => true,
            EventKind::Rest { .. } => self.before[1] != self.after[1],
            _ => false,
        }
    }
}

/// A point of the line that a figure shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// t.
    pub time: f64,
    /// x.
    pub x: f64,
    /// x'.
    pub v: f64,
    /// Sticking, or at rest at the wall.
    pub stuck: bool,
}

/// What came of an integration.
pub(super) struct Course {
    pub events: Vec<Happening>,
    pub samples: Vec<Moment>,
    pub points: Vec<Moment>,
    pub last: Moment,
    pub work: Work,
    /// The time spent sticking or at rest at the wall.
    pub stuck_time: Float,
    pub line: Vec<Dot>,
    /// The end was reached.
    pub complete: bool,
    /// The points are those of a section at impacts.
    points_at_impacts: bool,
}

impl Plan {
    /// Ends the motion at a thousandth of its time before the singularity.
    pub fn cut_before(&mut self, singularity: f64, reason: String) {
        let end = singularity * (1.0 - 1.0 / 1024.0);
        self.times.retain(|time| time.float(64) <= end);
        self.end = End::Time(Quantity::Float(Float::with_val(53, end)));
        self.cut = Some(reason);
    }

    /// The end, or a time that is long for the events that are to end it.
    fn target(&self) -> Quantity {
        let unit = self.setup.forcing.as_ref().map_or(10.0, |q| q.float(64).to_f64());
        match &self.end {
            End::Time(time) => time.clone(),
            End::Maxima(n) | End::Impacts(n) => {
                Quantity::Float(Float::with_val(64, 100.0 * unit * f64::from(n + 1)))
            }
        }
    }

    /// Whether the motion starts beside the periodic impact orbit.
    pub fn perturbed(&self) -> bool {
        let Some(orbit) = &self.setup.orbit else { return false };
        let start = self.setup.start[1].float(orbit.start.prec());
        difference(&start, &orbit.start) > Float::with_val(53, orbit.velocity.abs_ref()) * 1e-25f64
    }

    /// The same with half the perturbation, in the digits of [`Self::run`].
    pub fn run_half(&mut self, digits: u32, means: &Means) -> Option<Course> {
        let orbit = self.setup.orbit.as_ref()?;
        let start = self.setup.start[1].float(orbit.start.prec());
        let half = Quantity::Float((start + &orbit.start) / 2u32);
        let whole = std::mem::replace(&mut self.setup.start[1], half);
        let course = self.run(digits, means.doubles, means);
        self.setup.start[1] = whole;
        course.ok()
    }

    /// Integrates with so many digits, in doubles if `doubles`.
    pub fn run(&self, digits: u32, doubles: bool, means: &Means) -> Result<Course, SimulateError> {
        if doubles {
            self.integrate(Doubles, 16, means)
        } else {
            self.integrate(Digits::for_digits(digits), digits, means)
        }
    }

    fn integrate<R: Real>(
        &self,
        real: R,
        digits: u32,
        means: &Means,
    ) -> Result<Course, SimulateError> {
        let mut model = self.setup.model.clone();
        if self.section == Some(Section::Velocity) || matches!(self.end, End::Maxima(_)) {
            model = model.with_section(Expression::VELOCITY);
        }
        let system = model.compile(real.clone(), &self.setup.parameters)?;
        let bits = real.bits() + 64;
        let element = |q: &Quantity| real.float(&q.float(bits));
        let start = self.setup.start.each_ref().map(element);
        let settings = Settings { most_impacts: MOST_IMPACTS, ..Settings::for_digits(digits) };
        let mut flow = Integrator::new(&system, &real.zero(), &start, settings)?;
        let mut keeper = Keeper::new(self, &real, bits, &start);
        let mut stopped = false;
        let outcome = flow.advance(&element(&self.target()), &mut |report| {
            stopped |= means.stop.asked();
            if stopped || keeper.keep(report) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        let stuck = flow.contact().is_some() || flow.modes().contains(&0);
        let [x, v, ..] = flow.state() else { return Ok(keeper.course) };
        keeper.rest(flow.time(), [x, v], stuck);
        let (mut course, ended) = (keeper.course, keeper.ended);
        let reached = match self.end {
            End::Time(_) => outcome == Outcome::Reached,
            _ => ended.is_some(),
        };
        course.complete = !stopped && self.cut.is_none() && reached;
        course.last = moment(&real, flow.time(), [x, v], stuck);
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

impl Course {
    /// Whether both integrations met the same events (but for the impacts that one of them told
    /// apart before an accumulation and the other not, see [`align`]); nothing else can be compared.
    pub fn comparable(&self, finer: &Self) -> bool {
        let kinds = |c: &Self| -> Vec<EventKind> { c.events.iter().map(|e| e.kind).collect() };
        let sizes = |c: &Self| (c.samples.len(), c.points.len(), c.complete);
        kinds(self) == kinds(finer) && sizes(self) == sizes(finer)
    }

    /// The largest error, relative to the larger of the value and one, as log10.
    pub fn log10_error(&self, finer: &Self) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        let (own, other) = (self.numbers(), finer.numbers());
        for (a, b) in own.zip(other) {
            let size = Float::with_val(64, a.abs_ref()).max(&Float::with_val(64, 1));
            let error = Float::with_val(64, a - b).abs() / size;
            worst = worst.max(error.log10().to_f64());
        }
        worst
    }

    /// All numbers that are given, in order.
    fn numbers(&self) -> impl Iterator<Item = &Float> {
        let moments = [&self.last].into_iter().chain(&self.samples).chain(&self.points);
        let moments = moments.flat_map(|m| [&m.time].into_iter().chain(&m.state));
        let events = self.events.iter();
        let events = events.flat_map(|e| [&e.time].into_iter().chain(&e.before).chain(&e.after));
        moments.chain(events)
    }

    /// How many events there are of that name; hits without rebound are impacts.
    pub fn count(&self, name: &str) -> usize {
        let is = |e: &&Happening| match name {
            "impact" => e.is_impact(),
            _ => event_name(e.kind) == name,
        };
        self.events.iter().filter(is).count()
    }

    /// Impacts in sequence before each accumulation.
    fn runs(&self) -> Vec<usize> {
        let mut run = 0;
        let mut list = Vec::new();
        for event in &self.events {
            match event.kind {
                EventKind::Impact { .. } => run += 1,
                EventKind::Accumulation { .. } => list.push(std::mem::take(&mut run)),
                _ => run = 0,
            }
        }
        list
    }

    /// Leaves out the last impacts before every accumulation, but for so many.
    fn shorten(&mut self, common: &[usize]) {
        let mut accumulations = self.runs().into_iter().zip(common);
        let (mut events, mut points) = (Vec::new(), Vec::new());
        // Points of a section at impacts stand for these impacts, in order.
        let at_impacts = self.points_at_impacts;
        let mut old_points = std::mem::take(&mut self.points).into_iter();
        let mut run: Vec<(Happening, Option<Moment>)> = Vec::new();
        for event in std::mem::take(&mut self.events) {
            if matches!(event.kind, EventKind::Impact { .. }) {
                run.push((event, if at_impacts { old_points.next() } else { None }));
                continue;
            }
            if matches!(event.kind, EventKind::Accumulation { .. })
                && let Some((own, common)) = accumulations.next()
            {
                run.truncate(run.len() - (own - common).min(run.len()));
            }
            for (event, point) in run.drain(..) {
                events.push(event);
                points.extend(point);
            }
            if at_impacts && event.is_impact() {
                points.extend(old_points.next());
            }
            events.push(event);
        }
        for (event, point) in run {
            events.push(event);
            points.extend(point);
        }
        points.extend(old_points);
        (self.events, self.points) = (events, points);
    }
}

/// Leaves out the impacts before an accumulation that only one of two integrations told apart:
/// with fewer digits the sequence is known to be geometric, and jumped over, earlier.
pub(super) fn align(a: &mut Course, b: &mut Course) {
    let common: Vec<usize> = a.runs().iter().zip(b.runs()).map(|(m, n)| (*m).min(n)).collect();
    a.shorten(&common);
    b.shorten(&common);
}

fn moment<R: Real>(real: &R, time: &R::Element, [x, v]: [&R::Element; 2], stuck: bool) -> Moment {
    Moment { time: real.to_float(time), state: [real.to_float(x), real.to_float(v)], stuck }
}

/// Collects what is reported.
struct Keeper<'p, R: Real> {
    plan: &'p Plan,
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
    fn new(plan: &'p Plan, real: &R, bits: u32, start: &[R::Element; 2]) -> Self {
        let forcing = plan.setup.forcing.as_ref();
        let strobe = forcing.filter(|_| plan.section == Some(Section::Stroboscopic));
        let course = Course {
            events: Vec::new(),
            samples: Vec::new(),
            points: Vec::new(),
            last: moment(real, &real.zero(), start.each_ref(), false),
            work: Work::default(),
            stuck_time: Float::new(real.bits()),
            line: Vec::new(),
            complete: false,
            points_at_impacts: plan.section == Some(Section::Impact),
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
                let pair = |states: &[R::Element]| match states {
                    [x, v, ..] => [self.real.to_float(x), self.real.to_float(v)],
                    _ => [Float::new(2), Float::new(2)],
                };
                let (before, after) = (pair(event.before), pair(event.after));
                let time = self.real.to_float(event.time);
                self.event(Happening { kind: event.kind, time, before, after });
            }
        }
        self.ended.is_some()
    }

    fn event(&mut self, event: Happening) {
        let (section, end) = (self.plan.section, &self.plan.end);
        let maximum = matches!(event.kind, EventKind::Section { rising: false, .. });
        let impact = event.is_impact();
        let at = |state: &[Float; 2]| {
            let (time, state) = (event.time.clone(), state.clone());
            Moment { time, state, stuck: false }
        };
        if (maximum && section == Some(Section::Velocity))
            || (impact && section == Some(Section::Impact))
        {
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
            EventKind::Switching { .. } => !self.plan.setup.sticks,
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
        let end = real.sum(segment.start, segment.length);
        let at = |time: &R::Element| {
            let mut s = real.difference(time, segment.start);
            if real.sign(&s) < 0 {
                // During an accumulation of impacts, which is jumped over.
                s = real.zero();
            }
            moment(&real, time, [&segment.value(0, &s), &segment.value(1, &s)], stuck)
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
    fn rest(&mut self, time: &R::Element, state: [&R::Element; 2], stuck: bool) {
        let real = self.real.clone();
        while let Some(t) = self.times.get(self.course.samples.len()).filter(|t| *t <= time) {
            self.course.samples.push(moment(&real, t, state, stuck));
        }
        while let Some(t) = self.strobe_time().filter(|t| t <= time) {
            self.course.points.push(moment(&real, &t, state, stuck));
        }
    }
}
