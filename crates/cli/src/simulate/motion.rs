//! The motion, integrated twice: the difference estimates the errors.

use super::setup::Setup;
use crate::arguments::Section;
use lindstedt::equation::Expression;
use lindstedt::simulate::{
    Digits, Doubles, EventKind, Integrator, Outcome, Quantity, Real, Report, Segment, Settings,
    SimulateError, Work,
};
use rug::Float;
use std::ops::ControlFlow;

/// Points of a figure per step.
const DOTS: u32 = 24;
/// Impacts after which a motion is given up.
const MOST_IMPACTS: u64 = 1_000_000;

/// Where a motion ends.
#[derive(Clone)]
pub enum End {
    Time(Quantity),
    /// The N-th maximum of x.
    Maxima(u32),
    Impacts(u32),
}

/// What to integrate.
pub struct Plan {
    pub setup: Setup,
    pub end: End,
    /// Times of the samples, in order.
    pub times: Vec<Quantity>,
    pub section: Option<Section>,
    /// Points of the section left out at the beginning.
    pub skip: usize,
    /// Whether the line of a figure is kept.
    pub drawn: bool,
    /// Why the motion ends before it should.
    pub cut: Option<String>,
}

/// A state at a time.
#[derive(Clone)]
pub struct Moment {
    pub time: Float,
    pub state: [Float; 2],
    /// Sticking, or resting at the wall.
    pub stuck: bool,
}

/// An event.
pub struct Happening {
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

/// A point of a figure.
#[derive(Clone, Copy)]
pub struct Dot {
    pub time: f64,
    pub x: f64,
    pub v: f64,
    pub stuck: bool,
}

/// What came of it.
pub struct Motion {
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
    fn watches_velocity(&self) -> bool {
        self.section == Some(Section::Velocity) || matches!(self.end, End::Maxima(_))
    }

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
        let long = |n: u32| Quantity::Float(Float::with_val(64, 100.0 * unit * f64::from(n + 1)));
        match &self.end {
            End::Time(time) => time.clone(),
            End::Maxima(n) | End::Impacts(n) => long(*n),
        }
    }

    /// x'(0) on the periodic impact orbit that the motion starts beside.
    fn on_orbit(&self) -> Option<Float> {
        let (_, velocity) = self.setup.orbit.as_ref()?;
        let restitution = self.setup.parameters.get("R_r")?.float(velocity.prec());
        Some(-(restitution * velocity))
    }

    /// Whether the motion starts beside the periodic impact orbit.
    pub fn perturbed(&self) -> bool {
        let (Some(orbit), Some((_, velocity))) = (self.on_orbit(), &self.setup.orbit) else {
            return false;
        };
        let perturbation = self.setup.start[1].float(orbit.prec()) - orbit;
        perturbation.abs() > Float::with_val(53, velocity) * 1e-25f64
    }

    /// The same with half the perturbation, in the digits of [`Self::run`].
    pub fn run_half(
        &mut self,
        digits: u32,
        doubles: bool,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Motion> {
        let orbit = self.on_orbit()?;
        let start = self.setup.start[1].float(orbit.prec());
        let half = Quantity::Float((start + orbit) / 2u32);
        let whole = std::mem::replace(&mut self.setup.start[1], half);
        let motion = self.run(digits, doubles, goes_on);
        self.setup.start[1] = whole;
        motion.ok()
    }

    /// Integrates with so many digits, in doubles if `doubles`.
    pub fn run(
        &self,
        digits: u32,
        doubles: bool,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Motion, SimulateError> {
        if doubles {
            self.integrate(Doubles, 16, goes_on)
        } else {
            self.integrate(Digits::for_digits(digits), digits, goes_on)
        }
    }

    fn integrate<R: Real>(
        &self,
        real: R,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Motion, SimulateError> {
        let mut model = self.setup.model.clone();
        if self.watches_velocity() {
            model = model.with_section(Expression::VELOCITY);
        }
        let system = model.compile(real.clone(), &self.setup.parameters)?;
        let bits = real.bits() + 64;
        let element = |q: &Quantity| real.float(&q.float(bits));
        let start = self.setup.start.each_ref().map(element);
        let settings = Settings { most_impacts: MOST_IMPACTS, ..Settings::for_digits(digits) };
        let mut flow = Integrator::new(&system, &real.zero(), &start, settings)?;
        let strobe = (self.section == Some(Section::Stroboscopic))
            .then(|| self.setup.forcing.as_ref().map(|q| q.float(bits)))
            .flatten();
        let mut keeper = Keeper {
            plan: self,
            times: self.times.iter().map(element).collect(),
            strobe,
            bits,
            count: 0,
            ended: None,
            motion: Motion {
                events: Vec::new(),
                samples: Vec::new(),
                points: Vec::new(),
                last: moment(&real, &real.zero(), start.each_ref(), false),
                work: Work::default(),
                stuck_time: Float::new(real.bits()),
                line: Vec::new(),
                complete: false,
                points_at_impacts: self.section == Some(Section::Impact),
            },
            real: real.clone(),
        };
        let mut stopped = false;
        let target = element(&self.target());
        let outcome = flow.advance(&target, &mut |report| {
            stopped |= !goes_on();
            if stopped || keeper.keep(report) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        let stuck = flow.contact().is_some() || flow.modes().contains(&0);
        let [x, v, ..] = flow.state() else { return Ok(keeper.motion) };
        keeper.rest(flow.time(), [x, v], stuck);
        let (mut motion, ended) = (keeper.motion, keeper.ended);
        motion.complete = !stopped
            && self.cut.is_none()
            && match self.end {
                End::Time(_) => outcome == Outcome::Reached,
                _ => ended.is_some(),
            };
        motion.last = moment(&real, flow.time(), [x, v], stuck);
        if let Some(last) = ended {
            let end = last.time.to_f64();
            motion.line.retain(|dot| dot.time <= end);
            motion.samples.retain(|sample| sample.time <= last.time);
            motion.points.retain(|point| point.time <= last.time);
            motion.last = last;
        }
        motion.work = flow.work();
        Ok(motion)
    }
}

/// Leaves out the impacts before an accumulation that only one of two integrations told apart:
/// with fewer digits the sequence is known to be geometric, and jumped over, earlier.
pub fn align(a: &mut Motion, b: &mut Motion) {
    let runs = |motion: &Motion| -> Vec<usize> {
        let mut run = 0;
        let mut list = Vec::new();
        for event in &motion.events {
            match event.kind {
                EventKind::Impact { .. } => run += 1,
                EventKind::Accumulation { .. } => list.push(std::mem::take(&mut run)),
                _ => run = 0,
            }
        }
        list
    };
    let common: Vec<usize> = runs(a).iter().zip(runs(b)).map(|(m, n)| (*m).min(n)).collect();
    for motion in [a, b] {
        let mut accumulations = runs(motion).into_iter().zip(&common);
        let (mut events, mut points) = (Vec::new(), Vec::new());
        // Points of a section at impacts stand for these impacts, in order.
        let at_impacts = motion.points_at_impacts;
        let mut old_points = std::mem::take(&mut motion.points).into_iter();
        let mut run: Vec<(Happening, Option<Moment>)> = Vec::new();
        for event in std::mem::take(&mut motion.events) {
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
        (motion.events, motion.points) = (events, points);
    }
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
    motion: Motion,
}

impl<R: Real> Keeper<'_, R> {
    /// Keeps a report; whether the end is reached.
    fn keep(&mut self, report: &Report<'_, R>) -> bool {
        match report {
            Report::Segment(segment) => {
                self.segment(segment);
                false
            }
            Report::Busy => false,
            Report::Event(_) if self.ended.is_some() => true,
            Report::Event(event) => {
                let pair = |states: &[R::Element]| match states {
                    [x, v, ..] => [self.real.to_float(x), self.real.to_float(v)],
                    _ => [Float::new(2), Float::new(2)],
                };
                let (before, after) = (pair(event.before), pair(event.after));
                let time = self.real.to_float(event.time);
                let (section, end) = (self.plan.section, &self.plan.end);
                let here = Moment { time: time.clone(), state: after.clone(), stuck: false };
                let maximum = matches!(event.kind, EventKind::Section { rising: false, .. });
                let happening = Happening { kind: event.kind, time, before, after };
                let impact = happening.is_impact();
                if (maximum && section == Some(Section::Velocity))
                    || (impact && section == Some(Section::Impact))
                {
                    let (time, state) = (happening.time.clone(), happening.before.clone());
                    let point = Moment { time, state, stuck: false };
                    self.motion.points.push(point);
                }
                // Where a fractional power passes zero nothing happens that could be told in time:
                // the integrator leaps over the branch point.
                let silent = match event.kind {
                    EventKind::Section { .. } => true,
                    EventKind::Switching { .. } => !self.plan.setup.sticks,
                    _ => false,
                };
                if !silent {
                    self.motion.events.push(happening);
                }
                let (counts, most) = match end {
                    End::Time(_) => (false, u32::MAX),
                    End::Maxima(n) => (maximum, *n),
                    End::Impacts(n) => (impact, *n),
                };
                self.count += u32::from(counts);
                // Infinitely many impacts: the one that is to end the motion is among them.
                let all = matches!(event.kind, EventKind::Accumulation { .. })
                    && matches!(end, End::Impacts(_));
                if all || counts && self.count >= most {
                    self.ended = Some(here);
                }
                self.ended.is_some()
            }
        }
    }

    fn strobe_time(&self) -> Option<R::Element> {
        let n = u32::try_from(self.motion.points.len()).ok()?.checked_add(1)?;
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
            let (x, v) = (segment.value(0, &s), segment.value(1, &s));
            moment(&real, time, [&x, &v], stuck)
        };
        while let Some(time) = self.times.get(self.motion.samples.len()).filter(|t| **t < end) {
            let sample = at(time);
            self.motion.samples.push(sample);
        }
        while let Some(time) = self.strobe_time().filter(|t| *t < end) {
            let point = at(&time);
            self.motion.points.push(point);
        }
        if stuck {
            self.motion.stuck_time += real.to_float(segment.length);
        }
        if self.plan.drawn {
            let start = real.to_f64(segment.start);
            for k in 0..=DOTS {
                let part = real.double(f64::from(k) / f64::from(DOTS));
                let s = real.product(segment.length, &part);
                let value = |state| real.to_f64(&segment.value(state, &s));
                let time = start + real.to_f64(&s);
                self.motion.line.push(Dot { time, x: value(0), v: value(1), stuck });
            }
        }
    }

    /// What falls on the end itself.
    fn rest(&mut self, time: &R::Element, state: [&R::Element; 2], stuck: bool) {
        let real = self.real.clone();
        while let Some(t) = self.times.get(self.motion.samples.len()).filter(|t| *t <= time) {
            let sample = moment(&real, t, state, stuck);
            self.motion.samples.push(sample);
        }
        while let Some(t) = self.strobe_time().filter(|t| t <= time) {
            let point = moment(&real, &t, state, stuck);
            self.motion.points.push(point);
        }
    }
}
