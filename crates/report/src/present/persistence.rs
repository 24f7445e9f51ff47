//! The parameter for which an orbit persists, to first order.

use super::threshold::verdict;
use super::{Pen, Present, equation, head};
use crate::{Document, Formula, Text};
use lindstedt::threshold::Persistence;
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Number};

impl Present for Answer<Persistence> {
    fn page(&self, _: Pen) -> Document {
        let found = &self.value;
        let formula = |name: &str| Formula::new(name, latex_name(name));
        let sought = Text::words("Sought: ")
            .formula(formula(&found.unknown))
            .and(", for which the orbit that leaves a saddle ends in a saddle, to first order in ")
            .formula(formula(&found.parameter))
            .and(": the zero of Melnikov's integral.");
        let mut lines = Vec::new();
        for orbit in &found.orbits {
            let number = |name: Text, words: &str, number: &Number| {
                (name.and(format!("{words}, {}", orbit.name)), Text::number(number))
            };
            let work =
                |index: &str| Text::from(Formula::new(format!("D_{index}"), format!("D_{index}")));
            lines.push(number(Text::from(formula(&found.unknown)), "", &orbit.value));
            lines.push(number(work("0"), ", work without it", &orbit.known));
            lines.push(number(work("1"), ", work of its factor", &orbit.factor));
            let check = orbit.check.as_deref().unwrap_or("-");
            lines.push((format!("orbit, {}", orbit.name).into(), check.into()));
        }
        lines.push(("validity".into(), verdict(found.validity)));
        head(&found.problem).formula(equation(&found.problem)).words(sought).lines(lines)
    }
}
