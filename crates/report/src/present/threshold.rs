//! The threshold of homoclinic chaos: its numbers, its curves, its map.

use super::{Pen, Present, parameter, problem_at};
use crate::figure::{Axis, Colour, Mark, Raster, colours};
use crate::format::line as csv_line;
use crate::{Document, Figure, Formula, Table, Text};
use lindstedt::grid::{self, Grid};
use lindstedt::threshold::{Harmonic, HomoclinicThreshold, SecondOrderThreshold, Sweep};
use lindstedt::unstable::coeff::print::latex_name;
use lindstedt::{Answer, Header, Number, Remark, Standing};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The longest table on a page.
const PRINTED_POINTS: usize = 1000;
/// Up to so many rows are drawn as curves.
const MOST_CURVES: usize = 12;
/// Shades of a map.
const SHADES: f64 = 64.0;
/// The colours of the largest negative value, of zero, and of the largest value.
const DARK: Colour = (110, 35, 0);
const MIDDLE: Colour = (170, 170, 170);
const LIGHT: Colour = (205, 235, 255);

type Line = (Text, Text);

fn gamma_c(words: &str) -> Text {
    Text::from(Formula::new("gamma_c", r"\gamma_c")).and(words)
}

fn line(name: impl Into<Text>, value: impl Into<Text>) -> Line {
    (name.into(), value.into())
}

fn numbers(value: &HomoclinicThreshold) -> Vec<Line> {
    let number = |name: Text, number: &Number| (name, Text::number(number));
    let speed = match &value.cusp {
        Some(_) => Text::marked("V, largest speed, cusp at $|v*| = V$"),
        None => "V, largest speed".into(),
    };
    let mut lines = vec![
        number(gamma_c(""), &value.gamma_c),
        number(gamma_c(" with the sign of D"), &value.signed),
        number("D, work of friction".into(), &value.dissipation),
        number("F, work of the forcing".into(), &value.forcing),
        number(speed, &value.largest_speed),
    ];
    if let Some(cusp) = &value.cusp {
        lines.push(number("signed threshold at the cusp".into(), &cusp.signed));
    }
    lines.extend(value.harmonic.iter().flat_map(harmonic));
    if let Some(b) = value.cusp.as_ref().and_then(|cusp| cusp.touches_zero_at_b.as_ref()) {
        lines.push(line("cusp touches zero at b =", b.to_string()));
    }
    lines
}

/// `gamma/m, the coefficient of cos(omega*t) in x''`.
fn harmonic(harmonic: &Harmonic) -> Vec<Line> {
    let [coefficient, term] = &harmonic.latex;
    let alone = match harmonic.parameter {
        Some(_) => "",
        None => " (a threshold of no single parameter of it)",
    };
    let words = Text::from(Formula::new(&harmonic.coefficient, coefficient))
        .and(", the coefficient of ")
        .formula(Formula::new(&harmonic.term, term))
        .and(" in ")
        .formula(Formula::new("x''", "x''"))
        .and(alone);
    let mut lines = vec![(gamma_c(" is a value of"), words)];
    let parameter = harmonic.parameter.as_ref().zip(harmonic.threshold.as_ref());
    if let Some((name, number)) = parameter.filter(|(name, _)| **name != harmonic.coefficient) {
        lines.push((gamma_c(&format!(" as a value of {name}")), Text::number(number)));
    }
    lines
}

fn orbits(value: &HomoclinicThreshold) -> Vec<Line> {
    let mut lines = Vec::new();
    for orbit in &value.orbits {
        let least = if orbit.least == Some(true) { " (the least)" } else { "" };
        let name = gamma_c(&format!(", {}", orbit.name));
        lines.push((name, format!("{}{least}", orbit.gamma_c.decimal).into()));
        lines.push(line(format!("orbit, {}", orbit.name), orbit.check.as_deref().unwrap_or("-")));
    }
    for resonance in value.subharmonics.iter().flatten() {
        let name = gamma_c(&format!(" of period {}, {}", resonance.m, resonance.around));
        lines.push(line(name, resonance.gamma_c.decimal.as_str()));
    }
    if let Some(of) = &value.zeros_of {
        let name = format!("zero in {}", of.parameter);
        lines.extend(value.zeros.iter().map(|zero| (name.as_str().into(), Text::number(zero))));
        for [low, high] in &of.intervals {
            let interval = format!("[{}, {}]", low.decimal, high.decimal);
            lines.push(line(format!("zeros in {}, all of", of.parameter), interval));
        }
        let note = if of.complete { "complete" } else { "sign changes on a grid" };
        let count = format!("{} ({note})", value.zeros.len());
        lines.push(line(format!("zeros in {}, number", of.parameter), count));
    }
    lines
}

/// gamma_c + slope eps, by both routes.
fn second_order(found: &SecondOrderThreshold) -> Vec<Line> {
    let small = &found.parameter;
    let sum = |value: &Number, slope: &Number| {
        let (sign, size) = match slope.decimal.strip_prefix('-') {
            Some(size) => ("-", size),
            None => ("+", &*slope.decimal),
        };
        let error = |number: &Number| number.error.clone().unwrap_or_default();
        let text = format!("{} {sign} {size}*{small}", value.decimal);
        let latex = format!(r"{} {sign} {size}\,{}", value.decimal, latex_name(small));
        Text::default().formula(Formula::new(text, latex)).and(format!(
            " (estimated, errors {} and {})",
            error(value),
            error(slope)
        ))
    };
    let name = |words: &str| gamma_c(&format!(" to second order{words}, {}", found.name));
    let mut lines = vec![(name(""), sum(&found.gamma_c, &found.slope))];
    if let Some(slope) = &found.slope_below {
        lines.push((name(&format!(" for {small} < 0")), sum(&found.gamma_c, slope)));
    }
    if let Some(manifolds) = &found.manifolds {
        lines.push((name(" from the manifolds"), sum(&manifolds.gamma_c, &manifolds.slope)));
    }
    if let Some(reason) = &found.not_followed {
        lines.push((name(" from the manifolds"), reason.as_str().into()));
    }
    lines
}

/// What the orbits are: both loops of the closed form are homoclinic.
fn kind(value: &HomoclinicThreshold) -> &'static str {
    let checks = value.orbits.iter().filter_map(|orbit| orbit.check.as_deref());
    let mut checks = checks.map(|check| check.starts_with("heteroclinic"));
    match (checks.clone().any(|other| other), checks.any(|other| !other)) {
        (true, true) => "homoclinic or heteroclinic",
        (true, false) => "heteroclinic",
        _ => "homoclinic",
    }
}

/// The verdict with its distances as formulas.
pub(super) fn verdict(words: &str) -> Text {
    let marked = words.replace("||v*| - V|", "$D$").replace("|v*|", "$|v*|$");
    Text::marked(&marked.replace("$|v*|$ = V", "$|v*| = V$").replace("$D$", "$||v*| - V|$"))
}

impl Present for Answer<HomoclinicThreshold> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let mut lines = numbers(value);
        lines.extend(orbits(value));
        lines.extend(value.second_order.iter().flat_map(second_order));
        let crossing = value.homoclinic_points.word();
        lines.push((
            Text::words(format!("transversal {} points at gamma", kind(value))),
            crossing.into(),
        ));
        lines.push((Text::words("validity"), verdict(value.validity.verdict)));
        let remarks = value.remarks.iter().map(|remark| line("remark", remark.0.as_str()));
        lines.extend(remarks);
        if let Some(exact) = &value.gamma_c.exact {
            lines.push((gamma_c(" ="), Text::default().code(exact)));
        }
        let title = problem_at(&self.header);
        let page = Document::titled(title).lines(lines);
        value.sweep.iter().fold(page, |page, sweep| page.append(points(sweep)))
    }

    fn figure(&self) -> Option<Figure> {
        let sweep = self.value.sweep.as_ref()?;
        let Grid { columns, rows, .. } = &sweep.grid;
        match rows {
            Some(rows) if rows.values.len() > MOST_CURVES => (columns.is_equidistant()
                && rows.is_equidistant())
            .then(|| map(sweep, rows, &self.header)),
            _ => Some(curves(sweep, &self.header)),
        }
    }

    /// Every point; numbers with all their digits.
    fn table(&self) -> Option<Table> {
        let mut lines = rows(&self.value.sweep.as_ref()?.grid);
        let head = Table::new(lines.next()?);
        Some(lines.fold(head, Table::row))
    }

    fn shorten(&mut self, points: usize) {
        let Some(sweep) = self.value.sweep.as_mut().filter(|s| s.grid.points.len() > points) else {
            return;
        };
        sweep.grid.points.truncate(points);
        sweep.blanks.iter_mut().for_each(|blank| blank.points.retain(|index| *index < points));
        self.standing = Standing::Stopped { done: sweep.grid.done() };
        self.remarks.push(Remark(format!("stopped; the first {points} points are there")));
    }

    fn csv(&self, take: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
        let grid = &self.value.sweep.as_ref()?.grid;
        let head: Vec<String> = rows(grid).next()?;
        Some(take(&csv_line(&head)) && csv_points(grid, take))
    }
}

/// Every point as a line. Of millions each value is printed once, and into the same line.
fn csv_points(grid: &Grid<f64>, take: &mut dyn FnMut(&str) -> bool) -> bool {
    let texts = |axis: &grid::Axis| -> Vec<String> {
        axis.doubles().iter().map(|x| format!("{x:?},")).collect()
    };
    let (columns, rows) = (texts(&grid.columns), grid.rows.as_ref().map(texts));
    let (mut line, mut digits) = (String::new(), String::new());
    grid.points.chunks(grid.width()).enumerate().all(|(row, points)| {
        let row = rows.as_ref().and_then(|rows| rows.get(row));
        points.iter().zip(&columns).all(|(signed, column)| {
            digits.clear();
            // Writing into a string cannot fail.
            let _ = signed.map(|x| write!(digits, "{x:?}"));
            line.clear();
            let size = digits.strip_prefix('-').unwrap_or(&digits);
            let parts = [row.map_or("", String::as_str), column, size, ",", &digits, "\n"];
            line.extend(parts);
            take(&line)
        })
    })
}

/// The names of the columns, then every point.
fn rows(grid: &Grid<f64>) -> impl Iterator<Item = Vec<String>> {
    let head = names(grid).into_iter().chain(["gamma_c".into(), "signed".into()]).collect();
    let digits = |x: Option<f64>| x.map(|x| format!("{x:?}")).unwrap_or_default();
    let points = doubles(grid).map(move |(place, signed)| {
        let cells = [digits(signed.map(f64::abs)), digits(signed)];
        place.into_iter().map(|x| format!("{x:?}")).chain(cells).collect()
    });
    std::iter::once(head).chain(points)
}

/// The swept parameters, the slower one first.
fn names(grid: &Grid<f64>) -> Vec<String> {
    grid.rows.iter().chain([&grid.columns]).map(|axis| axis.name.clone()).collect()
}

/// Every point with its place, the slower parameter first.
fn doubles(grid: &Grid<f64>) -> impl Iterator<Item = (Vec<f64>, Option<f64>)> {
    let (columns, rows) = (grid.columns.doubles(), grid.rows.as_ref().map(grid::Axis::doubles));
    let width = grid.width();
    grid.points.iter().enumerate().map(move |(index, signed)| {
        let row = rows.as_ref().and_then(|rows| rows.get(index / width));
        (row.into_iter().chain(columns.get(index % width)).copied().collect(), *signed)
    })
}

/// How many points, and the first of them.
fn points(sweep: &Sweep) -> Document {
    let Sweep { grid, blanks, certified, .. } = sweep;
    let status = if *certified { "certified" } else { "estimated, in doubles" };
    let blank = grid.points.len() - grid.done();
    let without = if blank == 0 { String::new() } else { format!(", {blank} without a value") };
    let mut reasons: BTreeMap<usize, &str> = BTreeMap::new();
    for blank in blanks {
        let shown = blank.points.iter().take_while(|index| **index < PRINTED_POINTS);
        reasons.extend(shown.map(|index| (*index, blank.reason.as_str())));
    }
    let head: Vec<Text> = names(grid).into_iter().map(Text::words).collect();
    let table = Table::new(head.into_iter().chain([gamma_c(" with the sign of D")]));
    let rows = doubles(grid).take(PRINTED_POINTS).enumerate().map(|(index, (place, signed))| {
        let value = match signed {
            Some(signed) => format!("{signed:?}"),
            None => format!("- ({})", reasons.get(&index).copied().unwrap_or_default()),
        };
        place.iter().map(f64::to_string).chain([value]).collect::<Vec<_>>()
    });
    let page = Document::default()
        .words(format!("{} points ({status}){without}", grid.points.len()))
        .table(rows.fold(table, Table::row));
    if grid.points.len() > PRINTED_POINTS {
        return page.words("... (--plot FILE.csv has all of them)");
    }
    page
}

/// A family of curves; circles mark zeros, triangles cusps.
fn curves(sweep: &Sweep, header: &Header) -> Figure {
    let grid = &sweep.grid;
    let columns = grid.columns.doubles();
    let marked = if sweep.marks.is_empty() { "" } else { ": circles zeros, triangles cusps" };
    let title = format!("Melnikov threshold of {}{marked}", header.problem);
    let up = Axis::linear("gamma_c");
    let mut figure = Figure::new(title, parameter(header, &grid.columns.name), up);
    for (row, signed) in grid.points.chunks(grid.width()).enumerate() {
        let colour = colours::CYCLE[row % colours::CYCLE.len()];
        let name = grid
            .rows
            .as_ref()
            .and_then(|rows| Some(format!("{} = {}", rows.name, rows.values.get(row)?.to_f64())));
        let line = columns.iter().zip(signed).map(|(x, y)| (*x, y.map_or(f64::NAN, f64::abs)));
        figure = figure.layer(name.as_deref(), Mark::Line(2), colour, line);
        if let Some(marks) = sweep.marks.get(row) {
            let zeros = marks.zeros.iter().map(|x| (*x, 0.0));
            figure = figure.layer(None, Mark::Disc(5), colour, zeros).layer(
                None,
                Mark::Triangle(7),
                colour,
                marks.cusps.iter().copied(),
            );
        }
    }
    figure
}

/// The colour of a signed value over the largest: from dark vermilion, -1, through grey, 0, to light blue, 1, so that the
/// lightness alone tells all of it; small values are spread.
pub fn shade(share: f64) -> Colour {
    let depth = (share.abs().powf(0.4) * SHADES).round() / SHADES;
    let (r, g, b) = if share > 0.0 { LIGHT } else { DARK };
    let mix = |part: u8, end: u8| {
        (f64::from(part) + depth * (f64::from(end) - f64::from(part))).round() as u8
    };
    (mix(MIDDLE.0, r), mix(MIDDLE.1, g), mix(MIDDLE.2, b))
}

/// A map in shades of the signed threshold.
fn map(sweep: &Sweep, rows: &grid::Axis, header: &Header) -> Figure {
    let grid = &sweep.grid;
    let largest = grid.points.iter().flatten().fold(0.0f64, |m, s| m.max(s.abs()));
    let shade = |signed: &f64| shade(signed / largest.max(f64::MIN_POSITIVE));
    let title = format!("signed Melnikov threshold of {}", header.problem);
    let [across, up] = [&grid.columns, rows].map(|axis| parameter(header, &axis.name));
    let range = |axis: &grid::Axis| {
        let values = axis.doubles();
        let end = |x: Option<&f64>| x.copied().unwrap_or(f64::NAN);
        (end(values.first()), end(values.last()), values.len())
    };
    let (columns, rows) = (range(&grid.columns), range(rows));
    let at = |index: usize| grid.points.get(index)?.as_ref().map(shade);
    let cells = Raster::cells((columns.2, rows.2), at);
    let legend = [(1.0, largest), (0.0, 0.0), (-1.0, -largest)];
    let legend = legend.map(|(share, value)| (format!("{value:.3e}"), Some(self::shade(share))));
    let raster = Some(Raster { columns, rows, cells, legend: legend.into() });
    Figure { raster, ..Figure::new(title, across, up) }
}
