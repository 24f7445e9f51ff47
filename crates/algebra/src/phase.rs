//! Algebras of functions of the fast phase.

use crate::RationalAlgebra;
use rug::Rational;

/// Shorthand for the constants of an algebra of functions.
type Constant<A> = <<A as FunctionAlgebra>::Constants as crate::Ring>::Element;

/// An algebra of functions over a ring of constants: what it takes to expand an equation in its
/// small parameter.
pub trait FunctionAlgebra: RationalAlgebra {
    /// The ring of constants: functions that do not depend on the phase.
    type Constants: RationalAlgebra;

    /// The ring of constants.
    fn constants(&self) -> &Self::Constants;
    /// A constant as a function of the phase.
    fn embed(&self, c: &Constant<Self>) -> Self::Element;
    /// c f.
    fn scale_by(&self, f: &Self::Element, c: &Constant<Self>) -> Self::Element;
    /// c_1 f_1 + ... + c_m f_m; algebras override it where the sum costs less than its terms.
    fn linear_combination(&self, terms: &[(&Self::Element, &Constant<Self>)]) -> Self::Element {
        let mut sum = self.zero();
        for (f, c) in terms {
            self.add_assign(&mut sum, &self.scale_by(f, c));
        }
        sum
    }
    /// The linear combination of every list; see `Ring::SUMS_AT_ONCE`.
    fn linear_combinations(
        &self,
        lists: &[Vec<(&Self::Element, &Constant<Self>)>],
    ) -> Vec<Self::Element> {
        lists.iter().map(|terms| self.linear_combination(terms)).collect()
    }
    /// The constant that f is, if it is one.
    fn as_constant(&self, f: &Self::Element) -> Option<Constant<Self>>;
    /// ln |f|, where it lies in the algebra (in the Lobachevsky ring: f = cos psi).
    fn log_abs(&self, f: &Self::Element) -> Option<Self::Element>;
    /// g(f) for an elementary function g, where the algebra can evaluate it: algebras of values
    /// can, exact rings have nothing.
    fn apply(&self, _function: &Elementary, _f: &Self::Element) -> Option<Self::Element> {
        None
    }
    /// Whether f = g, as far as the algebra can tell: exactly, or within its rounding errors.
    fn agrees(&self, f: &Self::Element, g: &Self::Element) -> bool {
        f == g
    }
    /// The number of terms of f, for the work counters.
    fn terms(&self, f: &Self::Element) -> usize;
    /// Whether the algebra was asked to stop ([`Stop`](crate::Stop)) and the values computed
    /// since may mean nothing.
    fn interrupted(&self) -> bool {
        false
    }
}

/// An algebra in which time is more than the phase: with a forcing phase eta, or values at earlier times.
pub trait ForcedAlgebra: FunctionAlgebra {
    /// The number of delays that the algebra knows.
    fn delays(&self) -> usize {
        0
    }
    /// (cos m eta, sin m eta); nothing where there is no force.
    fn forcing(&self, multiple: u32) -> Option<(Self::Element, Self::Element)>;
}

/// What the equation u'' + u = f asks of an algebra of functions of the phase psi.
///
/// Laws (see [`laws::phase_algebra`](crate::laws::phase_algebra)): the derivation satisfies
/// Leibniz' rule and kills exactly the constants; `resolve` splits f without loss,
///
///   f = c cos psi + s sin psi + (u'' + u),   u(0) = u'(0) = 0,
///
/// where `c = 2<f cos>` and `s = 2<f sin>` are the resonant amplitudes (means over a period).
pub trait PhaseAlgebra: FunctionAlgebra {
    /// cos psi.
    fn cosine(&self) -> Self::Element;
    /// sin psi.
    fn sine(&self) -> Self::Element;
    /// df/dpsi.
    fn derivative(&self, f: &Self::Element) -> Self::Element;
    /// The force f = u'' + u that has the response u, see [`resolve`](Self::resolve); algebras override it where it
    /// costs less than its parts.
    fn force(&self, u: &Self::Element) -> Self::Element {
        self.add(&self.derivative(&self.derivative(u)), u)
    }
    /// The value f(0), where the algebra can give it.
    fn at_zero(&self, f: &Self::Element) -> Option<Constant<Self>>;
    /// The first harmonic `(2<f cos>, 2<f sin>)` of f.
    ///
    /// # Errors
    /// [`PhaseError`] when the mean values are not constants of this algebra.
    fn first_harmonic(
        &self,
        f: &Self::Element,
    ) -> Result<(Constant<Self>, Constant<Self>), PhaseError>;
    /// Splits off the resonant part of f and solves u'' + u = rest with u(0) = u'(0) = 0.
    ///
    /// # Errors
    /// [`PhaseError`] when the solution does not lie in this algebra.
    fn resolve(&self, f: &Self::Element) -> Result<Resolution<Self>, PhaseError>;
}

/// An elementary function of one variable.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Elementary {
    /// y^q: for y != 0 if q is an integer, for y > 0 otherwise.
    Power(Rational),
    /// e^y.
    Exp,
    /// sin y.
    Sin,
    /// cos y.
    Cos,
}

/// The parts of f = cos_amplitude cos psi + sin_amplitude sin psi + (response'' + response), unique with
/// the response at rest at zero, u(0) = u'(0) = 0.
#[derive(Clone, Debug)]
pub struct Resolution<A: PhaseAlgebra + ?Sized> {
    /// `2<f cos psi>`.
    pub cos_amplitude: Constant<A>,
    /// `2<f sin psi>`.
    pub sin_amplitude: Constant<A>,
    /// The solution u with u(0) = u'(0) = 0.
    pub response: A::Element,
}

/// Why an algebra could not split or solve.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PhaseError {
    /// The antiderivative needed is not an element of the algebra: could not decide.
    NotIntegrable {
        /// The power of cos psi at which the elimination leaves a remainder.
        power: i32,
    },
    /// The harmonic cos(k psi + m eta) is resonant: the linear part has no bounded response.
    Resonance {
        /// k.
        free: i32,
        /// m.
        forced: i32,
    },
    /// The ring of coefficients cannot divide by what the harmonic needs: could not decide.
    Indivisible {
        /// k in cos(k psi + m eta).
        free: i32,
        /// m.
        forced: i32,
    },
    /// The harmonic cos(k psi + m eta) is almost resonant: its divisor is below [`NEAR_MISS`].
    NearMiss {
        /// k.
        free: i32,
        /// m.
        forced: i32,
        /// 1 - lambda^2/omega_0^2, lambda the rate of the harmonic.
        size: Rational,
    },
    /// What the harmonic sum_j k_j nu_j + sum_l m_l Omega_l must be divided by cannot be told from zero: more
    /// digits decide, or it is a resonance.
    Undecided {
        /// k_1, ..., k_M, m_1, ..., m_L.
        harmonic: Vec<i32>,
    },
}

/// Of the square of a frequency: a smaller divisor says that a resonance was missed by a little.
pub const NEAR_MISS: (i32, i32) = (1, 1000);

/// The phase k psi + m eta as text: `2*psi - eta` from \[2, -1\]; `times` stands between number and name.
///
/// ```
/// use lindstedt_algebra::combination;
/// assert_eq!(combination([2, -1], ["psi", "eta"], "*"), "2*psi - eta");
/// assert_eq!(combination([0, -3], ["psi", "eta"], "*"), "-3*eta");
/// ```
#[must_use]
pub fn combination(factors: [i32; 2], names: [&str; 2], times: &str) -> String {
    let mut phase = String::new();
    for (n, name) in factors.into_iter().zip(names).filter(|(n, _)| *n != 0) {
        phase += match (phase.is_empty(), n < 0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        phase += &match n.unsigned_abs() {
            1 => name.to_owned(),
            n => format!("{n}{times}{name}"),
        };
    }
    phase
}

impl std::fmt::Display for PhaseError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotIntegrable { power } => {
                write!(f, "the antiderivative is not in the algebra (remainder at cos^{power})")
            }
            Self::Resonance { free, forced } => {
                let harmonic = "resonance with the harmonic";
                let phase = combination([*free, *forced], ["psi", "eta"], "*");
                write!(f, "{harmonic} cos({phase}) of the response and the force")
            }
            Self::Indivisible { free, forced } => {
                let harmonic = "could not divide by the response of the harmonic";
                let phase = combination([*free, *forced], ["psi", "eta"], "*");
                let why = "zero is not excluded, or the parameters must be numbers";
                write!(f, "{harmonic} cos({phase}): {why}")
            }
            Self::NearMiss { free, forced, size } => {
                let phase = combination([*free, *forced], ["psi", "eta"], "*");
                let size = size.to_f64();
                write!(
                    f,
                    "the harmonic cos({phase}) misses a resonance by {size:e} of the square of the frequency"
                )
            }
            Self::Undecided { harmonic } => {
                write!(f, "the divisor of the harmonic {harmonic:?} cannot be told from zero")
            }
        }
    }
}

impl std::error::Error for PhaseError {}
