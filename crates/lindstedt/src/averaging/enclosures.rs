//! Averaged expansions with enclosures of numbers as coefficients, for further computation.

use super::values::constant;
use super::{AveragingSettings, MOST_BITS, Task};
use crate::{Error, Progress, Value};
use lindstedt_coeff::amplitude::AmplitudePower;
use lindstedt_coeff::ball::Balls;
use lindstedt_coeff::ball::ring::{BallRing, Enclosure};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::{AveragedExpansion, ExpandError};
use lindstedt_phase::Torus;
use std::collections::BTreeMap;

/// An averaged expansion with numbers as coefficients.
pub(crate) struct Enclosures {
    pub(crate) expansion: AveragedExpansion<Torus<BallRing>>,
    /// omega_0.
    pub(crate) frequency: Enclosure,
    /// The frequency of the force.
    pub(crate) forcing: Option<Enclosure>,
    pub(crate) delays: Vec<Enclosure>,
}

/// The averaged expansion, checked, with coefficients enclosed in balls of radius below 2^-bits;
/// every parameter of the equation must have a value.
pub(crate) fn enclosures(
    problem: &Problem,
    settings: &AveragingSettings,
    bits: u32,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Enclosures, Error> {
    let task = Task::new(problem, settings)?;
    let order = u32::try_from(settings.order).unwrap_or(u32::MAX / 16);
    let mut working = bits.saturating_add(32 + 8 * order);
    loop {
        let ring = BallRing { balls: Balls::new(working) };
        let values = |name: &str| Some(Enclosure(task.value(name)?.ball(ring.balls)?));
        let algebra = task.algebra(&ring, &values, &|ring, _| *ring)?;
        let evaluate = |e: &Expression| constant(&ring, e, &values);
        let forcing = task.excitation.frequency.as_ref().and_then(evaluate);
        let delays = task.excitation.delays.iter().filter_map(evaluate).collect();
        let over = task.derive(algebra, &values, observer)?;
        let expansion = over.expansion;
        if expansion.order() < settings.order {
            return Err(ExpandError::Interrupted { order: expansion.order() }.into());
        }
        let harmonics = expansion.solution.iter().flat_map(|x| x.harmonics().values().flatten());
        let rates = expansion.amplitude_rate.iter().chain(&expansion.phase_rate);
        let all = harmonics.chain(rates).flat_map(|f| f.terms());
        let limit = -i64::from(bits);
        let wide = |(_, c): &(AmplitudePower, Enclosure)| {
            c.0.radius().get_exp().is_some_and(|e| i64::from(e) > limit)
        };
        if !all.clone().any(wide) {
            return Ok(Enclosures { frequency: over.frequency, expansion, forcing, delays });
        }
        if working >= MOST_BITS {
            return Err(Error::NotEnoughBits { bits: working, best: None });
        }
        working *= 2;
    }
}

/// Values of the parameters of the equation (and of a synchronous delay), given or by default;
/// `amplitude`, if given or a parameter of the problem.
pub(crate) fn defaults(
    problem: &Problem,
    given: &BTreeMap<String, Value>,
) -> BTreeMap<String, Value> {
    let mut values = given.clone();
    for card in &problem.parameters {
        if let Ok(value) = Value::parse(&card.default) {
            values.entry(card.name.to_string()).or_insert(value);
        }
    }
    values
}
