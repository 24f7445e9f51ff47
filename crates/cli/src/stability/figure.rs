//! The chart as SVG: where prediction and truth agree and where not, the flip curve, the point.

use super::chart::{Grid, Standing, standing};
use super::request::Request;
use crate::failure::{Failure, NO_ANSWER};
use lindstedt_impact::chart::Axis;
use plotters::prelude::*;

const SIZE: (u32, u32) = (960, 720);
/// Cells per axis at most.
const CELLS: usize = 240;

/// Colours that differ in brightness and for colour-blind readers (Okabe and Ito).
fn colour(standing: Standing) -> Option<RGBColor> {
    Some(match standing {
        Standing::BothStable => RGBColor(0, 158, 115),
        Standing::BothUnstable => RGBColor(226, 226, 226),
        Standing::FalseStable => RGBColor(213, 94, 0),
        Standing::FalseUnstable => RGBColor(86, 180, 233),
        Standing::OnlyStable => RGBColor(160, 214, 180),
        Standing::OnlyUnstable => RGBColor(240, 240, 240),
        Standing::Open => return None,
    })
}

fn label(standing: Standing, grid: &Grid) -> &'static str {
    match standing {
        Standing::BothStable => "predicted stable, is stable",
        Standing::BothUnstable => "predicted unstable, is unstable",
        Standing::FalseStable => "predicted stable, IS UNSTABLE",
        Standing::FalseUnstable => "predicted unstable, is stable",
        Standing::OnlyStable if grid.plan.exact.is_none() => "predicted stable",
        Standing::OnlyUnstable if grid.plan.exact.is_none() => "predicted unstable",
        Standing::OnlyStable if grid.plan.predictor.is_none() => "stable",
        Standing::OnlyUnstable if grid.plan.predictor.is_none() => "unstable",
        Standing::OnlyStable => "stable, no predicted orbit",
        Standing::OnlyUnstable => "unstable, no predicted orbit",
        Standing::Open => "undecided or no orbit",
    }
}

/// The SVG text.
pub fn draw(request: &Request, grid: &Grid) -> Result<String, Failure> {
    let mut svg = String::new();
    paint(request, grid, &mut svg).map_err(|error| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    })?;
    Ok(svg)
}

/// The range of an axis with half a cell around the outer points.
fn range(axis: &Axis) -> std::ops::Range<f64> {
    let half = 0.5 * (axis.high - axis.low) / (axis.count.max(2) - 1) as f64;
    axis.low - half..axis.high + half
}

fn paint(
    request: &Request,
    grid: &Grid,
    svg: &mut String,
) -> Result<(), Box<dyn std::error::Error>> {
    let (columns, rows) = (&grid.plan.columns, &grid.plan.rows);
    if columns.low >= columns.high || rows.low >= rows.high {
        return Err("an axis without extent".into());
    }
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (plot, legend) = root.split_vertically(SIZE.1 - 104);
    let prediction = match grid.plan.predictor {
        Some((_, order)) => {
            format!("averaging of order {order}, variant {}", request.variant_name())
        }
        None => "exact".to_owned(),
    };
    let agreement = if grid.agreement.compared > 0 {
        format!("; verdicts agree at {:.1} % of the points", 100.0 * grid.agreement.rate())
    } else {
        String::new()
    };
    let mut chart = ChartBuilder::on(&plot)
        .margin(14)
        .caption(
            format!("Stability of the impact orbit: {prediction}{agreement}"),
            ("sans-serif", 18),
        )
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(range(columns), range(rows))?;
    let mesh = &mut chart.configure_mesh();
    // 0, not -0 or 0.10000000000000003.
    let tick = |x: &f64| format!("{}", (x * 1e9).round() / 1e9 + 0.0);
    mesh.disable_mesh()
        .x_desc(grid.names[0].as_str())
        .y_desc(grid.names[1].as_str())
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 17))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .draw()?;
    let (dx, dy) = (columns.count.div_ceil(CELLS).max(1), rows.count.div_ceil(CELLS).max(1));
    let edge = |axis: &Axis, n: usize| {
        let step = (axis.high - axis.low) / (axis.count.max(2) - 1) as f64;
        axis.low + (n as f64 - 0.5) * step
    };
    let mut present = Vec::new();
    let mut cells = Vec::new();
    for row in (0..rows.count).step_by(dy) {
        let at = |column: usize| {
            grid.chart.point(column, row).map_or(Standing::Open, |p| standing(p, &grid.plan))
        };
        let mut column = 0;
        while column < columns.count {
            // Runs of equal standing become one rectangle.
            let own = at(column);
            let mut end = column + dx;
            while end < columns.count && at(end) == own {
                end += dx;
            }
            let end = end.min(columns.count);
            if !present.contains(&own) {
                present.push(own);
            }
            if let Some(colour) = colour(own) {
                let low = (edge(columns, column), edge(rows, row));
                let high = (edge(columns, end), edge(rows, (row + dy).min(rows.count)));
                cells.push(Rectangle::new([low, high], colour.filled()));
            }
            column = end;
        }
    }
    chart.draw_series(cells)?;
    let point = |&(x, y): &(f64, f64)| Circle::new((x, y), 2, BLACK.filled());
    chart.draw_series(grid.flip.iter().map(point))?;
    let base = |n: usize| request.sweeps.get(n).map_or(f64::NAN, |sweep| sweep.base);
    let asked = (base(0), base(1));
    if range(columns).contains(&asked.0) && range(rows).contains(&asked.1) {
        chart.draw_series([Cross::new(asked, 7, BLACK.stroke_width(3))])?;
    }
    let mut entries: Vec<(String, Option<RGBColor>)> =
        present.iter().map(|s| (label(*s, grid).to_owned(), colour(*s))).collect();
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    if !grid.flip.is_empty() {
        entries.push(("dots: flip, a multiplier at -1 (G(-1) = 0)".to_owned(), Some(BLACK)));
    }
    entries.push((
        format!("cross: {} = {}, {} = {}", grid.names[0], asked.0, grid.names[1], asked.1),
        None,
    ));
    for (index, (text, colour)) in entries.iter().enumerate() {
        let (x, y) = (70 + 300 * (index as i32 / 3), 2 + 26 * (index as i32 % 3));
        let box_style = colour.unwrap_or(WHITE);
        legend.draw(&Rectangle::new([(x, y), (x + 18, y + 16)], box_style.filled()))?;
        legend.draw(&Rectangle::new([(x, y), (x + 18, y + 16)], BLACK.stroke_width(1)))?;
        legend.draw(&Text::new(text.clone(), (x + 26, y + 1), ("sans-serif", 15)))?;
    }
    let fixed: Vec<String> = request
        .at
        .iter()
        .filter(|(name, _)| !grid.names.contains(name))
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    legend.draw(&Text::new(fixed.join(",  "), (70, 82), ("sans-serif", 15)))?;
    root.present()?;
    Ok(())
}
