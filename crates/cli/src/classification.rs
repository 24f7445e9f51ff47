//! What an equation is made of, and which methods take it, in words and as JSON.

pub use lindstedt::classification::{check, of, reason_text, refusal, shortened};
use lindstedt::equation::classify::{Algebra, Classification, Method, Reason, Symmetry};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, Expression};
use serde_json::{Value as Json, json};
use std::fmt::Write;

use crate::arguments::Normalisation;
use crate::failure::Failure;
use crate::problems::condition_name;
use crate::session::Loaded;

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
            let force = parts.stiffness.clone() * Expression::DISPLACEMENT;
            let linear = (Expression::ACCELERATION + force).canonical();
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
