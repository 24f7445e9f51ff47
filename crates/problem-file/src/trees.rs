//! What the parser asks of trees and does to them.

use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;
use rug::Rational;

pub(crate) fn multiply(factors: &mut Vec<Expression>, factor: Expression) {
    match factor {
        Expression::Product(inner) => factors.extend(inner),
        single => factors.push(single),
    }
}

/// The canonical form without the number of a product and with its factors and terms in the order
/// of their text: what a term is recognised by.
pub(crate) fn unordered(e: &Expression) -> Expression {
    match e.canonical() {
        Expression::Product(mut factors) => {
            factors.retain(|f| !matches!(f, Expression::Number(_)));
            factors.sort_by_cached_key(|f| f.print("", Style::Text));
            if factors.len() == 1 { factors.remove(0) } else { Expression::Product(factors) }
        }
        Expression::Sum(mut terms) => {
            terms.sort_by_cached_key(|t| t.print("", Style::Text));
            Expression::Sum(terms)
        }
        other => other,
    }
}

/// -e, with the sign in a number in front.
pub(crate) fn negated(e: Expression) -> Expression {
    match e {
        Expression::Product(mut factors) => {
            let more = factors.len() > 1;
            match factors.first_mut() {
                Some(Expression::Number(q)) if *q == -1 && more => {
                    factors.remove(0);
                    if factors.len() == 1 {
                        return factors.remove(0);
                    }
                }
                Some(Expression::Number(q)) => *q = Rational::from(-&*q),
                _ => factors.insert(0, Expression::integer(-1)),
            }
            Expression::Product(factors)
        }
        other => -other,
    }
}

/// A bound on the degree in x and x' and in what depends on them, with whole exponents only.
pub(crate) fn degree(e: &Expression) -> f64 {
    e.fold(&mut |e, below: &[f64]| match (e, below) {
        (Expression::Number(_) | Expression::Parameter(_) | Expression::Time, _) => 0.0,
        (Expression::Sum(_), below) => below.iter().copied().fold(0.0, f64::max),
        (Expression::Product(_), below) => below.iter().sum(),
        (Expression::Power(_, exponent), [base, _]) => {
            base * exponent.as_number().map_or(1.0, |q| q.to_f64().abs())
        }
        _ => 1.0,
    })
}
