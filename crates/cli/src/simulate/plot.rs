//! What the figures of `simulate` and `verify` share.

use crate::failure::{Failure, NO_ANSWER};
use crate::output;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

pub const BLUE: RGBColor = RGBColor(31, 90, 166);
pub const RED: RGBColor = RGBColor(200, 60, 40);
const SIZE: (u32, u32) = (960, 640);

pub type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

fn is(path: &Path, kind: &str) -> bool {
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

/// A chart over the range of the points, with axes named; `draw` fills it. A legend is shown when
/// `draw` labels a series.
pub fn chart(
    title: &str,
    labels: &(String, String),
    points: &[(f64, f64)],
    draw: impl FnOnce(&mut Chart<'_, '_>) -> Drawn,
) -> Result<String, Failure> {
    let mut svg = String::new();
    let drawn = || -> Drawn {
        let xs = range(points.iter().map(|p| p.0)).ok_or("no finite abscissa")?;
        let ys = range(points.iter().map(|p| p.1)).ok_or("no finite ordinate")?;
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .margin(16)
            .margin_right(28)
            .caption(title, ("sans-serif", 18))
            .x_label_area_size(48)
            .y_label_area_size(72)
            .build_cartesian_2d(xs.clone(), ys.clone())?;
        let (across, up) = (decimals(&xs), decimals(&ys));
        chart
            .configure_mesh()
            .x_desc(labels.0.as_str())
            .y_desc(labels.1.as_str())
            .axis_desc_style(("sans-serif", 16))
            .label_style(("sans-serif", 13))
            .x_label_formatter(&|x| format!("{:.across$}", x + 0.0))
            .y_label_formatter(&|y| format!("{:.up$}", y + 0.0))
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(228, 228, 228))
            .draw()?;
        draw(&mut chart)?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.9))
            .border_style(RGBColor(170, 170, 170))
            .label_font(("sans-serif", 14))
            .draw()?;
        root.present()?;
        Ok(())
    };
    drawn().map_err(|error| Failure {
        exit: NO_ANSWER,
        code: "figure",
        message: format!("nothing to draw: {error}"),
        hint: String::new(),
    })?;
    Ok(svg)
}

/// Decimal places that tell about ten ticks apart.
fn decimals(range: &std::ops::Range<f64>) -> usize {
    let tick = (range.end - range.start) / 10.0;
    (-tick.log10().floor()).clamp(0.0, 12.0) as usize
}
