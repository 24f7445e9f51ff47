//! An equation with the values of its parameters, multiplied out.

use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::{MOST_TERMS, Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Problem};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// The symbol that stands for pi in a bound expression: no parameter can have this name.
pub(crate) const PI: &str = "pi";

/// The value of a parameter as an expression.
pub(crate) fn of_value(value: &Exact) -> Expression {
    match value {
        Exact::Rational(q) => Expression::Number(q.clone()),
        Exact::PiTimes(q) => Expression::Number(q.clone()) * Expression::parameter(PI),
        Exact::Root(q) => {
            let root = Expression::Number(Rational::from(q.abs_ref()));
            let root = root.pow(Expression::Number(Rational::from((1, 2))));
            if *q < 0 { -root } else { root }
        }
    }
}

/// The expression with the values of its parameters.
pub(crate) fn bind(e: &Expression, values: &BTreeMap<String, Exact>) -> Expression {
    let value = |e: &Expression| match e {
        Expression::Parameter(name) => values.get(name).map(of_value),
        _ => None,
    };
    e.substitute(&value).canonical()
}

/// The left side of x'' + rest = 0 without x''.
pub(crate) fn rest(problem: &Problem) -> Result<Expression, Refusal> {
    let equation = problem.time_domain.as_ref().unwrap_or(&problem.equation);
    let alone = equation.acceleration_alone().map_err(|_| Refusal::Acceleration)?;
    let terms = alone.terms().iter().filter(|t| **t != Expression::ACCELERATION).cloned();
    Ok(Expression::Sum(terms.collect()).canonical())
}

pub(crate) fn multiply_out(e: &Expression) -> Result<Monomials, Refusal> {
    expand(e).ok_or(Refusal::TooManyTerms { limit: MOST_TERMS })
}

/// Names among `used` that have no value.
pub(crate) fn missing(used: &[String], values: &BTreeMap<String, Exact>) -> Result<(), Refusal> {
    let mut names: Vec<String> = Vec::new();
    for name in used.iter().filter(|name| !values.contains_key(*name)) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    if names.is_empty() { Ok(()) } else { Err(Refusal::MissingValues { names }) }
}

/// The refusal of a term, named as it occurs in the equation without values: the first term there
/// that `fits` refuses and whose coefficient does not vanish at the values.
pub(crate) fn named(
    rest: &Expression,
    values: &BTreeMap<String, Exact>,
    bound: (Expression, Why),
    fits: &dyn Fn(&Monomials, &Monomial) -> Option<Why>,
) -> Refusal {
    let found = expand(rest).and_then(|all| {
        all.terms.iter().find_map(|(monomial, q)| {
            let why = fits(&all, monomial)?;
            let term = all.tree(monomial, q);
            let vanishes = expand(&bind(&term, values)).is_some_and(|e| e.terms.is_empty());
            (!vanishes).then_some((term, why))
        })
    });
    let (term, why) = found.unwrap_or(bound);
    Refusal::Term { term: Box::new(term), why }
}
