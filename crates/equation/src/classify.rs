//! What an equation is made of, and which methods take it, before any work starts.

use crate::monomials::{MOST_TERMS, Monomial, Monomials, expand};
use crate::symmetry::{Parity, is_reversible, parity};
use crate::{AccelerationFault, Expression, Function, Problem};
use rug::Rational;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use thiserror::Error;

/// Ratios of the frequencies of force and oscillator are recognised up to these numbers.
const LARGEST_RESONANCE: u32 = 10;

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
    /// No term in x at order zero.
    NoLinearPart,
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
    /// The form x F(small ln x^2) is needed.
    Form,
    /// No saddle of an integrable equation at order zero.
    NoSaddle,
    /// The small parameter does not occur.
    NoSmallParameter,
    /// Nothing depends on t.
    NoForce,
    /// A force with a phase, or of another frequency than one before it.
    Frequency(Expression),
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
    /// Whether solutions can be run backwards in time ([`is_reversible`]).
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
            | Self::Forced(e)
            | Self::Resonant(e, _)
            | Self::Delay(e)
            | Self::NonSmooth(e)
            | Self::NotPolynomial(e)
            | Self::NotReal(e)
            | Self::Formal(e)
            | Self::Frequency(e)
            | Self::Drift(e) => Some(e),
            _ => None,
        }
    }
}

/// Why an equation could not be classified.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ClassifyError {
    /// x'' is not free.
    #[error("x'' does not stand alone")]
    Acceleration(AccelerationFault),
    /// Multiplied out, the equation is too long.
    #[error("multiplied out, the equation has more than {limit} terms")]
    TooManyTerms {
        /// The limit.
        limit: usize,
    },
}

/// Classifies a problem with the rational values that are known for its parameters.
///
/// # Errors
/// [`ClassifyError`].
///
/// # Example
/// ```
/// use lindstedt_equation::classify::{Method, Symmetry, classify};
/// use lindstedt_equation::Expression;
/// # use lindstedt_equation::{AmplitudeRole, Condition, Problem};
/// let x = Expression::Displacement;
/// # let problem = |equation| Problem {
/// #     name: "".into(), title: "".into(), equation, time_domain: None, impact: None,
/// #     synchronous: None,
/// #     small: "eps".into(), conditions: vec![Condition::InitialAmplitude],
/// #     amplitude: AmplitudeRole::InSmallParameter, parameters: Vec::new(), notes: "".into(),
/// #     source: "".into(),
/// # };
/// let duffing = problem(Expression::Acceleration + x.clone() + Expression::Small * x.pow(3));
/// let parts = classify(&duffing, &Default::default())?;
/// assert_eq!(parts.weak.len(), 1);
/// assert_eq!(parts.symmetry, Symmetry::Odd);
/// assert!(parts.takes(Method::LindstedtPoincare));
/// # Ok::<(), lindstedt_equation::classify::ClassifyError>(())
/// ```
pub fn classify(
    problem: &Problem,
    values: &BTreeMap<String, Rational>,
) -> Result<Classification, ClassifyError> {
    let equation = problem.equation.acceleration_alone().map_err(ClassifyError::Acceleration)?;
    let rest = equation.terms().iter().filter(|t| **t != Expression::Acceleration).cloned();
    let rest = Expression::Sum(rest.collect()).smooth_powers().canonical();
    let all = expand(&rest).ok_or(ClassifyError::TooManyTerms { limit: MOST_TERMS })?;
    let is_linear = |m: &Monomial| m.order == 0 && m.is_power(1, 0);
    // x (x^2)^delta and x S(delta ln x^2) carry a linear part too.
    let stiffness = linear_at_zero(&rest).unwrap_or_else(|| all.coefficient(is_linear));
    let value = |e: &Expression| evaluate(e, values);
    let mut parts = Classification {
        frequency: root(&stiffness),
        stiffness,
        strong: Vec::new(),
        weak: Vec::new(),
        forcing: Vec::new(),
        delays: collect(&rest, &|e| matches!(e, Expression::Delayed(..))),
        non_smooth: collect(
            &rest,
            &|e| matches!(e, Expression::Function(Function::Abs | Function::Sign, z) if !z.is_constant()),
        ),
        impact: problem.impact.is_some(),
        symmetry: if problem.impact.is_some() { Symmetry::None } else { Symmetry::Odd },
        reversible: true,
        algebra: Algebra::Numeric,
        methods: Vec::new(),
    };
    let stiffness_value = value(&parts.stiffness);
    for (monomial, q) in &all.terms {
        let term = all.tree(monomial, q);
        if term.contains(&Expression::Time) {
            parts.forcing.push(forcing(&all, monomial, term, stiffness_value.as_ref(), values));
            continue;
        }
        if parity(&term, true) != Some(Parity::Odd) {
            parts.symmetry = Symmetry::None;
        }
        if is_linear(monomial) {
            continue;
        }
        let order = monomial.order;
        // small^order is a factor; delta in (x^2)^delta vanishes at order zero too.
        let hidden = monomial
            .atoms
            .keys()
            .any(|key| all.atoms.get(key).is_some_and(|atom| atom.contains(&Expression::Small)));
        let list = if order > 0 || hidden { &mut parts.weak } else { &mut parts.strong };
        list.push(Term { term, order });
    }
    if !parts.strong.is_empty() && strong_terms_cancel(&rest, values) {
        parts.strong.clear();
    }
    parts.reversible =
        parts.forcing.is_empty() && problem.impact.is_none() && is_reversible(&equation);
    let stiffness_value = value(&parts.stiffness);
    crate::methods::decide(problem, &rest, values, stiffness_value, &mut parts);
    Ok(parts)
}

/// Whether the nonlinear terms at small parameter zero cancel each other at the values given.
fn strong_terms_cancel(rest: &Expression, values: &BTreeMap<String, Rational>) -> bool {
    let bind = |e: &Expression| match e {
        Expression::Small => Some(Expression::integer(0)),
        Expression::Parameter(name) => values.get(name).cloned().map(Expression::Number),
        _ => None,
    };
    let bound = without_trivial_powers(&rest.substitute(&bind).canonical());
    let Some(all) = expand(&bound) else { return false };
    all.terms.iter().all(|(monomial, q)| {
        monomial.is_power(1, 0) || all.tree(monomial, q).contains(&Expression::Time)
    })
}

/// kappa, when the equation at small parameter zero, multiplied out, is kappa x alone.
fn linear_at_zero(rest: &Expression) -> Option<Expression> {
    let off = |e: &Expression| matches!(e, Expression::Small).then(|| Expression::integer(0));
    let at_zero = without_trivial_powers(&rest.substitute(&off).canonical());
    let all = expand(&at_zero)?;
    let linear = all.terms.keys().all(|m| m.is_power(1, 0));
    linear.then(|| all.coefficient(|m| m.is_power(1, 0)))
}

/// y^0 = 1 and F(0) = F_0 where the small parameter was set to zero.
fn without_trivial_powers(e: &Expression) -> Expression {
    let again = without_trivial_powers;
    match e {
        Expression::Sum(l) => Expression::Sum(l.iter().map(again).collect()).canonical(),
        Expression::Product(l) => Expression::Product(l.iter().map(again).collect()).canonical(),
        Expression::Power(_, n) if n.as_number().is_some_and(|n| n.is_zero()) => {
            Expression::integer(1)
        }
        Expression::Function(Function::Exp, z) if z.as_number().is_some_and(|z| z.is_zero()) => {
            Expression::integer(1)
        }
        Expression::Formal(name, z) if z.as_number().is_some_and(|z| z.is_zero()) => {
            Expression::parameter(&format!("{name}_0"))
        }
        other => other.clone(),
    }
}

fn forcing(
    all: &Monomials,
    monomial: &Monomial,
    term: Expression,
    stiffness: Option<&Rational>,
    values: &BTreeMap<String, Rational>,
) -> Forcing {
    let atoms = || monomial.atoms.keys().filter_map(|key| all.atoms.get(key));
    let harmonic = atoms().find(|atom| atom.contains(&Expression::Time));
    let frequency = harmonic.and_then(frequency_of);
    let squared = frequency.as_ref().and_then(|f| evaluate(f, values)).map(|f| f.clone() * f);
    let resonance = squared
        .zip(stiffness.filter(|kappa| !kappa.is_zero()))
        .and_then(|(s, kappa)| ratio(&(s / kappa)));
    let delayed = atoms().any(|atom| matches!(atom, Expression::Delayed(..)));
    let parametric = monomial.x + monomial.velocity > 0 || delayed;
    Forcing { order: monomial.order, frequency, parametric, resonance, term }
}

/// omega of cos(omega t + phase) or sin(omega t + phase).
fn frequency_of(e: &Expression) -> Option<Expression> {
    let Expression::Function(Function::Sin | Function::Cos, argument) = e else { return None };
    let all = expand(argument)?;
    let time = |m: &Monomial| m.atoms.get("t") == Some(&1) && m.atoms.len() == 1;
    let linear = all
        .terms
        .keys()
        .all(|m| (m.atoms.is_empty() || time(m)) && m.order == 0 && m.x == 0 && m.velocity == 0);
    let frequency = all.coefficient(time);
    (linear && frequency != Expression::integer(0)).then_some(frequency)
}

/// (k, m) with (k/m)^2 = q.
fn ratio(q: &Rational) -> Option<(u32, u32)> {
    let root = rational_root(q)?;
    let k = root.numer().to_u32().filter(|k| *k <= LARGEST_RESONANCE)?;
    let m = root.denom().to_u32().filter(|m| *m <= LARGEST_RESONANCE)?;
    Some((k, m))
}

/// The rational square root of a positive rational number, if it is one.
pub fn rational_root(q: &Rational) -> Option<Rational> {
    let square = q.cmp0() == Ordering::Greater
        && q.numer().is_perfect_square()
        && q.denom().is_perfect_square();
    square.then(|| Rational::from((q.numer().clone().sqrt(), q.denom().clone().sqrt())))
}

/// sqrt(kappa), in closed form where kappa is a square.
fn root(kappa: &Expression) -> Expression {
    let half = Expression::Number(Rational::from((1, 2)));
    let plain = || kappa.clone().pow(half.clone());
    match kappa {
        Expression::Number(q) => rational_root(q).map_or_else(plain, Expression::Number),
        Expression::Power(base, n) if n.as_number().is_some_and(|n| n == 2) => (**base).clone(),
        _ => plain(),
    }
}

/// The value of a constant expression, exactly, if the parameters have values.
pub fn evaluate(e: &Expression, values: &BTreeMap<String, Rational>) -> Option<Rational> {
    let value = |e: &Expression| match e {
        Expression::Parameter(name) => values.get(name).cloned().map(Expression::Number),
        _ => None,
    };
    e.substitute(&value).as_number()
}

/// The subexpressions of a kind, each once.
fn collect(e: &Expression, wanted: &dyn Fn(&Expression) -> bool) -> Vec<Expression> {
    let found = std::cell::RefCell::new(Vec::new());
    let note = |e: &Expression| {
        if wanted(e) && !found.borrow().contains(e) {
            found.borrow_mut().push(e.clone());
        }
        false
    };
    let _ = e.find(&note);
    found.into_inner()
}

/// kappa of x'' + kappa x at order zero; nothing when the equation is too long to multiply out.
pub fn linear_stiffness(equation: &Expression) -> Option<Expression> {
    let all = expand(equation)?;
    Some(all.coefficient(|m| m.order == 0 && m.is_power(1, 0)))
}

/// The coefficients of small^i x^j x'^k by [i, j, k], x'' left out, of an equation that is a
/// polynomial with numbers for coefficients; nothing for another one, or when it is too long to
/// multiply out.
///
/// ```
/// use lindstedt_equation::{Expression, classify::polynomial};
/// let x = Expression::Displacement;
/// let duffing = Expression::Acceleration + 2 * x.clone() + 3 * Expression::Small * x.pow(3);
/// let terms: Vec<_> = polynomial(&duffing).into_iter().flatten().collect();
/// assert_eq!(terms, [([0, 1, 0], 2.into()), ([1, 3, 0], 3.into())]);
/// ```
pub fn polynomial(equation: &Expression) -> Option<BTreeMap<[u32; 3], Rational>> {
    let without = |e: &Expression| (*e == Expression::Acceleration).then(|| Expression::integer(0));
    let all = expand(&equation.substitute(&without))?;
    let plain = |(m, q): (&Monomial, &Rational)| {
        (m.atoms.is_empty() && m.parameters.is_empty())
            .then(|| ([m.order, m.x, m.velocity], q.clone()))
    };
    all.terms.iter().map(plain).collect()
}
