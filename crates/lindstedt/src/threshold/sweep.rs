//! Curves and surfaces of the signed threshold.

use super::subject::{Changes, Range, Subject};
use crate::grid::{Axis, Grid, Part, check_room};
use crate::{Error, Exact};
use lindstedt_melnikov::{self as melnikov, Class, StickSlip, surface};
use lindstedt_number::ball::Balls;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Curves of up to so many points are certified point by point.
const CERTIFIED_POINTS: usize = 20_000;
/// Rows between two looks at the clock.
const BLOCK: usize = 64;
/// Bits of a certified point: its midpoint is the nearest double but for ties.
const BITS: u32 = 140;
/// Bits of the marks of a curve.
const MARKING_BITS: u32 = 160;
/// Families of more curves have no marks: they are drawn as a map.
pub(super) const MOST_CURVES: usize = 12;

/// The signed threshold along one parameter or over two.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Sweep {
    /// The doubles nearest to the values, and nothing where there is no value.
    pub grid: Grid<f64>,
    /// Why points are without a value.
    pub blanks: Vec<Blank>,
    /// Whether the doubles are roundings of certified numbers.
    pub certified: bool,
    /// Over v* in closed form: zeros and cusps of every curve.
    pub marks: Vec<Marks>,
}

/// Points without a value, for one reason.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Blank {
    /// In words.
    pub reason: String,
    /// Their numbers, row by row.
    pub points: Vec<usize>,
}

/// The marked points of one curve.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Marks {
    /// The v* where the threshold vanishes.
    pub zeros: Vec<f64>,
    /// (v*, gamma_c) at |v*| = V.
    pub cusps: Vec<(f64, f64)>,
}

/// The points, and those without a value by reason.
struct Found {
    grid: Grid<f64>,
    reasons: BTreeMap<String, Vec<usize>>,
}

impl Found {
    /// From points and reasons; nothing where a point was not reached.
    fn of(grid: Grid<Result<f64, String>>) -> Self {
        let mut reasons: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, point) in grid.points.iter().enumerate() {
            let reason = match point {
                Some(Ok(_)) => continue,
                Some(Err(reason)) => reason.clone(),
                None => "not reached".to_owned(),
            };
            reasons.entry(reason).or_default().push(index);
        }
        Self { grid: grid.map(Result::ok), reasons }
    }
}

pub(super) fn compute(
    subject: &Subject<'_>,
    mut swept: Vec<Range>,
    part: Option<Part>,
) -> Result<Option<Sweep>, Error> {
    let Some(first) = swept.first() else { return Ok(None) };
    let height = swept.get(1).map_or(1, |second| second.axis.values.len());
    let points = first.axis.values.len().saturating_mul(height);
    let fast = (subject.work.doubles || points > CERTIFIED_POINTS)
        && subject.point.is_some()
        && swept.iter().all(stays);
    // How a point is computed is asked of the whole.
    if let (Some(_), Some(rows)) = (part, swept.get_mut(1)) {
        rows.axis = rows.axis.part(part);
    }
    let bytes = if fast { size_of::<Option<f64>>() } else { size_of::<Result<f64, String>>() };
    let points = swept.iter().map(|range| range.axis.values.len()).product();
    check_room(points, bytes, subject.work)?;
    let found = if fast { doubles(subject, &swept)? } else { certify(subject, &swept) };
    let blanks =
        found.reasons.into_iter().map(|(reason, points)| Blank { reason, points }).collect();
    let certified = !fast && subject.found.class() == Class::Certified;
    let marks =
        if height <= MOST_CURVES && part.is_none() { marks(subject, &swept) } else { Vec::new() };
    Ok(Some(Sweep { grid: found.grid, blanks, certified, marks }))
}

/// Whether every value is one of a parameter of section 3 that leaves the equation of its form.
fn stays(range: &Range) -> bool {
    match range.known {
        Some(melnikov::Axis::A | melnikov::Axis::B | melnikov::Axis::Omega) => {
            range.axis.values.iter().all(|value| value.sign().is_gt())
        }
        known => known.is_some(),
    }
}

fn certify(subject: &Subject<'_>, swept: &[Range]) -> Found {
    let axis = |n: usize| swept.get(n).map(|range| range.axis.clone());
    let point = |first: &Exact, second: Option<&Exact>| {
        let values = [Some(first), second];
        let changes: Vec<(&Range, &Exact)> =
            swept.iter().zip(values).filter_map(|(range, value)| Some((range, value?))).collect();
        let found = subject.signed(Balls::new(BITS), &changes);
        match found.map(|ball| ball.midpoint().to_f64()) {
            Err(_) if subject.work.stop.asked() => Err("not reached".to_owned()),
            Ok(value) => finite(subject, &changes, value),
            Err(reason) => Err(reason),
        }
    };
    let columns = axis(0).unwrap_or(Axis { name: String::new(), values: Vec::new() });
    Found::of(Grid::compute(columns, axis(1), subject.work, point))
}

/// A value that a double holds, or why it is none.
fn finite(subject: &Subject<'_>, changes: &Changes<'_>, value: f64) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err(beyond(subject, changes)) }
}

/// Why a value is not finite.
fn beyond(subject: &Subject<'_>, changes: &Changes<'_>) -> String {
    let refused = subject.changed(changes).and_then(|point| point.check().err());
    refused.map_or("beyond the largest double".to_owned(), |error| error.to_string())
}

/// The closed form in doubles.
fn doubles(subject: &Subject<'_>, swept: &[Range]) -> Result<Found, Error> {
    let (first, second) = (&swept[0], swept.get(1));
    let (columns, rows) = (first.axis.doubles(), second.map(|range| range.axis.doubles()));
    let Some((point, along)) = subject.point.as_ref().zip(first.known) else {
        return Ok(certify(subject, swept));
    };
    let base = point.map(Exact::to_f64);
    let width = columns.len();
    // Of one curve the row is the value that the columns replace.
    let across = second.and_then(|range| range.known).unwrap_or(along);
    let rows = rows.unwrap_or_else(|| vec![point.get(along).to_f64()]);
    let mut points = Vec::with_capacity(width.saturating_mul(rows.len()));
    let mut reasons: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let mut block = vec![f64::NAN; width.saturating_mul(BLOCK)];
    for (number, rows) in rows.chunks(BLOCK).enumerate() {
        if subject.work.stop.asked() {
            break;
        }
        let block = &mut block[..width * rows.len()];
        surface(&base, (across, rows), (along, &columns), block)?;
        points.extend(block.iter().map(|value| value.is_finite().then_some(*value)));
        let without = block.iter().enumerate().filter(|(_, value)| !value.is_finite());
        for (index, _) in without {
            let (column, row) = (index % width, number * BLOCK + index / width);
            let values =
                [first.axis.values.get(column), second.and_then(|s| s.axis.values.get(row))];
            let places = swept.iter().zip(values);
            let changes: Vec<_> = places.filter_map(|(range, v)| Some((range, v?))).collect();
            let reason = beyond(subject, &changes);
            reasons.entry(reason).or_default().push(row * width + column);
        }
    }
    let rows = second.map(|range| range.axis.clone());
    Ok(Found { grid: Grid { columns: first.axis.clone(), rows, points }, reasons })
}

/// The zeros and the cusps (|v*| = V) of every curve over v* in closed form.
fn marks(subject: &Subject<'_>, swept: &[Range]) -> Vec<Marks> {
    let first = swept.first().filter(|range| range.known == Some(melnikov::Axis::BeltSpeed));
    let (Some(first), Some(point)) = (first, &subject.point) else { return Vec::new() };
    if !swept.iter().all(stays) {
        return Vec::new();
    }
    let columns = first.axis.doubles();
    let (low, high) = columns
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let of = |point: &StickSlip| {
        let balls = Balls::new(MARKING_BITS);
        let both = |x: f64| [-x, x].into_iter().filter(|x| (low..=high).contains(x));
        let zeros = point.zeros(balls).unwrap_or_default();
        let value = point.threshold_at_cusp(balls).map(|ball| ball.midpoint().to_f64().abs());
        let speed = point.loop_speed(balls).map(|ball| ball.midpoint().to_f64());
        let cusp = speed.zip(value).filter(|(_, y)| y.is_finite() && point.dry.sign().is_ne());
        Marks {
            zeros: zeros.iter().flat_map(|zero| both(zero.midpoint().to_f64())).collect(),
            cusps: cusp.iter().flat_map(|(x, y)| both(*x).map(|x| (x, *y))).collect(),
        }
    };
    match swept.get(1).and_then(|range| Some((range.known?, &range.axis.values))) {
        Some((axis, values)) => {
            values.iter().map(|value| of(&point.clone().with(axis, value.clone()))).collect()
        }
        None => vec![of(point)],
    }
}

/// The keys of a sweep in JSON.
#[derive(Default, Serialize)]
struct Keys<'a> {
    curve: Vec<(f64, Option<f64>)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    curve_status: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    blanks: Option<Vec<Without<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    curve_signed: Option<Vec<(f64, Option<f64>)>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    grid: Option<Surface<'a>>,
}

/// A blank in JSON.
#[derive(Serialize)]
struct Without<'a> {
    reason: &'a str,
    points: Vec<Vec<f64>>,
}

/// A surface in JSON.
#[derive(Serialize)]
struct Surface<'a> {
    columns: Vec<f64>,
    rows: Vec<f64>,
    signed: Vec<&'a [Option<f64>]>,
}

pub(super) fn keys<S: Serializer>(sweep: &Option<Sweep>, serializer: S) -> Result<S::Ok, S::Error> {
    let Some(Sweep { grid, blanks, certified, .. }) = sweep else {
        return Keys::default().serialize(serializer);
    };
    let (columns, rows) = (grid.columns.doubles(), grid.rows.as_ref().map(Axis::doubles));
    let width = grid.width();
    let place = |index: &usize| {
        let row = rows.as_ref().and_then(|rows| rows.get(index / width));
        columns.get(index % width).into_iter().chain(row).copied().collect()
    };
    let without = |blank: &'_ Blank| blank.points.iter().map(place).collect();
    let blanks = blanks.iter().map(|b| Without { reason: &b.reason, points: without(b) }).collect();
    let mut keys = Keys {
        curve_status: Some(if *certified { "certified" } else { "estimated" }),
        blanks: Some(blanks),
        ..Keys::default()
    };
    match rows {
        None => {
            let signed: Vec<(f64, Option<f64>)> =
                columns.iter().copied().zip(grid.points.iter().copied()).collect();
            keys.curve = signed.iter().map(|(x, y)| (*x, y.map(f64::abs))).collect();
            keys.curve_signed = Some(signed);
        }
        Some(rows) => {
            keys.grid =
                Some(Surface { columns, rows, signed: grid.points.chunks(width).collect() });
        }
    }
    keys.serialize(serializer)
}
