//! The orbit moved along its family: c(s) = c + s d for the parameter p(s) of a part of an interval, -1 <= s <= 1.
//!
//! With the tangent for d the residual G(s) = F(c(s), p(s)) has hardly a first order:
//! G(s) = G(0) + s G'(0) + a rest of at most |G''|/2, G(0) and G'(0) formed exactly.

use crate::Failure;
use crate::centre::{Centre, Values, Variables};
use crate::exact::{Exact, Part, combine, unit};
use crate::linear::{Inverse, Linear};
use crate::newton::{Right, solve};
use crate::task::Task;
use rug::{Complete, Float, Integer, Rational};

/// The step d, as numbers over 2^bits, and G'(0).
#[derive(Clone, Debug)]
pub(crate) struct Drift {
    pub(crate) step: Centre,
    pub(crate) slope: Right,
}

impl Drift {
    /// The tangent of the family at a centre; nothing where neither field nor condition varies with a parameter.
    pub(crate) fn new(
        task: &Task,
        (centre, values, linear): (&Centre, &Values, &Linear),
        inverse: &Inverse,
    ) -> Result<Option<Self>, Failure> {
        // Coefficients that are uncertain by themselves need not move with the value of the condition.
        let alone = task.error.is_zero() || task.field.is_uncertain();
        if task.field.varying.is_none() && alone {
            return Ok(None);
        }
        let modes = centre.modes().max(inverse.modes);
        let by_parameter = by_parameter(task, centre, values);
        let mut rows: Vec<Vec<_>> =
            by_parameter.into_iter().map(|parts| combine(parts).doubles(0)).collect();
        rows.iter_mut().for_each(|row| row.resize(modes + 1, Default::default()));
        let mut model = linear.clone();
        model.cut(1e-14);
        let tangent = solve(&model, inverse, -task.error.to_f64(), &rows, &task.stop);
        let mut step = Centre::from_doubles(centre.bits, tangent.frequency, &tangent.unknowns);
        step.unknowns.iter_mut().for_each(|f| f.trim());
        Ok(Some(Self::along(task, (centre, values), step)))
    }

    /// Any step.
    pub(crate) fn along(task: &Task, (centre, values): (&Centre, &Values), step: Centre) -> Self {
        let rows = along(centre, values, &step, by_parameter(task, centre, values));
        let condition = Float::with_val(64, task.form(&step) - &task.error);
        let slope = Right::new(&rows, condition, centre.bits);
        Self { step, slope }
    }

    /// c + s d.
    pub(crate) fn moved(&self, centre: &Centre, s: f64) -> Centre {
        let mut moved = centre.clone();
        let sign = if s < 0.0 { -1 } else { 1 };
        moved.resize(centre.modes().max(self.step.modes()));
        for (f, d) in moved.unknowns.iter_mut().zip(&self.step.unknowns) {
            f.re.iter_mut().zip(&d.re).for_each(|(f, d)| *f += Integer::from(d * sign));
            f.im.iter_mut().zip(&d.im).for_each(|(f, d)| *f += Integer::from(d * sign));
        }
        moved.frequency += Rational::from(&self.step.frequency * sign);
        moved
    }
}

/// dF/ds at a centre (but for the errors of the functions).
fn by_parameter(task: &Task, centre: &Centre, values: &Values) -> Vec<Vec<Part>> {
    let Some(varying) = &task.field.varying else { return vec![Vec::new(); task.field.unknowns()] };
    let mut variables = Variables::known(centre, &values.functions);
    let minus = Rational::from(-1);
    varying.forces.iter().map(|p| variables.parts(p, 0, &minus)).collect()
}

/// DF d + dF/ds, exactly (but for the errors of the functions).
fn along(
    centre: &Centre,
    values: &Values,
    step: &Centre,
    by_parameter: Vec<Vec<Part>>,
) -> Vec<Exact> {
    let n = centre.unknowns.len();
    let minus = |f: &Exact| (-&f.scale).complete() >> step.bits;
    let row = |(i, mut parts): (usize, Vec<Part>)| {
        let by_frequency = &values.by_frequency[i];
        let factor = (&by_frequency.scale * &step.frequency).complete();
        parts.push(Part { factor, modes: by_frequency.modes.clone(), wave: unit() });
        let factor = centre.frequency.clone().square() >> step.bits;
        let bend = step.unknowns[i].derivative().derivative();
        parts.push(Part { factor, modes: bend, wave: unit() });
        for (k, h) in step.unknowns.iter().enumerate() {
            let entries = [(&values.by_x, h.clone()), (&values.by_slope, h.derivative())];
            for (entry, h) in entries.map(|(list, h)| (&list[i * n + k], h)) {
                let modes = entry.modes.times(&h);
                parts.push(Part { factor: minus(entry), modes, wave: unit() });
            }
        }
        combine(parts)
    };
    by_parameter.into_iter().enumerate().map(row).collect()
}
