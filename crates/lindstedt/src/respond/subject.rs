//! The slow flow of a question with its values, and what is shown of its states.

mod reach;

use super::answer::{Estimate, Response};
use super::frequency::{Varying, forcing_frequency, moving_frequency, resonant};
use super::refusals::{
    has_numbers, is_unit, is_unset, no_amplitude, no_frame, no_part, no_polynomial, no_resonance,
    no_squares, not_weak, not_whole, refuse_zero, strong_force, uncoupled, whole,
};
use super::{ORDER, Respond, SEARCHES, STEPS};
use crate::grid::Axis;
use crate::motion::Harmonics;
use crate::refusal::{Kind, Refusal, Refused};
use crate::{Error, Exact, Oscillator, Remark, SlowFlow, Work};
use lindstedt_coeff::print::Style;
use lindstedt_equation::Expression;
use lindstedt_evaluation::rotating::{FAMILY, Rotating, forced_part, rotating};
use lindstedt_evaluation::tongue::Tongues;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::interval::Interval;
use lindstedt_orbit::steady::{self, Course, Limits, System, Value, all_zeros, follow};
use rug::{Float, Rational};

/// Bits of the constants that are enclosed.
const BITS: u32 = 80;
/// How far beside the range a backbone may begin, in widths of it.
const BESIDE: f64 = 4.0;

pub(super) type Values = Vec<Option<Value>>;

pub(super) struct Subject<'a> {
    pub(super) oscillator: &'a Oscillator,
    pub(super) work: &'a Work,
    pub(super) order: usize,
    pub(super) slow: SlowFlow,
    pub(super) rotating: Rotating,
    /// The names of what varies, among the parameters of the flow.
    swept: [Option<String>; 2],
    /// omega = factor (Omega + eps sigma), where sigma varies in the place of omega.
    pub(super) factor: Option<Rational>,
    pub(super) small: Option<Rational>,
    pub(super) amplitude: Option<f64>,
    /// Boxes looked at by a search.
    pub(super) boxes: usize,
    /// Internal resonances beside the slow flow.
    pub(super) tongues: Tongues,
}

/// The oscillator with its values, but for those that vary, that of the small parameter, and the amplitude of a family, which is
/// no parameter of the equations.
fn with_values(oscillator: &Oscillator, swept: &[Option<String>]) -> Oscillator {
    let problem = oscillator.problem();
    let varies = |known: &String| swept.iter().flatten().any(|name| name == known);
    let mut case = oscillator.clone();
    for (known, value) in oscillator.all_values() {
        case = if varies(&known) { case.without(&known) } else { case };
        if known != *problem.small && !varies(&known) {
            case = case.with(&known, value);
        }
    }
    if problem.others.is_empty() { case } else { case.without(FAMILY) }
}

/// Whether a parameter may vary: a symbol of the flow, or the amplitude of a family.
fn is_open(slow: &SlowFlow, name: &String) -> bool {
    let family = name == FAMILY && !slow.energy.is_empty();
    let independent = slow.system.independent.contains(name);
    family || slow.system.symbols.contains(name) && !is_unit(slow, name) && !independent
}

/// The flow in the frame where it rests: of modes that a resonance couples, and whole where something varies.
fn coupled(slow: &SlowFlow, small: &str, order: usize, varies: bool) -> Result<Rotating, Error> {
    let found = rotating(slow, small, order).map_err(no_frame)?;
    if !found.whole && varies {
        return Err(not_whole());
    }
    if found.fixed == 0 && found.unforced().is_none() {
        return Err(uncoupled(slow, order));
    }
    if found.unforced().is_some_and(|free| free.energy.is_none()) && !slow.energy.is_empty() {
        return Err(no_squares());
    }
    Ok(found)
}

impl<'a> Subject<'a> {
    pub(super) fn new(
        oscillator: &'a Oscillator,
        question: &Respond,
        work: &'a Work,
    ) -> Result<Self, Error> {
        let problem = oscillator.problem();
        if problem.impact.is_some() {
            let message = "a wall: the flow between two impacts is no slow flow";
            let hint = "`lindstedt stability` has the orbits with impacts and their stability";
            return Err(Refused::no_answer("no-response", message, hint).into());
        }
        let order = question.order.unwrap_or(ORDER).max(1);
        let small = problem.small.to_string();
        let name = |axis: &Option<Axis>| axis.as_ref().map(|axis| axis.name.clone());
        let mut swept = [name(&question.sweep), name(&question.second)];
        let case = with_values(oscillator, &swept);
        let mut slow = match resonant(&case, order, work).and_then(|slow| whole(slow, order, work))
        {
            // What was stopped says nothing of the names.
            Err(error) if error.kind() == Kind::Stopped => return Err(error),
            found => found,
        };
        let mut factor = None;
        if let Some(axis) = &question.sweep
            && axis.name != small
            && !slow.as_ref().is_ok_and(|slow| is_open(slow, &axis.name))
        {
            let name = &axis.name;
            // A frequency: its detuning varies in its place.
            if let Some(found) = forcing_frequency(&case, axis, order, work)? {
                let Varying { slow: own, factor: ratio, symbol } = found;
                (factor, swept[0]) = (Some(ratio), Some(symbol));
                slow = whole(own, order, work);
            } else if slow.as_ref().is_ok_and(|slow| is_unit(slow, name)) {
                return Err(moving_frequency(name));
            } else if let Ok(slow) = &slow {
                let rate = slow.system.independent.contains(name);
                let none = || strong_force(&case, axis, work).unwrap_or_else(|| no_resonance(name));
                return Err(if rate { none() } else { no_part(name) });
            } else if slow.as_ref().is_err_and(|error| is_unset(error, name)) {
                let strong = strong_force(&case, axis, work);
                return Err(strong.unwrap_or_else(|| no_resonance(name)));
            }
        }
        let slow = slow.map_err(|error| not_weak(oscillator, error))?;
        if let Some(name) =
            swept.iter().flatten().find(|name| **name != small && !is_open(&slow, name))
        {
            return Err(if is_unit(&slow, name) { moving_frequency(name) } else { no_part(name) });
        }
        has_numbers(oscillator, &slow)?;
        Self::of((oscillator, question, work), order, slow, swept, factor)
    }

    fn of(
        (oscillator, question, work): (&'a Oscillator, &Respond, &'a Work),
        order: usize,
        slow: SlowFlow,
        swept: [Option<String>; 2],
        factor: Option<Rational>,
    ) -> Result<Self, Error> {
        let small = oscillator.problem().small.to_string();
        refuse_zero(question, &small)?;
        let rotating = coupled(&slow, &small, order, question.sweep.is_some())?;
        let tongues = Tongues::of(&slow, &small, order);
        let value = oscillator.value(&small).filter(|_| !swept.contains(&Some(small.clone())));
        let small = value.as_ref().and_then(Exact::as_rational).cloned();
        let amplitude = question.amplitude.as_ref().map(Exact::to_f64);
        let order = order.min(slow.order);
        let boxes = Limits::default().boxes;
        let subject = Self {
            oscillator,
            work,
            order,
            slow,
            rotating,
            swept,
            factor,
            small,
            amplitude,
            boxes,
            tongues,
        };
        subject.check()?;
        Ok(subject)
    }

    /// Refuses parameters without a value.
    fn check(&self) -> Result<(), Error> {
        if self.small.as_ref().is_some_and(Rational::is_zero) {
            let message = "at zero the small parameter leaves no slow flow";
            return Err(Refused::usage("parameter", message, "a small value other than 0").into());
        }
        let names = self.rotating.flow.parameters.iter();
        let unset = names.zip(self.values([None, None])).find(|(name, value)| {
            value.is_none() && !self.swept.iter().flatten().any(|it| it == *name)
        });
        let beside = self.slow.system.beside.as_ref();
        let swept = |(name, _): &(&String, Option<Value>)| {
            let names = self.slow.system.angle(name)?.0.parameters();
            names.into_iter().find(|name| self.swept.iter().flatten().any(|it| it == name))
        };
        match unset {
            Some(ref pair) if swept(pair).is_some() => {
                Err(no_polynomial(pair.0, &swept(pair).unwrap_or_default()))
            }
            // A detuning that follows from the frequency and the small parameter, which has no value.
            Some((name, _)) if beside.is_some_and(|it| it.symbol == *name) => {
                Err(self.oscillator.unset(&self.oscillator.problem().small))
            }
            Some((name, _)) if name == FAMILY => Err(no_amplitude("has no value")),
            Some((name, _)) => Err(self.oscillator.unset(name)),
            None if self.amplitude.is_some_and(|a| !a.is_finite() || a <= 0.0) => {
                let message = "the largest amplitude is a positive number";
                Err(Refused::usage("box", message, "--box 2").into())
            }
            None => Ok(()),
        }
    }

    /// What is said of coefficients that are enclosed.
    pub(super) fn enclosed(&self) -> Option<Remark> {
        let enclosed = self.slow.enclosed.as_ref()?;
        let left = match !self.is_whole() {
            true => {
                ", but for those that cannot be told from zero, which are left out: their number is estimated"
            }
            false => "",
        };
        let radius = enclosed.radius;
        Some(Remark(format!(
            "a frequency is irrational: the states are those of all coefficients within {radius:.1e}{left}"
        )))
    }

    /// Refuses an amplitude that is set where motions form no family, or that is a parameter of the equations as well.
    pub(super) fn refuse_amplitude(&self) -> Result<(), Error> {
        let problem = self.oscillator.problem();
        if problem.others.is_empty() || !self.oscillator.given().contains_key(FAMILY) {
            return Ok(());
        }
        let own =
            problem.equations().any(|it| it.parameters().iter().any(|name| **name == *FAMILY));
        let (code, message, hint) = match (self.is_family(), own) {
            (true, true) => (
                "symbol-taken",
                "`amplitude` is a parameter of the equations and that of the family of normal modes",
                "another name in the equations",
            ),
            (false, false) => (
                "parameter",
                "no conserved energy is known by which motions form families over their amplitude",
                "without --set amplitude",
            ),
            _ => return Ok(()),
        };
        Err(Refused::usage(code, message, hint).into())
    }

    /// Whether motions are families of one parameter.
    pub(super) fn is_family(&self) -> bool {
        self.rotating.unforced().is_some_and(|free| free.energy.is_some())
    }

    /// Whether what is found of the flow is found of the whole one.
    pub(super) fn is_whole(&self) -> bool {
        self.rotating.whole
    }

    pub(super) fn tier(&self) -> &'static str {
        if self.slow.enclosed.is_some() { "certified" } else { "exact" }
    }

    /// The value of the unit of frequency.
    pub(super) fn unit(&self) -> Option<Ball> {
        let value = |name: &str| self.oscillator.value(name);
        self.slow.system.unit_value(&value, Balls::new(BITS))
    }

    /// The value of a symbol cos(phi) or sin(phi).
    fn wave(&self, name: &str) -> Option<Ball> {
        let swept = |name: &str| self.swept.iter().flatten().any(|it| it == name);
        let value = |name: &str| self.oscillator.value(name).filter(|_| !swept(name));
        self.slow.system.wave(name, &value, Balls::new(BITS))
    }

    /// A detuning of a given frequency from that of a resonance, which is known within the radius of the slow flow.
    fn detuned(&self, detuning: &Rational) -> Value {
        let multiples = self.slow.system.forces.iter().flat_map(|phase| &phase.of_modes);
        let multiples: f64 = multiples.map(|q| q.to_f64().abs()).sum();
        match (&self.slow.enclosed, &self.small) {
            (Some(enclosed), Some(small)) if multiples > 0.0 => {
                let balls = Balls::new(BITS);
                let within = Float::with_val(53, multiples * enclosed.radius / small.to_f64());
                Value::from(&balls.add_error(&balls.from_rational(detuning), &within))
            }
            _ => Value::Rational(detuning.clone()),
        }
    }

    /// The values of the flow's parameters, those of what varies as given.
    pub(super) fn values(&self, varying: [Option<&Exact>; 2]) -> Values {
        let small = &self.oscillator.problem().small;
        let detuning = |name: &str| {
            let beside = self.slow.system.beside.as_ref().filter(|it| it.symbol == name)?;
            let away = (&beside.rate - self.slow.system.force()) / self.small.as_ref()?;
            Some(match &self.slow.system.unit {
                None => self.detuned(&away),
                Some(_) => Value::from(&Balls::new(BITS).mul_rational(&self.unit()?, &away)),
            })
        };
        let known = |name: &str| match self.oscillator.value(name) {
            Some(value) => Some(Value::from(&value)),
            None => self.wave(name).map(|ball| Value::from(&ball)),
        };
        let place = |name: &String| self.swept.iter().position(|it| it.as_ref() == Some(name));
        let value = |name: &String| match place(name) {
            Some(0) if self.factor.is_some() => {
                let varies = |value: &Exact| Some(self.detuned(value.as_rational()?));
                varying[0].and_then(varies)
            }
            Some(place) => varying[place].map(Value::from),
            None if **name == **small => self.small.clone().map(Value::Rational),
            None => detuning(name).or_else(|| known(name)),
        };
        self.rotating.flow.parameters.iter().map(value).collect()
    }

    /// Which of the flow's parameters vary.
    pub(super) fn open(&self) -> [Option<usize>; 2] {
        let names = &self.rotating.flow.parameters;
        let place = |name: &Option<String>| names.iter().position(|it| Some(it) == name.as_ref());
        self.swept.each_ref().map(place)
    }

    /// The values that enter, for the header.
    pub(super) fn shown_values(&self) -> impl Iterator<Item = (String, Exact)> {
        let varies = |name: &String| self.swept.iter().flatten().any(|swept| swept == name);
        self.oscillator.all_values().into_iter().filter(move |(name, _)| !varies(name))
    }

    /// Values of an axis at which all states are looked for: a list as it is, of a range some.
    pub(super) fn chosen(&self, axis: &Axis) -> Vec<Exact> {
        let most = SEARCHES[usize::from(self.rotating.turns.len() > 1)];
        let last = axis.values.len().max(1) - 1;
        let mut chosen: Vec<usize> = match last {
            last if last < most || !axis.is_equidistant() => (0..=last).collect(),
            last => (0..most).map(|k| k * last / (most - 1)).collect(),
        };
        chosen.dedup();
        chosen.into_iter().map(|k| axis.values[k].clone()).collect()
    }

    /// Those of the first parameter, as the flow has it.
    pub(super) fn samples(&self, axis: &Axis) -> Result<Vec<Exact>, Error> {
        let values = self.chosen(axis).into_iter();
        let Some(factor) = &self.factor else { return Ok(values.collect()) };
        let unset = || self.oscillator.unset(&self.oscillator.problem().small);
        let small = self.small.as_ref().ok_or_else(unset)?;
        let detuning = |value: Exact| {
            let rate = Rational::from(value.as_rational()? / factor);
            Some(Exact::Rational((rate - self.slow.system.force()) / small))
        };
        values.map(|value| detuning(value).ok_or(Error::NoValue)).collect()
    }

    pub(super) fn empty(&self, reach: f64, complete: bool) -> Response {
        Response {
            parameter: None,
            coordinates: self.slow.coordinates(),
            modes: self.modes(),
            turns: self.rotating.turns.iter().map(|turn| self.listed(turn)).collect(),
            amplitude_limit: Estimate { value: 2.0 * reach },
            complete,
            branches: Vec::new(),
            no_closed_missing: None,
            folds: Vec::new(),
            hopf: Vec::new(),
            crossings: Vec::new(),
            states: Vec::new(),
            backbone: Vec::new(),
            second: None,
            curves: Vec::new(),
            cusps: Vec::new(),
            bogdanov_takens: Vec::new(),
            followed: None,
            leads_to: None,
        }
    }

    fn modes(&self) -> Vec<[String; 2]> {
        let some = self.slow.system.shapes.as_ref();
        let lines = |style| some.map_or_else(Vec::new, |_| self.slow.print_shapes(style));
        let pairs = lines(Style::Text).into_iter().zip(lines(Style::Latex));
        pairs.map(|(text, latex)| [text, latex]).collect()
    }

    /// k_1, k_2, ...; those of an irrational frequency are in the middle of an enclosure.
    fn listed(&self, turn: &[Rational]) -> String {
        let shown = |k: &Rational| match k.denom().significant_bits() > 64 {
            true => self.slow.size(k),
            false => k.to_string(),
        };
        turn.iter().map(shown).collect::<Vec<_>>().join(", ")
    }

    /// The oscillator, and the harmonics of its motion that are those of the slow flow, of a single force.
    pub(super) fn in_time(&self) -> Result<(&Oscillator, Harmonics), Error> {
        if self.slow.forces() > 1 {
            let message = "several phases of forces have no period in common";
            return Err(Refused::usage("follow", message, "lindstedt simulate").into());
        }
        let turns = self.rotating.turns.iter().flatten().cloned().collect();
        let row = |row: &Vec<Rational>| row.iter().map(Rational::to_f64).collect();
        let modes = self.slow.system.modes().map(|rows| rows.iter().map(row).collect());
        Ok((self.oscillator, Harmonics { turns, modes }))
    }

    /// w of the x_j, x_j' at t = 0: z to leading order.
    pub(super) fn start(&self, from: &[[f64; 2]]) -> Vec<f64> {
        let values = doubles(&self.values([None, None]));
        let unit = self.unit().map_or(f64::NAN, |unit| unit.midpoint().to_f64());
        let own = |j: usize| match self.slow.system.modes() {
            None => from[j],
            Some(rows) => rows[j].iter().zip(from).fold([0.0, 0.0], |[x, v], (share, pair)| {
                [x + share.to_f64() * pair[0], v + share.to_f64() * pair[1]]
            }),
        };
        let start = |(j, nu): (usize, &Rational)| {
            let ([x, velocity], [forced, rate]) = (own(j), forced_part(&self.slow, j, &values));
            [0.5 * (x - forced), -0.5 * (velocity / unit - rate) / nu.to_f64()]
        };
        self.slow.system.frequencies.iter().enumerate().flat_map(start).collect()
    }

    pub(super) fn amplitudes(&self, w: &[f64]) -> Vec<Estimate> {
        w.chunks_exact(2).map(|w| Estimate { value: 2.0 * w[0].hypot(w[1]) }).collect()
    }

    /// The small parameter at a value of the flow's parameter: rates per unit of t.
    pub(super) fn rate(&self, value: Option<f64>) -> f64 {
        self.small.as_ref().map(Rational::to_f64).or(value).unwrap_or(f64::NAN)
    }

    /// Exponents per unit of t.
    pub(super) fn exponents(&self, point: &steady::Point, rate: f64) -> Vec<[Estimate; 2]> {
        let scaled = |x: f64| Estimate { value: rate * x };
        point.exponents.iter().map(|x| [scaled(x.re), scaled(x.im)]).collect()
    }

    /// Whether eta is not 0 at t = 0.
    pub(super) fn has_phase(&self) -> bool {
        let moved = |start: &Expression| start.as_number().is_none_or(|start| !start.is_zero());
        self.slow.system.forces.iter().any(|phase| moved(&phase.start))
    }

    pub(super) fn runs_backwards(&self) -> bool {
        self.small.as_ref().is_some_and(|small| *small < 0)
    }

    /// As [`steady::Point::is_stable`] has it of w'/eps; of a negative small parameter the slow flow runs backwards.
    pub(super) fn is_stable(&self, point: &steady::Point, rate: f64) -> Option<bool> {
        if rate > 0.0 {
            return point.is_stable();
        }
        let mut reversed = point.clone();
        reversed.exponents.iter_mut().for_each(|x| *x = -*x);
        reversed.is_stable()
    }

    /// The curve of free motion: from |w| = 0, also where that lies beside the range.
    pub(super) fn backbone(&self, values: &Values, course: &Course) -> Vec<[Estimate; 2]> {
        let Some(flow) = &self.rotating.backbone else { return Vec::new() };
        let [low, high] = course.range;
        let wide = [low - BESIDE * (high - low), high + BESIDE * (high - low)];
        let still = std::iter::once(Some(Value::Rational(Rational::new())));
        let given: Values = still.chain(values.iter().cloned()).collect();
        let range = [Interval::new(wide[0], wide[1])];
        let at_rest = all_zeros(&System::new(&flow.rows, &given), &range, &Limits::default());
        let starts = at_rest.into_iter().flat_map(|found| found.zeros);
        let system = flow.system(values);
        // A curve to look at: no finer than that.
        let step = course.step.max(1.0 / STEPS as f64) / (1.0 + 2.0 * BESIDE);
        let course = Course { parameter: 1, unknowns: 1, range: wide, step, ..course.clone() };
        let branches =
            starts.filter_map(|zero| follow(&system, &[0.0, zero.enclosure[0].middle()], &course));
        let points = branches.flat_map(|branch| branch.points);
        let inside =
            |point: &steady::Point| point.at[0] >= 0.0 && (low..=high).contains(&point.at[1]);
        let shown = |point: steady::Point| {
            [self.shown_value(point.at[1]), 2.0 * point.at[0]].map(|value| Estimate { value })
        };
        points.filter(inside).map(shown).collect()
    }
}

pub(super) fn doubles(values: &Values) -> Vec<f64> {
    let number =
        |value: &Option<Value>| value.as_ref().map_or(f64::NAN, |it| it.interval().middle());
    values.iter().map(number).collect()
}
