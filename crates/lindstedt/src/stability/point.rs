//! One point as plain data: the true orbit, the prediction and the truth.

use crate::{Number, Status};
use lindstedt_impact::ImpactError;
use lindstedt_impact::Radius;
use serde::Serialize;

/// Something that may not exist.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Found<T> {
    /// It does.
    There(T),
    /// It does not.
    Missing {
        /// No; nothing where it was not decided.
        exists: Option<bool>,
        /// Why.
        reason: String,
    },
}

impl<T> Found<T> {
    pub(super) fn missing(error: &ImpactError) -> Self {
        let decided =
            !matches!(error, ImpactError::Undecided { .. } | ImpactError::NoConvergence { .. });
        Self::Missing { exists: decided.then_some(false), reason: error.to_string() }
    }
}

impl Found<TrueOrbit> {
    /// Whether the orbit exists: not with a flight through the wall, undecided with one that
    /// touches it.
    #[must_use]
    pub fn exists(&self) -> Option<bool> {
        match self {
            Self::There(orbit) => orbit.exists,
            Self::Missing { exists, .. } => *exists,
        }
    }
}

/// A multiplier: real and imaginary part.
pub type Multiplier = [Number; 2];

/// The orbit of the true system.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct TrueOrbit {
    /// Whether it exists; nothing where the flight touches the wall.
    pub exists: Option<bool>,
    /// v, the velocity before the impact.
    pub impact_velocity: Number,
    /// phi of F cos(omega t + phi) + e^(R t) (C cos Omega t + D sin Omega t), where this form exists.
    pub phase: Option<Number>,
    /// C.
    #[serde(rename = "C")]
    pub cosine: Option<Number>,
    /// D.
    #[serde(rename = "D")]
    pub sine: Option<Number>,
    /// Whether the flight passes through the wall; nothing where it touches.
    pub penetrates: Option<bool>,
    /// The largest x - s inside the flight, if x has a maximum there.
    pub clearance: Option<Number>,
    /// The phase of the force at the impact.
    pub force_phase: Number,
    /// x'' before the impact.
    pub acceleration_before: Number,
    /// x'' after it.
    pub acceleration_after: Number,
    /// The lower left entry of the saltation matrix.
    pub saltation: Number,
    /// Of the equation for v; zero at the fold.
    pub discriminant: Number,
}

/// The orbit of the averaged flow.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct PredictedOrbit {
    /// Yes.
    pub exists: bool,
    /// v.
    pub impact_velocity: Number,
    /// phi.
    pub phase: Number,
    /// C.
    #[serde(rename = "C")]
    pub cosine: Number,
    /// D.
    #[serde(rename = "D")]
    pub sine: Number,
}

/// What averaging predicts.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Predicted {
    /// The order of the flow.
    pub order: usize,
    /// The variant.
    pub variant: &'static str,
    /// R, the growth rate of the flow.
    #[serde(rename = "R")]
    pub growth_rate: Option<Number>,
    /// alpha_0, its frequency.
    pub alpha0: Option<Number>,
    /// b_2, b_1, b_0 of the characteristic polynomial (variants E and P).
    pub b2: Option<Number>,
    /// b_1.
    pub b1: Option<Number>,
    /// b_0.
    pub b0: Option<Number>,
    /// The trace of the map.
    pub trace: Option<Number>,
    /// Its determinant.
    pub determinant: Option<Number>,
    /// Its multipliers.
    pub multipliers: Option<[Multiplier; 2]>,
    /// The verdict; nothing where undecided.
    pub stable: Option<bool>,
    /// The verdict in words.
    pub verdict: Option<&'static str>,
    /// The orbit of the flow (not of variant S).
    pub orbit: Option<Found<PredictedOrbit>>,
    /// m: averaging can be believed below 1.
    pub mismatch: Option<Number>,
    /// |lambda^2 + alpha^2 - g(lambda)| of the truncated series.
    pub residual: Option<Number>,
    /// Where the averaged series converges.
    pub convergence: Radius,
}

/// Averaging that knows of the impact within the delay.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Aware {
    /// Estimated.
    There {
        /// The multipliers in doubles.
        multipliers: Vec<Multiplier>,
        /// The verdict.
        stable: Option<bool>,
        /// The order.
        order: usize,
        /// Estimated.
        status: Status,
    },
    /// None.
    Missing {
        /// Why.
        reason: String,
    },
}

/// The truth about the delayed system.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct Truth {
    /// The verdict; nothing where undecided or neutral.
    pub stable: Option<bool>,
    /// The verdict in words.
    pub verdict: &'static str,
    /// The multipliers: exact for B = 0, else zeros of G.
    pub multipliers: Vec<Multiplier>,
    /// What they are, for B != 0.
    pub multipliers_of: Option<&'static str>,
    /// All multipliers of a larger modulus are listed.
    pub complete_to_modulus: Option<f64>,
    /// Why there are none.
    pub multipliers_missing: Option<String>,
    /// The number of zeros of G in the unit disc; nothing where undecided.
    pub zeros_in_unit_disc: Option<u32>,
    /// How the kick of B was treated.
    pub kick: Option<&'static str>,
    /// Growth of the piecewise linear return map, which decides for B != 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub return_map: Option<ReturnMap>,
}

/// Growth of the return map by iteration.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ReturnMap {
    /// The factor per impact.
    pub growth_per_impact: f64,
    /// Its difference between the two halves of the run.
    pub spread: f64,
    /// What the run has not settled, the points of a flight and rounding; never 0.
    pub error: f64,
    /// Estimated.
    pub status: Status,
    /// The verdict.
    pub verdict: &'static str,
}
