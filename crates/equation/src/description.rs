//! A classification in words and printed terms.

use crate::Expression;
use crate::classify::{Algebra, Classification, Forcing, Method, Reason, Symmetry, Term, evaluate};
use crate::print::Style;
use rug::Rational;
use serde::Serialize;
use std::collections::BTreeMap;

/// What an equation is made of and which methods take it, in words and printed terms.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Description {
    /// The factor of x at order zero.
    pub stiffness: String,
    /// omega_0.
    pub frequency: String,
    /// The linear part, `x'' + ... = 0` without the zero; nothing where there is none.
    #[serde(skip)]
    pub linear: Option<String>,
    /// Terms of order zero that are not linear.
    pub strong: Vec<Described>,
    /// Terms with the small parameter.
    pub weak: Vec<Described>,
    /// Terms that depend on t.
    pub forcing: Vec<DescribedForce>,
    /// x(t - T).
    pub delays: Vec<String>,
    /// What is not smooth.
    pub non_smooth: Vec<String>,
    /// Whether there is a wall.
    pub impact: bool,
    /// Whether it is odd under x -> -x, the forcing apart.
    pub odd: bool,
    /// Whether it is the same backwards in time.
    pub reversible: bool,
    /// The algebra of its expansion.
    pub algebra: &'static str,
    /// Every method with what speaks against it.
    pub methods: Vec<DescribedMethod>,
}

/// A term with its order; order 0 among the weak ones is the small parameter inside a function.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Described {
    /// The term.
    pub term: String,
    /// Its power of the small parameter.
    pub order: u32,
}

/// A force.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DescribedForce {
    /// The term.
    pub term: String,
    /// Its power of the small parameter.
    pub order: u32,
    /// Its frequency; nothing where it is not harmonic.
    pub frequency: Option<String>,
    /// Whether it multiplies x.
    pub parametric: bool,
    /// `k:m` where it is in resonance with omega_0.
    pub resonance: Option<String>,
}

/// A method with what speaks against it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DescribedMethod {
    /// The method.
    pub method: &'static str,
    /// Whether it takes the equation.
    pub applies: bool,
    /// The reasons against it.
    pub against: Vec<String>,
    /// Whether only the condition of the file keeps averaging away.
    #[serde(skip)]
    pub only_condition: bool,
}

impl Description {
    /// A classification in words.
    #[must_use]
    pub fn new(parts: &Classification, small: &str) -> Self {
        let show = |e: &Expression| e.print(small, Style::Text);
        let terms = |list: &[Term]| {
            let term = |t: &Term| Described { term: show(&t.term), order: t.order };
            list.iter().map(term).collect()
        };
        let force = |f: &Forcing| DescribedForce {
            term: show(&f.term),
            order: f.order,
            frequency: f.frequency.as_ref().map(show),
            parametric: f.parametric,
            resonance: f.resonance.map(|(k, m)| format!("{k}:{m}")),
        };
        let method = |(method, against): &(Method, Vec<Reason>)| DescribedMethod {
            method: method_name(*method),
            applies: against.is_empty(),
            against: against.iter().map(|r| reason_text(r, small)).collect(),
            only_condition: *method == Method::Averaging && against[..] == [Reason::Condition],
        };
        // As a product with x in a sum: signs and parentheses come out as in an equation.
        let linear = (parts.stiffness != Expression::integer(0)).then(|| {
            let force = parts.stiffness.clone() * Expression::DISPLACEMENT;
            show(&(Expression::ACCELERATION + force).canonical())
        });
        Self {
            stiffness: show(&parts.stiffness),
            frequency: show(&parts.frequency),
            linear,
            strong: terms(&parts.strong),
            weak: terms(&parts.weak),
            forcing: parts.forcing.iter().map(force).collect(),
            delays: parts.delays.iter().map(show).collect(),
            non_smooth: parts.non_smooth.iter().map(show).collect(),
            impact: parts.impact,
            odd: parts.symmetry == Symmetry::Odd,
            reversible: parts.reversible,
            algebra: algebra_name(parts.algebra),
            methods: parts.methods.iter().map(method).collect(),
        }
    }
}

fn method_name(method: Method) -> &'static str {
    match method {
        Method::LindstedtPoincare => "Lindstedt-Poincare",
        Method::Averaging => "averaging (KBM)",
        Method::EnergyIntegral => "energy integral",
        Method::Melnikov => "Melnikov",
        Method::TimeDomain => "time domain",
    }
}

fn algebra_name(algebra: Algebra) -> &'static str {
    match algebra {
        Algebra::TrigonometricOverRationals => "trigonometric polynomials over Q",
        Algebra::TrigonometricOverParameters => "trigonometric polynomials over Q[parameters]",
        Algebra::HalfTurns => "half turns between turning points",
        Algebra::Lobachevsky => "Lobachevsky ring",
        _ => "numeric only",
    }
}

/// A reason in words.
#[must_use]
pub fn reason_text(reason: &Reason, small: &str) -> String {
    let show = |e: &Expression| shortened(&e.print(small, Style::Text));
    match reason {
        Reason::NotWeaklyNonlinear(e) => {
            format!("{} has no factor {small}, so the equation is not weakly nonlinear", show(e))
        }
        Reason::DelayedLinearPart(e) => {
            format!("{} is linear and has no factor {small}: the linear part has a delay", show(e))
        }
        Reason::NoLinearPart => format!("no term k*x stands in the equation without {small}"),
        Reason::Divided(e) => format!(
            "{} does not cancel: what the equation is at {small} = 0 does not follow from its form",
            show(e)
        ),
        Reason::NegativeStiffness => "the linear stiffness is negative".into(),
        Reason::IrrationalFrequency => "x' occurs and omega_0 is irrational".into(),
        Reason::UnknownFrequency => "x' occurs and omega_0 has no value".into(),
        Reason::Forced(e) => format!("{} depends on t", show(e)),
        Reason::Resonant(e, (k, m)) => {
            format!("{} is of order zero and in resonance {k}:{m} with the linear part", show(e))
        }
        Reason::Delay(e) => format!("{} is a delay", show(e)),
        Reason::NonSmooth(e) => format!("{} is not smooth", show(e)),
        Reason::NotOdd(e) => format!(
            "{} is not odd, f(-x, -x') = -f(x, x'): the two half turns between turning points differ",
            show(e)
        ),
        Reason::NotPolynomial(e) if e.is_constant() => {
            format!("{} is irrational, and coefficients are rational numbers here", show(e))
        }
        Reason::NotPolynomial(e) => format!("{} is no polynomial in x, x' and ln x^2", show(e)),
        // A root of what is not 0 at rest is analytic there.
        Reason::NotReal(e @ Expression::Power(base, _)) if is_regular_at_rest(base) => format!(
            "{} is not real everywhere: write taylor({0}, 9), its polynomial of degree 9",
            show(e)
        ),
        Reason::NotReal(e) => format!(
            "{} is not real everywhere: write sign(x)*abs(x)^p, x*(x^2)^{small}, ln(x^2)",
            show(e)
        ),
        Reason::Impact => "there is a wall".into(),
        Reason::Drift(e) => {
            format!("{} works on x', so the amplitude drifts", show(e))
        }
        Reason::Condition => "the condition of the problem belongs to another method".into(),
        Reason::Form => format!("needs a force f(x), polynomial or x*F({small}*ln(x^2))"),
        Reason::Frequency(e) => format!(
            "{}: forces are cos or sin of multiples of one omega*t by numbers, without a phase",
            show(e)
        ),
        Reason::IrrationalRatio(e) => format!("{}: its frequency is an irrational number", show(e)),
        Reason::LargeDetuning(e) => {
            format!("{}: the detuning in its frequency is not small", show(e))
        }
        Reason::NoForce => "there is no force".into(),
        Reason::NoSaddle => "no integrable equation with a saddle at order zero".into(),
        Reason::NoSmallParameter => format!("the small parameter {small} does not occur"),
        Reason::Formal(e) => format!("{} is a formal function", show(e)),
        Reason::OutsideDomain(what) => what.clone(),
    }
}

/// Whether a base is a number other than 0 at x = x' = 0 and without the small parameter.
fn is_regular_at_rest(base: &Expression) -> bool {
    let rest = base.substitute(&|leaf| match leaf {
        Expression::Unknown(_) | Expression::Small => Some(Expression::Number(Rational::new())),
        _ => None,
    });
    evaluate(&rest, &BTreeMap::new()).is_some_and(|value| !value.is_zero())
}

/// The beginning of a long term.
#[must_use]
pub fn shortened(text: &str) -> String {
    let mut shown: String = text.chars().take(60).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown
}
