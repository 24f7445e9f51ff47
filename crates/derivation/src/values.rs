//! The values of parameters: those given, else those of the cards.

use lindstedt_equation::Problem;
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// The value of a parameter: the one given, else that of its card. What is no number ("+") is no
/// quantity.
#[must_use]
pub fn value(problem: &Problem, given: &BTreeMap<String, Exact>, name: &str) -> Option<Exact> {
    let card = || problem.parameters.iter().find(|card| card.name == name);
    given.get(name).cloned().or_else(|| Exact::parse(&card()?.default).ok())
}

/// The values given, and those of the other cards.
#[must_use]
pub fn all_values(problem: &Problem, given: &BTreeMap<String, Exact>) -> BTreeMap<String, Exact> {
    let names = problem.parameters.iter().map(|card| card.name.to_string());
    let cards = names.filter_map(|name| Some((name.clone(), value(problem, given, &name)?)));
    cards.chain(given.clone()).collect()
}

/// The rational values of the parameters that the problem has a card of.
#[must_use]
pub fn known_values(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
) -> BTreeMap<String, Rational> {
    let rational = |name: &str| value(problem, given, name)?.as_rational().cloned();
    let names = problem.parameters.iter().map(|card| card.name.to_string());
    names.filter_map(|name| Some((name.clone(), rational(&name)?))).collect()
}
