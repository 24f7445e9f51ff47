//! Coefficients of Taylor series about zero, up to z^order.

use crate::Function;
use rug::Rational;

/// Of exp, sin and cos; nothing for a function that is not analytic at zero.
///
/// ```
/// use lindstedt_equation::{Function, taylor};
/// assert_eq!(taylor::of_function(Function::Cos, 2), Some(vec![1.into(), 0.into(), (-1, 2).into()]));
/// ```
#[must_use]
pub fn of_function(function: Function, order: usize) -> Option<Vec<Rational>> {
    match function {
        Function::Exp => Some((0..=order).map(factorial_inverse).collect()),
        Function::Sin => Some(parity(order, 1, -1)),
        Function::Cos => Some(parity(order, 0, -1)),
        _ => None,
    }
}

fn factorial_inverse(n: usize) -> Rational {
    (1..=n).fold(Rational::from(1), |product, k| product / Rational::from(k))
}

/// The part of exp z of one parity, with (sign)^k on its k-th term: sin, cos, sinh, cosh.
#[must_use]
pub fn parity(order: usize, parity: usize, sign: i32) -> Vec<Rational> {
    let coefficient = |n: usize| match (n % 2 == parity, sign < 0 && n % 4 > 1) {
        (false, _) => Rational::new(),
        (true, false) => factorial_inverse(n),
        (true, true) => -factorial_inverse(n),
    };
    (0..=order).map(coefficient).collect()
}

/// Of (1 + z)^q.
#[must_use]
pub fn binomial(q: &Rational, order: usize) -> Vec<Rational> {
    let mut list = vec![Rational::from(1)];
    for n in 1..=order {
        let factor = (q - Rational::from(n) + 1u32) / Rational::from(n);
        let next = list.last().map(|c| Rational::from(c * &factor));
        list.extend(next);
    }
    list
}
