//! The first tangency of both loops as eps grows, beside Melnikov's threshold.

use super::{BLUE, Figure, GREY, SIZE, VERMILION};
use crate::failure::Failure;
use crate::simulate::plot::{FINE, Mark, sized, stroke};
use lindstedt_paper::trust::{Onset, OnsetPoint};
use plotters::prelude::*;

/// The band in which a threshold is called right.
const BAND: f64 = 0.1;

pub fn draw(onset: &Onset) -> Result<Figure, Failure> {
    let side = |pick: fn(&OnsetPoint) -> Option<(f64, f64)>| -> Vec<(f64, f64)> {
        onset.points.iter().filter_map(|p| Some((p.eps, pick(p)?.0))).collect()
    };
    let (right, left) = (side(|p| p.right), side(|p| p.left));
    let last = onset.points.last().map_or(1.0, |p| p.eps);
    let level = onset.threshold;
    let line = vec![(0.0, level), (last, level)];
    let band = RGBColor(240, 240, 240);
    let legend = [
        ("threshold (27)", Mark::Line(GREY, 2)),
        ("within 10 %", Mark::Line(band, 8)),
        ("right loop", Mark::Disc(VERMILION)),
        ("left loop", Mark::Disc(BLUE)),
    ];
    let mut points = [right.clone(), left.clone()].concat();
    points.extend([(0.0, (1.0 - BAND) * level), (last, (1.0 + BAND) * level)]);
    let labels = ("eps".to_owned(), "gamma at the tangency".to_owned());
    let title = "Where the tangle begins";
    let svg = sized(SIZE, (title, &labels, &legend), &points, |chart| {
        let frame = [(0.0, (1.0 - BAND) * level), (last, (1.0 + BAND) * level)];
        chart.draw_series([Rectangle::new(frame, band.filled())])?;
        chart.draw_series(LineSeries::new(line, stroke(GREY, 2)))?;
        for (curve, colour) in [(&right, VERMILION), (&left, BLUE)] {
            chart.draw_series(LineSeries::new(curve.iter().copied(), stroke(colour, 2)))?;
            let radius = (4 * FINE) as i32;
            chart.draw_series(curve.iter().map(|p| Circle::new(*p, radius, colour.filled())))?;
        }
        Ok(())
    })?;
    Ok(Figure {
        name: "onset",
        section: 3,
        caption: "The homoclinic tangency of the stick-slip oscillator that is the first one at small \
                  $eps$, followed to $eps = 1$, where on the left loop others have come before it, against \
                  Melnikov's threshold, which does not depend on $eps$ ($a = b = 1$, $alpha = beta = T0 = \
                  0.3$, $omega = 2$, $v* = 0.4$)."
            .into(),
        svg,
    })
}
