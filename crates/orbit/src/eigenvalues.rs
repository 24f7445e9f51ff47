//! Eigenvalues of small real matrices in doubles.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Steps of the QR algorithm for one matrix; a few per eigenvalue are the rule.
const MOST_STEPS: usize = 1000;
/// Bases in which it is tried.
const BASES: u32 = 8;

/// The eigenvalues of an n x n matrix, row by row, with their multiplicity, in no order; none where an entry is not finite or the
/// algorithm does not end. Errors of about 1e-16 times the norm of the matrix times their condition. Cost: O(n^3).
///
/// The shifts of the QR algorithm are functions of the matrix and can go round in a circle for ever, as with those that only
/// permute (dimforge/nalgebra 611). After a reflection the eigenvalues are the same, and the shifts are others.
pub(crate) fn eigenvalues(n: usize, rows: &[f64]) -> Vec<Complex<f64>> {
    if let ([a, b, c, d], 2) = (rows, n) {
        let (half, gap) = (0.5 * (a + d), 0.5 * (a - d));
        let square = gap * gap + b * c;
        let root = Complex::new(square, 0.0).sqrt();
        return vec![root + half, -root + half];
    }
    if n == 0 || rows.iter().any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let matrix = DMatrix::from_row_slice(n, n, rows);
    let found = (0..BASES).find_map(|k| {
        Schur::try_new(reflected(&matrix, k), f64::EPSILON, MOST_STEPS)
            .map(|schur| schur.complex_eigenvalues().iter().copied().collect())
    });
    found.unwrap_or_default()
}

/// H A H with a reflection H = 1 - 2 v v^T/|v|^2, another one for every k; for k = 0 the matrix itself.
fn reflected(matrix: &DMatrix<f64>, k: u32) -> DMatrix<f64> {
    let n = matrix.nrows();
    if k == 0 {
        return matrix.clone();
    }
    let v = DVector::from_fn(n, |i, _| (1.0 + f64::from(k) * (i as f64 + 1.0).sqrt()).sin());
    let reflection = DMatrix::identity(n, n) - &v * v.transpose() * (2.0 / v.norm_squared());
    &reflection * matrix * &reflection
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two springs that exchange what they hold, and the roots of z^4 = 1 as eigenvalues of a cyclic shift: the algorithm alone
    /// goes round for ever with both.
    #[test]
    fn what_only_permutes_has_eigenvalues() {
        let shift = |n: usize| {
            let entry = |k: usize| f64::from(u8::from((k / n + 1) % n == k % n));
            (0..n * n).map(entry).collect::<Vec<_>>()
        };
        for n in [3, 4, 5, 8] {
            let found = eigenvalues(n, &shift(n));
            assert_eq!(found.len(), n);
            for z in &found {
                assert!((z.powu(n as u32) - 1.0).norm() < 1e-12, "{n}: {z}");
            }
            let sum = found.iter().sum::<Complex<f64>>();
            assert!(sum.norm() < 1e-12);
        }
        assert!(eigenvalues(3, &[f64::NAN; 9]).is_empty());
    }
}
