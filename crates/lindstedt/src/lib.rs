//! Perturbation expansions of strongly nonlinear and non-smooth oscillators, to any order, in
//! exact arithmetic, each substituted back into its equation.
//!
//! ```
//! use lindstedt::{Oscillator, Quantity, Work};
//! let power_law = Oscillator::builtin("power-law")?.derive(2, &Work::default())?.value;
//! assert_eq!(power_law.exact(Quantity::FrequencySquared, 1).as_deref(), Some("1 - 2*ln(2)"));
//! # Ok::<(), lindstedt::Error>(())
//! ```
//!
//! One entry: an [`Oscillator`] is a problem with every value settled, from a built-in name
//! ([`Oscillator::builtin`]), a file ([`Oscillator::file`]) or an equation ([`Oscillator::parse`]).
//! Each question is a method that takes a [`Work`] (digits, memory, stop, progress) and returns
//! an [`Answer`] (header, value, standing, remarks) or an [`Error`], which holds every
//! crate's error and says code, standing and hint ([`Refusal`]). Every [`Number`] carries its [`Status`].
//!
//! What is exported here keeps its meaning between versions; [`unstable`] does not.

#![warn(clippy::too_many_lines)]

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;

mod answer;
/// What [`Oscillator::average`] answers with.
pub mod averaging {
    pub use lindstedt_derivation::averaging::{
        Algebraic, Averaging, Coefficient, Cycle, Cycles, Formula, RateTerm, SingleCycle,
        print_series,
    };
}
pub mod catalogue;
pub mod choices;
pub mod classification;
mod convergence;
mod derive;
mod error;
pub mod evaluate;
mod form;
pub mod grid;
mod hopf;
pub mod motion;
/// What [`Oscillator::estimate`] is asked and answers with.
pub mod numeric {
    pub use lindstedt_derivation::numeric::{Estimate, EstimatedSeries, Tier};
}
mod oscillator;
pub mod refusal;
mod resonance;
pub mod respond;
pub mod stability;
pub mod start;
pub mod threshold;
pub mod trade;
pub mod verify;

/// What the tests of single formulas reach: no part of the interface.
#[doc(hidden)]
pub mod formulas {
    pub use crate::motion::answer::shown;
    pub mod growth {
        pub use crate::motion::growth::{grows, linear, verdict};
    }
}

pub use answer::{Answer, Header, Remark, SCHEMA, Standing};
pub use derive::Derive;
pub use error::Error;
pub use evaluate::Evaluate;
pub use hopf::{HopfSeries, SoughtSeries};
pub use lindstedt_algebra::Stop;
pub use lindstedt_derivation::{
    Derivation, DerivationError, NamedSeries, Progress, Route, Solution, Work, resonance::SlowFlow,
};
pub use lindstedt_equation::{Condition, Problem, Quantity};
pub use lindstedt_evaluation::EvaluationError;
pub use lindstedt_number::{Exact, Number, NumberError, Status};
pub use lindstedt_problem_file::ProblemFile;
pub use motion::Simulate;
pub use oscillator::Oscillator;
pub use refusal::{Kind, Refusal, Refused, general_hint};
pub use resonance::Averaged;
pub use respond::Respond;
pub use stability::Stability;
pub use threshold::Threshold;
pub use verify::Verify;

/// The libraries below this one, for whoever adds a ring, a policy of the driver or a judge, or checks a
/// coefficient by hand. **Not stable**: their items change with every version; a question that
/// needs them to be asked is worth a method of [`Oscillator`].
pub mod unstable {
    pub use lindstedt_algebra as algebra;
    pub use lindstedt_coeff as coeff;
    pub use lindstedt_derivation as derivation;
    pub use lindstedt_equation as equation;
    pub use lindstedt_evaluation as evaluation;
    pub use lindstedt_expand as expand;
    pub use lindstedt_hopf as hopf;
    pub use lindstedt_impact as impact;
    pub use lindstedt_melnikov as melnikov;
    pub use lindstedt_multimodular as multimodular;
    pub use lindstedt_number as number;
    pub use lindstedt_orbit as orbit;
    pub use lindstedt_phase as phase;
    pub use lindstedt_problem_file as problem_file;
    pub use lindstedt_problems as problems;
    pub use lindstedt_recognise as recognise;
    pub use lindstedt_series as series;
    pub use lindstedt_simulate as simulate;
}
