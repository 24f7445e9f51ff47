//! What is integrated: the problem's equation with values, start and history.

use super::history::{Evaluator, constant, free_flight};
use super::orbit::on_orbit;
use crate::failure::{Failure, NO_ANSWER};
use crate::session::{Loaded, load, parameters};
use crate::stability::request::exact_parameters;
use lindstedt::equation::Function::{Abs, Sign, Sin};
use lindstedt::equation::{AmplitudeRole, Condition, Crossing, Expression, ParameterCard, Problem};
use lindstedt::expand::Excitation;
use lindstedt::problem_file::{History, Names, ProblemFile, parse_expression};
use lindstedt::problems::{stick_slip, vibro_impact};
use lindstedt::simulate::{Digits, Model, Parameters, Quantity, Real as _};
use lindstedt::verify::{quantities, quantity};
use lindstedt::{Error, Value};
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// A problem in the time domain.
pub struct Setup {
    pub name: String,
    pub model: Model,
    pub parameters: Parameters,
    /// Every parameter as it stands, in the order of the data card.
    pub at: Vec<(String, String)>,
    /// x(0), x'(0).
    pub start: [Quantity; 2],
    /// The period of the force.
    pub forcing: Option<Quantity>,
    /// A wall bounds the motion.
    pub wall: bool,
    /// Dry friction makes the body stick.
    pub sticks: bool,
    /// Period and impact velocity of the periodic impact orbit that the motion starts on.
    pub orbit: Option<(Float, Float)>,
    /// Parameters that can be swept (nothing else depends on them).
    pub sweepable: Vec<String>,
    /// Ranges LO..HI:COUNT of parameters that a file says.
    pub ranges: BTreeMap<String, String>,
    /// What was chosen, in words.
    pub remarks: Vec<String>,
}

type Given = BTreeMap<String, Value>;

/// Where a motion starts, as far as it was said.
#[derive(Default)]
pub struct Start<'a> {
    /// x(0), x'(0).
    pub state: Option<[Quantity; 2]>,
    /// `constant`, `free-flight`, or an expression in t.
    pub history: Option<&'a str>,
    /// Velocity added on the orbit.
    pub perturbation: Option<Rational>,
    /// A parameter is swept: on the orbit itself nothing but rounding errors would tell stable
    /// from unstable, so the start is perturbed.
    pub sweep: bool,
}

/// Whether two problems are the same equation with the same wall and delay.
fn same(a: &Problem, b: &Problem) -> bool {
    let equation = |p: &Problem| {
        let equation = p.equation.canonical();
        equation.multiplied_out().unwrap_or(equation)
    };
    let wall = |p: &Problem| {
        let wall = p.impact.as_ref()?;
        Some((wall.position.canonical(), wall.crossing, wall.restitution.canonical()))
    };
    equation(a) == equation(b) && wall(a) == wall(b) && a.synchronous == b.synchronous
}

fn source(name: &str) -> Result<Loaded, Failure> {
    let belt = stick_slip::problem();
    if belt.name == name { Ok(Loaded { problem: belt, file: None }) } else { load(name) }
}

impl Setup {
    /// Reads a problem; numbers that are computed have `digits` digits and some more.
    pub fn read(
        name: &str,
        set: &[String],
        start: &Start<'_>,
        digits: u32,
    ) -> Result<Self, Failure> {
        let Loaded { problem, file } = source(name)?;
        let file = file.as_ref();
        let impacting = same(&problem, &vibro_impact::problem());
        let state = match (&start.state, file.and_then(|f| f.initial.as_ref())) {
            (None, Some([x, v])) => {
                Some([quantity(&Value::parse(x)?), quantity(&Value::parse(v)?)])
            }
            (state, _) => state.clone(),
        };
        let names = || match file {
            Some(file) => file.names.clone(),
            None => Names::only(&problem.small, problem.parameters.iter().map(|card| &*card.name)),
        };
        let history = match start.history {
            Some(text) => Some(History::parse(text, &names()).map_err(Error::from)?),
            None => file.and_then(|f| f.history.clone()).map(|(history, _)| history),
        };
        let mut set = set.to_vec();
        if impacting {
            set.extend(defaults(&problem, &set));
        }
        let mut setup = if impacting && state.is_none() && history.is_none() {
            let usual = || start.sweep.then(|| Rational::from((1, 1000)));
            let perturbation = start.perturbation.clone().or_else(usual);
            on_orbit(&problem, &set, perturbation.as_ref(), digits)?
        } else if start.perturbation.is_some() {
            let message = if impacting {
                "--perturb starts on the orbit".to_owned()
            } else {
                format!("{} has no periodic impact orbit to perturb", problem.name)
            };
            let hint = if impacting { "leave out --state and --history" } else { "use --state" };
            return Err(Failure::usage("perturb", message, hint));
        } else {
            let case = Case { problem: &problem, file, impacting, digits };
            case.setup(&set, state, history)?
        };
        if let Some(file) = file {
            setup.keep_to(file);
        }
        Ok(setup)
    }

    /// What a file says about its parameters and its questions.
    fn keep_to(&mut self, file: &ProblemFile) {
        self.sweepable.retain(|name| !file.fixed.contains(name));
        self.ranges = file.ranges.clone();
        if !file.asked.is_empty() {
            let list = file.asked.join(", ");
            self.remarks.push(format!("asked for in the file, not answered by a motion: {list}"));
        }
    }
}

/// The parameters of a file that is the vibro-impact oscillator, as far as they are not set.
fn defaults(problem: &Problem, set: &[String]) -> Vec<String> {
    let known = vibro_impact::problem().parameters;
    let is_set = |name: &str| {
        set.iter().any(|item| item.split_once('=').is_some_and(|(n, _)| n.trim() == name))
    };
    let cards = problem.parameters.iter();
    let cards = cards.filter(|card| known.iter().any(|k| k.name == card.name));
    let cards = cards.filter(|card| !is_set(&card.name) && !card.default.is_empty());
    cards.map(|card| format!("{}={}", card.name, card.default)).collect()
}

/// All parameters of a card: given, or by default; a default that is no number stands for itself.
fn values(cards: &[ParameterCard], given: &Given) -> Vec<(String, Option<Value>)> {
    let value = |card: &ParameterCard| {
        let value = given.get(&*card.name).cloned();
        (card.name.to_string(), value.or_else(|| Value::parse(&card.default).ok()))
    };
    cards.iter().map(value).collect()
}

/// A problem that does not start on an impact orbit.
struct Case<'a> {
    problem: &'a Problem,
    file: Option<&'a ProblemFile>,
    /// It is the vibro-impact oscillator.
    impacting: bool,
    digits: u32,
}

impl Case<'_> {
    fn setup(
        &self,
        set: &[String],
        state: Option<[Quantity; 2]>,
        history: Option<History>,
    ) -> Result<Setup, Failure> {
        let mut problem = self.problem.clone();
        let role = problem.amplitude;
        let (given, mut at) = if self.impacting {
            let (_, at) = exact_parameters(set)?;
            let numbers = set.iter().filter(|item| !item.trim().starts_with("branch="));
            (parameters(&numbers.cloned().collect::<Vec<_>>())?, at)
        } else {
            let is_small = |card: &ParameterCard| card.name == problem.small;
            if role != AmplitudeRole::InSmallParameter && !problem.parameters.iter().any(is_small) {
                let (name, meaning) = (problem.small.clone(), "small parameter".into());
                problem.parameters.push(ParameterCard { name, meaning, default: "1".into() });
            }
            let given = parameters(set)?;
            // Domains as the expansions have them.
            lindstedt::check_parameters(&problem, &given)?;
            (linked(given), Vec::new())
        };
        let mut bindings = quantities(&problem, &given);
        if self.impacting {
            bindings.set(&problem.small, 1);
        } else {
            let text = |(name, value): (String, Option<Value>)| {
                let card = problem.parameters.iter().find(|card| *card.name == *name);
                let default = || card.map_or_else(String::new, |card| card.default.to_string());
                (name, value.map_or_else(default, |value| value.to_string()))
            };
            at = values(&problem.parameters, &given).into_iter().map(text).collect();
        }
        self.determined(&mut problem, &mut bindings)?;
        let (equation, small) = self.time_domain(&problem, &bindings);
        let bits = Digits::for_digits(self.digits + 40).bits();
        let mut remarks = Vec::new();
        let evaluator = Evaluator { parameters: &bindings, small: &small, bits };
        let state = match (state, &history) {
            (Some(state), _) => state,
            (None, Some(History::Expression(e))) => {
                let found = evaluator.value_and_rate(e).ok_or_else(|| unknown_start(&problem))?;
                remarks.push("start: that of the history".to_owned());
                found.map(Quantity::Float)
            }
            (None, _) => self.start(&problem, &evaluator, &mut remarks),
        };
        let forcing = self.forcing(&equation, &evaluator)?;
        let wall = problem.impact.is_some();
        problem.time_domain = None;
        problem.small = small.clone().into();
        problem.equation = equation;
        let mut model = Model::of_problem(&problem)?;
        let delayed = |e: &Expression| matches!(e, Expression::Delayed(..));
        let mut held = Vec::new();
        if problem.equation.find(&delayed).is_some() {
            let usual = || if self.impacting { History::FreeFlight } else { History::Constant };
            let start = state.each_ref().map(|q| q.float(bits));
            let (expression, remark) = match history.unwrap_or_else(usual) {
                History::Constant => {
                    let [x, _] = start;
                    (constant(x, &mut bindings), "x(t) = x(0) before t = 0")
                }
                History::FreeFlight => {
                    let equation = &problem.equation;
                    held = flying(equation).parameters();
                    let remark = "free flight without delay loop through the start";
                    (free_flight(equation, &start, &small, bits, &mut bindings)?, remark)
                }
                History::Expression(e) => (e, "the expression given, x(t) before t = 0"),
            };
            remarks.push(format!("history: {remark}"));
            model = model.with_history(&[expression]);
        } else if history.is_some() {
            remarks.push("history: not used, there is no delay".to_owned());
        }
        let sweepable = self.sweepable(&problem, &held);
        Ok(Setup {
            name: problem.name.to_string(),
            model,
            parameters: bindings,
            at,
            start: state,
            forcing,
            wall,
            sticks: rubs(&problem.equation),
            orbit: None,
            sweepable,
            ranges: BTreeMap::new(),
            remarks,
        })
    }

    /// Puts in what determines a parameter that has no value of its own (`follows`).
    fn determined(&self, problem: &mut Problem, bindings: &mut Parameters) -> Result<(), Failure> {
        let Some(file) = self.file else { return Ok(()) };
        let mut names = file.names.clone();
        names.parameters.iter_mut().for_each(|set| {
            set.insert("pi".to_owned());
        });
        for (name, text) in &file.follows {
            if bindings.get(name).is_some() {
                continue;
            }
            let follows = parse_expression(text, &names).map_err(|error| Failure {
                exit: NO_ANSWER,
                code: "no-value",
                message: format!("{name} has no value: {error} in {text:?}"),
                hint: "follows = \"...\" needs an expression in parameters and pi".into(),
            })?;
            bindings.set("pi", Quantity::PiMultiple(Rational::from(1)));
            let put_in =
                |e: &Expression| (*e == Expression::parameter(name)).then(|| follows.clone());
            problem.equation = problem.equation.substitute(&put_in);
            problem.time_domain = problem.time_domain.as_ref().map(|e| e.substitute(&put_in));
            if let Some(wall) = &mut problem.impact {
                wall.position = wall.position.substitute(&put_in);
                wall.restitution = wall.restitution.substitute(&put_in);
            }
        }
        Ok(())
    }

    /// The equation for x itself, and the name of its small parameter.
    fn time_domain(&self, problem: &Problem, bindings: &Parameters) -> (Expression, String) {
        let one = Some(Rational::from(1));
        let small = problem.small.to_string();
        let at_one = bindings.get(&small).and_then(Quantity::rational) == one;
        let pendulum = lindstedt::problems::find("pendulum");
        let equation = match (&problem.time_domain, problem.amplitude) {
            // At delta = 1 the pendulum's embedding is the pendulum.
            (Some(_), AmplitudeRole::InSums)
                if at_one && pendulum.is_some_and(|p| same(&p, problem)) =>
            {
                Expression::Acceleration + Expression::Displacement.apply(Sin)
            }
            (Some(equation), AmplitudeRole::InSums) => scaled(equation),
            (Some(equation), _) => equation.clone(),
            (None, _) => problem.equation.clone(),
        };
        // Duffing's rho = eps A^2 belongs to x/A; the coefficient for x is eps.
        if problem.amplitude == AmplitudeRole::InSmallParameter && bindings.get("eps").is_some() {
            return (equation, "eps".to_owned());
        }
        (equation, small)
    }

    /// Where a motion starts about which nothing is said: at rest at the amplitude; on a belt at
    /// (1/10, 0), from where it comes to the attractor that sticks (with the paper's parameters);
    /// in front of a wall; at 2.
    fn start(
        &self,
        problem: &Problem,
        evaluator: &Evaluator<'_>,
        remarks: &mut Vec<String>,
    ) -> [Quantity; 2] {
        let rest = Quantity::from(0);
        if problem.equation.canonical() == stick_slip::equation().canonical() {
            return [Quantity::from(Rational::from((1, 10))), rest];
        }
        let mut say =
            |text: &str| remarks.push(format!("start: at rest at {text}, nothing else is given"));
        if let Some(amplitude) = evaluator.parameters.get("amplitude") {
            if problem.conditions.first() == Some(&Condition::FundamentalAmplitude) {
                say("x(0) = amplitude");
            }
            return [amplitude.clone(), rest];
        }
        if let Some(wall) = &problem.impact
            && let Some(position) = evaluator.value(&wall.position)
        {
            let side = if wall.crossing == Crossing::Rising { -1 } else { 1 };
            say("distance 1 from the wall");
            return [Quantity::Float(position + side), rest];
        }
        say("x(0) = 2");
        [Quantity::from(2), rest]
    }

    /// The period of the force, where there is one.
    fn forcing(
        &self,
        equation: &Expression,
        evaluator: &Evaluator<'_>,
    ) -> Result<Option<Quantity>, Failure> {
        let Ok(Excitation { frequency: Some(frequency), .. }) = Excitation::of(equation) else {
            return Ok(None);
        };
        let Some(omega) = evaluator.value(&frequency) else { return Ok(None) };
        if omega > 0 {
            let pi = Float::with_val(evaluator.bits, rug::float::Constant::Pi);
            return Ok(Some(Quantity::Float(pi * 2u32 / omega)));
        }
        let name = frequency.parameters().join("*");
        Err(Failure {
            exit: NO_ANSWER,
            code: "outside-domain",
            message: format!("{name} is outside its domain > 0"),
            hint: String::new(),
        })
    }

    /// The parameters on which neither the start nor the period of the force depends, nor what
    /// was computed for the history.
    fn sweepable(&self, problem: &Problem, held: &[String]) -> Vec<String> {
        if self.impacting {
            return vec!["A".to_owned(), "B".to_owned()];
        }
        let frequency = Excitation::of(&problem.equation).ok().and_then(|e| e.frequency);
        let frequency = frequency.map_or_else(Vec::new, |e| e.parameters());
        let mut mentioned = problem.equation.parameters();
        mentioned.push(problem.small.to_string());
        if let Some(wall) = &problem.impact {
            mentioned.extend(wall.position.parameters());
            mentioned.extend(wall.restitution.parameters());
        }
        let cards = problem.parameters.iter().map(|card| card.name.to_string());
        let linked = problem.parameters.iter().any(|card| card.name == "n");
        cards
            .filter(|name| {
                let tied = problem.synchronous.as_ref();
                let tied = tied.is_some_and(|t| t.frequency == **name || t.periods == **name);
                let bound = ["amplitude", "pi"].contains(&name.as_str())
                    || (linked && *name == *problem.small);
                let contains = |list: &[String]| list.contains(name);
                contains(&mentioned) && !contains(&frequency) && !contains(held) && !tied && !bound
            })
            .collect()
    }
}

fn unknown_start(problem: &Problem) -> Failure {
    Failure {
        exit: NO_ANSWER,
        code: "no-history",
        message: format!("{}: the history has no value and slope at t = 0", problem.name),
        hint: "give a start with --state".into(),
    }
}

/// n = 1 + 2 delta: whichever is given determines the other.
fn linked(mut given: Given) -> Given {
    let rational = |name: &str| given.get(name).and_then(Value::as_rational).cloned();
    match (rational("n"), rational("delta")) {
        (Some(n), None) => {
            given.insert("delta".into(), Value::Rational((n - 1u32) / 2u32));
        }
        (None, Some(delta)) => {
            given.insert("n".into(), Value::Rational(delta * 2u32 + 1u32));
        }
        _ => {}
    }
    given
}

/// The equation without delay.
fn flying(e: &Expression) -> Expression {
    let inner = |e: &Expression| match e {
        Expression::Delayed(inner, _) => Some((**inner).clone()),
        _ => None,
    };
    e.substitute(&inner).canonical()
}

/// Whether a sign or absolute value has the velocity in its argument: dry friction.
fn rubs(equation: &Expression) -> bool {
    let is_friction = |e: &Expression| match e {
        Expression::Function(Abs | Sign, argument) => argument.contains(&Expression::Velocity),
        _ => false,
    };
    equation.find(&is_friction).is_some()
}

/// The equation for x = a y from that for y.
fn scaled(e: &Expression) -> Expression {
    let over = |e: Expression| e * Expression::parameter("amplitude").pow(-1);
    let list = |l: &[Expression]| l.iter().map(scaled).collect();
    match e {
        Expression::Displacement | Expression::Velocity | Expression::Acceleration => {
            over(e.clone())
        }
        Expression::Sum(l) => Expression::Sum(list(l)),
        Expression::Product(l) => Expression::Product(list(l)),
        Expression::Power(a, b) => Expression::Power(Box::new(scaled(a)), Box::new(scaled(b))),
        Expression::Function(f, a) => scaled(a).apply(*f),
        other => other.clone(),
    }
}
