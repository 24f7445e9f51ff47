//! Surfaces of thresholds in f64, on all cores, nothing allocated per point.
//!
//! What does not depend on the columns is formed once a row, what does not depend on the rows once a column. A value is
//! then some ten sums and products, one root and no branch, so that several columns are computed at a time.
//! Rows with numbers far from 1, and values near 0, are computed point by point.

use crate::fast::{LoopSpeed, Terms, forcing_factor, is_certain, is_moderate, is_near_one, value};
use crate::{Axis, FastPoint, MelnikovError};
use rayon::prelude::*;

/// The signed thresholds over a grid: `table[i * columns.len() + j]` at row i and column j.
///
/// NaN where a parameter leaves its domain (not finite, or a, b, omega <= 0). The rows run on all
/// cores of the current rayon pool; nothing is allocated per point. Every value is that of
/// [`FastPoint::threshold`].
///
/// # Errors
/// [`MelnikovError::WrongTableSize`] where `table` does not have rows x columns entries.
pub fn surface(
    point: &FastPoint,
    rows: (Axis, &[f64]),
    columns: (Axis, &[f64]),
    table: &mut [f64],
) -> Result<(), MelnikovError> {
    let expected = rows.1.len().saturating_mul(columns.1.len());
    if table.len() != expected {
        return Err(MelnikovError::WrongTableSize { expected, found: table.len() });
    }
    if columns.1.is_empty() {
        return Ok(());
    }
    let columns = Columns::new(point, rows.0, columns);
    let lines = table.par_chunks_mut(columns.values.len()).zip(rows.1.par_iter());
    lines.for_each(|(line, &row)| columns.fill(&point.with(rows.0, row), line));
    Ok(())
}

/// What the columns have in common over all rows.
struct Columns<'a> {
    axis: Axis,
    values: &'a [f64],
    /// Whether the plain form serves every column.
    moderate: bool,
    /// V and the factor of every column, where they depend on it and not on the row.
    speeds: Vec<LoopSpeed>,
    factors: Vec<f64>,
    /// All but the factor, where only the factor depends on the row.
    brackets: Vec<f64>,
}

/// The factor, or 0, which is no certain value, where it is far from 1.
fn plain_factor(p: &FastPoint) -> f64 {
    forcing_factor(p.a, p.omega).moderate().unwrap_or(0.0)
}

fn each_product(line: &mut [f64], factors: &[f64], factor: f64) {
    line.iter_mut().zip(factors).for_each(|(y, x)| *y = factor * x);
}

impl<'a> Columns<'a> {
    fn new(point: &FastPoint, row: Axis, (axis, values): (Axis, &'a [f64])) -> Self {
        let at = |x: &f64| point.with(axis, *x);
        let free = |axes: [Axis; 2]| axes.contains(&axis) && (row == axis || !axes.contains(&row));
        let moderate = match axis {
            Axis::A | Axis::B | Axis::Omega => values.iter().all(|&x| is_near_one(x)),
            _ => values.iter().all(|&x| is_moderate(x)),
        };
        let (speeds, factors, brackets) = Default::default();
        let mut columns = Self { axis, values, moderate, speeds, factors, brackets };
        if moderate && free([Axis::A, Axis::B]) {
            columns.speeds = values.iter().map(at).map(|p| LoopSpeed::new(p.a, p.b)).collect();
        }
        if moderate && free([Axis::A, Axis::Omega]) {
            columns.factors = values.iter().map(at).map(|p| plain_factor(&p)).collect();
        }
        if moderate && row == Axis::Omega && !matches!(axis, Axis::A | Axis::Omega) {
            let bracket = |p: FastPoint| Terms::new(&p, LoopSpeed::new(p.a, p.b), 1.0).bracket();
            columns.brackets = values.iter().map(at).map(bracket).collect();
        }
        columns
    }

    /// One row.
    fn fill(&self, row: &FastPoint, line: &mut [f64]) {
        let first = row.with(self.axis, self.values[0]);
        if !(self.moderate && first.is_moderate() && first.check().is_ok()) {
            return self.point_by_point(row, line, |_| true);
        }
        let own = Terms::new(&first, LoopSpeed::new(first.a, first.b), plain_factor(&first));
        let each = line.iter_mut().zip(self.values);
        match self.axis {
            _ if !self.brackets.is_empty() => {
                each_product(line, &self.brackets, own.factor);
            }
            Axis::Omega if !self.factors.is_empty() => {
                each_product(line, &self.factors, own.bracket());
            }
            Axis::BeltSpeed => each.for_each(|(y, &x)| *y = Terms { belt: x, ..own }.value()),
            Axis::Dry => each.for_each(|(y, &x)| *y = Terms { dry: 2.0 * x, ..own }.value()),
            Axis::Alpha => {
                let slope = own.linear_slope();
                each.for_each(|(y, &x)| *y = Terms { linear: slope * x, ..own }.value());
            }
            Axis::Beta | Axis::A | Axis::B | Axis::Omega => {
                for (column, (y, &x)) in each.enumerate() {
                    *y = self.terms(&first.with(self.axis, x), column, &own).value();
                }
            }
        }
        self.point_by_point(row, line, |y| !is_certain(y));
    }

    /// The terms of a column, each part from where it is known.
    fn terms(&self, at: &FastPoint, column: usize, own: &Terms) -> Terms {
        let speed = match (self.speeds.get(column), self.axis) {
            (Some(known), _) => *known,
            (None, Axis::A | Axis::B) => LoopSpeed::new(at.a, at.b),
            _ => own.speed,
        };
        let factor = match (self.factors.get(column), self.axis) {
            (Some(known), _) => *known,
            (None, Axis::A | Axis::Omega) => plain_factor(at),
            _ => own.factor,
        };
        Terms::new(at, speed, factor)
    }

    /// The columns whose value so far asks for it, each by itself.
    fn point_by_point(&self, row: &FastPoint, line: &mut [f64], asks: impl Fn(f64) -> bool) {
        // Most rows have none: a pass without a branch tells.
        if !line.iter().fold(false, |any, y| any | asks(*y)) {
            return;
        }
        let shared = forcing_factor(row.a, row.omega);
        for (y, &x) in line.iter_mut().zip(self.values).filter(|(y, _)| asks(**y)) {
            let at = row.with(self.axis, x);
            *y = match (at.check(), self.axis) {
                (Err(_), _) => f64::NAN,
                (Ok(()), Axis::A | Axis::Omega) => value(&at, &forcing_factor(at.a, at.omega)),
                (Ok(()), _) => value(&at, &shared),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface is its points, bit by bit, over every pair of axes: near |v*| = V, far from 1, and where nothing is left.
    #[test]
    fn a_surface_equals_its_points() {
        let base = FastPoint {
            a: 1.0,
            b: 1.0,
            dry: 0.3,
            alpha: 0.3,
            beta: 0.3,
            omega: 2.0,
            belt_speed: 0.4,
        };
        let edge = 0.5f64.sqrt();
        let positive = [0.3, 1.7, 0.02, 5.0];
        let signed = [-0.4, 0.0, edge, edge * (1.0 - 1e-14), -2.0];
        let list = |axis, far: &[f64]| match axis {
            Axis::A | Axis::B | Axis::Omega => [&positive[..], far].concat(),
            _ => [&signed[..], far].concat(),
        };
        let (mut points, mut none) = (0, 0);
        for row in Axis::ALL {
            for column in Axis::ALL {
                for far in [&[][..], &[1e-60, 1e60, 400.0, -1.0]] {
                    let (rows, columns) = (list(row, far), list(column, &[]));
                    for (along, down) in [(&columns, &rows), (&rows, &columns)] {
                        let mut table = vec![0.0; along.len() * down.len()];
                        surface(&base, (row, down), (column, along), &mut table).unwrap();
                        for (index, value) in table.iter().enumerate() {
                            let (i, j) = (index / along.len(), index % along.len());
                            let at = base.with(row, down[i]).with(column, along[j]);
                            match at.threshold() {
                                Ok(found) => assert_eq!(*value, found.signed, "{at:?}"),
                                Err(_) => assert!(value.is_nan(), "{at:?}"),
                            }
                            points += 1;
                            none += usize::from(value.is_nan());
                        }
                    }
                }
            }
        }
        assert!(points > 4000 && none > 100 && none < points / 4, "{points} {none}");
    }
}
