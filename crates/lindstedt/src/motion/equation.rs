//! The equation for x itself: the values of its parameters, what determines the others, and what kind of
//! equation it is.

use super::Branch;
use super::history::at_time;
use crate::{Exact, Oscillator};
use lindstedt_equation::Function::{Abs, Cos, Sign, Sin};
use lindstedt_equation::monomials::expand;
use lindstedt_equation::{AmplitudeRole, Expression, ParameterCard, Problem};
use lindstedt_simulate::{Parameters, Quantity};
use rug::Rational;
use std::collections::BTreeMap;

/// The problem with a card of its small parameter: without a value it is one.
pub(super) fn with_small(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    let known = problem.parameters.iter().any(|card| card.name == problem.small);
    if problem.amplitude != AmplitudeRole::InSmallParameter && !known {
        let (name, meaning) = (problem.small.clone(), "small parameter".into());
        problem.parameters.push(ParameterCard { name, meaning, default: "1".into() });
    }
    problem
}

/// n = 1 + 2 delta, where a problem has both: whichever is given determines the other.
pub(super) fn linked(
    problem: &Problem,
    mut given: BTreeMap<String, Exact>,
) -> BTreeMap<String, Exact> {
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
pub(super) fn values(
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
pub(crate) fn meaning(oscillator: &Oscillator, e: &Expression) -> Option<Expression> {
    match e {
        Expression::Parameter(name) => oscillator.problem_file().determined().get(&**name).cloned(),
        _ => None,
    }
}

/// The equation for x itself, and the name of its small parameter, with what determines parameters
/// put in, there and in the wall.
pub(super) fn determined(
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
/// does not depend on its phase. The small parameter stands by its name, so that a rate may contain it.
pub(super) fn without_phases(e: &Expression, small: &str) -> Expression {
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
    let named = |e: &Expression| match e {
        Expression::Small => Some(Expression::parameter(small)),
        _ => None,
    };
    e.map(&named).map(&plain)
}

fn is_state(e: &Expression) -> bool {
    matches!(e, Expression::Unknown(_))
}

/// Whether the equation is linear in x, x', x'' and their delayed values.
pub(super) fn is_linear(equation: &Expression) -> bool {
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

/// The argument of a sign or absolute value that has a velocity in it: dry friction.
pub(super) fn friction(equation: &Expression) -> Option<&Expression> {
    let moves = |e: &Expression| matches!(e, Expression::Unknown(x) if x.derivative == 1);
    let is_friction = |e: &Expression| match e {
        Expression::Function(Abs | Sign, argument) => argument.find(&moves).is_some(),
        _ => false,
    };
    match equation.find(&is_friction)? {
        Expression::Function(_, argument) => Some(&**argument),
        _ => None,
    }
}
