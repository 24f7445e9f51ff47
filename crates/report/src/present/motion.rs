//! Motions, their chaos, and bifurcation diagrams.

use super::{Pen, Present, parameter, problem_at};
use crate::figure::{Axis, Colour, Layer, Mark, colours};
use crate::format::line as csv_line;
use crate::{Document, Figure, Formula, Table, Text};
use lindstedt::motion::{
    Begin, Column, Diagnosis, Diagram, Dot, Event, Motion, Section, State, View,
};
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Header, Number};

/// Rows of a list that are printed; tables have all.
const PRINTED: usize = 40;
/// Between pieces of a line.
const GAP: (f64, f64) = (f64::NAN, f64::NAN);

fn formula(text: &str, latex: &str) -> Text {
    Formula::new(text, latex).into()
}

fn velocity() -> Text {
    formula("x'", r"\dot{x}")
}

/// x_k and x_k'.
fn both(name: &str) -> [Formula; 2] {
    let latex = latex_name(name);
    [Formula::new(name, &latex), Formula::new(format!("{name}'"), format!(r"\dot{{{latex}}}"))]
}

/// x before or after an event.
fn jump(word: &str) -> Text {
    velocity().and(format!(" {word}"))
}

/// The problem with its values, and where it starts.
fn head(header: &Header, start: &Begin, history: Option<&str>) -> Document {
    let unknowns = &start.unknowns;
    let title = problem_at(header);
    let chosen = start.chosen.map(|chosen| format!(" ({chosen})")).unwrap_or_default();
    let name = unknowns.first().map_or("x", String::as_str);
    let [own, rate] = both(name);
    let place = Text::from(own).and(format!(" = {}, ", start.x));
    let place = place.formula(rate).and(format!(" = {}", start.v));
    let others = unknowns.iter().skip(1).zip(&start.others);
    let place = others.fold(place, |place, (name, [x, v])| {
        let [own, rate] = both(name);
        place.and(", ").formula(own).and(format!(" = {x}, ")).formula(rate).and(format!(" = {v}"))
    });
    let place = place.and(chosen);
    let history = history.map(|history| (Text::words("history"), Text::words(history)));
    Document::titled(title).lines([(Text::words("start"), place)].into_iter().chain(history))
}

/// The first rows of a table under a title, and how many there are.
fn listed(page: Document, title: &str, table: Table) -> Document {
    let count = table.rows.len();
    if count == 0 {
        return page;
    }
    let rows = table.rows.into_iter().take(PRINTED).collect();
    let page = page.heading(title).table(Table { rows, ..table });
    if count <= PRINTED {
        return page;
    }
    page.words(format!("... {count} in all (--format json, --plot FILE.csv)"))
}

fn cell(number: &Number) -> Text {
    Text::words(number.decimal.as_str())
}

fn states(unknowns: &[String], list: &[State]) -> Table {
    let names = unknowns.iter().map(String::as_str);
    let names: Vec<&str> = if unknowns.is_empty() { vec!["x"] } else { names.collect() };
    let pairs = names.iter().flat_map(|name| both(name)).map(Text::from);
    let head = Table::new([formula("t", "t")].into_iter().chain(pairs));
    list.iter().fold(head, |table, s| {
        let cells = [&s.t, &s.x, &s.v].into_iter().chain(s.others.iter().flatten());
        table.row(cells.map(cell).collect::<Vec<_>>())
    })
}

fn events(list: &[Event]) -> Table {
    let names = [Text::words("event"), formula("t", "t"), formula("x", "x")];
    let head = Table::new(names.into_iter().chain([jump("before"), jump("after")]));
    let row = |e: &Event| {
        let numbers = [&e.t, &e.x, &e.v_before, &e.v_after].map(cell);
        [Text::words(e.kind)].into_iter().chain(numbers)
    };
    list.iter().fold(head, |table, event| table.row(row(event)))
}

impl Present for Answer<Motion> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let unknowns = &value.start.unknowns;
        let mut page = head(&self.header, &value.start, value.history);
        page = listed(page, "events", events(&value.events));
        page = listed(page, "samples", states(unknowns, &value.samples));
        if let Some(section) = &value.section {
            page = listed(page, "section", states(unknowns, &section.points));
        }
        let mut last = states(unknowns, std::slice::from_ref(&value.last));
        if value.last.sticking {
            last.columns.push(Text::default());
            last.rows.iter_mut().for_each(|row| row.push(Text::words("sticking")));
        }
        page = listed(page, "final", last);
        if let Some(growth) = &value.growth {
            let head = Table::new([Text::words("ratio")]);
            let rows = growth.iter().fold(head, |table, ratio| table.row([cell(ratio)]));
            page = listed(page, "growth per impact", rows);
        }
        let digits = if value.last.x.error.is_some() { "; digits estimated by 8 more" } else { "" };
        page.words(format!("{} ({} steps{digits})", value.verdict, value.work.steps))
    }

    fn figure(&self) -> Option<Figure> {
        Some(match self.value.view {
            View::Section => section_figure(self),
            view => line_figure(self, view == View::Phase),
        })
    }

    /// All points of the line, with the events and the section.
    fn table(&self) -> Option<Table> {
        let mut lines = rows(&self.value);
        let head = Table::new(lines.next()?);
        Some(lines.fold(head, Table::row))
    }

    fn csv(&self, take: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
        Some(rows(&self.value).all(|cells| take(&csv_line(&cells))))
    }
}

/// The names of the columns, then all points of the line, the events, the section; of several unknowns, of which a
/// line has the first alone, the samples.
fn rows(value: &Motion) -> impl Iterator<Item = Vec<String>> {
    let others = value.start.unknowns.get(1..).unwrap_or_default();
    let names = others.iter().flat_map(|name| [name.clone(), format!("{name}'")]);
    let head = ["what", "t", "x", "v"].map(str::to_owned).into_iter().chain(names).collect();
    let row = |what: &str, place: [f64; 3]| {
        let place = place.map(|x| format!("{x:?}"));
        [what.to_owned()].into_iter().chain(place)
    };
    let one = move |what: &str, place: [f64; 3]| -> Vec<String> {
        row(what, place).chain(vec![String::new(); 2 * others.len()]).collect()
    };
    let dots = value.line.iter().map(move |dot| {
        one(if dot.stuck { "sticking" } else { "moving" }, [dot.time, dot.x, dot.v])
    });
    let events = value.events.iter().map(move |event| {
        let [t, x, _, v] = event.place;
        one(event.kind, [t, x, v])
    });
    let points = value.section.iter().flat_map(|section| &section.points);
    let points = points.map(move |point| one("section", point.place));
    let samples = value.samples.iter().filter(move |_| !others.is_empty());
    let samples = samples.map(move |state| {
        let others = state.others.iter().flatten().map(|x| x.decimal.clone());
        row("sample", state.place).chain(others).collect()
    });
    std::iter::once(head).chain(dots).chain(events).chain(points).chain(samples)
}

/// Where the file has units for parameters, those of x and t follow from them.
fn axis(header: &Header, words: &str) -> Axis {
    match header.units.is_empty() {
        true => Axis::linear(format!("{words} (dimensionless)")),
        false => parameter(header, words),
    }
}

/// On a wall or at maxima one coordinate is constant: the points in time tell more.
fn section_figure(answer: &Answer<Motion>) -> Figure {
    let section = answer.value.section.as_ref();
    let places: Vec<[f64; 3]> =
        section.iter().flat_map(|s| &s.points).map(|state| state.place).collect();
    let (kind, across, up, pick) = match section.map(|section| section.kind) {
        Some(Section::Stroboscopic) => {
            ("once per period of the force", "displacement x", "velocity x'", [1, 2])
        }
        Some(Section::Impact) => {
            ("just before impacts", "time t", "velocity x' before impact", [0, 2])
        }
        _ => ("at maxima of x", "time t", "maximum of x", [0, 1]),
    };
    let name = &answer.header.problem;
    let title = format!("{name}: Poincare section {kind}, {} points", places.len());
    let mark = Mark::Disc(if places.len() > 500 { 1 } else { 3 });
    let points = places.iter().map(|place| (place[pick[0]], place[pick[1]]));
    Figure::new(title, axis(&answer.header, across), axis(&answer.header, up)).layer(
        None,
        mark,
        colours::BLUE,
        points,
    )
}

/// Moving and sticking apart; in the phase plane broken where the velocity jumps.
fn line_figure(answer: &Answer<Motion>, phase: bool) -> Figure {
    let Motion { line, events, .. } = &answer.value;
    let end = line.last().map_or(0.0, |dot| dot.time);
    let (what, across, up) = if phase {
        ("phase portrait", "displacement x", "velocity x'")
    } else {
        ("time series", "time t", "displacement x")
    };
    let title = format!("{}: {what} to t = {end:.4}", answer.header.problem);
    let mut figure = Figure::new(title, axis(&answer.header, across), axis(&answer.header, up));
    let kinds = [
        ("moving", false, Mark::Line(if phase { 1 } else { 2 }), colours::BLUE),
        ("sticking, or at rest at the wall", true, Mark::Line(4), colours::VERMILION),
    ];
    for (name, stuck, mark, colour) in kinds {
        figure = with(figure, name, mark, colour, pieces(&answer.value.line, phase, stuck));
    }
    let of = |kind: &'static str| events.iter().filter(move |e| e.kind == kind);
    if !phase {
        let impacts = of("impact").map(|e| (e.place[0], e.place[1])).collect();
        return with(figure, "impact", Mark::Triangle(6), colours::VERMILION, impacts);
    }
    let jump = |e: &Event| [(e.place[1], e.place[2]), (e.place[1], e.place[3]), GAP];
    let jumps = of("impact").flat_map(jump).collect();
    figure = with(figure, "impact", Mark::Dashed(1), colours::GREY, jumps);
    for (kind, name, mark) in
        [("stick", "stick begins", Mark::Disc(4)), ("slip", "slip begins", Mark::Ring(4))]
    {
        let points = of(kind).map(|e| (e.place[1], e.place[3])).collect();
        figure = with(figure, name, mark, colours::VERMILION, points);
    }
    figure
}

/// The figure with a layer, where there is something in it.
fn with(
    mut figure: Figure,
    name: &str,
    mark: Mark,
    colour: Colour,
    points: Vec<(f64, f64)>,
) -> Figure {
    if !points.is_empty() {
        let name = Some(name.to_owned());
        figure.layers.push(Layer { name, points, mark, colour, labels: Vec::new() });
    }
    figure
}

/// The line of a motion, moving or sticking, in pieces.
fn pieces(line: &[Dot], phase: bool, stuck: bool) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (index, dot) in line.iter().enumerate().filter(|(_, dot)| dot.stuck == stuck) {
        let before = index.checked_sub(1).and_then(|index| line.get(index));
        let goes_on = before.is_some_and(|before| {
            let jumps = before.time == dot.time && (before.v - dot.v).abs() > 1e-9;
            before.stuck == stuck && !(phase && jumps)
        });
        if !goes_on && !points.is_empty() {
            points.push(GAP);
        }
        points.push(if phase { (dot.x, dot.v) } else { (dot.time, dot.x) });
    }
    points
}

impl Present for Answer<Diagnosis> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let mut page = head(&self.header, &value.start, value.history);
        if let Some(found) = &value.lyapunov {
            page = page.heading("largest Lyapunov exponent").lines([
                (Text::words("exponent"), Text::number(&found.number)),
                (
                    Text::words("from"),
                    Text::words(format!(
                        "{} intervals of {} after {}",
                        value.kept, found.interval, value.skip
                    )),
                ),
            ]);
            page = page.words(found.estimate);
        }
        if let Some(test) = &value.zero_one {
            let k = formula("K", "K");
            let head = Table::new([Text::words("every"), k, "quartiles".into(), "".into()]);
            let table = test.k.iter().fold(head, |table, test| {
                let quartiles = test.quartiles.map(|q| format!("{q:.4}").into());
                let row = [test.every.to_string().into(), Text::number(&test.k)];
                table.row(row.into_iter().chain(quartiles))
            });
            page = page.heading("0-1 test").table(table);
            page = page.words(format!("of {}: {}", test.series, test.estimate));
        }
        page.words(value.verdict.as_str())
    }
}

impl Present for Answer<Diagram> {
    /// What the points span, per value; the points themselves belong into a file.
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let (coordinate, what) = value.sweep.ordinate();
        let head = Table::new([
            value.sweep.parameter.as_str(),
            "points",
            &format!("{what}: least"),
            "largest",
            "",
        ]);
        let rows = |columns: &[Column]| {
            columns.iter().fold(head.clone(), |table, column| {
                table.row(spanned(column, coordinate, value.sweep.kept))
            })
        };
        let page = self::head(&self.header, &value.start, value.history);
        let page = match &value.sweep.back {
            None => listed(page, "sweep", rows(&value.sweep.columns)),
            Some(back) => {
                let page = listed(page, "upwards", rows(&value.sweep.columns));
                listed(page, "downwards", rows(back))
            }
        };
        page.words(value.verdict.as_str())
    }

    fn figure(&self) -> Option<Figure> {
        let sweep = &self.value.sweep;
        let (coordinate, up) = sweep.ordinate();
        let points = sweep.columns.iter().flat_map(|column| {
            column.points.iter().map(move |point| (column.value, point[coordinate]))
        });
        let title = format!(
            "{}: bifurcation diagram, {} values, {} points each after {}",
            self.header.problem,
            sweep.columns.len(),
            sweep.kept,
            sweep.skip
        );
        let figure =
            Figure::new(title, axis(&self.header, &sweep.parameter), axis(&self.header, up));
        let Some(back) = &sweep.back else {
            return Some(figure.layer(None, Mark::Disc(1), colours::BLUE, points));
        };
        let down = back.iter().flat_map(|column| {
            column.points.iter().map(move |point| (column.value, point[coordinate]))
        });
        let figure = figure.layer(Some("upwards"), Mark::Triangle(4), colours::BLUE, points);
        Some(figure.layer(Some("downwards"), Mark::Disc(2), colours::VERMILION, down))
    }

    fn table(&self) -> Option<Table> {
        let sweep = &self.value.sweep;
        let mut table = Table::new([sweep.parameter.as_str(), "x", "v"]);
        for column in sweep.columns.iter().chain(sweep.back.iter().flatten()) {
            // What has no end as a decimal number is rounded: a column of numbers.
            let rounded = column.exact.contains(['/', 'p']);
            let value = if rounded { format!("{:?}", column.value) } else { column.exact.clone() };
            for [x, v] in &column.points {
                table = table.row([value.clone(), format!("{x:?}"), format!("{v:?}")]);
            }
        }
        Some(table)
    }
}

/// A value with the number of its points, the least and the largest, or why there are none.
fn spanned(column: &Column, coordinate: usize, kept: u32) -> [String; 5] {
    let values = || column.points.iter().map(|point| point[coordinate]);
    let count = column.points.len();
    let ceased = if count < kept as usize { "then the events cease" } else { "" };
    let (least, largest, words) = match &column.failure {
        Some(reason) => (String::new(), String::new(), reason.as_str()),
        None if count == 0 => {
            (String::new(), String::new(), "the events of the section cease before")
        }
        None => {
            let least = values().fold(f64::INFINITY, f64::min);
            let largest = values().fold(f64::NEG_INFINITY, f64::max);
            (format!("{least:.9}"), format!("{largest:.9}"), ceased)
        }
    };
    [column.exact.clone(), count.to_string(), least, largest, words.to_owned()]
}
