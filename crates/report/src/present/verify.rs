//! The expansion against the time domain.

use super::{Pen, Present};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Formula, Table, Text};
use lindstedt::Answer;
use lindstedt::respond::Estimate;
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::verify::{Comparison, SteadyStates, Verification};

/// Small parameter, difference, error of the integration, slope.
fn row(c: &Comparison) -> [String; 4] {
    let short = |x: &rug::Float| x.to_string_radix(10, Some(6));
    let slope = c.slope.map(|slope| format!("{slope:.4}")).unwrap_or_default();
    [c.small.to_string(), short(&c.error), short(&c.simulation_error), slope]
}

fn title(answer: &Answer<Verification>) -> String {
    let (header, value) = (&answer.header, &answer.value);
    let order = value.expected_order - 1;
    let Verification { periods, digits, .. } = value;
    format!(
        "{}: order {order}, {periods} periods, integration with {digits} digits",
        header.problem
    )
}

/// The steady states against periodic orbits.
fn steady(value: &SteadyStates, small: Text) -> Document {
    let page =
        Document::default().heading("steady states, and periodic orbits of the equation near them");
    if let Some(reason) = &value.refused {
        return page.words(format!("not compared: {reason}"));
    }
    let short = |x: &Option<Estimate>, orbit: bool| match x {
        Some(x) => format!("{:.3e}", x.value),
        None if orbit => "unresolved".to_owned(),
        None => "no orbit".to_owned(),
    };
    let frequency = value.states.iter().flat_map(|it| &it.table).any(|it| it.frequency.is_some());
    let head = ["a".into(), small, "amplitude".into(), "phase".into()].into_iter();
    let head = head.chain(frequency.then(|| "frequency".into())).chain(["local order".into()]);
    let mut table = Table::new(head);
    for state in &value.states {
        let own: Vec<String> = state.amplitudes.iter().map(|a| format!("{:.6}", a.value)).collect();
        for line in &state.table {
            let mut cells = vec![own.join(", "), line.small.clone()];
            cells.extend([&line.amplitude, &line.phase].map(|x| short(x, line.orbit)));
            cells.extend(frequency.then(|| short(&line.frequency, line.orbit)));
            cells.push(line.slope.map(|slope| format!("{slope:.3}")).unwrap_or_default());
            table = table.row(cells);
        }
    }
    page.table(table).words(value.reason.as_str())
}

impl Present for Answer<Verification> {
    fn page(&self, _: Pen) -> Document {
        let name = self.value.parameter.as_str();
        let small = Text::from(Formula::new(name, latex_name(name)));
        let error = Text::from(Formula::new("max |x_N - x|", r"\max |x_N - x|"));
        let steady = self.value.steady.as_ref().map(|it| steady(it, small.clone()));
        let table = Table::new([small, error, "integration".into(), "local order".into()]);
        let table = self.value.table.iter().map(row).fold(table, Table::row);
        let page = Document::titled(title(self)).table(table).words(self.value.reason.as_str());
        steady.into_iter().fold(page, Document::append)
    }

    /// The errors over the small parameter, with the line of slope N + 1.
    fn figure(&self) -> Option<Figure> {
        let value = &self.value;
        let points = value.table.iter().map(|c| (c.small.to_f64().abs(), c.error.to_f64()));
        let points: Vec<(f64, f64)> = points.collect();
        let &(x0, y0) = points.last()?;
        let expected = value.expected_order as f64;
        let line = points.iter().map(|(x, _)| (*x, y0 * (x / x0).powf(expected)));
        let across = Axis::logarithmic(format!("|{}|", value.parameter));
        let figure = Figure::new(title(self), across, Axis::logarithmic("max |x_N - x|"))
            .layer(Some(&format!("slope {expected}")), Mark::Line(2), colours::GREY, line)
            .layer(Some("measured"), Mark::Disc(5), colours::BLUE, points.iter().copied());
        Some(figure)
    }

    fn table(&self) -> Option<Table> {
        let table = Table::new(["small", "difference", "integration", "slope"]);
        Some(self.value.table.iter().map(row).fold(table, Table::row))
    }
}
