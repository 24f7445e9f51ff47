//! All values of a parameter between two proved orbits.
//!
//! On a part of the interval the field has balls for coefficients, the numerical orbit moves along the
//! tangent of the family, and one contraction test proves an orbit for each value in it. Two tests belong to one family where the orbit of the one lies in the ball
//! in which that of the other is alone, at the value that they share ([`Proof::is_same_as`]). A chain of
//! parts from one neighbour to the other proves: for every value between there is exactly one orbit near the
//! numerical ones, and the neighbours are its ends.

use super::between::middle;
use super::extrapolated;
use super::part::{Part, Refused, Size};
use crate::place::Place;
use crate::{Failure, Field, Kind, Proof, Request};
use lindstedt_number::ball::Ball;
use rug::{Float, Rational};

/// Halvings of the whole interval for its smallest part.
const MOST_HALVINGS: u32 = 7;
/// How much longer the part after one that succeeded is, and how much shorter one after a failure, at most.
const MOST_LONGER: f64 = 2.0;
const LEAST_LONGER: f64 = 0.125;
/// Lengths are multiples of the interval over 2 to this power.
const STEP_BITS: u32 = 16;
/// Of the length that the bounds seem to allow, so much is tried.
const CARE: f64 = 0.8;

/// What is proved of the values between two neighbours.
#[derive(Clone, Debug)]
pub struct Cover {
    /// The parts of the interval with a contraction test each.
    pub parts: u32,
    /// The largest distance of an orbit from the numerical one of its part.
    pub radius: Float,
    /// The frequencies of all orbits.
    pub frequency: Option<Ball>,
    /// The value up to which the parts reach.
    pub until: Rational,
    /// Why they do not reach the other end; nothing where they do.
    pub failure: Option<Failure>,
}

/// Proves the orbits for all values between two proved ones; `problem` is the field and the question for
/// all values between two numbers ([`Field::between`], [`Kind::between`]; where both vary, with the one
/// parameter, both growing with it or both falling). A part is as long as its bounds allow; ends where one
/// of a 128th of the interval fails. The cost is a proof of few digits per part.
///
/// ```
/// use lindstedt_equation::{Expression, Problem};
/// use lindstedt_orbit::{Field, Kind, Request, Start, cover, family};
/// use std::collections::BTreeMap;
/// let x = Expression::DISPLACEMENT;
/// let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let duffing = Problem::new("duffing", equation);
/// let kind = Kind::InitialAmplitude(1.into());
/// let at = |eps: &rug::Rational| {
///     let values = BTreeMap::from([("eps".to_owned(), eps.clone())]);
///     Ok((Field::of_problem(&duffing, &values)?, kind.clone()))
/// };
/// let between = |ends: &[rug::Rational; 2]| {
///     Ok((Field::between(&duffing, &BTreeMap::new(), "eps", ends)?, kind.clone()))
/// };
/// let start = Start { frequency: 1.17, cosines: vec![0.0, 1.0], sines: vec![] };
/// let ends = [(1, 2), (3, 5)].map(rug::Rational::from);
/// let members = family(&ends, at, &[start], &Request::default())?;
/// let proofs: Vec<_> = members.iter().flat_map(|m| &m.proof).collect();
/// let between = cover(&ends, [proofs[0], proofs[1]], between, &Request::default());
/// assert!(between.failure.is_none());
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn cover(
    ends: &[Rational; 2],
    proofs: [&Proof; 2],
    problem: impl Fn(&[Rational; 2]) -> Result<(Field, Kind), Failure>,
    request: &Request,
) -> Cover {
    let [left, right] = proofs;
    let ends_in_doubles = [(ends[0].clone(), left.starts()), (ends[1].clone(), right.starts())];
    let size = Size { modes: left.modes.max(right.modes), weight: left.weight.max(right.weight) };
    let places = proofs.map(Proof::place);
    let part = |part: &[Rational; 2], before: &Place| {
        if request.stop.asked() {
            return Err(Failure::Stopped.into());
        }
        let start = extrapolated(&ends_in_doubles, &middle(part));
        let found = Part::new(&problem(part)?, &start, size, part[0] < part[1], request)?;
        // A coefficient that vanishes in the middle alone would show a symmetry that the others lack.
        let alike = proofs.iter().all(|end| end.parity == found.parity);
        let last = part[1] == ends[1];
        let meets =
            found.at(false).is_same_as(before) && (!last || found.at(true).is_same_as(&places[1]));
        let apart = || Failure::Apart { radius: found.radius.to_f64() };
        if alike && meets { Ok(found) } else { Err(Refused::from(apart())) }
    };
    let whole = Rational::from(&ends[1] - &ends[0]);
    let smallest = Rational::from(whole.abs_ref()) >> MOST_HALVINGS;
    let mut cover = Cover {
        parts: 0,
        radius: Float::new(53),
        frequency: None,
        until: ends[0].clone(),
        failure: None,
    };
    let (mut width, mut last): (Rational, Option<Place>) = (whole.clone(), None);
    while cover.until != ends[1] {
        // Numbers that do not grow.
        let steps = Rational::from(&width / &whole) << STEP_BITS;
        width = (steps.floor() >> STEP_BITS) * &whole;
        let rest = Rational::from(&ends[1] - &cover.until);
        if Rational::from(rest.abs_ref()) <= *width.as_abs() {
            width = rest;
        }
        let to = Rational::from(&cover.until + &width);
        match part(&[cover.until.clone(), to.clone()], last.as_ref().unwrap_or(&places[0])) {
            Ok(found) => {
                cover.add(&found, to, proofs);
                width *= times(found.room, MOST_LONGER);
                if *width.as_abs() < smallest {
                    width = Rational::from(&whole >> MOST_HALVINGS);
                }
                last = Some(found.at(true));
            }
            Err(Refused { failure, room }) => {
                width *= times(room.unwrap_or(0.0), 0.5);
                let ends = matches!(failure, Failure::Stopped) || !is_local(&failure);
                if ends || *width.as_abs() < smallest {
                    cover.failure = Some(failure);
                    return cover;
                }
            }
        }
    }
    cover
}

/// The factor for the length of the next part, where this one could have been so many times longer.
fn times(room: f64, most: f64) -> Rational {
    let factor = (CARE * room).clamp(LEAST_LONGER, most);
    Rational::from(((factor * 64.0) as u32, 64))
}

/// Whether a shorter part may succeed.
fn is_local(failure: &Failure) -> bool {
    matches!(
        failure,
        Failure::NoContraction { .. }
            | Failure::Residual { .. }
            | Failure::Apart { .. }
            | Failure::NoPeriod { .. }
            | Failure::NoFunction { .. }
            | Failure::NotConverged { .. }
    )
}

impl Cover {
    fn add(&mut self, part: &Part, to: Rational, [left, right]: [&Proof; 2]) {
        self.parts += 1;
        self.until = to;
        if part.radius > self.radius {
            self.radius.clone_from(&part.radius);
        }
        let hull = |one: &Ball, other: &Ball| left.balls().hull(one, other);
        // That of a force which varies is, of a part, the one in its middle: those of the ends are its limits.
        let known = self.frequency.take();
        let known = known.unwrap_or_else(|| hull(&left.frequency, &right.frequency));
        self.frequency = Some(hull(&known, &part.frequency));
    }
}
