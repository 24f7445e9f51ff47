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
            let first = branch.place(*target, (start.0, Some(start.1)), homoclinic.guess)?;
            branch.known.push(first);
            first.1
        } else {
            branch.step(*target, 6)?
        };
        if observer(*target, &tangency).is_break() {
            break;
        }
    }
    Ok(())
}

struct Branch<'a, 'h> {
    homoclinic: &'a Homoclinic<'h>,
    along: &'a str,
    tick: &'a Tick<'a>,
    known: Vec<Known>,
}

/// A value of the other parameter, the tangency and the saddle there.
type Known = (f64, Tangency, [f64; 2]);

impl Branch<'_, '_> {
    fn place(
        &self,
        target: f64,
        (value, phase): (f64, Option<f64>),
        guess: [f64; 2],
    ) -> Result<Known, SimulateError> {
        let mut parameters = self.homoclinic.parameters.clone();
        parameters.set(self.along, Quantity::Float(Float::with_val(53, target)));
        let homoclinic = Homoclinic { parameters: &parameters, guess, ..*self.homoclinic };
        let phase = match phase {
            Some(phase) => phase,
            None => homoclinic.extremum(value, self.tick)?,
        };
        let tangency = homoclinic.tangency(value, phase, self.tick)?;
        let saddle = homoclinic.saddle(tangency.value, self.tick)?;
        Ok((target, tangency, saddle.state))
    }

    fn step(&mut self, target: f64, halvings: u32) -> Result<Tangency, SimulateError> {
        let Some((last, tangency, saddle)) = self.known.last().copied() else {
            return Err(SimulateError::NoTangency { value: f64::NAN });
        };
        let before = self.known.len().checked_sub(2).and_then(|index| self.known.get(index));
        let before = before.filter(|before| before.0 != last);
        let share = before.map_or(0.0, |before| (target - last) / (last - before.0));
        let (old, place) = before.map_or((tangency, saddle), |before| (before.1, before.2));
        let value = tangency.value + share * (tangency.value - old.value);
        let phase = tangency.phase + share * (tangency.phase - old.phase);
        let guess = [0, 1].map(|k| saddle[k] + share * (saddle[k] - place[k]));
        // The phase jumps where the saddle orbit begins to stick: looked for again then.
        for phase in [Some(phase), None] {
            let found = self.place(target, (value, phase), guess);
            if matches!(found, Err(SimulateError::Stopped)) {
                return Err(SimulateError::Stopped);
            }
            // Far from the prediction: another branch.
            if let Ok(found) = found
                && (found.1.value - value).abs() < 0.02 * value.abs()
            {
                self.known.push(found);
                return Ok(found.1);
            }
        }
        if halvings == 0 {
            return Err(SimulateError::NoTangency { value });
        }
        self.step((last + target) / 2.0, halvings - 1)?;
        self.step(target, halvings - 1)
    }
}
