//! What the errors at several values of the small parameter say of the order of accuracy.

use super::{SteadyStates, Verdict, Verify};
use crate::{Number, Status};
use lindstedt_equation::Condition;
use rug::ops::Pow;
use rug::{Float, Rational};
use serde::{Serialize, Serializer};

/// The observed order may differ from N + 1 by so much.
pub const TOLERANCE: f64 = 0.05;

/// Differences below this share of eps^(N+1) are rounding errors.
const ROUNDING: f64 = 1e-8;

/// The comparison at one value of the small parameter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Comparison {
    /// The value.
    pub small: Rational,
    /// max |x_N - x| on the points of the window.
    pub error: Float,
    /// The estimated error of the integration (against one with 8 digits more).
    pub simulation_error: Float,
    /// max |x| on the same points: no order is observed where the difference is as large.
    pub size: Float,
    /// ln(error/previous error)/ln(small/previous small); nothing for the first.
    pub slope: Option<f64>,
}

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let small = Number {
            exact: Some(self.small.to_string()),
            // The nearest double (`to_f64` cuts off), as short as it can be written.
            decimal: format!("{:e}", Float::with_val(53, &self.small).to_f64()),
            error: None,
            status: Status::Exact,
        };
        let difference = Number {
            exact: None,
            decimal: self.error.to_string_radix(10, Some(6)),
            error: Some(self.simulation_error.to_string_radix(10, Some(6))),
            status: Status::Estimated,
        };
        serializer.collect_map([
            ("small", Cell::Number(&small)),
            ("difference", Cell::Number(&difference)),
            ("slope", Cell::Slope(self.slope)),
        ])
    }
}

/// A value of a serialized comparison.
#[derive(Serialize)]
#[serde(untagged)]
enum Cell<'a> {
    Number(&'a Number),
    Slope(Option<f64>),
}

/// The result of [`crate::Oscillator::verify`].
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Verification {
    /// The name of the small parameter.
    pub parameter: String,
    /// The digits of the integration.
    pub digits: u32,
    /// The normalisation.
    pub normalisation: Condition,
    /// The window in periods.
    pub periods: u32,
    /// One line per value, in the order given.
    pub table: Vec<Comparison>,
    /// The slope between the last two values.
    pub observed_order: Option<f64>,
    /// N + 1.
    pub expected_order: usize,
    /// The last slope is within [`TOLERANCE`] of the limit that it and the one before extrapolate to
    /// (three values).
    pub settled: bool,
    /// [`TOLERANCE`].
    pub tolerance: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in words.
    pub reason: String,
    /// At a resonance: the steady states against periodic orbits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady: Option<SteadyStates>,
    /// The errors of the last two values are above those of the integration.
    #[serde(skip)]
    pub resolved: bool,
    /// The last errors are smaller than the motion.
    #[serde(skip)]
    pub small_enough: bool,
    /// There is no difference but rounding errors, far below eps^(N+1).
    #[serde(skip)]
    pub exact: bool,
}

impl Verification {
    /// Slopes and verdict.
    pub(super) fn new(
        parameter: &str,
        (condition, order): (Condition, usize),
        question: &Verify,
        digits: u32,
        mut table: Vec<Comparison>,
    ) -> Self {
        let limit = slopes(&mut table);
        let observed = table.last().and_then(|last| last.slope);
        let drowned = |c: &Comparison| c.simulation_error.clone() * 1000u32 > c.error;
        let resolved = !table.iter().rev().take(2).any(drowned);
        let small_enough = !table.iter().rev().take(2).any(|c| c.error >= c.size);
        let limit = limit.filter(|n| observed.is_some_and(|slope| (slope - n).abs() <= TOLERANCE));
        let expected = order as f64 + 1.0;
        // The error of a wrong order is C eps^n with a whole n: another limit is not one yet.
        let power = limit.filter(|n| (n - n.round()).abs() <= TOLERANCE);
        let near = |n: f64| (n - expected).abs() <= TOLERANCE;
        // Errors of rounding do not depend on eps, or are those of the integration.
        let rounding = |c: &Comparison| {
            let bound = Float::with_val(64, &c.small).abs().pow(order as u32 + 1) * ROUNDING;
            c.error.clone().max(&c.simulation_error) <= bound * &c.size
        };
        let constant = !resolved || observed.is_some_and(|slope| slope.abs() < 0.5);
        let exact = constant && table.len() > 1 && table.iter().all(rounding);
        let verdict = match power {
            _ if exact => Verdict::Agrees,
            _ if !resolved || !small_enough => Verdict::Undecided,
            _ if observed.is_some_and(near) => Verdict::Agrees,
            Some(n) if n < expected && !near(n) => Verdict::Disagrees,
            Some(_) => Verdict::Agrees,
            None => Verdict::Undecided,
        };
        let mut found = Self {
            parameter: parameter.to_owned(),
            digits,
            normalisation: condition,
            periods: question.periods,
            table,
            observed_order: observed,
            expected_order: order + 1,
            settled: limit.is_some(),
            tolerance: TOLERANCE,
            verdict,
            reason: String::new(),
            steady: None,
            resolved,
            small_enough,
            exact,
        };
        found.reason = found.words();
        found
    }

    /// The verdict in words.
    fn words(&self) -> String {
        let expected = self.expected_order;
        let few = self.table.len() < 3;
        if self.exact {
            return format!(
                "agrees: the differences are rounding errors, far below {}^{expected}: no term is seen to be left out",
                self.parameter
            );
        }
        match (self.verdict, self.observed_order) {
            (Verdict::Agrees, Some(slope)) if slope > expected as f64 + TOLERANCE => format!(
                "agrees: observed order {slope:.4}, expected at least {expected}: the terms left out begin later"
            ),
            (Verdict::Agrees, Some(slope)) => {
                format!("agrees: observed order {slope:.4}, expected {expected}")
            }
            (Verdict::Disagrees, Some(slope)) => {
                format!(
                    "disagrees: observed order {slope:.4}, expected {expected} within {TOLERANCE}"
                )
            }
            (Verdict::Undecided, Some(_)) if self.resolved && !self.small_enough => {
                "undecided: the difference is as large as the motion; smaller --small".to_owned()
            }
            (Verdict::Undecided, Some(slope)) if self.resolved => format!(
                "undecided: observed order {slope:.4} has not settled, expected {expected}; smaller --small{}",
                if few { ", at least three of them" } else { "" }
            ),
            _ => "undecided: the error of the integration is not small against the difference; \
                  more --digits or larger --small"
                .to_owned(),
        }
    }
}

/// The slope of every line but the first, and the limit that the last two extrapolate to.
fn slopes(comparisons: &mut [Comparison]) -> Option<f64> {
    let size = |c: &Comparison| Float::with_val(80, &c.small).abs().ln().to_f64();
    for i in 1..comparisons.len() {
        let log = |c: &Comparison| c.error.clone().ln().to_f64();
        let [before, after] = [&comparisons[i - 1], &comparisons[i]];
        let slope = (log(after) - log(before)) / (size(after) - size(before));
        comparisons[i].slope = slope.is_finite().then_some(slope);
    }
    // e = C eps^n (1 + c eps + ...) has ln e(eps_1)/e(eps_2) = n ln eps_1/eps_2 + c (eps_1 - eps_2):
    // from two slopes n and what the last slope lacks.
    match &comparisons[..] {
        [.., before, middle, last] => middle.slope.zip(last.slope).map(|(first, second)| {
            let steps = [size(before) - size(middle), size(middle) - size(last)];
            let falls = [steps[0].exp_m1(), -(-steps[1]).exp_m1()];
            let [far, near] = [falls[0] / steps[0], falls[1] / steps[1]];
            second - (second - first) * near / (near - far)
        }),
        _ => None,
    }
}
