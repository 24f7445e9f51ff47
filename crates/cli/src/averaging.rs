//! `lindstedt derive` with a free amplitude: the averaged equations of Krylov, Bogoliubov and
//! Mitropolsky.

use crate::Outcome;
use crate::arguments::Format;
use crate::classification::refusal;
use crate::derive::{number_json, say_missing};
use crate::failure::{INTERRUPTED, UNDECIDED};
use crate::output;
use crate::problems::{condition_name, condition_text};
use crate::session::Session;
use lindstedt::averaging::{Averaging, AveragingSettings, Coefficient, RateTerm, average};
use lindstedt::coeff::print::Style;
use lindstedt::coeff::print::{latex_name, power};
use lindstedt::equation::{Condition, Problem, print};
use lindstedt::number::ball::Balls;
use lindstedt::number::complex::Complex;
use lindstedt::{ProblemFile, Progress, Settings, problems};
use lindstedt_impact::convergence::{Convergence, convergence};
use lindstedt_impact::parameters::{Branch, Parameters};
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// Formulas longer than this are counted in the text formats; the JSON format has them all.
const PRINTED_CHARACTERS: usize = 6000;

pub fn run(
    problem: &Problem,
    settings: &Settings,
    digits: usize,
    header: &str,
    session: &Session<'_>,
    file: Option<(&ProblemFile, &str)>,
) -> Outcome {
    let asked = AveragingSettings {
        order: settings.order,
        parameters: settings.parameters.clone(),
        digits,
        stop: settings.stop.clone(),
        memory: settings.memory,
    };
    let mut observer = |progress: Progress| {
        session.say(match progress {
            Progress::Order(n, terms) => format!("order {n} of {}: {terms} terms", asked.order),
            _ => "substituting into the equation".to_owned(),
        });
        session.goes_on()
    };
    let (file, path) = file.map_or((None, ""), |(file, path)| (Some(file), path));
    let result = average(problem, &asked, &mut observer);
    let result = result.map_err(|error| refusal(error, file, path))?;
    session.done();
    let names: &[&str] = match result.is_linear() {
        true => &["growth_rate", "frequency", "solution"],
        // A_n(a)/a and B_n(a).
        false => &["solution", "growth_rate", "frequency"],
    };
    say_missing(file, &|name| names.contains(&name));
    let convergence = series_convergence(&result, settings);
    if let Some(found) = convergence.as_ref().filter(|found| found.diverges()) {
        output::warn(&divergence(found));
    }
    let text = match session.format() {
        Format::Json => {
            let mut json = report(&result, settings, session);
            if let (Some(map), Some(found)) = (json.as_object_mut(), &convergence) {
                map.insert("convergence".to_owned(), convergence_json(found));
            }
            format!("{json:#}\n")
        }
        Format::Text => {
            header.to_owned()
                + &Board { result: &result, style: Style::Text, markdown: false }.write()
        }
        Format::Latex => Board { result: &result, style: Style::Latex, markdown: false }.write(),
        Format::Markdown => Board { result: &result, style: Style::Latex, markdown: true }.write(),
    };
    output::write(session, &text)?;
    if result.order < asked.order || result.checked_orders < result.order {
        let reason = if session.interrupted() { "interrupted" } else { "time limit" };
        let checked =
            if result.checked_orders == result.order { "and checked" } else { "but not checked" };
        output::warn(&format!("{reason}: orders 0 to {} are finished {checked}", result.order));
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    Ok(0)
}

fn coefficient_json(coefficient: &Coefficient) -> Json {
    match coefficient {
        Coefficient::Number(number) => number_json(number),
        Coefficient::Formula { text, .. } => {
            json!({"exact": text, "decimal": null, "error": null, "status": "exact"})
        }
    }
}

/// The radius of the averaged series of the impact oscillator, when every parameter has a value
/// (the numbers are then no formulas).
fn series_convergence(result: &Averaging, settings: &Settings) -> Option<Convergence> {
    if result.problem.name != problems::vibro_impact::problem().name || !result.is_linear() {
        return None;
    }
    let numbers = |rates: &[Vec<RateTerm>]| -> Option<Vec<f64>> {
        let value = |rate: &Vec<RateTerm>| match rate.first().map(|term| &term.coefficient) {
            None => Some(0.0),
            Some(Coefficient::Number(number)) => number.decimal.parse().ok(),
            Some(Coefficient::Formula { .. }) => None,
        };
        rates.iter().map(value).collect()
    };
    let (growth, frequency) = (numbers(&result.amplitude_rate)?, numbers(&result.phase_rate)?);
    let terms: Vec<_> =
        growth.into_iter().zip(frequency).map(|(r, w)| Complex::new(r, w)).collect();
    let value =
        |name: &str| Some(settings.parameters.get(name)?.ball(Balls::new(64)).midpoint().to_f64());
    let parameters = Parameters {
        alpha: value("alpha")?,
        omega: value("omega")?,
        periods: settings.parameters.get("k")?.as_rational()?.numer().to_u32()?,
        damping: value("c")?,
        displacement_gain: value("A")?,
        velocity_gain: value("B")?,
        // The flight between the impacts knows nothing of the following.
        restitution: 1.0,
        wall: 0.0,
        force: 1.0,
        branch: Branch::Plus,
    };
    parameters.validate().ok()?;
    Some(convergence(&parameters, &terms))
}

pub fn convergence_json(found: &Convergence) -> Json {
    let finite = |x: f64| match x {
        x if x.is_finite() => json!(x),
        x if x.is_nan() => Json::Null,
        x => json!(x.to_string()),
    };
    json!({
        "radius": finite(found.radius),
        "ratio": finite(found.ratio),
        "diverges": found.diverges(),
        "status": "estimated",
    })
}

pub fn divergence(found: &Convergence) -> String {
    let radius = match found.radius {
        radius if radius < 1e-3 => format!("{radius:.1e}"),
        radius => format!("{radius:.3}"),
    };
    format!("the averaged series diverges at eps = 1: its radius of convergence is about {radius}")
}

/// A linear problem has numbers, growth_rate and frequency; otherwise the rates are polynomials in
/// the amplitude.
fn report(result: &Averaging, settings: &Settings, session: &Session<'_>) -> Json {
    let zero = || json!({"exact": "0", "decimal": "0", "error": null, "status": "exact"});
    let numbers = |rates: &[Vec<RateTerm>]| -> Json {
        let value = |rate: &Vec<RateTerm>| {
            rate.first().map_or_else(zero, |term| coefficient_json(&term.coefficient))
        };
        rates.iter().map(value).collect()
    };
    let polynomials = |rates: &[Vec<RateTerm>]| -> Json {
        let term = |term: &RateTerm| json!({"power": term.exponent, "coefficient": coefficient_json(&term.coefficient)});
        rates.iter().map(|rate| rate.iter().map(term).collect::<Json>()).collect()
    };
    let (a, b) = (&result.amplitude_rate, &result.phase_rate);
    let series = if result.is_linear() {
        json!({"growth_rate": numbers(a), "frequency": numbers(b)})
    } else {
        json!({"amplitude_rate": polynomials(a), "phase_rate": polynomials(b)})
    };
    let at: serde_json::Map<String, Json> =
        settings.parameters.iter().map(|(n, v)| (n.clone(), Json::from(v.to_string()))).collect();
    let problem = &result.problem;
    json!({
        "problem": problem.name,
        "equation": format!("{} = 0", problem.equation.print(&problem.small, print::Style::Text)),
        "parameter": problem.small,
        "at": at,
        "order": result.order,
        "tier": if result.exact { "exact" } else { "certified" },
        "normalisation": condition_name(Condition::FreeAmplitude),
        "series": series,
        "solution": result.solution.iter().map(|[text, _]| text).collect::<Vec<_>>(),
        "terms": result.terms,
        "residual": {
            "checked_orders": result.checked_orders,
            "zero": result.exact.then_some(true),
            "encloses_zero": !result.exact,
        },
        "method": {"name": "averaging (Krylov, Bogoliubov, Mitropolsky)"},
        "seconds": session.elapsed().as_secs_f64(),
    })
}

struct Board<'a> {
    result: &'a Averaging,
    style: Style,
    markdown: bool,
}

impl Board<'_> {
    fn formula(&self, text: &str) -> String {
        match (self.style, self.markdown) {
            (Style::Text, _) => format!("  {text}\n"),
            (Style::Latex, false) => format!("\\[ {text} \\]\n"),
            (Style::Latex, true) => format!("$$ {text} $$\n"),
        }
    }

    fn write(&self) -> String {
        let (result, problem) = (self.result, &self.result.problem);
        let style = match self.style {
            Style::Text => print::Style::Text,
            Style::Latex => print::Style::Latex,
        };
        let mut text = match (self.style, self.markdown) {
            (Style::Text, _) => format!("{}: {}\n", problem.name, problem.title),
            (Style::Latex, false) => {
                format!("\\paragraph*{{{}: {}}}\n", problem.name, problem.title)
            }
            (Style::Latex, true) => format!("### {}: {}\n", problem.name, problem.title),
        };
        text += &self.formula(&format!("{} = 0", problem.equation.print(&problem.small, style)));
        let small = match self.style {
            Style::Text => problem.small.to_string(),
            Style::Latex => latex_name(&problem.small),
        };
        text += &self.formula(&match self.style {
            Style::Text => format!("x = u_0 + u_1*{small} + ...   a' = A_1(a)*{small} + A_2(a)*{small}^2 + ...   psi' = B_0 + B_1(a)*{small} + ..."),
            Style::Latex => format!("x = u_0 + u_1\\,{small} + \\dots,\\quad \\dot a = A_1(a)\\,{small} + A_2(a)\\,{small}^2 + \\dots,\\quad \\dot\\psi = B_0 + B_1(a)\\,{small} + \\dots"),
        });
        let _ = writeln!(text, "Normalisation: {}.\n", condition_text(Condition::FreeAmplitude));
        for n in 0..=result.order {
            let position = usize::from(self.style == Style::Latex);
            let solution = result.solution.get(n).map_or("0", |pair| pair[position].as_str());
            let index = match self.style {
                Style::Text => format!("u_{n}"),
                Style::Latex => format!("u_{{{n}}}"),
            };
            text += &self.formula(&format!("{index} = {}", self.shortened(solution.to_owned())));
            for (name, rates) in [("A", &result.amplitude_rate), ("B", &result.phase_rate)] {
                if n == 0 && name == "A" {
                    continue;
                }
                let index = match self.style {
                    Style::Text => format!("{name}_{n}"),
                    Style::Latex => format!("{name}_{{{n}}}"),
                };
                let rate = self.rate(rates.get(n).map_or(&[], Vec::as_slice));
                text += &self.formula(&format!("{index} = {rate}"));
            }
        }
        let _ = if result.exact {
            writeln!(
                text,
                "\nResidual: the expansion substituted into the equation vanishes identically at orders 0 to {}.",
                result.checked_orders
            )
        } else {
            writeln!(
                text,
                "\nResidual: the expansion substituted into the equation encloses zero at orders 0 to {};\n{}.",
                result.checked_orders,
                if result.checked_orders < result.order {
                    "the orders above were not checked"
                } else {
                    "all digits printed are certain"
                }
            )
        };
        text
    }

    fn rate(&self, terms: &[RateTerm]) -> String {
        let mut line = String::new();
        for term in terms {
            let coefficient = match &term.coefficient {
                Coefficient::Number(number) => {
                    number.exact.clone().unwrap_or_else(|| number.decimal.clone())
                }
                Coefficient::Formula { text, latex } => match self.style {
                    Style::Text => text.clone(),
                    Style::Latex => latex.clone(),
                },
            };
            let is_sum = coefficient.trim_start_matches('-').contains([' ']);
            let name = (term.exponent != 0).then(|| power("a", term.exponent.into(), self.style));
            let (negative, magnitude) = match coefficient.strip_prefix('-') {
                Some(rest) if !is_sum => (true, rest.to_owned()),
                _ => (false, coefficient),
            };
            line += match (line.is_empty(), negative) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            let times = if self.style == Style::Text { "*" } else { "\\," };
            line += &match (name, is_sum) {
                (None, _) => magnitude,
                (Some(name), _) if magnitude == "1" => name,
                (Some(name), true) => format!("{name}{times}({magnitude})"),
                (Some(name), false) => format!("{magnitude}{times}{name}"),
            };
        }
        if line.is_empty() {
            return "0".to_owned();
        }
        self.shortened(line)
    }

    fn shortened(&self, line: String) -> String {
        let count = line.len();
        match self.style {
            _ if count <= PRINTED_CHARACTERS => line,
            Style::Text => format!("[{count} characters; in full with --format json]"),
            Style::Latex => format!("\\text{{[{count} characters; in full with --format json]}}"),
        }
    }
}
