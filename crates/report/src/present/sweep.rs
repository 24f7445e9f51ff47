//! Period and frequency, or averaged rates, over swept parameters.

use super::{Pen, Present, parameter, values};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table};
use lindstedt::evaluate::{Swept, SweptPeriod, SweptPoint, SweptRates};
use lindstedt::grid::Grid;
use lindstedt::{Answer, Error, Exact, Number};

/// The numbers of a point as columns.
trait Columns: SweptPoint {
    /// Their names.
    const NAMES: &'static [&'static str];
    /// What the figure shows, and what the page is about.
    const SHOWN: &'static str;
    /// The fields of a point, or of none.
    fn fields(point: Option<&Self>) -> Vec<String>;
    /// What the figure shows.
    fn shown(&self) -> Option<&Number>;
    /// What is known of the numbers.
    fn standing<'a>(points: impl Iterator<Item = &'a Self>) -> &'static str
    where
        Self: 'a;
}

impl Columns for SweptPeriod {
    const NAMES: &'static [&'static str] =
        &["period", "period_error", "frequency", "frequency_error", "exact_period"];
    const SHOWN: &'static str = "period";

    fn fields(point: Option<&Self>) -> Vec<String> {
        let [period, frequency, [exact, _]] = [
            parts(point.and_then(|found| found.period.as_ref())),
            parts(point.and_then(|found| found.frequency.as_ref())),
            parts(point.and_then(|found| found.exact_period.as_ref())),
        ];
        period.into_iter().chain(frequency).chain([exact]).collect()
    }

    fn shown(&self) -> Option<&Number> {
        self.period.as_ref()
    }

    fn standing<'a>(mut points: impl Iterator<Item = &'a Self>) -> &'static str {
        match points.any(|point| point.exact_period.is_some()) {
            true => "Period and frequency are estimated; the exact period is a closed form.",
            false => "Period and frequency are estimated.",
        }
    }
}

impl Columns for SweptRates {
    const NAMES: &'static [&'static str] =
        &["a", "amplitude_rate", "amplitude_rate_error", "phase_rate", "phase_rate_error"];
    const SHOWN: &'static str = "amplitude_rate";

    fn fields(point: Option<&Self>) -> Vec<String> {
        let [amplitude, phase] = [
            parts(point.and_then(|found| found.amplitude_rate.as_ref())),
            parts(point.and_then(|found| found.phase_rate.as_ref())),
        ];
        let start = point.map_or_else(String::new, |point| format!("{:?}", point.amplitude));
        [start].into_iter().chain(amplitude).chain(phase).collect()
    }

    fn shown(&self) -> Option<&Number> {
        self.amplitude_rate.as_ref()
    }

    fn standing<'a>(_: impl Iterator<Item = &'a Self>) -> &'static str {
        "The averaged rates a' and psi' at the amplitude a, estimated."
    }
}

/// Its decimal and its error, empty where there is none.
fn parts(number: Option<&Number>) -> [String; 2] {
    let error = |number: &Number| number.error.clone().unwrap_or_default();
    number.map_or_else(Default::default, |number| [number.decimal.clone(), error(number)])
}

fn title<P: Columns>(answer: &Answer<Swept<P>>) -> String {
    let order = answer.header.order.map(|order| format!(", order {order}"));
    let at = values(&answer.header).into_iter().map(|at| format!(", {at}"));
    let (at, about) = (at.collect::<String>(), P::SHOWN.replace('_', " "));
    format!("{}: {about}{}{at}", answer.header.problem, order.unwrap_or_default())
}

impl<P: Columns> Present for Answer<Swept<P>> {
    fn page(&self, _: Pen) -> Document {
        let table = listed(&self.value.grid, ToString::to_string);
        let page = Document::titled(title(self)).table(table);
        let points = self.value.grid.points.iter().flatten().flatten();
        page.words(P::standing(points))
    }

    /// Over the first parameter, a curve for every value of the second.
    fn figure(&self) -> Option<Figure> {
        let grid = &self.value.grid;
        let frame = Figure::new(
            title(self),
            parameter(&self.header, &grid.columns.name),
            Axis::linear(P::SHOWN.replace('_', " ")),
        );
        let rows = grid.points.chunks(grid.width()).enumerate();
        Some(rows.fold(frame, |frame, (index, row)| {
            let colour = colours::CYCLE[index % colours::CYCLE.len()];
            let value = grid.rows.as_ref().and_then(|axis| axis.values.get(index).zip(Some(axis)));
            let name = value.map(|(value, axis)| format!("{} = {value}", axis.name));
            let points = grid.columns.doubles().into_iter().zip(row).map(|(x, found)| {
                let found = found.as_ref().and_then(|found| found.as_ref().ok());
                let shown = found.and_then(|found| found.shown()?.decimal.parse().ok());
                (x, shown.unwrap_or(f64::NAN))
            });
            frame.layer(name.as_deref(), Mark::Line(2), colour, points)
        }))
    }

    /// As on the page, the parameters in decimals, as programs read them.
    fn table(&self) -> Option<Table> {
        Some(listed(&self.value.grid, |value| value.to_f64().to_string()))
    }
}

/// The parameters, then the numbers; of a point without them the reason, last.
fn listed<P: Columns>(grid: &Grid<Result<P, Error>>, value: fn(&Exact) -> String) -> Table {
    let names = P::NAMES.iter().copied().chain(["refused"]);
    let table = Table::new(grid.axes().map(|axis| axis.name.as_str()).chain(names));
    grid.iter().fold(table, |table, (x, y, found)| {
        let reason = match found {
            None => "not reached".to_owned(),
            Some(Err(error)) => error.to_string(),
            Some(Ok(found)) if !found.has_value() => "not one digit".to_owned(),
            Some(Ok(_)) => String::new(),
        };
        let found = found.and_then(|found| found.as_ref().ok());
        let values = [x].into_iter().chain(y).map(value);
        table.row(values.chain(P::fields(found)).chain([reason]))
    })
}
