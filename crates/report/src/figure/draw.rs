//! The one place that draws.

use super::scale::range;
use super::{Colour, Figure, FigureError, Layer, Mark, Raster, colours};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

/// The library places points on whole units: a picture is drawn so many times larger, and the
/// heading of the file says how large it is shown.
const FINE: u32 = 10;
/// Cells per axis at most: finer ones are not told apart.
const CELLS: usize = 240;

/// Lengths of a dashed line.
const DASH: u32 = 5 * FINE;
const GAP: u32 = 4 * FINE;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn stroke(colour: Colour, width: u32) -> ShapeStyle {
    rgb(colour).stroke_width(width * FINE)
}

fn units(n: u32) -> i32 {
    (n * FINE) as i32
}

/// A square around a point.
fn square(radius: u32, style: ShapeStyle) -> Rectangle<(i32, i32)> {
    let r = units(radius);
    Rectangle::new([(-r, -r), (r, r)], style)
}

/// Figures side by side.
pub(super) fn svg(figures: &[&Figure]) -> Result<String, FigureError> {
    let Some(first) = figures.first() else { return Err(FigureError::Empty) };
    let frames: Option<Vec<_>> = figures.iter().map(|figure| frame(figure)).collect();
    let frames = frames.ok_or(FigureError::Empty)?;
    let mut svg = String::new();
    let size = first.size;
    paint(&mut svg, size, figures, &frames)
        .map_err(|error| FigureError::Drawing(error.to_string()))?;
    let sized =
        |factor: u32| format!("width=\"{}\" height=\"{}\"", size.0 * factor, size.1 * factor);
    let edges = format!("{} shape-rendering=\"crispEdges\"", sized(1));
    let heading = if first.raster.is_some() { edges } else { sized(1) };
    Ok(svg.replacen(&sized(FINE), &heading, 1))
}

/// The ranges of both axes.
fn frame(figure: &Figure) -> Option<[Range<f64>; 2]> {
    let [across, up] = &figure.axes;
    if let Some(raster) = &figure.raster {
        let edge = |(low, high, count): (f64, f64, usize)| {
            let half = 0.5 * (high - low) / (count.max(2) - 1) as f64;
            (low < high && (high - low).is_finite()).then_some(low - half..high + half)
        };
        return Some([edge(raster.columns)?, edge(raster.rows)?]);
    }
    // A point that one axis cannot show does not widen the other.
    let shown = || {
        let points = figure.layers.iter().flat_map(|layer| &layer.points);
        let places = points.map(|(x, y)| (across.scale.place(*x), up.scale.place(*y)));
        places.filter(|(x, y)| x.is_finite() && y.is_finite())
    };
    Some([range(shown().map(|p| p.0))?, range(shown().map(|p| p.1))?])
}

fn paint(
    svg: &mut String,
    size: (u32, u32),
    figures: &[&Figure],
    frames: &[[Range<f64>; 2]],
) -> Drawn {
    let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let first = figures[0];
    let entries = entries(first);
    let per_row = ((size.0 - 48) / widest(&entries).max(1)).max(1) as usize;
    let rows = entries.len().div_ceil(per_row) as u32;
    let footer = if first.footer.is_empty() { 0 } else { 24 };
    let below = size.1 - 24 * rows - footer - 4;
    let (body, key) = root.split_vertically(below * FINE);
    for (panel, (figure, frame)) in
        body.split_evenly((1, figures.len())).iter().zip(figures.iter().zip(frames))
    {
        chart(panel, figure, frame)?;
    }
    legend(&key, &entries, per_row)?;
    if footer > 0 {
        let style = ("sans-serif", 14 * FINE).into_text_style(&key);
        key.draw_text(&first.footer, &style, (units(24), units(24 * rows)))?;
    }
    root.present()?;
    Ok(())
}

fn chart(area: &Area<'_>, figure: &Figure, [xs, ys]: &[Range<f64>; 2]) -> Drawn {
    let font = |size: u32| ("sans-serif", size * FINE);
    let [across, up] = &figure.axes;
    let mut chart = ChartBuilder::on(area)
        .margin(12 * FINE)
        .margin_right(28 * FINE)
        .caption(&figure.title, font(17))
        .x_label_area_size(46 * FINE)
        .y_label_area_size((34 + 8 * up.widest(ys) as u32) * FINE)
        .build_cartesian_2d(xs.clone(), ys.clone())?;
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(across.label.as_str())
        .y_desc(up.label.as_str())
        .axis_desc_style(font(15))
        .label_style(font(13))
        .set_all_tick_mark_size(units(5))
        .axis_style(stroke(colours::BLACK, 1))
        .light_line_style(TRANSPARENT)
        .bold_line_style(stroke((232, 232, 232), 1));
    if !up.names.is_empty() {
        mesh.y_labels(up.names.len());
    }
    if figure.raster.is_some() {
        mesh.disable_mesh();
    }
    mesh.x_label_formatter(&|x| across.tick(*x, xs))
        .y_label_formatter(&|y| up.tick(*y, ys))
        .draw()?;
    if let Some(raster) = &figure.raster {
        cells(&mut chart, raster)?;
    }
    for layer in &figure.layers {
        let place = |(x, y): &(f64, f64)| (across.scale.place(*x), up.scale.place(*y));
        let places: Vec<(f64, f64)> = layer.points.iter().map(place).collect();
        points(&mut chart, layer, &places)?;
    }
    Ok(())
}

fn points(chart: &mut Chart<'_, '_>, layer: &Layer, places: &[(f64, f64)]) -> Drawn {
    let finite = |p: &&(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let pieces = || places.split(|p| !finite(&p)).filter(|piece| !piece.is_empty());
    let dots = || places.iter().filter(finite).copied();
    let (colour, filled) = (layer.colour, rgb(layer.colour).filled());
    match layer.mark {
        Mark::Line(width) => {
            for piece in pieces() {
                let line = piece.iter().copied();
                chart.draw_series(LineSeries::new(line, stroke(colour, width)))?;
            }
        }
        Mark::Dashed(width) => {
            for piece in pieces() {
                let (line, style) = (piece.iter().copied(), stroke(colour, width));
                chart.draw_series(DashedLineSeries::new(line, DASH, GAP, style))?;
            }
        }
        Mark::Disc(r) => drop(chart.draw_series(dots().map(|p| Circle::new(p, units(r), filled)))?),
        Mark::Ring(r) => {
            chart.draw_series(dots().map(|p| Circle::new(p, units(r), stroke(colour, 2))))?;
        }
        Mark::Triangle(r) => {
            chart.draw_series(dots().map(|p| TriangleMarker::new(p, units(r), filled)))?;
        }
        Mark::Cross(r) => {
            chart.draw_series(dots().map(|p| Cross::new(p, units(r), stroke(colour, 2))))?;
        }
        Mark::Square(r) => {
            chart.draw_series(dots().map(|p| EmptyElement::at(p) + square(r, filled)))?;
        }
    }
    let labels = layer.labels.iter().zip(places).filter(|(_, p)| finite(p));
    let font = ("sans-serif", 11 * FINE);
    chart.draw_series(labels.map(|(word, p)| Text::new(word.clone(), *p, font)))?;
    Ok(())
}

/// Of so many cells along an axis one in so many is drawn.
pub(super) fn stride(cells: usize) -> usize {
    cells.div_ceil(CELLS).max(1)
}

/// Runs of equal cells become one rectangle.
fn cells(chart: &mut Chart<'_, '_>, raster: &Raster) -> Drawn {
    let (width, height) = (raster.columns.2, raster.rows.2);
    let (dx, dy) = (stride(width), stride(height));
    let edge = |(low, high, count): (f64, f64, usize), n: usize| {
        low + (n as f64 - 0.5) * (high - low) / (count.max(2) - 1) as f64
    };
    let mut rectangles = Vec::new();
    for row in (0..height).step_by(dy) {
        let at = |column: usize| raster.cells.get(row * width + column).copied().flatten();
        let mut column = 0;
        while column < width {
            let own = at(column);
            let mut end = column + dx;
            while end < width && at(end) == own {
                end += dx;
            }
            let end = end.min(width);
            if let Some(colour) = own {
                let low = (edge(raster.columns, column), edge(raster.rows, row));
                let top = edge(raster.rows, (row + dy).min(height));
                let high = (edge(raster.columns, end), top);
                rectangles.push(Rectangle::new([low, high], rgb(colour).filled()));
            }
            column = end;
        }
    }
    chart.draw_series(rectangles)?;
    Ok(())
}

/// An entry of the legend: words with a mark, or with a box of a colour.
type Entry = (String, Option<(Mark, Colour)>, Option<Colour>);

fn entries(figure: &Figure) -> Vec<Entry> {
    let mut list: Vec<Entry> = Vec::new();
    let boxes = figure.raster.iter().flat_map(|raster| &raster.legend);
    list.extend(boxes.map(|(words, colour)| (words.clone(), None, *colour)));
    for layer in &figure.layers {
        if let Some(name) = &layer.name
            && list.iter().all(|(words, ..)| words != name)
        {
            list.push((name.clone(), Some((layer.mark, layer.colour)), None));
        }
    }
    list
}

fn widest(entries: &[Entry]) -> u32 {
    entries.iter().map(|(words, ..)| 56 + 7 * words.chars().count() as u32).max().unwrap_or(0)
}

fn legend(area: &Area<'_>, entries: &[Entry], per_row: usize) -> Drawn {
    let width = units(widest(entries));
    for (index, (words, mark, colour)) in entries.iter().enumerate() {
        let (x, y) =
            (units(24) + width * (index % per_row) as i32, units(24) * (index / per_row) as i32);
        let style = ("sans-serif", 14 * FINE).into_text_style(area);
        area.draw_text(words, &style, (x + units(32), y + units(3)))?;
        let Some((mark, colour)) = *mark else {
            let place = [(x + units(4), y + units(2)), (x + units(22), y + units(18))];
            area.draw(&Rectangle::new(place, rgb(colour.unwrap_or((255, 255, 255))).filled()))?;
            area.draw(&Rectangle::new(place, stroke(colours::BLACK, 1)))?;
            continue;
        };
        let middle = (x + units(12), y + units(10));
        match mark {
            Mark::Line(width) => {
                let ends = vec![(x, middle.1), (x + units(24), middle.1)];
                area.draw(&PathElement::new(ends, stroke(colour, width)))?;
            }
            Mark::Dashed(width) => {
                let (ends, style) =
                    ([(x, middle.1), (x + units(24), middle.1)], stroke(colour, width));
                area.draw(&plotters::element::DashedPathElement::new(ends, DASH, GAP, style))?;
            }
            Mark::Disc(_) => area.draw(&Circle::new(middle, units(4), rgb(colour).filled()))?,
            Mark::Ring(_) => area.draw(&Circle::new(middle, units(4), stroke(colour, 2)))?,
            Mark::Triangle(_) => {
                area.draw(&TriangleMarker::new(middle, units(5), rgb(colour).filled()))?;
            }
            Mark::Cross(_) => area.draw(&Cross::new(middle, units(4), stroke(colour, 2)))?,
            Mark::Square(_) => {
                area.draw(&(EmptyElement::at(middle) + square(4, rgb(colour).filled())))?;
            }
        }
    }
    Ok(())
}
