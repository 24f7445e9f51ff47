//! The linearisation: the tape differentiated along the states.
//!
//! Direction i follows delta' = (df/dx) delta from its own start; its states stand behind the
//! states of the flow. Signs have derivative zero; where a switch slides the derivative of its
//! control is determined like the control itself.

use crate::compile::{Compiler, Value};
use crate::integrator::real::Real;
use crate::tape::Op;

impl<R: Real> Compiler<'_, R> {
    /// For every row its derivative in direction `direction` (nothing where it vanishes); state k
    /// of the direction is the row `variables (direction + 1) + k`.
    pub(crate) fn differentiate(
        &mut self,
        variables: usize,
        direction: usize,
    ) -> Vec<Option<usize>> {
        let (states, known) = (self.tape.states, self.tape.ops.len());
        let own = |k: usize| (k < variables).then_some(variables * (direction + 1) + k);
        let mut tangents: Vec<Option<usize>> = (0..states).map(own).collect();
        for index in 0..known {
            let row = states + index;
            let of = |operand: usize| tangents[operand];
            let tangent = match self.tape.ops[index] {
                Op::Constant(_) | Op::Time | Op::Delayed { .. } => None,
                Op::Add(a, b) => match (of(a), of(b)) {
                    (Some(a), Some(b)) => Some(self.push(Op::Add(a, b))),
                    (single, None) | (None, single) => single,
                },
                Op::Subtract(a, b) => match (of(a), of(b)) {
                    (Some(a), Some(b)) => Some(self.push(Op::Subtract(a, b))),
                    (None, Some(b)) => Some(self.times(b, -1)),
                    (single, None) => single,
                },
                Op::Scale(a, c) => of(a).map(|a| self.push(Op::Scale(a, c))),
                Op::Multiply(a, b) => {
                    let left = of(a).map(|da| self.push(Op::Multiply(da, b)));
                    let right = of(b).map(|db| self.push(Op::Multiply(a, db)));
                    match (left, right) {
                        (Some(left), Some(right)) => Some(self.push(Op::Add(left, right))),
                        (single, None) | (None, single) => single,
                    }
                }
                Op::Square(a) => of(a).map(|da| {
                    let product = self.push(Op::Multiply(a, da));
                    self.times(product, 2)
                }),
                // d(a/b) = (da - (a/b) db)/b.
                Op::Divide(a, b) => {
                    let left = of(a);
                    let right = of(b).map(|db| self.push(Op::Multiply(row, db)));
                    let above = match (left, right) {
                        (Some(left), Some(right)) => Some(self.push(Op::Subtract(left, right))),
                        (None, Some(right)) => Some(self.times(right, -1)),
                        (single, None) => single,
                    };
                    above.map(|above| self.push(Op::Divide(above, b)))
                }
                // d(a^p) = p a^p da/a.
                Op::Power(a, p) => of(a).map(|da| {
                    let product = self.push(Op::Multiply(row, da));
                    let quotient = self.push(Op::Divide(product, a));
                    self.push(Op::Scale(quotient, p))
                }),
                Op::Exp(a) => of(a).map(|da| self.push(Op::Multiply(row, da))),
                Op::Ln(a) => of(a).map(|da| self.push(Op::Divide(da, a))),
                Op::Sin { argument, .. } => {
                    of(argument).map(|da| self.push(Op::Multiply(row + 1, da)))
                }
                Op::Cos { argument, .. } => of(argument).map(|da| {
                    let product = self.push(Op::Multiply(row - 1, da));
                    self.times(product, -1)
                }),
                Op::Signed(a, switch) => of(a).map(|da| self.push(Op::Signed(da, switch))),
                Op::Control { switch, .. } => {
                    Some(self.push(Op::Control { switch, part: direction + 1 }))
                }
            };
            tangents.push(tangent);
        }
        for switch in &mut self.switches {
            switch.tangents.push(tangents[switch.row]);
        }
        tangents
    }

    fn times(&mut self, row: usize, n: i64) -> usize {
        let n = Value::Constant(self.float(n));
        let product = self.product(n, Value::Row(row));
        self.row(product)
    }
}
