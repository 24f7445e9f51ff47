//! Where the moduli of steady states of complex unknowns can lie, whatever their phases. With w_j = r_j e^{i theta_j}
//!
//!   e^{-i theta_j} G_j = sum_k P_jk(r) e^{i k theta},
//!
//! and at a state, of any complex weights m_j, Re sum_j m_j e^{-i theta_j} G_j = Re c_0 + sum_{k > 0} Re(c_k e^{i k theta})
//! vanishes, c_k = sum_j m_j P_jk + conj sum_j m_j P_j,-k, so that |Re c_0| <= sum_{k > 0} |c_k|. With weights like i r_j nu_j
//! this is the balance of energy: what modes exchange is no part of it, what damping takes and forces give is. As well
//! |P_jk| <= sum_{l != k} |P_jl|. Boxes of the r_j on which one of these fails for all r have no state: half as many
//! dimensions to subdivide as the unknowns have, and terms that turn with the phases are not taken for small ones.
//!
//! At a fold the real polynomial det G_w vanishes, too: its harmonics are those of one more equation.

#[cfg(test)]
mod tests;

use super::flow::times;
use super::krawczyk::{Region, middle};
use super::search::{Limits, Places, halved, modulus};
use super::{ComplexTerm, Flow, Polynomial, System, Value};
use lindstedt_number::interval::Interval;
use nalgebra::{DMatrix, DVector};
use rug::Rational;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A row of the system, the weight (Re m_1, Im m_1, Re m_2, ...) it is multiplied by, and the sign.
type Share = (usize, usize, f64);

/// The P_jk, and how they make the c_k.
pub(super) struct Balance {
    /// Re and Im of every P_jk, as functions of r and of the parameter that is open.
    system: System,
    /// j of every P_jk.
    owners: Vec<usize>,
    /// k of every P_jk.
    turns: Vec<Vec<i64>>,
    /// Re c_0.
    still: Vec<Share>,
    /// Re and Im of every other c_k.
    turning: Vec<[Vec<Share>; 2]>,
}

/// Cells are not cut below this fraction of the whole.
const SMALLEST: f64 = 1.0 / 256.0;
/// The circle is cut into arcs no smaller than 2^-MOST_CUTS of it.
const MOST_CUTS: u32 = 6;
/// Cells looked at.
const MOST_CELLS: usize = 10_000;
/// Of them where only their extent is asked for.
const MOST_OUTER: usize = 2_000;
/// Cells of which the circles are cut.
const MOST_TURNED: usize = 1_000;

/// The P_k of a polynomial in the w_j and their conjugates, as polynomials in the r_j and the parameters.
type Harmonics = BTreeMap<Vec<i64>, [Polynomial; 2]>;

/// Those of terms.
fn harmonics(terms: &[ComplexTerm]) -> Harmonics {
    let mut sums = Harmonics::new();
    for term in terms {
        let pairs = term.amplitudes.chunks_exact(2);
        let k = pairs.clone().map(|p| i64::from(p[0]) - i64::from(p[1])).collect();
        let exponents = pairs.map(|p| p[0] + p[1]).chain(term.parameters.iter().copied());
        let mut monomial = Polynomial::default();
        monomial.add_term(&exponents.collect::<Vec<_>>(), &Rational::from(1));
        for (sum, q) in sums.entry(k).or_default().iter_mut().zip([&term.re, &term.im]) {
            let coefficient = Polynomial::within(q.clone(), term.radius);
            *sum = std::mem::take(sum) + &(&coefficient * &monomial);
        }
    }
    sums
}

/// det G_w = |G_w|^2 - |G_conj w|^2 of one complex unknown.
fn determinant(equation: &[ComplexTerm]) -> Harmonics {
    let mut sums = Harmonics::new();
    for (i, sign) in [1, -1].into_iter().enumerate() {
        let by = |term: &ComplexTerm| {
            let power = term.amplitudes[i];
            let mut amplitudes = term.amplitudes.clone();
            amplitudes[i] = power.checked_sub(1)?;
            let [re, im] = [&term.re, &term.im].map(|q| Rational::from(q * power));
            let radius = (term.radius * f64::from(power)).next_up();
            let radius = if term.radius > 0.0 { radius } else { 0.0 };
            Some(ComplexTerm { amplitudes, re, im, radius, ..term.clone() })
        };
        let slope = harmonics(&equation.iter().filter_map(by).collect::<Vec<_>>());
        let factor = |n: i32| Polynomial::constant(Rational::from(n));
        for (k, own) in &slope {
            let own = own.each_ref().map(|part| part * &factor(sign));
            for (l, [re, im]) in &slope {
                let product = times(&own, &[re.clone(), im * &factor(-1)]);
                let k = k.iter().zip(l).map(|(k, l)| k - l).collect();
                for (sum, part) in sums.entry(k).or_default().iter_mut().zip(&product) {
                    *sum = std::mem::take(sum) + part;
                }
            }
        }
    }
    sums
}

impl Balance {
    /// Nothing of a flow that is not one of complex unknowns, or with parameters that have no value.
    pub(super) fn of(flow: &Flow, values: &[Option<Value>]) -> Option<Self> {
        Self::new(flow, values, None)
    }

    /// That of folds over the open parameter, at which det G_w vanishes as well; nothing of several complex unknowns.
    pub(super) fn of_folds(flow: &Flow, values: &[Option<Value>]) -> Option<Self> {
        let [equation] = &flow.complex[..] else { return None };
        Self::new(flow, values, Some(determinant(equation)))
    }

    fn new(flow: &Flow, values: &[Option<Value>], other: Option<Harmonics>) -> Option<Self> {
        let n = flow.complex.len();
        let mut groups = BTreeMap::new();
        for (j, equation) in flow.complex.iter().enumerate() {
            for (mut k, part) in harmonics(equation) {
                k[j] -= 1;
                groups.insert((j, k), part);
            }
        }
        let variables = n + usize::from(other.is_some());
        groups.extend(other.into_iter().flatten().map(|(k, part)| ((n, k), part)));
        let given: Vec<_> = (0..n).map(|_| None).chain(values.iter().cloned()).collect();
        let rows: Vec<_> = groups.values().flatten().cloned().collect();
        let system = System::new(&rows, &given);
        if n == 0 || system.variables() != variables {
            return None;
        }
        let owners = groups.keys().map(|(j, _)| *j).collect();
        let turns = groups.keys().map(|(_, k)| k.clone()).collect();
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
        Some(Self { system, owners, turns, still, turning: turning.into_values().collect() })
    }

    /// Where states can be that have (r_1, r_2, ..., the open parameter) in a box, and the number of boxes looked at.
    pub(super) fn places(&self, region: Region, limits: &Limits) -> (Places, usize) {
        let (cells, looked_at) = self.open(region, limits);
        let single = self.turns.iter().all(|k| k.len() == 1);
        if !single || cells.len() > MOST_TURNED {
            return (Places::Moduli(cells), looked_at);
        }
        (Places::Boxes(cells.iter().flat_map(|cell| self.turned(cell)).collect()), looked_at)
    }

    /// Boxes outside which no (r_1, r_2, ..., the open parameter) is that of a state, and the number of boxes looked at.
    fn open(&self, region: Region, limits: &Limits) -> (Vec<Region>, usize) {
        let widths: Vec<f64> = region.iter().map(|x| x.width().max(f64::MIN_POSITIVE)).collect();
        let mut stack = vec![region];
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
            let share = |j: &usize| cell[*j].width() / widths[*j];
            let widest = (0..widths.len()).max_by(|a, b| share(a).total_cmp(&share(b)));
            match widest.filter(|j| share(j) > SMALLEST) {
                Some(side) => stack.extend(halved(&cell, side)),
                None => open.push(cell),
            }
        }
        (open, cells)
    }

    /// Boxes of w, of one complex unknown, and of the open parameter that have every state with r and the parameter in a
    /// cell: of the arcs of the circle of e^{i theta} those on which no sum_k P_jk e^{i k theta} is excluded.
    fn turned(&self, cell: &[Interval]) -> Vec<Region> {
        let around = self.around(cell);
        let row = |row: usize| around.sum([(row, 1.0)].into_iter());
        let sums: Vec<[Interval; 2]> =
            (0..self.owners.len()).map(|place| [row(2 * place), row(2 * place + 1)]).collect();
        let mut stack: Vec<_> = Arc::QUADRANTS.into_iter().map(|arc| (arc, 2)).collect();
        let mut boxes = Vec::new();
        while let Some((arc, cuts)) = stack.pop() {
            let turn = arc.hull();
            if self.excludes_on(&sums, turn) {
                continue;
            }
            if cuts < MOST_CUTS {
                stack.extend(arc.halves().map(|half| (half, cuts + 1)));
                continue;
            }
            let state = turn.map(|part| part * cell[0]);
            boxes.push(state.into_iter().chain(cell[1..].iter().copied()).collect());
        }
        boxes
    }

    /// Whether one of the equations has no zero with e^{i theta} in a box.
    fn excludes_on(&self, sums: &[[Interval; 2]], turn: [Interval; 2]) -> bool {
        let times = |[a, b]: [Interval; 2], [c, d]: [Interval; 2]| [a * c - b * d, a * d + b * c];
        let power = |k: i64| {
            let base = if k < 0 { [turn[0], -turn[1]] } else { turn };
            (0..k.unsigned_abs()).fold([Interval::ONE, Interval::ZERO], |p, _| times(p, base))
        };
        let mut totals = vec![[Interval::ZERO; 2]; 1 + self.owners.iter().max().unwrap_or(&0)];
        for ((j, k), sum) in self.owners.iter().zip(&self.turns).zip(sums) {
            let part = times(*sum, power(k[0]));
            totals[*j] = [totals[*j][0] + part[0], totals[*j][1] + part[1]];
        }
        totals.iter().flatten().any(|total| !total.contains(0.0))
    }

    /// Whether no state has its moduli in a cell.
    pub(super) fn excludes(&self, cell: &[Interval]) -> bool {
        let around = self.around(cell);
        self.one_outweighs(&around) || self.rest_outweighs(&around).is_some_and(|it| it)
    }

    fn around(&self, cell: &[Interval]) -> Around {
        let at: Region = middle(cell).into_iter().map(Interval::point).collect();
        let away = cell.iter().zip(&at).map(|(r, m)| *r - *m).collect();
        let (values, slopes) = (self.system.values(&at), self.system.derivatives(cell).1);
        Around { values, slopes, away }
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
        let n = 2 * (1 + self.owners.iter().max()?);
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

/// The scales, powers of 2, at which moduli are looked at where nothing bounds them.
const SCALES: std::ops::Range<i32> = -8..15;
/// Scales without states that follow on the largest one.
const BEYOND: usize = 3;

/// A modulus that those of all states of complex unknowns keep to. Where nothing is known beforehand of the
/// states, those between it and 8 times as large are excluded, and no more is proved. Nothing where none is found.
#[must_use]
pub fn outermost(flow: &Flow, values: &[Option<Value>], known: Option<f64>) -> Option<f64> {
    let balance = Balance::of(flow, values)?;
    let n = flow.complex.len();
    let limits = Limits { boxes: MOST_OUTER, ..Limits::default() };
    let highest = |cells: &[Region]| cells.iter().flatten().map(|x| x.high()).reduce(f64::max);
    if let Some(known) = known {
        let (cells, _) = balance.open(vec![Interval::new(0.0, known); n], &limits);
        return highest(&cells).or(Some(known));
    }
    let shell = |k: i32| {
        let [inner, outer] = [k, k + 1].map(|k| 2f64.powi(k));
        let side = |(i, j): (usize, usize)| match i.cmp(&j) {
            Ordering::Less => Interval::new(0.0, inner),
            Ordering::Equal => Interval::new(inner, outer),
            Ordering::Greater => Interval::new(0.0, outer),
        };
        let parts = (0..n).map(|j| (0..n).map(|i| side((i, j))).collect::<Region>());
        let cells = parts.flat_map(|part| balance.open(part, &limits).0);
        highest(&cells.collect::<Vec<_>>())
    };
    let shells: Vec<Option<f64>> = SCALES.map(shell).collect();
    let ends = shells.windows(1 + BEYOND).filter(|run| run[1..].iter().all(Option::is_none));
    ends.filter_map(|run| run[0]).next_back()
}

/// An arc of the unit circle within a quadrant, by enclosures of its ends.
#[derive(Clone, Copy)]
struct Arc([[Interval; 2]; 2]);

impl Arc {
    const QUADRANTS: [Self; 4] = {
        let (plus, zero, minus) = (Interval::ONE, Interval::ZERO, Interval::MINUS_ONE);
        let ends = [[plus, zero], [zero, plus], [minus, zero], [zero, minus]];
        [
            Self([ends[0], ends[1]]),
            Self([ends[1], ends[2]]),
            Self([ends[2], ends[3]]),
            Self([ends[3], ends[0]]),
        ]
    };

    /// A box that has it: both parts are monotone.
    fn hull(&self) -> [Interval; 2] {
        let [a, b] = self.0;
        [a[0].hull(b[0]), a[1].hull(b[1])]
    }

    /// Cut at a point of the circle near its middle, the larger part of which follows from the smaller.
    fn halves(&self) -> [Self; 2] {
        let [a, b] = self.0;
        let [x, y] = [0, 1].map(|i| a[i].middle() + b[i].middle());
        let size = x.hypot(y);
        let other = |small: f64, sign: f64| {
            let square = Interval::ONE - Interval::point(small).powi(2);
            square.root() * Interval::point(sign.signum())
        };
        let point = |small: f64| Interval::point(small / size);
        let middle = match x.abs() < y.abs() {
            true => [point(x), other(x / size, y)],
            false => [other(y / size, x), point(y)],
        };
        [Self([a, middle]), Self([middle, b])]
    }
}
