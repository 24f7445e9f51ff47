//! The expression tree of an equation.

use rug::Rational;
use std::ops::{Add, Mul, Neg, Sub};

/// An expression in displacements, their derivatives, parameters and the small parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// A rational number.
    Number(Rational),
    /// A named parameter.
    Parameter(String),
    /// The small parameter of the expansion.
    Small,
    /// A displacement or one of its derivatives, now or at an earlier time.
    Unknown(Unknown),
    /// The time t.
    Time,
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

/// d^n x_k/dt^n at the time t - T.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// k, from 0: which displacement.
    pub index: usize,
    /// n: 0 the displacement, 1 the velocity, 2 the acceleration.
    pub derivative: u32,
    /// T, a positive expression in parameters; nothing for the value at t.
    pub delay: Option<Box<Expression>>,
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
    /// x, the displacement of an equation with one unknown.
    pub const DISPLACEMENT: Self = Self::unknown(0, 0);
    /// x' = dx/dt.
    pub const VELOCITY: Self = Self::unknown(0, 1);
    /// x'' = d^2x/dt^2.
    pub const ACCELERATION: Self = Self::unknown(0, 2);

    /// d^n x_k/dt^n, k from 0.
    pub const fn unknown(k: usize, n: u32) -> Self {
        Self::Unknown(Unknown { index: k, derivative: n, delay: None })
    }

    /// T of an unknown at the time t - T.
    pub fn delay(&self) -> Option<&Self> {
        match self {
            Self::Unknown(unknown) => unknown.delay.as_deref(),
            _ => None,
        }
    }

    /// Whether this is an unknown at an earlier time.
    pub fn is_delayed(&self) -> bool {
        self.delay().is_some()
    }

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
