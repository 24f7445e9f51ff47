//! First-order averaging as numbers.

use super::{Pen, Present, problem_at, stability_word};
use crate::{Document, Formula, Table, Text};
use lindstedt::evaluate::FirstOrder;
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Number};

/// What the grid shows beside cycles.
fn beside_cycles(found: &FirstOrder) -> Vec<(Text, Text)> {
    let touches =
        "a' touches zero within its error (one semistable cycle, two close ones or none), a";
    let steady = "a' is zero within its error: every amplitude is a steady state";
    let lost = "not resolved (the integral over the phase does not converge)";
    let touching = found.touching.iter().map(|a| (touches.into(), Text::number(a)));
    let from_to = |name: &'static str| {
        move |[from, to]: &[f64; 2]| (name.into(), Text::words(format!("a = {from:.6} to {to:.6}")))
    };
    let steady = found.steady.iter().map(from_to(steady));
    touching.chain(steady).chain(found.unresolved.iter().map(from_to(lost))).collect()
}

impl Present for Answer<FirstOrder> {
    fn page(&self, _: Pen) -> Document {
        let found = &self.value;
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
            let open = "stability undecided (its exponent is zero within its error)";
            let stable = stability_word(cycle.stable, open);
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
        lines.extend(beside_cycles(found));
        if found.cycles.is_empty() && found.touching.is_empty() && found.steady.is_empty() {
            let beside = match found.unresolved[..] {
                [] => "",
                _ => "; none is looked for where it is not resolved",
            };
            lines.push((
                "cycles".into(),
                format!("no change of sign of a' found up to a = {}{beside}", found.amplitude)
                    .into(),
            ));
        }
        if let Some(belt) = &found.belt {
            let name = Text::words(format!("a cycle is as fast as the belt at {belt}"));
            lines.extend(found.sticking.iter().map(|begins| line(name.clone(), &begins.value)));
            if found.sticking.is_empty() {
                lines.push((name, format!("nowhere up to a = {}", found.amplitude).into()));
            }
        }
        Document::titled(problem_at(&self.header))
            .words(format!(
                "First order in {}, x = a cos psi, omega = {}; estimated. Changes of sign of a' are sought at \
                 amplitudes {:.5} apart: cycles that are closer are not excluded.",
                found.parameter, found.frequency, found.cell
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
                cycle.stable.map_or("undecided".to_owned(), |stable| stable.to_string()),
            ])
        }))
    }
}
