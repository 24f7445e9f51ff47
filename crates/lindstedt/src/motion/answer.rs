//! The answer: a motion with the estimated errors of its numbers.

use super::growth::{self, shifts};
use super::plan::Plan;
use super::setup::Setup;
use super::{Section, View, difference};
use crate::{Exact, Number, Work};
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{Course, Dot, End, EventKind, Moment, Occurrence, Quantity};
use rug::Float;
use serde::{Serialize, Serializer};
use std::fmt::Write;

/// The motion and the same with eight digits more; nothing in doubles that met other events or have
/// not one digit.
pub(super) struct Pair {
    pub course: Course,
    pub finer: Option<Course>,
    /// The work was stopped before more was known.
    pub stopped: bool,
}

/// A state at a time.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct State {
    /// t.
    pub t: Number,
    /// x.
    pub x: Number,
    /// x'.
    pub v: Number,
    /// The same of further unknowns.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<[Number; 2]>,
    /// Sticking, or at rest at the wall.
    pub sticking: bool,
    /// t, x, x' in doubles.
    #[serde(skip)]
    pub place: [f64; 3],
}

/// An event.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Event {
    /// `impact`, `accumulation`, `rest`, `departure`, `stick`, `slip`, `switch`.
    pub kind: &'static str,
    /// When.
    pub t: Number,
    /// x.
    pub x: Number,
    /// x' before.
    pub v_before: Number,
    /// x' after.
    pub v_after: Number,
    /// t, x, x' before and x' after, in doubles.
    #[serde(skip)]
    pub place: [f64; 4],
}

/// The points of a section.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Points {
    /// Which.
    pub kind: Section,
    /// t, x, x'; at impacts the state just before.
    #[serde(serialize_with = "places")]
    pub points: Vec<State>,
    /// The points are estimated.
    pub status: crate::Status,
}

fn places<S: Serializer>(points: &[State], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|state| state.place))
}

/// What was started from.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Begin {
    /// x(0): as it was given, else a few digits.
    pub x: String,
    /// x'(0).
    pub v: String,
    /// The names of several unknowns.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unknowns: Vec<String>,
    /// The same of further unknowns.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<[String; 2]>,
    /// How it was chosen, where it was not given.
    pub chosen: Option<&'static str>,
}

impl Begin {
    pub(super) fn new(setup: &Setup) -> Self {
        let [x, v] = setup.flow.start.each_ref().map(shown);
        let pairs = setup.flow.others.chunks_exact(2);
        let others = pairs.map(|pair| [0, 1].map(|k| shown(&pair[k]))).collect();
        Self { x, v, unknowns: setup.unknowns.clone(), others, chosen: setup.chosen }
    }
}

/// Infinitely many impacts in a finite time.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Rest {
    /// Where they accumulate.
    pub t: Number,
    /// `rest`, at the wall.
    pub then: &'static str,
}

/// How far deviations from the periodic orbit tell of its stability.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct LinearRegime {
    /// Impacts at which they are linear in the perturbation, and no rounding errors.
    pub impacts: usize,
    /// Whether they grow; nothing where it cannot be told.
    pub grows: Option<bool>,
}

/// What the integration cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Steps {
    /// Steps taken.
    pub steps: u64,
    /// Steps tried in vain.
    pub rejected: u64,
    /// Impacts.
    pub impacts: u64,
}

/// The result of [`Oscillator::motion`](crate::Oscillator::motion).
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Motion {
    /// The digits asked for.
    pub digits: u32,
    /// The start.
    pub start: Begin,
    /// The motion before the start, in words, where there is a delay.
    pub history: Option<&'static str>,
    /// The events, in order.
    pub events: Vec<Event>,
    /// The states at the times asked for.
    pub samples: Vec<State>,
    /// The state at the end.
    #[serde(rename = "final")]
    pub last: State,
    /// The points of the section asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub section: Option<Points>,
    /// Ratios of the deviations of consecutive impact times from those of the periodic orbit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<Vec<Number>>,
    /// What they tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear_regime: Option<LinearRegime>,
    /// Accumulations of impacts.
    pub chattering: Vec<Rest>,
    /// The time spent sticking or at rest at the wall.
    pub sticking_time: Number,
    /// The cost of the integration.
    pub work: Steps,
    /// How errors are estimated.
    pub estimate: &'static str,
    /// Whether the end was reached.
    pub complete: bool,
    /// In words.
    pub verdict: String,
    /// The line of a figure, where one was asked for.
    #[serde(skip)]
    pub line: Vec<Dot>,
    /// What a figure shows.
    #[serde(skip)]
    pub view: View,
}

/// Numbers out of two integrations.
struct Numbers {
    digits: usize,
    /// Whether there is a second one to compare with.
    known: bool,
}

impl Numbers {
    fn number(&self, value: &Float, finer: &Float) -> Number {
        let number = if self.known {
            Number::with_error(value, &difference(value, finer), self.digits)
        } else {
            let balls = Balls::new(value.prec().max(64));
            let ball = balls.from_parts(value, &Float::new(53));
            Number::without_estimate(&ball, self.digits)
        };
        number.unwrap_or_else(|| Number::double(value.to_f64()))
    }

    fn state(&self, (a, b): (&Moment, &Moment)) -> State {
        let ([x, v], [finer_x, finer_v]) = (&a.state, &b.state);
        let others = a.others.chunks_exact(2).zip(b.others.chunks_exact(2));
        State {
            t: self.number(&a.time, &b.time),
            x: self.number(x, finer_x),
            v: self.number(v, finer_v),
            others: others.map(|(a, b)| [0, 1].map(|k| self.number(&a[k], &b[k]))).collect(),
            sticking: a.stuck,
            place: [a.time.to_f64(), x.to_f64(), v.to_f64()],
        }
    }

    fn states(&self, a: &[Moment], b: &[Moment]) -> Vec<State> {
        a.iter().zip(b).map(|pair| self.state(pair)).collect()
    }

    fn event(&self, (a, b): (&Occurrence, &Occurrence)) -> Event {
        let place = [&a.time, &a.after[0], &a.before[1], &a.after[1]];
        Event {
            kind: a.kind.name(),
            t: self.number(&a.time, &b.time),
            x: self.number(&a.after[0], &b.after[0]),
            v_before: self.number(&a.before[1], &b.before[1]),
            v_after: self.number(&a.after[1], &b.after[1]),
            place: place.map(Float::to_f64),
        }
    }
}

/// A value as it was given, or a few digits of it.
pub fn shown(q: &Quantity) -> String {
    match q {
        Quantity::Exact(Exact::Rational(q)) => {
            // A decimal number, where it is a short one.
            let short = Float::with_val(53, q).to_f64().to_string();
            let same = Exact::parse(&short).is_ok_and(|x| x.as_rational() == Some(q));
            if same { short } else { q.to_string() }
        }
        Quantity::Exact(x) => x.to_string(),
        other => other.float(53).to_f64().to_string(),
    }
}

impl Motion {
    /// The answer out of what was integrated; `half` are the deviations of the impact times with
    /// half the perturbation: what is linear is half as large.
    pub(super) fn new(plan: Plan, pair: Pair, half: Option<Vec<Float>>, work: &Work) -> Self {
        let Pair { course, finer, .. } = &pair;
        let numbers = Numbers { digits: work.printed_digits(), known: finer.is_some() };
        let finer = finer.as_ref().unwrap_or(course);
        let perturbed = plan.perturbed();
        let (all, fine) = (shifts(&plan, course), shifts(&plan, finer));
        let impacts = half.map_or(0, |half| growth::linear(&all, &half, &fine));
        let grows = growth::grows(all.get(..impacts).unwrap_or_default());
        let ratios = |list: &[Float]| -> Vec<Float> {
            list.windows(2).map(|w| Float::with_val(w[0].prec(), &w[1] / &w[0])).collect()
        };
        let (ratio, fine_ratio) = (ratios(&all), ratios(&fine));
        let ratio = ratio.iter().zip(&fine_ratio).map(|(a, b)| numbers.number(a, b));
        let events = || course.events.iter().zip(&finer.events);
        let endless = events().filter(|(a, _)| matches!(a.kind, EventKind::Accumulation { .. }));
        let start = Begin::new(&plan.setup);
        let points = || Points {
            kind: plan.section.unwrap_or(Section::Velocity),
            points: numbers.states(&course.points, &finer.points),
            status: crate::Status::Estimated,
        };
        Self {
            digits: u32::try_from(work.printed_digits()).unwrap_or(u32::MAX),
            start,
            history: plan.setup.history,
            events: events().map(|pair| numbers.event(pair)).collect(),
            samples: numbers.states(&course.samples, &finer.samples),
            last: numbers.state((&course.last, &finer.last)),
            section: plan.section.map(|_| points()),
            growth: perturbed.then(|| ratio.collect()),
            linear_regime: perturbed.then_some(LinearRegime { impacts, grows }),
            chattering: endless
                .map(|(a, b)| Rest { t: numbers.number(&a.time, &b.time), then: "rest" })
                .collect(),
            sticking_time: numbers.number(&course.stuck_time, &finer.stuck_time),
            work: Steps {
                steps: course.work.steps,
                rejected: course.work.rejected,
                impacts: course.work.impacts,
            },
            estimate: "difference to an integration with 8 digits more",
            complete: course.complete,
            verdict: verdict(&plan, &pair, perturbed.then_some((&all, impacts))),
            line: pair.course.line,
            view: plan.view,
        }
    }
}

/// In words; the deviations of a perturbed motion, and how many of them are linear.
fn verdict(plan: &Plan, pair: &Pair, shifts: Option<(&Vec<Float>, usize)>) -> String {
    let course = &pair.course;
    let time = course.last.time.to_f64();
    let mut text = String::new();
    if pair.finer.is_none() && pair.stopped {
        text += "without a second integration nothing is known of the errors; ";
    } else if pair.finer.is_none() {
        text += "no digit is left in doubles, a motion with more digits goes elsewhere (chaos, or an \
                 unstable motion); a picture; ";
    }
    text += &if course.complete {
        format!("reached t = {time:.6}")
    } else if let Some(reason) = &plan.cut {
        format!("{reason}; shown up to t = {time:.6}")
    } else {
        format!("the events that end the motion did not come before t = {time:.6}")
    };
    for what in ["impact", "accumulation", "stick"] {
        match course.count(what) {
            0 => {}
            1 => text += &format!(", 1 {what}"),
            n => text += &format!(", {n} {what}s"),
        }
    }
    let endless = course.events.iter().filter(|e| matches!(e.kind, EventKind::Accumulation { .. }));
    let endless: Vec<String> = endless.map(|e| format!("{:.6}", e.time.to_f64())).collect();
    if let Some((first, others)) = endless.split_first() {
        let more = match others.len() {
            0 => String::new(),
            n => format!(" and {n} later times"),
        };
        let _ = write!(
            text,
            "; chattering: infinitely many impacts up to t = {first}{more}, then at rest at the wall"
        );
        if matches!(plan.end, End::Impacts(_)) {
            text += "; the last impact asked for is among them";
        }
    }
    if let Some((shifts, linear)) = shifts {
        let _ = write!(text, "; {}", growth::verdict(shifts, linear));
    }
    if pair.finer.is_none() && !pair.stopped {
        text += "; for digits: without --f64, a shorter time; for a picture enough, for numbers \
                 --lyapunov or --zero-one";
    }
    text
}
