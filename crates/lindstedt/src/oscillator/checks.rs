//! What is refused before any work, with its place in the file.

use super::Oscillator;
use crate::refusal::Refused;
use crate::{Error, classification};
use lindstedt_equation::Expression;
use lindstedt_equation::classify::Classification;

impl Oscillator {
    /// Refuses, before any work, an equation that the expansion under the condition does not take,
    /// with the term and its place.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn check(&self) -> Result<(), Error> {
        let Ok(parts) = self.classify() else { return Ok(()) };
        self.check_parts(&parts)
    }

    /// The same for a classification that is there.
    pub(crate) fn check_parts(&self, parts: &Classification) -> Result<(), Error> {
        Ok(classification::check(parts, &self.file, self.condition, &self.origin)?)
    }

    /// Refuses forces with frequencies that no averaging takes.
    pub(crate) fn check_frequencies(&self) -> Result<(), Error> {
        let Ok(parts) = self.classify() else { return Ok(()) };
        let place = |term: &Expression| classification::place(&self.file, &self.origin, Some(term));
        Ok(classification::check_frequencies(&parts, place, &self.problem.small)?)
    }

    /// An error of the engine with the place in the file that it is about; an equation alone is its own
    /// place.
    pub(crate) fn refusal(&self, error: Error) -> Error {
        if self.bare {
            return error;
        }
        classification::refusal(error, Some(&self.file), &self.origin)
    }

    /// Refuses several unknowns, and a parameter that follows from pi: expansions take expressions over the rational
    /// numbers, and the delay of whole periods by its tie.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn without_pi(&self) -> Result<(), Error> {
        self.single()?;
        self.values_without_pi()
    }

    /// The same of parameters alone, for any number of unknowns.
    pub(crate) fn values_without_pi(&self) -> Result<(), Error> {
        self.second_order()?;
        let tied = self.problem.synchronous.as_ref().map(|tie| &*tie.delay);
        let determined = self.file.determined();
        let Some(name) = determined.keys().find(|name| Some(name.as_str()) != tied) else {
            return Ok(());
        };
        let how = self.file.follows.get(name).map_or("", String::as_str);
        let message =
            format!("{}: {name} follows: {how}; with pi only `simulate` computes it", self.origin);
        let hint = format!("in the file: {name} = {{ value = \"5*pi\" }} in the place of follows");
        Err(Refused::usage("no-value-set", message, hint).into())
    }

    /// Refuses several unknowns: averaging alone takes them.
    pub(crate) fn single(&self) -> Result<(), Error> {
        self.second_order()?;
        self.one_unknown()
    }

    /// The same, also for x' = ...
    pub(crate) fn one_unknown(&self) -> Result<(), Error> {
        if self.problem.others.is_empty() {
            return Ok(());
        }
        let message = "this question is for one unknown, and there are several equations";
        let hint = "`lindstedt derive` averages them, `respond` finds their steady motions, `evaluate --prove` encloses \
                    periodic orbits, `simulate` integrates them";
        Err(Refused::no_answer("several-unknowns", message, hint).into())
    }

    /// Refuses x' = ...: all questions but one are about x'' = ...
    pub(crate) fn second_order(&self) -> Result<(), Error> {
        if !self.problem.equation.is_first_order() {
            return Ok(());
        }
        let message =
            "the equation is x' = ..., of first order, and this question is for x'' = ...";
        let hint = if self.problem.others.is_empty() {
            "`lindstedt derive --unknown NAME` finds the Hopf points of a parameter and the cycles born there"
        } else {
            "`lindstedt derive --unknown NAME` takes one equation of first order, of one unknown, and no system"
        };
        Err(Refused::no_answer("first-order", message, hint).into())
    }
}
