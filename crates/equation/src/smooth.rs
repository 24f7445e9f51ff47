//! Identities that turn notation into what a ring contains: powers of |x| as powers of x^2, and terms divided by the
//! small parameter that have it as a factor.

use crate::monomials::{Monomial, expand};
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

    /// The same expression without the divisors small^n that its terms have as a factor once they are multiplied out, as
    /// in the pendulum of x/small. What does not cancel stays.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let y = || Expression::Small * Expression::DISPLACEMENT;
    /// let force = (y() - y().pow(3)) * Expression::Small.pow(-1);
    /// assert_eq!(
    ///     force.without_small_divisors().multiplied_out(),
    ///     (Expression::DISPLACEMENT - Expression::Small.pow(2) * Expression::DISPLACEMENT.pow(3)).multiplied_out(),
    /// );
    /// ```
    #[must_use]
    pub fn without_small_divisors(&self) -> Self {
        if !self.nodes().any(|e| small_divisor(e).is_some()) {
            return self.clone();
        }
        self.map(&|e| match e {
            Self::Product(factors) => divided(factors),
            _ => None,
        })
    }
}

/// n of small^(-n).
pub(crate) fn small_divisor(e: &Expression) -> Option<u32> {
    small_power(e).filter(|n| *n < 0).map(i32::unsigned_abs)
}

/// n of small^n, also where it is written as the power of a power.
fn small_power(e: &Expression) -> Option<i32> {
    match e {
        Expression::Small => Some(1),
        Expression::Power(base, exponent) => {
            let n = exponent.as_number().filter(Rational::is_integer)?;
            small_power(base)?.checked_mul(n.numer().to_i32()?)
        }
        _ => None,
    }
}

/// A product with small^(-n), every term of which has small^n as a factor; nothing for another one.
fn divided(factors: &[Expression]) -> Option<Expression> {
    let divisors = factors.iter().filter_map(small_divisor);
    let n = divisors.fold(0, u32::saturating_add);
    let others = factors.iter().filter(|e| small_divisor(e).is_none());
    let all = expand(&Expression::Product(others.cloned().collect())).filter(|_| n > 0)?;
    let quotient = |(monomial, q)| {
        let mut monomial: Monomial = Monomial::clone(monomial);
        monomial.order = monomial.order.checked_sub(n)?;
        Some(all.tree(&monomial, q))
    };
    let terms: Option<Vec<_>> = all.terms.iter().map(quotient).collect();
    Some(Expression::Sum(terms?).canonical())
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
