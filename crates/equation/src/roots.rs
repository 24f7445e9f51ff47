//! Square roots in closed form.

use crate::Expression;
use crate::monomials::expand;
use rug::Rational;
use rug::ops::Pow;
use std::cmp::Ordering;

/// The rational square root of a positive rational number, if it is one.
pub fn rational_root(q: &Rational) -> Option<Rational> {
    let square = q.cmp0() == Ordering::Greater
        && q.numer().is_perfect_square()
        && q.denom().is_perfect_square();
    square.then(|| Rational::from((q.numer().clone().sqrt(), q.denom().clone().sqrt())))
}

/// The highest power of a number that is formed.
const HIGHEST: u32 = 100;

/// The square of a rational multiple of the root of a number, as of 3/2*2^(1/2), where it is rational.
pub(crate) fn rational_square(e: &Expression) -> Option<Rational> {
    let all = expand(e)?;
    let [(monomial, q)] = all.terms.iter().collect::<Vec<_>>()[..] else { return None };
    let root = |(name, power): (&String, &i32)| {
        let Expression::Power(base, n) = all.atoms.get(name)? else { return None };
        let twice: Rational = n.as_number()? * 2 * *power;
        let twice = twice.is_integer().then(|| twice.numer().to_i32())??;
        let twice = Some(twice).filter(|n| n.unsigned_abs() <= HIGHEST)?;
        Some(base.as_number()?.pow(twice))
    };
    monomial.parameters.iter().map(root).try_fold(q.clone().square(), |q, root| Some(q * root?))
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
