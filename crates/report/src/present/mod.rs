//! What every answer looks like: a file per verb.

mod average;
mod catalogue;
mod classification;
mod derive;
mod estimate;
mod evaluate;
mod family;
mod homoclinic;
mod hopf;
mod motion;
mod one_phase;
mod persistence;
mod prove;
mod resonance;
mod respond;
mod stability;
mod sweep;
mod threshold;
mod trade;
mod verify;

use crate::figure::Axis;
use crate::format::steers;
use crate::{Document, Figure, Formula, Table, Text};
use classification::classification;
use lindstedt::unstable::coeff::print::Style;
use lindstedt::unstable::equation::{Condition, Problem};
use lindstedt::{Header, Number, Status};
use serde::Serialize;

pub use respond::angle;
pub use threshold::shade;

/// `name = value` of the parameters.
fn values(header: &Header) -> Vec<String> {
    header.at.iter().map(|(name, value)| format!("{name} = {value}")).collect()
}

/// The page of a problem under its name and its title.
fn head(problem: &Problem) -> Document {
    let title = format!("{}: {}", problem.name, problem.title);
    Document::titled(title.trim_end_matches([':', ' ']))
}

/// `problem: name = value, ...`.
fn problem_at(header: &Header) -> String {
    match &values(header)[..] {
        [] => header.problem.clone(),
        values => format!("{}: {}", header.problem, values.join(", ")),
    }
}

/// In words, with those where it is not known.
fn stability_word(stable: Option<bool>, open: &'static str) -> &'static str {
    stable.map_or(open, |stable| if stable { "stable" } else { "unstable" })
}

/// What writes the formulas of a page.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// Whether they have a LaTeX form: their coefficients may have millions of terms.
    latex: bool,
}

impl Pen {
    /// A formula from what prints it in the notations that are read.
    fn both(self, print: impl Fn(Style) -> String) -> Formula {
        let latex = if self.latex { print(Style::Latex) } else { String::new() };
        Formula::new(print(Style::Text), latex)
    }
}

/// An answer that can be shown.
pub trait Present {
    /// The page, its formulas written by a pen.
    fn page(&self, pen: Pen) -> Document;
    /// The page.
    fn document(&self) -> Document {
        self.page(Pen { latex: true })
    }
    /// The page for a reader of plain text alone: its formulas may lack the LaTeX form, which is then not printed.
    fn plain_document(&self) -> Document {
        self.page(Pen { latex: false })
    }
    /// The figure, where there is something to draw.
    fn figure(&self) -> Option<Figure> {
        None
    }
    /// The table behind the figure, for CSV.
    fn table(&self) -> Option<Table> {
        self.figure().map(|figure| figure.table())
    }
    /// Leaves out what a large grid has beyond its first so many points, and says so.
    fn shorten(&mut self, _points: usize) {}
    /// The lines of that table as comma-separated values, the names first, one by one as long as `take` says so;
    /// whether it took all, nothing where there is no table.
    fn csv(&self, take: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
        Some(self.table()?.csv_lines(take))
    }
}

/// An answer as JSON: the keys of its header, of its value, and its remarks.
///
/// # Errors
/// Those of serde: never for the answers of this workspace, whose keys are strings.
pub fn json<A: Serialize>(answer: &A) -> serde_json::Result<String> {
    Ok(safe(serde_json::to_string_pretty(answer)?))
}

/// The same on one line.
///
/// # Errors
/// As [`json`].
///
/// ```
/// assert_eq!(lindstedt_report::json_line("\u{9b}31m")?, "\"\\u009b31m\"\n");
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn json_line<A: Serialize + ?Sized>(answer: &A) -> serde_json::Result<String> {
    Ok(safe(serde_json::to_string(answer)?))
}

/// JSON in which every character that steers a terminal is an escape: serde leaves those above 0x1f.
fn safe(mut json: String) -> String {
    // Of ASCII that is printed nothing does: a quarter of a gigabyte is looked through at the speed of memory.
    let shown = |byte: &u8| *byte == b'\n' || (b' '..=b'~').contains(byte);
    let (words, rest) = json.as_bytes().as_chunks();
    if !rest.iter().all(shown)
        || !words.iter().all(|word| are_plain(*word) || word.iter().all(shown))
    {
        let escaped = |c: char| match c {
            c if c != '\n' && steers(c) => format!("\\u{:04x}", u32::from(c)),
            c => c.into(),
        };
        json = json.chars().map(escaped).collect();
    }
    json.push('\n');
    json
}

/// Whether all bytes are printed ASCII: none has the highest bit, none less 0x20 or plus 1 gets or loses it.
fn are_plain(word: [u8; 8]) -> bool {
    const ONES: u64 = u64::MAX / 0xff;
    let word = u64::from_ne_bytes(word);
    let low = word.wrapping_sub(0x20 * ONES);
    (word | low | word.wrapping_add(ONES)) & (0x80 * ONES) == 0
}

impl Text {
    /// A number: its decimal, and its error where that is more than a rounding.
    #[must_use]
    pub fn number(number: &Number) -> Self {
        Self::words(match number.status {
            Status::Estimated | Status::NoEstimate => number.to_string(),
            _ => number.decimal.clone(),
        })
    }
}

/// The axis of a parameter, with its unit where the file of the problem names one.
fn parameter(header: &Header, name: &str) -> Axis {
    Axis::linear(match header.units.get(name) {
        Some(unit) => format!("{name} ({unit})"),
        None => name.to_owned(),
    })
}

/// A short formula from what prints it in both notations.
fn both(print: impl Fn(Style) -> String) -> Formula {
    Pen { latex: true }.both(print)
}

/// The equation of a problem.
fn equation(problem: &Problem) -> Formula {
    both(|style| problem.print(style))
}

/// A condition in words.
fn condition_text(condition: Condition) -> &'static str {
    match condition {
        Condition::InitialAmplitude => "x(0) = 1, x'(0) = 0: corrections start at rest at zero",
        Condition::FundamentalAmplitude => {
            "the first harmonic of x is cos(tau): corrections have no first harmonic"
        }
        Condition::LimitCycle => "x'(0) = 0; the amplitude x(0) is determined order by order",
        Condition::FreeAmplitude => {
            "the first harmonic of x is a cos(psi): a and psi drift, corrections have none"
        }
    }
}
