//! The right sides as a flat list of recurrences for Taylor coefficients.
//!
//! Row r holds the coefficients of one quantity about the start of the step: first the states,
//! then one row per operation, operands before results. Level n of all rows follows from levels
//! 0..n of the operands, O(n) per row, so a step of order p costs O(rows p^2). The recurrences
//! are those of a = b c, a' = b' a (exponential) and so on (Moore, Interval Analysis, 1966;
//! Jorba and Zou, Experimental Mathematics 14, 2005, section 2).

mod sums;

use self::sums::{Step, square, steps};
use crate::integrator::arithmetic::Arithmetic;

/// One operation; the numbers are rows unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    /// A constant of the table.
    Constant(usize),
    /// t.
    Time,
    /// State `state` at t - T, T of the table of delays; the integrator fills the row.
    Delayed {
        state: usize,
        delay: usize,
    },
    Add(usize, usize),
    Subtract(usize, usize),
    /// Row times constant.
    Scale(usize, usize),
    Multiply(usize, usize),
    Square(usize),
    Divide(usize, usize),
    /// Row to the power of a constant; the row is positive.
    Power(usize, usize),
    Exp(usize),
    Ln(usize),
    /// The sine; the next row is the cosine of the same argument. `affine`: the argument is
    /// a + b t.
    Sin {
        argument: usize,
        affine: bool,
    },
    /// The cosine; the row before is the sine.
    Cos {
        argument: usize,
        affine: bool,
    },
    /// Row times the sign of a switch.
    Signed(usize, usize),
    /// The sign of a switch (part 0) or its derivative in a direction (part 1, 2, ...). While the
    /// switch slides the integrator determines the row.
    Control {
        switch: usize,
        part: usize,
    },
}

impl Op {
    /// The rows that the operation reads at its own level.
    pub(crate) fn operands(self) -> [Option<usize>; 2] {
        match self {
            Self::Constant(_) | Self::Time | Self::Delayed { .. } | Self::Control { .. } => {
                [None, None]
            }
            Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) | Self::Divide(a, b) => {
                [Some(a), Some(b)]
            }
            Self::Scale(a, _)
            | Self::Square(a)
            | Self::Power(a, _)
            | Self::Exp(a)
            | Self::Ln(a)
            | Self::Sin { argument: a, .. }
            | Self::Cos { argument: a, .. }
            | Self::Signed(a, _) => [Some(a), None],
        }
    }
}

/// States, operations, constants.
#[derive(Clone, Debug)]
pub(crate) struct Tape<E> {
    pub(crate) states: usize,
    pub(crate) ops: Vec<Op>,
    /// The rows that are a + b t: zero from level 2 on.
    pub(crate) affine: Vec<bool>,
    /// The operations that are needed, and those of them that are needed from level 2 on.
    pub(crate) live: Vec<usize>,
    pub(crate) curved: Vec<usize>,
    /// What the first two levels do, and the others: sums of one degree in one pass.
    pub(crate) first: Vec<Step<E>>,
    pub(crate) steps: Vec<Step<E>>,
    /// The rows of the controls: row, switch, part.
    pub(crate) controls: Vec<[usize; 3]>,
    /// Those of both that a control changes within its level.
    pub(crate) controlled: [Vec<Step<E>>; 2],
    /// The rows that are read from outside.
    pub(crate) needed: Vec<usize>,
    pub(crate) constants: Vec<E>,
}

/// Taylor coefficients: `stride` numbers per row.
#[derive(Clone, Debug)]
pub(crate) struct Rows<E> {
    pub(crate) stride: usize,
    pub(crate) data: Vec<E>,
}

impl<E: Clone> Rows<E> {
    pub(crate) fn new(rows: usize, stride: usize, zero: &E) -> Self {
        Self { stride, data: vec![zero.clone(); rows * stride] }
    }

    pub(crate) fn row(&self, row: usize) -> &[E] {
        &self.data[row * self.stride..(row + 1) * self.stride]
    }

    pub(crate) fn row_mut(&mut self, row: usize) -> &mut [E] {
        &mut self.data[row * self.stride..(row + 1) * self.stride]
    }

    pub(crate) fn at(&self, row: usize, level: usize) -> &E {
        &self.data[row * self.stride + level]
    }

    pub(crate) fn at_mut(&mut self, row: usize, level: usize) -> &mut E {
        &mut self.data[row * self.stride + level]
    }
}

/// What the recurrences need beside the rows: the time at the start of the step, the mode of
/// every switch, and two places to compute in.
pub(crate) struct Moment<'a, R: Arithmetic> {
    pub(crate) time: &'a R::Element,
    pub(crate) modes: &'a [R::Mode],
    pub(crate) sum: &'a mut R::Element,
    pub(crate) scratch: &'a mut R::Element,
}

impl<E: Clone> Tape<E> {
    pub(crate) fn rows(&self) -> usize {
        self.states + self.ops.len()
    }

    /// Level `n` of all operations.
    #[inline(always)]
    pub(crate) fn level<R: Arithmetic<Element = E>>(
        &self,
        real: &R,
        rows: &mut Rows<E>,
        n: usize,
        moment: &mut Moment<'_, R>,
    ) {
        // Rows start as zeros: where nothing is written they remain so.
        self.run(if n < 2 { &self.first } else { &self.steps }, real, rows, n, moment);
    }

    /// Some steps of level `n`.
    #[inline(always)]
    pub(crate) fn run<R: Arithmetic<Element = E>>(
        &self,
        steps: &[Step<E>],
        real: &R,
        rows: &mut Rows<E>,
        n: usize,
        moment: &mut Moment<'_, R>,
    ) {
        for step in steps {
            match step {
                Step::Operation(index) => self.operation(real, rows, *index, n, moment),
                Step::Sum(row, sum) => {
                    sum.level(real, rows, n, (&mut *moment.sum, &mut *moment.scratch));
                    std::mem::swap(rows.at_mut(*row, n), moment.sum);
                }
            }
        }
    }

    /// Restricts the work to what the given rows need.
    pub(crate) fn restrict<R: Arithmetic<Element = E>>(&mut self, real: &R, needed: Vec<usize>) {
        self.live = self.cone(needed.clone());
        self.curved = self.live.iter().copied().filter(|index| !self.affine[*index]).collect();
        self.first = self.live.iter().map(|index| Step::Operation(*index)).collect();
        self.steps = steps(real, self, &needed);
        self.controlled = self.behind_controls();
        let control = |(op, row)| match op {
            &Op::Control { switch, part } => Some([row, switch, part]),
            _ => None,
        };
        self.controls = self.ops.iter().zip(self.states..).filter_map(control).collect();
        self.needed = needed;
    }

    /// The steps of level `n` whose results a new coefficient `n` of a control changes.
    pub(crate) fn behind(&self, n: usize) -> &[Step<E>] {
        &self.controlled[usize::from(n >= 2)]
    }

    fn behind_controls(&self) -> [Vec<Step<E>>; 2] {
        let mut behind = vec![false; self.rows()];
        for (index, op) in self.ops.iter().enumerate() {
            let reads = op.operands().into_iter().flatten().any(|row| behind[row]);
            behind[self.states + index] = reads || matches!(op, Op::Control { .. });
        }
        [&self.first, &self.steps].map(|steps| {
            let changed = |step: &&Step<E>| behind[step.row(self.states)];
            steps.iter().filter(changed).cloned().collect()
        })
    }

    /// The tape of several ones that differ in their constants alone, side by side; nothing for others.
    pub(crate) fn side_by_side<R: Arithmetic>(
        tapes: &[&Self],
        real: &R,
        join: impl Fn(usize) -> R::Element,
    ) -> Option<Tape<R::Element>> {
        let (first, rest) = tapes.split_first()?;
        let same = |tape: &&Self| {
            (tape.states, &tape.ops, &tape.needed) == (first.states, &first.ops, &first.needed)
        };
        let mut tape = Tape {
            states: first.states,
            ops: first.ops.clone(),
            affine: first.affine.clone(),
            live: Vec::new(),
            curved: Vec::new(),
            first: Vec::new(),
            steps: Vec::new(),
            controls: Vec::new(),
            controlled: Default::default(),
            needed: Vec::new(),
            constants: (0..first.constants.len()).map(join).collect(),
        };
        tape.restrict(real, first.needed.clone());
        rest.iter().all(same).then_some(tape)
    }

    /// The operations that some rows need, in order.
    pub(crate) fn cone(&self, mut open: Vec<usize>) -> Vec<usize> {
        let mut needed = vec![false; self.ops.len()];
        while let Some(row) = open.pop() {
            let Some(index) = row.checked_sub(self.states) else { continue };
            if std::mem::replace(&mut needed[index], true) {
                continue;
            }
            open.extend(self.ops[index].operands().into_iter().flatten());
            // Sine and cosine read each other.
            match self.ops[index] {
                Op::Sin { .. } => open.push(row + 1),
                Op::Cos { .. } => open.push(row - 1),
                _ => {}
            }
        }
        (0..needed.len()).filter(|index| needed[*index]).collect()
    }

    /// Whether a row is a linear function of states and time.
    pub(crate) fn is_linear(&self, row: usize) -> bool {
        let linear = |index: usize| {
            let op = &self.ops[index];
            self.affine[index] || matches!(op, Op::Add(..) | Op::Subtract(..) | Op::Scale(..))
        };
        self.cone(vec![row]).into_iter().all(linear)
    }

    /// Level `n` of operation `index`. Inlined, as all that it does, into what is compiled for wider vectors.
    #[inline(always)]
    pub(crate) fn operation<R: Arithmetic<Element = E>>(
        &self,
        real: &R,
        rows: &mut Rows<E>,
        index: usize,
        n: usize,
        moment: &mut Moment<'_, R>,
    ) {
        let target = self.states + index;
        let sum = &mut *moment.sum;
        let scratch = &mut *moment.scratch;
        let order = n as u32;
        match self.ops[index] {
            Op::Delayed { .. } => return,
            Op::Control { switch, part } => match moment.modes[switch] {
                mode if real.slides(mode) => return,
                mode if part == 0 && n == 0 && !real.leaps(mode) => {
                    real.set(sum, &real.double(1.0));
                    real.times_sign(sum, mode);
                }
                _ => real.set_zero(sum),
            },
            Op::Constant(c) if n == 0 => real.set(sum, &self.constants[c]),
            Op::Constant(_) => real.set_zero(sum),
            Op::Time => match n {
                0 => real.set(sum, moment.time),
                1 => real.set(sum, &real.double(1.0)),
                _ => real.set_zero(sum),
            },
            Op::Add(a, b) => real.add(sum, rows.at(a, n), rows.at(b, n)),
            Op::Subtract(a, b) => real.subtract(sum, rows.at(a, n), rows.at(b, n)),
            Op::Scale(a, c) => real.multiply(sum, rows.at(a, n), &self.constants[c]),
            Op::Multiply(a, b) => real.convolve(sum, &rows.row(a)[..=n], &rows.row(b)[..=n]),
            Op::Square(a) => square(real, sum, &rows.row(a)[..=n]),
            Op::Divide(_, a) | Op::Power(a, _)
                if moment.modes.iter().any(|mode| real.leaps(*mode))
                    && real.is_zero(rows.at(a, 0)) =>
            {
                real.set_zero(sum);
            }
            // q b = a: q_n b_0 = a_n - sum_{j<n} q_j b_{n-j}.
            Op::Divide(a, b) => {
                real.convolve(scratch, &rows.row(target)[..n], &rows.row(b)[1..=n]);
                real.subtract(sum, rows.at(a, n), scratch);
                real.set(scratch, sum);
                real.divide(sum, scratch, rows.at(b, 0));
            }
            Op::Exp(a) if n == 0 => real.exp(sum, rows.at(a, 0)),
            // e' = a' e.
            Op::Exp(a) => {
                let (a, e) = (&rows.row(a)[..=n], &rows.row(target)[..n]);
                real.convolve_derivative(sum, scratch, a, e);
                real.over_integer(sum, order);
            }
            Op::Ln(a) if n == 0 => real.ln(sum, rows.at(a, 0)),
            // a l' = a': n a_0 l_n = n a_n - sum_{0<k<n} k l_k a_{n-k}.
            Op::Ln(a) => {
                let (a, l) = (&rows.row(a)[..=n], &rows.row(target)[..n]);
                real.convolve_derivative(sum, scratch, l, &a[1..]);
                real.over_integer(sum, order);
                real.subtract(scratch, &a[n], sum);
                real.divide(sum, scratch, &a[0]);
            }
            Op::Power(a, p) if n == 0 => real.power(sum, rows.at(a, 0), &self.constants[p]),
            // a b' = p a' b: n a_0 b_n = p sum_{j>0} j a_j b_{n-j} - sum_{0<k<n} k b_k a_{n-k}.
            Op::Power(a, p) => {
                let (a, b) = (&rows.row(a)[..=n], &rows.row(target)[..n]);
                real.convolve_derivative(sum, scratch, a, b);
                real.scale(sum, &self.constants[p]);
                let mut rest = real.zero();
                real.convolve_derivative(&mut rest, scratch, b, &a[1..]);
                real.subtract(scratch, sum, &rest);
                real.over_integer(scratch, order);
                real.divide(sum, scratch, &a[0]);
            }
            Op::Sin { argument, .. } if n == 0 => real.sin(sum, rows.at(argument, 0)),
            Op::Cos { argument, .. } if n == 0 => real.cos(sum, rows.at(argument, 0)),
            // s' = a' c, c' = -a' s.
            Op::Sin { argument, affine } => {
                let (a, c) = (rows.row(argument), rows.row(target + 1));
                chain(real, sum, scratch, (&a[..=n], &c[..n]), affine);
                real.over_integer(sum, order);
            }
            Op::Cos { argument, affine } => {
                let (a, s) = (rows.row(argument), rows.row(target - 1));
                chain(real, sum, scratch, (&a[..=n], &s[..n]), affine);
                real.over_integer(sum, order);
                real.times_integer(sum, -1);
            }
            Op::Signed(a, switch) => match moment.modes[switch] {
                mode if real.slides(mode) || real.leaps(mode) => real.set_zero(sum),
                mode => {
                    real.set(sum, rows.at(a, n));
                    real.times_sign(sum, mode);
                }
            },
        }
        std::mem::swap(rows.at_mut(target, n), sum);
    }
}

/// sum_{j>0} j a_j b_{n-j}; one term if a is affine.
#[inline(always)]
fn chain<R: Arithmetic>(
    real: &R,
    sum: &mut R::Element,
    scratch: &mut R::Element,
    (a, b): (&[R::Element], &[R::Element]),
    affine: bool,
) {
    match (affine, a, b) {
        (true, [_, slope, ..], [.., last]) => real.multiply(sum, slope, last),
        _ => real.convolve_derivative(sum, scratch, a, b),
    }
}

/// to = sum_k c_k s^k (Horner).
#[inline(always)]
pub(crate) fn horner<R: Arithmetic>(
    real: &R,
    to: &mut R::Element,
    coefficients: &[R::Element],
    s: &R::Element,
) {
    real.set_zero(to);
    for c in coefficients.iter().rev() {
        real.scale(to, s);
        real.increase(to, c);
    }
}
