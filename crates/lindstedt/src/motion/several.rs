//! Several unknowns in the time domain: no walls, no delays, a start of all of them.

use super::Start;
use super::equation::{friction, meaning, values, with_small};
use super::force::frequency;
use super::history::Evaluator;
use super::setup::Setup;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator};
use lindstedt_derivation::check_parameters;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Problem};
use lindstedt_simulate::{Flow, Model, Parameters, Quantity};
use rug::Rational;

const AT_AMPLITUDE: &str = "all at rest at the amplitude";
const AT_A_TENTH: &str = "all at rest at 1/10, nothing else is given";

/// The system x_k'' = ... with its values.
pub(super) fn several(oscillator: &Oscillator, start: &Start) -> Result<Setup, Error> {
    let mut problem = with_small(oscillator.problem());
    check_parameters(&problem, oscillator.given())?;
    let mut parameters = Parameters::of_problem(&problem, oscillator.given());
    if !oscillator.problem_file().determined().is_empty() {
        parameters.set("pi", Exact::PiTimes(1.into()));
    }
    let put_in = |e: &Expression| e.substitute(&|e| meaning(oscillator, e));
    let first = problem.time_domain.take().unwrap_or(problem.equation);
    problem.equation = put_in(&first);
    problem.others = problem.others.iter().map(put_in).collect();
    let delayed = problem.equations().flat_map(Expression::nodes).any(Expression::is_delayed);
    if delayed || start.history.is_some() || start.perturbation.is_some() {
        let message = "several unknowns are integrated from a state, without a delay";
        let hint = "`lindstedt derive` averages a delay of order eps: eps*x(t - T)";
        return Err(Refused::no_answer("several-unknowns", message, hint).into());
    }
    if problem.impact.is_some() {
        let message = "a wall is for one unknown";
        let hint = "a file without [impact]; or one equation";
        return Err(Refused::no_answer("several-unknowns", message, hint).into());
    }
    let small = problem.small.to_string();
    let mut state = state(start, &problem, &parameters)?;
    let chosen = start.state.is_none().then_some(match parameters.get("amplitude") {
        Some(_) => AT_AMPLITUDE,
        None => AT_A_TENTH,
    });
    let others = state.split_off(2);
    let [x, v] = <[Quantity; 2]>::try_from(state).map_err(|_| Error::NoValue)?;
    let equations: Vec<&Expression> = problem.equations().collect();
    let frequency = frequency(&equations, &small);
    let evaluator = Evaluator { parameters: &parameters, small: &small, bits: 256 };
    let period = frequency.as_ref().map(|frequency| evaluator.period(frequency)).transpose()?;
    let mut mentioned: Vec<String> = problem.equations().flat_map(|e| e.parameters()).collect();
    mentioned.push(small.clone());
    let cards = problem.parameters.iter().map(|card| card.name.to_string());
    Ok(Setup {
        name: problem.name.to_string(),
        at: values(&problem, oscillator.given(), None),
        chosen,
        history: None,
        frequency,
        wall: false,
        linear: false,
        orbit: None,
        sweepable: cards.filter(|name| mentioned.contains(name) && name != "amplitude").collect(),
        identity: problem.print(Style::Text),
        remarks: Vec::new(),
        unknowns: (0..=problem.others.len()).map(|k| problem.unknown(k)).collect(),
        flow: Flow {
            model: Model::of_problem(&problem)?,
            parameters,
            start: [x, v],
            others,
            forcing: period.flatten().map(Quantity::Float),
            sticks: equations.iter().any(|e| friction(e).is_some()),
        },
        small,
    })
}

/// The state asked for, x_1, x_1', x_2, x_2', ..., else at rest at the amplitude, else at 1/10.
fn state(
    start: &Start,
    problem: &Problem,
    parameters: &Parameters,
) -> Result<Vec<Quantity>, Error> {
    let states = 2 * problem.equations().count();
    let Some(state) = &start.state else {
        let at =
            parameters.get("amplitude").cloned().unwrap_or_else(|| Rational::from((1, 10)).into());
        return Ok((0..states).map(|k| if k % 2 == 0 { at.clone() } else { 0.into() }).collect());
    };
    if state.len() == states {
        return Ok(state.iter().cloned().map(Quantity::from).collect());
    }
    let names = (0..states / 2).map(|k| problem.unknown(k)).map(|x| format!("{x},{x}'"));
    let names = names.collect::<Vec<_>>().join(",");
    let message = format!("{} values of a state, but there are {states}: {names}", state.len());
    Err(Refused::usage("state", message, format!("--state {names}")).into())
}
