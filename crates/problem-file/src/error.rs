//! What is wrong with an equation or a file, where, and what would be right.

use std::fmt::{Display, Formatter};
use std::ops::Range;
use thiserror::Error;

/// What the parser expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Expectation {
    /// A number, a name, a function or an opening parenthesis.
    Operand,
    /// An operator or the end.
    Operator,
    /// A closing parenthesis, bracket or bar.
    Closing(char),
    /// A comma.
    Comma,
    /// A whole number between 1 and 99.
    Order,
    /// The word `to`.
    To,
    /// A parenthesis after the name of a function.
    Parenthesis,
}

impl Display for Expectation {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Operand => write!(f, "a number, a name or a parenthesis"),
            Self::Operator => write!(f, "an operator or the end"),
            Self::Closing(c) => write!(f, "`{c}`"),
            Self::Comma => write!(f, "a comma"),
            Self::Order => write!(f, "a whole number from 1 to 99"),
            Self::To => write!(f, "`to`"),
            Self::Parenthesis => write!(f, "`(`"),
        }
    }
}

/// A limit of the parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// Bytes of an equation.
    Length,
    /// Parentheses and powers inside each other.
    Depth,
    /// The size of a whole exponent, or the degree it leads to.
    Exponent,
    /// Digits of a number, or its exponent of ten.
    Digits,
}

impl Display for Limit {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Length => "bytes in an equation",
            Self::Depth => "parentheses or powers inside each other",
            Self::Exponent => "as an exponent",
            Self::Digits => "digits of a number",
        })
    }
}

/// What is wrong with an equation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ParseErrorKind {
    /// Something else was expected.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What.
        expected: Expectation,
        /// What stands there.
        found: String,
    },
    /// A character that no equation has.
    #[error("{character:?} has no meaning in an equation")]
    Character {
        /// The character.
        character: char,
    },
    /// A name that is not declared.
    #[error("the name {name} is not declared")]
    UnknownName {
        /// The name.
        name: String,
        /// A declared name that is spelled alike.
        nearest: Option<String>,
    },
    /// A function that is not taken.
    #[error("the function {name} is not taken")]
    UnknownFunction {
        /// The function.
        name: String,
        /// What to write instead.
        instead: &'static str,
    },
    /// Two readings are possible.
    #[error("{found} has two readings")]
    Ambiguous {
        /// What stands there.
        found: String,
        /// What to write instead.
        instead: String,
    },
    /// Something inside x( ) that is not an earlier time.
    #[error("{found} is not x at an earlier time")]
    NotADelay {
        /// What stands there.
        found: String,
    },
    /// x with more than two primes.
    #[error("a derivative of order {order}")]
    Derivative {
        /// The order.
        order: usize,
    },
    /// A derivative of something other than x.
    #[error("{name} is no function of time, so it has no derivative")]
    NotDifferentiable {
        /// The name.
        name: String,
    },
    /// A division by zero, or 0^(-n).
    #[error("a division by zero")]
    DivisionByZero,
    /// A second sign of equality.
    #[error("a second `=`")]
    SecondEquality,
    /// Something larger than the parser takes.
    #[error("more than {limit} {what}")]
    TooLarge {
        /// What there is too much of.
        what: Limit,
        /// The limit.
        limit: u64,
    },
    /// x stands in a history.
    #[error("a history is an expression in t, without x")]
    StateInHistory,
    /// Neither x'' nor x' occurs.
    #[error("neither x'' nor x' occurs, so the equation is no differential equation")]
    NoDerivative,
    /// x' does not occur linearly with a constant factor in an equation without x''.
    #[error("x' inside {term}: without x'' it must stand alone or with a constant factor")]
    VelocityInside {
        /// The term.
        term: String,
    },
    /// x'' does not occur linearly with a constant factor.
    #[error("x'' inside {term}: it must stand alone or with a constant factor")]
    AccelerationInside {
        /// The term.
        term: String,
        /// The Taylor polynomial of one over the factor of x'', where it has one.
        inverse: Option<String>,
    },
    /// A Taylor polynomial that is not known.
    #[error("no Taylor polynomial of {function} is known")]
    NoTaylor {
        /// The function.
        function: String,
    },
    /// The argument of a Taylor polynomial does not vanish at rest.
    #[error("{argument} does not vanish with x, x' and the small parameter")]
    TaylorArgument {
        /// The argument.
        argument: String,
    },
}

/// What is wrong with an equation, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{kind}")]
pub struct ParseError {
    /// What.
    pub kind: ParseErrorKind,
    /// The bytes of the text that it is about.
    pub at: Range<usize>,
}

impl ParseError {
    pub(crate) fn new(kind: ParseErrorKind, at: Range<usize>) -> Self {
        Self { kind, at }
    }

    /// What would be right.
    pub fn hint(&self) -> String {
        use ParseErrorKind as K;
        match &self.kind {
            K::Expected { expected: Expectation::Operand, .. } => {
                "for example x'' + x + eps*x^3 = 0".into()
            }
            K::Expected { expected: Expectation::Operator, found } if found.starts_with('`') => {
                "a product of two numbers or of a name and a number needs `*`".into()
            }
            K::Expected { expected: Expectation::Closing(_), .. } => "close what was opened".into(),
            K::Expected { expected: Expectation::Parenthesis, .. } => {
                "write sin(x), sin(omega*t), sin(x)^2".into()
            }
            K::Expected {
                expected: Expectation::Order | Expectation::To | Expectation::Comma,
                ..
            } => "write taylor(sin(x), 9)".into(),
            K::Expected { .. } => "write products with `*` where in doubt".into(),
            K::Character { character: ':' | ';' } => "one equation, in one line".into(),
            K::Character { .. } => "operators are + - * / ^ ( ) [ ] | =".into(),
            K::UnknownName { nearest: Some(nearest), .. } => format!("did you mean {nearest}?"),
            K::UnknownName { name, .. } if name == "pi" => {
                "pi stands in values and in what determines a parameter: w = { value = \"3*pi\" }, \
                 w = { follows = \"2*pi*f\" }"
                    .into()
            }
            K::UnknownName { name, .. } => {
                let name: String = name.chars().take(20).collect();
                format!("declare it: [parameters] {name} = {{ value = \"1\" }}; products need `*`")
            }
            K::UnknownFunction { instead, .. } => format!("what would work: {instead}"),
            K::Ambiguous { instead, .. } => format!("write {instead}"),
            K::NotADelay { .. } => "write x(t - T) for a delay, x*(...) for a product".into(),
            K::Derivative { .. } => "equations are of second order: x, x', x''".into(),
            K::NotDifferentiable { .. } => "primes belong to x: x', x''".into(),
            K::DivisionByZero => String::new(),
            K::SecondEquality => "one equation for one unknown x".into(),
            K::TooLarge { what: Limit::Exponent, .. } => {
                "a power as steep as this is a different problem".into()
            }
            K::TooLarge { .. } => String::new(),
            K::StateInHistory => "for example cos(2*t); or constant, or free-flight".into(),
            K::NoDerivative => {
                "for example x'' + x + eps*x^3 = 0, or x' + alpha*x(t - 1)*(1 + x) = 0".into()
            }
            K::VelocityInside { .. } => "divide the equation by the factor of x'".into(),
            K::AccelerationInside { inverse: Some(inverse), .. } => {
                format!("divide the equation by the factor of x'': its other terms times {inverse}")
            }
            K::AccelerationInside { .. } => {
                "divide the equation by the factor of x''; `lindstedt simulate` takes the quotient, an expansion \
                 taylor(1/(1 + z), 9) where z vanishes with x, x' and the small parameter"
                    .into()
            }
            K::NoTaylor { .. } => {
                "known: sin, cos, tan, exp, sinh, cosh, tanh, atan, ln(1 + z), (1 + z)^q".into()
            }
            K::TaylorArgument { .. } => "the polynomial is about zero".into(),
        }
    }
}

/// Line and column, from 1, of a byte of a text; columns count characters.
///
/// ```
/// assert_eq!(lindstedt_problem_file::position("a\nbc", 3), (2, 2));
/// ```
pub fn position(text: &str, offset: usize) -> (usize, usize) {
    let mut end = offset.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let before = &text[..end];
    let line = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line..].chars().count() + 1)
}

/// A piece of text for a message: at most 40 characters in one line.
pub(crate) fn excerpt(text: &str) -> String {
    let mut shown: String =
        text.chars().take(40).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    shown
}
