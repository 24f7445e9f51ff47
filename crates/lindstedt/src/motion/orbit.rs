//! The start on the periodic impact orbit: a wall and a delay of whole periods of the force.

use super::Branch;
use super::history::{Evaluator, Linear};
use crate::refusal::Refused;
use crate::{Error, Oscillator};
use lindstedt_algebra::Stop;
use lindstedt_equation::Crossing;
use lindstedt_impact::flight::clearance;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::ExactParameters;
use lindstedt_number::real::{Certified, Real as _};
use lindstedt_recognise::ImpactProblem;
use rug::Float;

/// The orbit with one impact in k periods of the force.
pub(super) struct Orbit {
    /// T = 2 pi k/omega.
    pub period: Float,
    /// x' before the impact.
    pub velocity: Float,
    /// x' after it.
    pub start: Float,
    /// The force is P0 cos(omega (t + advance)), t from the impact.
    pub advance: Float,
    /// x at the impact.
    pub wall: Float,
}

/// The parameters of the impact oscillator of section 2 of the paper, where the equation has its form
/// as it stands: a wall above, x'' with factor one, one force P0 cos(omega t), a loop over k periods.
pub(super) fn recognised(
    oscillator: &Oscillator,
    branch: Branch,
    evaluator: &Evaluator<'_>,
) -> Option<ExactParameters> {
    let problem = oscillator.problem();
    problem.synchronous.as_ref()?;
    problem.impact.as_ref().filter(|wall| wall.crossing == Crossing::Rising)?;
    let [d, _, _, m, p, q] = Linear::of(&problem.equation, evaluator)?.parts;
    let plain = d.is_zero() && m == 1 && p < 0 && q.is_zero();
    let values = oscillator.all_values().into_iter().collect();
    let found = plain.then(|| ImpactProblem::new(problem, &values, None, branch))?;
    Some(found.ok()?.parameters)
}

impl Orbit {
    /// The orbit of these parameters.
    pub fn of(parameters: &ExactParameters, bits: u32) -> Result<Self, Error> {
        let p = parameters.certified(bits);
        let real = |x: &Certified| Float::with_val(bits, x.ball().midpoint());
        let orbit = orbit(&p)?;
        if let Ok(Some(found)) = clearance(&p, &orbit, &Stop::default())
            && found.margin.is_positive()
        {
            let message = "no orbit: the flight passes through the wall";
            let hint = "give a start with --state";
            return Err(Refused::no_answer("no-orbit", message, hint).into());
        }
        let velocity = real(&orbit.velocity);
        Ok(Self {
            period: real(&p.period()),
            start: -(real(&p.restitution) * &velocity),
            velocity,
            advance: real(&orbit.force_angle()) / real(&p.omega),
            wall: real(&p.wall),
        })
    }
}
