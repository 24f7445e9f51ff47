//! Figures of a motion: phase portrait, time series, section.

use super::motion::{Dot, Motion, Plan};
use super::plot::{BLUE, Chart, Drawn, FINE, Mark, RED, chart, stroke};
use super::report::{name, plain};
use crate::arguments::{Figure, Section};
use crate::failure::Failure;
use lindstedt::simulate::EventKind;
use plotters::prelude::*;

const GREY: RGBColor = RGBColor(90, 90, 90);

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
            return chart(&title, &labels("time t", up), &[], &points, |c| dots(c, &points));
        }
        let title = format!("{problem}: Poincare section {kind}, {} points", points.len());
        return chart(&title, &labels("displacement x", up), &[], &points, |c| dots(c, &points));
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
    let legend = legend(motion, phase);
    chart(&title, &labels, &legend, &points, |chart| {
        lines(chart, motion, &place, phase)?;
        events(chart, motion, phase)
    })
}

const STICK: &str = "stick";
const SLIP: &str = "slip";

fn legend(motion: &Motion, phase: bool) -> Vec<(&'static str, Mark)> {
    let mut list = vec![("moving", Mark::Line(BLUE, 2))];
    let happens = |wanted: &str| motion.events.iter().any(|e| name(e.kind) == wanted);
    if motion.line.iter().any(|dot| dot.stuck) {
        list.push(("sticking, or at rest at the wall", Mark::Line(RED, 4)));
    }
    if happens("impact") {
        let mark = if phase { Mark::Line(GREY, 1) } else { Mark::Triangle(RED) };
        list.push(("impact", mark));
    }
    if phase && happens(STICK) {
        list.push(("stick begins", Mark::Disc(RED)));
    }
    if phase && happens(SLIP) {
        list.push(("slip begins", Mark::Ring(RED)));
    }
    list
}

fn dots(chart: &mut Chart<'_, '_>, points: &[(f64, f64)]) -> Drawn {
    let radius = (if points.len() > 500 { FINE } else { 3 * FINE }) as i32;
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
    let jump = |a: &Dot, b: &Dot| phase && a.time == b.time && (a.v - b.v).abs() > 1e-9;
    let same = |a: &Dot, b: &Dot| a.stuck == b.stuck && !jump(a, b);
    // The sticking pieces are drawn last, on top.
    for stuck in [false, true] {
        let style = if stuck { stroke(RED, 4) } else { stroke(BLUE, 1) };
        for piece in motion.line.chunk_by(same) {
            if piece.first().is_some_and(|dot| dot.stuck == stuck) {
                chart.draw_series(LineSeries::new(piece.iter().map(place), style))?;
            }
        }
    }
    Ok(())
}

fn events(chart: &mut Chart<'_, '_>, motion: &Motion, phase: bool) -> Drawn {
    let fine = FINE as i32;
    for e in motion.events.iter().filter(|e| matches!(e.kind, EventKind::Impact { .. })) {
        if phase {
            let ends = [&e.before, &e.after].map(|s| (s[0].to_f64(), s[1].to_f64()));
            let dashes = DashedLineSeries::new(ends, 5 * FINE, 4 * FINE, stroke(GREY, 1));
            chart.draw_series(dashes)?;
        } else {
            let at = (e.time.to_f64(), e.after[0].to_f64());
            chart.draw_series([TriangleMarker::new(at, 6 * fine, RED.filled())])?;
        }
    }
    for (kind, style) in [(STICK, RED.filled()), (SLIP, stroke(RED, 2))] {
        let found = motion.events.iter().filter(|e| phase && name(e.kind) == kind);
        let places = found.map(|e| (e.after[0].to_f64(), e.after[1].to_f64()));
        chart.draw_series(places.map(|at| Circle::new(at, 4 * fine, style)))?;
    }
    Ok(())
}
