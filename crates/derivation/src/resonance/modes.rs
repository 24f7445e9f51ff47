//! The modes of M x'' + K x: rational frequencies and shapes, exactly.

use super::ResonanceError;
use lindstedt_equation::classify::rational_root;
use rug::{Integer, Rational};

/// A square matrix of rational numbers, by rows.
pub(super) type Matrix = Vec<Vec<Rational>>;

/// x = P q with q_j'' + nu_j^2 q_j, the squares of the frequencies rational.
pub(super) struct Spectrum {
    /// nu_j^2.
    pub squares: Vec<Rational>,
    /// P, the shapes as columns; nothing where x is q.
    pub shapes: Option<Matrix>,
    /// P^-1 M^-1: what the other terms of the equations are multiplied by.
    pub inverse: Matrix,
}

impl Spectrum {
    /// nu_j > 0; where it is irrational a rational number within 2^-200.
    pub(super) fn frequencies_nearby(&self) -> Result<Vec<Rational>, ResonanceError> {
        if let Some(square) = self.squares.iter().find(|square| **square <= 0) {
            return Err(ResonanceError::NoOscillation { square: square.to_string() });
        }
        let below = |q: &Rational| {
            let scaled: Integer = Rational::from(q << 400).trunc().into_numer_denom().0;
            Rational::from(scaled.sqrt()) >> 200
        };
        let root = |q: &Rational| rational_root(q).unwrap_or_else(|| below(q));
        Ok(self.squares.iter().map(root).collect())
    }

    /// With mode k before the others.
    pub(super) fn with_first(self, k: usize) -> Self {
        let n = self.squares.len();
        let mut shapes: Matrix = self.shapes.unwrap_or_else(|| identity(n));
        let (mut squares, mut inverse) = (self.squares, self.inverse);
        squares[..=k].rotate_right(1);
        inverse[..=k].rotate_right(1);
        shapes.iter_mut().for_each(|row| row[..=k].rotate_right(1));
        Self { squares, shapes: Some(shapes), inverse }
    }

    /// With other vectors of the same spaces of equal frequencies, the rows of a matrix, as modes.
    pub(super) fn with_axes(&self, axes: &Matrix) -> Option<Self> {
        let own = self.shapes.clone().unwrap_or_else(|| identity(axes.len()));
        let mut columns = product(axes, &transposed(&own));
        columns.iter_mut().for_each(|column| from_first(column));
        let shapes = transposed(&columns);
        // P^-1 M^-1 with another P.
        let change = product(&inverted(&shapes)?, &own);
        let inverse = product(&change, &self.inverse);
        Some(Self { squares: self.squares.clone(), shapes: Some(shapes), inverse })
    }
}

fn identity(n: usize) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| Rational::from(u32::from(i == j))).collect()).collect()
}

fn transposed(matrix: &Matrix) -> Matrix {
    (0..matrix.len()).map(|j| matrix.iter().map(|row| row[j].clone()).collect()).collect()
}

/// Shapes are read from the first unknown.
fn from_first(vector: &mut [Rational]) {
    let first = vector.iter().find(|x| !x.is_zero()).cloned();
    first.iter().for_each(|first| vector.iter_mut().for_each(|x| *x /= first));
}

/// Vectors, as rows, that a symmetric regular form is diagonal in: e_1, e_2, ..., each freed of its part along those before
/// (Gram and Schmidt), of which one that is orthogonal to itself is joined by one that it is not orthogonal to. So each stays within
/// the e_k that the form ties together.
pub(super) fn orthogonal(form: &Matrix) -> Matrix {
    let n = form.len();
    let mut vectors = identity(n);
    let pairing = |a: &[Rational], b: &[Rational]| -> Rational {
        let parts = a.iter().zip(form).map(|(x, row)| {
            let along: Rational = row.iter().zip(b).map(|(f, y)| Rational::from(f * y)).sum();
            along * x
        });
        parts.sum()
    };
    for k in 0..n {
        let own = vectors[k].clone();
        if pairing(&own, &own).is_zero()
            && let Some(other) = vectors[k + 1..].iter().find(|v| !pairing(&own, v).is_zero())
        {
            // 2 (v, w) + (w, w) and -2 (v, w) + (w, w) are not both zero.
            let joined = |sign: i32| -> Vec<Rational> {
                own.iter().zip(other).map(|(x, y)| Rational::from(y * sign) + x).collect()
            };
            vectors[k] =
                [1, -1].map(joined).into_iter().find(|v| !pairing(v, v).is_zero()).unwrap_or(own);
        }
        let own = vectors[k].clone();
        let square = pairing(&own, &own);
        if square.is_zero() {
            continue;
        }
        for vector in &mut vectors[k + 1..] {
            let part = pairing(&own, vector) / &square;
            vector.iter_mut().zip(&own).for_each(|(x, y)| *x -= Rational::from(&part * y));
        }
    }
    vectors
}

/// The modes of M x'' + K x. Where both are diagonal the unknowns stay what they are.
///
/// The characteristic polynomial of M^-1 K is made integral; its roots are real where there are modes, so
/// that Newton's method from above, in integers, finds the largest one or shows that it is none. Cost: O(n^4).
pub(super) fn spectrum(mass: &Matrix, stiffness: &Matrix) -> Result<Spectrum, ResonanceError> {
    let n = mass.len();
    let inverse = inverted(mass).ok_or(ResonanceError::NotDiagonalisable)?;
    let matrix = product(&inverse, stiffness);
    let diagonal = |m: &Matrix| (0..n).all(|i| (0..n).all(|j| i == j || m[i][j].is_zero()));
    if diagonal(&matrix) && diagonal(mass) {
        let squares: Vec<_> = (0..n).map(|j| matrix[j][j].clone()).collect();
        return Ok(Spectrum { squares, shapes: None, inverse });
    }
    let squares = eigenvalues(&matrix)?;
    let mut columns: Vec<Vec<Rational>> = Vec::new();
    let mut distinct = squares.clone();
    distinct.dedup();
    for square in &distinct {
        columns.extend(eigenvectors(&matrix, square));
    }
    if columns.len() != n {
        return Err(ResonanceError::NotDiagonalisable);
    }
    let shapes: Matrix =
        (0..n).map(|i| columns.iter().map(|column| column[i].clone()).collect()).collect();
    let back = inverted(&shapes).ok_or(ResonanceError::NotDiagonalisable)?;
    let inverse = product(&back, &inverse);
    Ok(Spectrum { squares, inverse, shapes: Some(shapes) })
}

pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |row: &Vec<Rational>, j: usize| {
        row.iter().zip(b).map(|(x, other)| Rational::from(x * &other[j])).sum()
    };
    a.iter().map(|row| (0..b.len()).map(|j| entry(row, j)).collect()).collect()
}

/// The reduced row echelon form, and the columns of its pivots.
fn reduced(mut rows: Matrix, columns: usize) -> (Matrix, Vec<usize>) {
    let mut pivots = Vec::new();
    for column in 0..columns {
        let next = pivots.len();
        let Some(found) = (next..rows.len()).find(|i| !rows[*i][column].is_zero()) else {
            continue;
        };
        rows.swap(next, found);
        let scale = Rational::from(rows[next][column].recip_ref());
        rows[next].iter_mut().for_each(|x| *x *= &scale);
        let pivot = rows[next].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != next) {
            let factor = row[column].clone();
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= Rational::from(&factor * p));
        }
        pivots.push(column);
    }
    (rows, pivots)
}

pub(super) fn inverted(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let unit = |i: usize| (0..n).map(move |j| Rational::from(u32::from(i == j)));
    let rows =
        matrix.iter().enumerate().map(|(i, row)| row.iter().cloned().chain(unit(i)).collect());
    let (rows, pivots) = reduced(rows.collect(), n);
    (pivots.len() == n).then(|| rows.into_iter().map(|row| row[n..].to_vec()).collect())
}

/// A basis of the vectors v with matrix v = lambda v.
fn eigenvectors(matrix: &Matrix, lambda: &Rational) -> Vec<Vec<Rational>> {
    let mut shifted = matrix.clone();
    (0..matrix.len()).for_each(|i| shifted[i][i] -= lambda);
    kernel(shifted, matrix.len())
}

/// A basis of the kernel of a matrix with n columns, each vector with 1 in its first place that is not zero.
pub(super) fn kernel(matrix: Matrix, n: usize) -> Vec<Vec<Rational>> {
    let (rows, pivots) = reduced(matrix, n);
    let vector = |free: usize| {
        let mut vector = vec![Rational::new(); n];
        vector[free] = Rational::from(1);
        for (row, pivot) in rows.iter().zip(&pivots) {
            vector[*pivot] = Rational::from(-&row[free]);
        }
        from_first(&mut vector);
        vector
    };
    (0..n).filter(|j| !pivots.contains(j)).map(vector).collect()
}

/// The eigenvalues with their multiplicities, increasing, where all of them are rational.
fn eigenvalues(matrix: &Matrix) -> Result<Vec<Rational>, ResonanceError> {
    let n = matrix.len();
    let common = matrix.iter().flatten().fold(Integer::from(1), |d, q| d.lcm(q.denom()));
    // The characteristic polynomial of common * matrix (Faddeev and Leverrier), highest power first.
    let scaled: Matrix = matrix
        .iter()
        .map(|row| row.iter().map(|q| Rational::from(q * &common)).collect())
        .collect();
    let mut polynomial = vec![Integer::from(1)];
    let mut current = scaled.clone();
    for k in 1..=n {
        let trace: Rational = (0..n).map(|i| current[i][i].clone()).sum();
        let c = -trace / Integer::from(k);
        (0..n).for_each(|i| current[i][i] += &c);
        polynomial.push(c.into_numer_denom().0);
        current = product(&scaled, &current);
    }
    let mut found = Vec::new();
    while polynomial.len() > 1 {
        let root = largest_root(&polynomial).ok_or(ResonanceError::NoRationalForm)?;
        let mut carried = Integer::new();
        for c in &mut polynomial {
            *c += Integer::from(&carried * &root);
            carried.clone_from(c);
        }
        polynomial.pop();
        found.push(Rational::from((root, common.clone())));
    }
    found.sort();
    Ok(found)
}

/// The largest root of a monic polynomial with real roots, if it is an integer: from above, Newton's method
/// decreases towards it.
fn largest_root(polynomial: &[Integer]) -> Option<Integer> {
    let bound = polynomial.iter().map(|c| c.clone().abs()).max()?;
    let mut x = bound + 1u32;
    loop {
        let (mut value, mut slope) = (Integer::new(), Integer::new());
        for c in polynomial {
            slope = slope * &x + &value;
            value = value * &x + c;
        }
        if value.is_zero() {
            return Some(x);
        }
        // A polynomial with real roots is positive and grows above all of them.
        if value < 0 || slope <= 0 {
            return None;
        }
        // Beside a double root the step is half of the way; a root that is passed was no integer.
        x -= (value / slope).max(Integer::from(1));
    }
}
