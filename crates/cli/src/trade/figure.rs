//! Time against true error, both logarithmic, with the Pareto front.

use crate::failure::{Failure, NO_ANSWER};
use lindstedt::trade::{Row, Summation, Trade, pareto};
use plotters::prelude::*;

const SIZE: (u32, u32) = (960, 640);
/// An error of zero (all digits computed with are right) is drawn here at the least.
const LEAST: f64 = 1e-300;

/// Colours that differ in brightness and for colour-blind readers (Okabe and Ito).
fn colour(name: &str) -> RGBColor {
    match name {
        "exact" => RGBColor(0, 0, 0),
        "energy" => RGBColor(204, 121, 167),
        "collocation" => RGBColor(0, 114, 178),
        "collocation-f64" => RGBColor(86, 180, 233),
        "fourier" => RGBColor(0, 158, 115),
        "simulation-f64" => RGBColor(230, 159, 0),
        _ => RGBColor(213, 94, 0),
    }
}

/// The SVG text.
pub fn draw(trade: &Trade) -> Result<String, Failure> {
    let mut svg = String::new();
    paint(trade, &mut svg).map_err(|error| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    })?;
    Ok(svg)
}

/// One decade around the values.
fn range(values: impl Iterator<Item = f64>) -> Option<std::ops::Range<f64>> {
    let (low, high) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then_some(low / 3.0..high * 3.0)
}

fn paint(trade: &Trade, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let least = trade.rows.iter().map(|r| r.true_error).filter(|e| *e > 0.0);
    let least = (least.fold(1.0, f64::min) / 10.0).max(LEAST);
    let at = |row: &Row| (row.seconds, row.true_error.clamp(least, 1e3));
    let xs = range(trade.rows.iter().map(|r| r.seconds)).ok_or("no rows")?;
    let ys = range(trade.rows.iter().map(|r| at(r).1)).ok_or("no rows")?;
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let parameters: Vec<String> =
        trade.truth.at.iter().map(|(k, v)| format!("{k} = {v}")).collect();
    let caption = format!(
        "{} at {}: period (hollow: partial sums, full: resummed)",
        trade.problem.name,
        parameters.join(", ")
    );
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .caption(caption, ("sans-serif", 18))
        .x_label_area_size(44)
        .y_label_area_size(72)
        .build_cartesian_2d(xs.log_scale(), ys.log_scale())?;
    let tick = |x: &f64| format!("{x:.0e}");
    chart
        .configure_mesh()
        .x_desc("time / s")
        .y_desc("true relative error")
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .light_line_style(WHITE)
        .label_style(("sans-serif", 13))
        .draw()?;
    // The front as a staircase: what a time buys.
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for row in pareto(&trade.rows).into_iter().filter_map(|i| trade.rows.get(i)) {
        let point = at(row);
        steps.extend(steps.last().map(|before| (point.0, before.1)));
        steps.push(point);
    }
    let grey = RGBColor(150, 150, 150);
    let front = chart.draw_series(LineSeries::new(steps, grey.stroke_width(6)))?;
    front
        .label("Pareto front")
        .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], grey.stroke_width(6)));
    let mut rest = trade.rows.as_slice();
    let mut named: Vec<&str> = Vec::new();
    while let Some(first) = rest.first() {
        // Rows of one method are neighbours: a curve over the order. The integrator's curves go
        // over the digits.
        let name = first.method.name();
        let same = |row: &&Row| match first.order {
            Some(_) => row.method == first.method,
            None => row.method.name() == name,
        };
        let count = rest.iter().take_while(same).count().max(1);
        let (group, tail) = rest.split_at(count);
        rest = tail;
        let colour = colour(name);
        // Partial sums are hollow, resummations and the integrator full.
        let is_partial = |row: &&Row| row.summation == Some(Summation::PartialSum);
        let partial = group.iter().filter(is_partial);
        let line = LineSeries::new(partial.clone().map(at), colour.mix(0.4).stroke_width(1));
        chart.draw_series(line)?;
        let points = partial.map(|row| Circle::new(at(row), 4, colour.stroke_width(1)));
        chart.draw_series(points)?;
        let full = || group.iter().filter(|row| !is_partial(row));
        chart.draw_series(LineSeries::new(full().map(at), colour.stroke_width(1)))?;
        let points = full().map(|row| Circle::new(at(row), 4, colour.filled()));
        let drawn = chart.draw_series(points)?;
        if !named.contains(&name) {
            named.push(name);
            drawn.label(name).legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
        }
        let label = |row: &Row| {
            let digits = row.method.digits();
            let text = row.order.map_or_else(|| format!("{digits}d"), |n| n.to_string());
            Text::new(text, at(row), ("sans-serif", 11))
        };
        chart.draw_series(group.iter().map(label))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE)
        .border_style(BLACK)
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}
