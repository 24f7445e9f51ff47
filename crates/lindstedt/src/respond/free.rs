//! The states of a combination resonance and of two unknowns without a force, where one phase is free.

use super::answer::{Estimate, Response, State, States};
use super::shown::{BITS, polar, proved, real};
use super::subject::{Subject, Values};
use super::{Respond, not_determined};
use crate::refusal::Refused;
use crate::{Error, Exact, Number, Remark};
use lindstedt_number::ball::Balls;
use lindstedt_number::interval::Interval;
use lindstedt_number::real::{Certified, Real};
use lindstedt_orbit::steady::{
    self, FreePhase, Limits, Located, Point, System, Turning, Value, Zero, all_zeros,
};
use rug::Rational;

/// Where |w_o| is at most this times |w_c|, c is the unknown of the first search; beyond, of the second. Motions of
/// equal amplitudes lie within one of them.
const DIVIDE: (i32, i32) = (137, 100);
/// Boxes looked at for each of the two.
const MOST_BOXES: usize = 200_000;
/// Zeros this near to one another, in parts of the largest |w_j|, are the phases that a gauge leaves to one motion.
const SAME: f64 = 1e-9;
/// Points of two branches this near are one, in parts of the reach.
const NEAR: f64 = 1e-4;

/// Questions that a force alone answers.
fn refuse_forced(question: &Respond) -> Result<(), Error> {
    let (code, what) = match question {
        Respond { second: Some(_), .. } => ("sweep", "one parameter varies"),
        Respond { follow: true, .. } => ("follow", "no period is known"),
        Respond { start: Some(_), .. } => {
            ("start", "no phase is fixed in which a start could settle")
        }
        _ => return Ok(()),
    };
    let message = format!("without a force {what}");
    Err(Refused::usage(code, message, "`lindstedt simulate` shows motions").into())
}

impl States {
    /// Where the motions are whose phase is free.
    pub(super) fn turning(&self) -> Vec<Vec<f64>> {
        let moving = self.list.iter().filter(|state| !state.drift.is_empty());
        moving.map(|state| state.at.clone()).collect()
    }
}

impl Subject<'_> {
    /// Adds the motions that are steady but for the free phase, in frames of their own, at values of the parameters.
    pub(super) fn with_free_phase(
        &self,
        free: &FreePhase,
        reach: f64,
        values: &Values,
        states: &mut States,
    ) -> Result<(), Error> {
        let size = Rational::from_f64(reach).ok_or(Error::NoValue)?;
        let divide = Rational::from(DIVIDE);
        let system = self.rotating.flow.system(values);
        let still = states.list.len();
        for (c, most) in [divide.clone(), divide.recip()].into_iter().enumerate() {
            let Some(flow) = free.reduced(c, &[size.clone(), most.clone()]) else {
                states.count_proved = false;
                states.undecided += 1;
                return Ok(());
            };
            let region =
                [Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0), Interval::new(0.0, 1.0)];
            let limits = Limits {
                modulus: Some(1.0),
                boxes: MOST_BOXES.min(self.boxes),
                ..self.limits(reach)
            };
            let found = all_zeros(&flow.system(values), &region, &limits).ok_or(Error::NoValue)?;
            states.boxes += found.boxes;
            states.undecided += found.undecided.len();
            states.at_edge += found.at_edge.len();
            for zero in &found.zeros {
                match self.turning(free, (c, &size, &most), (&system, values), zero) {
                    Kept::Yes(state) => {
                        let same = |other: &State| free.same(&state.at, &other.at, SAME * reach);
                        if !states.list[still..].iter().any(same) {
                            states.list.push(state);
                        }
                    }
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

    /// All motions without a force at values of the parameters: rest, and those of which the unknowns keep in step. Those of
    /// a family have its amplitude, and rest has none.
    fn in_step(
        &self,
        free: &FreePhase,
        reach: f64,
        sample: Option<&Exact>,
    ) -> Result<States, Error> {
        let values = self.values([sample, None]);
        let rate = self.rate(sample.map(Exact::to_f64));
        let rest = || {
            let point = steady::state_at(&self.rotating.flow.system(&values), &[0.0; 4]);
            let zero = proved(&Certified::from_rational(Balls::new(BITS), &Rational::new()));
            Some(State {
                amplitudes: vec![zero.clone()?, zero?],
                phases: vec![None, None],
                stable: self.is_stable(&point, rate),
                exponents: self.exponents(&point, rate),
                near_resonance: None,
                frequency: None,
                drift: Vec::new(),
                growth: 0.0,
                at: point.at,
            })
        };
        let mut states = States {
            value: sample.and_then(|value| self.shown_sample(value)),
            count: 0,
            count_proved: self.is_whole(),
            undecided: 0,
            at_edge: 0,
            boxes: 0,
            list: if free.energy.is_some() { Vec::new() } else { rest().into_iter().collect() },
        };
        self.with_free_phase(free, reach, &values, &mut states)?;
        Ok(states)
    }

    /// The motions without a force at the values set, or their branches over a parameter.
    pub(super) fn unforced(&self, free: &FreePhase, question: &Respond) -> Result<Response, Error> {
        refuse_forced(question)?;
        let Some(axis) = &question.sweep else {
            let reach = self.reach(&[self.values([None, None])])?;
            let (reach, complete) = (reach.modulus, reach.complete[0]);
            let mut response = self.empty(reach, complete);
            response.states.push(self.in_step(free, reach, None)?);
            return Ok(response);
        };
        let samples = self.samples(axis)?;
        let at: Vec<_> = samples.iter().map(|sample| self.values([Some(sample), None])).collect();
        let reach = self.reach(&at)?;
        let (reach, complete) = (reach.modulus, reach.complete[0]);
        let mut response = self.empty(reach, complete);
        response.parameter = Some(axis.name.clone());
        response.no_closed_missing = Some(false);
        let mut found = Vec::new();
        for sample in &samples {
            let states = self.in_step(free, reach, Some(sample))?;
            found.push((Value::from(sample), states.turning()));
            response.states.push(states);
        }
        let course = self.course(&samples, axis, reach)?;
        self.follow_turning(free, &found, &course, &mut response)?;
        if free.energy.is_none() {
            let Turning { branch, changes, .. } = free.rest(&self.values([None, None]), &course);
            let index = response.branches.len();
            response.branches.push(self.shown_branch(&branch));
            let born = changes.into_iter().map(|it| Located { branch: index, ..it });
            response.hopf.extend(born.filter_map(|it| self.shown_change(&it)));
        }
        Ok(response)
    }

    /// Adds the branches that pass motions found at values of the parameter, and where they change.
    pub(super) fn follow_turning(
        &self,
        free: &FreePhase,
        found: &[(Value, Vec<Vec<f64>>)],
        course: &steady::Course,
        response: &mut Response,
    ) -> Result<(), Error> {
        let open = self.open()[0].ok_or_else(not_determined)?;
        let course = steady::Course { parameter: open, ..course.clone() };
        let wide = course.range[1] - course.range[0];
        let values = self.values([None, None]);
        let mut known: Vec<&Located> = Vec::new();
        let branches = free.branches(&values, found, &course);
        let before = response.branches.len();
        let changes = branches.iter().flat_map(|it| &it.changes);
        let crossings: Vec<_> =
            changes.filter(|it| it.change == steady::Change::Crossing).collect();
        for Turning { branch, rates, changes } in &branches {
            let mut shown = self.shown_branch(branch);
            for (point, delta) in shown.points.iter_mut().zip(rates) {
                point.frequency = self.frequency(*delta, self.rate(Some(point.value.value)));
            }
            response.branches.push(shown);
            let same = |a: &[f64], b: &[f64], within: f64| free.same(a, b, within);
            let apparent =
                |it: &&Located| crossings.iter().any(|other| it.is_part_of(other, &course, same));
            for found in changes.iter().filter(|it| !apparent(it)) {
                // Each of two branches knows their crossing.
                let near = |it: &&Located| {
                    let same = it.change == found.change
                        && free.same(&it.at, &found.at, NEAR * course.reach);
                    same && (it.at[4] - found.at[4]).abs() < NEAR * wide
                };
                if known.iter().any(near) {
                    continue;
                }
                known.push(found);
                let list = match found.change {
                    steady::Change::Fold => &mut response.folds,
                    steady::Change::Hopf => &mut response.hopf,
                    _ => &mut response.crossings,
                };
                let branch = found.branch + before;
                list.extend(self.shown_change(&Located { branch, ..found.clone() }));
            }
        }
        Ok(())
    }

    /// What is said of phases that no force fixes; whether the states of a combination resonance are counted.
    pub(super) fn free_phases(&self, value: &Response, counted: bool) -> Option<Remark> {
        if let Some(modes) = &self.rotating.combination {
            let names: Vec<_> = modes.iter().map(|j| value.coordinates[*j].as_str()).collect();
            let rest = match counted {
                true => {
                    "the other turns freely, in every state with rates of its own; their frequencies differ by these from \
                     those of the frame"
                }
                false => {
                    "their amplitudes may be steady in other frames than this one; such motions are not among the states \
                     (`simulate` shows them)"
                }
            };
            return Some(Remark(format!(
                "combination resonance of {}: the force fixes one combination of their phases, and {rest}",
                names.join(", ")
            )));
        }
        if self.rotating.unforced().is_some() {
            return Some(Remark(self.of_free_motion()));
        }
        let text = "the resonances of these orders leave a phase free: a motion that is steady in another rotating frame is \
                    none of these states";
        (self.rotating.fixed < self.rotating.turns.len()).then(|| Remark(text.to_owned()))
    }

    /// What is said of motions without a force.
    fn of_free_motion(&self) -> String {
        let amplitude = match self.rotating.unforced() {
            Some(free) if free.energy.is_none() => None,
            Some(free) if !free.definite => Some(
                "the square of which is a_1^2 + a_2^2, since the signs of the unknowns' energies are not the same or not known",
            ),
            _ => {
                Some("which the first unknown alone would have with the same energy at order zero")
            }
        };
        let family = amplitude.map_or(String::new(), |amplitude| {
            format!(
                "; energy is conserved, the motions are normal modes of that amplitude, {amplitude}: another exponent 0 lies \
                 along their family"
            )
        });
        format!(
            "no force fixes the phase of a motion: the exponent 0 along it is not listed{family}"
        )
    }

    /// eta' of a motion.
    fn frequency(&self, delta: f64, rate: f64) -> Option<Estimate> {
        let unit = self.unit()?.midpoint().to_f64();
        let nu = self.slow.system.frequencies.first()?.to_f64();
        let free = self.rotating.unforced().is_some();
        free.then_some(Estimate { value: nu * unit + rate * delta })
    }

    /// The state of a zero of the reduced equations.
    fn turning(
        &self,
        free: &FreePhase,
        (c, size, most): (usize, &Rational, &Rational),
        (system, values): (&System, &Values),
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
        let rate = self
            .rate(self.open()[0].and_then(|k| values[k].as_ref()).map(|it| it.interval().middle()));
        let scaled = |d: &Rational| Estimate { value: rate * delta * d.to_f64() };
        Kept::Yes(State {
            amplitudes: amplitudes.to_vec(),
            phases: phases.to_vec(),
            stable: self.is_stable(&point, rate),
            exponents: self.exponents(&point, rate),
            near_resonance: None,
            frequency: self.frequency(delta, rate),
            drift: free.weights.iter().map(scaled).collect(),
            growth: self.growth(values, &at),
            at: at.to_vec(),
        })
    }
}

enum Kept {
    Yes(State),
    Beyond,
    AtEdge,
}
