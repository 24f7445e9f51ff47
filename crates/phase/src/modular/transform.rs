//! Cosine and sine transforms of length Q modulo eight primes, by one number-theoretic transform.
//!
//! With theta_j = (2j + 1) pi/(4Q) the sum sum_m a_m cos 2m theta_j is, after the permutation
//! v_n = g_2n, v_(Q-1-n) = g_(2n+1) (J. Makhoul, IEEE Trans. ASSP 28 (1980) 27), the transform
//!
//!   v_n = sum_m w^(mn) u_m,   u_m = z^m (a_m - i a_(Q-m))/2,   w = z^4 = e^(2 pi i/Q),
//!
//! of length Q = r s: r transforms of length s and s of length r, each two small dense matrices, at
//! Q (r + s)/2 products in place of Q^2. The other three symmetries are this one, times a diagonal:
//!
//!   2 cos theta sum_k c_k cos (2k+1) theta = c_0 + sum_m (c_m + c_(m-1)) cos 2m theta,
//!   2 sin theta sum_k d_k cos (2k+1) theta = sum_m (d_(m-1) - d_m) sin 2m theta,
//!
//! and sin (2k+1) theta is (-1)^k cos (2k+1) (pi/2 - theta), the points in reverse.

use super::fields::{Kernel, Moduli, PrimeFields, Residues};
use super::symmetry::Symmetry;
use super::words::Words;
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;

/// The tables of eight primes and one number of points.
#[derive(Clone, Debug)]
pub(super) struct Transform {
    field: PrimeFields,
    points: usize,
    rows: usize,
    columns: usize,
    /// w^(s k m), w^(r k m) and w^(k m): the two small matrices and the factors between them.
    row_matrix: Small,
    column_matrix: Small,
    /// With row and column exchanged.
    twiddles: Vec<Residues>,
    /// The place of u_m in the input of [`Self::fourier`], and of y_n in its output.
    place_in: Vec<u32>,
    place_out: Vec<u32>,
    /// The factors of a_m and a_(Q-m) in u_m.
    entry: [Vec<Residues>; 2],
    /// The factors of v and of its mirror image on the way back, with the normalisation.
    exit: [Vec<Residues>; 2],
    /// 2 cos theta_j and its reciprocal; tan theta_j and its reciprocal.
    twice_cosine: Vec<Residues>,
    half_secant: Vec<Residues>,
    tangent: Vec<Residues>,
    cotangent: Vec<Residues>,
}

/// The transform y_k = sum_j v^(jk) x_j of a small length n, v of order n: y_k and y_(n-k) are the sum and the
/// difference of a cosine transform of x_j + x_(n-j) and a sine transform of x_j - x_(n-j).
#[derive(Clone, Debug)]
struct Small {
    length: usize,
    /// (v^(jk) + v^(-jk))/2, j, k <= n/2, and (v^(jk) - v^(-jk))/2, 1 <= j, k < n/2; rows filled up to full words.
    cosines: Vec<Residues>,
    sines: Vec<Residues>,
}

impl Small {
    /// From the powers v^m, m < n, and 1/2.
    fn new(
        field: &PrimeFields,
        length: usize,
        power: impl Fn(usize) -> Residues,
        half: Residues,
    ) -> Self {
        let (even, odd) = (length / 2 + 1, length.div_ceil(2) - 1);
        let entry = |j: usize, k: usize, minus: bool| {
            let m = j * k % length;
            let (plus, other) = (power(m), power((length - m) % length));
            let other = if minus { field.neg(&other) } else { other };
            field.product(&half, &field.sum(&plus, &other))
        };
        let matrix = |range: std::ops::Range<usize>, minus: bool| -> Vec<Residues> {
            let mut list = Vec::with_capacity(range.len() * stride(range.len()));
            for k in range.clone() {
                list.extend(range.clone().map(|j| entry(j, k, minus)));
                list.resize(list.len().next_multiple_of(stride(range.len())), field.zero());
            }
            list
        };
        let (cosines, sines) = (matrix(0..even, false), matrix(1..odd + 1, true));
        Self { length, cosines, sines }
    }

    /// `scratch` has room for 2 n numbers.
    #[inline(always)]
    fn apply<W: Words>(
        &self,
        field: &PrimeFields,
        moduli: &Moduli<W>,
        [x, y, scratch]: [&mut [Residues]; 3],
    ) {
        let n = self.length;
        let (even, odd) = (n / 2 + 1, n.div_ceil(2) - 1);
        let (sums, rest) = scratch.split_at_mut(even);
        let (differences, rest) = rest.split_at_mut(odd);
        sums[0] = x[0];
        let pairs = x[1..].iter().zip(x[1..].iter().rev());
        for ((sum, difference), (a, b)) in
            sums[1..].iter_mut().zip(differences.iter_mut()).zip(pairs)
        {
            *sum = field.sum(a, b);
            *difference = field.difference(a, b);
        }
        if n.is_multiple_of(2) {
            sums[n / 2] = x[n / 2];
        }
        let sines = &mut rest[..odd];
        // Both matrices are symmetric.
        moduli.matrix(&self.cosines, stride(even), sums, &mut y[..even]);
        moduli.matrix(&self.sines, stride(odd), differences, sines);
        for (k, sine) in sines.iter().enumerate() {
            let cosine = y[k + 1];
            y[n - 1 - k] = field.difference(&cosine, sine);
            y[k + 1] = field.sum(&cosine, sine);
        }
    }
}

/// The distance of rows of so many numbers, in full words of four points.
fn stride(length: usize) -> usize {
    length.next_multiple_of(4).max(4)
}

/// Q = r s, not below `least`, for which the work of an expansion of that degree is least: per point some
/// least/4 products of functions stand beside every transform.
pub(super) fn size(least: usize) -> (usize, usize) {
    let split = |points: usize| {
        let rows =
            (1..=points).take_while(|r| r * r <= points).filter(|r| points.is_multiple_of(*r));
        let rows = rows.last().unwrap_or(1);
        (rows, points / rows)
    };
    let cost = |&(r, s): &(usize, usize)| r * s * (least / 4 + r + s);
    let sizes = (least..=least + least / 4 + 1).map(split);
    sizes.min_by_key(cost).unwrap_or((1, least))
}

impl Transform {
    /// The tables from a root of unity of order 8Q; nothing if that is none.
    pub(super) fn new(field: PrimeFields, points: usize, root: Residues) -> Option<Self> {
        let (rows, columns) = size(points);
        // A number of points that `size` did not choose is as good, only slower.
        let (rows, columns) = if rows * columns == points { (rows, columns) } else { (1, points) };
        let order = 8 * points;
        let mut powers = vec![field.one()];
        for k in 1..order {
            powers.push(field.mul(&powers[k - 1], &root));
        }
        let z = |k: usize| powers[k % order];
        let number = |q: (i32, usize)| field.rational(&Rational::from(q));
        let (half, minus_half) = (number((1, 2)), number((-1, 2)));
        // i = z^(2Q).
        let minus_half_i = field.mul(&minus_half, &z(2 * points));
        let over_points = number((1, points));
        let times = |factor: Residues, k: usize| field.mul(&factor, &z(k));
        let mut entry = [half, minus_half_i]
            .map(|factor| (0..points).map(|m| times(factor, 2 * m)).collect::<Vec<Residues>>());
        // a_0 stands alone.
        (entry[0][0], entry[1][0]) = (field.one(), field.zero());
        let mut exit = [order - 2, 2].map(|step| {
            (0..points).map(|k| times(over_points, step * k)).collect::<Vec<Residues>>()
        });
        (exit[0][0], exit[1][0]) = (over_points, field.zero());
        let pair = |k: usize| (z(k), z(order - k));
        let odd = (0..points).map(|j| 2 * j + 1);
        let twice_cosine: Vec<Residues> =
            odd.clone().map(pair).map(|(a, b)| field.add(&a, &b)).collect();
        // 2 sin = (z - 1/z)/i = -i (z - 1/z).
        let minus_i = field.neg(&z(2 * points));
        let twice_sine: Vec<Residues> =
            odd.map(pair).map(|(a, b)| field.mul(&minus_i, &field.sub(&a, &b))).collect();
        let half_secant = field.reciprocals(&twice_cosine)?;
        let half_cosecant = field.reciprocals(&twice_sine)?;
        let product = |a: &[Residues], b: &[Residues]| -> Vec<Residues> {
            a.iter().zip(b).map(|(x, y)| field.mul(x, y)).collect()
        };
        Some(Self {
            field,
            points,
            rows,
            columns,
            row_matrix: Small::new(&field, rows, |m| z(8 * columns * m), half),
            column_matrix: Small::new(&field, columns, |m| z(8 * rows * m), half),
            twiddles: (0..points).map(|i| z(8 * (i / rows) * (i % rows))).collect(),
            place_in: (0..points).map(|m| (m % columns * rows + m / columns) as u32).collect(),
            place_out: (0..points).map(|n| (n % rows * columns + n / rows) as u32).collect(),
            entry,
            exit,
            tangent: product(&twice_sine, &half_secant),
            cotangent: product(&twice_cosine, &half_cosecant),
            twice_cosine,
            half_secant,
        })
    }

    /// y_n = sum_m w^(mn) u_m in place: u_m stands at (m mod s) r + m/s, and then y_n at (n mod r) s + n/r.
    #[inline(always)]
    fn fourier<W: Words>(&self, moduli: &Moduli<W>, list: &mut [Residues]) {
        let (r, s) = (self.rows, self.columns);
        let mut room = vec![self.field.zero(); self.points + r + 2 * s.max(r) + 2];
        let (middle, rest) = room.split_at_mut(self.points);
        let (row, scratch) = rest.split_at_mut(r);
        let parts = list.chunks_mut(r).zip(self.twiddles.chunks(r));
        for (column, (u, twiddles)) in parts.enumerate() {
            self.row_matrix.apply(&self.field, moduli, [u, &mut *row, &mut *scratch]);
            moduli.multiply(row, twiddles);
            let places = middle[column..].iter_mut().step_by(s);
            places.zip(&*row).for_each(|(place, value)| *place = *value);
        }
        for (u, out) in middle.chunks_mut(s).zip(list.chunks_mut(s)) {
            self.column_matrix.apply(&self.field, moduli, [u, out, &mut *scratch]);
        }
    }

    /// sum_m a_m cos 2m theta_j, m < Q, for every j.
    #[inline(always)]
    fn even_cosines<W: Words>(&self, moduli: &Moduli<W>, a: &[Residues]) -> Vec<Residues> {
        let q = self.points;
        let mut mirrored = vec![self.field.zero(); q];
        for (m, value) in a.iter().enumerate().skip(1) {
            mirrored[q - m] = *value;
        }
        let mut sums = vec![self.field.zero(); q];
        let pairs = [(&*mirrored, &*self.entry[1]), (a, &*self.entry[0])];
        moduli.sum_of_products(&pairs, &mut sums);
        let mut u = mirrored;
        for (place, value) in self.place_in.iter().zip(&sums) {
            u[*place as usize] = *value;
        }
        self.fourier(moduli, &mut u);
        let source = |j: usize| if j.is_multiple_of(2) { j / 2 } else { q - 1 - j / 2 };
        for (j, value) in sums.iter_mut().enumerate() {
            *value = u[self.place_out[source(j)] as usize];
        }
        sums
    }

    /// The a_m of the values: a_m = (z^-m V_(Q-m) + z^m V_m)/Q with V the transform of v.
    #[inline(always)]
    fn even_cosine_coefficients<W: Words>(
        &self,
        moduli: &Moduli<W>,
        values: &[Residues],
    ) -> Vec<Residues> {
        let q = self.points;
        let mut v = vec![self.field.zero(); q];
        for (j, &value) in values.iter().enumerate() {
            let n = if j.is_multiple_of(2) { j / 2 } else { q - 1 - j / 2 };
            v[self.place_in[n] as usize] = value;
        }
        self.fourier(moduli, &mut v);
        let at = |n: usize| v[self.place_out[n] as usize];
        let plain: Vec<Residues> = (0..q).map(at).collect();
        let mirrored: Vec<Residues> = (0..q).map(|m| at((q - m) % q)).collect();
        let pairs = [(&*mirrored, &*self.exit[0]), (&*plain, &*self.exit[1])];
        moduli.sum_of_products(&pairs, &mut v);
        v
    }

    /// The values at the points of a function of that symmetry from its coefficients, at most Q.
    pub(super) fn values(&self, symmetry: Symmetry, coefficients: &[Residues]) -> Vec<Residues> {
        self.field.vectorised(Values(self, symmetry, coefficients))
    }

    #[inline(always)]
    fn values_of<W: Words>(
        &self,
        moduli: &Moduli<W>,
        symmetry: Symmetry,
        coefficients: &[Residues],
    ) -> Vec<Residues> {
        let (field, q) = (&self.field, self.points);
        if let (Symmetry { sine: false, odd: false }, [constant]) = (symmetry, coefficients) {
            return vec![*constant; q];
        }
        if symmetry == (Symmetry { sine: false, odd: false }) {
            return self.even_cosines(moduli, coefficients);
        }
        // Coefficients of odd cosines first, then of 2 cos theta times their sum.
        let mut a = coefficients.to_vec();
        a.resize(q, field.zero());
        match (symmetry.sine, symmetry.odd) {
            (true, true) => negate_odd(field, &mut a),
            (true, false) => {
                for k in (0..q - 1).rev() {
                    a[k] = field.sum(&a[k], &a[k + 1]);
                }
            }
            _ => {}
        }
        for m in (1..q).rev() {
            a[m] = field.sum(&a[m], &a[m - 1]);
        }
        let mut values = self.even_cosines(moduli, &a);
        let tangent = symmetry.sine && !symmetry.odd;
        moduli.multiply(&mut values, if tangent { &self.tangent } else { &self.half_secant });
        if symmetry.sine && symmetry.odd {
            values.reverse();
        }
        values
    }

    /// The Q coefficients of a function of that symmetry from its values at the points.
    pub(super) fn coefficients(&self, symmetry: Symmetry, values: &[Residues]) -> Vec<Residues> {
        self.field.vectorised(Coefficients(self, symmetry, values))
    }

    #[inline(always)]
    fn coefficients_of<W: Words>(
        &self,
        moduli: &Moduli<W>,
        symmetry: Symmetry,
        values: &[Residues],
    ) -> Vec<Residues> {
        let (field, q) = (&self.field, self.points);
        if symmetry == (Symmetry { sine: false, odd: false }) {
            return self.even_cosine_coefficients(moduli, values);
        }
        let mut values = values.to_vec();
        if symmetry.sine && symmetry.odd {
            values.reverse();
        }
        let cotangent = symmetry.sine && !symmetry.odd;
        moduli.multiply(&mut values, if cotangent { &self.cotangent } else { &self.twice_cosine });
        let mut a = self.even_cosine_coefficients(moduli, &values);
        for m in 1..q {
            a[m] = field.difference(&a[m], &a[m - 1]);
        }
        match (symmetry.sine, symmetry.odd) {
            (true, true) => negate_odd(field, &mut a),
            (true, false) => {
                for k in 0..q - 1 {
                    a[k] = field.difference(&a[k], &a[k + 1]);
                }
            }
            _ => {}
        }
        a
    }
}

struct Values<'a>(&'a Transform, Symmetry, &'a [Residues]);

impl Kernel for Values<'_> {
    type Output = Vec<Residues>;

    #[inline(always)]
    fn run<W: Words>(self, words: W) -> Vec<Residues> {
        self.0.values_of(&Moduli::new(words, &self.0.field), self.1, self.2)
    }
}

struct Coefficients<'a>(&'a Transform, Symmetry, &'a [Residues]);

impl Kernel for Coefficients<'_> {
    type Output = Vec<Residues>;

    #[inline(always)]
    fn run<W: Words>(self, words: W) -> Vec<Residues> {
        self.0.coefficients_of(&Moduli::new(words, &self.0.field), self.1, self.2)
    }
}

#[inline(always)]
fn negate_odd(field: &PrimeFields, list: &mut [Residues]) {
    for value in list.iter_mut().skip(1).step_by(2) {
        *value = field.difference(&field.zero(), value);
    }
}

#[cfg(test)]
mod tests {
    use super::super::symmetry::SYMMETRIES;
    use super::*;

    /// Every basis function at every point, against its definition, and back; at the largest degree, too.
    #[test]
    fn every_basis_function_is_itself() {
        for points in [1usize, 2, 3, 4, 6, 7, 12, 15, 30, 49] {
            let order = 8 * points as u64;
            let field = PrimeFields::with_roots_of_unity(order).next().expect("primes");
            let root = field.root_of_unity(order).expect("a root");
            let transforms: Vec<Transform> = field
                .on_every_processor()
                .into_iter()
                .map(|field| Transform::new(field, points, root).expect("tables"))
                .collect();
            let z = |k: usize| field.power(&root, (k as u64 % order) as u32);
            let half = field.rational(&Rational::from((1, 2)));
            let half_over_i = field.neg(&field.mul(&half, &z(2 * points)));
            for symmetry in SYMMETRIES {
                for k in 0..points {
                    let value = |j: usize| {
                        let m = symmetry.harmonic(k) * (2 * j + 1) % (8 * points);
                        let (plus, minus) = (z(m), z(8 * points - m));
                        if symmetry.sine {
                            field.mul(&half_over_i, &field.sub(&plus, &minus))
                        } else {
                            field.mul(&half, &field.add(&plus, &minus))
                        }
                    };
                    let mut unit = vec![field.zero(); points];
                    unit[k] = field.one();
                    let values: Vec<Residues> = (0..points).map(value).collect();
                    for transform in &transforms {
                        let of = |unit: &[Residues]| transform.values(symmetry, unit);
                        assert_eq!(of(&unit), values, "{points} {symmetry:?} {k}");
                        assert_eq!(of(&unit[..=k]), values);
                        assert_eq!(transform.coefficients(symmetry, &values), unit);
                    }
                }
            }
        }
    }

    #[test]
    fn sizes_are_large_enough_and_split() {
        for least in 1..2000 {
            let (r, s) = size(least);
            assert!(r * s >= least && r * s <= least + least / 4 + 1 && r <= s);
            assert!(least < 30 || s < 4 * r, "{least}: {r} {s}");
        }
    }
}
