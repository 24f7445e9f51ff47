//! Curves over time.

use crate::failure::{Failure, NO_ANSWER};
use plotters::prelude::*;

const SIZE: (u32, u32) = (960, 540);

/// One curve: its points and its colour; points that are not finite are left out.
pub type Curve = (Vec<(f64, f64)>, RGBColor);

/// Curves in one frame, symmetric about zero.
pub fn draw(caption: &str, vertical: &str, curves: &[Curve]) -> Result<String, Failure> {
    let mut svg = String::new();
    plot(&mut svg, caption, vertical, curves).map_err(|error| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    })?;
    Ok(svg)
}

fn plot(
    svg: &mut String,
    caption: &str,
    vertical: &str,
    curves: &[Curve],
) -> Result<(), Box<dyn std::error::Error>> {
    let finite = |(points, colour): &Curve| -> Curve {
        (points.iter().copied().filter(|p| p.1.is_finite()).collect(), *colour)
    };
    let curves: Vec<Curve> = curves.iter().map(finite).collect();
    let first = curves.first().map(|(points, _)| points);
    let ends = first.and_then(|points| points.first().zip(points.last()));
    let (first, last) = ends.ok_or("no finite value")?;
    let all = curves.iter().flat_map(|(points, _)| points);
    let top = all.fold(0.0f64, |top, p| top.max(p.1.abs())).max(1e-300) * 1.05;
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .caption(caption, ("sans-serif", 18))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(first.0..last.0.max(first.0 + 1e-9), -top..top)?;
    chart.configure_mesh().x_desc("t").y_desc(vertical).light_line_style(WHITE).draw()?;
    for (points, colour) in &curves {
        chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?;
    }
    root.present()?;
    drop(chart);
    drop(root);
    Ok(())
}
