//! The steady states of a slow flow of N orders against the periodic orbits of the equation: amplitudes and phases
//! differ by O(eps^N).

use super::{Verdict, Verify};
use crate::respond::{Beside, Estimate};
use crate::{Exact, Oscillator, Work};
use rug::Rational;
use serde::Serialize;
use std::f64::consts::TAU;

/// Differences below this part of an amplitude, divided by |eps| and multiplied by the condition of the orbit, are those of the
/// integration: an orbit is fixed by rates of order eps, or less.
const RESOLVED: f64 = 1e-15;
/// The observed order may be less than N by so much.
const TOLERANCE: f64 = 0.1;

/// The comparison of all states.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SteadyStates {
    /// N.
    pub expected_order: usize,
    /// Those at the smallest value.
    pub states: Vec<SteadyState>,
    /// Agrees where every state that is resolved does.
    pub verdict: Verdict,
    /// The verdict in words.
    pub reason: String,
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
    /// The last slope.
    pub observed_order: Option<f64>,
    /// Agrees from N on, and beside N - 1/2: where order one has a fold the states move by the root of what is left out.
    pub verdict: Verdict,
}

/// Of a slope.
fn verdict(observed: Option<f64>, order: usize) -> Verdict {
    let beyond = observed.map(|n| n - order as f64);
    match beyond {
        None => Verdict::Undecided,
        Some(n) if n >= -TOLERANCE || (n + 0.5).abs() <= TOLERANCE => Verdict::Agrees,
        Some(_) => Verdict::Disagrees,
    }
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
    /// The slope of the first harmonics a_j e^(i phi_j), or, where their difference is that of the integration, one less than
    /// that of the frequencies, which differ by O(eps^(N + 1)).
    pub slope: Option<f64>,
    #[serde(skip)]
    differences: [Option<f64>; 2],
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
            differences: [None; 2],
        };
        let Some((state, Some(orbit))) = found else { return line };
        line.orbit = true;
        let size = state.pairs.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let resolved = RESOLVED * (1.0 / small.to_f64().abs()).max(10.0).max(orbit.condition);
        let least = resolved * size;
        let shown = |x: f64, least: f64| (x > least).then(|| Estimate { value: rounded(x) });
        let largest =
            |list: &mut dyn Iterator<Item = f64>, least| shown(list.fold(0.0, f64::max), least);
        let pairs = || state.pairs.iter().zip(&orbit.pairs);
        let angle = |x: f64| (x - TAU * (x / TAU).round()).abs();
        let moving = pairs().filter(|(a, _)| a.norm() > 1e-9 * size);
        line.amplitude = largest(&mut pairs().map(|(a, b)| (a.norm() - b.norm()).abs()), least);
        line.phase = largest(&mut moving.map(|(a, b)| angle(a.arg() - b.arg())), resolved);
        let frequency = state.frequency.zip(orbit.frequency);
        line.frequency = frequency.and_then(|(a, b)| shown((a - b).abs(), resolved));
        let difference = pairs().map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        // Of two that far above the error of the integration the slope is right within the tolerance.
        let frequency = frequency.map(|(a, b)| (a - b).abs()).filter(|it| *it > 30.0 * resolved);
        line.differences = [Some(difference).filter(|it| *it > 30.0 * least), frequency];
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
        let mut found = Self {
            expected_order: question.order,
            states: Vec::new(),
            verdict: Verdict::Undecided,
            reason: String::new(),
            refused: None,
        };
        let name = oscillator.problem().small.to_string();
        let lists = |oscillator: &Oscillator| {
            let at = |small: &Rational| {
                let case = oscillator.clone().with(&name, Exact::Rational(small.clone()));
                case.steady_orbits(question.order, work)
            };
            question.small.iter().map(at).collect::<Result<Vec<_>, _>>()
        };
        // The amplitude of the motion that is compared in time is none of a forced response.
        let without = |error| match oscillator.given().contains_key("amplitude") {
            true => lists(&oscillator.clone().without("amplitude")).map_err(|_| error),
            false => Err(error),
        };
        let lists = match lists(oscillator).or_else(without) {
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
                let slope = |of: usize| {
                    let (a, b) = table[k].differences[of].zip(table[k - 1].differences[of])?;
                    Some(rounded((a / b).ln() / (small - before) - of as f64))
                };
                table[k].slope = slope(0).or_else(|| slope(1));
            }
            let amplitudes = state.0.pairs.iter().map(|z| Estimate { value: z.norm() }).collect();
            let observed_order = table.iter().rev().find_map(|line| line.slope);
            let verdict = verdict(observed_order, question.order);
            found.states.push(SteadyState { amplitudes, table, observed_order, verdict });
        }
        if found.states.is_empty() {
            found.refused = Some("the slow flow has no steady state but rest".to_owned());
        }
        found.judge();
        found
    }

    fn judge(&mut self) {
        let (order, all) = (self.expected_order, self.states.len());
        let count = |verdict| self.states.iter().filter(|it| it.verdict == verdict).count();
        let [agree, disagree, open] =
            [Verdict::Agrees, Verdict::Disagrees, Verdict::Undecided].map(count);
        let is_half =
            |it: &&SteadyState| it.observed_order.is_some_and(|n| n < order as f64 - TOLERANCE);
        let half = self.states.iter().filter(is_half).count() - disagree;
        let (verdict, word) = match (agree, disagree) {
            (_, 1..) => (Verdict::Disagrees, "disagrees"),
            (1.., 0) => (Verdict::Agrees, "agrees"),
            (0, 0) => (Verdict::Undecided, "undecided"),
        };
        let full = agree - half;
        let parts = [
            (full, format!("of order {order}")),
            (half, format!("of order {order} - 1/2, as where order one has a fold")),
            (disagree, "of another order".to_owned()),
            (open, "not resolved, or no orbit".to_owned()),
        ];
        let parts = parts.into_iter().filter(|(n, _)| *n > 0);
        let parts: Vec<String> = parts.map(|(n, what)| format!("{what} ({n} of {all})")).collect();
        self.verdict = verdict;
        self.reason = format!("{word}: differences {}", parts.join(", "));
    }
}
