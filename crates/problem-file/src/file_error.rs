//! What is wrong with a problem file, and where.

use crate::error::{ParseError, ParseErrorKind};
use thiserror::Error;

/// Why an amplitude cannot enter in a way.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RoleReason {
    /// x = a y does not make a term a (a^2)^small times as large.
    #[error("{term} is not x*(x^2)^(small parameter) times a factor without x")]
    Scaling {
        /// The term.
        term: String,
    },
    /// The small parameter is not amplitude and one other parameter together.
    #[error("needs the parameter amplitude and one other that the equation does not mention")]
    Parts,
}

/// What is wrong with a problem file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FileErrorKind {
    /// The text is no TOML of this schema; the message is the TOML reader's.
    #[error("{message}")]
    Toml {
        /// What the TOML reader said.
        message: String,
    },
    /// An equation or expression cannot be read.
    #[error(transparent)]
    Equation(#[from] ParseError),
    /// The file is too large.
    #[error("more than {limit} bytes in a problem file")]
    TooLarge {
        /// The limit.
        limit: u64,
    },
    /// A word that a key does not take.
    #[error("{key} cannot be {found:?}")]
    Word {
        /// The key.
        key: &'static str,
        /// What stands there.
        found: String,
        /// What it takes.
        known: String,
    },
    /// A name that no parameter can have.
    #[error("{name:?} is not a name for a {what}")]
    Name {
        /// The name.
        name: String,
        /// What it should name.
        what: &'static str,
    },
    /// A value that is not exact.
    #[error("cannot read the value {text:?}")]
    Value {
        /// The text.
        text: String,
    },
    /// Two spellings of one name.
    #[error("{name} is declared twice")]
    Twice {
        /// The name.
        name: String,
    },
    /// An amplitude that cannot enter in the way claimed.
    #[error("amplitude = \"{role}\": {reason}")]
    Role {
        /// The way claimed.
        role: String,
        /// Why not.
        reason: RoleReason,
    },
    /// A quantity that the problem does not have.
    #[error("{key} mentions {name}, which is not declared")]
    Undeclared {
        /// The key.
        key: &'static str,
        /// The name.
        name: String,
    },
    /// A wall that depends on more than parameters.
    #[error("{key} of the wall depends on {on}: it is an expression in parameters")]
    Wall {
        /// The key.
        key: &'static str,
        /// `t` or `x`.
        on: &'static str,
    },
    /// x(0) without x'(0), or the other way round.
    #[error("x and velocity belong together")]
    HalfAStart,
    /// A range that cannot be read.
    #[error("{text:?} is no range")]
    Range {
        /// The text.
        text: String,
    },
    /// What determines a parameter cannot do so.
    #[error("follows of {name}: {reason}")]
    Follows {
        /// The name.
        name: String,
        /// Why not.
        reason: String,
    },
    /// As many unknowns as equations are needed.
    #[error("{equations} equations for the unknowns {unknowns}")]
    Unknowns {
        /// The names with primes.
        unknowns: String,
        /// How many equations there are.
        equations: usize,
    },
    /// The small parameter does not occur in the equation.
    #[error("the small parameter {name} does not occur in the equation")]
    NoSmallParameter {
        /// Its name.
        name: String,
    },
}

/// What is wrong with a problem file, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}, column {column}: {kind}")]
pub struct FileError {
    /// What.
    #[source]
    pub kind: FileErrorKind,
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
}

impl FileError {
    /// What would be right.
    pub fn hint(&self) -> String {
        match &self.kind {
            FileErrorKind::Equation(error) => error.hint(),
            FileErrorKind::Word { known, .. } => format!("known: {known}"),
            FileErrorKind::Name { .. } => {
                "letters, digits, `_` (problems: a-z, 0-9, `-`), at most 40, not reserved".into()
            }
            FileErrorKind::Value { .. } => {
                "values are exact: \"3\", \"-1/3\", \"0.1\", \"2.5e-3\", \"pi/4\", \"2*pi/3\""
                    .into()
            }
            FileErrorKind::NoSmallParameter { .. } => {
                "small = \"...\" names it; [orders] can give parameters an order".into()
            }
            FileErrorKind::Follows { .. } => {
                "an expression in parameters with a value and pi, as in \"2*pi*k/omega\"".into()
            }
            FileErrorKind::Wall { on: "t", .. } => {
                "in the frame of a wall at p(t), x = p(t) + y, it stands still at y = 0, and the force has -p'' besides: \
                 A*w^2*sin(w*t) of p = A*sin(w*t)"
                    .into()
            }
            FileErrorKind::HalfAStart => "give both, or a history alone".into(),
            FileErrorKind::Unknowns { .. } => "one equation with x'' for every unknown x".into(),
            FileErrorKind::Range { .. } => "NAME=LO..HI:COUNT, as in \"gamma=1/2..1:100\"".into(),
            FileErrorKind::Undeclared { .. } => "declare it under [parameters]".into(),
            _ => "see `lindstedt problems --show vibro-impact` for a complete file".into(),
        }
    }

    /// Whether a limit of size was exceeded.
    pub fn is_limit(&self) -> bool {
        match &self.kind {
            FileErrorKind::TooLarge { .. } => true,
            FileErrorKind::Equation(e) => matches!(e.kind, ParseErrorKind::TooLarge { .. }),
            _ => false,
        }
    }
}
