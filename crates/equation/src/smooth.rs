//! Powers of |x| as powers of x^2: identities that turn non-smooth notation into what the
//! Lobachevsky ring contains.

use crate::{Expression, Function};
use rug::Rational;

impl Expression {
    /// The same expression with |x|^q as (x^2)^(q/2) and sign(x) |x|^q as x (x^2)^((q - 1)/2), the
    /// latter equal for x other than zero and in the limit for q > 0. Other uses of abs and sign
    /// stay.
    ///
    /// ```
    /// use lindstedt_equation::{Expression, Function};
    /// let x = || Expression::DISPLACEMENT;
    /// let force = x().apply(Function::Sign) * x().apply(Function::Abs).pow(3);
    /// assert_eq!(force.smooth_powers(), x() * x().pow(2));
    /// ```
    #[must_use]
    pub fn smooth_powers(&self) -> Self {
        if !self.nodes().any(|e| matches!(e, Self::Function(Function::Abs, _))) {
            return self.clone();
        }
        self.map(&|e| match e {
            Self::Product(factors) => product(factors),
            Self::Power(..) => absolute_power(e).and_then(|q| square_to(&q, None)),
            // |x| alone has no form in x^2 that a ring contains.
            Self::Function(Function::Abs, _) => Some(e.clone()),
            _ => None,
        })
    }
}

/// q of |x|^q.
fn absolute_power(e: &Expression) -> Option<Expression> {
    let is_absolute = |e: &Expression| *e == Expression::DISPLACEMENT.apply(Function::Abs);
    match e {
        e if is_absolute(e) => Some(Expression::integer(1)),
        Expression::Power(base, exponent) if is_absolute(base) => Some((**exponent).clone()),
        _ => None,
    }
}

/// (x^2)^((q - less)/2); nothing when that is no integer but a number, which no ring contains.
fn square_to(q: &Expression, less: Option<i64>) -> Option<Expression> {
    let half = Rational::from((1, 2));
    let mut terms: Vec<Expression> = q.canonical().terms().to_vec();
    terms.extend(less.map(|n| Expression::integer(-n)));
    let halved = terms.into_iter().map(|t| Expression::Number(half.clone()) * t);
    let exponent = Expression::Sum(halved.collect()).canonical();
    let square = Expression::DISPLACEMENT.pow(2);
    match exponent {
        Expression::Number(n) if !n.is_integer() => None,
        Expression::Number(n) if n.is_zero() => Some(Expression::integer(1)),
        Expression::Number(n) if n == 1 => Some(square),
        exponent => Some(square.pow(exponent)),
    }
}

/// A product with sign(x) and powers of |x|; nothing for another one.
fn product(factors: &[Expression]) -> Option<Expression> {
    let sign = Expression::DISPLACEMENT.apply(Function::Sign);
    let signs = factors.iter().filter(|f| **f == sign).count();
    let powers: Vec<Expression> = factors.iter().filter_map(absolute_power).collect();
    let q = Expression::Sum(powers.clone());
    let square = match (powers.len(), signs) {
        (0, _) => None,
        (_, 0) => square_to(&q, None),
        (_, 1) => square_to(&q, Some(1)),
        _ => None,
    };
    let square = square?;
    let others = factors.iter().filter(|f| **f != sign && absolute_power(f).is_none());
    let mut list: Vec<Expression> = others.map(Expression::smooth_powers).collect();
    list.extend((signs == 1).then_some(Expression::DISPLACEMENT));
    list.push(square);
    Some(Expression::Product(list).canonical())
}
