//! Taylor polynomials, only where they are asked for.

use crate::error::{ParseErrorKind, excerpt};
use lindstedt_equation::print::Style;
use lindstedt_equation::taylor::{binomial, of_function, parity};
use lindstedt_equation::{Expression, Function};
use rug::Rational;

/// The Taylor polynomial of f at zero in powers of its argument z, up to z^order: f is named for
/// functions that no tree has, otherwise `expression` is f(z), ln(1 + z) or (1 + z)^q.
pub(crate) fn taylor(
    name: Option<&str>,
    expression: &Expression,
    order: usize,
) -> Result<Expression, ParseErrorKind> {
    let show = |e: &Expression| excerpt(&e.print("eps", Style::Text));
    let unknown = || ParseErrorKind::NoTaylor { function: show(expression) };
    let (coefficients, argument) = match (name, expression) {
        (Some(name), argument) => {
            let no = || ParseErrorKind::NoTaylor { function: excerpt(name) };
            (named(name, order).ok_or_else(no)?, argument.clone())
        }
        (None, Expression::Function(Function::Ln, z)) => {
            let log = |n: usize| match n {
                0 => Rational::new(),
                n => Rational::from((if n % 2 == 1 { 1 } else { -1 }, n)),
            };
            ((0..=order).map(log).collect(), without_one(z).ok_or_else(unknown)?)
        }
        (None, Expression::Function(function, z)) => {
            (of_function(*function, order).ok_or_else(unknown)?, (**z).clone())
        }
        (None, Expression::Power(base, exponent)) => {
            let q = exponent.as_number().ok_or_else(unknown)?;
            (binomial(&q, order), without_one(base).ok_or_else(unknown)?)
        }
        // 1/(1 + z), as a product with one factor.
        (None, Expression::Product(factors)) => match &factors[..] {
            [number, power] if number.as_number().is_some_and(|q| q == 1) => {
                return taylor(None, power, order);
            }
            _ => return Err(unknown()),
        },
        _ => return Err(unknown()),
    };
    if !vanishes_at_rest(&argument) {
        return Err(ParseErrorKind::TaylorArgument { argument: show(&argument) });
    }
    let term = |(n, c): (usize, &Rational)| match n {
        0 => Expression::Number(c.clone()),
        1 => Expression::Number(c.clone()) * argument.clone(),
        n => Expression::Number(c.clone()) * argument.clone().pow(n as i64),
    };
    let nonzero = coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero());
    Ok(Expression::Sum(nonzero.map(term).collect()).canonical())
}

/// z of 1 + z.
fn without_one(e: &Expression) -> Option<Expression> {
    let mut terms = e.terms().to_vec();
    let one = terms.iter().position(|t| *t == Expression::integer(1))?;
    terms.remove(one);
    Some(Expression::Sum(terms).canonical())
}

/// Whether the expression is zero at x = x' = 0, decided from its form: every term has a factor
/// that vanishes.
fn vanishes_at_rest(e: &Expression) -> bool {
    e.fold(&mut |e, below: &[bool]| match e {
        Expression::Unknown(_) | Expression::Small => true,
        Expression::Sum(_) => below.iter().all(|vanishes| *vanishes),
        Expression::Product(_) => below.iter().any(|vanishes| *vanishes),
        Expression::Power(_, exponent) => below[0] && exponent.as_number().is_some_and(|q| q > 0),
        Expression::Function(Function::Sin | Function::Abs, _) => below[0],
        _ => false,
    })
}

/// Functions that are known only by their polynomials.
fn named(name: &str, order: usize) -> Option<Vec<Rational>> {
    let arc = |n: usize| match (n % 2, n % 4) {
        (0, _) => Rational::new(),
        (_, 1) => Rational::from((1, n)),
        _ => Rational::from((-1, n)),
    };
    Some(match name {
        "sinh" => parity(order, 1, 1),
        "cosh" => parity(order, 0, 1),
        "tan" => quotient(&parity(order, 1, -1), &parity(order, 0, -1)),
        "tanh" => quotient(&parity(order, 1, 1), &parity(order, 0, 1)),
        "atan" | "arctan" => (0..=order).map(arc).collect(),
        _ => return None,
    })
}

/// a/b for b_0 = 1: c_n = a_n - sum_{k=1}^{n} b_k c_{n-k}.
fn quotient(a: &[Rational], b: &[Rational]) -> Vec<Rational> {
    let mut list: Vec<Rational> = Vec::new();
    for (n, a) in a.iter().enumerate() {
        let known = b.iter().skip(1).zip(list.iter().rev());
        let sum = known.map(|(b, c)| Rational::from(b * c)).fold(Rational::new(), |s, t| s + t);
        list.push(a - sum);
        debug_assert_eq!(list.len(), n + 1);
    }
    list
}
