//! What every tier costs, and how wrong it is: time against true error.

use super::{Pen, Present, equation};
use crate::figure::{Axis, Colour, Layer, Mark, colours};
use crate::{Document, Figure, Table, Text};
use lindstedt::Answer;
use lindstedt::trade::{LeftOut, Recommendation, Row, Summation, Trade};

/// An error of zero (all digits computed with are right) is drawn here at the least.
const LEAST: f64 = 1e-300;
/// The names of what is printed; a proved error stands behind them.
const TITLES: [&str; 9] = [
    "tier", "order", "precision", "summed", "time", "again", "memory", "true error", "stated error",
];
/// The names in CSV: the keys of JSON.
const KEYS: [&str; 12] = [
    "tier", "order", "digits", "harmonics", "summed", "seconds", "seconds_again", "memory_bytes",
    "true_error", "stated_error", "proved_error", "pareto",
];

fn colour(name: &str) -> Colour {
    match name {
        "exact" => colours::BLACK,
        "energy" => colours::PURPLE,
        "collocation" => colours::BLUE,
        "collocation-f64" => colours::SKY,
        "fourier" => colours::GREEN,
        "simulation-f64" => colours::ORANGE,
        _ => colours::VERMILION,
    }
}

/// Full marks: methods differ in shape, and those of one shape in lightness.
fn mark(name: &str) -> Mark {
    match name {
        "simulation" | "simulation-f64" => Mark::Triangle(5),
        "fourier" | "energy" => Mark::Cross(4),
        _ => Mark::Disc(4),
    }
}

/// 1.2 us, 34 ms, 5.6 s.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{s:.1e} s"),
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e4 => format!("{b:.0} B"),
        b if b < 1e7 => format!("{:.0} kB", b / 1e3),
        b => format!("{:.0} MB", b / 1e6),
    }
}

fn precision(row: &Row) -> String {
    let harmonics = row.method.harmonics().map(|n| format!("{n} harm."));
    harmonics.unwrap_or_else(|| format!("{} digits", row.method.digits()))
}

fn stated(row: &Row) -> String {
    if row.stated_error.is_finite() { format!("{:.1e}", row.stated_error) } else { "none".into() }
}

fn shown<T: ToString>(value: Option<T>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn cells(row: &Row) -> [String; 9] {
    [
        format!("{}{}", row.method.name(), if row.pareto { "*" } else { "" }),
        shown(row.order),
        precision(row),
        shown(row.summation.map(|summation| summation.name())),
        duration(row.seconds),
        duration(row.seconds_again),
        size(row.bytes),
        format!("{:.1e}", row.true_error),
        stated(row),
    ]
}

fn table(value: &Trade) -> Table {
    if value.proved_period.is_none() {
        return value.rows.iter().map(cells).fold(Table::new(TITLES), Table::row);
    }
    let proved = |row: &Row| shown(row.proved_error.map(|error| format!("{error:.1e}")));
    let rows = value.rows.iter().map(|row| cells(row).into_iter().chain([proved(row)]));
    rows.fold(Table::new(TITLES.into_iter().chain(["proved"])), Table::row)
}

fn left_out(left: &LeftOut) -> String {
    let order = left.order.map(|n| format!(", order {n}")).unwrap_or_default();
    let (name, digits) = (left.method.name(), left.method.digits());
    format!("Left out: {name}, {digits} digits{order}: {}.", left.reason)
}

/// A row in one line, with the error that it states.
fn named(row: &Row) -> String {
    let order = row.order.map(|n| format!(", order {n}")).unwrap_or_default();
    let sum = match row.summation {
        None => String::new(),
        Some(Summation::PartialSum) => ", summed as it stands".to_owned(),
        Some(by) => format!(", summed by {}", by.name()),
    };
    format!("{}{order}, {}{sum} (states {})", row.method.name(), precision(row), stated(row))
}

/// One sentence each for the error and the time that were asked for.
fn advice(found: &Recommendation) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(error) = found.error {
        match (&found.row, &found.for_many) {
            (Some(one), Some(many)) => {
                lines.push(format!("For {error:e} in {}: {}.", duration(one.seconds), named(one)));
                let (each, first) = (duration(many.seconds_again), duration(many.seconds));
                let many = named(many);
                lines.push(format!(
                    "For {error:e} at many values, {each} each after {first}: {many}."
                ));
            }
            _ if found.seconds.is_some() => {
                lines.push(format!("For {error:e}: no run here states it in that time."));
            }
            _ => lines.push(format!("For {error:e}: no run here states so small an error.")),
        }
    }
    if let Some(seconds) = found.seconds {
        let within = format!("Within {}", duration(seconds));
        lines.push(match (&found.within, &found.fastest) {
            (Some(best), _) => format!("{within}: {}.", named(best)),
            (None, Some(fast)) => format!(
                "{within}: no run here; the fastest that states an error takes {}: {}.",
                duration(fast.seconds),
                named(fast)
            ),
            _ => format!("{within}: no run here states an error."),
        });
    }
    lines
}

fn title(answer: &Answer<Trade>) -> String {
    let at: Vec<String> = answer.header.at.iter().map(|(k, v)| format!("{k} = {v}")).collect();
    format!("{} at {}", answer.header.problem, at.join(", "))
}

/// The layers of one curve: partial sums are rings, resummations and the integrator have the mark of their method.
fn curve(figure: Figure, rows: &[Row], at: impl Fn(&Row) -> (f64, f64)) -> Figure {
    let Some(first) = rows.first() else { return figure };
    let (name, colour) = (first.method.name(), colour(first.method.name()));
    let label = |row: &Row| {
        row.order.map_or_else(|| format!("{}d", row.method.digits()), |n| n.to_string())
    };
    [(true, Mark::Ring(4)), (false, mark(name))].into_iter().fold(
        figure,
        |figure, (partial, mark)| {
            let is_partial = |row: &&Row| row.summation == Some(Summation::PartialSum);
            let group: Vec<&Row> = rows.iter().filter(|row| is_partial(row) == partial).collect();
            let points: Vec<(f64, f64)> = group.iter().map(|row| at(row)).collect();
            let labels = group.iter().map(|row| label(row)).collect();
            let name = (!partial).then(|| name.to_owned());
            let mut figure = figure.layer(None, Mark::Line(1), colour, points.iter().copied());
            figure.layers.push(Layer { name, points, mark, colour, labels });
            figure
        },
    )
}

impl Present for Answer<Trade> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let period = format!("{} ({})", value.period, value.source);
        let proved = value.proved_period.as_ref().map(|number| {
            let error = number.error.as_deref().unwrap_or("0");
            ("T, proved", format!("{} +- {error}", number.decimal))
        });
        let page = Document::titled(title(self))
            .formula(equation(&value.problem))
            .lines([("T", period)].into_iter().chain(proved))
            .words(format!(
                "{}; time: best of {}; again: for one more value of the small parameter; memory {}; * is \
                 on the Pareto front.",
                value.errors, value.repeats, value.memory
            ))
            .table(table(value));
        let page = value.left_out.iter().map(left_out).fold(page, Document::words);
        value.recommendation.iter().flat_map(advice).fold(page, Document::words)
    }

    fn figure(&self) -> Option<Figure> {
        let rows = &self.value.rows;
        let least = rows.iter().map(|row| row.true_error).filter(|error| *error > 0.0);
        let least = (least.fold(1.0, f64::min) / 10.0).max(LEAST);
        let at = |row: &Row| (row.seconds, row.true_error.clamp(least, 1e3));
        let words = format!("{}: period (rings: partial sums, others: resummed)", title(self));
        let across = Axis::logarithmic("time / s");
        let figure = Figure::new(words, across, Axis::logarithmic("true relative error"));
        // The front as a staircase: what a time buys.
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for row in self.value.pareto.iter().filter_map(|index| rows.get(*index)) {
            let point = at(row);
            steps.extend(steps.last().map(|before| (point.0, before.1)));
            steps.push(point);
        }
        let figure = figure.layer(Some("Pareto front"), Mark::Line(6), colours::GREY, steps);
        // Rows of one method are neighbours: a curve over the order; that of the integrator goes over
        // the digits.
        let same = |a: &Row, b: &Row| match a.order {
            Some(_) => a.method == b.method,
            None => a.method.name() == b.method.name(),
        };
        Some(rows.chunk_by(same).fold(figure, |figure, rows| curve(figure, rows, at)))
    }

    fn table(&self) -> Option<Table> {
        let row = |row: &Row| {
            // An empty field is what nothing is known of.
            let number =
                |x: f64| Text::words(if x.is_finite() { format!("{x:e}") } else { String::new() });
            let proved = row.proved_error.map(number).unwrap_or_default();
            [
                row.method.name().into(),
                shown(row.order).into(),
                row.method.digits().to_string().into(),
                shown(row.method.harmonics()).into(),
                shown(row.summation.map(|summation| summation.name())).into(),
                number(row.seconds),
                number(row.seconds_again),
                row.bytes.to_string().into(),
                number(row.true_error),
                number(row.stated_error),
                proved,
                u8::from(row.pareto).to_string().into(),
            ]
        };
        Some(self.value.rows.iter().map(row).fold(Table::new(KEYS), Table::row))
    }
}
