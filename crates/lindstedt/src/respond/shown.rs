//! What is shown of the states, branches and changes of a subject.

use super::answer::{Branch, Change, Corner, Curve, Estimate, Point, State, States};
use super::subject::{Subject, doubles};
use crate::{Exact, Number, Status};
use lindstedt_number::ball::Balls;
use lindstedt_number::certified;
use lindstedt_number::interval::Interval;
use lindstedt_number::real::{Certified, Real};
use lindstedt_orbit::steady::{self, Found, Located, System, Zero};
use rug::Rational;

/// Bits of enclosures of states, which doubles bound.
pub(super) const BITS: u32 = 80;
/// Digits of them at most.
const DIGITS: usize = 15;

impl Subject<'_> {
    /// What is shown of a value of the flow's parameter.
    pub(super) fn shown_value(&self, value: f64) -> f64 {
        match (&self.factor, &self.small) {
            (Some(factor), Some(small)) => {
                factor.to_f64() * (self.slow.system.force().to_f64() + small.to_f64() * value)
            }
            _ => value,
        }
    }

    pub(super) fn shown_branch(&self, branch: &steady::Branch) -> Branch {
        let values = self.values([None, None]);
        let (systems, open) = (self.tongues.systems(&values), self.open()[0]);
        let mut values = doubles(&values);
        let mut point = |point: &steady::Point| {
            let (value, w) = point.at.split_last().unwrap_or((&0.0, &[]));
            let phase = |w: &[f64]| Estimate { value: w[1].atan2(w[0]) };
            let rate = self.rate(Some(*value));
            let mut stable = self.is_stable(point, rate);
            open.and_then(|open| values.get_mut(open)).into_iter().for_each(|it| *it = *value);
            let near_resonance = self.beside(&mut stable, &systems, &values, &point.at);
            Point {
                value: Estimate { value: self.shown_value(*value) },
                amplitudes: self.amplitudes(w),
                phases: w.chunks_exact(2).map(phase).collect(),
                stable,
                exponents: self.exponents(point, rate),
                frequency: None,
                near_resonance,
            }
        };
        let steady::Branch { points, closed, complete } = branch;
        Branch {
            points: points.iter().map(&mut point).collect(),
            closed: *closed,
            complete: *complete,
        }
    }

    pub(super) fn shown_change(&self, change: &Located) -> Option<Change> {
        let n = self.rotating.flow.unknowns();
        let Some(zero) = &change.proved else {
            let amplitudes = self.amplitudes(&change.at[..n]);
            return Some(Change {
                value: Number::double(self.shown_value(change.at[n])),
                amplitudes: amplitudes.iter().map(|a| Number::double(a.value)).collect(),
                branch: change.branch,
            });
        };
        let amplitudes = zero.enclosure[..n].chunks_exact(2).map(amplitude);
        let (amplitudes, value) =
            (amplitudes.collect::<Option<Vec<_>>>()?, self.proved_value(zero.enclosure[n])?);
        // That branches cross is not proved.
        let shown = |number: Number| match change.change {
            steady::Change::Crossing => Number { error: None, ..number.weaken(Status::Estimated) },
            _ => number,
        };
        let amplitudes = amplitudes.into_iter().map(shown).collect();
        Some(Change { value: shown(value), amplitudes, branch: change.branch })
    }

    fn proved_value(&self, value: Interval) -> Option<Number> {
        let mut shown = real(value);
        if let (Some(factor), Some(small)) = (&self.factor, &self.small) {
            let number = |q: &Rational| Certified::from_rational(Balls::new(BITS), q);
            shown = (shown * number(small) + number(&self.slow.system.force())) * number(factor);
        }
        proved(&shown)
    }

    pub(super) fn shown_states(
        &self,
        sample: Option<&Exact>,
        system: &System,
        found: &Found,
    ) -> Option<States> {
        let mut list: Vec<State> = Vec::new();
        let rate = self.rate(sample.map(Exact::to_f64));
        let values = self.values([sample, None]);
        let systems = self.tongues.systems(&values);
        for zero in &found.zeros {
            let point = steady::state_at(system, &zero.middle());
            let polar: Option<Vec<_>> = zero.enclosure.chunks_exact(2).map(polar).collect();
            let (amplitudes, phases) = polar?.into_iter().unzip();
            let mut stable = self.is_stable(&point, rate);
            let near_resonance = self.beside(&mut stable, &systems, &doubles(&values), &point.at);
            let exponents = self.exponents(&point, rate);
            let (drift, frequency) = (Vec::new(), None);
            let growth = self.growth(&values, &point.at);
            let at = point.at;
            list.push(State {
                amplitudes,
                phases,
                stable,
                exponents,
                near_resonance,
                frequency,
                drift,
                at,
                growth,
            });
        }
        let size = |state: &State| state.at.iter().map(|x| x * x).sum::<f64>();
        list.sort_by(|a, b| size(b).total_cmp(&size(a)).then(b.at[0].total_cmp(&a.at[0])));
        Some(States {
            value: sample.and_then(|value| self.shown_sample(value)),
            count: list.len(),
            count_proved: found.is_proved() && self.is_whole(),
            undecided: found.undecided.len(),
            at_edge: found.at_edge.len(),
            boxes: found.boxes,
            list,
        })
    }

    pub(super) fn shown_sample(&self, value: &Exact) -> Option<Number> {
        let exact = match (value.as_rational(), &self.factor, &self.small) {
            (Some(q), Some(factor), Some(small)) => {
                let rate = Rational::from(q * small) + self.slow.system.force();
                Exact::Rational(rate * factor)
            }
            _ => value.clone(),
        };
        certified(Some(exact.to_string()), DIGITS, |balls| Some(exact.ball(balls))).ok()
    }

    /// A curve in the plane of two parameters.
    pub(super) fn shown_curve(&self, curve: &steady::Curve, places: [usize; 2]) -> Curve {
        let point = |point: &steady::Point| {
            [self.shown_value(point.at[places[0]]), point.at[places[1]]]
                .map(|value| Estimate { value })
        };
        let kind = if curve.change == steady::Change::Fold { "fold" } else { "hopf" };
        let points = curve.branch.points.iter().map(point).collect();
        Curve { kind, points, closed: curve.branch.closed }
    }

    pub(super) fn shown_corner(&self, zero: &Zero, places: [usize; 2]) -> Option<Corner> {
        let n = self.rotating.flow.unknowns();
        let [first, second] = places.map(|place| zero.enclosure[place]);
        let amplitudes = zero.enclosure[..n].chunks_exact(2).map(amplitude);
        Some(Corner {
            values: [self.proved_value(first)?, proved(&real(second))?],
            amplitudes: amplitudes.collect::<Option<_>>()?,
        })
    }
}

pub(super) fn real(x: Interval) -> Certified {
    Certified::new(Balls::new(BITS), x.ball())
}

/// Nothing of what is not bounded.
pub(super) fn proved(x: &Certified) -> Option<Number> {
    Some(Number::of_ball(x.ball(), DIGITS)?.weaken(Status::Proved))
}

/// 2 |w| of an enclosed w.
fn amplitude(w: &[Interval]) -> Option<Number> {
    proved(&(real(w[0]).square() + real(w[1]).square()).sqrt().doubled())
}

/// 2 |w| and the angle of an enclosed w.
pub(super) fn polar(w: &[Interval]) -> Option<(Number, Option<Number>)> {
    let (re, im) = (real(w[0]), real(w[1]));
    let square = re.square() + im.square();
    // About the negative axis the principal value jumps: there it is taken from the opposite direction.
    let turned = || {
        Certified::new(Balls::new(BITS), Balls::new(BITS).pi()) + (-im.clone()).atan2(&-re.clone())
    };
    let cut = w[0].high() < 0.0 && w[1].contains(0.0);
    let phase = if cut { turned() } else { im.atan2(&re) };
    let phase = square.is_positive().then_some(phase).and_then(|phase| proved(&phase));
    Some((amplitude(w)?, phase))
}
