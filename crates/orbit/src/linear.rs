//! DF at the centre, in doubles: h -> omega^2 h_i'' - sum_k (dg_i/dx_k h_k + omega dg_i/dx_k' h_k')
//! (' = d/dtau), and the column of the frequency.

use crate::Rows;
use crate::centre::Values;
use crate::exact::{ERROR, Exact};
use crate::space::Wave;
use crate::upward::{UNIT, Up};
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
