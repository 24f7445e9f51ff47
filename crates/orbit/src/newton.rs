//! Newton's method in Fourier space: on few modes in doubles, then to any number of digits.

use crate::Failure;
use crate::centre::{Centre, Values};
use crate::exact::{Doubles, Exact};
use crate::linear::{Inverse, Linear, Step, at};
use crate::product::Products;
use crate::task::Task;
use lindstedt_algebra::Stop;
use nalgebra::{Complex, DVector};
use rug::Float;

/// Newton steps in doubles.
const MOST_STEPS: usize = 40;
/// A step below this fraction of the orbit ends them.
const CONVERGED: f64 = 1e-10;
/// A step of so many times the largest harmonic leads nowhere.
const FARTHEST: f64 = 1e3;
/// Sweeps of the inner iteration, and the factor that they shall gain.
const MOST_SWEEPS: usize = 60;
const GAIN: f64 = 1e-9;

/// sum_k max(k, 1) |c_k| over all unknowns.
fn size(unknowns: &[Vec<Complex<f64>>]) -> f64 {
    let one = |modes: &Vec<Complex<f64>>| -> f64 {
        modes.iter().enumerate().map(|(k, c)| c.norm() * k.max(1) as f64).sum()
    };
    unknowns.iter().map(one).sum()
}

/// Harmonic balance: Newton's method on the modes up to `modes`.
pub(crate) fn balance(task: &Task, mut centre: Centre, modes: usize) -> Result<Centre, Failure> {
    centre.resize(modes);
    let start = size(&centre.doubles());
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        if task.stop.asked() {
            return Err(Failure::Stopped);
        }
        let (linear, residual, condition) = state(task, &centre)?;
        let matrix = linear.matrix(modes);
        let basis = linear.basis(modes);
        let condition = task.is_free().then_some(condition);
        let rows = basis.iter().map(|w| w.of(at(&residual[w.unknown], w.k as i64)));
        let rows = condition.into_iter().chain(rows);
        let right = -DVector::from_iterator(matrix.nrows(), rows);
        let solution = matrix.lu().solve(&right).ok_or(Failure::Singular { modes })?;
        let extra = linear.extra();
        let mut step = vec![vec![Complex::default(); modes + 1]; linear.unknowns];
        for (w, value) in basis.iter().zip(solution.iter().skip(extra)) {
            step[w.unknown][w.k] += w.complex(*value);
        }
        let change = size(&step);
        let frequency = if extra == 1 { solution[0] } else { 0.0 };
        let now = size(&centre.doubles());
        // A step larger than the orbit is shortened: far away the linear model means little.
        let factor = (0.5 * now / change).min(1.0);
        step.iter_mut().flatten().for_each(|c| *c *= factor);
        centre.add(frequency * factor, &step, 0);
        if !change.is_finite() || now > 1e3 * start || centre.frequency <= 0 {
            return Err(Failure::NotConverged { modes });
        }
        // Steps as small as the rounding errors of the solution do not shrink any more.
        if change < CONVERGED * now || (change < 1e-6 * now && change > 0.5 * before) {
            return Ok(centre);
        }
        before = change;
    }
    Err(Failure::NotConverged { modes })
}

/// DF, F and the condition in doubles.
type State = (Linear, Vec<Vec<Complex<f64>>>, f64);

fn state(task: &Task, centre: &Centre) -> Result<State, Failure> {
    let (values, linear) = linearised(task, centre)?;
    let residual = values.residual.iter().map(|e| e.doubles(0)).collect();
    Ok((linear, residual, task.condition(centre).to_f64()))
}

/// F and DF at a centre.
pub(crate) fn linearised(task: &Task, centre: &Centre) -> Result<(Values, Linear), Failure> {
    let values = centre.values(&task.field, &task.stop)?;
    let linear = Linear::new(centre.frequency.to_f64(), &values, task.rows);
    Ok((values, linear))
}

/// The inverse of DF on the modes up to `modes`.
pub(crate) fn invert(linear: &Linear, modes: usize) -> Result<Inverse, Failure> {
    let matrix = linear.matrix(modes).try_inverse().ok_or(Failure::Singular { modes })?;
    Ok(Inverse { modes, basis: linear.basis(modes), matrix })
}

/// The residuals in doubles with one exponent.
fn residuals(list: &[Exact], bits: u32) -> (Vec<Vec<Complex<f64>>>, i32) {
    let largest = list.iter().filter_map(Exact::exponent).max().unwrap_or(-(bits as i32));
    (list.iter().map(|e| e.doubles(largest)).collect(), largest)
}

/// A right side and a value for the condition, times 2^-exponent.
#[derive(Clone, Debug)]
pub(crate) struct Right {
    pub(crate) rows: Vec<Doubles>,
    pub(crate) exponent: i32,
    pub(crate) condition: f64,
}

impl Right {
    pub(crate) fn new(rows: &[Exact], condition: Float, bits: u32) -> Self {
        let (rows, exponent) = residuals(rows, bits);
        let condition = Float::with_val(53, condition >> exponent).to_f64();
        Self { rows, exponent, condition }
    }
}

/// Newton's method with every residual formed exactly; the linear equations are solved in doubles
/// by iteration with A, so that the modes of the solution are not limited by those of A. Ends when a
/// step has a norm below `target`.
pub(crate) fn refine(
    task: &Task,
    mut centre: Centre,
    inverse: &Inverse,
    target: &Float,
    most_modes: usize,
) -> Result<Centre, Failure> {
    let mut linear: Option<Linear> = None;
    let mut before = Float::with_val(53, f64::INFINITY);
    let mut slow = 0;
    loop {
        if task.stop.asked() {
            return Err(Failure::Stopped);
        }
        let (residual, model) = match linear.take() {
            Some(linear) => (centre.residual(&task.field, &task.stop)?, linear),
            None => {
                let (values, mut model) = linearised(task, &centre)?;
                model.cut(1e-14);
                (values.residual, model)
            }
        };
        let (mut rows, exponent) = residuals(&residual, centre.bits);
        let allowed = (Float::with_val(53, target / 8u32) >> exponent).to_f64();
        let modes = needed(&rows, &model, inverse, allowed).min(most_modes);
        let condition = task.condition(&centre) >> exponent;
        rows.iter_mut().for_each(|row| row.resize(modes + 1, Complex::default()));
        let step = solve(&model, inverse, condition.to_f64(), &rows, &task.stop);
        let change = Float::with_val(53, size(&step.unknowns)) << exponent;
        // From a solution of the balance no step goes beyond the orbit; its numbers would double their bits each time.
        let near = change <= centre.largest() * FARTHEST;
        if !near {
            return Err(Failure::NotConverged { modes: inverse.modes });
        }
        centre.add(step.frequency, &step.unknowns, exponent);
        centre.unknowns.iter_mut().for_each(|f| f.trim());
        if change <= *target {
            return Ok(centre);
        }
        // Doubles give many digits per step; a step that is not much smaller than the one before
        // says that A does not contract.
        slow = if change > Float::with_val(53, &before / 4u32) { slow + 1 } else { 0 };
        if slow > 3 {
            return Err(Failure::NotConverged { modes: inverse.modes });
        }
        // Near the solution the model of the first steps serves for all.
        linear = (change < 1e-10).then_some(model);
        before = change;
    }
}

/// The least number of modes beyond which the residual, divided by omega^2 k, sums to less than what is
/// allowed.
fn needed(rows: &[Vec<Complex<f64>>], model: &Linear, inverse: &Inverse, allowed: f64) -> usize {
    let mut rest = 0.0;
    let mut k = rows.iter().map(|row| row.len()).max().unwrap_or(0).saturating_sub(1);
    while k > inverse.modes {
        let size: f64 = rows.iter().filter_map(|row| row.get(k)).map(|c| c.norm()).sum();
        rest += 2.0 * size / (model.frequency * model.frequency * k as f64);
        if rest > allowed {
            break;
        }
        k -= 1;
    }
    k
}

/// c with DF c = -F: c := c - A (DF c + F).
pub(crate) fn solve(
    model: &Linear,
    inverse: &Inverse,
    condition: f64,
    rows: &[Vec<Complex<f64>>],
    stop: &Stop,
) -> Step {
    let minus: Vec<Vec<_>> = rows.iter().map(|row| row.iter().map(|c| -c).collect()).collect();
    let mut step = model.precondition(inverse, -condition, &minus);
    let first = size(&step.unknowns);
    let products = Products::new(model, step.unknowns[0].len() - 1);
    let mut last = f64::INFINITY;
    for _ in 0..MOST_SWEEPS {
        let (of_condition, mut of_rows) = products.apply(&step);
        for (out, row) in of_rows.iter_mut().zip(rows) {
            out.iter_mut().for_each(|c| *c = -*c);
            out.iter_mut().zip(row).for_each(|(out, c)| *out -= c);
        }
        let correction = model.precondition(inverse, -(of_condition + condition), &of_rows);
        let change = size(&correction.unknowns);
        if !change.is_finite() || change > 2.0 * last || stop.asked() {
            break;
        }
        step.frequency += correction.frequency;
        let pairs = step.unknowns.iter_mut().flatten().zip(correction.unknowns.iter().flatten());
        pairs.for_each(|(c, d)| *c += d);
        last = change;
        if change < GAIN * first {
            break;
        }
    }
    step
}
