//! Curves and surfaces.

use super::report::Answer;
use super::request::{Request, Sweep};
use crate::failure::{Failure, UNDECIDED};
use crate::session::Session;
use lindstedt::Exact;
use lindstedt::number::ball::Balls;
use lindstedt_melnikov::{Class, FastPoint, surface};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Curves of up to so many points are certified point by point.
const CERTIFIED_POINTS: usize = 20_000;
/// Rows between two looks at the clock.
const BLOCK: usize = 64;
/// Bits of a certified point: its midpoint is the nearest double but for ties.
const BITS: u32 = 140;
/// Of a value that no double holds.
const NO_DOUBLE: &str = "beyond the largest double";

/// Signed thresholds on a grid; the first sweep runs along the columns.
pub struct Table {
    /// What is swept: along the columns, then along the rows.
    pub names: Vec<String>,
    pub columns: Vec<f64>,
    /// A single row with value NaN where there is one sweep.
    pub rows: Vec<f64>,
    /// rows x columns; NaN where there is no value.
    pub signed: Vec<f64>,
    /// The entries without a value, by the reason.
    pub blanks: BTreeMap<String, Vec<usize>>,
    pub certified: bool,
    pub finished: bool,
}

impl Table {
    pub fn compute(
        request: &Request,
        f64_only: bool,
        session: &Session<'_>,
    ) -> Result<Option<Self>, Failure> {
        let Some(first) = request.sweeps.first() else { return Ok(None) };
        let doubles =
            |values: &[Exact]| -> Vec<f64> { values.par_iter().map(Exact::to_f64).collect() };
        let columns = doubles(&first.values);
        let rows = request.sweeps.get(1).map_or_else(|| vec![f64::NAN], |s| doubles(&s.values));
        let points = rows.len().saturating_mul(columns.len());
        let bytes = points.saturating_mul(8) as u64;
        if bytes > session.memory() {
            return Err(Failure {
                exit: UNDECIDED,
                code: "too-large",
                message: format!("{points} points need {bytes} bytes"),
                hint: "fewer values, or raise --limit-memory".into(),
            });
        }
        let mut table = Self {
            names: request.sweeps.iter().map(|sweep| sweep.name.clone()).collect(),
            signed: vec![f64::NAN; points],
            blanks: BTreeMap::new(),
            certified: request.class() == Class::Certified,
            finished: true,
            columns,
            rows,
        };
        if request.is_fast() && (f64_only || points > CERTIFIED_POINTS) {
            table.certified = false;
            table.fast(request, session)?;
        } else {
            table.certify(request, session);
        }
        table.give_reasons(request);
        Ok(Some(table))
    }

    /// A reason for every entry without a value, where there is none yet.
    fn give_reasons(&mut self, request: &Request) {
        let known: BTreeSet<usize> = self.blanks.values().flatten().copied().collect();
        let width = self.columns.len().max(1);
        for (index, entry) in self.signed.iter_mut().enumerate() {
            if entry.is_finite() || known.contains(&index) {
                continue;
            }
            let places = [index % width, index / width];
            let values = request.sweeps.iter().zip(places);
            let changes: Vec<(&Sweep, &Exact)> =
                values.filter_map(|(sweep, i)| Some((sweep, sweep.values.get(i)?))).collect();
            let refused = request.changed(&changes).and_then(|point| point.check().err());
            let reason = match refused {
                Some(error) => error.to_string(),
                None if entry.is_nan() && !self.finished => "not reached".to_owned(),
                None => NO_DOUBLE.to_owned(),
            };
            *entry = f64::NAN;
            self.blanks.entry(reason).or_default().push(index);
        }
    }

    fn certify(&mut self, request: &Request, session: &Session<'_>) {
        let Some(first) = request.sweeps.first() else { return };
        let width = first.values.len();
        // An orbit that is followed numerically takes its time: look at the clock in between.
        let block = if self.certified { 256 } else { 4 };
        let mut index = 0;
        for (i, row) in self.signed.chunks_mut(width).enumerate() {
            let second = request.sweeps.get(1);
            let second = second.and_then(|sweep| Some((sweep, sweep.values.get(i)?)));
            for (entries, values) in row.chunks_mut(block).zip(first.values.chunks(block)) {
                if !session.goes_on() {
                    self.finished = false;
                    return;
                }
                let value = |value: &Exact| {
                    let changes: Vec<(&Sweep, &Exact)> =
                        second.into_iter().chain([(first, value)]).collect();
                    let double = request.signed(Balls::new(BITS), &changes)?.midpoint().to_f64();
                    if double.is_finite() { Ok(double) } else { Err(NO_DOUBLE.to_owned()) }
                };
                let found: Vec<Result<f64, String>> = values.par_iter().map(value).collect();
                for (entry, found) in entries.iter_mut().zip(found) {
                    match found {
                        Ok(double) => *entry = double,
                        Err(reason) => self.blanks.entry(reason).or_default().push(index),
                    }
                    index += 1;
                }
            }
        }
    }

    fn fast(&mut self, request: &Request, session: &Session<'_>) -> Result<(), Failure> {
        let Some(first) = request.sweeps.first() else { return Ok(()) };
        let Some(point) = &request.point else { return Ok(()) };
        let Some(along) = first.axis else { return Ok(()) };
        let base = FastPoint {
            a: point.a.to_f64(),
            b: point.b.to_f64(),
            dry: point.dry.to_f64(),
            alpha: point.alpha.to_f64(),
            beta: point.beta.to_f64(),
            omega: point.omega.to_f64(),
            belt_speed: point.belt_speed.to_f64(),
        };
        let width = self.columns.len();
        let across = request.sweeps.get(1).and_then(|second| second.axis);
        let Some(across) = across else {
            let here = [first_value(&base, along)];
            surface(&base, (along, &here), (along, &self.columns), &mut self.signed)?;
            return Ok(());
        };
        let blocks = self.signed.chunks_mut(BLOCK * width).zip(self.rows.chunks(BLOCK));
        for (block, rows) in blocks {
            if !session.goes_on() {
                self.finished = false;
                break;
            }
            surface(&base, (across, rows), (along, &self.columns), block)?;
        }
        Ok(())
    }

    /// (row, column, signed) in order.
    pub fn entries(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let width = self.columns.len().max(1);
        let rows = self.signed.chunks(width).zip(&self.rows);
        rows.flat_map(|(line, &row)| {
            line.iter().zip(&self.columns).map(move |(&signed, &column)| (row, column, signed))
        })
    }
}

/// A surface with one row needs a value for it: the base value of the same axis, overwritten by
/// the columns.
fn first_value(base: &FastPoint, axis: lindstedt_melnikov::Axis) -> f64 {
    use lindstedt_melnikov::Axis;
    match axis {
        Axis::A => base.a,
        Axis::B => base.b,
        Axis::Dry => base.dry,
        Axis::Alpha => base.alpha,
        Axis::Beta => base.beta,
        Axis::Omega => base.omega,
        Axis::BeltSpeed => base.belt_speed,
    }
}

/// Comma-separated values with a heading; every number with 17 digits.
pub fn csv(request: &Request, table: Option<&Table>, answer: &Answer) -> String {
    let mut text = String::new();
    let Some(table) = table else { return text };
    let _ = writeln!(text, "# {}, {}", request.problem, answer.parameters());
    let names: Vec<&str> = request.sweeps.iter().rev().map(|s| s.name.as_str()).collect();
    let _ = writeln!(text, "{},gamma_c,signed", names.join(","));
    for (row, column, signed) in table.entries() {
        if names.len() == 2 {
            let _ = write!(text, "{row:?},");
        }
        let _ = match signed.is_nan() {
            true => writeln!(text, "{column:?},,"),
            false => writeln!(text, "{column:?},{:?},{signed:?}", signed.abs()),
        };
    }
    text
}
