//! The bounds of the contraction test, every one with its rounding errors.
//!
//! Norms. Unknowns: |(delta, h)| = s |delta| + sum over the functions h of
//! |h_0| + sum_(k>0) k nu^k (|a_k| + |b_k|); right sides: sum nu^k (|a_k| + |b_k|), a Banach algebra (the
//! product of two waves is the mean of two waves). |h| and |dh/dtau| are both at most the norm.
//!
//! A = the inverse in doubles on the modes <= N, -1/(omega^2 k^2) beyond. T(c) = c - A F(c) has
//! |T(c) - T(d)| <= (Z0 + Z1 + Z2 r) |c - d| on the ball of radius r, and |T(cbar) - cbar| <= Y0.

mod moving;
mod outer;
mod tail;
#[cfg(test)]
mod tests;

use crate::centre::{Centre, Values, Variables};
use crate::drift::Drift;
use crate::exact::{Doubles, ERROR, power_of_two};
use crate::field::Field;
use crate::function::Tied;
use crate::laurent::Laurent;
use crate::linear::{Inverse, Linear, at};
use crate::newton::Right;
use crate::polynomial::Polynomial;
use crate::space::Wave;
use crate::task::Task;
use crate::upward::{Up, gamma, raised};
use nalgebra::{DMatrix, DVector};
use rug::Float;
use rug::float::Round;

/// What the couplings beyond the band are cut to, relative to their sum.
const BAND: f64 = 1e-14;
/// What doubles drop, relative to their exponent.
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
    whole: [Vec<Doubles>; 2],
    functions: &'a [Laurent],
    ties: Vec<Tied>,
    matrix: DMatrix<f64>,
    /// 1 - A D.
    defect: DMatrix<f64>,
    /// F and the condition.
    residual: Right,
    /// Where the centre moves with a parameter.
    pub(crate) drift: Option<&'a Drift>,
    /// A lower bound of omega.
    frequency_below: f64,
    /// s.
    scale: f64,
}

/// nu and what follows.
pub(crate) struct Weights {
    nu: f64,
    /// Upper bounds and lower bounds of nu^k, k = 0..
    powers: Vec<(f64, f64)>,
    /// Upper bounds of the variables at the centre, and their errors in units of 2^-bits.
    at: Vec<Up>,
    errors: Vec<Up>,
    /// The errors with uncertain coefficients in their middle.
    in_middle: Vec<Up>,
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
    /// What of Z1 comes from a centre that moves.
    pub(crate) change: Up,
    /// |A| from right sides to unknowns, and |A d^2/dtau^2| on unknowns.
    pub(crate) inverse: Up,
    pub(crate) bend: Up,
}

impl Weights {
    /// The weights for nu >= 1 up to mode `modes`.
    fn new(nu: f64, modes: usize) -> Self {
        let mut powers = vec![(1.0, 1.0)];
        for _ in 0..modes {
            let (above, below) = powers[powers.len() - 1];
            let exact = nu == 1.0;
            let next = |x: f64| if exact { x } else { x.next_up() };
            let last = |x: f64| if exact { x } else { x.next_down() };
            powers.push((next(above * nu), last(below * nu)));
        }
        Self { nu, powers, at: Vec::new(), errors: Vec::new(), in_middle: Vec::new() }
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
        values: &'a Values,
        linear: &Linear,
        inverse: &'a Inverse,
    ) -> Self {
        let whole = [linear.by_x.clone(), linear.by_slope.clone()];
        let mut linear = linear.clone();
        linear.cut(BAND);
        let matrix = linear.matrix(inverse.modes);
        let mut defect = -(&inverse.matrix * &matrix);
        for i in 0..defect.nrows() {
            defect[(i, i)] += 1.0;
        }
        let residual = Right::new(&values.residual, task.condition(centre), centre.bits);
        let (.., size) = centre.norms(Up::ONE);
        let scale = power_of_two((size.0 / linear.frequency).log2().round() as i32);
        let frequency_below = centre.frequency.to_f64().next_down();
        Self {
            field: &task.field,
            error: Up::of(&task.error),
            centre,
            inverse,
            linear,
            whole,
            functions: &values.functions,
            ties: ties(task, centre, &values.functions),
            matrix,
            defect,
            residual,
            drift: None,
            frequency_below,
            scale,
        }
    }

    /// The largest mode that any bound meets.
    pub(crate) fn reach(&self) -> usize {
        let moves = self.drift.into_iter().flat_map(|drift| &drift.slope.rows);
        let lists = self.whole.iter().flatten().chain(&self.residual.rows).chain(moves);
        let longest = lists.chain(&self.linear.by_frequency).map(Vec::len).max().unwrap_or(0);
        longest + self.inverse.modes + 2 * self.band() + 2
    }

    /// s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Whether the frequency is an unknown.
    pub(crate) fn is_free(&self) -> bool {
        self.extra() == 1
    }

    fn extra(&self) -> usize {
        self.linear.extra()
    }

    fn band(&self) -> usize {
        self.linear.band()
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

    /// All bounds but Z2 for one measure; of an orbit that moves for all its places. The cost is some
    /// n (n + band) operations.
    pub(crate) fn contraction(&self, measure: Measure, weights: &Weights) -> Contraction {
        let numerators = self.numerators(measure, weights);
        let alpha = self.columns(&numerators);
        let inverse = self.inverse_norm(measure, &alpha, weights, 0);
        let bend = self.inverse_norm(measure, &alpha, weights, 1);
        let y0 = self.y0(&self.residual, measure, &numerators, &alpha, weights);
        let z1 = self.z1(measure, &alpha, weights) + inverse * self.outside_band(weights);
        let z1 = z1 + inverse * self.uncertain_slope(weights);
        let z0 = self.z0(&numerators, &alpha, weights);
        let still = Contraction { y0, z0, z1, change: Up::ZERO, inverse, bend };
        if let Some(drift) = self.drift {
            let moves = self.y0(&drift.slope, measure, &numerators, &alpha, weights);
            return self.moving(still, drift, &moves, weights);
        }
        let y = self.uncertain_value(inverse, &alpha, weights);
        let y0 = Float::with_val_round(53, &still.y0 + &y, Round::Up).0;
        Contraction { y0, ..still }
    }

    /// What uncertain coefficients, an uncertain condition and the errors of the functions add to Y0.
    fn uncertain_value(&self, inverse: Up, alpha: &[f64], weights: &Weights) -> Float {
        let at = &self.outer(weights, &Float::new(53)).at;
        let condition = if self.extra() == 1 { Up(alpha[0]) * self.error } else { Up::ZERO };
        let part = |p: &Polynomial| p.uncertainty(at, weights.nu());
        let residual: Up = self.field.forces.iter().map(part).sum();
        let [of_functions, ..] = self.of_functions(weights, &weights.errors);
        let of_functions = Float::with_val(53, (inverse * of_functions).0) >> self.centre.bits;
        let residual = Float::with_val(53, (inverse * residual + condition).0);
        Float::with_val_round(53, &residual + &of_functions, Round::Up).0
    }

    /// What they make uncertain of DF, in the norm of right sides.
    fn uncertain_slope(&self, weights: &Weights) -> Up {
        let (nu, n) = (weights.nu(), self.field.unknowns());
        let outer = self.outer(weights, &Float::new(53));
        let part = |p: &Polynomial| p.uncertainty(&outer.at, nu);
        let [_, functions, flow_of_functions] = self.of_functions(weights, &weights.errors);
        let by_frequency = self.field.flow.iter().map(part).sum::<Up>().over(self.frequency_below);
        let column = |k: usize| {
            let row = |row: &Vec<Polynomial>| part(&row[k]) + outer.frequency * part(&row[n + k]);
            self.field.first.iter().map(row).sum()
        };
        let column = (0..n).map(column).fold(Up::ZERO, Up::max) + functions;
        let frequency = (by_frequency + flow_of_functions).over(self.scale);
        if self.extra() == 1 { column.max(frequency) } else { column }
    }

    /// |A F| of a right side: the finite part is a product in doubles with its a-priori error, the tail
    /// sum_(k > N) |F_k| nu^k/(omega^2 k).
    fn y0(
        &self,
        right: &Right,
        measure: Measure,
        numerators: &[f64],
        alpha: &[f64],
        weights: &Weights,
    ) -> Float {
        let at_wave = |w: &Wave| w.of(at(&right.rows[w.unknown], w.k as i64));
        let condition = (self.extra() == 1).then_some(right.condition);
        let all = condition.into_iter().chain(self.inverse.basis.iter().map(at_wave));
        let vector = DVector::from_iterator(numerators.len(), all);
        let product = &self.inverse.matrix * &vector;
        let n = numerators.len();
        let sum = product.iter().zip(numerators).map(|(x, w)| x.abs() * w).sum();
        let sizes = alpha.iter().zip(vector.iter()).map(|(a, x)| a * (x.abs() + DROPPED)).sum();
        let finite = raised(sum, n) + (gamma(n + 4) + ERROR) * raised(sizes, n);
        let tail = self.tail_of(&right.rows, measure, weights);
        let total = Float::with_val(53, (finite + tail).0);
        // Doubling by the exponent is exact.
        total << right.exponent
    }

    /// The tail rows of A on functions: sum_(k > N) |f_k| nu^k/(omega^2 k).
    fn tail_of(&self, list: &[Doubles], measure: Measure, weights: &Weights) -> Up {
        let (mut sum, mut terms) = (0.0, 8);
        for f in list {
            for (k, c) in f.iter().enumerate().skip(self.inverse.modes + 1) {
                let size = 2.0 * (c.re.abs() + c.im.abs() + DROPPED);
                sum += size * self.tail(measure, k, weights);
            }
            terms += f.len();
        }
        raised(sum, terms) * (Up::ONE + ERROR)
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
        let mut size = self.linear.coupling_size(w.unknown, w.k, h);
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

    /// N.
    pub(crate) fn modes(&self) -> usize {
        self.inverse.modes
    }
}

/// The functions of a field with what ties them to their arguments; of a cosine with the sine.
fn ties(task: &Task, centre: &Centre, functions: &[Laurent]) -> Vec<Tied> {
    let mut variables = Variables::known(centre, functions);
    let mut ties: Vec<Tied> = Vec::new();
    let mut done = 0;
    while let Some(function) = task.field.functions.get(done) {
        let tied = function.tie(&mut variables, &functions[done..]);
        done += tied.functions.len().max(1);
        ties.push(tied);
    }
    ties
}

/// A factor below 1 that covers the roundings of a denominator.
const LESS: f64 = 1.0 - 4.0 * f64::EPSILON;
