//! DF at the centre, in doubles: h -> omega^2 h_i'' - sum_k (dg_i/dx_k h_k + omega dg_i/dx_k' h_k')
//! (' = d/dtau), and the column of the frequency.

use crate::centre::Values;
use crate::exact::{ERROR, Exact};
use crate::space::Wave;
use crate::upward::{UNIT, Up};
use crate::{Condition, Rows};
use nalgebra::{Complex, DMatrix, DVector};

type C = Complex<f64>;

/// DF as coefficients; matrices of functions by rows.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub(crate) frequency: f64,
    pub(crate) unknowns: usize,
    /// dg_i/dx_k and omega dg_i/dx_k', modes 0..=band; what was left out of them has small norms.
    pub(crate) by_x: Vec<Vec<C>>,
    pub(crate) by_slope: Vec<Vec<C>>,
    /// dF_i/domega, modes 0...
    pub(crate) by_frequency: Vec<Vec<C>>,
    pub(crate) rows: Rows,
}

/// A correction: of the frequency and of the coefficients, modes 0... by unknowns.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub(crate) frequency: f64,
    pub(crate) unknowns: Vec<Vec<C>>,
}

impl Linear {
    pub(crate) fn new(frequency: f64, values: &Values, rows: Rows) -> Self {
        let coefficients = |list: &[Exact]| list.iter().map(|e| e.doubles(0)).collect();
        Self {
            frequency,
            unknowns: values.residual.len(),
            by_x: coefficients(&values.by_x),
            by_slope: coefficients(&values.by_slope),
            by_frequency: coefficients(&values.by_frequency),
            rows,
        }
    }

    /// Leaves out the modes of the functions beyond the band outside which the rest is below
    /// `fraction` of their sizes.
    pub(crate) fn cut(&mut self, fraction: f64) {
        for lists in [&mut self.by_x, &mut self.by_slope] {
            let total: f64 = lists.iter().flatten().map(|c| c.norm()).sum();
            for list in lists {
                let mut rest = 0.0;
                while let Some(c) = list.last() {
                    rest += c.norm();
                    if rest > fraction * total || list.len() == 1 {
                        break;
                    }
                    list.pop();
                }
            }
        }
    }

    /// The largest mode of the functions.
    pub(crate) fn band(&self) -> usize {
        self.by_x.iter().chain(&self.by_slope).map(|f| f.len()).max().unwrap_or(1) - 1
    }

    /// The waves up to a mode.
    pub(crate) fn basis(&self, modes: usize) -> Vec<Wave> {
        self.rows.parity.basis(self.unknowns, modes)
    }

    /// Unknowns beside the waves: the frequency.
    pub(crate) fn extra(&self) -> usize {
        usize::from(self.rows.condition.is_some())
    }

    /// The complex coefficient at mode k >= 0 of row i of -(dg/dx h + omega dg/dx' h') for a wave h.
    pub(crate) fn coupling(&self, i: usize, k: usize, h: Wave) -> C {
        let entry = i * self.unknowns + h.unknown;
        let (by_x, by_slope) = (&self.by_x[entry], &self.by_slope[entry]);
        let (k, j) = (k as i64, h.k as i64);
        if j == 0 {
            return -at(by_x, k);
        }
        let (u, v) = (at(by_x, k - j), at(by_slope, k - j));
        let (s, t) = (at(by_x, k + j), at(by_slope, k + j));
        let half = C::new(0.0, 0.5);
        // h' = -j sin j tau, j cos j tau.
        if h.sine {
            half * (u - s) - (v + t) * (0.5 * j as f64)
        } else {
            -(u + s) * 0.5 - half * (v - t) * j as f64
        }
    }

    /// A bound of the sums of absolute values in [`Self::coupling`] as a real coefficient: its
    /// rounding error is at most 8 units of this.
    pub(crate) fn coupling_size(&self, i: usize, k: usize, h: Wave) -> f64 {
        let entry = i * self.unknowns + h.unknown;
        let (by_x, by_slope) = (&self.by_x[entry], &self.by_slope[entry]);
        let (k, j) = (k as i64, h.k as i64);
        let size = |list: &[C], k| {
            let c = at(list, k);
            c.re.abs() + c.im.abs()
        };
        let x = size(by_x, k - j) + size(by_x, k + j);
        let slope = size(by_slope, k - j) + size(by_slope, k + j);
        x + slope * j as f64
    }

    /// The relative error of a coupling: of the coefficients, and of the operations.
    pub(crate) fn coupling_error() -> Up {
        ERROR + Up(16.0 * UNIT)
    }

    /// The row of DF at a wave against the column of a wave.
    pub(crate) fn entry(&self, row: Wave, column: Wave) -> f64 {
        let coupling = row.of(self.coupling(row.unknown, row.k, column));
        if row == column {
            let k = row.k as f64;
            coupling - self.frequency * self.frequency * k * k
        } else {
            coupling
        }
    }

    /// DF on the unknowns up to `modes`.
    pub(crate) fn matrix(&self, modes: usize) -> DMatrix<f64> {
        let (basis, extra) = (self.basis(modes), self.extra());
        let n = basis.len() + extra;
        let mut matrix = DMatrix::zeros(n, n);
        for (j, column) in basis.iter().enumerate() {
            for (i, row) in basis.iter().enumerate() {
                matrix[(i + extra, j + extra)] = self.entry(*row, *column);
            }
            if let Some(condition) = self.rows.condition {
                matrix[(0, j + extra)] = condition.of(*column);
            }
        }
        if extra == 1 {
            for (i, row) in basis.iter().enumerate() {
                let by_frequency = &self.by_frequency[row.unknown];
                matrix[(i + 1, 0)] = row.of(at(by_frequency, row.k as i64));
            }
        }
        matrix
    }

    /// DF applied to a step, up to its own modes: (condition, coefficients).
    pub(crate) fn apply(&self, step: &Step) -> (f64, Vec<Vec<C>>) {
        let n = self.unknowns;
        let modes = step.unknowns[0].len() - 1;
        let slope = |h: &Vec<C>| -> Vec<C> {
            let each = h.iter().enumerate();
            each.map(|(k, c)| c * C::new(0.0, k as f64)).collect()
        };
        let x: Vec<_> = step.unknowns.iter().map(|h| full(h)).collect();
        let slopes: Vec<_> = step.unknowns.iter().map(|h| full(&slope(h))).collect();
        let by_x: Vec<_> = self.by_x.iter().map(|f| full(f)).collect();
        let by_slope: Vec<_> = self.by_slope.iter().map(|f| full(f)).collect();
        let square = self.frequency * self.frequency;
        let row = |i: usize, k: usize| {
            let inertia = step.unknowns[i][k] * -(square * (k * k) as f64);
            let product = |j: usize| {
                let entry = i * n + j;
                convolution(&by_x[entry], &x[j], k) + convolution(&by_slope[entry], &slopes[j], k)
            };
            let product: C = (0..n).map(product).sum();
            inertia - product + at(&self.by_frequency[i], k as i64) * step.frequency
        };
        let of = |condition: Condition| {
            let waves = self.basis(modes);
            waves.iter().map(|w| condition.of(*w) * w.of(step.unknowns[w.unknown][w.k])).sum()
        };
        let rows = (0..n).map(|i| (0..=modes).map(|k| row(i, k)).collect()).collect();
        (self.rows.condition.map_or(0.0, of), rows)
    }

    /// A applied to (condition, coefficients): the inverse on its modes, the inverse of omega^2
    /// d^2/dtau^2 beyond.
    pub(crate) fn precondition(&self, inverse: &Inverse, condition: f64, rows: &[Vec<C>]) -> Step {
        let extra = self.extra();
        let basis = &inverse.basis;
        let at_row = |w: &Wave| w.of(at(&rows[w.unknown], w.k as i64));
        let start = (extra == 1).then_some(condition);
        let all = start.into_iter().chain(basis.iter().map(at_row));
        let vector = DVector::from_iterator(basis.len() + extra, all);
        let solution = &inverse.matrix * vector;
        let modes = rows[0].len().max(inverse.modes + 1);
        let mut unknowns = vec![vec![C::default(); modes]; self.unknowns];
        for (w, value) in basis.iter().zip(solution.iter().skip(extra)) {
            unknowns[w.unknown][w.k] += w.complex(*value);
        }
        for (h, row) in unknowns.iter_mut().zip(rows) {
            for (k, c) in row.iter().enumerate().skip(inverse.modes + 1) {
                let rate = k as f64 * self.frequency;
                h[k] = *c / -(rate * rate);
            }
        }
        Step { frequency: if extra == 1 { solution[0] } else { 0.0 }, unknowns }
    }
}

/// The numerical inverse of DF on the waves up to a mode.
#[derive(Clone, Debug)]
pub(crate) struct Inverse {
    pub(crate) modes: usize,
    pub(crate) basis: Vec<Wave>,
    pub(crate) matrix: DMatrix<f64>,
}

/// c_k for any k of a real function.
pub(crate) fn at(half: &[C], k: i64) -> C {
    match half.get(k.unsigned_abs() as usize) {
        Some(c) if k < 0 => c.conj(),
        Some(c) => *c,
        None => C::default(),
    }
}

/// c_k, k = -M..=M.
fn full(half: &[C]) -> Vec<C> {
    let negative = half.iter().skip(1).rev().map(C::conj);
    negative.chain(half.iter().copied()).collect()
}

/// sum_l f_l g_(k-l) of two full lists.
fn convolution(f: &[C], g: &[C], k: usize) -> C {
    let (m, n) = ((f.len() / 2) as i64, (g.len() / 2) as i64);
    let k = k as i64;
    let (from, to) = ((k - n).max(-m), (k + n).min(m));
    if from > to {
        return C::default();
    }
    let part = &f[(from + m) as usize..=(to + m) as usize];
    let other = &g[(k - to + n) as usize..=(k - from + n) as usize];
    let (mut re, mut im) = (0.0, 0.0);
    for (a, b) in part.iter().zip(other.iter().rev()) {
        re += a.re * b.re - a.im * b.im;
        im += a.re * b.im + a.im * b.re;
    }
    C::new(re, im)
}
