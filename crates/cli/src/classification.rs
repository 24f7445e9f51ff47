//! What an equation is made of, and which methods take it, in words and as JSON.

use lindstedt::ProblemFile;
use lindstedt::equation::classify::{
    Algebra, Classification, ClassifyError, Method, Reason, Symmetry, classify,
};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, Expression, Problem};
use lindstedt::expand::ExpandError;
use lindstedt::{Error, Exact, check_parameters, known_values};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::fmt::Write;

use crate::arguments::Normalisation;
use crate::failure::{Failure, NO_ANSWER};
use crate::problems::condition_name;
use crate::session::Loaded;

/// Classifies a problem with the values given and the defaults. A value outside its domain is against
/// every method that looks at it: Melnikov's looks at no amplitude, averaging asks for another start.
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

/// A reason in words.
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

fn shortened(text: &str) -> String {
    let mut shown: String = text.chars().take(60).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown
}

/// The classification in lines of text, of the equation of a file or of a built-in problem.
pub fn text(parts: &Classification, small: &str, is_file: bool) -> String {
    let show = |e: &Expression| shortened(&e.print(small, Style::Text));
    let mut text = String::new();
    let mut line = |name: &str, what: String| {
        let _ = writeln!(text, "{name:<20}{what}");
    };
    let zero = Expression::integer(0);
    line(
        "linear part",
        if parts.stiffness == zero {
            "none".into()
        } else {
            // As a product with x in a sum: signs and parentheses come out as in an equation.
            let force = parts.stiffness.clone() * Expression::Displacement;
            let linear = (Expression::Acceleration + force).canonical();
            format!("{}, frequency omega_0 = {}", show(&linear), show(&parts.frequency))
        },
    );
    for term in parts.strong.iter().take(20) {
        line("strong term", show(&term.term));
    }
    for term in parts.weak.iter().take(40) {
        let order = if term.order == 0 {
            format!("{small} inside, every order from 0")
        } else {
            format!("order {} in {small}", term.order)
        };
        line("weak term", format!("{}  ({order})", show(&term.term)));
    }
    if parts.weak.len() > 40 {
        line("weak term", format!("... {} in all", parts.weak.len()));
    }
    for forcing in &parts.forcing {
        let kind = if forcing.parametric { "parametric, " } else { "" };
        let frequency = match &forcing.frequency {
            Some(frequency) => format!("frequency {}", show(frequency)),
            None => "not harmonic".into(),
        };
        let resonance = match forcing.resonance {
            Some((k, m)) => format!(", in resonance {k}:{m} with omega_0"),
            None => String::new(),
        };
        let order = forcing.order;
        line(
            "forcing",
            format!("{}  ({kind}order {order}, {frequency}{resonance})", show(&forcing.term)),
        );
    }
    for delay in &parts.delays {
        line("delay", show(delay));
    }
    for e in &parts.non_smooth {
        line("non-smooth", show(e));
    }
    if parts.impact {
        line("impact", "a rigid wall".into());
    }
    let symmetry = match parts.symmetry {
        Symmetry::Odd if !parts.forcing.is_empty() => "odd under x -> -x, the forcing apart",
        Symmetry::Odd => "odd under x -> -x: odd harmonics only",
        Symmetry::None => "none: harmonics of both parities",
    };
    line(
        "symmetry",
        format!("{symmetry}{}", if parts.reversible { "; reversible in time" } else { "" }),
    );
    line("algebra", algebra_name(parts.algebra).into());
    for (method, against) in &parts.methods {
        let verdict = match &against[..] {
            [] => "applies".to_owned(),
            [Reason::Condition] if *method == Method::Averaging && is_file => {
                "applies with --normalisation free".to_owned()
            }
            reasons => {
                let reasons: Vec<String> = reasons.iter().map(|r| reason_text(r, small)).collect();
                format!("no: {}", reasons.join("; "))
            }
        };
        line(method_name(*method), verdict);
    }
    text
}

/// The classification as JSON.
pub fn as_json(parts: &Classification, small: &str) -> Json {
    let show = |e: &Expression| e.print(small, Style::Text);
    let terms = |list: &[lindstedt::equation::classify::Term]| -> Vec<Json> {
        list.iter().map(|t| json!({"term": show(&t.term), "order": t.order})).collect()
    };
    let forcing: Vec<Json> = parts
        .forcing
        .iter()
        .map(|f| {
            json!({
                "term": show(&f.term),
                "order": f.order,
                "frequency": f.frequency.as_ref().map(show),
                "parametric": f.parametric,
                "resonance": f.resonance.map(|(k, m)| format!("{k}:{m}")),
            })
        })
        .collect();
    let methods: Vec<Json> = parts
        .methods
        .iter()
        .map(|(method, against)| {
            let reasons: Vec<String> = against.iter().map(|r| reason_text(r, small)).collect();
            json!({"method": method_name(*method), "applies": against.is_empty(), "against": reasons})
        })
        .collect();
    json!({
        "stiffness": show(&parts.stiffness),
        "frequency": show(&parts.frequency),
        "strong": terms(&parts.strong),
        "weak": terms(&parts.weak),
        "forcing": forcing,
        "delays": parts.delays.iter().map(show).collect::<Vec<_>>(),
        "non_smooth": parts.non_smooth.iter().map(show).collect::<Vec<_>>(),
        "impact": parts.impact,
        "odd": parts.symmetry == Symmetry::Odd,
        "reversible": parts.reversible,
        "algebra": algebra_name(parts.algebra),
        "methods": methods,
    })
}

/// The condition asked for. Averaging needs nothing of a file that was written for a constant amplitude,
/// so a free one need not be listed; what an amplitude is under the other conditions only the file can
/// say.
pub fn condition(
    asked: Option<Normalisation>,
    loaded: &mut Loaded,
    path: &str,
) -> Result<Option<Condition>, Failure> {
    let condition = asked.map(|normalisation| match normalisation {
        Normalisation::Initial => Condition::InitialAmplitude,
        Normalisation::Fundamental => Condition::FundamentalAmplitude,
        Normalisation::Free => Condition::FreeAmplitude,
    });
    let conditions = &mut loaded.problem.conditions;
    match condition.filter(|asked| loaded.file.is_some() && !conditions.contains(asked)) {
        None => Ok(condition),
        Some(Condition::FreeAmplitude) => {
            conditions.push(Condition::FreeAmplitude);
            Ok(condition)
        }
        Some(other) => {
            let line = format!("condition = \"{}\" in the file asks for it", condition_name(other));
            let message = format!("{path} does not offer this normalisation");
            Err(Failure::usage("unknown-normalisation", message, &line))
        }
    }
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
pub fn marks(small: &str) -> String {
    format!("a factor {small} marks the small terms; `simulate` takes it as it is")
}

/// Refuses, before any work, a file whose equation the expansion with the condition asked for does
/// not take, with the term and its place. Free amplitudes and values outside their domain are left to
/// their driver.
pub fn check(
    parts: &Classification,
    file: &ProblemFile,
    condition: Option<Condition>,
    path: &str,
) -> Result<(), Failure> {
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
        Err(Failure { exit: NO_ANSWER, code: "no-method", message, hint })
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
pub fn refusal(error: Error, file: Option<&ProblemFile>, path: &str) -> Failure {
    let averages = matches!(
        error,
        Error::Expand(
            ExpandError::AmplitudeDrifts { .. }
                | ExpandError::NoLimitCycle
                | ExpandError::AmplitudeOfHigherOrder
                | ExpandError::IrrationalAmplitude
                | ExpandError::SeveralLimitCycles { .. }
                | ExpandError::DegenerateLimitCycle
        )
    );
    let no_root = matches!(error, Error::Expand(ExpandError::StiffnessNotSquare));
    let mut failure = Failure::from(error);
    if let (Some(file), "no-expansion") = (file, failure.code) {
        failure.message = format!("{}: {}", place(file, path, None), failure.message);
        if averages {
            failure.hint = AVERAGES.to_owned();
        } else if !file.problem.equation.contains(&Expression::Small) {
            failure.hint = marks(&file.problem.small);
        } else if no_root {
            failure.hint = "--set gives all parameters values, that of the force included; or write omega_0^2*x".to_owned();
        }
    }
    failure
}
