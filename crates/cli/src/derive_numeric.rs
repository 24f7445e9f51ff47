//! `lindstedt derive --tier collocation|fourier`: coefficients with estimated errors.

use crate::Outcome;
use crate::arguments::{DeriveOptions, Format, Route, TierName};
use crate::classification::refusal;
use crate::derive::number_json;
use crate::failure::{Failure, UNDECIDED};
use crate::output;
use crate::problems::{condition_name, condition_text};
use crate::session::Session;
use lindstedt::equation::{Problem, print};
use lindstedt::expand::ExpandError;
use lindstedt::numeric::{self, Estimate, Tier};
use lindstedt::{Error, ProblemFile, Settings};
use serde_json::{Value as Json, json};
use std::fmt::Write;

pub fn run(
    options: &DeriveOptions,
    (problem, file): (&Problem, Option<&ProblemFile>),
    settings: &Settings,
    digits: usize,
    session: &Session<'_>,
) -> Outcome {
    if options.route == Route::Energy {
        let message = "the energy integral is exact: --route energy has no other tier".to_owned();
        return Err(Failure::usage("route-and-tier", message, "drop --route or --tier"));
    }
    let tier = match options.tier {
        TierName::Fourier => Tier::Fourier { harmonics: options.harmonics as usize },
        _ if options.precision.f64 => Tier::Doubles,
        _ => Tier::Collocation { digits: u32::try_from(digits).unwrap_or(u32::MAX) },
    };
    let mut observer = |work: &lindstedt::expand::OrderWork| {
        session.say(format!("order {} of {}", work.order, settings.order));
        session.goes_on()
    };
    let result = numeric::derive(problem, settings, tier, &mut observer);
    let result = result.map_err(|error| match error {
        Error::Expand(ExpandError::Interrupted { .. }) if !session.interrupted() => Failure {
            exit: UNDECIDED,
            code: "limit-seconds",
            message: "the time limit was reached before two grids were finished".to_owned(),
            hint: "raise --limit-seconds or lower --order or --digits".to_owned(),
        },
        other => refusal(other, file, &options.problem).into(),
    })?;
    session.done();
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report(problem, settings, &result, digits, session)),
        Format::Markdown => table(problem, &result, digits, "### ", "\n"),
        Format::Text => table(problem, &result, digits, "", ""),
        Format::Latex => format!(
            "\\begin{{verbatim}}\n{}\\end{{verbatim}}\n",
            table(problem, &result, digits, "", "")
        ),
    };
    output::write(session, &text)?;
    Ok(0)
}

/// The name in the JSON contract.
fn tier_name(tier: Tier) -> &'static str {
    if matches!(tier, Tier::Fourier { .. }) { "fourier" } else { "collocation" }
}

fn report(
    problem: &Problem,
    settings: &Settings,
    result: &Estimate,
    digits: usize,
    session: &Session<'_>,
) -> Json {
    let mut series = serde_json::Map::new();
    for named in &result.series {
        let numbers = (0..named.coefficients.len()).map(|n| named.number(n, digits));
        let list = numbers.map(|found| found.map_or(Json::Null, |n| number_json(&n))).collect();
        series.insert(named.name.to_owned(), list);
    }
    let at: serde_json::Map<String, Json> =
        settings.parameters.iter().map(|(k, v)| (k.clone(), json!(v.to_string()))).collect();
    let equation = problem.equation.print(&problem.small, print::Style::Text);
    json!({
        "problem": problem.name,
        "equation": format!("{equation} = 0"),
        "parameter": problem.small,
        "at": at,
        "order": result.order,
        "tier": tier_name(result.tier),
        "normalisation": condition_name(result.condition),
        "series": series,
        "solution": [],
        "residual": {"checked_orders": null, "zero": null},
        "method": {
            "name": "the same recursion on two grids",
            "nodes": result.nodes,
            "bits": result.bits,
            "products": result.products,
        },
        "seconds": session.elapsed().as_secs_f64(),
    })
}

fn table(problem: &Problem, result: &Estimate, digits: usize, heading: &str, gap: &str) -> String {
    let mut text = format!("{heading}{}: {}\n{gap}", problem.name, problem.title);
    let equation = problem.equation.print(&problem.small, print::Style::Text);
    let _ = writeln!(text, "  {equation} = 0");
    let _ = writeln!(text, "Normalisation: {}.", condition_text(result.condition));
    let _ = writeln!(
        text,
        "Estimated numbers ({} nodes, {} bits): the error is four times the difference of two \
         grids.",
        result.nodes, result.bits
    );
    for named in &result.series {
        let name = named.name.replace('_', " ");
        let _ = writeln!(text, "{gap}{name} in powers of {}:{gap}", problem.small);
        for n in 0..named.coefficients.len() {
            let Some(number) = named.number(n, digits) else {
                let _ = writeln!(text, "  {n}: not one digit");
                continue;
            };
            let error = number.error.as_deref().unwrap_or("0");
            let _ = writeln!(text, "  {n}: {}  (+- {error})", number.decimal);
        }
    }
    text
}
