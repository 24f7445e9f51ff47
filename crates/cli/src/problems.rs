//! `lindstedt problems`: what is built in.

use crate::Outcome;
use crate::arguments::{Format, ProblemsOptions};
use crate::output;
use crate::session::{Session, problem};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, Problem};
use serde_json::json;
use std::fmt::Write;

pub fn run(options: &ProblemsOptions, session: &Session<'_>) -> Outcome {
    let list = match &options.show {
        Some(name) => vec![problem(name)?],
        None => lindstedt::problems::all(),
    };
    let text = match session.format() {
        Format::Json => {
            let list: Vec<_> = list.iter().map(as_json).collect();
            format!("{:#}\n", json!({ "problems": list }))
        }
        Format::Text => list.iter().map(|p| card(p, Style::Text)).collect(),
        Format::Latex | Format::Markdown => list.iter().map(|p| card(p, Style::Latex)).collect(),
    };
    output::write(session, &text)?;
    Ok(0)
}

/// The name of a condition in results.
pub fn condition_name(condition: Condition) -> &'static str {
    match condition {
        Condition::InitialAmplitude => "initial-amplitude",
        Condition::FundamentalAmplitude => "fundamental-amplitude",
        Condition::LimitCycle => "limit-cycle",
    }
}

/// A condition in words.
pub fn condition_text(condition: Condition) -> &'static str {
    match condition {
        Condition::InitialAmplitude => "x(0) = 1, x'(0) = 0: corrections start at rest at zero",
        Condition::FundamentalAmplitude => {
            "the first harmonic of x is cos(tau): corrections have no first harmonic"
        }
        Condition::LimitCycle => "x'(0) = 0; the amplitude x(0) is determined order by order",
    }
}

fn card(problem: &Problem, style: Style) -> String {
    let mut text = String::new();
    let equation = problem.equation.print(problem.small, style);
    let equation = match style {
        Style::Text => format!("{equation} = 0"),
        Style::Latex => format!("$${equation} = 0$$"),
    };
    let _ = writeln!(text, "{}\n  {}\n  {equation}", problem.name, problem.title);
    let _ = writeln!(text, "  small parameter {}", problem.small);
    for condition in &problem.conditions {
        let name = condition_name(*condition);
        let _ = writeln!(text, "  normalisation {name}: {}", condition_text(*condition));
    }
    for card in &problem.parameters {
        let _ = writeln!(text, "  {} = {} by default: {}", card.name, card.default, card.meaning);
    }
    let _ = writeln!(text, "  {}\n  source: {}\n", problem.notes, problem.source);
    text
}

fn as_json(problem: &Problem) -> serde_json::Value {
    let parameters: Vec<_> = problem
        .parameters
        .iter()
        .map(|card| json!({"name": card.name, "default": card.default, "meaning": card.meaning}))
        .collect();
    let conditions: Vec<_> = problem.conditions.iter().map(|c| condition_name(*c)).collect();
    json!({
        "name": problem.name,
        "title": problem.title,
        "equation": format!("{} = 0", problem.equation.print(problem.small, Style::Text)),
        "latex": format!("{} = 0", problem.equation.print(problem.small, Style::Latex)),
        "parameter": problem.small,
        "normalisations": conditions,
        "parameters": parameters,
        "notes": problem.notes,
        "source": problem.source,
    })
}
