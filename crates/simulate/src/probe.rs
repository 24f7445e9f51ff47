//! The right sides at the end of a step: how well a series solves its equation there.

use crate::integrator::arithmetic::Arithmetic;
use crate::tape::{Moment, Op, Rows, Tape, horner};

/// All rows at one place of a series, and x' - f of every variable there.
#[derive(Clone, Debug)]
pub(crate) struct Probe<E> {
    pub(crate) rows: Rows<E>,
    pub(crate) defects: Vec<E>,
}

impl<E: Clone> Probe<E> {
    pub(crate) fn new(rows: usize, variables: usize, zero: &E) -> Self {
        Self { rows: Rows::new(rows, 1, zero), defects: vec![zero.clone(); variables] }
    }

    /// The place h behind the start, where the moment is.
    #[inline(always)]
    pub(crate) fn place<A: Arithmetic<Element = E>>(
        &mut self,
        real: &A,
        (tape, right_sides): (&Tape<E>, &[usize]),
        series: &Rows<E>,
        h: &E,
        moment: &mut Moment<'_, A>,
    ) {
        let given = |(_, op): &(usize, &Op)| matches!(op, Op::Delayed { .. } | Op::Control { .. });
        let given = (tape.states..).zip(&tape.ops).filter(given).map(|(row, _)| row);
        for row in (0..tape.states).chain(given) {
            horner(real, self.rows.at_mut(row, 0), series.row(row), h);
        }
        tape.level(real, &mut self.rows, 0, moment);
        for (state, defect) in self.defects.iter_mut().enumerate() {
            slope(real, (&mut *moment.sum, &mut *moment.scratch), series.row(state), h);
            real.subtract(defect, moment.sum, self.rows.at(right_sides[state], 0));
        }
    }
}

/// sum = the derivative of sum_k c_k s^k (Horner).
#[inline(always)]
pub(crate) fn slope<A: Arithmetic>(
    real: &A,
    (sum, scratch): (&mut A::Element, &mut A::Element),
    coefficients: &[A::Element],
    s: &A::Element,
) {
    real.set_zero(sum);
    for (k, c) in coefficients.iter().enumerate().skip(1).rev() {
        real.scale(sum, s);
        real.set(scratch, c);
        real.times_integer(scratch, k as i32);
        real.increase(sum, scratch);
    }
}
