//! The plane of the gains: where the region of (17) and the truth agree and where not.

use super::{Figure, GREEN, PALE, SKY, VERMILION, failed};
use crate::failure::Failure;
use crate::simulate::plot::{Drawn, FINE, stroke};
use lindstedt_impact::chart::{Chart, Point};
use lindstedt_impact::map::Verdict;
use lindstedt_paper::trust::Region;
use plotters::coord::Shift;
use plotters::prelude::*;

const SIZE: (u32, u32) = (640, 400);
const LEGEND: u32 = 52;

/// How a point stands, with its colour.
const STANDINGS: [(&str, RGBColor); 4] = [
    ("predicted stable, is stable", GREEN),
    ("predicted unstable, is unstable", PALE),
    ("predicted stable, IS UNSTABLE", VERMILION),
    ("predicted unstable, is stable", SKY),
];

pub fn draw(region: &Region) -> Result<Figure, Failure> {
    let mut svg = String::new();
    paint(region, &mut svg).map_err(|error| failed(&error))?;
    let large = format!("width=\"{}\" height=\"{}\"", SIZE.0 * FINE, SIZE.1 * FINE);
    let small = format!("width=\"{}\" height=\"{}\"", SIZE.0, SIZE.1);
    let silent = region.charts.iter().any(|c| c.chart.points.iter().any(|p| standing(p).is_none()));
    Ok(Figure {
        name: "region",
        section: 2,
        caption: format!(
            "The plane of the gains for {}, the first of the sample that is unstable without the \
             loop: (17) against the zeros of $G$ with the mean kick. The cross is the orbit without loop.{}",
            region.orbit.marked(),
            if silent { " White: (17) predicts nothing, its orbit does not exist." } else { "" }
        )
        .into(),
        svg: svg.replacen(&large, &small, 1),
    })
}

fn standing(point: &Point) -> Option<usize> {
    use Verdict::{Stable, Unstable};
    match (point.predicted?, point.exact?) {
        (Stable, Stable) => Some(0),
        (Unstable, Unstable) => Some(1),
        (Stable, Unstable) => Some(2),
        (Unstable, Stable) => Some(3),
        _ => None,
    }
}

fn paint(region: &Region, svg: &mut String) -> Drawn {
    let fine = FINE as i32;
    let root = SVGBackend::with_string(svg, (SIZE.0 * FINE, SIZE.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let (body, legend) = root.split_vertically((SIZE.1 - LEGEND) * FINE);
    let panels = body.split_evenly((1, region.charts.len().max(1)));
    for (panel, chart) in panels.iter().zip(&region.charts) {
        let rate = 100.0 * chart.chart.agreement().rate();
        plane(panel, &chart.chart, &format!("{}: {rate:.1} %", chart.rule))?;
    }
    for (n, (word, colour)) in STANDINGS.iter().enumerate() {
        let (x, y) = ((60 + 290 * (n as i32 / 2)) * fine, (2 + 24 * (n as i32 % 2)) * fine);
        let frame = [(x, y), (x + 16 * fine, y + 16 * fine)];
        legend.draw(&Rectangle::new(frame, colour.filled()))?;
        let style = ("sans-serif", 14 * FINE).into_text_style(&legend);
        legend.draw_text(word, &style, (x + 24 * fine, y + fine))?;
    }
    root.present()?;
    Ok(())
}

fn plane(area: &DrawingArea<SVGBackend<'_>, Shift>, chart: &Chart, title: &str) -> Drawn {
    let (columns, rows) = (chart.plan.columns, chart.plan.rows);
    let half = |low: f64, high: f64, count: usize| 0.5 * (high - low) / (count.max(2) - 1) as f64;
    let (dx, dy) =
        (half(columns.low, columns.high, columns.count), half(rows.low, rows.high, rows.count));
    let font = |size: u32| ("sans-serif", size * FINE);
    let mut axes = ChartBuilder::on(area)
        .margin(10 * FINE)
        .caption(title, font(15))
        .x_label_area_size(40 * FINE)
        .y_label_area_size(48 * FINE)
        .build_cartesian_2d(columns.low - dx..columns.high + dx, rows.low - dy..rows.high + dy)?;
    let tick = |x: &f64| format!("{}", (x * 1e9).round() / 1e9 + 0.0);
    axes.configure_mesh()
        .disable_mesh()
        .x_desc("gain A")
        .y_desc("gain B")
        .x_labels(7)
        .y_labels(7)
        .axis_desc_style(font(14))
        .label_style(font(12))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .axis_style(stroke(BLACK, 1))
        .set_all_tick_mark_size((4 * FINE) as i32)
        .draw()?;
    let mut cells = Vec::new();
    for row in 0..rows.count {
        // Runs of equal standing become one rectangle.
        let at = |column: usize| chart.point(column, row).and_then(standing);
        let mut column = 0;
        while column < columns.count {
            let own = at(column);
            let end = (column..columns.count).find(|c| at(*c) != own).unwrap_or(columns.count);
            if let Some((_, colour)) = own.and_then(|n| STANDINGS.get(n)) {
                let low = (columns.value(column) - dx, rows.value(row) - dy);
                let high = (columns.value(end - 1) + dx, rows.value(row) + dy);
                cells.push(Rectangle::new([low, high], colour.filled()));
            }
            column = end;
        }
    }
    axes.draw_series(cells)?;
    axes.draw_series([Cross::new((0.0, 0.0), (5 * FINE) as i32, stroke(BLACK, 2))])?;
    Ok(())
}
