//! What an equation is made of, and which methods take it: the data.

use crate::Expression;
use rug::Rational;
use std::collections::BTreeMap;

/// A term with its order in the small parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The term, the small parameter included.
    pub term: Expression,
    /// The power of the small parameter.
    pub order: u32,
}

/// A harmonic force, or a coefficient that varies harmonically in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Forcing {
    /// The term.
    pub term: Expression,
    /// Its order in the small parameter.
    pub order: u32,
    /// Its frequency, if it is a sine or cosine of omega t (+ phase).
    pub frequency: Option<Expression>,
    /// Whether x or x' is a factor.
    pub parametric: bool,
    /// (k, m) with omega : omega_0 = k : m exactly, both at most 10; nothing when the values are
    /// not known or the ratio is no such fraction.
    pub resonance: Option<(u32, u32)>,
}

/// How the equation changes under (x, x') -> (-x, -x').
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// It changes its sign: the solution has odd harmonics only.
    Odd,
    /// Terms of both parities, or of a parity that is not decided.
    None,
}

/// The coefficients and functions that a derivation computes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Algebra {
    /// Trigonometric polynomials over Q.
    TrigonometricOverRationals,
    /// Trigonometric polynomials over `Q[parameters]`.
    TrigonometricOverParameters,
    /// Polynomials in the phase and its harmonics between turning points.
    HalfTurns,
    /// The Lobachevsky ring.
    Lobachevsky,
    /// None: numbers only.
    Numeric,
}

/// The methods of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Lindstedt and Poincare: a constant amplitude or a limit cycle.
    LindstedtPoincare,
    /// Krylov, Bogoliubov, Mitropolsky: a drifting amplitude, forcing, delay.
    Averaging,
    /// The energy integral: the frequency alone.
    EnergyIntegral,
    /// Melnikov's integral over a homoclinic orbit.
    Melnikov,
    /// Integration in time.
    TimeDomain,
}

/// Why a method does not apply. Terms are given as they occur, multiplied out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// A term of order zero other than x'' and x.
    NotWeaklyNonlinear(Expression),
    /// x or x' at an earlier time among the linear terms of order zero.
    DelayedLinearPart(Expression),
    /// No term in x at order zero.
    NoLinearPart,
    /// A division by the small parameter, which does not cancel.
    Divided(Expression),
    /// x'' - k x: no oscillation about x = 0.
    NegativeStiffness,
    /// The velocity occurs and omega_0 is irrational, so that time cannot be scaled exactly.
    IrrationalFrequency,
    /// The velocity occurs and omega_0 has no value, so that time cannot be scaled.
    UnknownFrequency,
    /// A function of t.
    Forced(Expression),
    /// A force of order zero in resonance with the linear part, k : m.
    Resonant(Expression, (u32, u32)),
    /// A delay.
    Delay(Expression),
    /// A function without a derivative at zero.
    NonSmooth(Expression),
    /// A term that is not odd, f(-x, -x') = -f(x, x'), beside one that jumps with the velocity.
    NotOdd(Expression),
    /// A function that is no polynomial in x, x' and ln x^2.
    NotPolynomial(Expression),
    /// A real power or logarithm of something that can be negative.
    NotReal(Expression),
    /// A wall.
    Impact,
    /// A term odd in the velocity, under a condition with constant amplitude.
    Drift(Expression),
    /// The condition of the problem belongs to another method.
    Condition,
    /// A force f(x), polynomial or of the form x F(small ln x^2), is needed.
    Form,
    /// No saddle of an integrable equation at order zero.
    NoSaddle,
    /// The small parameter does not occur.
    NoSmallParameter,
    /// Nothing depends on t.
    NoForce,
    /// A force with a phase, or of another frequency than one before it.
    Frequency(Expression),
    /// A force whose frequency is an irrational number.
    IrrationalRatio(Expression),
    /// A force whose frequency is a number and a detuning that is not small.
    LargeDetuning(Expression),
    /// A formal function, and no equation for integration in time.
    Formal(Expression),
    /// A value outside its domain, with the domain; found by who knows the values.
    OutsideDomain(String),
}

/// The parts of an equation and the methods that take it.
#[derive(Clone, Debug, PartialEq)]
pub struct Classification {
    /// kappa of x'' + kappa x at order zero.
    pub stiffness: Expression,
    /// omega_0 = sqrt(kappa).
    pub frequency: Expression,
    /// Terms of order zero other than x'' and kappa x, forces apart.
    pub strong: Vec<Term>,
    /// Terms with the small parameter, forces apart.
    pub weak: Vec<Term>,
    /// Terms with t.
    pub forcing: Vec<Forcing>,
    /// x or x' at an earlier time.
    pub delays: Vec<Expression>,
    /// Functions that are not smooth.
    pub non_smooth: Vec<Expression>,
    /// Whether there is a wall.
    pub impact: bool,
    /// The symmetry, forces apart.
    pub symmetry: Symmetry,
    /// Whether solutions can be run backwards in time (`symmetry::is_reversible`).
    pub reversible: bool,
    /// What a derivation computes with.
    pub algebra: Algebra,
    /// Every method with the reasons against it, none for a method that applies.
    pub methods: Vec<(Method, Vec<Reason>)>,
}

impl Classification {
    /// Whether the method applies.
    pub fn takes(&self, method: Method) -> bool {
        self.methods.iter().any(|(m, against)| *m == method && against.is_empty())
    }

    /// The term because of which no expansion and no threshold exists, with the reason; nothing
    /// when some method other than integration in time applies.
    pub fn refusal(&self) -> Option<&Reason> {
        let formal = |m: &Method| !matches!(m, Method::TimeDomain);
        let mut methods = self.methods.iter().filter(|(m, _)| formal(m));
        if methods.any(|(_, against)| against.is_empty()) {
            return None;
        }
        let of = |method| self.methods.iter().find(|(m, _)| *m == method);
        let reasons = of(Method::Averaging).into_iter().chain(of(Method::LindstedtPoincare));
        reasons.flat_map(|(_, against)| against).next()
    }
}

impl Reason {
    /// The term that the reason is about.
    pub fn term(&self) -> Option<&Expression> {
        match self {
            Self::NotWeaklyNonlinear(e)
            | Self::DelayedLinearPart(e)
            | Self::Forced(e)
            | Self::Resonant(e, _)
            | Self::Delay(e)
            | Self::NonSmooth(e)
            | Self::NotOdd(e)
            | Self::NotPolynomial(e)
            | Self::NotReal(e)
            | Self::Formal(e)
            | Self::Frequency(e)
            | Self::IrrationalRatio(e)
            | Self::LargeDetuning(e)
            | Self::Drift(e) => Some(e),
            _ => None,
        }
    }
}

/// The value of a constant expression, exactly, if the parameters have values.
pub fn evaluate(e: &Expression, values: &BTreeMap<String, Rational>) -> Option<Rational> {
    e.with_values(values).as_number()
}
