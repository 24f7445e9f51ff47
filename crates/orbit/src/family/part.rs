//! One contraction test for all values of a part of an interval.

use crate::bounds::{Frame, Measure, Weights};
use crate::centre::Centre;
use crate::drift::Drift;
use crate::linear::Inverse;
use crate::newton::{balance, invert, linearised, refine};
use crate::place::Place;
use crate::proof::frequency_error;
use crate::radii::{Radii, decide};
use crate::task::Task;
use crate::upward::Up;
use crate::{Condition, Failure, Field, Kind, Parity, Request, Start};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

/// Digits of the numerical solution.
const DIGITS: u32 = 12;
/// The numerical solution has at most this many times the modes of the inverse.
const MOST_TIMES: usize = 4;

/// Exactly one orbit for every value, within the radius of a place of the centre.
pub(super) struct Part {
    pub(super) parity: Parity,
    pub(super) radius: Float,
    /// Those of all these orbits.
    pub(super) frequency: Ball,
    /// About how many times longer the part could be.
    pub(super) room: f64,
    unique_within: Float,
    weight: f64,
    scale: f64,
    centre: Centre,
    drift: Option<Drift>,
    /// s at the first end, and how far the ends are from -1 and 1.
    from: f64,
    slack: Up,
    condition: Option<(Condition, Rational, Up)>,
}

/// What failed, and about how long a part would not.
pub(super) struct Refused {
    pub(super) failure: Failure,
    pub(super) room: Option<f64>,
}

impl From<Failure> for Refused {
    fn from(failure: Failure) -> Self {
        Self { failure, room: None }
    }
}

/// The modes of the inverse and nu: those of a neighbour do.
#[derive(Clone, Copy)]
pub(super) struct Size {
    pub(super) modes: usize,
    pub(super) weight: f64,
}

impl Part {
    /// The test for all values from the first to the last; `upward` where the values are.
    pub(super) fn new(
        (field, kind): &(Field, Kind),
        starts: &[Start],
        size: Size,
        upward: bool,
        request: &Request,
    ) -> Result<Self, Refused> {
        let (task, guess) = Task::new(field, kind, starts, &request.stop)?;
        let rough = balance(&task, guess, size.modes)?;
        let inverse = invert(&linearised(&task, &rough)?.1, size.modes)?;
        let target = rough.largest() / Float::with_val(53, Float::i_pow_u(10, DIGITS));
        let most = MOST_TIMES * size.modes;
        let centre = refine(&task, rough, &inverse, &target, most)?;
        let (values, linear) = linearised(&task, &centre)?;
        let drift = Drift::new(&task, (&centre, &values, &linear), &inverse)?;
        let mut frame = Frame::new(&task, &centre, &values, &linear, &inverse);
        frame.drift = drift.as_ref();
        let weights = frame.weights(size.weight)?;
        let (radii, room) = judged(&frame, &inverse, &weights)?;
        let frequency = frequencies(&frame, &weights, &radii.radius, &centre, drift.as_ref());
        let known = !task.is_free() || frequency.is_positive();
        if !known {
            return Err(Failure::NoPeriod { radius: radii.radius.to_f64() }.into());
        }
        let varying = task.field.varying.as_ref().map(|varying| (varying.from, varying.slack));
        let (from, slack) = varying.unwrap_or((if upward { -1.0 } else { 1.0 }, Up::ZERO));
        let length = drift.as_ref().map_or(Up::ZERO, |d| Up::of_float(&frame.length(d, &weights)));
        Ok(Self {
            parity: task.rows.parity,
            radius: radii.radius,
            frequency,
            room,
            unique_within: radii.unique_within,
            weight: weights.nu().0,
            scale: frame.scale(),
            from,
            slack: slack * length,
            condition: task.asked(),
            drift,
            centre,
        })
    }

    /// Where the orbit of the first or of the last value is.
    pub(super) fn at(&self, last: bool) -> Place {
        let s = if last { -self.from } else { self.from };
        let centre = self.drift.as_ref().map(|drift| drift.moved(&self.centre, s));
        Place {
            parity: self.parity,
            weight: self.weight,
            scale: self.scale,
            centre: centre.unwrap_or_else(|| self.centre.clone()),
            slack: self.slack,
            radius: self.radius.clone(),
            unique_within: self.unique_within.clone(),
            condition: self.condition.clone(),
        }
    }
}

/// The radii, and the factor by which a part could be longer: what comes from the drift grows with the length in
/// Z1 and with its square in Y0.
fn judged(
    frame: &Frame<'_>,
    inverse: &Inverse,
    weights: &Weights,
) -> Result<(Radii, f64), Refused> {
    let bounds = frame.contraction(Measure::Norm, weights);
    let curvature = |r: &Float| frame.z2(&bounds, weights, &frame.around(weights, r));
    let left = 1.0 - (bounds.z0.0 + bounds.z1.0 - bounds.change.0);
    let load = 2.0 * curvature(&Float::new(53)).0 * bounds.y0.to_f64();
    let room = left / (bounds.change.0 + load.sqrt());
    let radii = decide(&bounds, inverse.modes, curvature);
    let radii = radii.map_err(|failure| Refused { failure, room: Some(room) })?;
    Ok((radii, room))
}

/// omega of all places, with the error of each.
fn frequencies(
    frame: &Frame<'_>,
    weights: &Weights,
    radius: &Float,
    centre: &Centre,
    drift: Option<&Drift>,
) -> Ball {
    let balls = Balls::new(centre.bits + 16);
    let middle = balls.from_rational(&centre.frequency);
    // The condition is nothing of a forced orbit: its frequency is known.
    if !frame.is_free() {
        return middle;
    }
    let moved = drift.map_or(Up::ZERO, |drift| Up::of(&drift.step.frequency));
    let error = frequency_error(frame, weights, radius);
    balls.add_error(&balls.add_error(&middle, &error), &Float::with_val(53, moved.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove_all;
    use lindstedt_equation::{Expression, Problem};

    /// Coefficients within balls of their own and an interval of amplitudes: both ends of both are covered.
    #[test]
    fn uncertainties_that_do_not_move_together_are_covered() {
        let x = Expression::DISPLACEMENT;
        let of = |e: Expression| Expression::ACCELERATION + x.clone() + e * x.clone().pow(3);
        let balls = Balls::new(128);
        let ball = balls.add_error(&balls.one(), &Float::with_val(53, 1e-3));
        let values = [("e".to_owned(), ball)].into();
        let field = Field::within(&of(Expression::parameter("e")), "eps", &values, 128).unwrap();
        let (value, error) = (Rational::from(1), Rational::from((1, 1000)));
        let kind = Kind::InitialWithin { value, error };
        let start = [Start { frequency: 1.3, cosines: vec![0.0, 1.0], sines: vec![] }];
        let size = Size { modes: 12, weight: 1.0 };
        let part = Part::new(&(field, kind), &start, size, true, &Request::default());
        let Ok(part) = part else { panic!("not proved") };
        for (e, a) in [(999, 1001), (1001, 999), (1001, 1001)] {
            let end = Field::new(&of(Expression::Number((e, 1000).into())), "eps", &[].into());
            let kind = Kind::InitialAmplitude(Rational::from((a, 1000)));
            let proof = prove_all(&end.unwrap(), &kind, &start, &Request::default()).unwrap();
            let frequency = proof.frequency.midpoint().to_rational().unwrap();
            assert!(part.frequency.contains(&frequency), "{e} {a}: {:?}", part.frequency);
            let apart =
                part.at(false).centre.distance(&proof.place().centre, Up::ONE, Some(part.scale));
            assert!(apart.0 <= part.radius.to_f64(), "{e} {a}: {apart:?}");
        }
    }

    /// Duffing over a part: at both ends the frequency is in the ball, the orbit is in its place.
    #[test]
    fn both_ends_of_a_part_are_in_it() {
        let x = Expression::DISPLACEMENT;
        let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
        let duffing = Problem::new("duffing", equation);
        let kind = Kind::InitialAmplitude(1.into());
        let start = [Start { frequency: 1.17, cosines: vec![0.0, 1.0], sines: vec![] }];
        let request = Request { digits: 20, ..Request::default() };
        for ends in [[(1, 2), (13, 25)], [(13, 25), (1, 2)]] {
            let ends = ends.map(Rational::from);
            let field = Field::between(&duffing, &Default::default(), "eps", &ends).unwrap();
            let size = Size { modes: 12, weight: 1.0 };
            let upward = ends[0] < ends[1];
            let part = Part::new(&(field, kind.clone()), &start, size, upward, &request);
            let Ok(part) = part else { panic!("not proved") };
            for (last, end) in ends.iter().enumerate() {
                let values = [("eps".to_owned(), end.clone())].into();
                let field = Field::of_problem(&duffing, &values).unwrap();
                let proof = prove_all(&field, &kind, &start, &request).unwrap();
                let frequency = proof.frequency.midpoint().to_rational().unwrap();
                assert!(part.frequency.contains(&frequency), "{:?}", part.frequency);
                let (place, there) = (part.at(last == 1), proof.place());
                let apart = place.centre.distance(&there.centre, Up::ONE, Some(part.scale));
                assert!(apart.0 <= part.radius.to_f64() && apart.0 > 1e-3 * part.radius.to_f64());
                let other = part.at(last == 0).centre.distance(&there.centre, Up::ONE, None);
                assert!(other.0 > 1e-3 && place.is_same_as(&there));
            }
        }
    }
}
