//! What is built in, and one problem with all that is known before any work.

use crate::{Oscillator, SCHEMA};
use lindstedt_equation::Problem;
use lindstedt_equation::description::Description;
use lindstedt_equation::print::Style;
use serde::Serialize;

/// A list of problems.
///
/// ```
/// use lindstedt::catalogue::Catalogue;
/// let names: Vec<String> = Catalogue::builtin().problems.into_iter().map(|p| p.name).collect();
/// assert_eq!(names[..3], ["power-law", "pendulum", "vibro-impact"]);
/// ```
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Catalogue {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The problems.
    pub problems: Vec<Entry>,
}

/// A problem as data.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// Its title.
    pub title: String,
    /// Its equation, `... = 0`.
    pub equation: String,
    /// The same in LaTeX.
    pub latex: String,
    /// The small parameter.
    pub parameter: String,
    /// What its amplitude may be.
    pub normalisations: Vec<&'static str>,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Notes.
    pub notes: String,
    /// Where it comes from.
    pub source: String,
    /// The text of its problem file; only where one problem is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// What its equation is made of; only where one problem is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub classification: Option<Description>,
    /// The conditions, for readers.
    #[serde(skip)]
    pub conditions: Vec<lindstedt_equation::Condition>,
}

/// A parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its default, exact; empty where it has none.
    pub default: String,
    /// What it means.
    pub meaning: String,
}

impl Entry {
    fn new(problem: &Problem) -> Self {
        let parameter = |card: &lindstedt_equation::ParameterCard| Parameter {
            name: card.name.to_string(),
            default: card.default.to_string(),
            meaning: card.meaning.to_string(),
        };
        Self {
            name: problem.name.to_string(),
            title: problem.title.to_string(),
            equation: problem.print(Style::Text),
            latex: problem.print(Style::Latex),
            parameter: problem.small.to_string(),
            normalisations: problem.conditions.iter().map(|c| c.name()).collect(),
            parameters: problem.parameters.iter().map(parameter).collect(),
            notes: problem.notes.to_string(),
            source: problem.source.to_string(),
            file: None,
            classification: None,
            conditions: problem.conditions.clone(),
        }
    }
}

impl Catalogue {
    /// The built-in problems.
    #[must_use]
    pub fn builtin() -> Self {
        let mut list = lindstedt_problems::all();
        list.push(lindstedt_problems::stick_slip::problem());
        Self { schema: SCHEMA, problems: list.iter().map(Entry::new).collect() }
    }
}

impl Oscillator {
    /// The problem with its file and its classification.
    #[must_use]
    pub fn entry(&self) -> Catalogue {
        let mut entry = Entry::new(self.problem());
        entry.file = Some(self.problem_file().to_text());
        // What an equation is made of is said of one unknown.
        entry.classification = self.single().ok().and_then(|()| self.describe().ok());
        Catalogue { schema: SCHEMA, problems: vec![entry] }
    }
}
