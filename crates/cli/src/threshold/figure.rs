//! The figure: a family of curves with cusps and zeros marked, or a map of a surface.

use super::request::Request;
use super::sweep::Table;
use crate::failure::Failure;
use lindstedt::number::ball::Balls;
use lindstedt_melnikov::Axis;
use plotters::prelude::*;

/// Up to so many rows are drawn as curves.
const MOST_CURVES: usize = 12;
/// Cells per axis of a map.
const CELLS: usize = 120;
const SIZE: (u32, u32) = (960, 640);

/// The SVG text.
pub fn draw(request: &Request, table: Option<&Table>) -> Result<String, Failure> {
    let mut svg = String::new();
    if let Some(table) = table {
        let drawn = if table.rows.len() <= MOST_CURVES {
            curves(request, table, &mut svg)
        } else {
            map(request, table, &mut svg)
        };
        drawn.map_err(|error| Failure {
            exit: crate::failure::NO_ANSWER,
            code: "figure",
            message: format!("nothing to draw: {error}"),
            hint: String::new(),
        })?;
    }
    Ok(svg)
}

type Drawn = Result<(), Box<dyn std::error::Error>>;

fn range(values: impl Iterator<Item = f64>) -> Option<std::ops::Range<f64>> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // A margin keeps marks on the frame visible, and a single value drawable.
    let margin = 0.03 * (high - low).max(1e-9 * high.abs()).max(1e-300);
    (low <= high && (high - low).is_finite()).then_some(low - margin..high + margin)
}

fn curves(request: &Request, table: &Table, svg: &mut String) -> Drawn {
    let name = &request.sweeps[0].name;
    let xs = range(table.columns.iter().copied()).ok_or("no finite abscissa")?;
    let top = range(table.signed.iter().map(|s| s.abs())).ok_or("no finite threshold")?;
    let ys = -0.02 * top.end..top.end;
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let what = if request.file.is_some() { &request.problem } else { "the stick-slip oscillator" };
    let marked = if request.point.is_some() { ": circles zeros, triangles cusps" } else { "" };
    let caption = format!("Melnikov threshold of {what}{marked}");
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .caption(caption, ("sans-serif", 18))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(xs.clone(), ys)?;
    chart
        .configure_mesh()
        .x_desc(name.as_str())
        .y_desc("gamma_c")
        .light_line_style(WHITE)
        .draw()?;
    let width = table.columns.len().max(1);
    for (i, line) in table.signed.chunks(width).enumerate() {
        let hue = i as f64 / table.rows.len() as f64;
        let colour = HSLColor(0.62 * (1.0 - hue), 0.85, 0.42);
        let points = table.columns.iter().zip(line).map(|(&x, s)| (x, s.abs()));
        // Gaps where the parameters leave the domain.
        let points: Vec<(f64, f64)> = points.collect();
        let mut first = true;
        for piece in points.split(|(_, y)| !y.is_finite()).filter(|piece| !piece.is_empty()) {
            let series = LineSeries::new(piece.iter().copied(), colour.stroke_width(2));
            let annotated = chart.draw_series(series)?;
            if first && request.sweeps.len() == 2 {
                let label = format!("{} = {}", request.sweeps[1].name, table.rows[i]);
                annotated.label(label).legend(move |(x, y)| {
                    PathElement::new(vec![(x, y), (x + 20, y)], colour.stroke_width(2))
                });
            }
            first = false;
        }
        let (zeros, cusps) = marks(request, i, &xs);
        chart.draw_series(zeros.into_iter().map(|x| Circle::new((x, 0.0), 5, colour.filled())))?;
        let triangles = cusps.into_iter();
        chart.draw_series(triangles.map(|at| TriangleMarker::new(at, 7, colour.filled())))?;
    }
    if request.sweeps.len() == 2 {
        chart.configure_series_labels().background_style(WHITE).border_style(BLACK).draw()?;
    }
    root.present()?;
    Ok(())
}

/// The zeros and the cusps (|v*| = V) of one curve over v*.
fn marks(request: &Request, row: usize, xs: &std::ops::Range<f64>) -> (Vec<f64>, Vec<(f64, f64)>) {
    let Some(mut point) = request.point.clone() else { return (Vec::new(), Vec::new()) };
    if !request.is_fast() || request.sweeps[0].axis != Some(Axis::BeltSpeed) {
        return (Vec::new(), Vec::new());
    }
    if let Some(second) = request.sweeps.get(1)
        && let (Some(axis), Some(value)) = (second.axis, second.values.get(row))
    {
        point = point.with(axis, value.clone());
    }
    let balls = Balls::new(160);
    let both = |x: f64| [-x, x].into_iter().filter(|x| xs.contains(x));
    let zeros = point.zeros(balls).unwrap_or_default();
    let zeros = zeros.iter().flat_map(|zero| both(zero.midpoint().to_f64())).collect();
    let value = point.threshold_at_cusp(balls).map(|ball| ball.midpoint().to_f64().abs());
    let speed = point.loop_speed(balls).map(|ball| ball.midpoint().to_f64());
    let cusps = match (speed, value) {
        (Some(x), Some(y)) if y.is_finite() && point.dry.sign().is_ne() => {
            both(x).map(|x| (x, y)).collect()
        }
        _ => Vec::new(),
    };
    (zeros, cusps)
}

/// sgn(s) log-scaled colours: blue D > 0, red D < 0, white near 0.
fn map(request: &Request, table: &Table, svg: &mut String) -> Drawn {
    let (across, up) = (&request.sweeps[0].name, &request.sweeps[1].name);
    let xs = range(table.columns.iter().copied()).ok_or("no finite abscissa")?;
    let ys = range(table.rows.iter().copied()).ok_or("no finite ordinate")?;
    let largest = table.signed.iter().filter(|s| s.is_finite()).fold(0.0f64, |m, s| m.max(s.abs()));
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let caption = format!("signed Melnikov threshold, blue > 0 > red, up to {largest:.3e}");
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .caption(caption, ("sans-serif", 18))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(xs, ys)?;
    let mesh = &mut chart.configure_mesh();
    mesh.disable_mesh().x_desc(across.as_str()).y_desc(up.as_str()).draw()?;
    let width = table.columns.len();
    let (dx, dy) = (width.div_ceil(CELLS).max(1), table.rows.len().div_ceil(CELLS).max(1));
    let edge = |values: &[f64], i: usize| values.get(i).or(values.last()).copied().unwrap_or(0.0);
    let mut cells = Vec::new();
    for i in (0..table.rows.len()).step_by(dy) {
        for j in (0..width).step_by(dx) {
            let Some(&s) = table.signed.get(i * width + j).filter(|s| s.is_finite()) else {
                continue;
            };
            let depth = (s.abs() / largest.max(f64::MIN_POSITIVE)).powf(0.4);
            let colour = HSLColor(if s > 0.0 { 0.6 } else { 0.0 }, 0.8, 1.0 - 0.6 * depth);
            let low = (edge(&table.columns, j), edge(&table.rows, i));
            let high = (edge(&table.columns, j + dx), edge(&table.rows, i + dy));
            cells.push(Rectangle::new([low, high], colour.filled()));
        }
    }
    chart.draw_series(cells)?;
    root.present()?;
    Ok(())
}
