//! Section 2, the vibro-impact oscillator with a delay loop, (1)-(17).
//!
//! Every formula is written down as it is printed and compared, exactly, with what is derived from
//! the equation of motion. Where they differ, all changes of one place are tried on the printed
//! formula; one that makes it equal is the misprint.

mod averaged;
mod edits;
mod equation;
mod formula;
mod judge;
mod orbit;
mod perturbation;
mod prediction;
mod setting;
mod stability;

pub use formula::{completions, parse};
pub(super) use prediction::{ORBITS_READ, SAMPLED, unstable_example};
pub use prediction::{Rate, Sample};

use super::{Reader, Row, Section, Text};
use judge::Statement;
use lindstedt::Error;
use lindstedt::unstable::impact::linearised::ImpactMap;

/// The words of a derivation that failed where it cannot.
const FAILED: Error = Error::NoValue;

/// Orders of the symbolic averaging beyond which nothing new is seen.
const ORDERS: usize = 6;

/// All formulas that are compared as expressions, in the order of the paper.
fn statements() -> Result<Vec<Statement>, Error> {
    let mut list = equation::statements()?;
    list.extend(averaged::statements()?);
    list.extend(orbit::statements()?);
    list.extend(perturbation::statements(&ImpactMap::derive().ok_or(FAILED)?)?);
    Ok(list)
}

/// Reads another text in the place of a printed formula of section 2, by the label of its row:
/// the rows it gets then (several for several slips), or nothing for an unknown label.
///
/// # Errors
/// [`Error::NoValue`] only if the derivation fails, which it does not.
///
/// ```
/// use lindstedt_paper::{Verdict, reread};
/// let verdict = |text: &str| Some(reread("b_0, (16)", text).ok()??.first()?.verdict);
/// let right = "R_r*alpha0*exp(4*beta*R)*[1/omega*(R*C + alpha0*D) - a*sin(phi)]";
/// assert_eq!(verdict(right), Some(Verdict::Agrees));
/// assert_eq!(verdict(&right.replace("R*C", "R*D")), Some(Verdict::Misprint));
/// assert_eq!(verdict("R_r*alpha0"), Some(Verdict::Wrong));
/// ```
pub fn reread(label: &str, printed: &str) -> Result<Option<Vec<Row>>, Error> {
    let found =
        statements()?.into_iter().find(|statement| *Text::from(statement.label.as_str()) == *label);
    Ok(found.map(|statement| Statement { printed: printed.to_owned(), ..statement }.rows()))
}

/// (1)-(4).
pub(super) fn read_equation(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    for statement in equation::statements()? {
        if statement.label == "(2)" {
            section.rows.push(averaged::loop_switched_off(reader.options.order.min(ORDERS))?);
        }
        section.rows.extend(statement.rows());
    }
    Ok(true)
}

/// (5)-(7).
pub(super) fn read_averaging(
    reader: &mut Reader<'_>,
    section: &mut Section,
) -> Result<bool, Error> {
    section.rows.extend(averaged::rows(reader.options.order.min(ORDERS))?);
    Ok(true)
}

/// (8) and what follows it.
pub(super) fn read_orbit(_: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.rows.extend(orbit::rows()?);
    Ok(true)
}

/// (9)-(16).
pub(super) fn read_perturbation(_: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    section.rows.extend(perturbation::rows()?);
    Ok(true)
}

/// (17) and the predictions.
pub(super) fn read_stability(
    reader: &mut Reader<'_>,
    section: &mut Section,
) -> Result<bool, Error> {
    let rows = stability::rows(section);
    section.rows.extend(rows);
    prediction::read(reader, section)
}
