//! First-order averaging as numbers.

use super::Present;
use crate::{Document, Formula, Table, Text};
use lindstedt::evaluate::FirstOrder;
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Number};

impl Present for Answer<FirstOrder> {
    fn document(&self) -> Document {
        let found = &self.value;
        let at: Vec<String> = self.header.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        let between = if at.is_empty() { "" } else { ": " };
        let small = latex_name(&found.parameter);
        let rate = |name: &str, latex: &str| {
            let text = format!("{name}/{} at a = {}", found.parameter, found.amplitude);
            Text::from(Formula::new(
                text,
                format!(r"{latex}/{small},\quad a = {}", found.amplitude),
            ))
        };
        let line = |name: Text, number: &Number| (name, Text::number(number));
        let mut lines = vec![
            line(rate("a'", r"\dot a"), &found.amplitude_rate),
            line(rate("(psi' - omega)", r"(\dot\psi - \omega)"), &found.phase_rate),
        ];
        for cycle in &found.cycles {
            let stable = if cycle.stable { "stable" } else { "unstable" };
            let words = match cycle.belt {
                Some(belt) => format!("cycle, {stable}, {}, a", belt.word()),
                None => format!("cycle, {stable}, a"),
            };
            lines.push(line(words.as_str().into(), &cycle.amplitude));
            lines.push(line(
                Text::words(format!("its exponent over {}", found.parameter)),
                &cycle.exponent,
            ));
            let shift = format!("its frequency less omega, over {}", found.parameter);
            lines.push(line(Text::words(shift), &cycle.phase_rate));
        }
        if found.cycles.is_empty() {
            lines.push((
                "cycles".into(),
                format!("no change of sign of a' found up to a = {}", found.amplitude).into(),
            ));
        }
        if let Some(belt) = &found.belt {
            let name = Text::words(format!("a cycle is as fast as the belt at {belt}"));
            lines.extend(found.sticking.iter().map(|begins| line(name.clone(), &begins.value)));
            if found.sticking.is_empty() {
                lines.push((name, format!("nowhere up to a = {}", found.amplitude).into()));
            }
        }
        Document::titled(format!("{}{between}{}", self.header.problem, at.join(", ")))
            .words(format!(
                "First order in {}, x = a cos psi, omega = {}; estimated, changes of sign of a' on a grid.",
                found.parameter, found.frequency
            ))
            .lines(lines)
    }

    fn table(&self) -> Option<Table> {
        let head = Table::new(["a", "exponent", "phase_rate", "stable"]);
        Some(self.value.cycles.iter().fold(head, |table, cycle| {
            table.row([
                cycle.amplitude.decimal.clone(),
                cycle.exponent.decimal.clone(),
                cycle.phase_rate.decimal.clone(),
                cycle.stable.to_string(),
            ])
        }))
    }
}
