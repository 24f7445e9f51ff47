//! What every verb answers with.

use crate::Error;
use lindstedt_number::ball::Balls;
use lindstedt_number::{Number, Status, as_map};
use rug::Float;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// The version of the JSON form; it grows when a key changes its meaning.
pub const SCHEMA: u32 = 1;

/// Digits of numbers in doubles.
const DOUBLE_DIGITS: usize = 12;

/// A number in doubles with an estimated error, or zero within it.
pub(crate) fn estimated(value: f64, error: f64) -> Result<Number, Error> {
    let (value, error) = (Float::with_val(64, value), Float::with_val(53, error));
    let ball = Balls::new(64).from_parts(&value, &error);
    let number = if ball.contains_zero() {
        Number::of_ball(&ball, DOUBLE_DIGITS)
    } else {
        Number::with_error(&value, &error, DOUBLE_DIGITS)
    };
    Ok(number.ok_or(Error::NoValue)?.weaken(Status::Estimated))
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => f.write_str("complete"),
            Self::Stopped { done } => write!(f, "stopped, {done} done"),
            Self::Undecided => f.write_str("undecided"),
            Self::NoAnswer => f.write_str("no answer"),
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What an answer belongs to, in the same words for all verbs.
///
/// ```
/// use lindstedt::{Oscillator, Work};
/// let duffing = Oscillator::builtin("duffing")?.set("eps", "1/2")?;
/// let header = duffing.evaluate(&Default::default(), &Work::default())?.header;
/// assert_eq!(header.equation, "x'' + x + rho*x^3 = 0");
/// assert_eq!(header.at[0], ("eps".to_owned(), "1/2".to_owned()));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
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
    /// The units of parameters, where the file of the problem names them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub units: BTreeMap<String, String>,
    /// The order of the expansion; nothing where none is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// How numbers were computed: `exact`, `collocation`, `fourier`, `doubles`, ...
    pub tier: &'static str,
    /// Wall-clock seconds of the question.
    pub seconds: f64,
}

/// How far an answer goes; one exit code each on the command line.
///
/// ```
/// use lindstedt::{Oscillator, Standing, Stop, Work};
/// let law = Oscillator::builtin("power-law")?;
/// let work = Work { stop: Stop::new(|| true), ..Work::default() };
/// let found = law.derive(3, &work);
/// assert!(found.is_err() || found.is_ok_and(|answer| answer.standing != Standing::Complete));
/// assert_eq!(law.derive(1, &Work::default())?.standing, Standing::Complete);
/// # Ok::<(), lindstedt::Error>(())
/// ```
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
///
/// ```
/// use lindstedt::Oscillator;
/// let text = "equation = \"x'' + x + eps*x^3 = 0\"\n[parameters]\nk = { value = \"2\" }\n";
/// let remark = Oscillator::file(text)?.remarks()[0].to_string();
/// assert_eq!(remark, "parameter k is declared and occurs nowhere");
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Remark(pub String);

/// A plain answer: its header, its value, how far it goes, and what is to be said beside it.
///
/// As JSON it is one object: the keys of the header, then those of the value, then `standing`, and
/// `remarks` where there are any.
///
/// ```
/// use lindstedt::{Oscillator, Quantity, Work};
/// let answer = Oscillator::parse("x'' + x + eps*x^3 = 0")?.derive(1, &Work::default())?;
/// assert_eq!((answer.header.tier, answer.header.order), ("exact", Some(1)));
/// let first = answer.map(|value| value.exact(Quantity::Frequency, 1)).value;
/// assert_eq!(first.as_deref(), Some("3/8"));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Answer<T> {
    /// What it belongs to.
    #[serde(flatten)]
    pub header: Header,
    /// The value.
    #[serde(flatten)]
    pub value: T,
    /// How far it goes; as JSON the words of its `Display`.
    #[serde(serialize_with = "in_words")]
    pub standing: Standing,
    /// What is to be said beside it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<Remark>,
}

fn in_words<S: Serializer>(standing: &Standing, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(standing)
}

impl<T> Answer<T> {
    /// The answer with another value made from its own.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Answer<U> {
        let Self { header, value, standing, remarks } = self;
        Answer { header, value: f(value), standing, remarks }
    }
}
