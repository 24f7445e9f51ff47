//! The threshold to second order in the small parameter, orbit by orbit, and the manifolds that judge it.

use super::subject::Subject;
use crate::answer::estimated;
use crate::refusal::Refused;
use crate::{Error, Number};
use lindstedt_melnikov::splitting::SecondOrder;
use lindstedt_number::Exact;
use lindstedt_recognise::{GAMMA, OrbitSplitting, SplittingProblem};
use lindstedt_simulate::{Homoclinic, Loop, Model, Parameters, SimulateError, TangencyLine};
use rug::Rational;
use serde::Serialize;
use std::ops::ControlFlow;

/// The threshold on one orbit, gamma_c + slope eps + O(eps^2). Estimated.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SecondOrderThreshold {
    /// Which orbit; with its saddle where there are several.
    pub name: String,
    /// The small parameter.
    pub parameter: String,
    /// gamma_c.
    pub gamma_c: Number,
    /// Its derivative by the small parameter at 0, by Melnikov's integral of second order.
    pub slope: Number,
    /// The derivative for negative values of the small parameter, where it is another one: of several equal extrema of
    /// the work each has a tangency, and the first is the threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope_below: Option<Number>,
    /// The same from the manifolds themselves, of a loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub manifolds: Option<Manifolds>,
    /// Why not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_followed: Option<String>,
}

/// The first tangency of the manifolds at some values of the small parameter, extrapolated to 0.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Manifolds {
    /// gamma_c.
    pub gamma_c: Number,
    /// Its derivative.
    pub slope: Number,
    /// What they are extrapolated from.
    pub points: Vec<ManifoldPoint>,
}

/// A tangency.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ManifoldPoint {
    /// The small parameter.
    pub small: f64,
    /// gamma there.
    pub gamma: Number,
}

/// Orbits followed round the loop for the first tangency, then more of them.
const ORBITS: [u32; 2] = [24, 61];
/// The perturbation against the force of eps = 0 at the smallest eps; the largest is eight times as large.
const SMALL: f64 = 1.0 / 1024.0;
/// How far from gamma_c the tangency at the smallest eps is looked for, as a share of it and in slopes.
const AROUND: (f64, f64) = (0.02, 3.0);

/// The threshold to second order on every orbit.
///
/// `first` has gamma_c of every orbit by Melnikov's integral of first order, or one for all mirror images.
pub(super) fn list(
    subject: &Subject<'_>,
    first: &[&Number],
) -> Result<Vec<SecondOrderThreshold>, Error> {
    let problem = subject.splitting()?;
    let orbits = problem.orbits(&subject.work.stop);
    let saddle = |orbit: &OrbitSplitting| orbit.orbit.saddles[0];
    let several = orbits.iter().any(|orbit| is_loop(orbit) && saddle(orbit) != saddle(&orbits[0]));
    let mut list = Vec::new();
    for (index, orbit) in orbits.iter().enumerate() {
        let of_first_order = first.get(index).or(first.first());
        let of_first_order = of_first_order.and_then(|number| number.decimal.parse::<f64>().ok());
        // Where the work of the force cancels to rounding errors this integral is not that one.
        let gap = |found: &SecondOrder| {
            of_first_order.map_or(f64::INFINITY, |gamma| (found.signed.abs() - gamma).abs())
        };
        let known = orbit.found.as_ref().filter(|found| gap(found) < 1e-5 * found.signed.abs());
        let Some(found) = known else {
            let message = format!(
                "the second order on the {} was not found: there D = 0, or x' = v* is not passed with a speed, or the force works too little on it for doubles",
                orbit.name
            );
            return Err(Refused::undecided(
                "could-not-decide",
                message,
                "other values of the parameters",
            )
            .into());
        };
        let followed = follow(subject, &problem, orbit, found)?;
        let (manifolds, not_followed) = match followed {
            // Of two extremes of the work that are equal each has a tangency, and one is the threshold.
            Ok(line) if is_another(&line, found) => (
                None,
                Some(format!("the tangency met is another one, of the slope {}", line.slope)),
            ),
            Ok(line) => (Some(manifolds(&line)?), None),
            Err(reason) => (None, Some(reason)),
        };
        let gamma = found.signed.abs();
        list.push(SecondOrderThreshold {
            name: if several {
                format!("{} at x = {}", orbit.name, saddle(orbit))
            } else {
                orbit.name.to_owned()
            },
            parameter: subject.oscillator.problem().small.to_string(),
            gamma_c: estimated(gamma, found.signed_error + 2.0 * gap(found))?,
            slope: estimated(found.slope, found.error)?,
            slope_below: several_slopes(found)
                .then(|| estimated(found.slope_below, found.error))
                .transpose()?,
            manifolds,
            not_followed,
        });
    }
    Ok(list)
}

fn is_loop(orbit: &OrbitSplitting) -> bool {
    orbit.orbit.saddles[0] == orbit.orbit.saddles[1]
}

/// Whether equal extrema of the work have tangencies of different slopes.
fn several_slopes(found: &SecondOrder) -> bool {
    (found.slope_below - found.slope).abs() > 2.0 * found.error
}

fn is_another(line: &TangencyLine, found: &SecondOrder) -> bool {
    let gaps = [line.intercept - found.signed.abs(), line.slope - found.slope];
    let errors = [line.errors[0] + found.signed_error, line.errors[1] + found.error];
    gaps.iter().zip(errors).any(|(gap, error)| gap.abs() > 3.0 * error)
}

fn manifolds(line: &TangencyLine) -> Result<Manifolds, Error> {
    let point = |[small, gamma, error]: &[f64; 3]| {
        Ok(ManifoldPoint { small: *small, gamma: estimated(*gamma, *error)? })
    };
    Ok(Manifolds {
        gamma_c: estimated(line.intercept, line.errors[0])?,
        slope: estimated(line.slope, line.errors[1])?,
        points: line.points.iter().map(point).collect::<Result<_, Error>>()?,
    })
}

/// The tangencies of a loop at small eps, or why there are none.
fn follow(
    subject: &Subject<'_>,
    problem: &SplittingProblem,
    orbit: &OrbitSplitting,
    found: &SecondOrder,
) -> Result<Result<TangencyLine, String>, Error> {
    if !is_loop(orbit) {
        return Ok(Err("the tangency of manifolds of two saddles is not followed".to_owned()));
    }
    // A power of two.
    let small = (SMALL / found.strength).log2().round().exp2();
    let values = [1.0, 2.0, 4.0, 8.0].map(|k| k * small);
    let gamma = found.signed.abs();
    let width = (AROUND.0 * gamma).max(AROUND.1 * small * found.slope.abs());
    let model = Model::second_order(&problem.equation())?.with_small("eps");
    let parameters = Parameters::new().with("pi", Exact::PiTimes(Rational::from(1)));
    let side = if orbit.orbit.middle > orbit.orbit.saddles[0] { Loop::Right } else { Loop::Left };
    let (period, guess) = (problem.period(), [orbit.orbit.saddles[0], 0.0]);
    let homoclinic =
        Homoclinic { model: &model, parameters: &parameters, name: GAMMA, period, side, guess };
    let tick = || {
        if subject.work.stop.asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let bracket = (gamma - width, gamma + width);
    let [few, more] = ORBITS
        .map(|count| move || homoclinic.tangent_line(("eps", &values), bracket, count, &tick));
    let line = few().or_else(|failure| match failure {
        SimulateError::NoTangency { .. } => more(),
        other => Err(other),
    });
    Ok(line.map_err(|failure| match failure {
        SimulateError::Stopped => "stopped".to_owned(),
        other => other.to_string(),
    }))
}
