//! What is integrated: the equation for x itself with values, start, history and forcing.

use super::equation::{determined, friction, is_linear, linked, meaning, values, with_small};
use super::force::frequency;
use super::history::{Evaluator, at_time, flying, free_flight, named};
use super::orbit::{Orbit, recognised};
use super::{Branch, Start};
use crate::grid::Axis;
use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Error, Exact, Oscillator};
use lindstedt_derivation::check_parameters;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Condition, Crossing, Expression, Impact, Problem};
use lindstedt_problem_file::History;
use lindstedt_simulate::{Digits, Flow, Model, Parameters, Quantity, Real as _};
use rug::{Float, Rational};

/// On the orbit itself nothing but rounding errors would tell stable from unstable in a sweep.
const SWEPT_PERTURBATION: (u32, u32) = (1, 1000);

/// A problem in the time domain.
pub(super) struct Setup {
    pub name: String,
    /// The motion: model, values, start, period of the force.
    pub flow: Flow,
    /// Every parameter as it stands, in the order of the data card.
    pub at: Vec<(String, String)>,
    /// How the start was chosen, where it was not given.
    pub chosen: Option<&'static str>,
    /// The motion before t = 0, in words.
    pub history: Option<&'static str>,
    /// The frequency of the force in the parameters, the small one by its name.
    pub frequency: Option<Expression>,
    /// The name of the small parameter.
    pub small: String,
    /// A wall bounds the motion.
    pub wall: bool,
    /// The equation is linear, without a wall.
    pub linear: bool,
    /// The periodic impact orbit that the motion starts on.
    pub orbit: Option<Orbit>,
    /// Parameters that can be swept: nothing that was computed beforehand depends on them.
    pub sweepable: Vec<String>,
    /// Equation, wall and history in one line: with the parameters and the start, all that
    /// determines a motion.
    pub identity: String,
    pub remarks: Vec<String>,
    /// The names of several unknowns.
    pub unknowns: Vec<String>,
}

impl Setup {
    /// Of one unknown. What is computed beforehand has `digits` digits and some more.
    pub fn single(
        oscillator: &Oscillator,
        start: &Start,
        swept: bool,
        digits: u32,
    ) -> Result<Self, Error> {
        let mut problem = with_small(oscillator.problem());
        let given = linked(&problem, oscillator.given().clone());
        check_parameters(&problem, &given)?;
        let mut parameters = Parameters::of_problem(&problem, &given);
        let at = values(&problem, &given, start.branch);
        let (equation, small) = determined(oscillator, &mut problem, &mut parameters);
        let bits = Digits::for_digits(digits.saturating_add(40)).bits();
        let mut case = Case {
            oscillator,
            problem,
            equation,
            small,
            parameters,
            bits,
            held: Vec::new(),
            orbit: None,
            remarks: Vec::new(),
        };
        let begin = case.begin(start, swept)?;
        case.finished(begin, at)
    }

    /// The period of the force; where what varies determines it, at the first value.
    pub fn forcing_at(&self, axis: &Axis) -> Result<Option<Quantity>, Error> {
        let first = axis.values.first().cloned().map(Quantity::from);
        let own = first.and_then(|value| self.period_at(&axis.name, &value)).transpose()?;
        Ok(own
            .map(|x| Quantity::Float(Float::with_val(53, x)))
            .or_else(|| self.flow.forcing.clone()))
    }

    /// The period of the force where the parameter has this value, if it is one on which the
    /// frequency depends.
    pub fn period_at(&self, name: &str, value: &Quantity) -> Option<Result<f64, Error>> {
        let frequency = self.frequency.as_ref()?;
        frequency.parameters().iter().find(|parameter| *parameter == name)?;
        let mut parameters = self.flow.parameters.clone();
        parameters.set(name, value.clone());
        let evaluator = Evaluator { parameters: &parameters, small: &self.small, bits: 64 };
        let period = evaluator.period(frequency).transpose()?;
        Some(period.map(|period| period.to_f64()))
    }
}

/// A setup in the making.
struct Case<'a> {
    oscillator: &'a Oscillator,
    problem: Problem,
    /// For x itself.
    equation: Expression,
    /// The name of its small parameter.
    small: String,
    parameters: Parameters,
    bits: u32,
    /// Parameters on which what was computed beforehand depends.
    held: Vec<String>,
    orbit: Option<Orbit>,
    remarks: Vec<String>,
}

/// Start, how it was chosen, and the motion before it with its words.
struct Begin {
    state: [Quantity; 2],
    chosen: Option<&'static str>,
    history: Option<(Expression, &'static str)>,
}

impl Case<'_> {
    fn evaluator(&self) -> Evaluator<'_> {
        Evaluator { parameters: &self.parameters, small: &self.small, bits: self.bits }
    }

    fn begin(&mut self, start: &Start, swept: bool) -> Result<Begin, Error> {
        let file = self.oscillator.problem_file();
        let history = match &start.history {
            Some(text) => Some(History::parse(text, &file.names)?),
            None => file.history.clone().map(|(history, _)| history),
        };
        let state = match (start.pair()?, &file.initial) {
            (Some(state), _) => Some(state),
            (None, Some([x, v])) => {
                // A first harmonic is no start.
                if self.problem.conditions.first() != Some(&Condition::FundamentalAmplitude) {
                    let taken = Taken::Initial("--state AMPLITUDE,0");
                    self.remarks.extend(self.oscillator.start_remark(taken).map(|r| r.0));
                }
                Some([Exact::parse(x)?, Exact::parse(v)?])
            }
            (None, None) => None,
        };
        let branch = start.branch.unwrap_or(Branch::Plus);
        let impacting = recognised(self.oscillator, branch, &self.evaluator());
        if let (Some(parameters), None, None) = (&impacting, &state, &history) {
            let usual = || swept.then(|| Rational::from(SWEPT_PERTURBATION));
            let perturbation = start.perturbation.clone().or_else(usual);
            let asked = start.perturbation.is_some();
            let orbit = Orbit::of(parameters, self.bits)?;
            return self.on_orbit(orbit, perturbation.as_ref(), asked);
        }
        if start.perturbation.is_some() {
            return Err(self.no_orbit(impacting.is_some()));
        }
        let (state, chosen) = match (state, &history) {
            (Some(state), _) => (state.map(Quantity::from), None),
            (None, Some(History::Expression(e))) => {
                let found = self.evaluator().value_and_rate(&self.put_in(e));
                (
                    found.ok_or_else(|| self.unknown_start())?.map(Quantity::Float),
                    Some("that of the history"),
                )
            }
            (None, _) => self.usual_start(),
        };
        let history = self.history(history, &state, impacting.is_some())?;
        Ok(Begin { state, chosen, history })
    }

    /// Just after an impact, with the orbit as history: the flight before t = 0 began one period
    /// earlier from the same state.
    fn on_orbit(
        &mut self,
        orbit: Orbit,
        perturbation: Option<&Rational>,
        asked: bool,
    ) -> Result<Begin, Error> {
        let advance = named(&mut self.parameters, "advance", orbit.advance.clone());
        let mut held = self.flying();
        held.extend(self.walls().flat_map(Expression::parameters));
        let tie = self.problem.synchronous.iter();
        held.extend(tie.flat_map(|t| [t.periods.to_string(), t.frequency.to_string()]));
        self.held = held;
        self.equation = at_time(&self.equation, &(Expression::Time + advance));
        let state = [orbit.wall.clone(), orbit.start.clone()];
        let flight =
            free_flight(&self.equation, &state, &self.small, self.bits, &mut self.parameters)?;
        let period = named(&mut self.parameters, "T", orbit.period.clone());
        let history = at_time(&flight, &(Expression::Time + period));
        let [x, mut v] = state;
        if let Some(delta) = perturbation {
            v += Float::with_val(self.bits, &orbit.velocity * delta);
        }
        self.orbit = Some(orbit);
        Ok(Begin {
            state: [x, v].map(Quantity::Float),
            chosen: Some(match (perturbation, asked) {
                (Some(_), false) => {
                    "on the periodic orbit, t = 0 just after an impact, 1/1000 of the impact velocity added"
                }
                _ => "on the periodic orbit, t = 0 just after an impact",
            }),
            history: Some((history, "the periodic orbit")),
        })
    }

    fn no_orbit(&self, impacting: bool) -> Error {
        let (message, hint) = if impacting {
            ("--perturb starts on the orbit".to_owned(), "leave out --state and --history")
        } else {
            let name = &self.problem.name;
            let message = format!(
                "{name} starts at a state: only an impact oscillator with a delay of whole periods \
                 begins on its periodic impact orbit, which --perturb leaves"
            );
            (message, "--state X,V alone")
        };
        Refused::usage("perturb", message, hint).into()
    }

    fn unknown_start(&self) -> Error {
        let message = format!("{}: the history has no value and slope at t = 0", self.problem.name);
        Refused::no_answer("no-history", message, "give a start with --state").into()
    }

    /// Where a motion starts about which nothing is said: on a belt at (1/10, 0), from where it
    /// comes to the attractor that sticks (with the paper's parameters); at rest at the amplitude; in
    /// front of a wall; at 2.
    fn usual_start(&self) -> ([Quantity; 2], Option<&'static str>) {
        let rest = Quantity::from(0);
        if self.has_belt() {
            let chosen = "at rest at x(0) = 1/10, nothing else is given";
            return ([Quantity::from(Rational::from((1, 10))), rest], Some(chosen));
        }
        if let Some(amplitude) = self.parameters.get("amplitude") {
            let chosen = "at rest at the amplitude";
            return ([amplitude.clone(), rest], Some(chosen));
        }
        if let Some(wall) = &self.problem.impact
            && let Some(position) = self.evaluator().value(&wall.position)
        {
            let side = if wall.crossing == Crossing::Rising { -1 } else { 1 };
            let chosen = "at rest at distance 1 from the wall, nothing else is given";
            return ([Quantity::Float(position + side), rest], Some(chosen));
        }
        ([Quantity::from(2), rest], Some("at rest at x(0) = 2, nothing else is given"))
    }

    /// Whether dry friction is against something that moves: its argument is not zero with the
    /// velocity.
    fn has_belt(&self) -> bool {
        let still =
            |e: &Expression| matches!(e, Expression::Unknown(_)).then(|| Expression::integer(0));
        friction(&self.equation).is_some_and(|argument| {
            let speed = self.evaluator().value(&argument.substitute(&still));
            speed.is_some_and(|speed| !speed.is_zero())
        })
    }

    /// The motion before t = 0, where the equation has a delay.
    fn history(
        &mut self,
        history: Option<History>,
        state: &[Quantity; 2],
        impacting: bool,
    ) -> Result<Option<(Expression, &'static str)>, Error> {
        if !self.equation.nodes().any(Expression::is_delayed) {
            if history.is_some() {
                self.remarks.push("history: not used, there is no delay".to_owned());
            }
            return Ok(None);
        }
        let usual = if impacting { History::FreeFlight } else { History::Constant };
        let start = state.each_ref().map(|q| q.float(self.bits));
        Ok(Some(match history.unwrap_or(usual) {
            History::Constant => {
                let [x, _] = start;
                (named(&mut self.parameters, "x", x), "x(t) = x(0) before t = 0")
            }
            History::FreeFlight => {
                self.held = self.flying();
                let parameters = &mut self.parameters;
                let flight =
                    free_flight(&self.equation, &start, &self.small, self.bits, parameters)?;
                (flight, "free flight without delay loop through the start")
            }
            History::Expression(e) => (self.put_in(&e), "the expression given, x(t) before t = 0"),
        }))
    }

    /// An expression of the user with what determines its parameters.
    fn put_in(&self, e: &Expression) -> Expression {
        let file = self.oscillator.problem_file();
        file.put_in(e).substitute(&|e| meaning(self.oscillator, e))
    }

    /// The parameters of free flight.
    fn flying(&self) -> Vec<String> {
        let flying = flying(&self.equation);
        let mut parameters = flying.parameters();
        if flying.contains(&Expression::Small) {
            parameters.push(self.small.clone());
        }
        parameters
    }

    fn walls(&self) -> impl Iterator<Item = &Expression> {
        self.problem.impact.iter().flat_map(|wall| [&wall.position, &wall.restitution])
    }

    fn finished(mut self, begin: Begin, at: Vec<(String, String)>) -> Result<Setup, Error> {
        let frequency = frequency(&[&self.equation], &self.small);
        let forcing = match &frequency {
            Some(frequency) => self.evaluator().period(frequency)?.map(Quantity::Float),
            None => None,
        };
        self.problem.time_domain = None;
        self.problem.small = self.small.clone().into();
        self.problem.equation = self.equation.clone();
        let mut model = Model::of_problem(&self.problem)?;
        let (past, history) = begin.history.unzip();
        if let Some(past) = &past {
            model = model.with_history(std::slice::from_ref(past));
        }
        let asked = &self.oscillator.problem_file().asked;
        if !asked.is_empty() {
            let list: Vec<&str> = asked.iter().map(|asked| asked.name()).collect();
            let list = list.join(", ");
            self.remarks.push(format!("asked for in the file, not answered by a motion: {list}"));
        }
        let (wall, sweepable) = (self.problem.impact.is_some(), self.sweepable());
        Ok(Setup {
            identity: self.identity(past.as_ref()),
            name: self.problem.name.to_string(),
            flow: Flow {
                model,
                parameters: self.parameters,
                start: begin.state,
                others: Vec::new(),
                forcing,
                sticks: friction(&self.equation).is_some(),
            },
            at,
            chosen: begin.chosen,
            history,
            wall,
            linear: !wall && is_linear(&self.equation),
            // The frequency of the force is held on the orbit.
            frequency: frequency.filter(|_| self.orbit.is_none()),
            sweepable,
            small: self.small,
            orbit: self.orbit,
            remarks: self.remarks,
            unknowns: Vec::new(),
        })
    }

    fn identity(&self, history: Option<&Expression>) -> String {
        let print = |e: &Expression| e.print(&self.small, Style::Text);
        let mut text = print(&self.equation);
        if let Some(Impact { position, crossing, restitution }) = &self.problem.impact {
            text += &format!("; {crossing:?} to {}, {}", print(position), print(restitution));
        }
        if let Some(history) = history {
            text += &format!("; before {}", print(history));
        }
        text
    }

    /// The parameters on which neither the start depends, nor what was computed for the history.
    fn sweepable(&self) -> Vec<String> {
        let mut mentioned = self.equation.parameters();
        mentioned.push(self.small.clone());
        mentioned.extend(self.walls().flat_map(Expression::parameters));
        // A delay that was put in moves with what it follows from.
        let tie = self.problem.synchronous.as_ref();
        let tie = tie.filter(|tie| mentioned.iter().any(|name| *name == *tie.delay));
        let linked = self.problem.parameters.iter().any(|card| card.name == "n");
        let free = |name: &String| {
            let tied = tie.is_some_and(|t| t.frequency == **name || t.periods == **name);
            let bound = name == "amplitude" || (linked && *name == self.small);
            mentioned.contains(name) && !self.held.contains(name) && !tied && !bound
        };
        let names = self.problem.parameters.iter().map(|card| card.name.to_string());
        names.filter(free).collect()
    }
}
