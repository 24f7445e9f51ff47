//! Sums of one degree in one pass.
//!
//! From level 2 on a row r = sum_i c_i u_i, each u_i a row, a product of two rows or a square, is one step
//!
//! ```text
//! r_n = sum_i c_i u_(i,n),   u_(i,n) = a_n, sum_j a_j b_(n-j) or sum_j a_j a_(n-j)
//! ```
//!
//! in place of an operation per sign of the sum: the products and partial sums that nothing else reads are never
//! written. Every product and every sum is rounded as the operations round it, in their order, so that the levels are
//! those of the operations, bit for bit (a zero may have another sign).

use super::{Op, Rows, Tape};
use crate::integrator::arithmetic::Arithmetic;

/// u of c u.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Row(usize),
    Product(usize, usize),
    Square(usize),
}

/// c.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factor {
    One,
    Constant(usize),
}

/// +- c u.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Signed {
    negative: bool,
    factor: Factor,
    part: Part,
}

/// c u with its number; nothing stands for 1.
#[derive(Clone, Debug)]
struct Term<E> {
    factor: Option<E>,
    part: Part,
}

/// What a level does, one after the other.
#[derive(Clone, Debug)]
pub(crate) enum Step<E> {
    /// An operation of the tape.
    Operation(usize),
    /// The row becomes a sum.
    Sum(usize, Sum<E>),
}

impl<E> Step<E> {
    /// The row that it writes, behind so many states.
    pub(crate) fn row(&self, states: usize) -> usize {
        match self {
            Self::Operation(index) => states + index,
            Self::Sum(row, _) => *row,
        }
    }
}

/// A sum of terms, added from the first to the last.
#[derive(Clone, Debug)]
pub(crate) struct Sum<E> {
    terms: Vec<Term<E>>,
}

impl<E: Clone> Sum<E> {
    /// sum = its coefficient n.
    #[inline(always)]
    pub(crate) fn level<R: Arithmetic<Element = E>>(
        &self,
        real: &R,
        rows: &Rows<E>,
        n: usize,
        (sum, scratch): (&mut E, &mut E),
    ) {
        let Some((first, rest)) = self.terms.split_first() else {
            real.set_zero(sum);
            return;
        };
        first.level(real, rows, n, sum);
        for term in rest {
            term.level(real, rows, n, scratch);
            real.increase(sum, scratch);
        }
    }
}

impl<E: Clone> Term<E> {
    #[inline(always)]
    fn level<R: Arithmetic<Element = E>>(&self, real: &R, rows: &Rows<E>, n: usize, to: &mut E) {
        match self.part {
            Part::Row(a) => real.set(to, rows.at(a, n)),
            Part::Product(a, b) => real.convolve(to, &rows.row(a)[..=n], &rows.row(b)[..=n]),
            Part::Square(a) => square(real, to, &rows.row(a)[..=n]),
        }
        if let Some(factor) = &self.factor {
            real.scale(to, factor);
        }
    }
}

/// to = sum_j a_j a_(n-j) of n + 1 numbers.
#[inline(always)]
pub(crate) fn square<R: Arithmetic>(real: &R, to: &mut R::Element, a: &[R::Element]) {
    let half = a.len() / 2;
    real.convolve(to, &a[..half], &a[a.len() - half..]);
    real.times_integer(to, 2);
    if !a.len().is_multiple_of(2) {
        real.accumulate(to, &a[half], &a[half]);
    }
}

/// The steps of a level from 2 on; `needed`: rows that are read from outside.
pub(crate) fn steps<R: Arithmetic>(
    real: &R,
    tape: &Tape<R::Element>,
    needed: &[usize],
) -> Vec<Step<R::Element>> {
    let mut plan = Plan::new(tape, needed);
    for index in &tape.curved {
        plan.terms[*index] = plan.of(tape, *index);
    }
    let term = |signed: &Signed| {
        let factor = match (signed.factor, signed.negative) {
            (Factor::One, false) => None,
            (Factor::One, true) => Some(real.double(-1.0)),
            (Factor::Constant(c), false) => Some(tape.constants[c].clone()),
            (Factor::Constant(c), true) => Some(real.negative(&tape.constants[c])),
        };
        Term { factor, part: signed.part }
    };
    let written = |index: usize| {
        plan.kept[tape.states + index] && !matches!(tape.ops[index], Op::Delayed { .. })
    };
    let kept = tape.curved.iter().filter(|index| written(**index));
    kept.map(|index| match &plan.terms[*index] {
        None => Step::Operation(*index),
        Some(terms) => {
            let terms = terms.iter().map(term).collect();
            Step::Sum(tape.states + index, Sum { terms })
        }
    })
    .collect()
}

/// Which rows are written, and the terms of every operation that is a sum.
struct Plan {
    kept: Vec<bool>,
    terms: Vec<Option<Vec<Signed>>>,
}

impl Plan {
    /// Written are rows that are read from outside, more than once, or over all their levels.
    fn new<E>(tape: &Tape<E>, needed: &[usize]) -> Self {
        let mut readers = vec![0; tape.states + tape.ops.len()];
        let mut kept = vec![false; readers.len()];
        needed.iter().for_each(|row| kept[*row] = true);
        for index in &tape.curved {
            let op = tape.ops[*index];
            let adds = matches!(op, Op::Add(..) | Op::Subtract(..) | Op::Scale(..));
            for operand in op.operands().into_iter().flatten() {
                readers[operand] += 1;
                kept[operand] |= !adds || readers[operand] > 1;
            }
            kept[tape.states + index] |= !adds && !matches!(op, Op::Multiply(..) | Op::Square(_));
        }
        Self { kept, terms: vec![None; tape.ops.len()] }
    }

    fn of<E>(&mut self, tape: &Tape<E>, index: usize) -> Option<Vec<Signed>> {
        let single = |part| Some(vec![Signed { negative: false, factor: Factor::One, part }]);
        match tape.ops[index] {
            Op::Multiply(a, b) => single(Part::Product(a, b)),
            Op::Square(a) => single(Part::Square(a)),
            Op::Scale(a, c) => {
                let mut terms = self.operand(tape, a);
                match &mut terms[..] {
                    [] => {}
                    [Signed { factor: factor @ Factor::One, .. }] => *factor = Factor::Constant(c),
                    // c (c' u) and c (u + v) are rounded twice.
                    _ => terms = self.whole(a, Factor::Constant(c)),
                }
                Some(terms)
            }
            Op::Add(a, b) => Some(self.sum(tape, (a, b), false)),
            Op::Subtract(a, b) => Some(self.sum(tape, (a, b), true)),
            _ => None,
        }
    }

    /// a +- b: the terms of the one, then that of the other.
    fn sum<E>(&mut self, tape: &Tape<E>, (a, b): (usize, usize), minus: bool) -> Vec<Signed> {
        let (mut left, mut right) = (self.operand(tape, a), self.operand(tape, b));
        if left.len() > 1 && right.len() > 1 {
            right = self.whole(b, Factor::One);
        }
        right.iter_mut().for_each(|term| term.negative ^= minus);
        if right.len() > 1 {
            std::mem::swap(&mut left, &mut right);
        }
        left.extend(right);
        left
    }

    /// The terms of an operand: itself where it is written; none where it vanishes from level 2 on.
    fn operand<E>(&mut self, tape: &Tape<E>, row: usize) -> Vec<Signed> {
        let index = row.checked_sub(tape.states);
        if index.is_some_and(|index| tape.affine[index]) {
            return Vec::new();
        }
        let own = index.filter(|_| !self.kept[row]).and_then(|index| self.terms[index].clone());
        own.unwrap_or_else(|| self.whole(row, Factor::One))
    }

    /// The row itself, which is written then.
    fn whole(&mut self, row: usize, factor: Factor) -> Vec<Signed> {
        self.kept[row] = true;
        vec![Signed { negative: false, factor, part: Part::Row(row) }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::real::Doubles;
    use crate::quantity::{Parameters, Quantity};
    use crate::system::{Model, System};
    use crate::tape::Moment;
    use lindstedt_equation::{Expression, Function};

    /// Sums of squares, products, multiples of sums, nested differences, quotients, roots, signs: every level of every
    /// written row is that of the operations, from arbitrary levels of the states.
    #[test]
    fn levels_are_those_of_the_operations() {
        let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
        let number = |n: i64, d: i64| Expression::Number((n, d).into());
        let apply = |e: &Expression, f| e.clone().apply(f);
        let wave = apply(&(number(7, 5) * Expression::Time), Function::Cos);
        let slip = v.clone() - number(2, 5);
        let cubic = x.clone() * x.clone() * x.clone() - number(1, 3) * slip.clone() * slip.clone();
        let nested = (x.clone() - number(3, 1) * (v.clone() + x.clone() * v.clone())) - cubic;
        let root = (number(2, 1) + x.clone() * x.clone()).pow(-1) * v.clone();
        let force = nested.clone()
            + number(-5, 7) * (nested * wave.clone() - x.clone())
            + apply(&slip, Function::Sign) * number(3, 10)
            + apply(&x, Function::Exp) * number(1, 9)
            - root;
        let model = Model::first_order(&[], &[v, force - wave]).unwrap().linearised();
        let parameters = Parameters::new().with("a", Quantity::from(1));
        let system = model.compile(Doubles, &parameters).unwrap();
        let (tape, sums) = (&system.tape, compared(&system));
        // The work of a level: steps in place of operations.
        assert_eq!((tape.curved.len(), tape.steps.len(), sums), (104, 35, 26));
    }

    /// The number of sums, after every level of every written row has been compared with that of the operations, from
    /// arbitrary levels of the states.
    fn compared(system: &System<Doubles>) -> usize {
        let tape = &system.tape;
        let random = |k: usize| ((k * 7919 % 1013) as f64 - 506.0) / 700.0;
        let mut rows = Rows::new(tape.rows(), 24, &0.0);
        for state in 0..tape.states {
            rows.row_mut(state)
                .iter_mut()
                .enumerate()
                .for_each(|(n, c)| *c = random(24 * state + n));
        }
        let (mut other, modes) = (rows.clone(), vec![1; system.switches.len()]);
        let (mut sum, mut scratch) = (0.0, 0.0);
        for n in 0..24 {
            let (sum, scratch) = (&mut sum, &mut scratch);
            let mut moment = Moment { time: &0.7, modes: &modes, sum, scratch };
            tape.level(&Doubles, &mut rows, n, &mut moment);
            for index in &tape.live {
                tape.operation(&Doubles, &mut other, *index, n, &mut moment);
            }
        }
        // The bits; a zero may have another sign.
        let bits = |row: &[f64]| row.iter().map(|c| (c + 0.0).to_bits()).collect::<Vec<_>>();
        let mut sums = 0;
        for step in &tape.steps {
            let row = step.row(tape.states);
            sums += usize::from(matches!(step, Step::Sum(..)));
            assert_eq!(bits(rows.row(row)), bits(other.row(row)), "row {row}");
        }
        for row in &system.right_sides {
            assert_eq!(bits(rows.row(*row)), bits(other.row(*row)));
        }
        sums
    }

    /// Four hundred random right sides, half of them with their linearisation: sums, differences, multiples, products
    /// and squares of what came before, so that much is read more than once, and of functions of it.
    #[test]
    fn random_tapes_are_their_operations() {
        // A linear congruential generator (Knuth, MMIX).
        let mut state = 1u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as usize % n
        };
        let (mut sums, mut terms) = (0, 0);
        for sample in 0..400 {
            let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
            let mut known = vec![x, v.clone(), Expression::Time];
            for _ in 0..9 {
                let (a, b) = (known[below(known.len())].clone(), known[below(known.len())].clone());
                let q = Expression::Number((below(9) as i64 - 4, below(5) as i64 + 1).into());
                known.push(match below(10) {
                    0 | 1 => a + b,
                    2 | 3 => a - b,
                    4 => q * a,
                    5 => a + q * b,
                    6 | 7 => a * b,
                    8 => a.clone() * a,
                    _ if below(2) == 0 => (q * a).apply(Function::Sin),
                    _ => (a.clone() * a + Expression::Number(2.into())).pow(-1) * b,
                });
            }
            let force = known.split_off(known.len() - 3).into_iter().reduce(|a, b| a - b);
            let mut model = Model::first_order(&[], &[v, force.unwrap()]).unwrap();
            if sample % 2 == 0 {
                model = model.linearised();
            }
            let system = model.compile(Doubles, &Parameters::new()).unwrap();
            sums += compared(&system);
            let longest = system.tape.steps.iter().map(|step| match step {
                Step::Sum(_, sum) => sum.terms.len(),
                Step::Operation(_) => 0,
            });
            terms = terms.max(longest.max().unwrap_or(0));
        }
        assert!(sums > 2000 && terms > 4, "{sums} sums of up to {terms} terms");
    }
}
