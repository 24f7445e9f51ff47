//! Choices by their words: one table for each, which the program, Python and the answers read.

use crate::evaluate::Language;
use crate::motion::{Section, View};
use crate::{Condition, Route, Work};
use lindstedt_derivation::numeric::Tier;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::parameters::Branch;
use lindstedt_impact::prediction::Variant;
use lindstedt_series::resummation::Method;

/// A value with its word, and what it is in a line; nothing where the word says it.
///
/// ```
/// use lindstedt::{Route, choices::{Choice, ROUTES}};
/// assert_eq!(Choice::find(ROUTES, "clock"), Some(Route::Clock));
/// assert_eq!(Choice::word(ROUTES, Route::EnergyIntegral), "energy");
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Choice<T> {
    /// The word.
    pub word: &'static str,
    /// The value.
    pub value: T,
    /// What it is.
    pub help: &'static str,
}

impl<T: Copy> Choice<T> {
    const fn new(word: &'static str, value: T, help: &'static str) -> Self {
        Self { word, value, help }
    }

    /// The value of a word.
    #[must_use]
    pub fn find(list: &[Self], word: &str) -> Option<T> {
        list.iter().find(|choice| choice.word == word).map(|choice| choice.value)
    }

    /// The word of a value; empty where the list does not have it.
    #[must_use]
    pub fn word(list: &[Self], value: T) -> &'static str
    where
        T: PartialEq,
    {
        list.iter().find(|choice| choice.value == value).map_or("", |choice| choice.word)
    }
}

/// What the amplitude is.
pub const NORMALISATIONS: &[Choice<Condition>] = &[
    Choice::new("initial", Condition::InitialAmplitude, "x(0) = A, x'(0) = 0"),
    Choice::new("fundamental", Condition::FundamentalAmplitude, "The first harmonic of x is A cos"),
    Choice::new(
        "free",
        Condition::FreeAmplitude,
        "The first harmonic is a cos(psi), a drifts: averaging (KBM)",
    ),
];

/// How an exact expansion is derived; the last has no solution.
pub const ROUTES: &[Choice<Route>] = &[
    Choice::new(
        "auto",
        Route::Automatic,
        "The clock where the equation allows it, else the driver",
    ),
    Choice::new(
        "driver",
        Route::Driver,
        "Solution and frequency order by order, checked by substitution",
    ),
    Choice::new(
        "clock",
        Route::Clock,
        "Solution and frequency from the still part of the solution and one shift of its clock",
    ),
    Choice::new(
        "energy",
        Route::EnergyIntegral,
        "The frequency alone, exact and to much higher order",
    ),
    Choice::new("frequency", Route::Frequency, "The series of omega^2, omega and T"),
];

/// The numbers that an expansion is derived in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Numbers {
    /// Exact ones.
    Exact,
    /// Values at nodes, in doubles or to the digits of the work.
    Collocation,
    /// Fourier coefficients in doubles.
    Fourier,
}

impl Numbers {
    /// The tier with so many harmonics; nothing for exact numbers.
    #[must_use]
    pub fn tier(self, harmonics: usize, work: &Work) -> Option<Tier> {
        match self {
            Self::Exact => None,
            Self::Fourier => Some(Tier::Fourier { harmonics }),
            Self::Collocation if work.doubles => Some(Tier::Doubles),
            Self::Collocation => Some(Tier::Collocation { digits: work.digits }),
        }
    }
}

/// The tiers of an expansion.
pub const TIERS: &[Choice<Numbers>] = &[
    Choice::new("exact", Numbers::Exact, "Exact rings; every order substituted back"),
    Choice::new("collocation", Numbers::Collocation, "Values at double-exponential nodes"),
    Choice::new("fourier", Numbers::Fourier, "A truncated Fourier series"),
];

/// How a series is summed; nothing is the method with the least error estimate.
pub const RESUMMATIONS: &[Choice<Option<Method>>] = &[
    Choice::new(
        Method::PartialSum.name(),
        Some(Method::PartialSum),
        "The partial sum; of a divergent series up to the smallest term",
    ),
    Choice::new(Method::Pade.name(), Some(Method::Pade), "Diagonal Pade approximants"),
    Choice::new(
        Method::Uniform.name(),
        Some(Method::Uniform),
        "The series in u = x/(1 + x) with a prefactor",
    ),
    Choice::new(Method::UniformPade.name(), Some(Method::UniformPade), "Pade approximants in u"),
    Choice::new(
        Method::ConformalPade.name(),
        Some(Method::ConformalPade),
        "A conformal map of the plane cut at the nearest singularities, then Pade",
    ),
    Choice::new(
        Method::BorelPade.name(),
        Some(Method::BorelPade),
        "Pade approximants of the Borel transform",
    ),
    Choice::new(
        "auto",
        None,
        "The least error estimate, or a simpler method within a factor ten of it",
    ),
];

/// The languages of code.
pub const LANGUAGES: &[Choice<Language>] = &[
    Choice::new("rust", Language::Rust, ""),
    Choice::new("python", Language::Python, ""),
    Choice::new("c", Language::C, ""),
    Choice::new("latex", Language::Latex, ""),
];

/// Poincare sections.
pub const SECTIONS: &[Choice<Section>] = &[
    Choice::new(
        "stroboscopic",
        Section::Stroboscopic,
        "Once per period of the force, t = 2 pi n/omega",
    ),
    Choice::new("impact", Section::Impact, "Just before each impact"),
    Choice::new("velocity", Section::Velocity, "x' = 0 from above: maxima of x"),
];

/// What a figure shows: of a motion, and last, of a sweep alone.
pub const FIGURES: &[Choice<Option<View>>] = &[
    Choice::new("phase", Some(View::Phase), "x' over x, sticking marked"),
    Choice::new("time", Some(View::Time), "x over t with impacts and sticking"),
    Choice::new("section", Some(View::Section), "The points of the section"),
    Choice::new("bifurcation", None, "The points of the section over the swept parameter"),
];

/// Which orbit meets which flow in the averaged prediction, and whether the averaging knows of the impact within the delay.
pub const VARIANTS: &[Choice<(Variant, bool)>] = &[
    Choice::new("E", (Variant::E, false), "Orbit and map of the equivalent flow"),
    Choice::new("S", (Variant::S, false), "The true orbit's saltation with the equivalent flow"),
    Choice::new("P", (Variant::P, false), "The paper's letter"),
    Choice::new(
        "impact-aware",
        (Variant::E, true),
        "The averaging that knows of the impact within the delay",
    ),
];

/// The velocity kick in the characteristic function.
pub const KICKS: &[Choice<Kick>] = &[
    Choice::new("none", Kick::None, ""),
    Choice::new("mean", Kick::Mean, ""),
    Choice::new("before", Kick::Before, ""),
    Choice::new("after", Kick::After, ""),
];

/// The root of the impact velocity.
pub const BRANCHES: &[Choice<Branch>] =
    &[Choice::new("+", Branch::Plus, ""), Choice::new("-", Branch::Minus, "")];

/// Whether a stability has the averaged prediction, and whether the truth.
pub const PREDICTORS: &[Choice<(bool, bool)>] = &[
    Choice::new("kbm", (true, false), "The averaged prediction (KBM) alone"),
    Choice::new("exact", (false, true), "The exact characteristic function alone"),
    Choice::new("both", (true, true), "Both, with their agreement"),
];
