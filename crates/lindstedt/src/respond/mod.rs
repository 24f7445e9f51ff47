//! The question `respond`: steady states at resonance, response curves, folds, stability.

mod answer;
mod free;
mod frequency;
mod orbit;
mod refusals;
mod shown;
mod subject;
mod validity;

use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Oscillator, Remark, Standing, Stop, Work};
pub use answer::{
    Branch, Change, Corner, Curve, Destination, Estimate, Point, Reading, Response, State, States,
};
use lindstedt_orbit::steady::{self, Course, Fate, Plane, Survey, Value, settle};
pub(crate) use orbit::Beside;
use std::time::Instant;
use subject::Subject;

/// What to look for.
///
/// ```
/// use lindstedt::{Oscillator, Respond, Work};
/// let forced = Oscillator::parse("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2")?;
/// let forced = forced.set("eps", "1/10")?.set("sigma", "1")?;
/// let question = Respond { order: Some(2), ..Respond::default() };
/// assert_eq!(forced.respond(&question, &Work::default())?.value.states[0].count, 3);
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Respond {
    /// The orders of the slow flow; 2 if nothing.
    pub order: Option<usize>,
    /// The parameter that varies: its range, and with how many steps at least a branch goes through it; nothing for the
    /// states at the values set.
    pub sweep: Option<Axis>,
    /// A second one: curves of folds and Hopf points, cusps and Bogdanov-Takens points in the plane of the two.
    pub second: Option<Axis>,
    /// The largest amplitude that is looked at; if nothing, 5/4 of a bound of the steady states of the slow flow of the lowest order in
    /// which the force acts and that bounds them, or, where the states in it are not decided, one within which every order adds less
    /// than the order before.
    pub amplitude: Option<Exact>,
    /// With a sweep: also the equation itself, integrated along the values upwards and downwards, each from the end of the
    /// one before.
    pub follow: bool,
    /// x and x' of every unknown at t = 0: where does the motion go?
    pub start: Option<Vec<[Exact; 2]>>,
}

impl Respond {
    /// Reads `NAME=LO..HI[:COUNT]` or `NAME=V1,V2,...`; without a count 200 steps.
    ///
    /// # Errors
    /// Those of [`Axis::parse_until`]; [`Refused`] for what a file calls fixed.
    pub fn read_sweep(oscillator: &Oscillator, text: &str, stop: &Stop) -> Result<Axis, Error> {
        let counted = text.rsplit_once("..").is_none_or(|(_, rest)| rest.contains(':'));
        let steps = if counted { String::new() } else { format!(":{STEPS}") };
        oscillator.axis_until(&format!("{text}{steps}"), stop)
    }

    /// Reads `X,V`, of several unknowns one pair after the other.
    ///
    /// # Errors
    /// [`Refused`] with the form that is expected, [`DerivationError::BadValue`](crate::DerivationError::BadValue).
    pub fn read_start(text: &str) -> Result<Vec<[Exact; 2]>, Error> {
        let parts: Vec<&str> = text.split(',').collect();
        let (pairs, []) = parts.as_chunks::<2>() else { return Err(bad_start(1)) };
        pairs.iter().map(|[x, velocity]| Ok([Exact::parse(x)?, Exact::parse(velocity)?])).collect()
    }
}

fn bad_start(unknowns: usize) -> Error {
    let message = "a start state is X,V of every unknown";
    Refused::usage("start", message, format!("--start 1/2,0{}", ",0,0".repeat(unknowns - 1))).into()
}

/// Steps through a range of which no number is given.
const STEPS: usize = 201;
/// Orders of the slow flow.
const ORDER: usize = 2;
/// Searches along a sweep, for one unknown and for several.
const SEARCHES: [usize; 2] = [9, 3];
/// Steps through a range, however few values are listed.
const LEAST_STEPS: usize = 60;
/// Points of one branch at most.
const MOST_POINTS: usize = 100_000;
/// Values at which the equation is integrated along a sweep.
const MOST_FOLLOWED: usize = 101;
/// A start state is followed at least so many times as long as the slowest motion beside a state takes to fall by a factor e.
const DECAY: f64 = 40.0;

impl Oscillator {
    /// The steady states of the slow flow at resonance, which are the periodic responses: with a `sweep` the branches
    /// over it with their folds and Hopf points, else all states at the values set.
    ///
    /// With x_j = a_j cos(k_j eta + phi_j) + ..., eta the phase of the force, a and phi are accurate to
    /// O(eps^N) for N orders. The number of states is *proved* for the truncated slow flow within the box of amplitudes that
    /// is said; where that failed, the states found stand in the answer and it is undecided. Amplitudes and phases of single
    /// states are enclosed ([`Status::Proved`](crate::Status::Proved)), those along branches and all exponents are
    /// estimated in doubles. A closed branch is found where it reaches over one of the values searched; for one unknown its folds are looked
    /// for themselves, and what could be missing is remarked. Cost: the slow flow; a
    /// search with proof per value, milliseconds for one unknown, seconds for two; microseconds per point.
    ///
    /// Without a force two unknowns that a resonance ties together lock: their motions are counted in the same way, in frames
    /// that turn with a frequency of their own. Where an energy is conserved these are the normal modes, families over
    /// `amplitude`, which is that of the first unknown moving alone with the same energy at order zero.
    ///
    /// # Errors
    /// [`Refused`] without a resonance, for walls and jumps, where no box is known; those of
    /// [`Oscillator::slow_flow`].
    ///
    /// ```
    /// use lindstedt::{Oscillator, Respond, Work};
    /// let forced = Oscillator::parse("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2")?;
    /// let forced = forced.set("eps", "1/10")?.set("sigma", "1")?;
    /// let answer = forced.respond(&Respond::default(), &Work::default())?;
    /// let states = &answer.value.states[0];
    /// assert_eq!((states.count, states.count_proved), (3, true));
    /// let stable = states.list.iter().filter(|state| state.stable == Some(true)).count();
    /// assert_eq!(stable, 2);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn respond(&self, question: &Respond, work: &Work) -> Result<Answer<Response>, Error> {
        let start = Instant::now();
        self.second_order()?;
        self.check_frequencies()?;
        let case = self.with_order_parameter();
        let subject = Subject::new(&case, question, work)?;
        subject.refuse_amplitude()?;
        let unforced = subject.rotating.unforced();
        let mut value = match (unforced, &question.sweep, &question.second) {
            (Some(free), ..) => subject.unforced(free, question)?,
            (None, None, _) => subject.states()?,
            (None, Some(axis), None) => subject.branches(axis)?,
            (None, Some(first), Some(second)) => subject.plane(first, second)?,
        };
        if let (Some(axis), None, true) = (&question.sweep, &question.second, question.follow) {
            value.followed = Some(subject.followed(axis, value.amplitude_limit.value)?);
        }
        if let Some(from) = &question.start {
            value.leads_to = Some(subject.destination(from, &value)?);
        }
        let mut remarks = self.remarks().to_vec();
        let undecided =
            value.states.iter().filter(|states| states.undecided + states.at_edge > 0).count();
        if undecided > 0 {
            let place = if value.parameter.is_some() { "at a value searched " } else { "" };
            let level = match unforced {
                Some(free) if free.energy.is_some() && !free.definite => {
                    ", or an unknown has no part in the conserved energy there"
                }
                _ => "",
            };
            let stopped = if work.stop.asked() { ", or the search was stopped" } else { "" };
            remarks.push(Remark(format!(
                "{place}the number of steady states is not decided: some cannot be told apart within rounding, or too many \
                 boxes{level}{stopped}"
            )));
        }
        let combination = subject.rotating.combination.as_ref();
        let counted = subject.rotating.free.is_some() && question.second.is_none();
        remarks.extend(subject.free_phases(&value, counted));
        remarks.extend(subject.enclosed());
        remarks.extend(missing(&value));
        remarks.extend(subject.doubts(question, &value));
        let standing = match question.sweep {
            _ if work.stop.asked() => {
                let done = value.branches.iter().filter(|branch| branch.complete).count();
                Standing::Stopped { done }
            }
            None if undecided > 0 || (combination.is_some() && !counted) => Standing::Undecided,
            _ => Standing::Complete,
        };
        let header =
            self.header(subject.shown_values(), Some(subject.order), subject.tier(), start);
        Ok(Answer { header, value, standing, remarks })
    }
}

impl Subject<'_> {
    /// All states at the values set.
    fn states(&self) -> Result<Response, Error> {
        let values = self.values([None, None]);
        let reach = self.reach(std::slice::from_ref(&values))?;
        let system = self.rotating.flow.system(&values);
        let look = |reach, limits| steady::all_states(&self.rotating.flow, &values, reach, &limits);
        let (found, reach, complete) = self.within(&reach, look, steady::Found::is_proved)?;
        let mut response = self.empty(reach, complete);
        let mut states = self.shown_states(None, &system, &found).ok_or(Error::NoValue)?;
        if let Some(free) = &self.rotating.free {
            self.with_free_phase(free, reach, &values, &mut states)?;
        }
        response.states.push(states);
        Ok(response)
    }

    /// The branches over the parameter.
    fn branches(&self, axis: &Axis) -> Result<Response, Error> {
        let samples = self.samples(axis)?;
        let at: Vec<_> = samples.iter().map(|sample| self.values([Some(sample), None])).collect();
        let reach = self.reach(&at)?;
        let values = self.values([None, None]);
        let course = self.course(&samples, axis, reach.modulus)?;
        let look = |reach, limits| {
            let course = Course { reach, ..course.clone() };
            let (values, samples) = (values.clone(), samples.clone());
            Survey { flow: &self.rotating.flow, values, samples, course, limits }.run()
        };
        let decides = |found: &steady::Response| found.searches.iter().all(|it| it.1.is_proved());
        let (found, reach, complete) = self.within(&reach, look, decides)?;
        let course = Course { reach, ..course };
        let mut response = self.empty(reach, complete);
        response.parameter = Some(axis.name.clone());
        response.no_closed_missing = Some(found.no_closed_missing);
        response.branches = found.branches.iter().map(|b| self.shown_branch(b)).collect();
        for change in &found.changes {
            let list = match change.change {
                steady::Change::Fold => &mut response.folds,
                steady::Change::Hopf => &mut response.hopf,
                _ => &mut response.crossings,
            };
            list.push(self.shown_change(change).ok_or(Error::NoValue)?);
        }
        let mut turning = Vec::new();
        for (sample, found) in &found.searches {
            let values = self.values([Some(sample), None]);
            let system = self.rotating.flow.system(&values);
            let states = self.shown_states(Some(sample), &system, found);
            let mut states = states.ok_or(Error::NoValue)?;
            if let Some(free) = &self.rotating.free {
                self.with_free_phase(free, reach, &values, &mut states)?;
                turning.push((Value::from(sample), states.turning()));
            }
            response.states.push(states);
        }
        if let Some(free) = &self.rotating.free {
            self.follow_turning(free, &turning, &course, &mut response)?;
            response.no_closed_missing = Some(false);
        }
        response.backbone = self.backbone(&values, &course);
        Ok(response)
    }

    fn course(&self, samples: &[Exact], axis: &Axis, reach: f64) -> Result<Course, Error> {
        Ok(Course {
            parameter: 0,
            range: ends(samples)?,
            second: None,
            positive: None,
            unknowns: 0,
            reach,
            step: step(axis),
            most: MOST_POINTS,
            stop: self.work.stop.clone(),
        })
    }

    /// The curves in the plane of two parameters.
    fn plane(&self, first: &Axis, second: &Axis) -> Result<Response, Error> {
        let samples = [self.samples(first)?, self.chosen(second)];
        let pairs =
            samples[0].iter().flat_map(|a| samples[1].iter().map(move |b| [Some(a), Some(b)]));
        let at: Vec<_> = pairs.map(|pair| self.values(pair)).collect();
        let reach = self.reach(&at)?;
        let (reach, complete) = (reach.modulus, reach.complete[0]);
        let values = self.values([None, None]);
        let open = self.open();
        let [Some(a), Some(b)] = open else { return Err(not_determined()) };
        let plane = Plane {
            flow: &self.rotating.flow,
            values,
            open: [a, b],
            course: Course {
                // As for the one of the two with more values, whichever is named first.
                step: [first, second].map(step).into_iter().fold(f64::INFINITY, f64::min),
                ..self.course(&samples[0], first, reach)?
            },
            second: ends(&samples[1])?,
            samples,
            limits: self.limits(reach),
        };
        let found = plane.run().ok_or_else(not_determined)?;
        let mut response = self.empty(reach, complete);
        response.parameter = Some(first.name.clone());
        response.second = Some(second.name.clone());
        let places = plane.places();
        response.curves = found.curves.iter().map(|c| self.shown_curve(c, places)).collect();
        for (change, zero) in &found.corners {
            let list = match change {
                steady::Change::Cusp => &mut response.cusps,
                _ => &mut response.bogdanov_takens,
            };
            list.push(self.shown_corner(zero, places).ok_or(Error::NoValue)?);
        }
        Ok(response)
    }

    /// The equation itself along the values.
    fn followed(&self, axis: &Axis, box_amplitude: f64) -> Result<[Vec<Reading>; 2], Error> {
        let values = axis.every(MOST_FOLLOWED);
        let (oscillator, harmonics) = self.in_time()?;
        let found = oscillator.followed(&values, &harmonics, box_amplitude, self.work)?;
        let reading = |found: &crate::motion::Reading| {
            let number = |value| Estimate { value };
            let polar = |part: &dyn Fn(&[f64; 2]) -> f64| {
                let list = found.harmonics.as_ref()?.iter();
                Some(list.map(|w| number(part(w))).collect::<Vec<_>>())
            };
            Reading {
                value: number(found.value.to_f64()),
                amplitudes: polar(&|w| w[0].hypot(w[1])),
                phases: polar(&|w| w[1].atan2(w[0])),
            }
        };
        Ok(found.each_ref().map(|list| list.iter().map(reading).collect()))
    }

    /// Where a start state goes.
    fn destination(&self, from: &[[Exact; 2]], response: &Response) -> Result<Destination, Error> {
        let refused = |message| Err(Refused::usage("start", message, "lindstedt simulate").into());
        if response.parameter.is_some() {
            return refused("a start state is followed without a sweep");
        }
        if self.has_phase() {
            return refused("a start state is followed for a force without a phase at t = 0");
        }
        if self.runs_backwards() {
            return refused("a start state is followed for a positive small parameter");
        }
        if from.len() != self.rotating.turns.len() {
            return Err(bad_start(self.rotating.turns.len()));
        }
        let from: Vec<_> = from.iter().map(|pair| pair.each_ref().map(Exact::to_f64)).collect();
        let start = self.start(&from);
        let system = self.rotating.flow.system(&self.values([None, None]));
        let reach = response.amplitude_limit.value / 2.0;
        let states = response.states.first().map_or(&[][..], |states| &states.list);
        let decays = states.iter().flat_map(|state| &state.exponents).map(|[re, _]| re.value.abs());
        let slowest = decays.filter(|rate| *rate > 0.0).fold(f64::INFINITY, f64::min);
        let slow = DECAY * self.rate(None) / slowest;
        let goes = |start: &[f64]| {
            let fate = settle(&system, start, reach, slow, &self.work.stop);
            match fate {
                Fate::Steady(w) => {
                    let near = |state: &State| {
                        state.at.iter().zip(&w).all(|(a, b)| (a - b).abs() < 1e-6 * reach)
                    };
                    ("steady", states.iter().position(near), self.amplitudes(&w))
                }
                Fate::Cycle(w) => ("cycle", None, self.amplitudes(&w)),
                Fate::Moving(w) => ("moving", None, self.amplitudes(&w)),
                Fate::Away => ("away", None, Vec::new()),
            }
        };
        let (fate, state, amplitudes) = goes(&start);
        let neighbours = neighbours(&start, self.start_error(&start));
        // Beyond the box the slow flow says nothing of the oscillator; that of a larger box that was asked for is trusted.
        let trusted = self.amplitude.map_or(reach, |a| reach.max(a / 2.0));
        let outside = |w: &[f64]| w.chunks_exact(2).any(|w| w[0].hypot(w[1]) > trusted);
        let goes_elsewhere = || {
            neighbours.into_iter().any(|start| {
                let (other, place, _) = goes(&start);
                (other, place) != (fate, state)
            })
        };
        let unstable = state.is_some_and(|state| states[state].stable != Some(true));
        let doubt = match fate {
            _ if outside(&start) => Some("the start lies outside the box"),
            "moving" => Some("the amplitudes still move"),
            "away" => Some("the amplitudes leave the box"),
            _ if unstable => Some("the state is not stable"),
            _ if goes_elsewhere() => Some("starts that differ by terms of order eps go elsewhere"),
            _ => None,
        };
        Ok(Destination { fate, state, amplitudes, decided: doubt.is_none(), doubt })
    }
}

/// The states at this distance of one, in eight directions of every w: basins are as thin as spirals.
fn neighbours(start: &[f64], distance: f64) -> impl Iterator<Item = Vec<f64>> {
    (0..4 * start.len()).map(move |k| {
        let mut start = start.to_vec();
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 * (k % 8) as f64).sin_cos();
        start[k / 8 * 2] += distance * cos;
        start[k / 8 * 2 + 1] += distance * sin;
        start
    })
}

/// What may be missing of branches.
fn missing(value: &Response) -> Vec<Remark> {
    let mut remarks = Vec::new();
    let broken = value.branches.iter().filter(|branch| !branch.complete).count();
    if broken > 0 {
        remarks.push(Remark(format!("{broken} branches were not followed to their ends")));
    }
    let readings = value.followed.iter().flatten().flatten();
    if let Some([up, down]) = value.followed.as_ref().filter(|[up, down]| up.len() != down.len()) {
        let (up, down) = (up.len(), down.len());
        remarks
            .push(Remark(format!("--follow: stopped after {up} values upwards, {down} downwards")));
    }
    let open = readings.clone().filter(|reading| reading.amplitudes.is_none()).count();
    if open > 0 {
        remarks.push(Remark(format!(
            "--follow: at {open} of {} values the motion did not settle, and the next begins where it came to",
            readings.count()
        )));
    }
    if value.no_closed_missing == Some(false) {
        let text = "closed branches that lie between the values searched may be missing: a list of values, --sweep NAME=V1,V2,..., is searched at each of them";
        remarks.push(Remark(text.to_owned()));
    }
    remarks
}

/// The longest step of a branch, in parts of the range.
fn step(axis: &Axis) -> f64 {
    1.0 / axis.values.len().max(LEAST_STEPS) as f64
}

/// The least and the largest of some values.
fn ends(samples: &[Exact]) -> Result<[f64; 2], Error> {
    let values = samples.iter().map(Exact::to_f64);
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if low < high {
        return Ok([low, high]);
    }
    let message = "a sweep needs two different ends";
    Err(Refused::usage("sweep", message, "--sweep NAME=LO..HI:COUNT").into())
}

/// A slow flow whose steady states are not isolated.
fn not_determined() -> Error {
    let message = "the slow flow leaves more than one parameter open";
    Refused::usage("no-value-set", message, "--set NAME=VALUE").into()
}
