//! Homoclinic tangencies, continued in a second parameter.

use crate::error::SimulateError;
use crate::integrator::Tick;
use crate::quantity::Quantity;
use crate::tangency::{Homoclinic, Tangency};
use rug::Float;
use std::ops::ControlFlow;

/// Follows a tangency while another parameter, `along`, takes the given values, with steps in
/// between where Newton's method needs them. The first value starts from `start` = (value, phase)
/// and from the guess of the saddle; then on from the two before. Equal values of `along` in
/// sequence repeat the same point.
///
/// The branch is followed, whether or not other tangencies have come before it. The observer is
/// told of every point asked for, and breaks off; `tick` is asked at every step of the integrations
/// behind it ([`SimulateError::Stopped`]).
///
/// Errors: [`SimulateError::NoTangency`] where the branch ends or 6 halvings do not help.
pub fn continue_tangency(
    homoclinic: &Homoclinic<'_>,
    (along, values): (&str, &[f64]),
    start: (f64, f64),
    tick: &Tick<'_>,
    observer: &mut dyn FnMut(f64, &Tangency) -> ControlFlow<()>,
) -> Result<(), SimulateError> {
    let mut branch = Branch { homoclinic, along, tick, known: Vec::new() };
    for target in values {
        let tangency = if branch.known.is_empty() {
            let first = Point { value: start.0, phase: start.1, saddle: homoclinic.guess };
            branch.place(*target, Some(first.phase), &first, true)?.1
        } else {
            branch.step(*target, 6, true)?
        };
        if let Some(tangency) = tangency
            && observer(*target, &tangency).is_break()
        {
            break;
        }
    }
    Ok(())
}

struct Branch<'a, 'h> {
    homoclinic: &'a Homoclinic<'h>,
    along: &'a str,
    tick: &'a Tick<'a>,
    /// Values of the other parameter, no two neighbours equal, and the points there.
    known: Vec<(f64, Point)>,
}

/// A value and a phase of the tangency, and the saddle there.
#[derive(Clone, Copy)]
struct Point {
    value: f64,
    phase: f64,
    saddle: [f64; 2],
}

impl Point {
    /// self + weight (other - self).
    fn towards(&self, other: &Self, weight: f64) -> Self {
        let between = |from: f64, to: f64| from + weight * (to - from);
        Self {
            value: between(self.value, other.value),
            phase: between(self.phase, other.phase),
            saddle: [0, 1].map(|k| between(self.saddle[k], other.saddle[k])),
        }
    }
}

impl Branch<'_, '_> {
    /// The tangency at a value of the other parameter, from a prediction, with its error if that is asked for; the
    /// phase is looked for where none is given.
    fn place(
        &mut self,
        target: f64,
        phase: Option<f64>,
        predicted: &Point,
        asked: bool,
    ) -> Result<(Point, Option<Tangency>), SimulateError> {
        let (value, tick) = (predicted.value, self.tick);
        let mut parameters = self.homoclinic.parameters.clone();
        parameters.set(self.along, Quantity::Float(Float::with_val(53, target)));
        let guess = predicted.saddle;
        let homoclinic = Homoclinic { parameters: &parameters, guess, ..*self.homoclinic };
        let sought = phase.map_or_else(|| homoclinic.extremum(value, tick), Ok)?;
        let near = homoclinic.near(value, sought, tick)?;
        let (mut point, mut tangency) =
            (Point { value: near.value, phase: near.phase, saddle: near.saddle.state }, None);
        // Far from the prediction: another branch.
        if !self.known.is_empty() && (near.value - value).abs() >= 0.01 * value.abs() {
            return Err(SimulateError::NoTangency { value });
        }
        if asked {
            let found = homoclinic.refined(near, tick)?;
            (point.value, point.phase) = (found.value, found.phase);
            tangency = Some(found);
        }
        if phase.is_none() {
            // Counted from another turn, or the phases jump: those before are told from here on, for the next
            // prediction.
            let jump = point.phase - predicted.phase;
            let turns = jump.round();
            let jump = if (jump - turns).abs() < 0.1 { turns } else { jump };
            self.known.iter_mut().for_each(|(_, known)| known.phase += jump);
        }
        if self.known.last().is_some_and(|last| last.0 == target) {
            self.known.pop();
        }
        self.known.push((target, point));
        Ok((point, tangency))
    }

    /// By the polynomial through the last three points (Neville's scheme).
    fn predicted(&self, target: f64) -> Option<Point> {
        let mut table: Vec<_> = self.known.iter().rev().take(3).copied().collect();
        for apart in 1..table.len() {
            for k in 0..table.len() - apart {
                let (near, far) = (self.known[self.known.len() - 1 - k].0, table[k + apart].0);
                let weight = (target - near) / (far - near);
                table[k].1 = table[k].1.towards(&table[k + 1].1, weight);
            }
        }
        table.first().map(|first| first.1)
    }

    fn step(
        &mut self,
        target: f64,
        halvings: u32,
        asked: bool,
    ) -> Result<Option<Tangency>, SimulateError> {
        let ahead = self.known.last().map(|last| last.0).zip(self.predicted(target));
        let Some((last, predicted)) = ahead else {
            return Err(SimulateError::NoTangency { value: f64::NAN });
        };
        // The phase jumps where the saddle orbit begins to stick: looked for again then.
        for phase in [Some(predicted.phase), None] {
            match self.place(target, phase, &predicted, asked) {
                Ok((_, tangency)) => return Ok(tangency),
                Err(SimulateError::Stopped) => return Err(SimulateError::Stopped),
                Err(_) => {}
            }
        }
        if halvings == 0 {
            return Err(SimulateError::NoTangency { value: predicted.value });
        }
        self.step((last + target) / 2.0, halvings - 1, false)?;
        self.step(target, halvings - 1, asked)
    }
}
