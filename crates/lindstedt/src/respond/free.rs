//! The states of a combination resonance, where one phase is free.

use super::answer::{Estimate, State, States};
use super::shown::{BITS, polar, proved, real};
use super::subject::Subject;
use crate::{Error, Number};
use lindstedt_number::ball::Balls;
use lindstedt_number::interval::Interval;
use lindstedt_number::real::{Certified, Real};
use lindstedt_orbit::steady::{FreePhase, Limits, Point, System, Zero, all_zeros};
use rug::Rational;

/// Where |w_o| is at most this times |w_c|, c is the unknown of the first search; beyond, of the second. Motions of
/// equal amplitudes lie within one of them.
const DIVIDE: (i32, i32) = (137, 100);

impl Subject<'_> {
    /// Adds the motions that are steady but for the free phase, in frames of their own.
    pub(super) fn with_free_phase(
        &self,
        free: &FreePhase,
        reach: f64,
        system: &System,
        states: &mut States,
    ) -> Result<(), Error> {
        let size = Rational::from_f64(reach).ok_or(Error::NoValue)?;
        let divide = Rational::from(DIVIDE);
        for (c, most) in [divide.clone(), divide.recip()].into_iter().enumerate() {
            let Some(flow) = free.reduced(c, &[size.clone(), most.clone()]) else {
                states.count_proved = false;
                states.undecided += 1;
                return Ok(());
            };
            let region =
                [Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0), Interval::new(0.0, 1.0)];
            let limits = Limits { modulus: Some(1.0), ..self.limits(reach) };
            let reduced = flow.system(&self.values([None, None]));
            let found = all_zeros(&reduced, &region, &limits).ok_or(Error::NoValue)?;
            states.boxes += found.boxes;
            states.undecided += found.undecided.len();
            states.at_edge += found.at_edge.len();
            for zero in &found.zeros {
                match self.turning(free, (c, &size, &most), system, zero) {
                    Kept::Yes(state) => states.list.push(state),
                    Kept::Beyond => {}
                    Kept::AtEdge => states.at_edge += 1,
                }
            }
        }
        states.count = states.list.len();
        states.count_proved &= states.undecided == 0 && states.at_edge == 0;
        let size = |state: &State| state.at.iter().map(|x| x * x).sum::<f64>();
        states.list.sort_by(|a, b| size(b).total_cmp(&size(a)));
        Ok(())
    }

    /// The state of a zero of the reduced equations.
    fn turning(
        &self,
        free: &FreePhase,
        (c, size, most): (usize, &Rational, &Rational),
        system: &System,
        zero: &Zero,
    ) -> Kept {
        let exact = |q: &Rational| Certified::from_rational(Balls::new(BITS), q);
        let [re, im, s] = [0, 1, 2].map(|k| zero.enclosure[k]);
        if s.low() <= 0.0 {
            return Kept::AtEdge;
        }
        let gauge = real(s) * exact(size);
        let ratio = (real(re).square() + real(im).square()).sqrt() * exact(most);
        let limit = exact(size);
        let other = gauge.clone() * ratio;
        if !(limit.clone() - other.clone()).is_positive() {
            let beyond = (other - limit).is_positive();
            return if beyond { Kept::Beyond } else { Kept::AtEdge };
        }
        let (Some(own), Some(other)) = (proved(&gauge.doubled()), proved(&other.doubled())) else {
            return Kept::AtEdge;
        };
        let phase = polar(&[re, im]).and_then(|(_, phase)| phase);
        let mut amplitudes = [own, other];
        let mut phases: [Option<Number>; 2] = [proved(&exact(&Rational::new())), phase];
        amplitudes.rotate_left(c);
        phases.rotate_left(c);
        let a = s.middle() * size.to_f64();
        let y = [re, im].map(|part| part.middle() * most.to_f64());
        let mut pairs = [[a, 0.0], [a * y[0], a * y[1]]];
        pairs.rotate_left(c);
        let at = [pairs[0][0], pairs[0][1], pairs[1][0], pairs[1][1]];
        let (delta, exponents) = free.drift(system, &at);
        let point = Point { at: at.to_vec(), exponents, change: None };
        let rate = self.rate(None);
        let scaled = |d: &Rational| Estimate { value: rate * delta * d.to_f64() };
        Kept::Yes(State {
            amplitudes: amplitudes.to_vec(),
            phases: phases.to_vec(),
            stable: self.is_stable(&point, rate),
            exponents: self.exponents(&point, rate),
            drift: free.weights.iter().map(scaled).collect(),
            growth: self.growth(&self.values([None, None]), &at),
            at: at.to_vec(),
        })
    }
}

enum Kept {
    Yes(State),
    Beyond,
    AtEdge,
}
