//! A problem with values, start, history and forcing, read off its equation.

use super::history::{Evaluator, constant, free_flight};
use super::setup::{Setup, identity, same};
use crate::failure::{Failure, NO_ANSWER};
use crate::session::parameters;
use crate::stability::exact_parameters;
use lindstedt::Exact;
use lindstedt::equation::Function::{Abs, Cos, Sign, Sin};
use lindstedt::equation::{AmplitudeRole, Condition, Crossing, Expression, ParameterCard, Problem};
use lindstedt::expand::Excitation;
use lindstedt::problem_file::{History, ProblemFile};
use lindstedt::problems::stick_slip;
use lindstedt::simulate::{Digits, Model, Parameters, Quantity, Real as _};
use lindstedt::verify::quantities;
use rug::Rational;
use std::collections::BTreeMap;

type Given = BTreeMap<String, Exact>;

/// All parameters of a card: given, or by default; a default that is no number stands for itself.
fn values(cards: &[ParameterCard], given: &Given) -> Vec<(String, Option<Exact>)> {
    let value = |card: &ParameterCard| {
        let value = given.get(&*card.name).cloned();
        (card.name.to_string(), value.or_else(|| Exact::parse(&card.default).ok()))
    };
    cards.iter().map(value).collect()
}

/// A problem that does not start on an impact orbit.
pub struct Case<'a> {
    pub problem: &'a Problem,
    pub file: Option<&'a ProblemFile>,
    /// It is the vibro-impact oscillator.
    pub impacting: bool,
    pub digits: u32,
}

impl Case<'_> {
    pub fn setup(
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
            let text = |(name, value): (String, Option<Exact>)| {
                let card = problem.parameters.iter().find(|card| *card.name == *name);
                let default = || card.map_or_else(String::new, |card| card.default.to_string());
                (name, value.map_or_else(default, |value| value.to_string()))
            };
            at = values(&problem.parameters, &given).into_iter().map(text).collect();
        }
        let history = self.determined(&mut problem, history, &mut bindings);
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
        let force = Excitation::of(&without_phases(&equation)).ok();
        let frequency = force.and_then(|force| force.frequency);
        let forcing = match &frequency {
            Some(frequency) => evaluator.period(frequency)?.map(Quantity::Float),
            None => None,
        };
        let wall = problem.impact.is_some();
        problem.time_domain = None;
        problem.small = small.clone().into();
        problem.equation = equation;
        let mut model = Model::of_problem(&problem)?;
        let (mut held, mut past) = (Vec::new(), None);
        if problem.equation.nodes().any(Expression::is_delayed) {
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
            model = model.with_history(std::slice::from_ref(&expression));
            past = Some(expression);
        } else if history.is_some() {
            remarks.push("history: not used, there is no delay".to_owned());
        }
        let sweepable = self.sweepable(&problem, &held);
        Ok(Setup {
            identity: identity(&problem, past.as_ref()),
            name: problem.name.to_string(),
            model,
            parameters: bindings,
            at,
            start: state,
            forcing,
            frequency: frequency.map(|frequency| (frequency, small)),
            wall,
            linear: !wall && degree(&problem.equation).is_some_and(|degree| degree <= 1),
            sticks: rubs(&problem.equation),
            orbit: None,
            sweepable,
            fixed: Vec::new(),
            ranges: BTreeMap::new(),
            remarks,
        })
    }

    /// Puts in what determines the parameters that have no value of their own because it contains pi.
    fn determined(
        &self,
        problem: &mut Problem,
        history: Option<History>,
        bindings: &mut Parameters,
    ) -> Option<History> {
        let Some(file) = self.file else { return history };
        if !file.determined().is_empty() {
            bindings.set("pi", Exact::PiTimes(Rational::from(1)));
        }
        let value = |e: &Expression| match e {
            Expression::Parameter(name) => file.determined().get(&**name).cloned(),
            _ => None,
        };
        problem.equation = problem.equation.substitute(&value);
        problem.time_domain = problem.time_domain.as_ref().map(|e| e.substitute(&value));
        if let Some(wall) = &mut problem.impact {
            wall.position = wall.position.substitute(&value);
            wall.restitution = wall.restitution.substitute(&value);
        }
        match history {
            Some(History::Expression(e)) => {
                Some(History::Expression(file.put_in(&e).substitute(&value)))
            }
            other => other,
        }
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
                Expression::ACCELERATION + Expression::DISPLACEMENT.apply(Sin)
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

    /// The parameters on which neither the start depends, nor what was computed for the history.
    fn sweepable(&self, problem: &Problem, held: &[String]) -> Vec<String> {
        if self.impacting {
            return vec!["A".to_owned(), "B".to_owned()];
        }
        let mut mentioned = problem.equation.parameters();
        mentioned.push(problem.small.to_string());
        if let Some(wall) = &problem.impact {
            mentioned.extend(wall.position.parameters());
            mentioned.extend(wall.restitution.parameters());
        }
        // A delay that was put in moves with what it follows from.
        let tie = problem.synchronous.as_ref();
        let tie = tie.filter(|tie| mentioned.iter().any(|name| *name == *tie.delay));
        let cards = problem.parameters.iter().map(|card| card.name.to_string());
        let linked = problem.parameters.iter().any(|card| card.name == "n");
        cards
            .filter(|name| {
                let tied = tie.is_some_and(|t| t.frequency == **name || t.periods == **name);
                let bound = ["amplitude", "pi"].contains(&name.as_str())
                    || (linked && *name == *problem.small);
                let contains = |list: &[String]| list.contains(name);
                contains(&mentioned) && !contains(held) && !tied && !bound
            })
            .collect()
    }
}

/// The equation with cos(omega t) for cos(omega t + p) and the same for sin: the period of a force does
/// not depend on its phase.
fn without_phases(e: &Expression) -> Expression {
    let out = |e: Expression| {
        let e = e.canonical();
        e.multiplied_out().unwrap_or(e).canonical()
    };
    let plain = |e: &Expression| {
        let Expression::Function(function @ (Cos | Sin), z) = e else {
            return None;
        };
        let at = |time: i64| {
            z.substitute(&|e| (*e == Expression::Time).then(|| Expression::integer(time)))
        };
        let bend = out(at(2) - 2 * at(1) + at(0));
        if !z.contains(&Expression::Time)
            || bend != Expression::integer(0)
            || z.nodes().any(|e| matches!(e, Expression::Unknown(_)))
        {
            return None;
        }
        Some((out(at(1) - at(0)) * Expression::Time).apply(*function))
    };
    e.map(&plain)
}

/// The degree in x, x', x'' and their delayed values; nothing for what is no polynomial in them.
fn degree(e: &Expression) -> Option<i64> {
    e.fold(&mut |e, below: &[Option<i64>]| match (e, below) {
        (Expression::Unknown(_), _) => Some(1),
        (Expression::Sum(_), list) => list.iter().try_fold(0, |m, d| Some(m.max((*d)?))),
        (Expression::Product(_), list) => list.iter().try_fold(0, |m, d| Some(m + (*d)?)),
        (Expression::Power(_, exponent), [base, of_exponent]) => {
            match ((*base)?, (*of_exponent)?) {
                (0, 0) => Some(0),
                (d, 0) => {
                    let n = exponent.as_number().filter(|n| n.is_integer() && *n >= 0)?;
                    d.checked_mul(n.numer().to_i64()?)
                }
                _ => None,
            }
        }
        (Expression::Function(..) | Expression::Formal(..), [z]) => z.filter(|degree| *degree == 0),
        _ => Some(0),
    })
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
    let rational = |name: &str| given.get(name).and_then(Exact::as_rational).cloned();
    match (rational("n"), rational("delta")) {
        (Some(n), None) => {
            given.insert("delta".into(), Exact::Rational((n - 1u32) / 2u32));
        }
        (None, Some(delta)) => {
            given.insert("n".into(), Exact::Rational(delta * 2u32 + 1u32));
        }
        _ => {}
    }
    given
}

/// The equation without delay.
fn flying(e: &Expression) -> Expression {
    let now = |e: &Expression| match e {
        Expression::Unknown(unknown) => {
            Some(Expression::unknown(unknown.index, unknown.derivative))
        }
        _ => None,
    };
    e.map(&now).canonical()
}

/// Whether a sign or absolute value has the velocity in its argument: dry friction.
fn rubs(equation: &Expression) -> bool {
    let is_friction = |e: &Expression| match e {
        Expression::Function(Abs | Sign, argument) => argument.contains(&Expression::VELOCITY),
        _ => false,
    };
    equation.find(&is_friction).is_some()
}

/// The equation for x = a y from that for y.
fn scaled(e: &Expression) -> Expression {
    let over = |e: Expression| e * Expression::parameter("amplitude").pow(-1);
    let change = |e: &Expression| matches!(e, Expression::Unknown(_)).then(|| over(e.clone()));
    e.substitute(&change)
}
