//! Steady states at resonance against periodic orbits that are proved without any expansion, and against closed forms.

mod free;
mod irrational;
mod numbers;
mod orbits;
mod starts;
mod sweeps;

use lindstedt::respond::Response;
use lindstedt::{Oscillator, Respond, Work};

fn ask(equation: &str, values: &[(&str, &str)], question: &Respond) -> Response {
    let start = Oscillator::parse(equation).unwrap();
    let set = |case: Oscillator, (name, value): &(&str, &str)| case.set(name, value).unwrap();
    let case = values.iter().fold(start, set);
    case.respond(question, &Work::default()).unwrap().value
}

fn to_order(order: usize) -> Respond {
    Respond { order: Some(order), ..Respond::default() }
}

fn decimals(numbers: &[lindstedt::Number]) -> Vec<f64> {
    numbers.iter().map(|number| number.decimal.parse().unwrap()).collect()
}
