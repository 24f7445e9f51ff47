//! Gaussian elimination with complete pivoting, which reveals the rank.

use lindstedt_algebra::Stop;
use rug::Float;

/// The pivots below 2^-(7/8 bits) of the first are zero: the rest is the rounding of the data.
/// A caller that doubles the bits tells a true zero from a small pivot.
const RANK_NUMERATOR: u32 = 7;
const RANK_DENOMINATOR: u32 = 8;

/// A matrix in echelon form: after the permutation of the columns the upper triangle of the
/// first `rank` columns is regular.
pub(super) struct Echelon {
    pub rank: usize,
    rows: Vec<Vec<Float>>,
    columns: Vec<usize>,
    bits: u32,
}

impl Echelon {
    /// Eliminates; O(rows^2 columns). Means nothing once `stop` said so, which is asked per row.
    pub fn new(mut rows: Vec<Vec<Float>>, bits: u32, stop: &Stop) -> Self {
        let width = rows.first().map_or(0, Vec::len);
        let mut columns: Vec<usize> = (0..width).collect();
        let mut threshold: Option<Float> = None;
        let mut rank = 0;
        while rank < rows.len().min(width) {
            let mut best = (rank, rank);
            for (i, row) in rows.iter().enumerate().skip(rank) {
                for (j, entry) in row.iter().enumerate().skip(rank) {
                    if entry.cmp_abs(&rows[best.0][best.1]).is_some_and(|o| o.is_gt()) {
                        best = (i, j);
                    }
                }
            }
            let size = Float::with_val(bits, rows[best.0][best.1].abs_ref());
            let least = threshold
                .get_or_insert_with(|| size.clone() >> (bits / RANK_DENOMINATOR * RANK_NUMERATOR));
            if size.is_zero() || size <= *least || !size.is_finite() || stop.asked() {
                break;
            }
            rows.swap(rank, best.0);
            for row in &mut rows {
                row.swap(rank, best.1);
            }
            columns.swap(rank, best.1);
            let (done, rest) = rows.split_at_mut(rank + 1);
            let Some(pivot) = done.last() else { break };
            for row in rest {
                if row[rank].is_zero() || stop.asked() {
                    continue;
                }
                let factor = Float::with_val(bits, &row[rank] / &pivot[rank]);
                for j in rank..width {
                    row[j] -= Float::with_val(bits, &factor * &pivot[j]);
                }
            }
            rank += 1;
        }
        Self { rank, rows, columns, bits }
    }

    /// The vector of the kernel whose first free component is one and whose other free ones
    /// vanish; nothing for a regular square matrix.
    pub fn kernel(&self) -> Option<Vec<Float>> {
        let width = self.columns.len();
        if self.rank >= width {
            return None;
        }
        let mut permuted = vec![Float::new(self.bits); width];
        permuted[self.rank] = Float::with_val(self.bits, 1);
        for i in (0..self.rank).rev() {
            let mut sum = Float::new(self.bits);
            let known = self.rows[i].iter().zip(&permuted).take(self.rank + 1).skip(i + 1);
            for (entry, value) in known {
                sum -= Float::with_val(self.bits, entry * value);
            }
            permuted[i] = sum / &self.rows[i][i];
        }
        let mut vector = vec![Float::new(self.bits); width];
        for (value, &column) in permuted.into_iter().zip(&self.columns) {
            vector[column] = value;
        }
        Some(vector)
    }
}
