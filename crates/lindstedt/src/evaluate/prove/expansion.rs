//! Which of several proved orbits the expansion belongs to.
//!
//! The sum of the expansion, as it is computed, is a trigonometric polynomial: a point of the space in which
//! the orbits are proved. Where it lies in the ball in which an orbit is the only one, no other orbit is
//! nearer. Else Newton's method is started from it, and what it leads to is compared by the proofs.

use super::orbit::{Expansion, above};
use super::{DIGITS_OF_A_GUESS, MODES_OF_A_GUESS};
use crate::evaluate::Evaluate;
use crate::evaluate::wanted::Wanted;
use crate::{Oscillator, Work};
use lindstedt_orbit::{Kind, Proof, Request, prove};

impl Oscillator {
    /// The orbit of the sum among several limit cycles, and how far the sum is from it.
    pub(super) fn of_the_sum(
        &self,
        proofs: &[Proof],
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Option<(usize, Expansion)> {
        if proofs.len() < 2 || wanted.kind != Kind::LimitCycle || !self.has_expansion() {
            return None;
        }
        let rough = Work { digits: DIGITS_OF_A_GUESS.min(work.digits), ..work.clone() };
        let found = self.period(question, &rough).ok()?;
        let start = self.by_sum(Some(&found), question, &rough)?;
        let distance = |i: &usize| Some(proofs.get(*i)?.distance_from(&start));
        let tie =
            |i: usize, alone: bool| Some((i, Expansion { distance: above(&distance(&i)?), alone }));
        let alone = |i: &usize| distance(i).is_some_and(|d| d <= proofs[*i].unique_within);
        if let Some(i) = (0..proofs.len()).find(alone) {
            return tie(i, true);
        }
        let request = Request {
            digits: rough.digits,
            stop: work.stop.clone(),
            modes_limit: MODES_OF_A_GUESS,
        };
        let reached = prove(&wanted.field, &wanted.kind, &start, &request).ok()?;
        tie(proofs.iter().position(|proof| proof.is_same_as(&reached))?, false)
    }
}
