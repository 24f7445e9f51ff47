//! What the figures of `simulate` and `verify` share.

use crate::failure::{Failure, NO_ANSWER};
use crate::output;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

pub const BLUE: RGBColor = RGBColor(31, 90, 166);
pub const RED: RGBColor = RGBColor(200, 60, 40);
const SIZE: (u32, u32) = (960, 640);
/// The library places points on whole units: the picture is drawn so many times larger and the
/// heading of the file says how large it is shown.
pub const FINE: u32 = 10;

/// An entry of the legend.
#[derive(Clone, Copy)]
pub enum Mark {
    Line(RGBColor, u32),
    Disc(RGBColor),
    Ring(RGBColor),
    Triangle(RGBColor),
}

/// A style of that width in shown units.
pub fn stroke(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(width * FINE)
}

pub type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

pub fn is(path: &Path, kind: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind))
}

/// Refuses names that are neither figure nor table.
pub fn check(paths: &[PathBuf]) -> Result<(), Failure> {
    match paths.iter().find(|path| !is(path, "svg") && !is(path, "csv")) {
        None => Ok(()),
        Some(path) => {
            let message = format!("cannot plot to {}", path.display());
            Err(Failure::usage("plot", message, "the name must end in .svg or .csv"))
        }
    }
}

/// Writes the table or the figure, as the name says.
pub fn write(
    path: &Path,
    table: impl FnOnce() -> Result<String, Failure>,
    figure: impl FnOnce() -> Result<String, Failure>,
) -> Result<(), Failure> {
    let contents = if is(path, "csv") { table()? } else { figure()? };
    std::fs::write(path, contents)
        .map_err(|error| output::trouble(&path.display().to_string(), &error))
}

fn range(values: impl Iterator<Item = f64>) -> Option<std::ops::Range<f64>> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // A margin keeps marks on the frame visible, and a single value drawable.
    let margin = 0.04 * (high - low).max(1e-6 * high.abs()).max(1e-9);
    (low <= high && (high - low).is_finite()).then_some(low - margin..high + margin)
}

/// A chart over the range of the points, with axes named and a legend above; `draw` fills it.
pub fn chart(
    title: &str,
    labels: &(String, String),
    legend: &[(&str, Mark)],
    points: &[(f64, f64)],
    draw: impl FnOnce(&mut Chart<'_, '_>) -> Drawn,
) -> Result<String, Failure> {
    sized(SIZE, (title, labels, legend), points, draw)
}

/// The same of another size: the smaller, the larger the letters when it is scaled to a page.
pub fn sized(
    size: (u32, u32),
    (title, labels, legend): (&str, &(String, String), &[(&str, Mark)]),
    points: &[(f64, f64)],
    draw: impl FnOnce(&mut Chart<'_, '_>) -> Drawn,
) -> Result<String, Failure> {
    let mut svg = String::new();
    let drawn = || -> Drawn {
        let xs = range(points.iter().map(|p| p.0)).ok_or("no finite abscissa")?;
        let ys = range(points.iter().map(|p| p.1)).ok_or("no finite ordinate")?;
        let large = (size.0 * FINE, size.1 * FINE);
        let root = SVGBackend::with_string(&mut svg, large).into_drawing_area();
        root.fill(&WHITE)?;
        let font = |size: u32| ("sans-serif", size * FINE);
        let (heading, body) = root.split_vertically(36 * FINE);
        heading.draw_text(
            title,
            &font(17).into_text_style(&heading),
            ((24 * FINE) as i32, (12 * FINE) as i32),
        )?;
        let strip = if legend.is_empty() { 4 } else { 26 };
        let (key, body) = body.split_vertically(strip * FINE);
        entries(&key, legend)?;
        let (across, up) = (decimals(&xs), decimals(&ys));
        let whole = ys.start.abs().max(ys.end.abs()).log10().max(0.0) as u32;
        let width = 52 + 8 * (up as u32 + whole);
        let mut chart = ChartBuilder::on(&body)
            .margin(12 * FINE)
            .margin_right(28 * FINE)
            .x_label_area_size(48 * FINE)
            .y_label_area_size(width * FINE)
            .build_cartesian_2d(xs.clone(), ys.clone())?;
        let shown = |x: &f64, places: usize, range: &std::ops::Range<f64>| {
            // No "-0.0".
            let x = if x.abs() < 1e-9 * (range.end - range.start) { 0.0 } else { *x };
            format!("{x:.places$}")
        };
        chart
            .configure_mesh()
            .x_desc(labels.0.as_str())
            .y_desc(labels.1.as_str())
            .axis_desc_style(font(15))
            .label_style(font(13))
            .x_label_formatter(&|x| shown(x, across, &xs))
            .y_label_formatter(&|y| shown(y, up, &ys))
            .set_all_tick_mark_size((5 * FINE) as i32)
            .axis_style(stroke(BLACK, 1))
            .light_line_style(WHITE)
            .bold_line_style(stroke(RGBColor(232, 232, 232), 1))
            .draw()?;
        draw(&mut chart)?;
        root.present()?;
        Ok(())
    };
    drawn().map_err(|error| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    })?;
    let large = format!("width=\"{}\" height=\"{}\"", size.0 * FINE, size.1 * FINE);
    let small = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    Ok(svg.replacen(&large, &small, 1))
}

/// The legend: marks with words, in a row.
fn entries(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    legend: &[(&str, Mark)],
) -> Drawn {
    let fine = FINE as i32;
    let (mut x, y) = (24 * fine, 10 * fine);
    let radius = 4 * fine;
    for (word, mark) in legend {
        let middle = (x + 12 * fine, y);
        match *mark {
            Mark::Line(colour, width) => {
                let ends = vec![(x, y), (x + 24 * fine, y)];
                area.draw(&PathElement::new(ends, stroke(colour, width)))?;
            }
            Mark::Disc(colour) => area.draw(&Circle::new(middle, radius, colour.filled()))?,
            Mark::Ring(colour) => area.draw(&Circle::new(middle, radius, stroke(colour, 2)))?,
            Mark::Triangle(colour) => {
                area.draw(&TriangleMarker::new(middle, radius, colour.filled()))?;
            }
        }
        let style = ("sans-serif", 14 * FINE).into_text_style(area);
        area.draw_text(word, &style, (x + 32 * fine, y - 7 * fine))?;
        x += (60 + 7 * word.chars().count() as i32) * fine;
    }
    Ok(())
}

/// Decimal places that tell about ten ticks apart.
fn decimals(range: &std::ops::Range<f64>) -> usize {
    let tick = (range.end - range.start) / 10.0;
    (-tick.log10().floor()).clamp(0.0, 12.0) as usize
}
