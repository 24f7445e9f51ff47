//! Period and frequency over swept parameters.

use super::{Present, parameter};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table};
use lindstedt::evaluate::EvaluationSweep;
use lindstedt::{Answer, Number};

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
        let page = self.table().into_iter().fold(Document::titled(title(self)), Document::table);
        page.words("Period and frequency are estimated; the exact period is a closed form.")
    }

    /// The period over the first parameter, a curve for every value of the second.
    fn figure(&self) -> Option<Figure> {
        let grid = &self.value.grid;
        let frame = Figure::new(
            title(self),
            parameter(&self.header, &grid.columns.name),
            Axis::linear("period"),
        );
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

    /// The parameters, then the numbers; of a point without them the reason, last.
    fn table(&self) -> Option<Table> {
        let names =
            ["period", "period_error", "frequency", "frequency_error", "exact_period", "refused"];
        let grid = &self.value.grid;
        let table = Table::new(grid.axes().map(|axis| axis.name.as_str()).chain(names));
        Some(grid.iter().fold(table, |table, (x, y, found)| {
            let reason = match found {
                None => "not reached".to_owned(),
                Some(Err(error)) => error.to_string(),
                Some(Ok(found)) if found.period.is_none() => "not one digit".to_owned(),
                Some(Ok(_)) => String::new(),
            };
            let found = found.and_then(|found| found.as_ref().ok());
            let [period, frequency, [exact, _]] = [
                parts(found.and_then(|found| found.period.as_ref())),
                parts(found.and_then(|found| found.frequency.as_ref())),
                parts(found.and_then(|found| found.exact_period.as_ref())),
            ];
            let values = [x].into_iter().chain(y).map(ToString::to_string);
            table.row(values.chain(period).chain(frequency).chain([exact, reason]))
        }))
    }
}
