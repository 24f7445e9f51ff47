//! The Taylor series of all states about the start of a step, its length, and a check of both.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::probe::{Probe, slope};
use crate::system::System;
use crate::tape::{Moment, Op, Rows, horner};
use std::ops::{ControlFlow, Range};

/// From so many levels on a step is long (220 digits): it is asked whether to go on with it.
const LONG: usize = 256;

/// What the right side is at this moment.
#[derive(Clone, Debug)]
pub(crate) struct Phase {
    /// The sign of every switch; 0: it slides.
    pub(crate) modes: Vec<i8>,
    /// The wall that the body rests at: x and x' are constant.
    pub(crate) contact: Option<usize>,
}

/// log2 of the longest step, and of the largest of x_0, of x_1 and of x_2; nothing where a coefficient is not finite.
type Length = Option<(f64, [f64; 3])>;

/// Taylor coefficients and the places to compute them in.
#[derive(Clone, Debug)]
pub(crate) struct Series<R: Real> {
    pub(crate) rows: Rows<R::Element>,
    pub(crate) order: usize,
    pub(crate) probe: Probe<R::Element>,
    /// Where it was placed.
    probed: Option<R::Element>,
    /// log2 of the length of a step, and of the norms of x_0, x_1 and x_2, once asked for.
    length: Option<Length>,
    /// Whether the body rests at a wall.
    rests: bool,
    sum: R::Element,
    scratch: R::Element,
}

/// log2 of zero, and of zero.
const NOTHING: (f64, f64) = (f64::NEG_INFINITY, f64::NEG_INFINITY);

impl<R: Real> Series<R> {
    pub(crate) fn new(system: &System<R>, order: usize) -> Self {
        let zero = system.real.zero();
        Self {
            rows: Rows::new(system.tape.rows(), order + 1, &zero),
            order,
            probe: Probe::new(system.tape.rows(), system.variables, &zero),
            probed: None,
            length: None,
            rests: false,
            sum: zero.clone(),
            scratch: zero,
        }
    }

    /// Levels 1..=levels of the states and 0..=levels of all other rows, from level 0 of the
    /// states and the delayed rows. Where there are many, `tick` is asked before every one whether to go on
    /// ([`SimulateError::Stopped`]): a level n takes n products per operation.
    pub(crate) fn expand(
        &mut self,
        system: &System<R>,
        time: &R::Element,
        phase: &Phase,
        levels: usize,
        tick: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<(), SimulateError> {
        let asks = levels >= LONG;
        (self.probed, self.length) = (None, None);
        self.rests = phase.contact.is_some();
        let sliding = phase.modes.iter().position(|mode| *mode == 0);
        let mut sensitivity = None;
        for n in 0..=levels {
            if asks && tick().is_break() {
                return Err(SimulateError::Stopped);
            }
            // Where it slides the levels below the last are found with their control.
            let slides = sliding.filter(|_| phase.contact.is_none() && n < levels);
            if slides.is_none() {
                self.level(system, time, phase, n);
            }
            if n == levels {
                break;
            }
            if slides.is_none() {
                self.states(system, phase, n);
            }
            if let Some(switch) = slides {
                let s = match sensitivity.take() {
                    Some(s) => s,
                    None => self.sensitivity(system, time, phase, switch)?,
                };
                self.slide(system, time, phase, (switch, n), &s);
                sensitivity = Some(s);
            }
        }
        if let Some(switch) = sliding {
            self.set_control(system, switch, None, levels, &system.real.zero());
        }
        Ok(())
    }

    /// The coefficients of some rows from elsewhere.
    pub(crate) fn take<I: Iterator<Item = R::Element>>(
        &mut self,
        rows: &[usize],
        from: impl Fn(usize) -> I,
    ) {
        (self.probed, self.length, self.rests) = (None, None, false);
        for row in rows {
            self.rows.row_mut(*row).iter_mut().zip(from(*row)).for_each(|(to, x)| *to = x);
        }
    }

    fn level(&mut self, system: &System<R>, time: &R::Element, phase: &Phase, n: usize) {
        let (sum, scratch) = (&mut self.sum, &mut self.scratch);
        let mut moment = Moment { time, modes: &phase.modes, sum, scratch };
        system.tape.level(&system.real, &mut self.rows, n, &mut moment);
    }

    /// The same after a control alone has changed.
    fn level_again(&mut self, system: &System<R>, time: &R::Element, phase: &Phase, n: usize) {
        let (sum, scratch) = (&mut self.sum, &mut self.scratch);
        let mut moment = Moment { time, modes: &phase.modes, sum, scratch };
        let steps = system.tape.behind(n);
        system.tape.run(steps, &system.real, &mut self.rows, n, &mut moment);
    }

    /// x_{n+1} = f_n/(n+1).
    fn states(&mut self, system: &System<R>, phase: &Phase, n: usize) {
        let real = &system.real;
        for (state, right) in system.right_sides.iter().enumerate() {
            if phase.contact.is_some() {
                real.set_zero(&mut self.sum);
            } else {
                real.set(&mut self.sum, self.rows.at(*right, n));
                real.over_integer(&mut self.sum, n as u32 + 1);
            }
            std::mem::swap(self.rows.at_mut(state, n + 1), &mut self.sum);
        }
    }

    /// Sets coefficient `n` of the control of a switch: of one part, or of all.
    fn set_control(
        &mut self,
        system: &System<R>,
        switch: usize,
        part: Option<usize>,
        n: usize,
        value: &R::Element,
    ) {
        for [row, s, p] in &system.tape.controls {
            if *s == switch && part.is_none_or(|part| part == *p) {
                system.real.set(self.rows.at_mut(*row, n), value);
            }
        }
    }

    /// h_{n+1} of the switch (part 0) and of its derivatives in the directions, for the controls set and level n found.
    fn constraint(
        &mut self,
        system: &System<R>,
        time: &R::Element,
        phase: &Phase,
        (switch, n): (usize, usize),
    ) {
        self.states(system, phase, n);
        let (sum, scratch) = (&mut self.sum, &mut self.scratch);
        let mut moment = Moment { time, modes: &phase.modes, sum, scratch };
        for index in &system.switches[switch].cone {
            let (tape, real) = (&system.tape, &system.real);
            tape.operation(real, &mut self.rows, *index, n + 1, &mut moment);
        }
    }

    /// One part of it.
    fn constrained(&self, system: &System<R>, switch: usize, part: usize, n: usize) -> R::Element {
        let switch = &system.switches[switch];
        let row = match part.checked_sub(1) {
            None => Some(switch.row),
            Some(direction) => switch.tangents[direction],
        };
        row.map_or_else(|| system.real.zero(), |row| self.rows.at(row, n + 1).clone())
    }

    /// dh_1/du where u stands for the sign; checks that h_1 is affine in u.
    fn sensitivity(
        &mut self,
        system: &System<R>,
        time: &R::Element,
        phase: &Phase,
        switch: usize,
    ) -> Result<R::Element, SimulateError> {
        let real = &system.real;
        let mut h = [0.0, 1.0, -1.0].map(|u| {
            self.set_control(system, switch, None, 0, &real.zero());
            self.set_control(system, switch, Some(0), 0, &real.double(u));
            self.level(system, time, phase, 0);
            self.constraint(system, time, phase, (switch, 0));
            self.constrained(system, switch, 0, 0)
        });
        let slope = real.difference(&h[1], &h[0]);
        let other = real.difference(&h[0], &h[2]);
        let defect = real.log2(&real.difference(&slope, &other));
        real.times_integer(&mut h[0], 2);
        let size = real.log2(&slope).max(real.log2(&h[0]));
        let affine = defect <= size - f64::from(real.bits()) / 2.0 || defect == f64::NEG_INFINITY;
        if !affine {
            return Err(SimulateError::NotAffine { switch });
        }
        if real.sign(&slope) == 0 {
            let time = real.to_f64(time);
            return Err(SimulateError::HigherSliding { switch, time });
        }
        Ok(slope)
    }

    /// Coefficient n of the control (and of its derivatives) that keeps the switch at zero: the
    /// coefficient enters h_{n+1} with the factor sensitivity/(n+1).
    fn slide(
        &mut self,
        system: &System<R>,
        time: &R::Element,
        phase: &Phase,
        (switch, n): (usize, usize),
        sensitivity: &R::Element,
    ) {
        let real = &system.real;
        self.set_control(system, switch, None, n, &real.zero());
        self.level(system, time, phase, n);
        // That of the motion first; the directions read it, and not each other.
        for parts in [0..=0, 1..=system.directions()] {
            if parts.is_empty() {
                continue;
            }
            self.constraint(system, time, phase, (switch, n));
            for part in parts {
                let h = self.constrained(system, switch, part, n);
                let mut u = real.quotient(&h, sensitivity);
                real.times_integer(&mut u, -(n as i32 + 1));
                self.set_control(system, switch, Some(part), n, &u);
            }
            self.level_again(system, time, phase, n);
        }
        self.states(system, phase, n);
    }

    /// log2 of the largest coefficient of level `n` of the states in `range`.
    fn norm(&self, real: &R, range: Range<usize>, n: usize) -> f64 {
        real.log2_of_largest(range.map(|state| self.rows.at(state, n)))
    }

    /// The longest step h with |x_m| h^m <= tolerance max_{k<3} |x_k| h^k for m = p - 1, p, in
    /// the largest norm; the linearisation is measured by itself. At rest at a wall x is constant, and the force that
    /// will end it is in its place. Nothing if a coefficient is not finite.
    pub(crate) fn step(&mut self, system: &System<R>, log2_tolerance: f64) -> Option<f64> {
        let length = self.length.unwrap_or_else(|| self.longest(system, log2_tolerance));
        self.length = Some(length);
        Some(length?.0.min(1000.0).exp2())
    }

    fn longest(&self, system: &System<R>, log2_tolerance: f64) -> Length {
        let n = system.variables;
        let first = |group: Range<usize>| {
            [0, 1, 2].map(|level| self.norm(&system.real, group.clone(), level))
        };
        let of = |group: Range<usize>, first| {
            let last = |level| self.norm(&system.real, group.clone(), level);
            log2_step(self.order, log2_tolerance, first, last)
        };
        let moving = if self.rests { system.force()..system.force() + 1 } else { 0..n };
        let own = first(moving.clone());
        let mut log = of(moving, own)?;
        let others = n..system.tape.states;
        if !others.is_empty() {
            log = log.min(of(others.clone(), first(others))?);
        }
        Some((log, own))
    }

    /// Whether h |x'(h) - f(x(h))|, and |w(h) - w(x(h))| for the nonlinear functions w of switches and sections (at rest
    /// at a wall of the force alone), are within the tolerance (relative to |x_0| + h |x_1|, of w to |w_0| + h |w_1| if that is more) or within
    /// rounding errors. It sees what the last coefficients do not tell: x'' = x^101 at x = 0 has
    /// none below order 103.
    pub(crate) fn holds(
        &mut self,
        system: &System<R>,
        end: &R::Element,
        phase: &Phase,
        h: &R::Element,
        log2_tolerance: f64,
    ) -> bool {
        let real = &system.real;
        if self.probed.as_ref() != Some(h) {
            self.place(system, end, phase, h);
        }
        let worst = match self.rests {
            true => f64::NEG_INFINITY,
            false => real.log2_of_largest(self.probe.defects.iter()),
        };
        let Some((_, [place, speed, bend])) = self.length.flatten().filter(|_| !worst.is_nan())
        else {
            return false;
        };
        let size = real.log2(h);
        let scale = place.max(speed + size).max(bend + 2.0 * size);
        // The derivative's tail is p times that of the series.
        let factor = (self.order as f64).log2() + 3.0;
        let force = [system.force()];
        let surfaces = if self.rests { &force[..] } else { &system.nonlinear };
        let surfaces = surfaces.iter().map(|row| self.truncated(real, *row, h));
        let (surface, extent) = surfaces.fold(NOTHING, |a, b| (a.0.max(b.0), a.1.max(b.1)));
        let limit = log2_tolerance + factor;
        if worst + size <= limit + scale && surface <= limit + scale.max(extent) {
            return true;
        }
        // Rounding errors of some hundred operations on the largest term are no defect either.
        let terms = system.tape.ops.iter().zip(system.tape.states..);
        let terms = terms.filter(|(op, _)| !matches!(op, Op::Constant(_) | Op::Time));
        let terms = terms.map(|(_, row)| self.probe.rows.at(row, 0));
        let mut largest = real.log2_of_largest(terms.clone());
        if largest.is_nan() {
            // Of those that are finite.
            largest = terms.map(|term| real.log2(term)).fold(f64::NEG_INFINITY, f64::max);
        }
        let largest = largest.max(scale - size);
        worst.max(surface) <= largest + 7.0 - f64::from(real.bits())
    }

    /// log2 of |w(h) - w(x(h))| and of the larger of |w_0| and h |w_1| for a row w of the probe.
    fn truncated(&self, real: &R, row: usize, h: &R::Element) -> (f64, f64) {
        let truncated = self.value(real, row, h);
        let [first, slope] = [0, 1].map(|level| real.log2(self.rows.at(row, level)));
        let defect = real.difference(&truncated, self.probe.rows.at(row, 0));
        (real.log2(&defect), first.max(slope + real.log2(h)))
    }

    fn place(&mut self, system: &System<R>, end: &R::Element, phase: &Phase, h: &R::Element) {
        let (sum, scratch) = (&mut self.sum, &mut self.scratch);
        let mut moment = Moment { time: end, modes: &phase.modes, sum, scratch };
        let equation = (&system.tape, &system.right_sides[..]);
        self.probe.place(&system.real, equation, &self.rows, h, &mut moment);
        self.probed = Some(h.clone());
    }

    /// The rows and defects at h from elsewhere.
    pub(crate) fn take_probe(
        &mut self,
        h: R::Element,
        rows: impl Iterator<Item = R::Element>,
        defects: impl Iterator<Item = R::Element>,
    ) {
        self.probe.rows.data.iter_mut().zip(rows).for_each(|(to, x)| *to = x);
        self.probe.defects.iter_mut().zip(defects).for_each(|(to, x)| *to = x);
        self.probed = Some(h);
    }

    /// The derivative of a row at s.
    pub(crate) fn slope(&mut self, real: &R, row: usize, s: &R::Element) -> R::Element {
        slope(real, (&mut self.sum, &mut self.scratch), self.rows.row(row), s);
        self.sum.clone()
    }

    /// The states at s; those of the probe are not computed again.
    pub(crate) fn states_at(&self, real: &R, states: &mut [R::Element], s: &R::Element) {
        let probed = self.probed.as_ref() == Some(s);
        for (row, state) in states.iter_mut().enumerate() {
            if probed {
                real.set(state, self.probe.rows.at(row, 0));
            } else {
                horner(real, state, self.rows.row(row), s);
            }
        }
    }

    /// The value of a row at s.
    pub(crate) fn value(&self, real: &R, row: usize, s: &R::Element) -> R::Element {
        let mut value = real.zero();
        horner(real, &mut value, self.rows.row(row), s);
        value
    }
}

/// log2 of the step length from the norms (as log2) of the first and of the other levels; infinite for polynomials.
pub(crate) fn log2_step(
    order: usize,
    log2_tolerance: f64,
    first: [f64; 3],
    norm: impl Fn(usize) -> f64,
) -> Option<f64> {
    let mut log = f64::INFINITY;
    for m in [order - 1, order] {
        let last = norm(m);
        if last.is_nan() || first.iter().any(|x| x.is_nan()) {
            return None;
        }
        if last == f64::NEG_INFINITY {
            continue;
        }
        let longest = (0..3).map(|k| (log2_tolerance + first[k] - last) / (m - k) as f64);
        log = log.min(longest.fold(f64::NEG_INFINITY, f64::max));
    }
    Some(log)
}
