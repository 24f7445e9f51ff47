//! Newton's method in Fourier space: on few modes in doubles, then to any number of digits.

use crate::Failure;
use crate::centre::{Centre, Doubles};
use crate::linear::{Inverse, Linear, Step, at};
use crate::task::Task;
use lindstedt_algebra::Stop;
use nalgebra::{Complex, DVector};
use rug::Float;

/// Newton steps in doubles.
const MOST_STEPS: usize = 40;
/// A step below this fraction of the orbit ends them.
const CONVERGED: f64 = 1e-10;
/// Sweeps of the inner iteration, and the factor that they shall gain.
const MOST_SWEEPS: usize = 60;
const GAIN: f64 = 1e-9;

/// sum_k max(k, 1) |c_k|.
fn size(modes: &[Complex<f64>]) -> f64 {
    modes.iter().enumerate().map(|(k, c)| c.norm() * k.max(1) as f64).sum()
}

/// Harmonic balance: Newton's method on the modes up to `modes`.
pub(crate) fn balance(
    task: &Task,
    mut centre: Centre,
    modes: usize,
    stop: &Stop,
) -> Result<Centre, Failure> {
    centre.modes.resize(modes);
    let start = size(&centre.doubles());
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        if stop.asked() {
            return Err(Failure::Stopped);
        }
        let (linear, residual, condition) = state(task, &centre);
        let matrix = linear.matrix(modes);
        let basis = task.rows.parity.basis(modes);
        let condition = task.is_free().then_some(condition);
        let rows = basis.iter().map(|w| w.of(at(&residual, w.k as i64)));
        let rows = condition.into_iter().chain(rows);
        let right = -DVector::from_iterator(matrix.nrows(), rows);
        let solution = matrix.lu().solve(&right).ok_or(Failure::Singular { modes })?;
        let extra = usize::from(task.is_free());
        let mut step = vec![Complex::default(); modes + 1];
        for (w, value) in basis.iter().zip(solution.iter().skip(extra)) {
            step[w.k] += w.complex(*value);
        }
        let change = size(&step);
        let frequency = if extra == 1 { solution[0] } else { 0.0 };
        let now = size(&centre.doubles());
        // A step larger than the orbit is shortened: far away the linear model means little.
        let factor = (0.5 * now / change).min(1.0);
        step.iter_mut().for_each(|c| *c *= factor);
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
fn state(task: &Task, centre: &Centre) -> (Linear, Vec<Complex<f64>>, f64) {
    let values = centre.values(&task.field);
    let linear = Linear::new(centre.frequency.to_f64(), &values, task.rows);
    (linear, values.residual.doubles(Some(0)).values, task.condition(centre).to_f64())
}

/// The inverse of DF on the modes up to `modes`.
pub(crate) fn invert(linear: &Linear, modes: usize) -> Result<Inverse, Failure> {
    let matrix = linear.matrix(modes).try_inverse().ok_or(Failure::Singular { modes })?;
    Ok(Inverse { modes, basis: linear.rows.parity.basis(modes), matrix })
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
    stop: &Stop,
) -> Result<Centre, Failure> {
    let mut linear: Option<Linear> = None;
    let mut before = Float::with_val(53, f64::INFINITY);
    let mut slow = 0;
    loop {
        if stop.asked() {
            return Err(Failure::Stopped);
        }
        let (residual, model) = match linear.take() {
            Some(linear) => (centre.residual(&task.field), linear),
            None => {
                let values = centre.values(&task.field);
                let mut model = Linear::new(centre.frequency.to_f64(), &values, task.rows);
                model.cut(1e-14);
                (values.residual, model)
            }
        };
        let residual = residual.doubles(None);
        let modes = needed(&residual, &model, inverse, target).min(most_modes);
        let condition = task.condition(&centre) >> residual.exponent;
        let mut rows = residual.values;
        rows.resize(modes + 1, Complex::default());
        let step = solve(&model, inverse, condition.to_f64(), &rows, stop);
        let change = Float::with_val(53, size(&step.modes)) << residual.exponent;
        centre.add(step.frequency, &step.modes, residual.exponent);
        centre.modes.trim();
        if change <= *target {
            return Ok(centre);
        }
        // Doubles give many digits per step; a step that is not much smaller than the one before
        // says that A does not contract.
        slow = if change > Float::with_val(53, &before / 4u32) { slow + 1 } else { 0 };
        if !change.is_finite() || slow > 3 {
            return Err(Failure::NotConverged { modes: inverse.modes });
        }
        // Near the solution the model of the first steps serves for all.
        linear = (change < 1e-10).then_some(model);
        before = change;
    }
}

/// The least number of modes beyond which the residual, divided by omega^2 k, sums to less than an
/// eighth of the target.
fn needed(residual: &Doubles, model: &Linear, inverse: &Inverse, target: &Float) -> usize {
    let allowed = (Float::with_val(53, target / 8u32) >> residual.exponent).to_f64();
    let mut rest = 0.0;
    let mut k = residual.values.len().saturating_sub(1);
    while k > inverse.modes {
        rest += 2.0 * residual.values[k].norm() / (model.frequency * model.frequency * k as f64);
        if rest > allowed {
            break;
        }
        k -= 1;
    }
    k
}

/// c with DF c = -F: c := c - A (DF c + F).
fn solve(
    model: &Linear,
    inverse: &Inverse,
    condition: f64,
    rows: &[Complex<f64>],
    stop: &Stop,
) -> Step {
    let minus: Vec<_> = rows.iter().map(|c| -c).collect();
    let mut step = model.precondition(inverse, -condition, &minus);
    step.modes.resize(rows.len().max(inverse.modes + 1), Complex::default());
    let first = size(&step.modes);
    let mut last = f64::INFINITY;
    for _ in 0..MOST_SWEEPS {
        let (of_condition, mut of_rows) = model.apply(&step);
        for (out, c) in of_rows.iter_mut().zip(rows) {
            *out = -(*out + c);
        }
        let correction = model.precondition(inverse, -(of_condition + condition), &of_rows);
        let change = size(&correction.modes);
        if !change.is_finite() || change > 2.0 * last || stop.asked() {
            break;
        }
        step.frequency += correction.frequency;
        step.modes.iter_mut().zip(&correction.modes).for_each(|(c, d)| *c += d);
        last = change;
        if change < GAIN * first {
            break;
        }
    }
    step
}
