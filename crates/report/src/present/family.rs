//! Proved orbits over a parameter.

use super::{Pen, Present, parameter, values};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table};
use lindstedt::evaluate::{ProvedBranch, ProvedFamily, ProvedMember};
use lindstedt::{Answer, Number};

fn title(answer: &Answer<ProvedFamily>) -> String {
    let at = values(&answer.header).into_iter().map(|at| format!(", {at}"));
    let at: String = at.collect();
    format!("{}: proved orbits over {}{at}", answer.header.problem, answer.value.parameter)
}

type Quantity = fn(&ProvedMember) -> Option<&Number>;

impl Present for Answer<ProvedFamily> {
    fn page(&self, _: Pen) -> Document {
        let words = "Every point is proved. Between: in how many parts the interval up to the next value is proved, \
                     for all values in it; -: it is not.";
        let several = self.value.branches.len() > 1;
        let branches = self.value.branches.iter().enumerate();
        let page = branches.fold(Document::titled(title(self)), |page, (index, branch)| {
            let page = match several {
                true => page.words(format!("Branch {}:", index + 1)),
                false => page,
            };
            let page = page.table(shown(&self.value.parameter, branch));
            branch.ends.iter().fold(page, |page, end| {
                let (name, value, why) = (&self.value.parameter, &end.value, &end.why);
                page.words(format!("Not followed to {name} = {value}: {why}."))
            })
        });
        let others = "There may be other branches.";
        let page = page.words(words);
        if several { page.words(others) } else { page }
    }

    /// The largest x over the parameter, or the frequency where the largest x is given: lines where all values
    /// between are proved.
    fn figure(&self) -> Option<Figure> {
        let points = || self.value.branches.iter().flat_map(|branch| &branch.points);
        let largest = points().map(|point| Some(&point.orbit.maximum.as_ref()?.decimal));
        let mut largest = largest.collect::<Vec<_>>();
        largest.dedup();
        let given = self.value.parameter == "amplitude" || largest.len() < 2;
        let (name, quantity): (&str, Quantity) = match given {
            true => ("frequency", |point| point.orbit.frequency.as_ref()),
            false => ("largest x", |point| point.orbit.maximum.as_ref()),
        };
        let frame = Figure::new(
            title(self),
            parameter(&self.header, &self.value.parameter),
            Axis::linear(name),
        );
        let branches = self.value.branches.iter().enumerate();
        Some(branches.fold(frame, |frame, (index, branch)| {
            let colour = colours::CYCLE[index % colours::CYCLE.len()];
            let at = |point: &ProvedMember| {
                let y = quantity(point).and_then(|number| number.decimal.parse().ok());
                (point.value.to_f64(), y.unwrap_or(f64::NAN))
            };
            let covered = branch.points.iter().flat_map(|point| {
                let proved = point.between.as_ref().is_none_or(|between| between.proved);
                std::iter::once(at(point)).chain((!proved).then_some((f64::NAN, f64::NAN)))
            });
            let covered: Vec<(f64, f64)> = covered.collect();
            let discs: Vec<(f64, f64)> = branch.points.iter().map(at).collect();
            frame.layer(None, Mark::Line(2), colour, covered).layer(
                None,
                Mark::Disc(2),
                colour,
                discs,
            )
        }))
    }

    /// All branches, one row per orbit.
    fn table(&self) -> Option<Table> {
        let numbers =
            COLUMNS.iter().flat_map(|(name, _)| [(*name).to_owned(), format!("{name}_error")]);
        let head = ["branch", &self.value.parameter].map(str::to_owned).into_iter().chain(numbers);
        let table =
            Table::new(head.chain(["stable", "radius", "parts_to_next"].map(str::to_owned)));
        let branches = self.value.branches.iter().enumerate();
        let rows = branches.flat_map(|(i, branch)| branch.points.iter().map(move |p| (i, p)));
        Some(rows.fold(table, |table, (index, point)| {
            let head = [(index + 1).to_string(), point.value.to_f64().to_string()];
            let numbers = COLUMNS.iter().flat_map(|(_, quantity)| {
                let number = quantity(point);
                let decimal = number.map_or_else(String::new, |number| number.decimal.clone());
                [decimal, number.and_then(|number| number.error.clone()).unwrap_or_default()]
            });
            let stable = point.orbit.stable.map_or_else(String::new, |stable| stable.to_string());
            let radius = point.orbit.radius().map_or_else(String::new, |r| r.decimal.clone());
            table.row(head.into_iter().chain(numbers).chain([stable, radius, between(point)]))
        }))
    }
}

/// What a row says, each with its error.
const COLUMNS: [(&str, Quantity); 6] = [
    ("period", |point| point.orbit.period.as_ref()),
    ("frequency", |point| point.orbit.frequency.as_ref()),
    ("x", |point| point.orbit.amplitude.as_ref()),
    ("maximum", |point| point.orbit.maximum.as_ref()),
    ("minimum", |point| point.orbit.minimum.as_ref()),
    ("floquet_exponent", |point| point.orbit.floquet_exponent.first()),
];

/// How many parts prove the interval up to the next value; empty at the last.
fn between(point: &ProvedMember) -> String {
    match &point.between {
        None => String::new(),
        Some(between) if between.proved => between.parts.to_string(),
        Some(_) => "-".to_owned(),
    }
}

fn shown(parameter: &str, branch: &ProvedBranch) -> Table {
    let table = Table::new([parameter, "period", "frequency", "largest x", "stable", "between"]);
    let number = |number: &Option<Number>| match number {
        Some(Number { decimal, error: Some(error), .. }) => format!("{decimal} +- {error}"),
        Some(Number { decimal, .. }) => decimal.clone(),
        None => String::new(),
    };
    branch.points.iter().fold(table, |table, point| {
        let orbit = &point.orbit;
        let stable = match orbit.stable {
            Some(true) => "yes",
            Some(false) => "no",
            None => "",
        };
        table.row([
            point.value.to_string(),
            number(&orbit.period),
            number(&orbit.frequency),
            number(&orbit.maximum),
            stable.to_owned(),
            between(point),
        ])
    })
}
