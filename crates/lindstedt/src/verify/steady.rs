//! The steady states of a slow flow of N orders against the periodic orbits of the equation: amplitudes and phases
//! differ by O(eps^N).

use super::Verify;
use crate::respond::{Beside, Estimate};
use crate::{Exact, Oscillator, Work};
use rug::Rational;
use serde::Serialize;
use std::f64::consts::TAU;

/// Differences below this part of an amplitude are those of the integration.
const RESOLVED: f64 = 1e-12;

/// The comparison of all states.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SteadyStates {
    /// N.
    pub expected_order: usize,
    /// Those at the smallest value.
    pub states: Vec<SteadyState>,
    /// Why there are none.
    pub refused: Option<String>,
}

/// A steady state at the values of the small parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SteadyState {
    /// a_j at the smallest value.
    pub amplitudes: Vec<Estimate>,
    /// One line per value.
    pub table: Vec<SteadyDifference>,
    /// The slope of the last line.
    pub observed_order: Option<f64>,
}

/// How far a state and the orbit near it are apart.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SteadyDifference {
    /// The small parameter.
    pub small: String,
    /// Whether there is such a state and an orbit near it was found.
    pub orbit: bool,
    /// The largest difference of the a_j; nothing where it is that of the integration.
    pub amplitude: Option<Estimate>,
    /// That of the phi_j.
    pub phase: Option<Estimate>,
    /// That of the frequencies, without a force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<Estimate>,
    /// The slope of the first harmonics a_j e^(i phi_j); nothing where the difference is that of the integration.
    pub slope: Option<f64>,
    #[serde(skip)]
    difference: Option<f64>,
}

impl SteadyDifference {
    fn of(small: &Rational, found: Option<&Beside>) -> Self {
        let mut line = Self {
            small: small.to_string(),
            orbit: false,
            amplitude: None,
            phase: None,
            frequency: None,
            slope: None,
            difference: None,
        };
        let Some((state, Some(orbit))) = found else { return line };
        line.orbit = true;
        let size = state.pairs.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let least = RESOLVED * size;
        let shown = |x: f64, least: f64| (x > least).then(|| Estimate { value: rounded(x) });
        let largest =
            |list: &mut dyn Iterator<Item = f64>, least| shown(list.fold(0.0, f64::max), least);
        let pairs = || state.pairs.iter().zip(&orbit.pairs);
        let angle = |x: f64| (x - TAU * (x / TAU).round()).abs();
        let moving = pairs().filter(|(a, _)| a.norm() > 1e-9 * size);
        line.amplitude = largest(&mut pairs().map(|(a, b)| (a.norm() - b.norm()).abs()), least);
        line.phase = largest(&mut moving.map(|(a, b)| angle(a.arg() - b.arg())), RESOLVED);
        let frequency = state.frequency.zip(orbit.frequency);
        line.frequency = frequency.and_then(|(a, b)| shown((a - b).abs(), RESOLVED));
        let difference = pairs().map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        line.difference = Some(difference).filter(|it| *it > least);
        line
    }
}

/// Four digits: the others are those of the integration.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// How far two states lie apart.
fn away(a: &Beside, b: &Beside) -> f64 {
    a.0.pairs.iter().zip(&b.0.pairs).map(|(a, b)| (a - b).norm_sqr()).sum()
}

fn nearest<'a>(list: &'a [Beside], to: &Beside) -> Option<&'a Beside> {
    list.iter().min_by(|a, b| away(a, to).total_cmp(&away(b, to)))
}

impl SteadyStates {
    pub(super) fn of(oscillator: &Oscillator, question: &Verify, work: &Work) -> Self {
        let mut found = Self { expected_order: question.order, states: Vec::new(), refused: None };
        let name = oscillator.problem().small.to_string();
        let at = |small: &Rational| {
            let case = oscillator.clone().with(&name, Exact::Rational(small.clone()));
            case.steady_orbits(question.order, work)
        };
        let lists = match question.small.iter().map(at).collect::<Result<Vec<_>, _>>() {
            Ok(lists) => lists,
            Err(error) => {
                found.refused = Some(error.to_string());
                return found;
            }
        };
        let Some(last) = lists.last() else { return found };
        for state in last {
            let near = lists.iter().zip(&question.small).filter_map(|(list, small)| {
                let near = nearest(list, state)?;
                // A state that vanishes on the way has no partner there.
                let same = nearest(last, near).is_some_and(|it| std::ptr::eq(it, state));
                Some(SteadyDifference::of(small, Some(near).filter(|_| same)))
            });
            let mut table: Vec<_> = near.collect();
            for k in 1..table.len() {
                let [small, before] = [k, k - 1].map(|k| question.small[k].to_f64().abs().ln());
                let pair = table[k].difference.zip(table[k - 1].difference);
                table[k].slope = pair.map(|(a, b)| rounded((a / b).ln() / (small - before)));
            }
            let amplitudes = state.0.pairs.iter().map(|z| Estimate { value: z.norm() }).collect();
            let observed_order = table.last().and_then(|line| line.slope);
            found.states.push(SteadyState { amplitudes, table, observed_order });
        }
        if found.states.is_empty() {
            found.refused = Some("the slow flow has no steady state but rest".to_owned());
        }
        found
    }
}
