//! The expansion against the time domain.

use super::Present;
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Formula, Table, Text};
use lindstedt::Answer;
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::verify::{Comparison, Verification};

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

impl Present for Answer<Verification> {
    fn document(&self) -> Document {
        let name = self.value.parameter.as_str();
        let small = Text::from(Formula::new(name, latex_name(name)));
        let error = Text::from(Formula::new("max |x_N - x|", r"\max |x_N - x|"));
        let table = Table::new([small, error, "integration".into(), "local order".into()]);
        let table = self.value.table.iter().map(row).fold(table, Table::row);
        Document::titled(title(self)).table(table).words(self.value.reason.as_str())
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
