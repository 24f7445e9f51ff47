//! Steady states at resonance: the states, the response curve with its backbone.

use super::{Pen, Present, parameter, stability_word, values};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Formula, Table, Text};
use lindstedt::respond::{
    Change, Corner, Destination, Estimate, Point, Reading, Response, State, States,
};
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Number, Standing};

/// The number of an unknown in names, where there are several.
fn index(value: &Response, j: usize) -> String {
    if value.turns.len() == 1 { String::new() } else { format!("_{}", j + 1) }
}

fn title(answer: &Answer<Response>) -> String {
    let order = answer.header.order.unwrap_or_default();
    let over = answer.value.parameter.as_ref().map(|name| match &answer.value.second {
        None => format!(" over {name}"),
        Some(second) => format!(" over {name} and {second}"),
    });
    format!("{}: steady states{}, order {order}", answer.header.problem, over.unwrap_or_default())
}

fn word(stable: Option<bool>, near_resonance: Option<Estimate>) -> &'static str {
    stability_word(stable, if near_resonance.is_some() { "undecided" } else { "neutral" })
}

/// So many decimals, or as many digits in powers of ten where that leaves few or is long.
fn decimals(x: f64, count: usize) -> String {
    let size = x.abs();
    match size == 0.0 || (100.0 * 0.1f64.powi(count as i32)..1e6).contains(&size) {
        true => format!("{x:.count$}"),
        false => format!("{x:.count$e}"),
    }
}

fn exponent([re, im]: &[Estimate; 2]) -> String {
    let part = |x| decimals(x, 6);
    if im.value == 0.0 {
        part(re.value)
    } else {
        let sign = if im.value < 0.0 { '-' } else { '+' };
        format!("{} {sign} {}i", part(re.value), part(im.value.abs()))
    }
}

fn amplitude(value: &Response, j: usize) -> Text {
    let index = index(value, j);
    Formula::new(format!("a{index}"), format!("a{index}")).into()
}

fn phase(value: &Response, j: usize) -> Text {
    let index = index(value, j);
    Formula::new(format!("phi{index}"), format!(r"\varphi{index}")).into()
}

/// Whether states turn in frames of their own.
fn drifts(states: &States) -> bool {
    states.list.iter().any(|state| !state.drift.is_empty())
}

/// Whether states have frequencies of their own: those without a force.
fn is_free(states: &States) -> bool {
    states.list.iter().any(|state| state.frequency.is_some())
}

/// An estimate that may be missing.
fn frequency(x: Option<Estimate>) -> String {
    x.map_or("-".to_owned(), |x| format!("{:.9}", x.value))
}

fn columns(value: &Response) -> impl Iterator<Item = Text> {
    (0..value.turns.len()).flat_map(|j| [amplitude(value, j), phase(value, j)])
}

fn state(state: &State, free: bool, drifts: bool) -> Vec<Text> {
    let pairs = state.amplitudes.iter().zip(&state.phases);
    let phase = |phase: &Option<Number>| phase.as_ref().map_or("-".into(), Text::number);
    let mut cells: Vec<Text> = pairs.flat_map(|(a, p)| [Text::number(a), phase(p)]).collect();
    let exponents: Vec<String> = state.exponents.iter().map(exponent).collect();
    if free {
        cells.push(frequency(state.frequency).into());
    }
    cells.extend([word(state.stable, state.near_resonance).into(), exponents.join(", ").into()]);
    if drifts {
        let rates = state.drift.iter().map(|rate| decimals(rate.value, 6));
        cells.push(rates.collect::<Vec<_>>().join(", ").into());
    }
    cells
}

fn states(value: &Response, states: &States) -> Table {
    let free = is_free(states);
    let drifts = drifts(states) && !free;
    let head = columns(value).chain(free.then(|| "frequency".into()));
    let head = head.chain(["stability".into(), "exponents".into()]);
    let head = head.chain(drifts.then(|| "rates in the frame".into()));
    let rows = states.list.iter().map(|it| state(it, free, drifts));
    rows.fold(Table::new(head), Table::row)
}

fn proof(states: &States) -> String {
    let proof = match (states.count_proved, states.undecided + states.at_edge) {
        (true, _) => "exactly so many, proved",
        (false, 0) => "estimated: coefficients that cannot be told from zero are left out",
        (false, _) => "number not decided",
    };
    let open = match states.undecided {
        0 => String::new(),
        n => format!("; {n} parts of the box are undecided"),
    };
    let edge = match states.at_edge {
        0 => String::new(),
        n => format!("; of {n} more is not decided whether they lie in the box"),
    };
    format!("{} ({proof}{open}{edge})", states.count)
}

fn changes(value: &Response) -> impl Iterator<Item = (&'static str, &Change)> {
    let list = |name, list| std::iter::repeat(name).zip(list);
    list("fold", &value.folds)
        .chain(list("Hopf point", &value.hopf))
        .chain(list("crossing of branches", &value.crossings))
}

/// The searches and the points of change of a sweep.
fn sweep(value: &Response, name: &str, absence: bool) -> Document {
    let formula = || Text::from(Formula::new(name, latex_name(name)));
    let searches = value.states.iter().map(|states| {
        let value = states.value.as_ref();
        let at = value.and_then(|value| value.exact.clone()).unwrap_or_default();
        let count = |known| states.list.iter().filter(|state| state.stable == known).count();
        let neutral = match count(None) {
            0 => String::new(),
            n => format!(", neutral or undecided {n}"),
        };
        [at, proof(states), format!("{}{neutral}", count(Some(true)))]
    });
    let head: [Text; 3] = [formula(), "steady states".into(), "of them stable".into()];
    let page = Document::default().table(searches.fold(Table::new(head), Table::row));
    let head = ["".into(), formula()].into_iter();
    let table = Table::new(head.chain((0..value.turns.len()).map(|j| amplitude(value, j))));
    let mut rows = changes(value).peekable();
    if rows.peek().is_none() {
        return if absence { page.words("no folds, no Hopf points") } else { page };
    }
    page.table(rows.fold(table, |table, (word, change)| {
        let amplitudes = change.amplitudes.iter().map(Text::number);
        let cells = [word.into(), Text::number(&change.value)].into_iter();
        table.row(cells.chain(amplitudes).collect::<Vec<_>>())
    }))
}

/// The equation itself, integrated upwards and downwards.
const FOLLOWED: [(&str, Mark); 2] = [("upwards", Mark::Cross(4)), ("downwards", Mark::Ring(3))];

/// The largest step from one value to the next, upwards and downwards: where the motion jumps.
fn jumps(value: &Response, name: &str) -> Option<Document> {
    let followed = value.followed.as_ref()?;
    let formula = Text::from(Formula::new(name, latex_name(name)));
    let head: [Text; 4] = ["".into(), formula, "amplitudes".into(), "then".into()];
    let row = |(list, (word, _)): (&Vec<Reading>, (&str, Mark))| {
        let of = |k: usize| list[k].amplitudes.iter().flatten().map(|a| a.value);
        let step =
            |k: &usize| of(k - 1).zip(of(*k)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let settled = |k: usize| list[k].amplitudes.is_some();
        let steps = (1..list.len()).filter(|k| settled(k - 1) && settled(*k));
        let k = steps.max_by(|a, b| step(a).total_cmp(&step(b)))?;
        // What is nothing beside the largest amplitudes is shown as zero.
        let least = 1e-6 * value.amplitude_limit.value;
        let own = |a: f64| decimals(if a < least { 0.0 } else { a }, 6);
        let shown = |k| of(k).map(own).collect::<Vec<_>>().join(", ");
        let at = format!("{} .. {}", list[k - 1].value.value, list[k].value.value);
        Some([word.to_owned(), at, shown(k - 1), shown(k)])
    };
    let mut rows = followed.iter().zip(FOLLOWED).filter_map(row).peekable();
    rows.peek()?;
    let table = rows.fold(Table::new(head), Table::row);
    Some(
        Document::default()
            .heading("the equation itself, integrated: its largest step")
            .table(table),
    )
}

/// Where a start state goes, in words.
fn leads_to(to: &Destination) -> String {
    let words = match (to.fate, to.state) {
        (_, Some(state)) => format!("state {} of the table", state + 1),
        ("steady", None) => "a steady state beyond the box".to_owned(),
        ("cycle", None) => "no steady state: the amplitudes go round a cycle".to_owned(),
        _ => return format!("not known: {}", to.doubt.unwrap_or_default()),
    };
    words + &to.doubt.map_or_else(String::new, |doubt| format!("; not decided: {doubt}"))
}

fn corners(value: &Response) -> impl Iterator<Item = (&'static str, &Corner)> {
    let list = |name, list| std::iter::repeat(name).zip(list);
    list("cusp", &value.cusps).chain(list("Bogdanov-Takens point", &value.bogdanov_takens))
}

/// The points in the plane of two parameters.
fn plane(value: &Response, names: [&String; 2], absence: bool) -> Document {
    let count = |kind| value.curves.iter().filter(|curve| curve.kind == kind).count();
    let words = format!("curves: {} of folds, {} of Hopf points", count("fold"), count("hopf"));
    let formula = |name: &String| Text::from(Formula::new(name, latex_name(name)));
    let head = ["".into()].into_iter().chain(names.map(formula));
    let table = Table::new(head.chain((0..value.turns.len()).map(|j| amplitude(value, j))));
    let rows: Vec<_> = corners(value).collect();
    let page = Document::default().words(words);
    if rows.is_empty() {
        return if absence {
            page.words("no cusps, no Bogdanov-Takens points on them; a curve that passes none of the values searched is not among these")
        } else {
            page
        };
    }
    page.table(rows.into_iter().fold(table, |table, (word, corner)| {
        let numbers = corner.values.iter().chain(&corner.amplitudes).map(Text::number);
        table.row([word.into()].into_iter().chain(numbers).collect::<Vec<_>>())
    }))
}

/// k_1 eta_1 + k_2 eta_2 + ... from `k_1, k_2, ...`, of one phase k eta; as text and as LaTeX.
pub fn angle(turns: &str) -> [String; 2] {
    let list: Vec<&str> = turns.split(", ").collect();
    let mut lines = [String::new(), String::new()];
    for (l, turn) in list.iter().enumerate().filter(|(_, turn)| **turn != "0") {
        let i = if list.len() == 1 { String::new() } else { format!("_{}", l + 1) };
        let size = turn.trim_start_matches('-');
        let sign = match (lines[0].is_empty(), size == *turn) {
            (true, true) => "",
            (true, false) => "-",
            (false, true) => " + ",
            (false, false) => " - ",
        };
        let [text, latex] = match size.split_once('/') {
            _ if size == "1" => Default::default(),
            None => [format!("{size} "), format!("{size} ")],
            Some((p, q)) => [format!("({size}) "), format!(r"\frac{{{p}}}{{{q}}} ")],
        };
        lines[0] += &format!("{sign}{text}eta{i}");
        lines[1] += &format!(r"{sign}{latex}\eta{i}");
    }
    lines
}

fn decimal(number: &Number) -> f64 {
    number.decimal.parse().unwrap_or(f64::NAN)
}

/// Curves of folds and of Hopf points in the plane of two parameters.
fn curves(value: &Response, title: String, [across, up]: [Axis; 2]) -> Figure {
    let mut figure = Figure::new(title, across, up);
    for curve in &value.curves {
        let (name, colour) = match curve.kind {
            "fold" => ("folds", colours::BLUE),
            _ => ("Hopf points", colours::VERMILION),
        };
        let points = curve.points.iter().map(|[x, y]| (x.value, y.value));
        figure = figure.layer(Some(name), Mark::Line(2), colour, points);
    }
    for (word, corner) in corners(value) {
        let [x, y] = &corner.values;
        let mark = if word == "cusp" { Mark::Disc(4) } else { Mark::Triangle(6) };
        figure = figure.layer(Some(word), mark, colours::BLACK, [(decimal(x), decimal(y))]);
    }
    figure
}

impl Present for Answer<Response> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let at = values(&self.header);
        let whole = if value.complete {
            "all states of the truncated slow flow lie in it"
        } else {
            "the truncated slow flow may have states beyond"
        };
        let limit =
            format!("amplitudes up to {}: {whole}", decimals(value.amplitude_limit.value, 4));
        let mut lines: Vec<(Text, Text)> = vec![("box".into(), limit.into())];
        if !at.is_empty() {
            lines.insert(0, ("at".into(), at.join(", ").into()));
        }
        let motion = |(j, turns): (usize, &String)| {
            let i = index(value, j);
            let [text, latex] = angle(turns);
            let name = value.coordinates.get(j).map_or("x", String::as_str);
            let text = format!("{name} = a{i} cos({text} + phi{i}) + ...");
            let x = latex_name(name);
            let latex = format!(r"{x} = a{i} \cos({latex} + \varphi{i}) + \ldots");
            ("motion".into(), Formula::new(text, latex).into())
        };
        lines.extend(value.turns.iter().enumerate().map(motion));
        let own = |[text, latex]: &[String; 2]| ("modes".into(), Formula::new(text, latex).into());
        lines.extend(value.modes.iter().map(own));
        // Of what was not looked for to the end nothing is said to be absent.
        let stopped = matches!(self.standing, Standing::Stopped { .. });
        if stopped {
            let words = "before the end: there may be more of everything below";
            lines.push(("stopped".into(), words.into()));
        }
        if let (Some(first), Some(second)) = (&value.parameter, &value.second) {
            return Document::titled(title(self)).lines(lines).append(plane(
                value,
                [first, second],
                !stopped,
            ));
        }
        if let Some(name) = &value.parameter {
            let closed = value.branches.iter().filter(|branch| branch.closed).count();
            let points: usize = value.branches.iter().map(|branch| branch.points.len()).sum();
            let count = value.branches.len();
            let words = format!("{count}, of them {closed} closed; {points} points");
            lines.push(("branches".into(), words.into()));
            let page =
                Document::titled(title(self)).lines(lines).append(sweep(value, name, !stopped));
            return jumps(value, name).into_iter().fold(page, Document::append);
        }
        let found = value.states.first();
        lines.extend(found.map(|states| ("steady states".into(), proof(states).into())));
        let to =
            value.leads_to.as_ref().map(|to| ("the start leads to".into(), leads_to(to).into()));
        lines.extend(to);
        let page = Document::titled(title(self)).lines(lines);
        found.into_iter().fold(page, |page, found| page.table(states(value, found)))
    }

    /// Amplitudes over the parameter, stable and unstable parts drawn apart, the backbone below them.
    fn figure(&self) -> Option<Figure> {
        let value = &self.value;
        let name = value.parameter.as_ref()?;
        if let Some(second) = &value.second {
            let axes = [name, second].map(|name| parameter(&self.header, name));
            return Some(curves(value, title(self), axes));
        }
        let up = Axis::linear(if value.turns.len() == 1 { "amplitude" } else { "amplitudes" });
        let mut figure = Figure::new(title(self), parameter(&self.header, name), up);
        if !value.backbone.is_empty() {
            let points = value.backbone.iter().map(|[x, a]| (x.value, a.value));
            figure = figure.layer(Some("free motion"), Mark::Line(1), colours::GREY, points);
        }
        for j in 0..value.turns.len() {
            let colour = colours::CYCLE[j % colours::CYCLE.len()];
            for branch in &value.branches {
                for (kind, part) in parts(&branch.points) {
                    let whole = matches!(kind, "stable" | "neutral");
                    let mark = if whole { Mark::Line(2) } else { Mark::Dashed(2) };
                    let name = format!("{kind}{}", index(value, j).replace('_', " "));
                    let points = part.iter().map(|p| (p.value.value, p.amplitudes[j].value));
                    figure = figure.layer(Some(&name), mark, colour, points);
                }
            }
        }
        for (k, list) in value.followed.iter().flatten().enumerate() {
            let (name, mark) = FOLLOWED[k.min(1)];
            let points = list.iter().flat_map(|reading| {
                let amplitudes = reading.amplitudes.iter().flatten();
                amplitudes.map(|a| (reading.value.value, a.value))
            });
            figure = figure.layer(Some(name), mark, colours::BLACK, points);
        }
        for (word, change) in changes(value) {
            let points = change.amplitudes.iter().map(|a| (decimal(&change.value), decimal(a)));
            let mark = match word {
                "fold" => Mark::Disc(4),
                "Hopf point" => Mark::Triangle(5),
                _ => Mark::Square(4),
            };
            figure = figure.layer(Some(word), mark, colours::BLACK, points);
        }
        Some(figure)
    }

    /// Every point of every branch; without a sweep every state.
    fn table(&self) -> Option<Table> {
        let value = &self.value;
        let Some(name) = &value.parameter else {
            return value.states.first().map(|found| states(value, found));
        };
        if value.second.is_some() {
            return self.figure().map(|figure| figure.table());
        }
        let mut head = vec!["branch".to_owned(), name.clone()];
        let numbers = 0..value.turns.len();
        head.extend(
            numbers
                .map(|j| index(value, j))
                .flat_map(|j| [format!("amplitude{j}"), format!("phase{j}")]),
        );
        let points = value.branches.iter().flat_map(|branch| &branch.points);
        let free = points.clone().any(|point| point.frequency.is_some());
        head.extend(free.then(|| "frequency".to_owned()));
        head.push("stable".to_owned());
        let longest = points.map(|point| point.exponents.len()).max().unwrap_or(0);
        head.extend((1..=longest).flat_map(|k| [format!("re_{k}"), format!("im_{k}")]));
        let branches = value.branches.iter().enumerate();
        let rows = branches.flat_map(|(n, branch)| branch.points.iter().map(move |p| (n, p)));
        let digits = |x: &Estimate| format!("{:?}", x.value);
        let width = head.len();
        let table = rows.fold(Table::new(head), |table, (n, point)| {
            let mut cells = vec![n.to_string(), digits(&point.value)];
            let pairs = point.amplitudes.iter().zip(&point.phases);
            cells.extend(pairs.flat_map(|(a, phase)| [digits(a), digits(phase)]));
            cells.extend(free.then(|| point.frequency.as_ref().map_or(String::new(), digits)));
            cells.push(word(point.stable, point.near_resonance).to_owned());
            cells.extend(point.exponents.iter().flatten().map(digits));
            table.row(cells)
        });
        let followed = value.followed.iter().flatten().zip(FOLLOWED);
        let readings = followed.flat_map(|(list, (name, _))| list.iter().map(move |r| (name, r)));
        Some(readings.fold(table, |table, (name, reading)| {
            let mut cells = vec![name.to_owned(), digits(&reading.value)];
            let pairs = reading.amplitudes.iter().flatten().zip(reading.phases.iter().flatten());
            cells.extend(pairs.flat_map(|(a, phase)| [digits(a), digits(phase)]));
            cells.resize(width, String::new());
            table.row(cells)
        }))
    }
}

/// Runs of points that are equally stable; each begins with the last point of the one before. A single neutral point, a
/// fold, counts to what is before it.
fn parts(points: &[Point]) -> Vec<(&'static str, &[Point])> {
    let mut parts = Vec::new();
    let (mut first, mut own) = (0, word(None, None));
    for (k, point) in points.iter().enumerate() {
        let kind =
            Some(word(point.stable, point.near_resonance)).filter(|it| *it != word(None, None));
        let kind = kind.unwrap_or(own);
        if kind != own && own != word(None, None) {
            parts.push((own, &points[first..k]));
            first = k - 1;
        }
        own = kind;
    }
    parts.push((own, &points[first..]));
    parts
}
