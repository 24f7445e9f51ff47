//! What only equations of second order have: x'' to be solved for, and walls.

use crate::compile::{Compiler, Value};
use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::tape::Op;
use lindstedt_equation::{Crossing, Expression, Impact, Unknown};

/// expression = factor x'' + rest.
pub(crate) fn split_acceleration(
    expression: &Expression,
) -> Result<(Option<Expression>, Expression), SimulateError> {
    let none = |rest: &Expression| Ok((None, rest.clone()));
    match expression {
        e if is_acceleration(e) => Ok((Some(Expression::integer(1)), Expression::integer(0))),
        Expression::Sum(terms) => {
            let (mut factor, mut rest) = (None, Vec::new());
            for term in terms {
                let (f, r) = split_acceleration(term)?;
                rest.push(r);
                factor = match (factor, f) {
                    (Some(a), Some(b)) => Some(a + b),
                    (a, b) => a.or(b),
                };
            }
            Ok((factor, Expression::Sum(rest)))
        }
        Expression::Product(factors) => {
            let Some(place) = factors.iter().position(contains_acceleration) else {
                return none(expression);
            };
            let mut others = factors.clone();
            let (factor, rest) = split_acceleration(&others.remove(place))?;
            if others.iter().any(contains_acceleration) {
                return Err(SimulateError::NotSecondOrder);
            }
            let times =
                |e: Expression| Expression::Product(others.iter().cloned().chain([e]).collect());
            Ok((factor.map(&times), times(rest)))
        }
        other if contains_acceleration(other) => Err(SimulateError::NotSecondOrder),
        other => none(other),
    }
}

fn contains_acceleration(expression: &Expression) -> bool {
    expression.nodes().any(is_acceleration)
}

fn is_acceleration(e: &Expression) -> bool {
    matches!(e, Expression::Unknown(Unknown { derivative: 2, .. }))
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
