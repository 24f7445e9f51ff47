//! Period and frequency over swept parameters.

use super::Present;
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table};
use lindstedt::evaluate::{EvaluationSweep, SweptPeriod};
use lindstedt::{Answer, Number};

/// The names of the axes, then those of the values.
fn head(sweep: &EvaluationSweep, values: &[&str]) -> Table {
    let axes = std::iter::once(&sweep.grid.columns).chain(&sweep.grid.rows);
    Table::new(axes.map(|axis| axis.name.as_str()).chain(values.iter().copied()))
}

/// A table with the cells of each point; of one that was refused the reason stands in the first.
fn filled<const N: usize>(
    sweep: &EvaluationSweep,
    table: Table,
    cells: impl Fn(&SweptPeriod) -> [String; N],
    refused: impl Fn(&str) -> [String; N],
) -> Table {
    sweep.grid.iter().fold(table, |table, (x, y, found)| {
        let cells = match found {
            None => refused("not reached"),
            Some(Err(reason)) => refused(reason),
            Some(Ok(found)) => cells(found),
        };
        let values = std::iter::once(x).chain(y).map(ToString::to_string);
        table.row(values.chain(cells))
    })
}

fn shown(number: Option<&Number>) -> String {
    match number {
        None => "not one digit".to_owned(),
        Some(Number { decimal, error: Some(error), .. }) => format!("{decimal} +- {error}"),
        Some(Number { decimal, .. }) => format!("{decimal} (no estimate)"),
    }
}

fn decimal(number: Option<&Number>) -> String {
    number.map(|number| number.decimal.clone()).unwrap_or_default()
}

fn error(number: Option<&Number>) -> String {
    number.and_then(|number| number.error.clone()).unwrap_or_default()
}

fn title(answer: &Answer<EvaluationSweep>) -> String {
    let order = answer.header.order.map(|order| format!(", order {order}"));
    format!("{}: period{}", answer.header.problem, order.unwrap_or_default())
}

impl Present for Answer<EvaluationSweep> {
    fn document(&self) -> Document {
        let values = ["period", "frequency", "exact period"];
        let cells = |found: &SweptPeriod| {
            let exact = decimal(found.exact_period.as_ref());
            [shown(found.period.as_ref()), shown(found.frequency.as_ref()), exact]
        };
        let refused = |reason: &str| [reason.to_owned(), String::new(), String::new()];
        let page = Document::titled(title(self));
        page.table(filled(&self.value, head(&self.value, &values), cells, refused))
    }

    /// The period over the first parameter, a curve for every value of the second.
    fn figure(&self) -> Option<Figure> {
        let grid = &self.value.grid;
        let across = Axis::linear(grid.columns.name.as_str());
        let frame = Figure::new(title(self), across, Axis::linear("period"));
        let rows = grid.points.chunks(grid.columns.values.len().max(1)).enumerate();
        Some(rows.fold(frame, |frame, (index, row)| {
            let colour = colours::CYCLE[index % colours::CYCLE.len()];
            let value = grid.rows.as_ref().and_then(|axis| axis.values.get(index).zip(Some(axis)));
            let name = value.map(|(value, axis)| format!("{} = {value}", axis.name));
            let points = grid.columns.doubles().into_iter().zip(row).map(|(x, found)| {
                let found = found.as_ref().and_then(|found| found.as_ref().ok());
                let period = found.and_then(|found| found.period.as_ref()?.decimal.parse().ok());
                (x, period.unwrap_or(f64::NAN))
            });
            frame.layer(name.as_deref(), Mark::Line(2), colour, points)
        }))
    }

    fn table(&self) -> Option<Table> {
        let names =
            ["period", "period_error", "frequency", "frequency_error", "exact_period", "refused"];
        let cells = |found: &SweptPeriod| {
            let SweptPeriod { period, frequency, exact_period } = found;
            let (period, frequency) = (period.as_ref(), frequency.as_ref());
            let exact = decimal(exact_period.as_ref());
            [
                decimal(period),
                error(period),
                decimal(frequency),
                error(frequency),
                exact,
                String::new(),
            ]
        };
        let refused = |reason: &str| {
            let mut cells: [String; 6] = Default::default();
            cells[5] = reason.to_owned();
            cells
        };
        Some(filled(&self.value, head(&self.value, &names), cells, refused))
    }
}
