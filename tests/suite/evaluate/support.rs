//! What the tests of evaluation share.

use lindstedt::evaluate::Evaluation;
use lindstedt::unstable::equation::Problem;
use lindstedt::unstable::series::resummation::Method;
use lindstedt::unstable::simulate::{
    Doubles, Integrator, Model, Parameters, Quantity, Settings as Precision, Trajectory as Path,
};
use lindstedt::{Error, Evaluate, Oscillator, ProblemFile, Work, unstable::problems};
use rug::Float;

/// A problem with values.
pub fn valued(problem: &Problem, set: &[(&str, &str)]) -> Oscillator {
    let oscillator = Oscillator::from_problem(problem).unwrap();
    set.iter().fold(oscillator, |oscillator, (name, value)| oscillator.set(name, value).unwrap())
}

pub fn question(order: usize, method: Option<Method>) -> Evaluate {
    Evaluate { order: Some(order), method, ..Evaluate::default() }
}

pub fn evaluate(
    problem: &Problem,
    order: usize,
    method: Option<Method>,
    set: &[(&str, &str)],
) -> Result<Evaluation, Error> {
    let found = valued(problem, set).evaluate(&question(order, method), &Work::default());
    found.map(|answer| answer.value)
}

pub fn run(
    name: &str,
    order: usize,
    method: Option<Method>,
    set: &[(&str, &str)],
) -> Result<Evaluation, Error> {
    evaluate(&problems::find(name).unwrap(), order, method, set)
}

/// |value/exact - 1| of T/2pi without the amplitude, from the raw outcome.
pub fn relative_error(result: &Evaluation, exact: &str) -> f64 {
    let value = &result.resummed.outcome.estimate.value;
    let exact = Float::with_val(300, Float::parse(exact).unwrap());
    let two_pi = Float::with_val(300, rug::float::Constant::Pi) * 2u32;
    let value = Float::with_val(300, value) * two_pi;
    ((value - &exact) / exact).abs().to_f64()
}

/// The same for the estimate of the error.
pub fn relative_estimate(result: &Evaluation, exact: &str) -> f64 {
    let exact = Float::with_val(300, Float::parse(exact).unwrap());
    let two_pi = Float::with_val(300, rug::float::Constant::Pi) * 2u32;
    let estimate = Float::with_val(300, &result.resummed.outcome.estimate.error) * two_pi;
    (estimate / exact).abs().to_f64()
}

pub fn example(name: &str) -> Problem {
    let path = format!("{}/../docs/examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    ProblemFile::parse(&std::fs::read_to_string(path).unwrap()).unwrap().problem
}

/// A problem from an equation and further lines of its file.
pub fn written(equation: &str, lines: &str) -> Problem {
    let text = format!("name = 'test'\nequation = \"{equation}\"\n{lines}");
    ProblemFile::parse(&text).unwrap().problem
}

pub fn quantity(text: &str) -> Quantity {
    Quantity::parse(text).unwrap()
}

/// x at times >= 0 in doubles.
pub fn integrated(
    problem: &Problem,
    set: &[(&str, &str)],
    start: [f64; 2],
    times: &[f64],
) -> Vec<f64> {
    let mut parameters = Parameters::new();
    for card in problem.parameters.iter().filter(|card| card.name != "branch") {
        parameters.set(&card.name, quantity(&card.default));
    }
    for (name, value) in set {
        parameters.set(name, quantity(value));
    }
    let system = Model::of_problem(problem).unwrap().compile(Doubles, &parameters).unwrap();
    let mut flow = Integrator::new(&system, &0.0, &start, Precision::for_digits(16)).unwrap();
    let mut path = Path::new(Doubles);
    let end = times.iter().fold(0.0f64, |top, t| top.max(*t));
    let _ = flow.advance(&end, &mut |report| path.record(report)).unwrap();
    times.iter().map(|t| path.value(0, t).unwrap()).collect()
}
