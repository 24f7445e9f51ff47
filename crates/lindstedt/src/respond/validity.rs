//! Where the slow flow, whose states are proved, says little of the oscillator.

use super::Respond;
use super::answer::{Estimate, Response, State};
use super::subject::{Subject, Values, doubles};
use crate::{Exact, Remark};
use lindstedt_evaluation::rotating::{order_sizes, rotating, start_error};
use lindstedt_orbit::steady::{Limits, System, Zero, all_states};
use rug::Rational;

/// The distance from the states of the order before, over the size of a state, from which the orders do not settle there.
const FAR: f64 = 0.5;
/// Boxes of a search that is not shown.
const FEW_BOXES: usize = 20_000;
/// The modulus at which the linear terms are compared that alone matter at rest.
const NEAR_REST: f64 = 1e-9;

impl Subject<'_> {
    /// The largest ratio of what an order adds to the slow flow at a state to what the order before adds, of those
    /// that add anything.
    pub(super) fn growth(&self, values: &Values, at: &[f64]) -> f64 {
        let mut moduli: Vec<f64> = at.chunks_exact(2).map(|w| w[0].hypot(w[1])).collect();
        if moduli.iter().all(|w| *w == 0.0) {
            moduli.fill(NEAR_REST);
        }
        let (turns, mut values) = (&self.rotating.turns, doubles(values));
        // The amplitude of a family is none of them.
        values.truncate(self.slow.system.symbols.len() + 1);
        let mut sizes = order_sizes(&self.slow, turns, &values, &moduli, self.order);
        // Those of free motion are in the time of the unit of frequency.
        sizes[0] *= self.unit().map_or(1.0, |unit| unit.midpoint().to_f64());
        sizes.retain(|size| *size > 0.0);
        sizes.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max)
    }

    /// Where an internal resonance beside the slow flow may make a state unstable, that is not called stable.
    pub(super) fn beside(
        &self,
        stable: &mut Option<bool>,
        systems: &[System],
        values: &[f64],
        at: &[f64],
    ) -> Option<Estimate> {
        if *stable != Some(true) || systems.is_empty() {
            return None;
        }
        let values = &values[..values.len().min(self.slow.system.symbols.len() + 1)];
        let unit = self.unit().map_or(1.0, |unit| unit.midpoint().to_f64());
        let found = self.tongues.worst(systems, values, at, unit);
        *stable = stable.filter(|_| found.is_none());
        found.map(|value| Estimate { value })
    }

    /// By how much a start state of the slow flow may be wrong, as it is known to leading order.
    pub(super) fn start_error(&self, start: &[f64]) -> f64 {
        let moduli: Vec<f64> = start.chunks_exact(2).map(|w| w[0].hypot(w[1])).collect();
        start_error(&self.slow, &doubles(&self.values([None, None])), &moduli)
    }

    /// That the orders before have states where this one has none, or stable ones far from them: of a single value, in a box twice as
    /// large.
    fn unsettled(&self, question: &Respond, value: &Response) -> Option<Remark> {
        let alone = question.sweep.is_none() && self.rotating.free.is_none();
        let [states] = &value.states[..] else { return None };
        let small = &self.oscillator.problem().small;
        let values = self.values([None, None]);
        let reach = value.amplitude_limit.value;
        let limits = Limits { boxes: FEW_BOXES, ..self.limits(reach) };
        let places = |order: usize| -> Option<Vec<Vec<f64>>> {
            let before = rotating(&self.slow, small, order).ok().filter(|it| it.fixed > 0)?;
            let found = all_states(&before.flow, &values, reach, &limits)?;
            let middle = |zero: &Zero| zero.enclosure.iter().map(|x| x.middle()).collect();
            Some(found.zeros.iter().map(middle).collect())
        };
        let size = |w: &[f64]| w.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
        if !alone || self.order < 2 || self.rotating.fixed == 0 {
            return None;
        }
        if states.count == 0 && states.undecided == 0 {
            let lower = (1..self.order).rev().find_map(|order| {
                Some((order, places(order).filter(|places| !places.is_empty())?.len()))
            });
            let (order, many) = lower?;
            return Some(Remark(format!(
                "order {} has no state where order {order} has {many}: the orders do not settle, and that there is none says nothing \
                 of the oscillator; the small parameter or the force is too large",
                self.order,
            )));
        }
        let before = places(self.order - 1)?;
        let far = |state: &&State| {
            let apart = |place: &Vec<f64>| {
                let gap: Vec<f64> = place.iter().zip(&state.at).map(|(a, b)| a - b).collect();
                size(&gap)
            };
            state.stable == Some(true)
                && before.iter().all(|place| apart(place) > FAR * size(&state.at))
        };
        let many = states.list.iter().filter(far).count();
        (many > 0).then(|| {
            Remark(format!(
                "{many} of the stable states lie far from those of order {}, by more than half of their amplitude: the orders do not settle \
                 there, the small parameter or the force is too large",
                self.order - 1,
            ))
        })
    }

    /// Remarks on states at which the orders do not fall, and on a divisor that the small parameter exceeds.
    pub(super) fn doubts(&self, question: &Respond, value: &Response) -> Vec<Remark> {
        let growths = value.states.iter().flat_map(|states| &states.list).map(|it| it.growth);
        let many = growths.clone().filter(|growth| *growth >= 1.0).count();
        let worst = growths.fold(0.0, f64::max);
        let orders = (many > 0).then(|| {
            Remark(format!(
                "at {many} of the states an order of the slow flow adds as much as the order before or more (up to {worst:.1} \
                 times): the oscillator need not have a motion near these, the small parameter or the amplitude is too large"
            ))
        });
        let orders = orders.or_else(|| self.unsettled(question, value));
        let name = &self.oscillator.problem().small;
        let axes = [&question.sweep, &question.second].into_iter().flatten();
        let swept = axes.filter(|axis| *axis.name == **name).flat_map(|axis| &axis.values);
        let small = self.small.iter().map(Rational::to_f64).chain(swept.map(Exact::to_f64));
        let small = small.fold(0.0, |most: f64, value| most.max(value.abs()));
        let room = |order: usize| small.powi(i32::try_from(order.max(1)).unwrap_or(i32::MAX));
        let nearest = self.slow.nearest.iter().filter(|near| near.order <= self.order);
        let ratios = nearest.map(|near| (near.size.to_f64().abs() / room(near.order), near));
        let missed = ratios.filter(|(ratio, _)| *ratio < 1.0).min_by(|a, b| a.0.total_cmp(&b.0));
        let missed = missed.map(|(_, near)| {
            Remark(format!(
                "at order {} the harmonic {} of {} misses a resonance by {} of the square of its frequency, less than the small \
                 terms move it: write the frequency as a resonant one and a detuning of order eps",
                near.order,
                self.slow.harmonic(near),
                self.slow.coordinates()[near.unknown],
                self.slow.size(&near.size),
            ))
        });
        // Beyond a tenth `derive` does not detune by itself.
        let beside = self.slow.system.beside.as_ref().filter(|_| self.factor.is_none());
        let (force, tenth) = (self.slow.system.force(), Rational::from((1, 10)));
        let away = beside.map(|it| (&it.rate, Rational::from(&it.rate - &force)));
        let away = away.filter(|(rate, away)| away.clone().abs() > tenth * *rate);
        let detuned = away.map(|(rate, away)| {
            let [force, away] = [&force, &away].map(|rate| self.slow.size(rate));
            Remark(format!(
                "the frequency of the force, {rate}, counts as that of the resonance, {force}, with a detuning of {away}"
            ))
        });
        orders.into_iter().chain(missed).chain(detuned).chain(tongues(value)).collect()
    }
}

/// What is said of states beside an internal resonance.
fn tongues(value: &Response) -> Option<Remark> {
    let states = value.states.iter().flat_map(|states| &states.list);
    let states: Vec<f64> = states.filter_map(|it| Some(it.near_resonance?.value)).collect();
    let points = value.branches.iter().flat_map(|branch| &branch.points);
    let points: Vec<f64> = points.filter_map(|it| Some(it.near_resonance?.value)).collect();
    let worst = states.iter().chain(&points).copied().reduce(f64::max)?;
    let along = if points.is_empty() {
        String::new()
    } else {
        format!(" and {} points of branches", points.len())
    };
    Some(Remark(format!(
        "whether {} of the states{along} are stable is not decided: an unknown at rest lies in or beside a tongue of an \
         internal resonance that the slow flow does not have (real part there {worst:.6} to leading order): write its \
         frequency as a resonant one and a detuning of order eps",
        states.len(),
    )))
}
