//! The convergence of an averaged series as data.

use crate::convergence::Convergence;
use lindstedt_number::Status;
use serde::Serialize;

/// That an averaged series diverges, in words.
#[must_use]
pub fn divergence(found: &Convergence) -> String {
    let radius = match found.radius {
        radius if radius < 1e-3 => format!("{radius:.1e}"),
        radius => format!("{radius:.3}"),
    };
    format!("the averaged series diverges at eps = 1: its radius of convergence is about {radius}")
}

/// The convergence of an averaged series as data.
#[derive(Clone, Debug, Serialize)]
pub struct Radius {
    /// The least |eps| of a branch point; `infinite` without control and damping.
    pub radius: Option<Finite>,
    /// |lambda_N/lambda_(N-1)| of the last two terms.
    pub ratio: Option<Finite>,
    /// Whether eps = 1 lies outside.
    pub diverges: bool,
    /// Estimated.
    pub status: Status,
}

/// A double that JSON can say: a number, or the word for infinity.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Finite {
    /// A finite number.
    Number(f64),
    /// The word.
    Word(String),
}

impl Finite {
    fn new(x: f64) -> Option<Self> {
        match x {
            x if x.is_finite() => Some(Self::Number(x)),
            x if x.is_nan() => None,
            _ => Some(Self::Word("infinite".to_owned())),
        }
    }
}

impl Radius {
    /// The plain form.
    #[must_use]
    pub fn new(found: &Convergence) -> Self {
        Self {
            radius: Finite::new(found.radius),
            ratio: Finite::new(found.ratio),
            diverges: found.diverges(),
            status: Status::Estimated,
        }
    }
}
