//! `lindstedt problems`: what is built in.

use crate::Outcome;
use crate::arguments::{Format, ProblemsOptions};
use crate::classification;
use crate::output;
use crate::session::{Loaded, Session, load};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Condition, ParameterCard, Problem};
use lindstedt::problems::stick_slip;
use serde_json::json;
use std::collections::BTreeMap;
use std::fmt::Write;

pub fn run(options: &ProblemsOptions, session: &Session<'_>) -> Outcome {
    if let Some(name) = options.show.as_deref() {
        return show(name, session);
    }
    let mut list = lindstedt::problems::all();
    list.push(stick_slip::problem());
    let text = match session.format() {
        Format::Json => {
            let list: Vec<_> = list.iter().map(as_json).collect();
            format!("{:#}\n", json!({ "problems": list }))
        }
        format => {
            let style = if format == Format::Text { Style::Text } else { Style::Latex };
            list.iter().map(|p| card(p, style)).collect()
        }
    };
    output::write(session, &text)?;
    Ok(0)
}

/// One problem as a problem file, with its classification in comments.
fn show(name: &str, session: &Session<'_>) -> Outcome {
    let loaded = match name {
        _ if name == stick_slip::problem().name => {
            Loaded { problem: stick_slip::problem(), file: None }
        }
        "vibro-impact" => {
            Loaded { problem: lindstedt::problems::vibro_impact::problem(), file: None }
        }
        _ => load(name)?,
    };
    let problem = &loaded.problem;
    let parts = classification::of(problem, &BTreeMap::new());
    let file = match &loaded.file {
        Some(file) => file.to_text(),
        None => lindstedt::problem_file::write(problem),
    };
    let text = match session.format() {
        Format::Text => {
            let lines = match &parts {
                Ok(parts) => classification::text(parts, &problem.small, loaded.file.is_some()),
                Err(error) => format!("{error}\n"),
            };
            let comments: String = lines.lines().map(|line| format!("# {line}\n")).collect();
            format!("{file}\n{comments}")
        }
        Format::Json => {
            let mut json = as_json(problem);
            json["file"] = file.into();
            json["classification"] = match &parts {
                Ok(parts) => classification::as_json(parts, &problem.small),
                Err(error) => json!({ "error": error.to_string() }),
            };
            format!("{:#}\n", json!({ "problems": [json] }))
        }
        Format::Latex | Format::Markdown => card(problem, Style::Latex),
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
        Condition::FreeAmplitude => "free-amplitude",
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
        Condition::FreeAmplitude => {
            "the first harmonic of x is a cos(psi): a and psi drift, corrections have none"
        }
    }
}

fn card(problem: &Problem, style: Style) -> String {
    let mut text = String::new();
    let equation = problem.equation.print(&problem.small, style);
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
    closing(&mut text, &problem.parameters, &problem.notes, &problem.source);
    text
}

fn closing(text: &mut String, parameters: &[ParameterCard], notes: &str, source: &str) {
    for card in parameters {
        let _ = writeln!(text, "  {} = {} by default: {}", card.name, card.default, card.meaning);
    }
    let _ = writeln!(text, "  {notes}\n  source: {source}\n");
}

fn parameters_as_json(parameters: &[ParameterCard]) -> Vec<serde_json::Value> {
    let json = |card: &ParameterCard| json!({"name": card.name, "default": card.default, "meaning": card.meaning});
    parameters.iter().map(json).collect()
}

fn as_json(problem: &Problem) -> serde_json::Value {
    let parameters = parameters_as_json(&problem.parameters);
    let conditions: Vec<_> = problem.conditions.iter().map(|c| condition_name(*c)).collect();
    json!({
        "name": problem.name,
        "title": problem.title,
        "equation": format!("{} = 0", problem.equation.print(&problem.small, Style::Text)),
        "latex": format!("{} = 0", problem.equation.print(&problem.small, Style::Latex)),
        "parameter": problem.small,
        "normalisations": conditions,
        "parameters": parameters,
        "notes": problem.notes,
        "source": problem.source,
    })
}
