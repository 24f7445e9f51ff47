//! The bounds of the contraction test, every one with its rounding errors.
//!
//! Norms. Unknowns: |(delta, h)| = s |delta| + |h_0| + sum_(k>0) k nu^k (|a_k| + |b_k|) for a
//! frequency delta and a function h; right sides: sum nu^k (|a_k| + |b_k|), a Banach algebra (the
//! product of two waves is the mean of two waves). |h| and |dh/dtau| are both at most the norm.
//!
//! A = the inverse in doubles on the modes <= N, -1/(omega^2 k^2) beyond. T(c) = c - A F(c) has
//! |T(c) - T(d)| <= (Z0 + Z1 + Z2 r) |c - d| on the ball of radius r, and |T(cbar) - cbar| <= Y0.

mod tail;

use crate::centre::{Centre, Doubles, Values, power_of_two};
use crate::field::Field;
use crate::linear::{Inverse, Linear, at};
use crate::space::Wave;
use crate::task::Task;
use crate::upward::{Up, gamma, raised};
use nalgebra::{DMatrix, DVector};
use rug::Float;
use rug::float::Round;

/// What the couplings beyond the band are cut to, relative to their sum.
const BAND: f64 = 1e-10;
/// What [`Doubles`] drop, relative to their exponent.
const DROPPED: f64 = 1e-260;

/// Everything about a centre and an inverse that does not depend on the weight.
pub(crate) struct Frame<'a> {
    field: &'a Field,
    /// What is uncertain of the condition's value.
    error: Up,
    centre: &'a Centre,
    inverse: &'a Inverse,
    linear: Linear,
    /// g_x and omega g_y, uncut.
    whole: [Doubles; 2],
    matrix: DMatrix<f64>,
    /// 1 - A D.
    defect: DMatrix<f64>,
    /// F and the condition, times 2^-exponent.
    residual: Doubles,
    condition: f64,
    /// A lower bound of omega.
    frequency_below: f64,
    /// s.
    scale: f64,
}

/// nu and the weights that follow.
pub(crate) struct Weights {
    nu: f64,
    /// Upper bounds and lower bounds of nu^k, k = 0..
    powers: Vec<(f64, f64)>,
}

/// What a bound measures: all unknowns with their weights, or the frequency alone.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Measure {
    /// The norm.
    Norm,
    /// |delta|.
    Frequency,
}

/// The bounds for one measure.
#[derive(Clone, Debug)]
pub(crate) struct Contraction {
    /// |A F(cbar)|.
    pub(crate) y0: Float,
    /// |1 - A D| on the finite rows of the finite columns.
    pub(crate) z0: Up,
    /// Everything else of |1 - A DF(cbar)|.
    pub(crate) z1: Up,
    /// |A| from right sides to unknowns, and |A d^2/dtau^2| on unknowns.
    pub(crate) inverse: Up,
    pub(crate) bend: Up,
}

impl Weights {
    /// The weights for nu >= 1 up to mode `modes`.
    pub(crate) fn new(nu: f64, modes: usize) -> Self {
        let mut powers = vec![(1.0, 1.0)];
        for _ in 0..modes {
            let (above, below) = powers[powers.len() - 1];
            let exact = nu == 1.0;
            let next = |x: f64| if exact { x } else { x.next_up() };
            let last = |x: f64| if exact { x } else { x.next_down() };
            powers.push((next(above * nu), last(below * nu)));
        }
        Self { nu, powers }
    }

    pub(crate) fn nu(&self) -> Up {
        Up(self.nu)
    }

    /// nu^k from above; infinite beyond the list.
    fn above(&self, k: usize) -> f64 {
        self.powers.get(k).map_or(f64::INFINITY, |p| p.0)
    }

    fn below(&self, k: usize) -> f64 {
        self.powers.get(k).map_or(1.0, |p| p.1)
    }
}

impl<'a> Frame<'a> {
    /// Forms 1 - A D, at a cost of 2 n^3 operations.
    pub(crate) fn new(
        task: &'a Task,
        centre: &'a Centre,
        values: &Values,
        linear: &Linear,
        inverse: &'a Inverse,
    ) -> Self {
        let whole = [values.by_x.doubles(Some(0)), values.by_slope.doubles(Some(0))];
        let mut linear = linear.clone();
        linear.cut(BAND);
        let matrix = linear.matrix(inverse.modes);
        let mut defect = -(&inverse.matrix * &matrix);
        for i in 0..defect.nrows() {
            defect[(i, i)] += 1.0;
        }
        let mut residual = values.residual.doubles(None);
        if residual.values.iter().all(|c| c.re == 0.0 && c.im == 0.0) {
            residual.exponent = -(centre.bits as i32);
        }
        let condition = Float::with_val(53, task.condition(centre) >> residual.exponent).to_f64();
        let [_, _, size] = centre.norms(Up::ONE);
        let scale = power_of_two((size.0 / linear.frequency).log2().round() as i32);
        let frequency_below = centre.frequency.to_f64().next_down();
        Self {
            field: &task.field,
            error: task.error,
            centre,
            inverse,
            linear,
            whole,
            matrix,
            defect,
            residual,
            condition,
            frequency_below,
            scale,
        }
    }

    /// The largest mode that any bound meets.
    pub(crate) fn reach(&self) -> usize {
        let lists = self.whole.iter().chain([&self.residual]).map(|d| d.values.len());
        let longest = lists.max().unwrap_or(0).max(self.linear.by_frequency.len());
        longest + self.inverse.modes + 2 * self.band() + 2
    }

    /// s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    fn extra(&self) -> usize {
        usize::from(self.linear.rows.condition.is_some())
    }

    fn band(&self) -> usize {
        self.linear.by_x.len().max(self.linear.by_slope.len()) - 1
    }

    /// An upper and a lower bound of the weight of the unknown i.
    fn weight(&self, i: usize, weights: &Weights) -> (f64, f64) {
        match i.checked_sub(self.extra()) {
            None => (self.scale, self.scale),
            Some(i) => {
                let k = self.inverse.basis[i].k;
                let times = k.max(1) as f64;
                ((times * weights.above(k)).next_up(), (times * weights.below(k)).next_down())
            }
        }
    }

    /// Upper bounds of the weights that a measure gives to the finite unknowns.
    fn numerators(&self, measure: Measure, weights: &Weights) -> Vec<f64> {
        let n = self.inverse.matrix.nrows();
        match measure {
            Measure::Norm => (0..n).map(|i| self.weight(i, weights).0).collect(),
            Measure::Frequency => {
                (0..n).map(|i| if i < self.extra() { 1.0 } else { 0.0 }).collect()
            }
        }
    }

    /// An upper bound of |A e| for the right side e = one wave of mode k > N: nu^k/(omega^2 k).
    fn tail(&self, measure: Measure, k: usize, weights: &Weights) -> f64 {
        if measure == Measure::Frequency {
            return 0.0;
        }
        let below = (self.frequency_below * self.frequency_below).next_down() * k as f64;
        (weights.above(k) / below.next_down()).next_up()
    }

    /// Upper bounds of |A e_c| for the rows c of F: condition, then the basis.
    fn columns(&self, numerators: &[f64]) -> Vec<f64> {
        let n = numerators.len();
        let of = |column: usize| {
            let sum: f64 = self
                .inverse
                .matrix
                .column(column)
                .iter()
                .zip(numerators)
                .map(|(a, w)| a.abs() * w)
                .sum();
            raised(sum, n).0
        };
        (0..n).map(of).collect()
    }

    /// All bounds but Z2 for one measure. The cost is some n (n + band) operations.
    pub(crate) fn contraction(&self, measure: Measure, weights: &Weights) -> Contraction {
        let numerators = self.numerators(measure, weights);
        let alpha = self.columns(&numerators);
        let inverse = self.inverse_norm(measure, &alpha, weights, 0);
        let bend = self.inverse_norm(measure, &alpha, weights, 1);
        let [y, z] = self.uncertain(inverse, &alpha, weights);
        let y0 = self.y0(measure, &numerators, &alpha, weights);
        let y0 = Float::with_val_round(53, &y0 + y.0, Round::Up).0;
        let z1 = self.z1(measure, &alpha, weights) + inverse * self.outside_band(weights) + z;
        let z0 = self.z0(&numerators, &alpha, weights);
        Contraction { y0, z0, z1, inverse, bend }
    }

    /// What uncertain coefficients and an uncertain condition add to Y0 and to Z1.
    fn uncertain(&self, inverse: Up, alpha: &[f64], weights: &Weights) -> [Up; 2] {
        let at = self.outer(weights, &Float::new(53));
        let part = |derivative| self.field.uncertainty(at, weights.nu(), derivative);
        let condition = if self.extra() == 1 { Up(alpha[0]) * self.error } else { Up::ZERO };
        let by_frequency = part([1, 0, 0]).over(self.scale);
        let slope = by_frequency.max(part([0, 1, 0]) + part([0, 0, 1]));
        [inverse * part([0, 0, 0]) + condition, inverse * slope]
    }

    /// Y0 >= |A F(cbar)|: the finite part is a product in doubles with its a-priori error, the tail
    /// sum_(k > N) |F_k| nu^k/(omega^2 k).
    fn y0(&self, measure: Measure, numerators: &[f64], alpha: &[f64], weights: &Weights) -> Float {
        let values = &self.residual.values;
        let at_wave = |w: &Wave| w.of(at(values, w.k as i64));
        let condition = (self.extra() == 1).then_some(self.condition);
        let all = condition.into_iter().chain(self.inverse.basis.iter().map(at_wave));
        let vector = DVector::from_iterator(numerators.len(), all);
        let product = &self.inverse.matrix * &vector;
        let n = numerators.len();
        let sum = product.iter().zip(numerators).map(|(x, w)| x.abs() * w).sum();
        let sizes = alpha.iter().zip(vector.iter()).map(|(a, x)| a * (x.abs() + DROPPED)).sum();
        let finite = raised(sum, n) + (gamma(n + 4) + Doubles::ERROR) * raised(sizes, n);
        let mut tail = 0.0;
        for (k, c) in values.iter().enumerate().skip(self.inverse.modes + 1) {
            let size = 2.0 * (c.re.abs() + c.im.abs() + DROPPED);
            tail += size * self.tail(measure, k, weights);
        }
        let tail = raised(tail, values.len() + 8) * (Up::ONE + Doubles::ERROR);
        let total = Float::with_val(53, (finite + tail).0);
        // Doubling by the exponent is exact.
        total << self.residual.exponent
    }

    /// Z0 >= |1 - A D|: the computed defect and the a-priori error gamma_n |A| |D| of the product.
    fn z0(&self, numerators: &[f64], alpha: &[f64], weights: &Weights) -> Up {
        let n = numerators.len();
        let error = gamma(n + 8) + Linear::coupling_error();
        let column = |j: usize| {
            let sum: f64 =
                self.defect.column(j).iter().zip(numerators).map(|(r, w)| r.abs() * w).sum();
            let sizes: f64 = (0..n).map(|c| alpha[c] * self.size(c, j)).sum();
            // 1 itself is a summand of the diagonal.
            let one = error * Up(numerators[j]);
            let total = raised(sum, n) + error * raised(sizes, 4 * n) + one;
            total.over(self.weight(j, weights).1)
        };
        (0..n).map(column).fold(Up::ZERO, Up::max)
    }

    /// The sum of absolute values that an entry of D is computed from.
    fn size(&self, row: usize, column: usize) -> f64 {
        let extra = self.extra();
        let (Some(i), Some(j)) = (row.checked_sub(extra), column.checked_sub(extra)) else {
            return self.matrix[(row, column)].abs();
        };
        let (w, h) = (self.inverse.basis[i], self.inverse.basis[j]);
        let mut size = self.linear.coupling_size(w.k, h);
        if w == h {
            let rate = self.linear.frequency * w.k as f64;
            size += rate * rate;
        }
        size
    }

    /// max_k |A e_k| k^power/nu^k over all waves: power 0 for |A|, power 1 for |A d^2/dtau^2| (k^2
    /// against the weight k nu^k).
    fn inverse_norm(&self, measure: Measure, alpha: &[f64], weights: &Weights, power: i32) -> Up {
        let mut largest = match measure {
            Measure::Frequency => Up::ZERO,
            Measure::Norm => {
                let square = (self.frequency_below * self.frequency_below).next_down();
                let k = if power == 0 { (self.inverse.modes + 1) as f64 } else { 1.0 };
                Up::ONE.over(square * k * LESS)
            }
        };
        for (w, a) in self.inverse.basis.iter().zip(alpha.iter().skip(self.extra())) {
            let factor = (w.k as f64).powi(power);
            largest = largest.max((Up(*a) * Up(factor)).over(weights.below(w.k)));
        }
        largest
    }

    /// Z2(r) >= |A (DF(c) - DF(d))|/|c - d| for c, d in the ball of radius r: the second
    /// derivatives of the majorant polynomial, and 2 omega d^2/dtau^2, 2 d^2x/dtau^2 of the inertia.
    pub(crate) fn z2(&self, bounds: &Contraction, weights: &Weights, r: &Float) -> Up {
        let (scale, free) = (self.scale, self.extra() == 1);
        let at = self.outer(weights, r);
        let (frequency, r) = (at[0], Up::of_float(r));
        let [.., size] = self.centre.norms(weights.nu());
        let g = |p, q, s| self.field.majorant(at, weights.nu(), [p, q, s]);
        let twice = Up(2.0);
        let both = bounds.inverse * (g(0, 2, 0) + twice * g(0, 1, 1) + g(0, 0, 2));
        if !free {
            return both;
        }
        let mixed = bounds.inverse * (g(1, 1, 0) + g(1, 0, 1)) + twice * frequency * bounds.bend;
        let square = bounds.inverse * g(2, 0, 0) + twice * bounds.bend * (size + r);
        both.max(mixed.over(scale)).max(square.over(scale).over(scale))
    }

    /// Upper bounds of (omega, |x|, |dx/dtau|) on the ball of radius r.
    fn outer(&self, weights: &Weights, r: &Float) -> [Up; 3] {
        let r = Up::of_float(r);
        let [x, slope, _] = self.centre.norms(weights.nu());
        let frequency = Up(self.centre.frequency.to_f64().next_up());
        let free = self.extra() == 1;
        let frequency = if free { frequency + r.over(self.scale) } else { frequency };
        [frequency, x + r, slope + r]
    }

    /// A Lipschitz constant of a polynomial field p(omega, x, dx/dtau) on the ball of radius r.
    pub(crate) fn slope(&self, field: &Field, weights: &Weights, r: &Float) -> Up {
        let at = self.outer(weights, r);
        let p = |derivative| field.majorant(at, weights.nu(), derivative);
        let by_frequency = p([1, 0, 0]).over(self.scale);
        let by_orbit = p([0, 1, 0]) + p([0, 0, 1]);
        if self.extra() == 1 { by_frequency.max(by_orbit) } else { by_orbit }
    }

    /// What is uncertain of a polynomial field at the centre.
    pub(crate) fn unknown(&self, field: &Field, weights: &Weights) -> Up {
        field.uncertainty(self.outer(weights, &Float::new(53)), weights.nu(), [0, 0, 0])
    }

    /// N.
    pub(crate) fn modes(&self) -> usize {
        self.inverse.modes
    }
}

/// A factor below 1 that covers the roundings of a denominator.
const LESS: f64 = 1.0 - 4.0 * f64::EPSILON;
