//! Steady states and branches as plain data.

use crate::Number;
use serde::{Serialize, Serializer};

/// Steady states of the slow flow. Amplitudes and phases are those of x_j = a_j cos(k_j eta + phi_j) + ..., a list with an
/// entry per unknown (per mode, where the unknowns are coupled at order zero).
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Response {
    /// The parameter that varies.
    pub parameter: Option<String>,
    /// What the x_j are called: the unknowns, or q_1, q_2, ... of the modes.
    pub coordinates: Vec<String>,
    /// x = P q line by line in text and in LaTeX, where they are those of modes.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "as_text")]
    pub modes: Vec<[String; 2]>,
    /// k_j.
    pub turns: Vec<String>,
    /// The largest a_j that is looked at.
    pub amplitude_limit: Estimate,
    /// Whether the truncated slow flow has no steady states beyond.
    pub complete: bool,
    /// Over one parameter: whether it is proved of the truncated slow flow that no closed branch in the box is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_closed_missing: Option<bool>,
    /// The branches.
    pub branches: Vec<Branch>,
    /// Folds: two states meet.
    pub folds: Vec<Change>,
    /// Hopf points: the amplitudes begin to oscillate.
    pub hopf: Vec<Change>,
    /// Where branches cross.
    pub crossings: Vec<Change>,
    /// All states at one value each.
    pub states: Vec<States>,
    /// Pairs of parameter and amplitude of free motion.
    pub backbone: Vec<[Estimate; 2]>,
    /// The second parameter that varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<String>,
    /// With two parameters: curves of folds and Hopf points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
    /// Where two folds meet, with two parameters.
    pub cusps: Vec<Corner>,
    /// Where folds and Hopf points meet, with two parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bogdanov_takens: Vec<Corner>,
    /// The equation integrated along the values, upwards and downwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub followed: Option<[Vec<Reading>; 2]>,
    /// Where the start state goes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leads_to: Option<Destination>,
}

/// A double, estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The double.
    pub value: f64,
}

impl Serialize for Estimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Number::double(self.value).serialize(serializer)
    }
}

/// A piece of the response curve.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Branch {
    /// Its points, in order.
    pub points: Vec<Point>,
    /// Whether it is closed.
    pub closed: bool,
    /// Whether it was followed to the ends of the range or of the box.
    pub complete: bool,
}

/// A point of it.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Point {
    /// The parameter.
    pub value: Estimate,
    /// a_j.
    pub amplitudes: Vec<Estimate>,
    /// phi_j.
    pub phases: Vec<Estimate>,
    /// Whether all exponents have negative real parts; nothing where that is neutral.
    pub stable: Option<bool>,
    /// The Floquet exponents per unit of t, to the order kept.
    pub exponents: Vec<[Estimate; 2]>,
    /// Without a force: eta'.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<Estimate>,
    /// As of a [`State`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_resonance: Option<Estimate>,
}

/// A point at which states change.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Change {
    /// The parameter: enclosed where the point is proved.
    pub value: Number,
    /// a_j.
    pub amplitudes: Vec<Number>,
    /// The branch, from 0.
    pub branch: usize,
}

/// All states at one value of the parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct States {
    /// The value; nothing without a sweep.
    pub value: Option<Number>,
    /// How many states were found.
    pub count: usize,
    /// Whether there are exactly so many in the box.
    pub count_proved: bool,
    /// Parts of the box that could not be decided.
    pub undecided: usize,
    /// Proved states of which is not decided whether their amplitude is at most the limit.
    pub at_edge: usize,
    /// Parts of the box that were looked at.
    pub boxes: usize,
    /// The states, the largest amplitude first.
    pub list: Vec<State>,
}

/// A steady state.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct State {
    /// a_j.
    pub amplitudes: Vec<Number>,
    /// phi_j in (-pi, pi]; nothing where the amplitude may be zero.
    pub phases: Vec<Option<Number>>,
    /// Whether it is stable; nothing where that is neutral, or not decided beside a resonance.
    pub stable: Option<bool>,
    /// The Floquet exponents per unit of t, to the order kept.
    pub exponents: Vec<[Estimate; 2]>,
    /// Of a state that is stable but for an internal resonance, which the slow flow does not have: the largest real part of an
    /// exponent with it, in or beside a tongue of which the leading order alone is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_resonance: Option<Estimate>,
    /// Without a force: eta'; nothing at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<Estimate>,
    /// Where one phase is free: the rates by which the frequencies of the unknowns differ from those of the
    /// frame, without a force from those of the linear unknowns. The free phase is chosen so that one phi_j is 0; the exponent 0 along it
    /// is not listed, nor is the other one along a family of normal modes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drift: Vec<Estimate>,
    /// Re w_1, Im w_1, ...
    #[serde(skip)]
    pub(crate) at: Vec<f64>,
    /// The largest ratio of what an order adds to the slow flow at the state to what the order before adds.
    #[serde(skip)]
    pub(crate) growth: f64,
}

/// The response of the equation itself at a value of the parameter, integrated.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Reading {
    /// The value.
    pub value: Estimate,
    /// a_j; nothing where the motion ended or did not settle.
    pub amplitudes: Option<Vec<Estimate>>,
    /// phi_j.
    pub phases: Option<Vec<Estimate>>,
}

/// Where a start state goes.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Destination {
    /// `steady`; `cycle`, the amplitudes go round a cycle of the slow flow; `moving`, where the time looked at does not
    /// tell; `away`.
    pub fate: &'static str,
    /// Which state of the list, from 0.
    pub state: Option<usize>,
    /// The amplitudes at the end.
    pub amplitudes: Vec<Estimate>,
    /// Whether the start lies in the box, the state is stable and starts that differ in one coordinate by the terms of order eps go
    /// there, too: the start is known to leading order.
    pub decided: bool,
    /// Why it is not decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<&'static str>,
}

/// A curve in the plane of two parameters.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Curve {
    /// `fold` or `hopf`.
    pub kind: &'static str,
    /// Pairs of the parameters.
    pub points: Vec<[Estimate; 2]>,
    /// Whether it is closed.
    pub closed: bool,
}

/// A point on a curve of folds, proved.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Corner {
    /// The two parameters.
    pub values: [Number; 2],
    /// a_j.
    pub amplitudes: Vec<Number>,
}

fn as_text<S: Serializer>(lines: &[[String; 2]], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(lines.iter().map(|[text, _]| text))
}
