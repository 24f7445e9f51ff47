//! Which methods take an equation, and why the others do not.

use crate::refusal::{Refusal, Refused, averages};
use crate::{Error, Exact, check_parameters, known_values};
use lindstedt_equation::classify::{
    Algebra, Classification, ClassifyError, Method, Reason, Symmetry, classify,
};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Condition, Expression, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_problem_file::ProblemFile;
use serde::Serialize;
use std::collections::BTreeMap;

/// Classifies a problem with the values given and the defaults. A value outside its domain is against
/// every method that looks at it: Melnikov's looks at no amplitude, averaging asks for another start.
/// # Errors
/// [`ClassifyError`].
pub fn of(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
) -> Result<Classification, ClassifyError> {
    let mut parts = classify(problem, &known_values(problem, given))?;
    if let Err(error) = check_parameters(problem, given)
        && let Error::OutsideDomain { name, .. } = &error
    {
        let looks = |method| match method {
            Method::Melnikov => false,
            Method::Averaging => name != "amplitude",
            _ => true,
        };
        let applies =
            |(method, against): &&mut (Method, Vec<Reason>)| against.is_empty() && looks(*method);
        for (_, against) in parts.methods.iter_mut().filter(applies) {
            against.push(Reason::OutsideDomain(error.to_string()));
        }
    }
    Ok(parts)
}

/// A reason in words.
#[must_use]
pub fn reason_text(reason: &Reason, small: &str) -> String {
    let show = |e: &Expression| shortened(&e.print(small, Style::Text));
    match reason {
        Reason::NotWeaklyNonlinear(e) => {
            format!("{} has no factor {small}, so the equation is not weakly nonlinear", show(e))
        }
        Reason::NoLinearPart => format!("no term k*x stands in the equation without {small}"),
        Reason::NegativeStiffness => "the linear stiffness is negative".into(),
        Reason::IrrationalFrequency => "x' occurs and omega_0 is irrational".into(),
        Reason::UnknownFrequency => "x' occurs and omega_0 has no value".into(),
        Reason::Forced(e) => format!("{} depends on t", show(e)),
        Reason::Resonant(e, (k, m)) => {
            format!("{} is of order zero and in resonance {k}:{m} with the linear part", show(e))
        }
        Reason::Delay(e) => format!("{} is a delay", show(e)),
        Reason::NonSmooth(e) => format!("{} is not smooth", show(e)),
        Reason::NotPolynomial(e) => format!(
            "{} is no polynomial in x, x' and ln x^2 (of f regular at 0, taylor(f(z), 9) asks for one)",
            show(e)
        ),
        Reason::NotReal(e) => format!(
            "{} is not real everywhere: write x*(x^2)^delta, sign(x)*abs(x)^p, ln(x^2)",
            show(e)
        ),
        Reason::Impact => "there is a wall".into(),
        Reason::Drift(e) => {
            format!("{} works on x', so the amplitude drifts", show(e))
        }
        Reason::Condition => "the condition of the problem belongs to another method".into(),
        Reason::Form => format!("the form x*F({small}*ln(x^2)) is needed"),
        Reason::Frequency(e) => format!(
            "{}: forces are cos or sin of multiples of one omega*t by numbers, without a phase",
            show(e)
        ),
        Reason::NoForce => "there is no force".into(),
        Reason::NoSaddle => "no integrable equation with a saddle at order zero".into(),
        Reason::NoSmallParameter => format!("the small parameter {small} does not occur"),
        Reason::Formal(e) => format!("{} is a formal function", show(e)),
        Reason::OutsideDomain(what) => what.clone(),
        _ => "not applicable".into(),
    }
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

/// What a file says for the amplitude to be averaged.
const AVERAGES: &str =
    "averaging takes it: condition = \"free-amplitude\" in the file, or --normalisation free";

/// The path of a file with the place of a term of its equation, or of the equation.
fn place(file: &ProblemFile, path: &str, term: Option<&Expression>) -> String {
    let place = term.and_then(|term| file.locate(term)).or_else(|| file.locate_equation());
    let place = place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"));
    format!("{path}{place}")
}

/// What an equation without a small parameter misses.
#[must_use]
pub fn marks(small: &str) -> String {
    format!("a factor {small} marks the small terms; `simulate` takes it as it is")
}

/// Refuses, before any work, a file whose equation the expansion with the condition asked for does
/// not take, with the term and its place. Free amplitudes and values outside their domain are left to
/// their driver.
///
/// # Errors
/// [`Refused`] with the reason.
pub fn check(
    parts: &Classification,
    file: &ProblemFile,
    condition: Option<Condition>,
    path: &str,
) -> Result<(), Refused> {
    let condition = condition.or(file.problem.conditions.first().copied());
    let against = |method: Method| {
        let listed = parts.methods.iter().filter(move |(m, _)| *m == method);
        let reasons = listed.flat_map(|(_, against)| against);
        reasons.filter(|r| !matches!(r, Reason::Condition | Reason::OutsideDomain(_)))
    };
    let small = &file.problem.small;
    let nothing_small = !file.problem.equation.contains(&Expression::Small);
    let marks = marks(small);
    let refused = |at: String, what: String, hint: String| {
        let message = format!("{at}: {what}");
        Err(Refused::no_answer("no-method", message, hint))
    };
    let Some(reason) = against(Method::LindstedtPoincare).next() else {
        if condition.is_some() {
            return Ok(());
        }
        let (what, hint) = if nothing_small {
            (reason_text(&Reason::NoSmallParameter, small), marks)
        } else {
            let hint = "\"initial-amplitude\", \"limit-cycle\", \"free-amplitude\"";
            ("condition = [] asks for no expansion".to_owned(), hint.to_owned())
        };
        return refused(place(file, path, None), what, hint);
    };
    if condition == Some(Condition::FreeAmplitude) {
        let plain = |r: &&Reason| match r {
            Reason::NoLinearPart | Reason::NotWeaklyNonlinear(_) => nothing_small,
            Reason::Frequency(_) => true,
            _ => false,
        };
        let Some(reason) = against(Method::Averaging).find(plain) else { return Ok(()) };
        let at = place(file, path, reason.term());
        let hint = if nothing_small { marks } else { String::new() };
        return refused(at, reason_text(reason, small), hint);
    }
    let at = match reason {
        // The equation is not to blame.
        Reason::Impact => path.to_owned(),
        _ => place(file, path, reason.term()),
    };
    let averages = || {
        against(Method::Averaging).next().is_none()
            && parts.forcing.iter().all(|force| force.resonance.is_none())
    };
    let in_numbers = matches!(reason, Reason::NonSmooth(_) | Reason::NotPolynomial(_))
        && parts.takes(Method::TimeDomain);
    let hint = if nothing_small && *reason == Reason::NoSmallParameter {
        &*marks
    } else if parts.takes(Method::Melnikov) {
        "Melnikov's method takes equations of this kind: lindstedt threshold FILE"
    } else if *reason == Reason::UnknownFrequency {
        "--set NAME=VALUE gives it one"
    } else if averages() {
        AVERAGES
    } else if in_numbers {
        "in numbers: `lindstedt simulate`, and `derive --tier collocation` for forces of x alone"
    } else if nothing_small {
        &*marks
    } else {
        "`lindstedt problems --show FILE` lists the methods"
    };
    refused(at, reason_text(reason, small), hint.to_owned())
}

/// A refusal of the engine; of the equation of a file with its place. Where no amplitude is constant,
/// or none that is known exactly, averaging is what takes the equation.
#[must_use]
pub fn refusal(error: Error, file: Option<&ProblemFile>, path: &str) -> Error {
    let averages = matches!(&error, Error::Expand(error) if averages(error));
    let no_root = matches!(error, Error::Expand(ExpandError::StiffnessNotSquare));
    let Some(file) = file.filter(|_| error.code() == "no-expansion") else { return error };
    let hint = if averages {
        AVERAGES.to_owned()
    } else if !file.problem.equation.contains(&Expression::Small) {
        marks(&file.problem.small)
    } else if no_root {
        "--set gives all parameters values, that of the force included; or write omega_0^2*x"
            .to_owned()
    } else {
        error.hint()
    };
    let message = format!("{}: {error}", place(file, path, None));
    Refused { code: error.code(), kind: error.kind(), message, hint }.into()
}

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
        let terms = |list: &[lindstedt_equation::classify::Term]| {
            let term = |t: &lindstedt_equation::classify::Term| Described {
                term: show(&t.term),
                order: t.order,
            };
            list.iter().map(term).collect()
        };
        let force = |f: &lindstedt_equation::classify::Forcing| DescribedForce {
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
        _ => "other",
    }
}

fn algebra_name(algebra: Algebra) -> &'static str {
    match algebra {
        Algebra::TrigonometricOverRationals => "trigonometric polynomials over Q",
        Algebra::TrigonometricOverParameters => "trigonometric polynomials over Q[parameters]",
        Algebra::Lobachevsky => "Lobachevsky ring",
        _ => "numeric only",
    }
}
