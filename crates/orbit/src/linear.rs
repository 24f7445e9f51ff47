//! DF at the centre, in doubles: h -> omega^2 h'' - g_x h - omega g_y h' (' = d/dtau), and the
//! column of the frequency.

use crate::centre::{Doubles, Values};
use crate::space::Wave;
use crate::upward::{UNIT, Up};
use crate::{Condition, Rows};
use nalgebra::{Complex, DMatrix, DVector};

type C = Complex<f64>;

/// DF as coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub(crate) frequency: f64,
    /// g_x and omega g_y, k = 0..=band; what was left out of them has small norms.
    pub(crate) by_x: Vec<C>,
    pub(crate) by_slope: Vec<C>,
    /// dF/domega, k = 0...
    pub(crate) by_frequency: Vec<C>,
    pub(crate) rows: Rows,
}

/// A correction: of the frequency and of c_k, k = 0...
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub(crate) frequency: f64,
    pub(crate) modes: Vec<C>,
}

impl Linear {
    pub(crate) fn new(frequency: f64, values: &Values, rows: Rows) -> Self {
        let coefficients = |e: &crate::centre::Exact| e.doubles(Some(0)).values;
        Self {
            frequency,
            by_x: coefficients(&values.by_x),
            by_slope: coefficients(&values.by_slope),
            by_frequency: coefficients(&values.by_frequency),
            rows,
        }
    }

    /// Leaves out the modes of g_x and g_y beyond the band outside which the rest is below
    /// `fraction` of their sizes.
    pub(crate) fn cut(&mut self, fraction: f64) {
        for list in [&mut self.by_x, &mut self.by_slope] {
            let total: f64 = list.iter().map(|c| c.norm()).sum();
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

    /// The complex coefficient at mode k >= 0 of -(g_x h + omega g_y h') for a wave h.
    pub(crate) fn coupling(&self, k: usize, h: Wave) -> C {
        let (k, j) = (k as i64, h.k as i64);
        if j == 0 {
            return -at(&self.by_x, k);
        }
        let (u, v) = (at(&self.by_x, k - j), at(&self.by_slope, k - j));
        let (s, t) = (at(&self.by_x, k + j), at(&self.by_slope, k + j));
        let i = C::new(0.0, 0.5);
        // h' = -j sin j tau, j cos j tau.
        if h.sine {
            i * (u - s) - (v + t) * (0.5 * j as f64)
        } else {
            -(u + s) * 0.5 - i * (v - t) * j as f64
        }
    }

    /// A bound of the sums of absolute values in [`Self::coupling`] as a real coefficient: its
    /// rounding error is at most 8 units of this.
    pub(crate) fn coupling_size(&self, k: usize, h: Wave) -> f64 {
        let (k, j) = (k as i64, h.k as i64);
        let size = |list: &[C], k| {
            let c = at(list, k);
            c.re.abs() + c.im.abs()
        };
        let x = size(&self.by_x, k - j) + size(&self.by_x, k + j);
        let slope = size(&self.by_slope, k - j) + size(&self.by_slope, k + j);
        x + slope * j as f64
    }

    /// The relative error of a coupling: of the coefficients, and of the operations.
    pub(crate) fn coupling_error() -> Up {
        Doubles::ERROR + Up(16.0 * UNIT)
    }

    /// The row of DF at a wave against the column of a wave.
    pub(crate) fn entry(&self, row: Wave, column: Wave) -> f64 {
        let coupling = row.of(self.coupling(row.k, column));
        if row == column {
            let k = row.k as f64;
            coupling - self.frequency * self.frequency * k * k
        } else {
            coupling
        }
    }

    /// DF on the unknowns up to `modes`.
    pub(crate) fn matrix(&self, modes: usize) -> DMatrix<f64> {
        let basis = self.rows.parity.basis(modes);
        let extra = usize::from(self.rows.condition.is_some());
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
                matrix[(i + 1, 0)] = row.of(at(&self.by_frequency, row.k as i64));
            }
        }
        matrix
    }

    /// DF applied to a step, up to its own modes: (condition, coefficients).
    pub(crate) fn apply(&self, step: &Step) -> (f64, Vec<C>) {
        let modes = step.modes.len() - 1;
        let slope: Vec<C> =
            step.modes.iter().enumerate().map(|(k, c)| c * C::new(0.0, k as f64)).collect();
        let (x, slope) = (full(&step.modes), full(&slope));
        let (by_x, by_slope) = (full(&self.by_x), full(&self.by_slope));
        let square = self.frequency * self.frequency;
        let row = |k: usize| {
            let inertia = step.modes[k] * -(square * (k * k) as f64);
            let product = convolution(&by_x, &x, k) + convolution(&by_slope, &slope, k);
            inertia - product + at(&self.by_frequency, k as i64) * step.frequency
        };
        let of = |condition: Condition| {
            let waves = self.rows.parity.basis(modes);
            waves.iter().map(|w| condition.of(*w) * w.of(step.modes[w.k])).sum()
        };
        (self.rows.condition.map_or(0.0, of), (0..=modes).map(row).collect())
    }

    /// A applied to (condition, coefficients): the inverse on its modes, the inverse of omega^2
    /// d^2/dtau^2 beyond.
    pub(crate) fn precondition(&self, inverse: &Inverse, condition: f64, rows: &[C]) -> Step {
        let extra = usize::from(self.rows.condition.is_some());
        let basis = &inverse.basis;
        let at_row = |w: &Wave| w.of(at(rows, w.k as i64));
        let start = (extra == 1).then_some(condition);
        let all = start.into_iter().chain(basis.iter().map(at_row));
        let vector = DVector::from_iterator(basis.len() + extra, all);
        let solution = &inverse.matrix * vector;
        let mut modes = vec![C::default(); rows.len().max(inverse.modes + 1)];
        for (w, value) in basis.iter().zip(solution.iter().skip(extra)) {
            modes[w.k] += w.complex(*value);
        }
        for (k, c) in rows.iter().enumerate().skip(inverse.modes + 1) {
            let rate = k as f64 * self.frequency;
            modes[k] = *c / -(rate * rate);
        }
        Step { frequency: if extra == 1 { solution[0] } else { 0.0 }, modes }
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
