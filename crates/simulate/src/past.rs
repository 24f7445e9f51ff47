//! The method of steps: the solution so far as Taylor polynomials, re-expanded where a delayed
//! term needs it.
//!
//! A delayed row is the polynomial of the piece that holds t - T, shifted to t - T, so the
//! recurrences of the step are exact, and the step ends where the piece ends: every breakpoint
//! t_i + m T (t_i an impact, a switching, the start) is the end of a step. Two neighbouring
//! pieces whose polynomials agree to the tolerance over one of them are read as one; this merges
//! slivers and breakpoints that the delay has smoothed.

use crate::integrator::real::Real;
use crate::series::log2_step;
use crate::system::System;
use crate::tape::{Moment, Op, Rows};
use std::collections::VecDeque;

/// A time as an unevaluated sum: in f64 a thousand impacts lose no digits.
#[derive(Clone, Debug)]
pub(crate) struct Clock<E> {
    pub(crate) high: E,
    pub(crate) low: E,
}

impl<E: Clone + PartialOrd> Clock<E> {
    pub(crate) fn new<R: Real<Element = E>>(real: &R, time: &E) -> Self {
        Self { high: time.clone(), low: real.zero() }
    }

    /// Adds s (Knuth's two-sum).
    pub(crate) fn advance<R: Real<Element = E>>(&mut self, real: &R, s: &E) {
        let total = real.sum(&self.high, s);
        let part = real.difference(&total, &self.high);
        let lost = real.difference(&self.high, &real.difference(&total, &part));
        let rest = real.sum(&lost, &real.difference(s, &part));
        let low = real.sum(&self.low, &rest);
        self.high = real.sum(&total, &low);
        self.low = real.difference(&low, &real.difference(&self.high, &total));
    }

    /// self - other.
    pub(crate) fn since<R: Real<Element = E>>(&self, real: &R, other: &Self) -> E {
        let high = real.difference(&self.high, &other.high);
        real.sum(&high, &real.difference(&self.low, &other.low))
    }
}

#[derive(Clone, Debug)]
struct Piece<E> {
    start: Clock<E>,
    length: E,
    /// How far its polynomial holds, before the start and beyond the end.
    before: E,
    beyond: E,
    coefficients: Vec<E>,
}

/// The solution so far.
#[derive(Clone, Debug)]
pub(crate) struct Past<R: Real> {
    start: Clock<R::Element>,
    pieces: VecDeque<Piece<R::Element>>,
    history: Rows<R::Element>,
    longest: R::Element,
    shifted: Vec<R::Element>,
}

impl<R: Real> Past<R> {
    pub(crate) fn new(system: &System<R>, start: &Clock<R::Element>, order: usize) -> Self {
        let real = &system.real;
        let mut longest = real.zero();
        for delay in &system.delays {
            if *delay > longest {
                longest = delay.clone();
            }
        }
        let rows = system.history.as_ref().map_or(0, |history| history.tape.rows());
        Self {
            start: start.clone(),
            pieces: VecDeque::new(),
            history: Rows::new(rows, order + 2, &real.zero()),
            longest,
            shifted: Vec::new(),
        }
    }

    /// Fills the delayed rows at `now`; returns how long they hold.
    pub(crate) fn fill(
        &mut self,
        system: &System<R>,
        now: &Clock<R::Element>,
        rows: &mut Rows<R::Element>,
        log2_tolerance: f64,
    ) -> Option<R::Element> {
        let real = &system.real;
        let mut limit: Option<R::Element> = None;
        for delay in 0..system.delays.len() {
            let mut then = now.clone();
            then.advance(real, &real.negative(&system.delays[delay]));
            let before = self.start.since(real, &then);
            // Breakpoints are met to rounding errors; within them the later piece counts.
            let mut slack = real.absolute(&now.high);
            real.increase(&mut slack, &self.longest);
            real.scale(&mut slack, &real.double((8.0 - f64::from(real.bits())).exp2()));
            let length = if before > slack {
                let own = self.fill_history(system, delay, &then, rows, log2_tolerance)?;
                if own < before { own } else { before }
            } else {
                self.fill_piece(system, delay, &then, rows, &slack)?
            };
            if limit.as_ref().is_none_or(|limit| length < *limit) {
                limit = Some(length);
            }
        }
        limit
    }

    fn fill_history(
        &mut self,
        system: &System<R>,
        delay: usize,
        then: &Clock<R::Element>,
        rows: &mut Rows<R::Element>,
        log2_tolerance: f64,
    ) -> Option<R::Element> {
        let (real, history) = (&system.real, system.history.as_ref()?);
        let order = rows.stride - 1;
        let (mut sum, mut scratch) = (real.zero(), real.zero());
        let (sum, scratch) = (&mut sum, &mut scratch);
        let mut moment = Moment { time: &then.high, modes: &[], sum, scratch };
        for n in 0..=order + 1 {
            history.tape.level(real, &mut self.history, n, &mut moment);
        }
        let norm = |level| {
            let logs = history.rows.iter().map(|row| real.log2(self.history.at(*row, level)));
            logs.fold(f64::NEG_INFINITY, |a, b| if b.is_nan() { b } else { a.max(b) })
        };
        let log = log2_step(order + 1, log2_tolerance, [0, 1, 2].map(norm), norm)?;
        for (index, op) in system.tape.ops.iter().enumerate() {
            let Op::Delayed { state, delay: d } = *op else { continue };
            if d != delay {
                continue;
            }
            let derived = history.derived && state == 1;
            let source = history.rows[if derived { 0 } else { state }];
            for n in 0..=order {
                let mut value = self.history.at(source, n + usize::from(derived)).clone();
                if derived {
                    real.times_integer(&mut value, n as i32 + 1);
                }
                *rows.at_mut(system.tape.states + index, n) = value;
            }
        }
        Some(real.double(log.min(1000.0).exp2()))
    }

    fn fill_piece(
        &mut self,
        system: &System<R>,
        delay: usize,
        then: &Clock<R::Element>,
        rows: &mut Rows<R::Element>,
        slack: &R::Element,
    ) -> Option<R::Element> {
        let (real, stride) = (&system.real, rows.stride);
        let after = |piece: &Piece<R::Element>| {
            let offset = then.since(real, &piece.start);
            let rest = real.difference(&piece.length, &offset);
            (offset, rest)
        };
        let index = self.pieces.partition_point(|piece| after(piece).1 <= *slack);
        // The piece itself, or its successor if that holds here already and lasts longer.
        let mut best: Option<(usize, R::Element, R::Element)> = None;
        for candidate in index..(index + 2).min(self.pieces.len()) {
            let piece = &self.pieces[candidate];
            let (offset, rest) = after(piece);
            let earliest = real.negative(&real.sum(&piece.before, slack));
            let rest = real.sum(&rest, &piece.beyond);
            let longer = best.as_ref().is_none_or(|(_, _, known)| rest > *known);
            if offset >= earliest && longer {
                best = Some((candidate, offset, rest));
            }
        }
        let (index, offset, rest) = best?;
        let piece = &self.pieces[index];
        for (position, op) in system.tape.ops.iter().enumerate() {
            let Op::Delayed { state, delay: d } = *op else { continue };
            if d == delay {
                let source = &piece.coefficients[state * stride..(state + 1) * stride];
                let row = rows.row_mut(system.tape.states + position);
                for (to, from) in row.iter_mut().zip(source) {
                    real.set(to, from);
                }
                shift(real, row, &offset);
            }
        }
        Some(rest)
    }

    /// Adds the piece [now, now + length] with the coefficients in `rows`; `smooth`: no state
    /// jumps at its start.
    pub(crate) fn push(
        &mut self,
        system: &System<R>,
        now: &Clock<R::Element>,
        rows: &Rows<R::Element>,
        length: &R::Element,
        (smooth, log2_tolerance): (bool, f64),
    ) {
        let (real, stride) = (&system.real, rows.stride);
        while let Some(first) = self.pieces.front() {
            let age = real.difference(&now.since(real, &first.start), &first.length);
            // One piece more than needed: successors reach back.
            let twice = real.sum(&self.longest, &self.longest);
            if age > twice && self.pieces.len() > 4 {
                self.pieces.pop_front();
            } else {
                break;
            }
        }
        let coefficients = rows.data[..system.variables * stride].to_vec();
        let (before, beyond) = (real.zero(), real.zero());
        let start = now.clone();
        let mut piece = Piece { start, length: length.clone(), before, beyond, coefficients };
        if let Some(last) = self.pieces.back_mut().filter(|_| smooth) {
            // The difference of the two polynomials about the common point.
            let (mut ahead, mut back) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            let mut scale = f64::NEG_INFINITY;
            let logs = (real.log2(length), real.log2(&last.length));
            for state in 0..system.variables {
                let range = state * stride..(state + 1) * stride;
                self.shifted.clear();
                self.shifted.extend_from_slice(&last.coefficients[range.clone()]);
                shift(real, &mut self.shifted, &last.length);
                for (k, (a, b)) in self.shifted.iter().zip(&piece.coefficients[range]).enumerate() {
                    let size = real.log2(&real.difference(a, b));
                    let power = k as f64;
                    // 0 * infinity has no place here: lengths are finite and positive.
                    ahead = ahead.max(size + power * logs.0);
                    back = back.max(size + power * logs.1);
                    if k == 0 {
                        scale = scale.max(real.log2(b));
                    }
                }
            }
            let tolerance = log2_tolerance.max(6.0 - f64::from(real.bits())) + scale;
            if ahead <= tolerance {
                last.beyond = length.clone();
            }
            if back <= tolerance {
                piece.before = last.length.clone();
            }
        }
        self.pieces.push_back(piece);
    }
}

/// The coefficients of c(s + offset).
fn shift<R: Real>(real: &R, c: &mut [R::Element], offset: &R::Element) {
    if real.sign(offset) == 0 {
        return;
    }
    for i in 0..c.len().saturating_sub(1) {
        for k in (i..c.len() - 1).rev() {
            let (low, high) = c.split_at_mut(k + 1);
            real.accumulate(&mut low[k], &high[0], offset);
        }
    }
}
