//! Where the moduli of steady states of complex unknowns can lie, whatever their phases. With w_j = r_j e^{i theta_j}
//!
//!   e^{-i theta_j} G_j = sum_k P_jk(r) e^{i k theta},
//!
//! and at a state, of any complex weights m_j, Re sum_j m_j e^{-i theta_j} G_j = Re c_0 + sum_{k > 0} Re(c_k e^{i k theta})
//! vanishes, c_k = sum_j m_j P_jk + conj sum_j m_j P_j,-k, so that |Re c_0| <= sum_{k > 0} |c_k|. With weights like i r_j nu_j
//! this is the balance of energy: what modes exchange is no part of it, what damping takes and forces give is. As well
//! |P_jk| <= sum_{l != k} |P_jl|. Boxes of the r_j on which one of these fails for all r have no state: half as many
//! dimensions to subdivide as the unknowns have, and terms that turn with the phases are not taken for small ones.

use super::krawczyk::{Region, middle};
use super::search::{Limits, halved, modulus};
use super::{Flow, Polynomial, System, Value};
use lindstedt_number::interval::Interval;
use nalgebra::{DMatrix, DVector};
use rug::Rational;
use std::collections::BTreeMap;

/// A row of the system, the weight (Re m_1, Im m_1, Re m_2, ...) it is multiplied by, and the sign.
type Share = (usize, usize, f64);

/// The P_jk, and how they make the c_k.
pub(super) struct Balance {
    /// Re and Im of every P_jk, as functions of r.
    system: System,
    /// j of every P_jk.
    owners: Vec<usize>,
    /// Re c_0.
    still: Vec<Share>,
    /// Re and Im of every other c_k.
    turning: Vec<[Vec<Share>; 2]>,
}

/// Cells are not cut below this fraction of the largest modulus.
const SMALLEST: f64 = 1.0 / 256.0;
/// Cells looked at.
const MOST_CELLS: usize = 10_000;

impl Balance {
    /// Nothing of a flow that is not one of complex unknowns, or with parameters that have no value.
    pub(super) fn of(flow: &Flow, values: &[Option<Value>]) -> Option<Self> {
        let n = flow.complex.len();
        let mut groups: BTreeMap<(usize, Vec<i64>), [Polynomial; 2]> = BTreeMap::new();
        for (j, equation) in flow.complex.iter().enumerate() {
            for term in equation {
                let pairs = term.amplitudes.chunks_exact(2);
                let mut k: Vec<i64> =
                    pairs.clone().map(|p| i64::from(p[0]) - i64::from(p[1])).collect();
                *k.get_mut(j)? -= 1;
                let exponents = pairs.map(|p| p[0] + p[1]).chain(term.parameters.iter().copied());
                let mut monomial = Polynomial::default();
                monomial.add_term(&exponents.collect::<Vec<_>>(), &Rational::from(1));
                let sum = groups.entry((j, k)).or_default();
                for (sum, q) in sum.iter_mut().zip([&term.re, &term.im]) {
                    let coefficient = Polynomial::within(q.clone(), term.radius);
                    *sum = std::mem::take(sum) + &(&coefficient * &monomial);
                }
            }
        }
        let given: Vec<_> = (0..n).map(|_| None).chain(values.iter().cloned()).collect();
        let rows: Vec<_> = groups.values().flatten().cloned().collect();
        let system = System::new(&rows, &given);
        if n == 0 || system.variables() != n {
            return None;
        }
        let owners = groups.keys().map(|(j, _)| *j).collect();
        let (mut still, mut turning) = (Vec::new(), BTreeMap::<_, [Vec<Share>; 2]>::new());
        for (place, (j, mut k)) in groups.into_keys().enumerate() {
            let [re, im, a, b] = [2 * place, 2 * place + 1, 2 * j, 2 * j + 1];
            let real = [(re, a, 1.0), (im, b, -1.0)];
            let Some(first) = k.iter().find(|k| **k != 0) else {
                still.extend(real);
                continue;
            };
            let sign = if *first > 0 { 1.0 } else { -1.0 };
            if sign < 0.0 {
                k.iter_mut().for_each(|k| *k = -*k);
            }
            let shares = turning.entry(k).or_default();
            shares[0].extend(real);
            shares[1].extend([(im, a, sign), (re, b, sign)]);
        }
        Some(Self { system, owners, still, turning: turning.into_values().collect() })
    }

    /// Boxes of (r_1, r_2, ...) outside which no r up to `most` is that of a state, and the number of boxes looked at.
    pub(super) fn open(&self, most: f64, limits: &Limits) -> (Vec<Region>, usize) {
        let n = self.system.variables();
        let mut stack = vec![vec![Interval::new(0.0, most); n]];
        let (mut open, mut cells) = (Vec::new(), 0);
        while let Some(cell) = stack.pop() {
            if cells >= MOST_CELLS.min(limits.boxes) || limits.stop.asked() {
                open.push(cell);
                continue;
            }
            cells += 1;
            if self.excludes(&cell) {
                continue;
            }
            let width = |j: &usize| cell[*j].width();
            let widest = (0..n).max_by(|a, b| width(a).total_cmp(&width(b)));
            match widest.filter(|j| width(j) > SMALLEST * most) {
                Some(side) => stack.extend(halved(&cell, side)),
                None => open.push(cell),
            }
        }
        (open, cells)
    }

    /// Whether no state has its moduli in a cell.
    pub(super) fn excludes(&self, cell: &[Interval]) -> bool {
        let at: Region = middle(cell).into_iter().map(Interval::point).collect();
        let away: Region = cell.iter().zip(&at).map(|(r, m)| *r - *m).collect();
        let around = Around {
            values: self.system.values(&at),
            slopes: self.system.derivatives(cell).1,
            away,
        };
        self.one_outweighs(&around) || self.rest_outweighs(&around).is_some_and(|it| it)
    }

    /// Whether a P_jk is larger than all other P_jl.
    fn one_outweighs(&self, around: &Around) -> bool {
        let size = |place: usize| {
            modulus(&[2 * place, 2 * place + 1].map(|row| around.sum([(row, 1.0)].into_iter())))
        };
        let mut sizes: BTreeMap<usize, Vec<Interval>> = BTreeMap::new();
        for (place, j) in self.owners.iter().enumerate() {
            sizes.entry(*j).or_default().push(size(place));
        }
        sizes.values().any(|sizes| {
            (0..sizes.len()).any(|k| {
                let others = sizes.iter().enumerate().filter(|(l, _)| *l != k);
                let sum = others
                    .fold(Interval::ZERO, |sum, (_, size)| sum + Interval::point(size.high()));
                sizes[k].low() > sum.high()
            })
        })
    }

    /// Whether |Re c_0| is larger than all |c_k| for the weights that make it so by least squares in the middle.
    fn rest_outweighs(&self, around: &Around) -> Option<bool> {
        let n = 2 * self.system.variables();
        let of_weights = |shares: &[Share]| {
            let mut row = DVector::zeros(n);
            shares.iter().for_each(|(i, m, sign)| row[*m] += sign * around.values[*i].middle());
            row
        };
        let mut squares = DMatrix::<f64>::zeros(n, n);
        for row in self.turning.iter().flatten().map(|shares| of_weights(shares)) {
            squares += &row * row.transpose();
        }
        // Of weights that differ in nothing some.
        let little = 1e-9 * squares.trace() + f64::MIN_POSITIVE;
        squares += DMatrix::identity(n, n) * little;
        let weights = squares.cholesky()?.solve(&of_weights(&self.still));
        let weights = &weights / weights.amax();
        let sum = |shares: &[Share]| {
            around.sum(shares.iter().map(|(row, m, sign)| (*row, sign * weights[*m])))
        };
        let size =
            |pair: &[Vec<Share>; 2]| modulus(&pair.each_ref().map(|shares| sum(shares))).high();
        let rest =
            self.turning.iter().fold(Interval::ZERO, |rest, c| rest + Interval::point(size(c)));
        Some(sum(&self.still).below() > rest.high())
    }
}

/// The rows of a system on a cell: values in a point, slopes on the cell, and what lies between.
struct Around {
    values: Vec<Interval>,
    slopes: Vec<Interval>,
    away: Region,
}

impl Around {
    /// An enclosure on the cell of a sum of rows times doubles, in mean-value form.
    fn sum(&self, parts: impl Iterator<Item = (usize, f64)>) -> Interval {
        let n = self.away.len();
        let mut sums = vec![Interval::ZERO; n + 1];
        for (row, factor) in parts {
            let factor = Interval::point(factor);
            let slopes = &self.slopes[row * n..(row + 1) * n];
            for (sum, part) in sums.iter_mut().zip([&self.values[row]].into_iter().chain(slopes)) {
                *sum = *sum + factor * *part;
            }
        }
        self.away.iter().zip(&sums[1..]).fold(sums[0], |sum, (away, slope)| sum + *slope * *away)
    }
}
