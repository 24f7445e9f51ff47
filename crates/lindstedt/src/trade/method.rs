//! The routes to a period.

use super::Plan;
use lindstedt_equation::{AmplitudeRole, Problem};

/// How a period is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Method {
    /// Derived in exact rings, then evaluated to `digits` digits.
    Exact {
        /// Digits of the evaluation.
        digits: u32,
    },
    /// The exact energy integral (power law and pendulum), then evaluated.
    Energy {
        /// Digits of the evaluation.
        digits: u32,
    },
    /// [`crate::numeric::Tier::Collocation`].
    Collocation {
        /// Correct digits of the coefficients.
        digits: u32,
    },
    /// [`crate::numeric::Tier::Doubles`].
    Doubles,
    /// [`crate::numeric::Tier::Fourier`].
    Fourier {
        /// Harmonics of each symmetry class.
        harmonics: usize,
    },
    /// Integrated in the time domain in double precision.
    SimulationInDoubles {
        /// Digits of one step.
        digits: u32,
    },
    /// Integrated in the time domain in floats of so many digits.
    Simulation {
        /// Digits of one step.
        digits: u32,
    },
}

impl Method {
    /// `exact`, `energy`, `collocation`, `collocation-f64`, `fourier`, `simulation-f64`,
    /// `simulation`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Exact { .. } => "exact",
            Self::Energy { .. } => "energy",
            Self::Collocation { .. } => "collocation",
            Self::Doubles => "collocation-f64",
            Self::Fourier { .. } => "fourier",
            Self::SimulationInDoubles { .. } => "simulation-f64",
            Self::Simulation { .. } => "simulation",
        }
    }

    /// Digits computed with; 16 for the tiers in doubles.
    #[must_use]
    pub fn digits(&self) -> u32 {
        match *self {
            Self::Exact { digits }
            | Self::Energy { digits }
            | Self::Collocation { digits }
            | Self::SimulationInDoubles { digits }
            | Self::Simulation { digits } => digits,
            Self::Doubles | Self::Fourier { .. } => 16,
        }
    }

    /// Harmonics, where the method has them instead of digits.
    #[must_use]
    pub fn harmonics(&self) -> Option<usize> {
        match *self {
            Self::Fourier { harmonics } => Some(harmonics),
            _ => None,
        }
    }

    /// Whether a series is summed, to an order; otherwise the equation is integrated.
    #[must_use]
    pub fn has_order(&self) -> bool {
        !matches!(self, Self::SimulationInDoubles { .. } | Self::Simulation { .. })
    }

    /// All methods in the order of the rows. The digits of an evaluation cost nothing beside an exact
    /// derivation, which is made once, for the most.
    pub(super) fn all(problem: &Problem, plan: &Plan) -> Vec<Self> {
        let (digits, harmonics) = (sorted(&plan.digits), sorted(&plan.harmonics));
        let most = plan.most_digits();
        let mut list = vec![Self::Exact { digits: most }];
        if matches!(
            problem.amplitude,
            AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSums
        ) {
            list.push(Self::Energy { digits: most });
        }
        list.extend(digits.iter().map(|&digits| Self::Collocation { digits }));
        list.push(Self::Doubles);
        list.extend(harmonics.into_iter().map(|harmonics| Self::Fourier { harmonics }));
        list.extend([8, 12, 16].map(|digits| Self::SimulationInDoubles { digits }));
        list.extend(digits.into_iter().map(|digits| Self::Simulation { digits }));
        list
    }

    /// The orders of the runs; one run without an order for the integrator.
    pub(super) fn orders(&self, plan: &Plan) -> Vec<Option<usize>> {
        if self.has_order() {
            sorted(&plan.orders).into_iter().map(Some).collect()
        } else {
            vec![None]
        }
    }
}

fn sorted<T: Ord + Copy>(list: &[T]) -> Vec<T> {
    let mut list = list.to_vec();
    list.sort_unstable();
    list.dedup();
    list
}

/// Shorter times are mostly noise: nothing is extrapolated from them.
const MEASURABLE: f64 = 0.05;

/// The seconds of an order from those of the two before, if both are long enough to mean anything.
/// Exact derivations grow exponentially, and running into the limit at every order would take as
/// many times the limit; the numeric ones are broken off when their time is over.
#[doc(hidden)]
pub fn predict(method: &Method, times: &[(usize, f64)], order: Option<usize>) -> Option<f64> {
    let &(last, seconds) = times.last()?;
    if seconds == f64::INFINITY || !matches!(method, Method::Exact { .. } | Method::Energy { .. }) {
        return seconds.is_infinite().then_some(seconds);
    }
    let &(before, less) = times.iter().rev().nth(1).filter(|(_, less)| *less >= MEASURABLE)?;
    let steps = (order? - last) as f64 / (last - before) as f64;
    Some(seconds * (seconds / less).max(1.0).powf(steps))
}
