//! Rest, and where motions are born of it.

use super::super::survey::Located;
use super::super::{Branch, Change, Course, Point, Value};
use super::{FreePhase, Turning};
use crate::eigenvalues::eigenvalues;
use nalgebra::Complex;

impl FreePhase {
    /// Rest over the parameter, and the values at which exponents of it cross the imaginary axis, by bisection: motions are born
    /// of rest there. Two crossings within a 400th of the range that undo each other are not seen.
    #[must_use]
    pub fn rest(&self, values: &[Option<Value>], course: &Course) -> Turning {
        const CELLS: u32 = 400;
        let flow = self.flow().system(values);
        let [low, high] = course.range;
        let slopes = |s: f64| -> Vec<f64> {
            let (_, slopes) = flow.derivatives(&[0.0, 0.0, 0.0, 0.0, s]);
            slopes.chunks_exact(5).flat_map(|row| &row[..4]).copied().collect()
        };
        // The exponents with the largest real part first, and the size of the matrix.
        let growths = |s: f64| {
            let rows = slopes(s);
            let mut exponents = eigenvalues(4, &rows);
            exponents.sort_by(|a, b| b.re.total_cmp(&a.re));
            (exponents, rows.iter().fold(0.0f64, |m, x| m.max(x.abs())))
        };
        let points: Vec<Point> = (0..=CELLS)
            .map(|k| low + (high - low) * f64::from(k) / f64::from(CELLS))
            .map(|s| {
                let at = vec![0.0, 0.0, 0.0, 0.0, s];
                Point { at, exponents: eigenvalues(4, &slopes(s)), change: None }
            })
            .collect();
        // How many grow, but for rounding.
        let growing = |(exponents, size): &(Vec<Complex<f64>>, f64)| {
            exponents.iter().filter(|x| x.re > 1e-11 * size).count()
        };
        // The error of an exponent by rounding, which is that of a square root where two of them meet.
        let unsure = |(exponents, size): &(Vec<Complex<f64>>, f64), k: usize| {
            let others = (0..exponents.len()).filter(|j| *j != k);
            let gap = others.map(|j| (exponents[j] - exponents[k]).norm()).fold(*size, f64::min);
            1e-14 * size * size / gap.max(1e-7 * size)
        };
        // Where an exponent is zero within its error at both ends, it moves by rounding alone.
        let moves = |cell: &[f64; 2]| {
            let ends = cell.map(growths);
            let [from, to] = ends.each_ref().map(growing);
            from != to
                && ends.iter().any(|end| {
                    let k = from.min(to);
                    end.0.get(k).is_some_and(|x| x.re.abs() > unsure(end, k))
                })
        };
        let mut changes = Vec::new();
        let mut cells: Vec<_> = points.windows(2).map(|two| [two[0].at[4], two[1].at[4]]).collect();
        cells.retain(moves);
        while let Some([a, b]) = cells.pop() {
            let ends = [a, b].map(growths);
            let [from, to] = ends.each_ref().map(growing);
            if from == to {
                continue;
            }
            let [Some(x), Some(y)] = ends.map(|(all, _)| Some(all.get(from.min(to))?.re)) else {
                continue;
            };
            let (middle, width) = (0.5 * (a + b), b - a);
            // A real part that passes zero does so on a line; one that comes from a double exponent, like a root.
            let line = width < 1e-7 * (high - low) && x * y < 0.0;
            let at = if line { a - x * width / (y - x) } else { middle };
            if line || width < 1e-14 * (high - low) || [a, b].contains(&middle) {
                let at = vec![0.0, 0.0, 0.0, 0.0, at];
                changes.push(Located { change: Change::Hopf, branch: 0, at, proved: None });
            } else {
                cells.extend([[a, middle], [middle, b]]);
            }
        }
        // Of one that is met at the end of two cells both find it, within rounding.
        let place = |it: &Located| it.at[4];
        changes.sort_by(|a, b| place(a).total_cmp(&place(b)));
        changes.dedup_by(|next, it| {
            let same = place(next) - place(it) < 1e-7 * (high - low);
            if same {
                it.at[4] = 0.5 * (place(it) + place(next));
            }
            same
        });
        let rates = vec![0.0; points.len()];
        Turning { branch: Branch { points, closed: false, complete: true }, rates, changes }
    }
}
