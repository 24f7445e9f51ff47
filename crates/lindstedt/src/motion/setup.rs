//! What is integrated: the equation for x itself with values, start, history and forcing.

use super::history::{Evaluator, at_time, flying, free_flight, named};
use super::orbit::{Orbit, recognised};
use super::{Branch, Start};
use crate::refusal::Refused;
use crate::start::Taken;
use crate::{Error, Exact, Oscillator};
use lindstedt_derivation::check_parameters;
use lindstedt_equation::Function::{Abs, Cos, Sign, Sin};
use lindstedt_equation::monomials::expand;
use lindstedt_equation::print::Style;
use lindstedt_equation::{
    AmplitudeRole, Condition, Crossing, Expression, Impact, ParameterCard, Problem,
};
use lindstedt_expand::Excitation;
use lindstedt_problem_file::History;
use lindstedt_simulate::{Digits, Flow, Model, Parameters, Quantity, Real as _};
use rug::{Float, Rational};
use std::collections::BTreeMap;

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
    /// The frequency of the force in the parameters.
    frequency: Option<Expression>,
    /// The name of the small parameter.
    small: String,
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
}

impl Setup {
    /// What is computed beforehand has `digits` digits and some more.
    pub fn new(
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
        let state = match (&start.state, &file.initial) {
            (Some(state), _) => Some(state.clone()),
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
            return self.on_orbit(Orbit::of(parameters, self.bits)?, perturbation.as_ref());
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
    fn on_orbit(&mut self, orbit: Orbit, perturbation: Option<&Rational>) -> Result<Begin, Error> {
        let advance = named(&mut self.parameters, "advance", orbit.advance.clone());
        let mut held = flying(&self.equation).parameters();
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
            chosen: Some("on the periodic orbit, t = 0 just after an impact"),
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
                self.held = flying(&self.equation).parameters();
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

    fn walls(&self) -> impl Iterator<Item = &Expression> {
        self.problem.impact.iter().flat_map(|wall| [&wall.position, &wall.restitution])
    }

    fn finished(mut self, begin: Begin, at: Vec<(String, String)>) -> Result<Setup, Error> {
        let force = Excitation::of(&without_phases(&self.equation)).ok();
        let frequency = force.and_then(|force| force.frequency);
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
            let list = asked.join(", ");
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

/// The problem with a card of its small parameter: without a value it is one.
fn with_small(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    let known = problem.parameters.iter().any(|card| card.name == problem.small);
    if problem.amplitude != AmplitudeRole::InSmallParameter && !known {
        let (name, meaning) = (problem.small.clone(), "small parameter".into());
        problem.parameters.push(ParameterCard { name, meaning, default: "1".into() });
    }
    problem
}

/// n = 1 + 2 delta, where a problem has both: whichever is given determines the other.
fn linked(problem: &Problem, mut given: BTreeMap<String, Exact>) -> BTreeMap<String, Exact> {
    let rational = |name: &str| given.get(name).and_then(Exact::as_rational).cloned();
    let other = match (rational("n"), rational("delta")) {
        (Some(n), None) => ("delta", (n - 1u32) / 2u32),
        (None, Some(delta)) => ("n", delta * 2u32 + 1u32),
        _ => return given,
    };
    if problem.parameters.iter().any(|card| card.name == other.0) {
        given.insert(other.0.to_owned(), other.1.into());
    }
    given
}

/// All parameters of the card: given, or by default; a default that is no number stands for itself.
fn values(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
    branch: Option<Branch>,
) -> Vec<(String, String)> {
    let value = |card: &ParameterCard| {
        let default = || {
            let value = Exact::parse(&card.default);
            value.map_or_else(|_| card.default.to_string(), |value| value.to_string())
        };
        let text = match (given.get(&*card.name), branch) {
            (Some(value), _) => value.to_string(),
            (None, Some(branch)) if card.name == "branch" => {
                if branch == Branch::Plus { "+" } else { "-" }.to_owned()
            }
            _ => default(),
        };
        (card.name.to_string(), text)
    };
    problem.parameters.iter().map(value).collect()
}

/// What determines a parameter that has no value of its own because it contains pi.
fn meaning(oscillator: &Oscillator, e: &Expression) -> Option<Expression> {
    match e {
        Expression::Parameter(name) => oscillator.problem_file().determined().get(&**name).cloned(),
        _ => None,
    }
}

/// The equation for x itself, and the name of its small parameter, with what determines parameters
/// put in, there and in the wall.
fn determined(
    oscillator: &Oscillator,
    problem: &mut Problem,
    parameters: &mut Parameters,
) -> (Expression, String) {
    if !oscillator.problem_file().determined().is_empty() {
        parameters.set("pi", Exact::PiTimes(Rational::from(1)));
    }
    let put_in = |e: &Expression| e.substitute(&|e| meaning(oscillator, e));
    if let Some(wall) = &mut problem.impact {
        wall.position = put_in(&wall.position);
        wall.restitution = put_in(&wall.restitution);
    }
    let small = problem.small.to_string();
    let at_one = parameters.get(&small).and_then(Quantity::rational) == Some(Rational::from(1));
    let equation = match (&problem.time_domain, problem.amplitude) {
        // The equation for x/a.
        (Some(equation), AmplitudeRole::InSums) => {
            let amplitude = || Expression::parameter("amplitude").pow(-1);
            let scaled = |e: &Expression| {
                matches!(e, Expression::Unknown(_)).then(|| e.clone() * amplitude())
            };
            if at_one { embedded(equation) } else { equation.clone() }.substitute(&scaled)
        }
        (Some(equation), _) => equation.clone(),
        (None, _) => problem.equation.clone(),
    };
    let equation = put_in(&equation);
    // Duffing's rho = eps A^2 belongs to x/A; the coefficient for x is eps.
    let of_x = problem.amplitude == AmplitudeRole::InSmallParameter;
    let small = if of_x && parameters.get("eps").is_some() { "eps".to_owned() } else { small };
    (equation, small)
}

/// An equation with the force x S(delta ln x^2), S(z) = sin(a e^(z/2))/(a e^(z/2)), at delta = 1: S is
/// even in e^(z/2), which is x then but for its sign, so that the force is sin(a x)/a.
fn embedded(equation: &Expression) -> Expression {
    let one = |e: &Expression| (*e == Expression::Small).then(|| Expression::integer(1));
    let x = || Expression::DISPLACEMENT;
    let root = x().pow(2).pow(Expression::Number(Rational::from((1, 2)))).canonical();
    let equation = equation.substitute(&one).canonical();
    let equation = equation.map(&|e| (*e == root).then(x));
    let sine = |e: &Expression| {
        let Expression::Product(factors) = e else { return None };
        let angle = factors.iter().find_map(|factor| match factor {
            Expression::Function(Sin, angle) => Some((**angle).clone()),
            _ => None,
        })?;
        let inverse = angle.clone().pow(-1).canonical();
        let both = [&x(), &inverse].iter().all(|wanted| factors.contains(wanted));
        let others = factors.iter().filter(|f| **f != x() && **f != inverse).cloned();
        let slope = angle.substitute(&|e| (*e == x()).then(|| Expression::integer(1)));
        both.then(|| Expression::Product(others.chain([slope.pow(-1)]).collect()))
    };
    equation.map(&sine)
}

/// The equation with cos(omega t) for cos(omega t + p) and the same for sin: the period of a force
/// does not depend on its phase.
fn without_phases(e: &Expression) -> Expression {
    let out = |e: Expression| {
        let e = e.canonical();
        e.multiplied_out().unwrap_or(e).canonical()
    };
    let plain = |e: &Expression| {
        let Expression::Function(function @ (Cos | Sin), z) = e else { return None };
        let at = |time: i64| at_time(z, &Expression::integer(time));
        let bend = out(at(2) - 2 * at(1) + at(0));
        let driven = z.contains(&Expression::Time) && !z.nodes().any(is_state);
        (driven && bend == Expression::integer(0))
            .then(|| (out(at(1) - at(0)) * Expression::Time).apply(*function))
    };
    e.map(&plain)
}

fn is_state(e: &Expression) -> bool {
    matches!(e, Expression::Unknown(_))
}

/// Whether the equation is linear in x, x', x'' and their delayed values.
fn is_linear(equation: &Expression) -> bool {
    let degree = |(atom, n): (&Expression, u32)| match atom {
        Expression::Unknown(_) => n,
        other if other.nodes().any(is_state) => 2,
        _ => 0,
    };
    expand(equation).is_some_and(|all| {
        all.terms.keys().all(|m| {
            let atoms = m.atoms.iter().filter_map(|(key, n)| Some((all.atoms.get(key)?, *n)));
            m.x + m.velocity + atoms.map(degree).sum::<u32>() <= 1
        })
    })
}

/// The argument of a sign or absolute value that has the velocity in it: dry friction.
fn friction(equation: &Expression) -> Option<&Expression> {
    let is_friction = |e: &Expression| match e {
        Expression::Function(Abs | Sign, argument) => argument.contains(&Expression::VELOCITY),
        _ => false,
    };
    match equation.find(&is_friction)? {
        Expression::Function(_, argument) => Some(&**argument),
        _ => None,
    }
}
