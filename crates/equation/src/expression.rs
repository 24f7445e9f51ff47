//! The expression tree of an equation.

use rug::Rational;
use std::ops::{Add, Mul, Neg, Sub};

/// An expression in the displacement x, its derivatives, parameters and the small parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A rational number.
    Number(Rational),
    /// A named parameter.
    Parameter(String),
    /// The small parameter of the expansion.
    Small,
    /// x.
    Displacement,
    /// x' = dx/dt.
    Velocity,
    /// x'' = d^2x/dt^2.
    Acceleration,
    /// The time t.
    Time,
    /// An expression in x and x' (first) at the earlier time t - T; T (second) is a positive
    /// expression in parameters.
    Delayed(Box<Expression>, Box<Expression>),
    /// A sum.
    Sum(Vec<Expression>),
    /// A product.
    Product(Vec<Expression>),
    /// base^exponent. For exponents that are no integers the base must be positive: write
    /// x (x^2)^delta, not x^(1+2 delta).
    Power(Box<Expression>, Box<Expression>),
    /// An elementary function.
    Function(Function, Box<Expression>),
    /// F(z) = sum_n F_n z^n/n! with formal coefficients F_n (the pendulum's S_n).
    Formal(String, Box<Expression>),
}

/// The elementary functions of an expression tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// The natural logarithm (of a positive argument).
    Ln,
    /// The exponential function.
    Exp,
    /// The sine.
    Sin,
    /// The cosine.
    Cos,
    /// The absolute value.
    Abs,
    /// The sign; between -1 and 1 at zero (Filippov's convention).
    Sign,
}

impl Expression {
    /// An integer.
    pub fn integer(n: i64) -> Self {
        Self::Number(Rational::from(n))
    }

    /// A named parameter.
    pub fn parameter(name: &str) -> Self {
        Self::Parameter(name.to_owned())
    }

    /// self^exponent.
    #[must_use]
    pub fn pow(self, exponent: impl Into<Self>) -> Self {
        Self::Power(Box::new(self), Box::new(exponent.into()))
    }

    /// ln self.
    #[must_use]
    pub fn ln(self) -> Self {
        Self::Function(Function::Ln, Box::new(self))
    }

    /// F(self) for an elementary function F.
    #[must_use]
    pub fn apply(self, function: Function) -> Self {
        Self::Function(function, Box::new(self))
    }

    /// self at the time t - delay.
    #[must_use]
    pub fn delayed(self, delay: impl Into<Self>) -> Self {
        Self::Delayed(Box::new(self), Box::new(delay.into()))
    }

    /// F(self) for a formal function F.
    #[must_use]
    pub fn formal(self, name: &str) -> Self {
        Self::Formal(name.to_owned(), Box::new(self))
    }
}

impl From<i64> for Expression {
    fn from(n: i64) -> Self {
        Self::integer(n)
    }
}

impl<T: Into<Expression>> Add<T> for Expression {
    type Output = Self;
    fn add(self, other: T) -> Self {
        let mut terms = match self {
            Self::Sum(terms) => terms,
            single => vec![single],
        };
        match other.into() {
            Self::Sum(more) => terms.extend(more),
            single => terms.push(single),
        }
        Self::Sum(terms)
    }
}

impl<T: Into<Expression>> Sub<T> for Expression {
    type Output = Self;
    fn sub(self, other: T) -> Self {
        self + -other.into()
    }
}

impl<T: Into<Expression>> Mul<T> for Expression {
    type Output = Self;
    fn mul(self, other: T) -> Self {
        let mut factors = match self {
            Self::Product(factors) => factors,
            single => vec![single],
        };
        match other.into() {
            Self::Product(more) => factors.extend(more),
            single => factors.push(single),
        }
        Self::Product(factors)
    }
}

impl Neg for Expression {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Self::Number(n) => Self::Number(-n),
            other => Self::integer(-1) * other,
        }
    }
}

impl Mul<Expression> for i64 {
    type Output = Expression;
    fn mul(self, other: Expression) -> Expression {
        Expression::integer(self) * other
    }
}

impl Sub<Expression> for i64 {
    type Output = Expression;
    fn sub(self, other: Expression) -> Expression {
        Expression::integer(self) - other
    }
}
