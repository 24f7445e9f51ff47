//! Period and frequency over swept parameters.

use super::Present;
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table};
use lindstedt::evaluate::{EvaluationSweep, SweptPeriod};
use lindstedt::{Answer, Number};

/// A row for every point: its values, and its cells; of one that was refused the reason is in the cell of
/// that index.
fn table<const N: usize>(
    sweep: &EvaluationSweep,
    names: [&str; N],
    refused: usize,
    cells: impl Fn(&SweptPeriod) -> [String; N],
) -> Table {
    let axes = sweep.grid.axes();
    let table = Table::new(axes.map(|axis| axis.name.as_str()).chain(names));
    sweep.grid.iter().fold(table, |table, (x, y, found)| {
        let without = |reason: String| {
            std::array::from_fn(|n| if n == refused { reason.clone() } else { String::new() })
        };
        let cells = match found {
            None => without("not reached".to_owned()),
            Some(Err(error)) => without(error.to_string()),
            Some(Ok(found)) => cells(found),
        };
        table.row([x].into_iter().chain(y).map(ToString::to_string).chain(cells))
    })
}

fn shown(number: Option<&Number>) -> String {
    number.map_or_else(|| "not one digit".to_owned(), ToString::to_string)
}

/// Its decimal and its error, empty where there is none.
fn parts(number: Option<&Number>) -> [String; 2] {
    let error = |number: &Number| number.error.clone().unwrap_or_default();
    number.map_or_else(Default::default, |number| [number.decimal.clone(), error(number)])
}

fn title(answer: &Answer<EvaluationSweep>) -> String {
    let order = answer.header.order.map(|order| format!(", order {order}"));
    let at = answer.header.at.iter().map(|(name, value)| format!(", {name} = {value}"));
    let at: String = at.collect();
    format!("{}: period{}{at}", answer.header.problem, order.unwrap_or_default())
}

impl Present for Answer<EvaluationSweep> {
    fn document(&self) -> Document {
        let names = ["period", "frequency", "exact period"];
        Document::titled(title(self)).table(table(&self.value, names, 0, |found| {
            let [exact, _] = parts(found.exact_period.as_ref());
            [shown(found.period.as_ref()), shown(found.frequency.as_ref()), exact]
        }))
    }

    /// The period over the first parameter, a curve for every value of the second.
    fn figure(&self) -> Option<Figure> {
        let grid = &self.value.grid;
        let frame =
            Figure::new(title(self), Axis::linear(&*grid.columns.name), Axis::linear("period"));
        let rows = grid.points.chunks(grid.width()).enumerate();
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
        Some(table(&self.value, names, 5, |found| {
            let [period, period_error] = parts(found.period.as_ref());
            let [frequency, frequency_error] = parts(found.frequency.as_ref());
            let [exact, _] = parts(found.exact_period.as_ref());
            [period, period_error, frequency, frequency_error, exact, String::new()]
        }))
    }
}
