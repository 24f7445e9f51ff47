//! Why an expansion was refused.

use lindstedt_algebra::PhaseError;
use thiserror::Error;

/// Why an equation could not be expanded. Positions are printed forms of the offending term.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ExpandError {
    /// The equation is not x'' + F(x, x') with x'' alone.
    #[error("x'' must stand alone with a constant factor, but the equation contains {term}")]
    AccelerationNotIsolated {
        /// The offending term.
        term: String,
    },
    /// A term that no algebra of the engine takes.
    #[error("the term {term} is not taken by this method")]
    UnsupportedTerm {
        /// The offending term.
        term: String,
    },
    /// A root of a number among the coefficients.
    #[error("{number} is irrational, and coefficients are rational numbers here")]
    IrrationalNumber {
        /// The number.
        number: String,
    },
    /// A name without a value.
    #[error("the name {name} has no value")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// At order zero the equation of this unknown is not x_j'' + nu_j^2 x_j + force(t) with the frequency
    /// nu_j of the algebra, off resonance.
    #[error(
        "without the small parameter equation {} is not that of the frequency given, off resonance",
        unknown + 1
    )]
    NotTheFrequency {
        /// j, from 0.
        unknown: usize,
    },
    /// At order zero a force has the frequency of this unknown.
    #[error("without the small parameter a force drives unknown {} at its own frequency: there the motion grows without bound", unknown + 1)]
    ForcedAtResonance {
        /// j, from 0.
        unknown: usize,
    },
    /// No value of the parameter that is sought removes the resonant part of this order.
    #[error("order {order}: no value of the parameter that is sought keeps the motion periodic")]
    NotBalanced {
        /// The order.
        order: usize,
    },
    /// The parts of a motion with its own frequency are no polynomials in the parameters without a value.
    #[error(
        "order {order}: cosine and sine of the motion mix in a ratio with parameters without a value below the line"
    )]
    TurnsBySymbols {
        /// The order.
        order: usize,
    },
    /// At order zero the equation is not a linear oscillator.
    #[error(
        "without the small parameter the equation is not x'' + k*x: it has damping, a delay or a nonlinear \
         term"
    )]
    NotWeaklyNonlinear,
    /// The factor of x at order zero cannot be divided by.
    #[error("the linear stiffness cannot be inverted among the coefficients")]
    SingularStiffness,
    /// x'' alone is no oscillator.
    #[error("the linear stiffness is zero: without the small terms nothing oscillates")]
    NoStiffness,
    /// x'' - k x is no oscillator.
    #[error("the linear stiffness is negative: no oscillation about x = 0")]
    NegativeStiffness,
    /// The stiffness is not 1 although the velocity occurs: omega_0 would be needed.
    #[error("the equation contains x': scale time so that the linear stiffness is 1")]
    StiffnessNotOne,
    /// The resonant part in sin psi does not vanish: the amplitude is not constant.
    #[error(
        "order {order}: the secular term in sin psi does not vanish, so no solution of \
             constant amplitude exists; a limit cycle or slow drift must be allowed"
    )]
    AmplitudeDrifts {
        /// The order at which it appears.
        order: usize,
    },
    /// omega_0, the square root of the stiffness, is not in the ring of coefficients.
    #[error("the linear stiffness has no square root among the coefficients")]
    StiffnessNotSquare,
    /// The cosine of a phase shift omega_0 T is not in the ring of coefficients.
    #[error("the phase shift of a delay is no angle with coefficients of this ring")]
    IrrationalAngle,
    /// A free amplitude was asked of the expansion at fixed amplitude.
    #[error("a free amplitude drifts: it is taken by the averaging expansion")]
    AmplitudeIsFree,
    /// No limit cycle: the first-order averaged equation has no positive root.
    #[error("no limit cycle: the averaged amplitude equation of order 1 has no positive root")]
    NoLimitCycle,
    /// The leading amplitude of a limit cycle is a root of a polynomial only for polynomial equations.
    #[error("a limit cycle is expanded only where the equation is a polynomial in x and x'")]
    CycleNotPolynomial,
    /// The averaged amplitude equation of order 1 vanishes for every amplitude.
    #[error(
        "the averaged amplitude equation of order 1 vanishes: a limit cycle is decided at a higher order, \
         which this expansion does not do"
    )]
    AmplitudeOfHigherOrder,
    /// The leading amplitude is not a rational number.
    #[error("the leading amplitude of the limit cycle is irrational")]
    IrrationalAmplitude,
    /// More than one limit cycle bifurcates.
    #[error("{count} limit cycles exist at order 1; only one can be expanded at a time")]
    SeveralLimitCycles {
        /// How many positive roots there are.
        count: usize,
    },
    /// The amplitude equation is degenerate, a multiple root.
    #[error(
        "the averaged amplitude equation of order 1 has a multiple root: whether there is a limit cycle, it does not decide"
    )]
    DegenerateLimitCycle,
    /// The algebra could not solve at some order.
    #[error("order {order}: {source}")]
    Phase {
        /// The order.
        order: usize,
        /// What the algebra said.
        source: PhaseError,
    },
    /// The solution is not found as one function of a shifted clock (it may exist in another form).
    #[error("order {order}: the solution is not one function of a shifted clock")]
    NotOneClock {
        /// The order at which it is seen.
        order: usize,
    },
    /// The caller asked to stop.
    #[error("interrupted at order {order}")]
    Interrupted {
        /// The order being computed.
        order: usize,
    },
    /// The normalisation is violated (a defect of the engine).
    #[error("the normalisation does not hold at order {order}")]
    Normalisation {
        /// The first order at which it does not hold.
        order: usize,
    },
    /// The residual of a computed expansion does not vanish (a defect of the engine).
    #[error("the residual does not vanish at order {order}")]
    Residual {
        /// The first order at which it does not vanish.
        order: usize,
    },
}
