//! Where a motion ends: poles of x(t), and steps that come to a halt.

use super::Integrator;
use super::real::Real;
use crate::error::SimulateError;

/// The step at which x, on its way from zero, counted as escaping (see [`Integrator::escapes`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Runaway {
    steps: u64,
    /// log2 |x|.
    size: f64,
    /// log2 |x/x'|.
    time: f64,
}

impl<R: Real> Integrator<'_, R> {
    /// Whether steps end at a singularity of x(t): x has left its start by 2^10 and the largest state
    /// by 2^20, or x' alone by 2^20.
    pub(super) fn escapes(&self) -> bool {
        let real = &self.system.real;
        let size = |x: &R::Element| real.log2(x);
        let largest = self.state.iter().map(size).fold(f64::NEG_INFINITY, f64::max);
        let above = |index: usize, bits: f64| {
            self.state.get(index).is_some_and(|x| size(x) > self.log2_start + bits)
        };
        above(0, 10.0) && largest > self.log2_start + 20.0 || above(1, 20.0)
    }

    /// Whether x or x' is near 2^1024, where doubles end: no pole, however large.
    pub(super) fn overflows(&self) -> bool {
        let real = &self.system.real;
        real.bits() <= 53 && self.state.iter().any(|x| real.log2(x) > 900.0)
    }

    /// A pole of x(t) that steps do not come near to, because the motion is stiff there: after
    /// x = C (t* - t)^-p, |x/x'| = (t* - t)/p, while |x| grows by a factor 2^g the time |x/x'|
    /// shrinks by 2^s with g = p s. Said where s is four or more with p up to 10 (a double
    /// exponential has a larger one by then) and more steps were taken on the way than to a pole
    /// that is not stiff.
    pub(super) fn runs_away(&mut self) -> Option<SimulateError> {
        let real = &self.system.real;
        let [x, velocity] = self.state.get(..2)? else { return None };
        let outwards = real.sign(x) * real.sign(velocity) > 0;
        let size = real.log2(x);
        let time = size - real.log2(velocity);
        if !outwards || size <= self.log2_start + 10.0 || !self.escapes() {
            self.runaway = None;
            return None;
        }
        let steps = self.work.steps;
        let began = *self.runaway.get_or_insert(Runaway { steps, size, time });
        let (grown, shrunk) = (size - began.size, began.time - time);
        let many = 1000 + 16 * u64::from(real.bits());
        let is_pole = shrunk >= 4.0 && grown > 0.0 && grown <= 10.0 * shrunk;
        (steps - began.steps > many && is_pole).then(|| SimulateError::Escape {
            time: self.seconds() + time.exp2() * grown / shrunk,
            displacement: real.to_f64(x),
        })
    }

    /// |w|^p near w = 0 or another singularity.
    pub(super) fn stuck(&self, time: f64) -> SimulateError {
        let real = &self.system.real;
        let near = |row: usize| real.log2(self.series.rows.at(row, 0));
        let nearest = (0..self.system.switches.len())
            .filter(|index| self.system.switches[*index].branch)
            .min_by(|a, b| {
                let rows = (self.system.switches[*a].row, self.system.switches[*b].row);
                near(rows.0).total_cmp(&near(rows.1))
            });
        match nearest {
            Some(switch) => SimulateError::BranchPoint { switch, time },
            None if self.escapes() => {
                // x has left its start by 2^10 at a pole; in a collision, or where x grows like a
                // logarithm, x' alone is unbounded.
                let x = self.state.first();
                let displacement = x.map_or(f64::NAN, |x| real.to_f64(x));
                if self.overflows() {
                    return SimulateError::Overflow { time };
                }
                if x.is_some_and(|x| real.log2(x) > self.log2_start + 10.0) {
                    SimulateError::Escape { time, displacement }
                } else {
                    SimulateError::UnboundedVelocity { time, displacement }
                }
            }
            None => SimulateError::StepTooSmall { time },
        }
    }
}
