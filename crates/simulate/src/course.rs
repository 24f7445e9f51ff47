//! What happens on the way from a start to an end: events, samples, the points of a section; two
//! integrations of one motion compared.

use crate::quantity::Quantity;
use crate::report::{EventKind, Work};
use rug::Float;

/// Where a course ends.
#[derive(Clone, Debug)]
pub enum End {
    /// At this time.
    Time(Quantity),
    /// The N-th maximum of x.
    Maxima(u32),
    /// The N-th impact.
    Impacts(u32),
}

/// A state at a time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// t.
    pub time: Float,
    /// x, x'.
    pub state: [Float; 2],
    /// The same of further unknowns, one after the other.
    pub others: Vec<Float>,
    /// Sticking, or resting at the wall.
    pub stuck: bool,
}

/// An event on the way.
#[derive(Clone, Debug)]
pub struct Occurrence {
    /// What.
    pub kind: EventKind,
    /// When.
    pub time: Float,
    /// x, x' before.
    pub before: [Float; 2],
    /// x, x' after.
    pub after: [Float; 2],
}

impl Occurrence {
    /// An impact, or a hit without rebound.
    #[must_use]
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
#[derive(Clone, Debug)]
pub struct Course {
    /// The events, but for those of sections and for switches that nothing comes of.
    pub events: Vec<Occurrence>,
    /// The states at the times asked for.
    pub samples: Vec<Moment>,
    /// The points of the section; at impacts the state just before.
    pub points: Vec<Moment>,
    /// The state at the end.
    pub last: Moment,
    /// The cost.
    pub work: Work,
    /// The time spent sticking or at rest at the wall.
    pub stuck_time: Float,
    /// The line of a figure, where one is kept.
    pub line: Vec<Dot>,
    /// The end was reached.
    pub complete: bool,
    /// The points are those of a section at impacts.
    pub(crate) points_at_impacts: bool,
}

impl Course {
    /// Whether both integrations met the same events (but for the impacts that one of them told
    /// apart before an accumulation and the other not, see [`align`]); nothing else can be compared.
    #[must_use]
    pub fn comparable(&self, finer: &Self) -> bool {
        let kinds = |c: &Self| -> Vec<EventKind> { c.events.iter().map(|e| e.kind).collect() };
        let sizes = |c: &Self| (c.samples.len(), c.points.len(), c.complete);
        kinds(self) == kinds(finer) && sizes(self) == sizes(finer)
    }

    /// The largest error, relative to the larger of the value and one, as log10.
    #[must_use]
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
        let moments = moments.flat_map(|m| [&m.time].into_iter().chain(&m.state).chain(&m.others));
        let events = self.events.iter();
        let events = events.flat_map(|e| [&e.time].into_iter().chain(&e.before).chain(&e.after));
        moments.chain(events)
    }

    /// How many events there are of that name; hits without rebound are impacts.
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        let is = |e: &&Occurrence| match name {
            "impact" => e.is_impact(),
            _ => e.kind.name() == name,
        };
        self.events.iter().filter(is).count()
    }

    /// The latest moment of so many events, samples and points, if it is after the start.
    fn latest(&self, [events, samples, points]: [usize; 3]) -> Option<Moment> {
        let after = |event: &Occurrence| {
            let (time, state) = (event.time.clone(), event.after.clone());
            Moment { time, state, others: Vec::new(), stuck: false }
        };
        // Of an event the states of further unknowns are not kept.
        let alone = self.last.others.is_empty();
        let event = self.events.get(..events).and_then(<[_]>::last).filter(|_| alone).map(after);
        let last = |list: &[Moment], count: usize| list.get(..count)?.last().cloned();
        let kept = [last(&self.samples, samples), last(&self.points, points), event];
        let latest = kept.into_iter().flatten().max_by(|a, b| a.time.total_cmp(&b.time));
        latest.filter(|moment| moment.time > 0)
    }

    /// Impacts in sequence before each accumulation, whatever switches between them.
    fn runs(&self) -> Vec<usize> {
        let mut run = 0;
        let mut list = Vec::new();
        for event in &self.events {
            match event.kind {
                EventKind::Impact { .. } => run += 1,
                EventKind::Switching { .. } => {}
                EventKind::Accumulation { .. } => list.push(std::mem::take(&mut run)),
                _ => run = 0,
            }
        }
        list
    }

    /// Leaves out what lies between the last of so many impacts and every accumulation; nothing where there is no number.
    fn shorten(&mut self, common: &[Option<usize>]) {
        let mut common = common.iter();
        let (mut events, mut points) = (Vec::new(), Vec::new());
        // Points of a section at impacts stand for these impacts, in order.
        let at_impacts = self.points_at_impacts;
        let mut old_points = std::mem::take(&mut self.points).into_iter();
        let mut run: Vec<(Occurrence, Option<Moment>)> = Vec::new();
        let mut left_out: Vec<(Option<Float>, Float)> = Vec::new();
        for event in std::mem::take(&mut self.events) {
            let point = if at_impacts && event.is_impact() { old_points.next() } else { None };
            if matches!(event.kind, EventKind::Impact { .. } | EventKind::Switching { .. }) {
                run.push((event, point));
                continue;
            }
            if matches!(event.kind, EventKind::Accumulation { .. })
                && let Some(Some(most)) = common.next()
            {
                let impacts = run.iter().enumerate().filter(|(_, (event, _))| event.is_impact());
                let end = impacts.map(|(k, _)| k + 1).take(*most).last().unwrap_or(0);
                run.truncate(end);
                let last = run.last().map(|(last, _)| last).or(events.last());
                left_out.push((last.map(|last| last.time.clone()), event.time.clone()));
            }
            for (event, point) in run.drain(..).chain([(event, point)]) {
                events.push(event);
                points.extend(point);
            }
        }
        for (event, point) in run {
            events.push(event);
            points.extend(point);
        }
        let between = |point: &Moment| {
            let after = |from: &Option<Float>| from.as_ref().is_none_or(|from| point.time > *from);
            left_out.iter().any(|(from, to)| after(from) && point.time < *to)
        };
        points.extend(old_points.filter(|point| at_impacts || !between(point)));
        (self.events, self.points) = (events, points);
    }
}

/// Leaves out the impacts before an accumulation that only one of two integrations told apart:
/// with fewer digits the sequence is known to be geometric, and jumped over, earlier.
pub fn align(a: &mut Course, b: &mut Course) {
    let pairs = a.runs().into_iter().zip(b.runs());
    let common: Vec<_> = pairs.map(|(m, n)| (m != n).then_some(m.min(n))).collect();
    a.shorten(&common);
    b.shorten(&common);
}

/// Cuts two integrations of one motion that were broken off to what both came to: the same events, samples and points,
/// up to the last of them. Whether there is any; not where the body stuck, for how long up to there is not known.
pub fn cut(a: &mut Course, b: &mut Course) -> bool {
    let stuck = |course: &Course| !course.stuck_time.is_zero();
    if stuck(a) || stuck(b) {
        return false;
    }
    let same = a.events.iter().zip(&b.events).take_while(|(x, y)| x.kind == y.kind).count();
    let (samples, points) =
        (a.samples.len().min(b.samples.len()), a.points.len().min(b.points.len()));
    let latest = |course: &Course| course.latest([same, samples, points]);
    let [Some(first), Some(second)] = [latest(a), latest(b)] else { return false };
    for course in [&mut *a, &mut *b] {
        course.events.truncate(same);
        course.samples.truncate(samples);
        course.points.truncate(points);
        course.complete = false;
    }
    let (one, other) = (first.time.to_f64(), second.time.to_f64());
    (a.last, b.last) = (first, second);
    a.line.retain(|dot| dot.time <= one);
    b.line.retain(|dot| dot.time <= other);
    true
}
