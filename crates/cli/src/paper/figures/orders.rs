//! The true error of the period against the order of the delta expansion.

use super::{BLUE, Figure, GREEN, ORANGE, PURPLE, SIZE, VERMILION};
use crate::failure::Failure;
use crate::simulate::plot::{FINE, Mark, sized, stroke};
use lindstedt_paper::trust::Truncation;
use plotters::prelude::*;

/// The cases drawn: their name, whether re-expanded, and the colour.
const CURVES: [(&str, bool, RGBColor); 5] = [
    ("n = 3", false, BLUE),
    ("n = 5", false, PURPLE),
    ("pendulum", false, VERMILION),
    ("n = 3", true, GREEN),
    ("n = 9", true, ORANGE),
];

pub fn draw(list: &[Truncation]) -> Result<Figure, Failure> {
    let mut curves = Vec::new();
    for (name, resummed, colour) in CURVES {
        let Some(found) = list.iter().find(|t| t.name == name) else { continue };
        let errors = if resummed { &found.resummed } else { &found.errors };
        let logarithm = |(n, error): (usize, &f64)| (n as f64, error.max(1e-300).log10());
        let points: Vec<(f64, f64)> = errors.iter().enumerate().map(logarithm).collect();
        let word = if resummed { format!("{name}, in u") } else { name.to_owned() };
        curves.push((word, points, colour));
    }
    let legend: Vec<(&str, Mark)> =
        curves.iter().map(|(word, _, colour)| (word.as_str(), Mark::Disc(*colour))).collect();
    let all: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points, _)| points.clone()).collect();
    let labels = ("order N".to_owned(), "log10 of the relative error of T".to_owned());
    let title = "Error of the period by the small delta method";
    let svg = sized(SIZE, (title, &labels, &legend), &all, |chart| {
        for (_, points, colour) in &curves {
            chart.draw_series(LineSeries::new(points.iter().copied(), stroke(*colour, 2)))?;
            let radius = (3 * FINE) as i32;
            chart.draw_series(points.iter().map(|p| Circle::new(*p, radius, colour.filled())))?;
        }
        Ok(())
    })?;
    Ok(Figure {
        name: "orders",
        section: 4,
        caption: "True error of the period cut off after order $N$; the curves in $u$: the same coefficients \
                  re-expanded in $u = delta/(1 + delta)$ with the factor $sqrt(1 - u)$."
            .into(),
        svg,
    })
}
