//! A problem file: what it says, the words that it knows, and its usual choices.

use crate::error::{excerpt, position};
use crate::file_error::RoleReason;
use crate::grammar::locate;
use crate::history::History;
use crate::meaning::Meanings;
use crate::names::Names;
use lindstedt_equation::print::Style;
use lindstedt_equation::{AmplitudeRole, Expression, Problem, Quantity};
use std::collections::{BTreeMap, BTreeSet};

/// Bytes of a problem file; look at the size of a file before reading it.
pub const LARGEST_FILE: u64 = 256 * 1024;

/// A problem with everything that its file says.
///
/// ```
/// use lindstedt_problem_file::ProblemFile;
/// let file = ProblemFile::parse("equation = \"x'' + x + eps*k*x^3 = 0\"\n")?;
/// assert_eq!(file.problem.parameters[0].name, "k");
/// assert_eq!(file.locate_equation(), Some((1, 13)));
/// # Ok::<(), lindstedt_problem_file::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ProblemFile {
    /// The problem; parameters with an order are multiplied by the small parameter to that power, and what
    /// determines a parameter stands in its place, unless it contains pi.
    pub problem: Problem,
    /// Units as text, by parameter.
    pub units: BTreeMap<String, String>,
    /// Parameters that are determined by others, with how.
    pub follows: BTreeMap<String, String>,
    /// x(0) and x'(0) as exact text.
    pub initial: Option<[String; 2]>,
    /// The motion before t = 0, and as it was written.
    pub history: Option<(History, String)>,
    /// The parameter that is sought as a series, by solvability.
    pub unknown: Option<String>,
    /// Parameters that are held fixed.
    pub fixed: Vec<String>,
    /// Parameters that are swept.
    pub swept: Vec<String>,
    /// LO..HI:COUNT of those of `swept` that have a range.
    pub ranges: BTreeMap<String, String>,
    /// Quantities that are asked for.
    pub asked: Vec<Quantity>,
    /// Parameters that are declared and occur nowhere.
    pub unused: Vec<String>,
    /// The names that the equation may mention.
    pub names: Names,
    /// Whether it has a name of its own.
    pub named: bool,
    /// Whether it has a table of parameters; without one every name of the equation is one, without a value.
    pub declares: bool,
    /// The equation as it was written.
    pub equation: String,
    /// Where it starts, in bytes of the file; nothing when it contains escapes.
    pub(crate) start: Option<usize>,
    pub(crate) meanings: Meanings,
    pub(crate) text: String,
}

/// The name of a problem whose file has none.
pub(crate) const UNNAMED: &str = "oscillator";

/// The names of the ways in which an amplitude enters.
pub const AMPLITUDES: [(&str, AmplitudeRole); 6] = [
    ("scaled", AmplitudeRole::Scaled),
    ("scales-frequency", AmplitudeRole::ScalesFrequency { exponent: 2 }),
    ("in-sums", AmplitudeRole::InSums),
    ("in-small-parameter", AmplitudeRole::InSmallParameter),
    ("determined", AmplitudeRole::Determined),
    ("free", AmplitudeRole::Free),
];

/// Why an amplitude cannot enter in this way. The roles of the built-in problems are claims about
/// the equation, and a claim is checked.
pub(crate) fn misplaced(
    role: AmplitudeRole,
    equation: &Expression,
    small: &str,
    declared: &BTreeSet<String>,
) -> Option<RoleReason> {
    match role {
        AmplitudeRole::ScalesFrequency { .. } => {
            let equation = equation.smooth_powers().canonical();
            let fits = |e: &&Expression| **e == Expression::ACCELERATION || is_power_law(e);
            let odd = equation.terms().iter().find(|e| !fits(e))?;
            Some(RoleReason::Scaling { term: excerpt(&odd.print(small, Style::Text)) })
        }
        AmplitudeRole::InSmallParameter => {
            let mentioned = equation.parameters();
            let free = declared.iter().filter(|name| !mentioned.contains(*name));
            let others = free.filter(|name| *name != "amplitude").count();
            (others != 1 || !declared.contains("amplitude")).then_some(RoleReason::Parts)
        }
        _ => None,
    }
}

/// Whether a term is c x (x^2)^small with c free of x, so that x = a y makes it a (a^2)^small times as
/// large.
fn is_power_law(term: &Expression) -> bool {
    let x = Expression::DISPLACEMENT;
    let power = x.clone().pow(2).pow(Expression::Small).canonical();
    let moving = |e: &&Expression| e.nodes().any(|e| matches!(e, Expression::Unknown(_)));
    let mut moving: Vec<&Expression> = term.factors().iter().filter(moving).collect();
    moving.sort_by_key(|e| **e != x);
    moving == [&x, &power]
}

impl ProblemFile {
    /// An expression in the parameters of the file as the problem has it: with the orders of its parameters
    /// and with what determines them in their place.
    #[must_use]
    pub fn put_in(&self, e: &Expression) -> Expression {
        self.meanings.put_in(e)
    }

    /// What determines the parameters that keep their name in the problem: expressions in the others and in
    /// the parameter `pi`, which has the value pi.
    #[must_use]
    pub fn determined(&self) -> &BTreeMap<String, Expression> {
        &self.meanings.with_pi
    }

    /// Line and column of a term of the equation; nothing if it cannot be found.
    pub fn locate(&self, term: &Expression) -> Option<(usize, usize)> {
        let found = locate(&self.equation, &self.names, term)?;
        Some(position(&self.text, self.start? + found.start))
    }

    /// Forgets where the equation stands: its text was made, not written by somebody.
    pub fn forget_places(&mut self) {
        self.start = None;
    }

    /// The text of the file.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.text
    }

    /// Line and column of the equation; nothing when it contains escapes.
    pub fn locate_equation(&self) -> Option<(usize, usize)> {
        Some(position(&self.text, self.start?))
    }
}
