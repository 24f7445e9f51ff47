//! Across a branch point |w|^p, w = 0, on its series in fractional powers.
//!
//! With the states y_c at the branch point, at the distance T ahead, the solution before it is
//! y_c + D(d), d the distance in time, D a series without constant (`local`): the states now give
//! y_c = y - D(T) and w(y_c) = 0 gives T. Both are iterated together with Picard's iteration for D,
//! which converges like the influence of the terms in |w| over the time T. It is tried when they
//! and everything else change the states by less than 10^(-digits/12) in T, so that some 15 terms
//! of the series suffice, or, where T would come near to the rounding errors of the time, by less
//! than an eighth.

use crate::branch::Branch;
use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Observer};
use crate::local::{Local, Piece, ShapeRef};
use crate::past::Clock;
use crate::puiseux::{Lattice, MOST_TERMS};
use crate::report::{Event, EventKind, Report, Segment};
use crate::system::System;
use std::ops::ControlFlow;

/// Exponents between which terms count as the tail.
type Band = (f64, f64);

/// The series on both sides of a branch point.
struct Crossing<R: Real> {
    /// Before it, with the time from now to it; nothing if it is here.
    before: Option<(Local<R>, R::Element)>,
    after: Local<R>,
    /// How long the series after it is used.
    length: R::Element,
    /// The states at the branch point.
    start: Vec<R::Element>,
    clock: Clock<R::Element>,
    direction: i8,
}

/// Looks for sign changes of a section per side.
const LOOKS: u32 = 16;
/// Products of coefficients that one crossing may take: some ten seconds.
const MOST_WORK: u64 = 100_000_000;

/// Why a series was not finished.
enum Halt {
    /// The observer broke it off.
    Stopped,
    /// It has so many terms that it takes too long.
    Dense(usize),
}

/// Picard's iteration for one crossing: the work so far, and who is asked whether to go on.
struct Iteration<'a, 'o, R: Real> {
    work: u64,
    observer: &'a mut Observer<'o, R>,
}

impl<R: Real> Iteration<'_, '_, R> {
    /// One step; whether the right sides have such series.
    fn sweep(
        &mut self,
        local: &mut Local<R>,
        system: &System<R>,
        start: &[R::Element],
        time: &R::Element,
    ) -> Result<bool, Halt> {
        if (self.observer)(&Report::Busy).is_break() {
            return Err(Halt::Stopped);
        }
        let exists = local.sweep(system, start, time).is_some();
        self.work += local.work();
        let terms = local.longest();
        if local.lattice.is_dense() {
            return Err(Halt::Dense(MOST_TERMS));
        }
        if terms > MOST_TERMS || self.work > MOST_WORK {
            Err(Halt::Dense(terms))
        } else {
            Ok(exists)
        }
    }
}

impl<R: Real> Integrator<'_, R> {
    /// Crosses the branch point, if its series converges; nothing otherwise.
    pub(crate) fn cross(
        &mut self,
        branch: &Branch<R::Element>,
        remaining: &R::Element,
        observer: &mut Observer<'_, R>,
    ) -> Result<Option<ControlFlow<()>>, SimulateError> {
        let system = self.system;
        let (real, index) = (&system.real, branch.switch);
        let smooth = self.phase.modes.iter().all(|mode| mode.abs() == 1);
        let Some(power) = Local::exponent(system, index).cloned() else { return Ok(None) };
        if self.past.is_some() || self.phase.contact.is_some() || !smooth {
            return Ok(None);
        }
        let near = self.log2_tolerance / 12.0;
        let here = real.sign(&branch.after) == 0;
        let (rates, duration) = if here {
            (self.rates_without(index)?, near)
        } else {
            let influence = self.influence(index, &branch.after)?;
            let worst = influence.change.max(influence.duration);
            let time = real.log2(&self.clock.high).max(real.log2(&branch.after));
            let last = real.log2(&branch.after) <= time + self.log2_tolerance / 3.0;
            if !(worst <= near || last && worst <= -3.0) || influence.change.is_nan() {
                return Ok(None);
            }
            (influence.rates, influence.duration.max(-1e3))
        };
        // The powers that the terms in |w| add to a state are between p + 1 and p + 2 apart.
        let spacing = real.to_f64(&power) + 2.0;
        for stretch in [1.1, 2.0, 4.0] {
            let cut = stretch * self.log2_tolerance / duration.min(-3.0) + 2.0 + 1.5 * spacing;
            let band = (cut - 1.5 * spacing, cut);
            let beyond = cut + 3.0 + spacing.abs();
            let Some(lattice) = Lattice::new(real, &power, beyond) else { return Ok(None) };
            let mut iteration = Iteration { work: 0, observer };
            let found = if here {
                self.depart_from(index, lattice, (&rates, band), &mut iteration)
            } else {
                self.meet((index, &branch.after), lattice, (&rates, band), &mut iteration)
            };
            match found {
                Ok(None) => {}
                Ok(Some(crossing)) => {
                    return Ok(Some(self.carry_out(index, &crossing, remaining, observer)));
                }
                Err(Halt::Stopped) => {
                    self.expand()?;
                    return Ok(Some(ControlFlow::Break(())));
                }
                Err(Halt::Dense(terms)) => {
                    let time = self.seconds();
                    return Err(SimulateError::DenseBranchPoint { switch: index, time, terms });
                }
            }
        }
        Ok(None)
    }

    /// The series before and after a branch point ahead.
    fn meet(
        &self,
        (index, after): (usize, &R::Element),
        lattice: Lattice<R>,
        (rates, band): (&[R::Element], Band),
        iteration: &mut Iteration<'_, '_, R>,
    ) -> Result<Option<Crossing<R>>, Halt> {
        let system = self.system;
        let real = &system.real;
        let mode = self.phase.modes[index];
        let mut before = Local::new(system, lattice, (index, -1, self.phase.modes.clone()), rates);
        let back = |local: &Local<R>, length: &R::Element| -> Vec<R::Element> {
            let changes = local.states.iter().map(|terms| local.lattice.change(terms, length));
            self.state
                .iter()
                .zip(changes)
                .map(|(now, change)| real.difference(now, &change))
                .collect()
        };
        let mut length = after.clone();
        let mut start = back(&before, &length);
        let (mut settled, rounding) = (0, 4.0 - f64::from(real.bits()));
        let at = |length: &R::Element| {
            let mut clock = self.clock.clone();
            clock.advance(real, length);
            clock
        };
        for _ in 0..64 + real.bits() {
            if !iteration.sweep(&mut before, system, &start, &at(&length).high)? {
                return Ok(None);
            }
            let Some(slope) = before.slope(system) else { return Ok(None) };
            let shift = real.quotient(&before.offset, &slope);
            real.increase(&mut length, &shift);
            if real.sign(&slope) != mode || real.sign(&length) <= 0 {
                return Ok(None);
            }
            let next = back(&before, &length);
            let scale = start.iter().map(|x| real.log2(x)).fold(f64::NEG_INFINITY, f64::max);
            let moved = start.iter().zip(&next).map(|(a, b)| real.log2(&real.difference(a, b)));
            let moved = moved.fold(f64::NEG_INFINITY, |a, b| if b.is_nan() { b } else { a.max(b) });
            let still = moved <= scale + rounding
                && real.log2(&shift) <= real.log2(&length) + rounding + 4.0;
            start = next;
            settled = if still { settled + 1 } else { 0 };
            if settled == 3 {
                break;
            }
        }
        let ends = before.ends(system, &start, &length, (band, self.log2_tolerance));
        if settled < 3 || !ends || !self.alone(index, &before, &length) {
            return Ok(None);
        }
        if let Some(w) = start.get_mut(system.switches[index].row) {
            real.set_zero(w);
        }
        let one = before.lattice.integer(1);
        let rates: Vec<R::Element> = (before.states.iter())
            .map(|terms| terms.get(&one).map_or_else(|| real.zero(), |c| real.negative(c)))
            .collect();
        let clock = at(&length);
        let lattice = before.lattice.clone();
        let after = self.leave((index, -mode), lattice, (&start, &rates), &clock, iteration)?;
        let Some(after) = after else { return Ok(None) };
        let ends = after.ends(system, &start, &length, (band, self.log2_tolerance));
        let ends = ends && self.alone(index, &after, &length);
        let before = Some((before, length.clone()));
        Ok(ends.then_some(Crossing { before, after, length, start, clock, direction: -mode }))
    }

    /// The series after a branch point that is here.
    fn depart_from(
        &self,
        index: usize,
        lattice: Lattice<R>,
        (rates, band): (&[R::Element], Band),
        iteration: &mut Iteration<'_, '_, R>,
    ) -> Result<Option<Crossing<R>>, Halt> {
        let system = self.system;
        let real = &system.real;
        let direction = real.sign(self.series.rows.at(system.switches[index].row, 1));
        let (start, clock) = (self.state.clone(), self.clock.clone());
        let after = self.leave((index, direction), lattice, (&start, rates), &clock, iteration)?;
        let Some(after) = after else { return Ok(None) };
        let mut length = real.double(1.0);
        for _ in 0..4 * real.bits() {
            if after.ends(system, &start, &length, (band, self.log2_tolerance))
                && self.alone(index, &after, &length)
            {
                let crossing = Crossing { before: None, after, length, start, clock, direction };
                return Ok(Some(crossing));
            }
            real.scale(&mut length, &real.double(0.25));
        }
        Ok(None)
    }

    /// The series after a branch point where w grows into `direction`.
    fn leave(
        &self,
        (index, direction): (usize, i8),
        lattice: Lattice<R>,
        (start, rates): (&[R::Element], &[R::Element]),
        clock: &Clock<R::Element>,
        iteration: &mut Iteration<'_, '_, R>,
    ) -> Result<Option<Local<R>>, Halt> {
        let system = self.system;
        let mut modes = self.phase.modes.clone();
        modes[index] = direction;
        let mut after = Local::new(system, lattice, (index, 1, modes), rates);
        for _ in 0..64 + system.real.bits() {
            let known = after.states.clone();
            if !iteration.sweep(&mut after, system, start, &clock.high)? {
                return Ok(None);
            }
            let Some(slope) = after.slope(system) else { return Ok(None) };
            if system.real.sign(&slope) != direction {
                return Ok(None);
            }
            // Every coefficient follows from those before it, so they settle to the last bit.
            if after.states == known {
                return Ok(Some(after));
            }
        }
        Ok(None)
    }

    /// Whether no wall and no other switch is met.
    fn alone(&self, index: usize, local: &Local<R>, length: &R::Element) -> bool {
        let walls = self.system.walls.iter().map(|wall| wall.row);
        let others = self.system.switches.iter().enumerate().filter(|(other, _)| *other != index);
        let mut rows = walls.chain(others.map(|(_, switch)| switch.row));
        rows.all(|row| local.keeps_its_sign(row, length))
    }

    /// Moves over the branch point, or as far as there is time.
    fn carry_out(
        &mut self,
        index: usize,
        crossing: &Crossing<R>,
        remaining: &R::Element,
        observer: &mut Observer<'_, R>,
    ) -> ControlFlow<()> {
        let system = self.system;
        let real = &system.real;
        let mut told = ControlFlow::Continue(());
        let mut keep = |answer: ControlFlow<()>| {
            if answer.is_break() {
                told = ControlFlow::Break(());
            }
        };
        let Crossing { after, start, clock, .. } = crossing;
        let begin = self.clock.clone();
        let mut left = remaining.clone();
        if let Some((before, length)) = &crossing.before {
            let part = if *length < *remaining { length } else { remaining };
            let nearest = real.difference(length, part);
            let piece = before.piece(start, length.clone());
            keep(self.pass((before, &piece), (part, length, &nearest), clock, start, observer));
            left = real.difference(remaining, part);
            self.state = before.states(start, &nearest);
            self.clock.advance(real, part);
            if *length <= *remaining {
                self.state.clone_from(start);
                self.clock = clock.clone();
                self.before.clone_from(start);
                let from = self.phase.modes[index];
                self.phase.modes[index] = crossing.direction;
                let kind = EventKind::Switching { switch: index, from, to: crossing.direction };
                keep(self.tell(kind, f64::NEG_INFINITY, observer));
            }
        } else {
            self.phase.modes[index] = crossing.direction;
        }
        if real.sign(&left) > 0 {
            let part = if crossing.length < left { &crossing.length } else { &left };
            let piece = after.piece(start, real.zero());
            keep(self.pass((after, &piece), (part, &real.zero(), part), clock, start, observer));
            self.state = after.states(start, part);
            // The end is met exactly: one sum from the beginning.
            let whole = match &crossing.before {
                _ if *part == left => remaining.clone(),
                Some((_, length)) => real.sum(length, part),
                None => part.clone(),
            };
            self.clock = begin;
            self.clock.advance(real, &whole);
        }
        self.work.steps += 1;
        self.vanishing.iter_mut().for_each(|skip| *skip = 0);
        told
    }

    /// Reports one side and the crossings of sections in it: `length` long, from the distance
    /// `far` to `near` of the branch point.
    fn pass(
        &mut self,
        (local, piece): (&Local<R>, &Piece<R>),
        (length, from, to): (&R::Element, &R::Element, &R::Element),
        clock: &Clock<R::Element>,
        start: &[R::Element],
        observer: &mut Observer<'_, R>,
    ) -> ControlFlow<()> {
        let system = self.system;
        let real = &system.real;
        let segment = Segment {
            real,
            start: &self.clock.high,
            length,
            modes: &self.phase.modes,
            contact: None,
            shape: ShapeRef::Local(piece),
        };
        let mut told = observer(&Report::Segment(segment));
        for (section, row) in system.sections.iter().enumerate() {
            let mut last = from.clone();
            for look in 0..=LOOKS {
                let share = real.double(f64::from(look) / f64::from(LOOKS));
                let way = real.product(&real.difference(to, from), &share);
                let place = real.sum(from, &way);
                let sign = real.sign(&local.row(*row, &place));
                let known = self.sides[section];
                if sign != 0 && known == -sign {
                    let d = bisect(local, *row, known, (last.clone(), place.clone()));
                    let mut time = clock.clone();
                    let mut signed = d.clone();
                    real.times_integer(&mut signed, i32::from(local.side));
                    time.advance(real, &signed);
                    self.before = local.states(start, &d);
                    let kind = EventKind::Section { section, rising: sign > 0 };
                    let (before, after) = (&self.before[..], &self.before[..]);
                    let log2_error = f64::NEG_INFINITY;
                    let event = Event { time: &time.high, kind, before, after, log2_error };
                    if observer(&Report::Event(event)).is_break() {
                        told = ControlFlow::Break(());
                    }
                }
                if sign != 0 {
                    self.sides[section] = sign;
                }
                last = place;
            }
        }
        told
    }
}

/// The distance where a row ceases to have the sign `known`, between two distances.
fn bisect<R: Real>(
    local: &Local<R>,
    row: usize,
    known: i8,
    (mut last, mut next): (R::Element, R::Element),
) -> R::Element {
    let real = &local.lattice.real;
    for _ in 0..2 * real.bits() {
        let middle = real.product(&real.sum(&last, &next), &real.double(0.5));
        if middle == last || middle == next {
            break;
        }
        if real.sign(&local.row(row, &middle)) == known {
            last = middle;
        } else {
            next = middle;
        }
    }
    next
}
