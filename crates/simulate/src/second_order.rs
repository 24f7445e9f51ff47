//! What only equations of second order have: x_1'', x_2'', ... to be solved for, and walls.

use crate::compile::{Compiler, Value};
use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::tape::Op;
use lindstedt_equation::{Crossing, Expression, Impact, Unknown};

/// A factor of x_k''; nothing for zero.
type Factor = Option<Expression>;

/// x_1'', x_2'', ... from equations that are linear in them, by Cramer's rule.
pub(crate) fn accelerations(equations: &[&Expression]) -> Result<Vec<Expression>, SimulateError> {
    let n = equations.len();
    let (mut mass, mut right): (Vec<Vec<Factor>>, Vec<Expression>) = (Vec::new(), Vec::new());
    for equation in equations {
        let (mut row, mut rest) = (Vec::new(), (*equation).clone());
        for k in 0..n {
            let (factor, others) = split_acceleration(&rest, k)?;
            row.push(factor);
            rest = others;
        }
        if contains_acceleration(&rest) {
            return Err(SimulateError::NotSecondOrder);
        }
        mass.push(row);
        right.push(-rest);
    }
    let all: Vec<usize> = (0..n).collect();
    let whole = determinant(&mass, &all, &all).ok_or(SimulateError::NotSecondOrder)?;
    let without = |i: usize| all.iter().copied().filter(|k| *k != i).collect::<Vec<_>>();
    let solved = |k: usize| {
        let parts = right.iter().enumerate().filter_map(|(i, right)| {
            let minor = determinant(&mass, &without(i), &without(k))?;
            let minor = if (i + k).is_multiple_of(2) { minor } else { -minor };
            Some(if is_one(&minor) { right.clone() } else { minor * right.clone() })
        });
        let parts: Vec<Expression> = parts.collect();
        let sum = if let [part] = &parts[..] { part.clone() } else { Expression::Sum(parts) };
        if is_one(&whole) { sum } else { sum * whole.clone().pow(-1) }
    };
    Ok((0..n).map(solved).collect())
}

fn is_one(e: &Expression) -> bool {
    e.as_number().is_some_and(|one| one == 1)
}

/// The determinant of some rows and columns, along the first row; nothing where it is zero by its shape.
fn determinant(matrix: &[Vec<Factor>], rows: &[usize], columns: &[usize]) -> Factor {
    let Some((first, below)) = rows.split_first() else { return Some(Expression::integer(1)) };
    let mut sum = None;
    for (place, column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns.iter().copied().filter(|k| k != column).collect();
        let Some(entry) = &matrix[*first][*column] else { continue };
        let Some(minor) = determinant(matrix, below, &others) else { continue };
        let product = (entry.clone() * minor).canonical();
        let product = if place.is_multiple_of(2) { product } else { -product };
        sum = Some(sum.map_or_else(|| product.clone(), |sum: Expression| sum + product.clone()));
    }
    sum
}

/// expression = factor x_k'' + rest.
fn split_acceleration(
    expression: &Expression,
    k: usize,
) -> Result<(Factor, Expression), SimulateError> {
    let none = |rest: &Expression| Ok((None, rest.clone()));
    let holds = |e: &Expression| e.nodes().any(|e| is_acceleration(e, Some(k)));
    match expression {
        e if is_acceleration(e, Some(k)) => {
            Ok((Some(Expression::integer(1)), Expression::integer(0)))
        }
        Expression::Sum(terms) => {
            let (mut factor, mut rest) = (None, Vec::new());
            for term in terms {
                let (f, r) = split_acceleration(term, k)?;
                rest.push(r);
                factor = match (factor, f) {
                    (Some(a), Some(b)) => Some(a + b),
                    (a, b) => a.or(b),
                };
            }
            Ok((factor, Expression::Sum(rest)))
        }
        Expression::Product(factors) => {
            let Some(place) = factors.iter().position(holds) else {
                return none(expression);
            };
            let mut others = factors.clone();
            let (factor, rest) = split_acceleration(&others.remove(place), k)?;
            if others.iter().any(contains_acceleration) {
                return Err(SimulateError::NotSecondOrder);
            }
            let times =
                |e: Expression| Expression::Product(others.iter().cloned().chain([e]).collect());
            Ok((factor.map(&times), times(rest)))
        }
        other if holds(other) => Err(SimulateError::NotSecondOrder),
        other => none(other),
    }
}

fn contains_acceleration(expression: &Expression) -> bool {
    expression.nodes().any(|e| is_acceleration(e, None))
}

/// x_k'', of any unknown where none is said.
fn is_acceleration(e: &Expression, k: Option<usize>) -> bool {
    matches!(e, Expression::Unknown(Unknown { derivative: 2, index, .. }) if k.is_none_or(|k| k == *index))
}

/// A wall, compiled.
#[derive(Clone, Debug)]
pub(crate) struct Wall<E> {
    /// The row of x - position.
    pub(crate) row: usize,
    pub(crate) position: E,
    pub(crate) restitution: E,
    /// +1: the wall is above, -1: below.
    pub(crate) direction: i8,
}

pub(crate) fn compile_wall<R: Real>(
    compiler: &mut Compiler<'_, R>,
    wall: &Impact,
    second_order: bool,
) -> Result<Wall<R::Element>, SimulateError> {
    let position = compiler.expression(&wall.position)?;
    let restitution = compiler.expression(&wall.restitution)?;
    let (Value::Constant(position), Value::Constant(restitution)) = (position, restitution) else {
        return Err(SimulateError::UnexpectedState);
    };
    if !second_order {
        return Err(SimulateError::NotSecondOrder);
    }
    if !(0..=1).contains(&restitution) {
        return Err(SimulateError::BadRestitution { restitution: restitution.to_f64() });
    }
    let constant = compiler.constant(&position);
    let constant = compiler.push(Op::Constant(constant));
    Ok(Wall {
        row: compiler.push(Op::Subtract(0, constant)),
        position: compiler.real.float(&position),
        restitution: compiler.real.float(&restitution),
        direction: if wall.crossing == Crossing::Rising { 1 } else { -1 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Doubles, Integrator, Model, Parameters, Settings};

    /// 2 x'' + y'' + 3 x = 0 = x'' + 2 y'' + 3 y: x + y = cos t, x - y = cos(sqrt 3 t)/2.
    #[test]
    fn masses_that_couple() -> Result<(), SimulateError> {
        let term = |q: i64, k, n| Expression::integer(q) * Expression::unknown(k, n);
        let equations = [[2, 1, 3, 0], [1, 2, 0, 3]]
            .map(|[a, b, c, d]| term(a, 0, 2) + term(b, 1, 2) + term(c, 0, 0) + term(d, 1, 0));
        let model = Model::of_unknowns(&equations.each_ref())?;
        let system = model.compile(Doubles, &Parameters::new())?;
        let start = [0.75, 0.0, 0.25, 0.0];
        let mut flow = Integrator::new(&system, &0.0, &start, Settings::for_digits(16))?;
        flow.advance(&2.0, &mut |_| std::ops::ControlFlow::Continue(()))?;
        let [x, _, y, _] = flow.state() else { return Err(SimulateError::UnexpectedState) };
        let (sum, difference) = (2f64.cos(), 0.5 * (2.0 * 3f64.sqrt()).cos());
        assert!((x + y - sum).abs() < 1e-13 && (x - y - difference).abs() < 1e-13, "{x} {y}");
        // One of the accelerations is not there.
        let none = Expression::DISPLACEMENT + Expression::unknown(1, 0);
        assert_eq!(
            accelerations(&[&equations[0], &none]).err(),
            Some(SimulateError::NotSecondOrder)
        );
        Ok(())
    }
}
