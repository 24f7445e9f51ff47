//! How far states of a slow flow are looked for.

use super::super::not_determined;
use super::super::refusals::{no_amplitude, no_bound, no_energy, no_frame};
use super::{Subject, Values};
use crate::{Error, SlowFlow};
use lindstedt_derivation::resonance::QuadraticInvariant;
use lindstedt_evaluation::rotating::{Rotating, rotating};
use lindstedt_orbit::steady::{Limits, bound, outermost};

/// The box is so many times as large as that of order one, for higher orders.
const ROOM: f64 = 1.25;
/// Boxes looked at where a smaller box may decide what this one does not.
const FEW_BOXES: usize = 20_000;

/// The largest |w_j| that are looked at.
pub(in crate::respond) struct Reach {
    pub(in crate::respond) modulus: f64,
    /// A smaller one, for where that one decides nothing.
    less: Option<f64>,
    /// Whether all states of the truncated slow flow lie within the one and the other.
    pub(in crate::respond) complete: [bool; 2],
}

impl Subject<'_> {
    /// How far to look: as asked, else so that all steady states of the lowest order lie within in which a force acts and that bounds
    /// them.
    pub(in crate::respond) fn reach(&self, at: &[Values]) -> Result<Reach, Error> {
        let largest = |rotating: &Rotating| {
            let bound = |values: &Values| match rotating.unforced() {
                Some(free) => free.bound(values),
                None => bound(&rotating.flow.system(values)),
            };
            at.iter().try_fold(0.0f64, |most, values| Some(most.max(bound(values)?)))
        };
        let still = |values: &Values| {
            values.last().is_some_and(|it| it.as_ref().is_some_and(|it| it.interval().low() <= 0.0))
        };
        if self.is_family() && at.iter().any(still) {
            return Err(no_amplitude("is a positive number"));
        }
        let whole = largest(&self.rotating);
        let (modulus, less) = match self.amplitude {
            None if self.is_family() => (whole.ok_or(Error::NoValue)?, None),
            // Not further than there can be states.
            Some(amplitude) => {
                let far = whole.filter(|r| *r > 0.0).map_or(f64::INFINITY, |r| ROOM * r);
                (far.min(amplitude / 2.0), None)
            }
            None => self.leading(at, &largest)?,
        };
        let complete =
            [Some(modulus), less].map(|r| r.is_some_and(|r| whole.is_some_and(|it| it <= r)));
        Ok(Reach { modulus, less, complete })
    }

    /// A box of the lowest order in which a force acts and that bounds its states, and a smaller one: with its states, or as large as
    /// the orders fall within. Orders before that one have rest, whose bound is nothing to the states that a force makes; so has
    /// one whose terms are all linear, as of parametric resonance.
    fn leading(
        &self,
        at: &[Values],
        largest: &dyn Fn(&Rotating) -> Option<f64>,
    ) -> Result<(f64, Option<f64>), Error> {
        let small = self.oscillator.problem().small.to_string();
        // A box to look in: terms of high degree that are almost zero bound nothing.
        let sure = SlowFlow { doubtful: Vec::new(), ..self.slow.clone() };
        // Of states at rest in the frame, not of motions that turn in it.
        let outer = |rotating: &Rotating, known| {
            let one = |values| outermost(&rotating.flow, values, known);
            let mut at = at.iter().filter(|_| rotating.unforced().is_none()).peekable();
            at.peek()?;
            at.try_fold(0.0f64, |most, values| Some(most.max(one(values)?)))
        };
        for order in 1..=self.order {
            let rotating = rotating(&sure, &small, order).map_err(no_frame)?;
            if rotating.fixed == 0 && self.rotating.fixed > 0 {
                continue;
            }
            let Some(most) = largest(&rotating) else {
                match outer(&rotating, None) {
                    Some(most) => return Ok((ROOM * most, None)),
                    None => continue,
                }
            };
            if most == 0.0 {
                // Rest alone, in a box of any size, where no order is left.
                match order < self.order {
                    true => continue,
                    false => return Ok((1.0, None)),
                }
            }
            let states = (self.order > order).then(|| outer(&rotating, Some(most))).flatten();
            let less = states.map(|states| ROOM * self.falling(at, states, most));
            return Ok((ROOM * most, less.filter(|less| *less < ROOM * most)));
        }
        // A form that the lowest orders alone keep makes no families.
        let whole = |form: &QuadraticInvariant| form.orders >= self.order;
        let kept = self.rotating.unforced().is_some()
            && self.slow.quadratic_invariants().iter().any(whole);
        Err(if kept { no_energy() } else { no_bound() })
    }

    /// The largest modulus between two at which every order adds less to the slow flow than the order before, or the least:
    /// states of the truncated flow farther out say nothing of the oscillator.
    fn falling(&self, at: &[Values], least: f64, most: f64) -> f64 {
        let falls = |r: &f64| {
            let place = [ROOM * r, 0.0].repeat(self.rotating.turns.len());
            at.iter().all(|values| self.growth(values, &place) < 1.0)
        };
        let radii = (0..64).map(|k| most * 0.5f64.powf(f64::from(k) / 4.0));
        radii.take_while(|r| *r > least).find(falls).unwrap_or(least)
    }

    /// What is found in a box, or, where a few boxes do not decide that, in the smaller one; with its reach and whether that has
    /// all states.
    pub(in crate::respond) fn within<T>(
        &self,
        reach: &Reach,
        look: impl Fn(f64, Limits) -> Option<T>,
        decides: impl Fn(&T) -> bool,
    ) -> Result<(T, f64, bool), Error> {
        let limits = self.limits(reach.modulus);
        let boxes = if reach.less.is_some() { FEW_BOXES } else { limits.boxes };
        let found = look(reach.modulus, Limits { boxes, ..limits }).ok_or_else(not_determined)?;
        match reach.less {
            Some(less) if !decides(&found) && !self.work.stop.asked() => {
                let found = look(less, self.limits(less)).ok_or_else(not_determined)?;
                Ok((found, less, reach.complete[1]))
            }
            _ => Ok((found, reach.modulus, reach.complete[0])),
        }
    }

    pub(in crate::respond) fn limits(&self, reach: f64) -> Limits {
        let (modulus, stop) = (Some(reach), self.work.stop.clone());
        Limits { modulus, stop, boxes: self.boxes, ..Limits::default() }
    }
}
