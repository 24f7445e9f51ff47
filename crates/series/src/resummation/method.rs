//! The methods, and what they are given.

use super::estimate::sizes;
use super::singularity::nearest_singularity;
use super::{Growth, ResummationError, Singularity, growth};
use lindstedt_algebra::Stop;
use rug::Float;
use std::fmt;
use std::str::FromStr;

/// A way from coefficients to a value.
///
/// ```
/// use lindstedt_series::resummation::Method;
/// assert_eq!("borel-pade".parse(), Ok(Method::BorelPade));
/// assert_eq!(Method::PartialSum.to_string(), "none");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Method {
    /// The partial sum; of a divergent series up to the smallest term.
    PartialSum,
    /// Diagonal Pade approximants.
    Pade,
    /// The series in u = x/(s + x) with a prefactor, its partial sum.
    Uniform,
    /// Diagonal Pade approximants in u.
    UniformPade,
    /// Pade approximants after the conformal map of the plane cut at the nearest singularities, with
    /// the prefactor of the change of variable where one is known.
    ConformalPade,
    /// Pade approximants of the Borel transform and Laplace's integral.
    BorelPade,
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = ResummationError;

    fn from_str(text: &str) -> Result<Self, ResummationError> {
        let found = || text.chars().take(60).collect();
        let method = Self::ALL.into_iter().find(|method| method.name() == text);
        method.ok_or_else(|| ResummationError::UnknownMethod { found: found() })
    }
}

impl Method {
    /// Its name in questions and results: `none`, `pade`, `uniform`, `uniform-pade`, `conformal`,
    /// `borel-pade`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PartialSum => "none",
            Self::Pade => "pade",
            Self::Uniform => "uniform",
            Self::UniformPade => "uniform-pade",
            Self::ConformalPade => "conformal",
            Self::BorelPade => "borel-pade",
        }
    }

    /// All of them, in the order in which `auto` prefers them among equals.
    pub const ALL: [Self; 6] = [
        Self::PartialSum,
        Self::Uniform,
        Self::Pade,
        Self::UniformPade,
        Self::ConformalPade,
        Self::BorelPade,
    ];
}

/// What is known of the function beyond its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformMap {
    /// s in u = x/(s + x).
    pub scale: Float,
    /// p: the series of (1 - u)^p f, and of the like for the conformal map, is re-expanded;
    /// f ~ x^p for x -> infinity makes it bounded.
    pub prefactor: Float,
    /// The radius of convergence in u where it is known; else it is estimated.
    pub radius: Option<f64>,
}

/// The coefficients and the point at some precision, with what they tell.
#[derive(Clone, Debug)]
pub struct Sample {
    /// c_0, c_1, ...
    pub coefficients: Vec<Float>,
    /// x.
    pub point: Float,
    /// The change of variable for [`Method::Uniform`].
    pub map: Option<UniformMap>,
    /// The radius of convergence where it is known, zero for a series that diverges everywhere;
    /// else it is estimated.
    pub radius: Option<f64>,
    /// The precision to which all of these are known, relative.
    pub bits: u32,
}

impl Sample {
    /// Whether the approximants of two methods are different: diagonal ones of one series are the
    /// same in x and in u = x/(s + x).
    pub(super) fn are_independent(a: Method, b: Method) -> bool {
        let kind = |m| if m == Method::UniformPade { Method::Pade } else { m };
        let by_approximants =
            |m| matches!(m, Method::Pade | Method::ConformalPade | Method::BorelPade);
        let (a, b) = (kind(a), kind(b));
        a != b && by_approximants(a) && by_approximants(b)
    }

    /// Whether the error of `method` follows from the terms and a known radius of convergence.
    pub(super) fn has_known_tail(&self, method: Method) -> bool {
        match method {
            Method::PartialSum => self.radius.is_some_and(|radius| radius > 0.0),
            Method::Uniform => self.map.as_ref().is_some_and(|map| map.radius.is_some()),
            _ => false,
        }
    }

    /// Whether no agreement means anything: the terms of an entire function (or of one with too
    /// few coefficients to tell) still grow at the last order.
    pub(super) fn is_unresolved(&self) -> bool {
        let of_unknown_kind =
            matches!(growth(&self.coefficients), Growth::Entire | Growth::Undecided);
        if self.radius.is_some() || !of_unknown_kind {
            return false;
        }
        let terms = sizes(&self.coefficients, &self.point);
        let third = terms.len().div_ceil(3);
        let largest = |list: &[Float]| list.iter().cloned().reduce(|a, b| a.max(&b));
        let (early, late) = (terms.get(..third), terms.get(terms.len() - third..));
        late.and_then(largest) > early.and_then(largest)
    }

    /// The nearest singularity in the coefficients, on the circle of convergence where that is known
    /// (see [`nearest_singularity`](super::nearest_singularity)); nothing once `stop` said so.
    #[must_use]
    pub fn singularity(&self, stop: &Stop) -> Option<Singularity> {
        nearest_singularity(&self.coefficients, self.radius, self.bits, stop)
    }
}
