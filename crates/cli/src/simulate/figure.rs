//! Figures of a motion: phase portrait, time series, section.

use super::motion::{Dot, Motion, Plan};
use super::plot::{BLUE, Chart, Drawn, RED, chart};
use super::report::{name, plain};
use crate::arguments::{Figure, Section};
use crate::failure::Failure;
use lindstedt::simulate::EventKind;
use plotters::prelude::*;

const GREY: RGBColor = RGBColor(120, 120, 120);

pub fn draw(figure: Figure, plan: &Plan, motion: &Motion) -> Result<String, Failure> {
    let problem = &plan.setup.name;
    let labels =
        |x: &str, y: &str| (format!("{x} (dimensionless)"), format!("{y} (dimensionless)"));
    if figure == Figure::Section {
        let points: Vec<(f64, f64)> =
            motion.points.iter().map(plain).map(|[_, x, v]| (x, v)).collect();
        let (kind, up) = match plan.section {
            Some(Section::Stroboscopic) => ("once per period of the force", "velocity x'"),
            Some(Section::Impact) => ("just before impacts", "velocity x' before impact"),
            _ => ("at maxima of x", "velocity x'"),
        };
        // On a wall or at maxima one coordinate is constant: the points in time tell more.
        let over_time = !matches!(plan.section, Some(Section::Stroboscopic));
        if over_time {
            let maxima = plan.section != Some(Section::Impact);
            let pick = |[t, x, v]: [f64; 3]| (t, if maxima { x } else { v });
            let points: Vec<(f64, f64)> = motion.points.iter().map(plain).map(pick).collect();
            let up = if maxima { "maximum of x" } else { up };
            let title = format!("{problem}: Poincare section {kind}, {} points", points.len());
            return chart(&title, &labels("time t", up), &points, |c| dots(c, &points));
        }
        let title = format!("{problem}: Poincare section {kind}, {} points", points.len());
        return chart(&title, &labels("displacement x", up), &points, |c| dots(c, &points));
    }
    let phase = figure == Figure::Phase;
    let place = |dot: &Dot| if phase { (dot.x, dot.v) } else { (dot.time, dot.x) };
    let points: Vec<(f64, f64)> = motion.line.iter().map(place).collect();
    let (title, labels) = if phase {
        ("phase portrait", labels("displacement x", "velocity x'"))
    } else {
        ("time series", labels("time t", "displacement x"))
    };
    let end = motion.line.last().map_or(0.0, |dot| dot.time);
    let title = format!("{problem}: {title} to t = {end:.4}");
    chart(&title, &labels, &points, |chart| {
        lines(chart, motion, &place, phase)?;
        events(chart, motion, phase)
    })
}

fn dots(chart: &mut Chart<'_, '_>, points: &[(f64, f64)]) -> Drawn {
    let radius = if points.len() > 500 { 1 } else { 3 };
    chart.draw_series(points.iter().map(|p| Circle::new(*p, radius, BLUE.filled())))?;
    Ok(())
}

/// Pieces of one kind; in the phase plane broken where the velocity jumps.
fn lines(
    chart: &mut Chart<'_, '_>,
    motion: &Motion,
    place: &dyn Fn(&Dot) -> (f64, f64),
    phase: bool,
) -> Drawn {
    let mut labelled = [false; 2];
    let jump = |a: &Dot, b: &Dot| phase && a.time == b.time && (a.v - b.v).abs() > 1e-9;
    // The sticking pieces are drawn last, on top.
    for stuck in [false, true] {
        let same = |a: &Dot, b: &Dot| a.stuck == b.stuck && !jump(a, b);
        for piece in
            motion.line.chunk_by(same).filter(|p| p.first().is_some_and(|d| d.stuck == stuck))
        {
            let (colour, width, word) = if stuck {
                (RED, 4, "sticking or at rest at the wall")
            } else {
                (BLUE, 1, "moving")
            };
            let style = colour.stroke_width(width);
            let series = chart.draw_series(LineSeries::new(piece.iter().map(place), style))?;
            if !std::mem::replace(&mut labelled[usize::from(stuck)], true) {
                let key = colour.stroke_width(width.max(2));
                series
                    .label(word)
                    .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 20, y)], key));
            }
        }
    }
    Ok(())
}

fn events(chart: &mut Chart<'_, '_>, motion: &Motion, phase: bool) -> Drawn {
    let impacts = motion.events.iter().filter(|e| matches!(e.kind, EventKind::Impact { .. }));
    let impacts: Vec<_> = impacts.collect();
    if !phase && !impacts.is_empty() {
        let marks = impacts.iter().map(|e| (e.time.to_f64(), e.after[0].to_f64()));
        chart
            .draw_series(marks.map(|at| TriangleMarker::new(at, 6, RED.filled())))?
            .label("impact")
            .legend(|(x, y)| TriangleMarker::new((x + 10, y), 6, RED.filled()));
    }
    if phase && !impacts.is_empty() {
        let mut first = true;
        for e in &impacts {
            let ends = [&e.before, &e.after].map(|s| (s[0].to_f64(), s[1].to_f64()));
            let style = GREY.mix(0.6).stroke_width(1);
            let series = chart.draw_series(DashedLineSeries::new(ends, 4, 4, style))?;
            if std::mem::take(&mut first) {
                series.label("impact").legend(move |(x, y)| {
                    PathElement::new(vec![(x, y), (x + 20, y)], GREY.stroke_width(1))
                });
            }
        }
    }
    if !phase {
        return Ok(());
    }
    for (kind, filled) in [("stick", true), ("slip", false)] {
        let found = motion.events.iter().filter(|e| name(e.kind) == kind);
        let places: Vec<_> = found.map(|e| (e.after[0].to_f64(), e.after[1].to_f64())).collect();
        if places.is_empty() {
            continue;
        }
        let style = if filled { RED.filled() } else { RED.stroke_width(2) };
        chart
            .draw_series(places.into_iter().map(|at| Circle::new(at, 4, style)))?
            .label(if filled { "stick begins" } else { "slip begins" })
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, style));
    }
    Ok(())
}
