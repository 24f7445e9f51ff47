//! What every verb answers with.

use lindstedt_number::as_map;
use serde::Serialize;

/// The version of the JSON form; it grows when a key changes its meaning.
pub const SCHEMA: u32 = 1;

/// What an answer belongs to, in the same words for all verbs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Header {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The name of the problem.
    pub problem: String,
    /// Its equation, `... = 0`, as a problem file has it.
    pub equation: String,
    /// The values that enter, exact, in the order of the problem.
    #[serde(serialize_with = "as_map")]
    pub at: Vec<(String, String)>,
    /// The order of the expansion; nothing where none is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// How numbers were computed: `exact`, `collocation`, `fourier`, `doubles`, ...
    pub tier: &'static str,
    /// Wall-clock seconds of the question.
    pub seconds: f64,
}

/// How far an answer goes; one exit code each on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// All that was asked for.
    Complete,
    /// Stopped; so many parts are finished and stand in the answer.
    Stopped {
        /// Finished orders, points, rows or times.
        done: usize,
    },
    /// It could not be decided, or not with the digits asked for.
    Undecided,
    /// There is no such value, and the answer says why.
    NoAnswer,
}

/// Something to know beside the answer, in one line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Remark(pub String);

/// A plain answer: its header, its value, how far it goes, and what is to be said beside it.
///
/// As JSON it is one object: the keys of the header, then those of the value, then `remarks` where
/// there are any.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer<T> {
    /// What it belongs to.
    #[serde(flatten)]
    pub header: Header,
    /// The value.
    #[serde(flatten)]
    pub value: T,
    /// How far it goes.
    #[serde(skip)]
    pub standing: Standing,
    /// What is to be said beside it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<Remark>,
}

impl<T> Answer<T> {
    /// The answer with another value made from its own.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Answer<U> {
        let Self { header, value, standing, remarks } = self;
        Answer { header, value: f(value), standing, remarks }
    }
}
