//! Square roots in closed form.

use crate::Expression;
use rug::Rational;
use std::cmp::Ordering;

/// The rational square root of a positive rational number, if it is one.
pub fn rational_root(q: &Rational) -> Option<Rational> {
    let square = q.cmp0() == Ordering::Greater
        && q.numer().is_perfect_square()
        && q.denom().is_perfect_square();
    square.then(|| Rational::from((q.numer().clone().sqrt(), q.denom().clone().sqrt())))
}

/// sqrt(kappa), in closed form where kappa is a square.
pub(crate) fn root(kappa: &Expression) -> Expression {
    let half = Expression::Number(Rational::from((1, 2)));
    let plain = || kappa.clone().pow(half.clone());
    match kappa {
        Expression::Number(q) => rational_root(q).map_or_else(plain, Expression::Number),
        Expression::Power(base, n) if n.as_number().is_some_and(|n| n == 2) => (**base).clone(),
        _ => plain(),
    }
}
