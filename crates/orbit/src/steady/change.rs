//! Folds, Hopf points, cusps and Bogdanov-Takens points near a guess, proved: zeros of the polynomial systems of
//! [`Flow::conditions`].

use super::branch::{Branch, Point};
use super::flow::{Change, Flow};
use super::krawczyk::{Zero, zero_near};
use super::value::Value;
use crate::eigenvalues::eigenvalues;
use nalgebra::{Complex, DMatrix, DVector};

/// The parts of a unit within which a point is looked for.
const NEAR: f64 = 1e-2;

impl Flow {
    /// The point of a change near `at` (w and the free parameters), proved with the vectors that belong to it: its first
    /// intervals are w and the free parameters. Nothing where there is none near, or where it is degenerate. Of a crossing only
    /// that beta = 0 is not excluded is proved.
    #[must_use]
    pub fn change_near(
        &self,
        change: Change,
        values: &[Option<Value>],
        at: &[f64],
    ) -> Option<Zero> {
        let n = self.unknowns();
        if at.len() != n + Self::free(change) {
            return None;
        }
        let jacobian = self.jacobian(values, at)?;
        let svd = jacobian.clone().svd(true, true);
        let last = svd.singular_values.imin();
        let v: DVector<f64> = svd.v_t.as_ref()?.row(last).transpose();
        let mut l = v.clone();
        let mut guess = at.to_vec();
        match change {
            Change::Fold => guess.extend(v.iter()),
            Change::Hopf => {
                let (a, b, rate) = rotation(&jacobian)?;
                l = &a / a.norm_squared();
                guess.extend(a.iter().chain(b.iter()).chain([&rate]));
            }
            Change::Cusp | Change::BogdanovTakens => {
                let right = if change == Change::Cusp {
                    -self.curvature(values, at, &v)?
                } else {
                    v.clone()
                };
                // The last singular value is zero at the point.
                let cut = svd.singular_values[last] * (1.0 + 1e-9);
                let u = svd.solve(&right, cut).ok()?;
                guess.extend(v.iter().chain(u.iter()));
            }
            Change::Crossing => {
                l = svd.u.as_ref()?.column(last).into_owned();
                guess.extend(l.iter().chain([&0.0]));
            }
        }
        let l: Vec<f64> = l.iter().copied().collect();
        let system = self.conditions(change, values, &l)?;
        let size = |part: &[f64]| part.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let (of_state, of_vectors) = (size(&at[..n]), size(&guess[at.len()..]));
        let width = |i: usize| match i {
            i if i < n => of_state,
            i if i < at.len() => at[i].abs().max(1e-3 * of_state),
            _ => of_vectors,
        };
        let widths: Vec<f64> = (0..guess.len()).map(|i| NEAR * width(i)).collect();
        let zero = zero_near(&system, &guess, &widths)?;
        // Newton's method may have gone to another point.
        let found = zero.middle();
        let near = |i: &usize| (found[*i] - at[*i]).abs() <= 10.0 * widths[*i].max(1e-9);
        // Of a crossing beta is zero.
        let crosses = change != Change::Crossing || zero.enclosure.last()?.contains(0.0);
        (crosses && (0..at.len()).all(|i| near(&i))).then_some(zero)
    }

    /// G_w.
    fn jacobian(&self, values: &[Option<Value>], at: &[f64]) -> Option<DMatrix<f64>> {
        let n = self.unknowns();
        let system = self.system(values);
        if system.variables() != at.len() {
            return None;
        }
        let (_, slopes) = system.derivatives(at);
        Some(DMatrix::from_fn(n, n, |i, j| slopes[i * at.len() + j]))
    }

    /// G_ww(v, v), by a difference: a guess.
    fn curvature(
        &self,
        values: &[Option<Value>],
        at: &[f64],
        v: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let beside = |sign: f64| {
            let mut moved = at.to_vec();
            moved.iter_mut().zip(v.iter()).for_each(|(x, v)| *x += sign * 1e-4 * v);
            self.jacobian(values, &moved)
        };
        Some((beside(1.0)? - beside(-1.0)?) * v / 2e-4)
    }

    /// Cusps and Bogdanov-Takens points on a curve of folds over two free parameters, each proved: the curve turns back
    /// in both parameters at once, or a second exponent changes its sign.
    #[must_use]
    pub fn on_folds(&self, values: &[Option<Value>], folds: &Branch) -> Vec<(Change, Zero)> {
        let n = self.unknowns();
        let mut found: Vec<(Change, Zero)> = Vec::new();
        let mut keep = |change: Change, at: &[f64]| {
            let Some(zero) = self.change_near(change, values, &at[..n + 2]) else { return };
            let same = |(other, known): &(Change, Zero)| {
                let pairs = zero.enclosure.iter().zip(&known.enclosure).take(n + 2);
                *other == change && pairs.into_iter().all(|(a, b)| a.meet(*b).is_some())
            };
            if !found.iter().any(same) {
                found.push((change, zero));
            }
        };
        // In the plane of the parameters the curve runs back where it came from; a piece over the cusp itself hardly moves there.
        // Where a change has a point of its own beside another one there is no direction between them.
        let mut points: Vec<&Point> = folds.points.iter().collect();
        points.dedup_by(|a, b| {
            let size = a.at.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            a.at.iter().zip(&b.at).all(|(x, y)| (x - y).abs() <= 1e-9 * size)
        });
        let extent = [n, n + 1].map(|k| {
            let values = points.iter().map(|point| point.at[k]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            (high - low).max(f64::MIN_POSITIVE)
        });
        let moved =
            |i: usize| [0, 1].map(|k| (points[i + 1].at[n + k] - points[i].at[n + k]) / extent[k]);
        // After its last piece a closed curve has the first.
        let pieces = points.len().saturating_sub(1);
        let after = |i: usize| match folds.closed {
            true => Some(i % pieces),
            false => (i < pieces).then_some(i),
        };
        let back = |i: usize, j: usize| {
            after(j).is_some_and(|j| {
                let [a, b] = [moved(i), moved(j)];
                a[0] * b[0] + a[1] * b[1] < 0.0
            })
        };
        for i in 0..pieces {
            if back(i, i + 1) || back(i, i + 2) {
                keep(Change::Cusp, &points[i + 1].at);
            }
        }
        // The exponents without the one that is zero.
        let second = |exponents: &[Complex<f64>]| {
            let zero = exponents.iter().map(|x| x.norm()).fold(f64::INFINITY, f64::min);
            let others = exponents.iter().filter(|x| x.norm() > zero);
            others.fold(Complex::new(1.0, 0.0), |product, x| product * x).re
        };
        for two in points.windows(2) {
            if second(&two[0].exponents) * second(&two[1].exponents) < 0.0 {
                keep(Change::BogdanovTakens, &two[0].at);
            }
        }
        found
    }
}

/// a, b and a rate > 0 with J a = -rate b, J b = rate a, of the pair of exponents nearest to the imaginary axis; a and b at
/// right angles.
fn rotation(jacobian: &DMatrix<f64>) -> Option<(DVector<f64>, DVector<f64>, f64)> {
    let n = jacobian.nrows();
    let exponents = eigenvalues(n, jacobian.transpose().as_slice());
    let turning = exponents.iter().filter(|x| x.im > 0.0);
    let rate = turning.min_by(|x, y| x.re.abs().total_cmp(&y.re.abs()))?.im;
    let matrix = DMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => jacobian[(i, j)],
        (false, false) => jacobian[(i - n, j - n)],
        (true, false) => f64::from(u8::from(i == j - n)) * rate,
        (false, true) => -f64::from(u8::from(i - n == j)) * rate,
    });
    let svd = matrix.svd(false, true);
    let null: DVector<f64> = svd.v_t.as_ref()?.row(svd.singular_values.imin()).transpose();
    let complex = null.rows(0, n).map(|x| Complex::new(x, 0.0))
        + null.rows(n, n).map(|x| Complex::new(0.0, x));
    let square: Complex<f64> = complex.iter().map(|z| z * z).sum();
    let turned = complex * Complex::from_polar(1.0, -0.5 * square.arg());
    let a = turned.map(|z| z.re);
    let scale = a.norm();
    Some((a / scale, turned.map(|z| z.im) / scale, rate))
}
