//! What an equation is made of, and which methods take it, in words and as JSON.

use lindstedt::ProblemFile;
use lindstedt::equation::classify::{
    Algebra, Classification, ClassifyError, Method, Reason, Symmetry, classify,
};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, Expression, Problem};
use lindstedt::{Value, known_values};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::fmt::Write;

use crate::failure::{Failure, NO_ANSWER};

/// Classifies a problem with the values given and the defaults.
pub fn of(
    problem: &Problem,
    given: &BTreeMap<String, Value>,
) -> Result<Classification, ClassifyError> {
    classify(problem, &known_values(problem, given))
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
        Reason::NoLinearPart => format!("without {small} there is no term in x"),
        Reason::NegativeStiffness => "the linear stiffness is negative".into(),
        Reason::IrrationalFrequency => {
            "x' occurs and omega_0 is irrational or without a value: scale time in the file".into()
        }
        Reason::Forced(e) => format!("{} depends on t", show(e)),
        Reason::Resonant(e, (k, m)) => {
            format!("{} is of order zero and in resonance {k}:{m} with the linear part", show(e))
        }
        Reason::Delay(e) => format!("{} is a delay", show(e)),
        Reason::NonSmooth(e) => format!("{} is not smooth", show(e)),
        Reason::NotPolynomial(e) => format!(
            "{} is no polynomial in x, x' and ln x^2 (taylor(f(z), 9) asks for a polynomial)",
            show(e)
        ),
        Reason::NotReal(e) => format!(
            "{} is not real everywhere: write x*(x^2)^delta, sign(x)*abs(x)^p, ln(x^2)",
            show(e)
        ),
        Reason::Impact => "there is a wall".into(),
        Reason::Drift(e) => {
            format!(
                "{} works on x', so the amplitude drifts (condition = \"limit-cycle\"?)",
                show(e)
            )
        }
        Reason::Condition => "the condition of the problem belongs to another method".into(),
        Reason::Form => format!("the form x*F({small}*ln(x^2)) is needed"),
        Reason::NoSaddle => "no integrable equation with a saddle at order zero".into(),
        Reason::NoSmallParameter => format!("the small parameter {small} does not occur"),
        Reason::Formal(e) => format!("{} is a formal function", show(e)),
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

/// The classification in lines of text.
pub fn text(parts: &Classification, small: &str) -> String {
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

/// Refuses, before any work, a file whose equation the expansion with the condition asked for does
/// not take, with the term and its place. Free amplitudes are left to their driver.
pub fn check(
    parts: &Classification,
    file: &ProblemFile,
    condition: Option<Condition>,
    path: &str,
) -> Result<(), Failure> {
    let condition = condition.or(file.problem.conditions.first().copied());
    let lindstedt = parts.methods.iter().find(|(m, _)| *m == Method::LindstedtPoincare);
    let mut against = lindstedt.into_iter().flat_map(|(_, against)| against);
    let Some(reason) = against.find(|r| !matches!(r, Reason::Condition)) else {
        return Ok(());
    };
    if condition == Some(Condition::FreeAmplitude) {
        return Ok(());
    }
    let place = reason.term().and_then(|term| file.locate(term));
    let place = place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"));
    Err(Failure {
        exit: NO_ANSWER,
        code: "no-method",
        message: format!("{path}{place}: {}", reason_text(reason, &file.problem.small)),
        hint: if parts.takes(Method::Melnikov) {
            "Melnikov's method takes equations of this kind: lindstedt threshold FILE".into()
        } else {
            "`lindstedt problems --show FILE` lists the methods".into()
        },
    })
}
