//! Equations in the coordinates of their modes.

use super::algebraic::{AlgebraicModes, Entry};
use super::conserved::conserved_energy;
use super::modes::Spectrum;
use super::{Names, ResonanceError};
use lindstedt_equation::{Expression, Unknown};
use rug::Rational;

/// q_j'' + the rest of equation j, with x = P q in it; irrational numbers by their names.
pub(super) fn separated(
    equations: &[Expression],
    modes: &Spectrum,
    algebraic: Option<&AlgebraicModes>,
    names: Names<'_>,
) -> Result<Vec<Expression>, ResonanceError> {
    let without: Vec<Expression> =
        equations.iter().map(|e| without_acceleration(e, names)).collect::<Result<_, _>>()?;
    let without = match algebraic {
        None => without,
        Some(known) => without.iter().zip(&known.stiffness).map(without_stiffness).collect(),
    };
    let named = algebraic.is_some();
    let without: Vec<Expression> = without.iter().map(|e| in_modes(e, modes, named)).collect();
    let equation = |(j, row): (usize, &Vec<Rational>)| {
        let parts = row.iter().enumerate().zip(&without).filter(|((_, q), _)| !q.is_zero());
        let terms = parts
            .map(|((i, q), e)| (factor(q, Entry::Inverse(j, i), named) * e.clone()).canonical());
        let terms = terms.flat_map(|e| e.terms().to_vec());
        let square = algebraic.map(|_| Entry::Square(j).name());
        let square = square.map(|name| Expression::parameter(&name) * Expression::unknown(j, 0));
        let first = [Expression::unknown(j, 2)].into_iter().chain(square);
        Expression::Sum(first.chain(terms).collect())
    };
    Ok(modes.inverse.iter().enumerate().map(equation).collect())
}

/// A number; irrational ones have names, in the place of which their enclosures are put.
fn factor(q: &Rational, entry: Entry, named: bool) -> Expression {
    if named { Expression::parameter(&entry.name()) } else { Expression::Number(q.clone()) }
}

/// With P q in the place of x.
fn in_modes(e: &Expression, modes: &Spectrum, named: bool) -> Expression {
    let shape = |e: &Expression| {
        let (Some(shapes), Expression::Unknown(unknown)) = (&modes.shapes, e) else { return None };
        let mode = |index| Expression::Unknown(Unknown { index, ..unknown.clone() });
        let part =
            |(j, p): (usize, &Rational)| factor(p, Entry::Shape(unknown.index, j), named) * mode(j);
        Some(Expression::Sum(shapes[unknown.index].iter().enumerate().map(part).collect()))
    };
    e.map(&shape)
}

/// The energy that the equations solved for the x_j'' conserve, in irrational modes: names of their numbers would hide that these
/// depend on each other.
pub(super) fn energy(
    equations: &[Expression],
    modes: &Spectrum,
    known: &AlgebraicModes,
    names: Names<'_>,
) -> Result<Option<Expression>, ResonanceError> {
    let inverse = known.mass_inverse.clone();
    let own = Spectrum { squares: Vec::new(), shapes: None, inverse };
    let own = separated(equations, &own, None, names)?;
    Ok(conserved_energy(&own).map(|energy| in_modes(&energy, modes, true)))
}

/// The equation without sum_j k_j x_j at order zero.
fn without_stiffness((equation, row): (&Expression, &Vec<Rational>)) -> Expression {
    let term = |(j, k): (usize, &Rational)| {
        Expression::Number(Rational::from(-k)) * Expression::unknown(j, 0)
    };
    let terms = row.iter().enumerate().map(term);
    let all = Expression::Sum(std::iter::once(equation.clone()).chain(terms).collect());
    all.multiplied_out().unwrap_or(all).canonical()
}

/// The equation without the x_k'', which stand in terms of their own with constant factors.
fn without_acceleration(
    equation: &Expression,
    names: Names<'_>,
) -> Result<Expression, ResonanceError> {
    let accelerated =
        |e: &Expression| matches!(e, Expression::Unknown(Unknown { derivative: 2.., .. }));
    let alone = |term: &Expression| match term {
        Expression::Product(factors) => {
            let (with, others): (Vec<_>, Vec<_>) = factors.iter().partition(|f| accelerated(f));
            with.len() == 1 && others.iter().all(|e| matches!(e, Expression::Number(_)))
        }
        single => accelerated(single),
    };
    let holds = |e: &Expression| e.nodes().any(accelerated);
    let split = |e: &Expression| {
        let (with, rest): (Vec<_>, Vec<_>) = e.terms().iter().cloned().partition(holds);
        match with.iter().find(|term| !alone(term)) {
            None => Ok(Expression::Sum(rest).canonical()),
            Some(term) => Err(ResonanceError::Acceleration { term: names.shown(term) }),
        }
    };
    split(&equation.canonical()).or_else(|error| {
        let all = equation.multiplied_out().ok_or(error)?;
        split(&all)
    })
}
