//! The solution on one side of a branch point as series in fractional powers of the distance.

use crate::integrator::real::Real;
use crate::puiseux::{Lattice, Terms};
use crate::system::System;
use crate::tape::{Op, horner};

/// The states at a branch point and the series of all rows on one side of it.
#[derive(Clone, Debug)]
pub(crate) struct Local<R: Real> {
    pub(crate) lattice: Lattice<R>,
    pub(crate) states: Vec<Terms<R::Element>>,
    pub(crate) rows: Vec<Terms<R::Element>>,
    /// +1: after the branch point, -1: before it.
    pub(crate) side: i8,
    /// What was left of the argument of the switch at the branch point, where it should vanish.
    pub(crate) offset: R::Element,
    switch: usize,
    /// The signs of all switches on this side.
    modes: Vec<i8>,
}

/// What is reported of a series: the values at the branch point, and the changes from there.
#[derive(Clone, Debug)]
pub(crate) struct Piece<R: Real> {
    lattice: Lattice<R>,
    states: Vec<Terms<R::Element>>,
    start: Vec<R::Element>,
    /// Where in the segment the branch point is.
    at: R::Element,
}

impl<R: Real> Piece<R> {
    pub(crate) fn value(&self, state: usize, s: &R::Element) -> Option<R::Element> {
        let real = &self.lattice.real;
        let d = real.absolute(&real.difference(s, &self.at));
        let change = self.lattice.change(self.states.get(state)?, &d);
        Some(real.sum(self.start.get(state)?, &change))
    }
}

/// A piece of the solution, as it is kept: Taylor coefficients, `stride` per state, or such series.
#[derive(Clone, Debug)]
pub(crate) enum Shape<R: Real> {
    Taylor { coefficients: Vec<R::Element>, stride: usize },
    Local(Box<Piece<R>>),
}

/// The same, borrowed.
#[derive(Debug)]
pub(crate) enum ShapeRef<'a, R: Real> {
    Taylor { coefficients: &'a [R::Element], stride: usize },
    Local(&'a Piece<R>),
}

impl<R: Real> Clone for ShapeRef<'_, R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R: Real> Copy for ShapeRef<'_, R> {}

impl<'a, R: Real> ShapeRef<'a, R> {
    pub(crate) fn taylor(self, state: usize) -> Option<&'a [R::Element]> {
        match self {
            Self::Taylor { coefficients, stride } => coefficients.chunks_exact(stride).nth(state),
            Self::Local(_) => None,
        }
    }

    pub(crate) fn value(self, real: &R, state: usize, s: &R::Element) -> Option<R::Element> {
        match self {
            Self::Taylor { .. } => {
                let mut value = real.zero();
                horner(real, &mut value, self.taylor(state)?, s);
                Some(value)
            }
            Self::Local(piece) => piece.value(state, s),
        }
    }

    pub(crate) fn keep(self) -> Shape<R> {
        match self {
            Self::Taylor { coefficients, stride } => {
                Shape::Taylor { coefficients: coefficients.to_vec(), stride }
            }
            Self::Local(piece) => Shape::Local(Box::new(piece.clone())),
        }
    }
}

impl<R: Real> Shape<R> {
    pub(crate) fn borrow(&self) -> ShapeRef<'_, R> {
        match self {
            Self::Taylor { coefficients, stride } => {
                ShapeRef::Taylor { coefficients, stride: *stride }
            }
            Self::Local(piece) => ShapeRef::Local(piece),
        }
    }
}

impl<R: Real> Local<R> {
    /// Straight lines with the given rates at the branch point of a switch.
    pub(crate) fn new(
        system: &System<R>,
        lattice: Lattice<R>,
        (switch, side, modes): (usize, i8, Vec<i8>),
        rates: &[R::Element],
    ) -> Self {
        let one = lattice.integer(1);
        let states = rates.iter().map(|rate| {
            let mut rate = rate.clone();
            lattice.real.times_integer(&mut rate, i32::from(side));
            let mut terms = Terms::new();
            lattice.put(&mut terms, one, &rate);
            terms
        });
        let states = states.collect();
        let rows = vec![Terms::new(); system.tape.rows()];
        let offset = lattice.real.zero();
        Self { lattice, states, rows, side, offset, switch, modes }
    }

    /// The terms of the longest row.
    pub(crate) fn longest(&self) -> usize {
        self.rows.iter().map(Terms::len).max().unwrap_or(0)
    }

    /// Products of coefficients in one sweep, to an order of magnitude.
    pub(crate) fn work(&self) -> u64 {
        self.rows.iter().map(|row| (row.len() as u64).pow(2)).sum()
    }

    /// The power p of the |w|^p of a switch (the first one).
    pub(crate) fn exponent(system: &System<R>, switch: usize) -> Option<&R::Element> {
        let modulus = |row: usize| {
            let op = row.checked_sub(system.tape.states).map(|index| system.tape.ops[index]);
            matches!(op, Some(Op::Signed(_, s)) if s == switch)
        };
        let power = |op: &Op| match *op {
            Op::Power(row, p) if modulus(row) => system.tape.constants.get(p),
            _ => None,
        };
        system.tape.ops.iter().find_map(power)
    }

    /// One step of Picard's iteration: the right sides along the series, integrated. `start`: the
    /// states at the branch point, `time`: when. Nothing where the right sides have no such series.
    pub(crate) fn sweep(
        &mut self,
        system: &System<R>,
        start: &[R::Element],
        time: &R::Element,
    ) -> Option<()> {
        let n = system.tape.states;
        let zero = self.lattice.integer(0);
        for (state, value) in start.iter().enumerate() {
            let mut row = self.states[state].clone();
            self.lattice.put(&mut row, zero, value);
            self.rows[state] = row;
        }
        let surface = system.switches[self.switch].row;
        if surface < n {
            self.offset = start[surface].clone();
            self.rows[surface].remove(&zero);
        }
        for index in &system.tape.live {
            let mut row = self.operation(system, *index, time)?;
            if n + index == surface {
                self.offset = row.remove(&zero).unwrap_or_else(|| self.lattice.real.zero());
            }
            self.rows[n + index] = row;
        }
        let side = self.lattice.real.double(f64::from(self.side));
        for (state, right) in system.right_sides.iter().enumerate() {
            let rate = self.lattice.scale(&self.rows[*right], &side);
            self.states[state] = self.lattice.integral(&rate)?;
        }
        Some(())
    }

    fn operation(
        &self,
        system: &System<R>,
        index: usize,
        time: &R::Element,
    ) -> Option<Terms<R::Element>> {
        let (lattice, real) = (&self.lattice, &self.lattice.real);
        let row = |r: usize| &self.rows[r];
        let constant = |c: usize| system.tape.constants.get(c);
        let sign = |switch: usize| self.modes.get(switch).copied().filter(|mode| mode.abs() == 1);
        Some(match system.tape.ops[index] {
            Op::Constant(c) => lattice.constant(constant(c)?),
            Op::Time => {
                let mut terms = lattice.constant(time);
                let side = real.double(f64::from(self.side));
                lattice.put(&mut terms, lattice.integer(1), &side);
                terms
            }
            Op::Delayed { .. } => return None,
            Op::Add(a, b) => lattice.sum(row(a), row(b), 1),
            Op::Subtract(a, b) => lattice.sum(row(a), row(b), -1),
            Op::Scale(a, c) => lattice.scale(row(a), constant(c)?),
            Op::Multiply(a, b) => lattice.product(row(a), row(b)),
            Op::Square(a) => lattice.product(row(a), row(a)),
            Op::Divide(a, _) if row(a).is_empty() => Terms::new(),
            Op::Divide(a, b) => lattice.quotient(row(a), row(b))?,
            Op::Power(a, p) => lattice.power(row(a), constant(p)?)?,
            Op::Exp(a) => lattice.exp(row(a))?,
            Op::Ln(a) => lattice.ln(row(a))?,
            Op::Sin { argument, .. } => {
                let [sine, _] = lattice.sine(row(argument))?;
                sine
            }
            Op::Cos { argument, .. } => {
                let [_, cosine] = lattice.sine(row(argument))?;
                cosine
            }
            Op::Signed(a, switch) => lattice.scale(row(a), &real.double(f64::from(sign(switch)?))),
            Op::Control { switch, part: 0 } => {
                lattice.constant(&real.double(f64::from(sign(switch)?)))
            }
            Op::Control { switch, .. } => {
                sign(switch)?;
                Terms::new()
            }
        })
    }

    /// d(argument of the switch)/d(distance) at the branch point; nothing if it does not begin
    /// with its first power.
    pub(crate) fn slope(&self, system: &System<R>) -> Option<R::Element> {
        let (exponent, slope) = self.rows[system.switches[self.switch].row].first_key_value()?;
        (*exponent == self.lattice.integer(1)).then(|| slope.clone())
    }

    /// The states at a distance.
    pub(crate) fn states(&self, start: &[R::Element], d: &R::Element) -> Vec<R::Element> {
        let real = &self.lattice.real;
        let pairs = self.states.iter().zip(start);
        pairs.map(|(terms, at)| real.sum(at, &self.lattice.change(terms, d))).collect()
    }

    /// Whether the terms just below the cut are below the tolerance at a distance, relative to the
    /// largest state of their group (the flow, the linearisation).
    pub(crate) fn ends(
        &self,
        system: &System<R>,
        start: &[R::Element],
        d: &R::Element,
        (band, log2_tolerance): ((f64, f64), f64),
    ) -> bool {
        let (real, n) = (&self.lattice.real, system.variables);
        [0..n, n..system.tape.states].into_iter().all(|group| {
            let mut scale = f64::NEG_INFINITY;
            for k in group.clone() {
                let largest = self.lattice.size(&self.states[k], d, (0.0, f64::INFINITY));
                scale = scale.max(real.log2(&start[k])).max(largest);
            }
            group.into_iter().all(|k| {
                let tail = self.lattice.size(&self.states[k], d, band);
                tail == f64::NEG_INFINITY || tail <= scale + log2_tolerance
            })
        })
    }

    /// Whether a row has no zero up to a distance: its constant outweighs all other terms.
    pub(crate) fn keeps_its_sign(&self, row: usize, d: &R::Element) -> bool {
        let real = &self.lattice.real;
        let constant = self.rows[row].get(&self.lattice.integer(0));
        let size = self.lattice.size(&self.rows[row], d, (f64::NEG_INFINITY, f64::INFINITY));
        constant.is_some_and(|c| real.log2(c) > size)
    }

    /// The value of a row at a distance.
    pub(crate) fn row(&self, row: usize, d: &R::Element) -> R::Element {
        let constant = self.rows[row].get(&self.lattice.integer(0));
        let change = self.lattice.change(&self.rows[row], d);
        constant.map_or_else(|| change.clone(), |c| self.lattice.real.sum(c, &change))
    }

    pub(crate) fn piece(&self, start: &[R::Element], at: R::Element) -> Piece<R> {
        let (lattice, states) = (self.lattice.clone(), self.states.clone());
        Piece { lattice, states, start: start.to_vec(), at }
    }
}
