//! `lindstedt verify`: the expansion against the time domain.

use crate::Outcome;
use crate::arguments::{Format, VerifyOptions};
use crate::classification::{self, refusal};
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::output;
use crate::problems::condition_name;
use crate::session::{Loaded, Session, load, parameters};
use crate::simulate::plot;
use crate::start::{self, Taken};
use lindstedt::equation::{AmplitudeRole, Condition, Problem};
use lindstedt::expand::ExpandError;
use lindstedt::verify::{Comparison, TOLERANCE, Verdict, Verification, VerifySettings, verify};
use lindstedt::{Error, Exact, Progress};
use plotters::prelude::*;
use rug::{Float, Rational};
use serde_json::{Value as Json, json};
use std::fmt::Write;

pub fn run(options: &VerifyOptions, session: &Session<'_>) -> Outcome {
    let mut loaded = load(&options.problem)?;
    loaded.without_pi(&options.problem)?;
    let condition =
        classification::condition(options.normalisation, &mut loaded, &options.problem)?;
    let Loaded { problem, file } = loaded;
    let parameters = parameters(&options.set)?;
    if let Some(name) = parameters.keys().find(|name| !is_free(&problem, condition, name)) {
        if *name == problem.small || problem.parameters.iter().any(|card| card.name == **name) {
            let message = format!("{name} is not free here: {} is varied", problem.small);
            return Err(Failure::usage("parameter", message, "--small V1,V2,..."));
        }
        let message = format!("{} has no parameter {name:?}", problem.name);
        let free = problem.parameters.iter().map(|card| &*card.name);
        let free: Vec<&str> = free.filter(|name| is_free(&problem, condition, name)).collect();
        let hint = match free.as_slice() {
            [] => {
                format!("it has none that is free; {} is varied: --small V1,V2,...", problem.small)
            }
            list => format!("free are {}", list.join(", ")),
        };
        return Err(Failure::usage("unknown-parameter", message, &hint));
    }
    // The equation of a file is looked at before any work starts.
    if let Some(file) = &file
        && let Ok(parts) = classification::of(&problem, &parameters)
    {
        classification::check(&parts, file, condition, &options.problem)?;
    }
    if condition.is_none() && problem.conditions.is_empty() {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-expansion",
            message: format!("{} has no expansion that could be verified", problem.name),
            hint: "`simulate` takes it, `problems --show` lists the methods".into(),
        });
    }
    plot::check(&options.plot)?;
    let settings = VerifySettings {
        order: options.order as usize,
        condition,
        small: small(&options.small)?,
        periods: options.periods,
        digits: options.digits,
        parameters,
        memory: session.memory(),
        ..VerifySettings::default()
    };
    output::check_writable(session)?;
    let found = verify(&problem, &settings, &mut |progress| {
        match progress {
            Progress::Order(order, _) => session.say(format!("order {order}")),
            Progress::Integrating(n) => {
                session.say(format!("{n} of {} values compared", settings.small.len()));
            }
            _ => {}
        }
        session.goes_on()
    });
    let stopped = |what: String| {
        let (exit, code) = if session.interrupted() {
            (INTERRUPTED, "interrupted")
        } else {
            (UNDECIDED, "limit-seconds")
        };
        let hint = "raise --limit-seconds, or shorten --periods".to_owned();
        Err(Failure { exit, code, message: what, hint })
    };
    let found = match found {
        Err(Error::Expand(ExpandError::Interrupted { .. })) => {
            return stopped("stopped before the comparison was finished".to_owned());
        }
        found => found.map_err(|error| refusal(error, file.as_ref(), &options.problem))?,
    };
    session.done();
    let drifts_or_given = [Condition::InitialAmplitude, Condition::FreeAmplitude];
    if drifts_or_given.contains(&found.condition) {
        start::compare(&problem, file.as_ref(), &settings.parameters, Taken::Amplitude);
    }
    if found.order < settings.order {
        return stopped(format!("stopped after order {} of the expansion", found.order));
    }
    let report = Report { problem: &problem.name, settings: &settings, found: &found };
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report.json(session)),
        Format::Text => report.text(),
        Format::Latex => report.latex(),
        Format::Markdown => report.markdown(),
    };
    for path in &options.plot {
        plot::write(path, || Ok(report.csv()), || report.figure())?;
    }
    output::write(session, &text)?;
    Ok(match found.verdict {
        Verdict::Agrees => 0,
        Verdict::Disagrees => NO_ANSWER,
        Verdict::Undecided => UNDECIDED,
    })
}

/// Whether a parameter can be set: the equation mentions it, or it is the amplitude of the
/// solution; the small parameter and what is part of it are varied.
fn is_free(problem: &Problem, condition: Option<Condition>, name: &str) -> bool {
    if name == "amplitude" {
        let condition = condition.or(problem.conditions.first().copied());
        return condition == Some(Condition::FreeAmplitude)
            || matches!(
                problem.amplitude,
                AmplitudeRole::InSums
                    | AmplitudeRole::Scaled
                    | AmplitudeRole::ScalesFrequency { .. }
            );
    }
    let is_card = problem.parameters.iter().any(|card| card.name == *name);
    let mentioned = problem.equation.parameters().iter().any(|known| known == name);
    let tied = problem.synchronous.as_ref().is_some_and(|tie| tie.periods == *name);
    let determined = problem.synchronous.as_ref().is_some_and(|tie| tie.delay == *name);
    is_card && name != problem.small && (mentioned || tied) && !determined
}

fn small(text: &str) -> Result<Vec<Rational>, Failure> {
    let mut list: Vec<Rational> = Vec::new();
    for part in text.split(',') {
        let value = Exact::parse(part)?;
        let wrong = |message: String| Err(Failure::usage("small", message, "1/100,1/200,1/400"));
        let Some(q) = value.as_rational().filter(|q| !q.is_zero()) else {
            return wrong(format!("{part:?} is no rational number other than zero"));
        };
        if list.last().is_some_and(|last| q.cmp_abs(last).is_ge()) {
            return wrong(format!("{part} is not smaller than the value before"));
        }
        list.push(q.clone());
    }
    if list.len() < 2 || list.len() > 100 {
        return Err(Failure::usage("small", "2 to 100 values are needed".into(), "1/100,1/200"));
    }
    Ok(list)
}

struct Report<'a> {
    problem: &'a str,
    settings: &'a VerifySettings,
    found: &'a Verification,
}

/// The nearest double (`to_f64` cuts off), as short as it can be written.
fn rounded(q: &Rational) -> String {
    format!("{:e}", Float::with_val(53, q).to_f64())
}

fn short(x: &Float) -> String {
    x.to_string_radix(10, Some(6))
}

impl Report<'_> {
    fn verdict(&self) -> String {
        let expected = self.found.order + 1;
        match (self.found.verdict, self.found.observed) {
            (Verdict::Agrees, Some(slope)) if slope > expected as f64 + TOLERANCE => format!(
                "agrees: observed order {slope:.4}, expected at least {expected}: the terms left out begin later"
            ),
            (Verdict::Agrees, Some(slope)) => {
                format!("agrees: observed order {slope:.4}, expected {expected}")
            }
            (Verdict::Disagrees, Some(slope)) => {
                format!(
                    "disagrees: observed order {slope:.4}, expected {expected} within {TOLERANCE}"
                )
            }
            (Verdict::Undecided, Some(_)) if self.found.resolved && !self.found.small_enough => {
                "undecided: the difference is as large as the motion; smaller --small".to_owned()
            }
            (Verdict::Undecided, Some(slope)) if self.found.resolved => format!(
                "undecided: observed order {slope:.4} has not settled, expected {expected}; smaller --small{}",
                if self.found.comparisons.len() < 3 { ", at least three of them" } else { "" }
            ),
            _ => "undecided: the error of the integration is not small against the difference; \
                  more --digits or larger --small"
                .to_owned(),
        }
    }

    fn word(&self) -> &'static str {
        match self.found.verdict {
            Verdict::Agrees => "agrees",
            Verdict::Disagrees => "disagrees",
            Verdict::Undecided => "undecided",
        }
    }

    fn json(&self, session: &Session<'_>) -> Json {
        let row = |c: &Comparison| {
            json!({
                "small": {"exact": c.small.to_string(), "decimal": rounded(&c.small),
                          "error": null, "status": "exact"},
                "difference": {"exact": null, "decimal": short(&c.error),
                               "error": short(&c.simulation_error), "status": "estimated"},
                "slope": c.slope,
            })
        };
        let at: serde_json::Map<_, _> = self
            .settings
            .parameters
            .iter()
            .map(|(n, v)| (n.clone(), v.to_string().into()))
            .collect();
        json!({
            "problem": self.problem,
            "parameter": self.found.parameter,
            "at": at,
            "order": self.found.order,
            "digits": self.found.digits,
            "normalisation": condition_name(self.found.condition),
            "periods": self.settings.periods,
            "table": self.found.comparisons.iter().map(row).collect::<Vec<_>>(),
            "observed_order": self.found.observed,
            "expected_order": self.found.order + 1,
            "settled": self.found.settled,
            "tolerance": TOLERANCE,
            "verdict": self.word(),
            "reason": self.verdict(),
            "seconds": session.elapsed().as_secs_f64(),
        })
    }

    /// Small parameter, difference, error of the integration, slope.
    fn rows(&self) -> Vec<[String; 4]> {
        let slope = |c: &Comparison| c.slope.map(|s| format!("{s:.4}")).unwrap_or_default();
        let row = |c: &Comparison| {
            [c.small.to_string(), short(&c.error), short(&c.simulation_error), slope(c)]
        };
        self.found.comparisons.iter().map(row).collect()
    }

    fn heading(&self) -> [String; 4] {
        let name = self.found.parameter.clone();
        [name, "max |x_N - x|".into(), "integration".into(), "local order".into()]
    }

    fn title(&self) -> String {
        let Self { problem, found, settings } = self;
        format!(
            "{problem}: order {}, {} periods, integration with {} digits",
            found.order, settings.periods, found.digits
        )
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n\n", self.title());
        for [small, error, noise, slope] in [self.heading()].into_iter().chain(self.rows()) {
            let line = format!("  {small:<12} {error:<16} {noise:<16} {slope}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
        let _ = writeln!(text, "\n  {}", self.verdict());
        text
    }

    fn markdown(&self) -> String {
        let mut text = format!("### {}\n\n", self.title());
        let line = |cells: [String; 4]| {
            format!("| {} |\n", cells.map(|c| c.replace('|', "\\|")).join(" | "))
        };
        text += &line(self.heading());
        text += "|---|---|---|---|\n";
        text.extend(self.rows().into_iter().map(line));
        let _ = writeln!(text, "\n{}", self.verdict());
        text
    }

    fn latex(&self) -> String {
        let mut text = String::from("\\begin{tabular}{llll}\n");
        let name = match self.found.parameter.as_str() {
            "eps" => r"\varepsilon".to_owned(),
            other => format!("\\{other}"),
        };
        let _ =
            writeln!(text, "${name}$ & $\\max |x_N - x|$ & integration & local order \\\\ \\hline");
        for row in self.rows() {
            let _ = writeln!(text, "{} \\\\", row.join(" & "));
        }
        let _ = writeln!(text, "\\end{{tabular}}\n% {}", self.verdict());
        text
    }

    fn csv(&self) -> String {
        let mut text = format!("# {}\nsmall,difference,integration,slope\n", self.title());
        for row in self.rows() {
            let _ = writeln!(text, "{}", row.join(","));
        }
        text
    }

    /// log10 of the errors over log10 of the small parameter, with the line of slope N + 1.
    fn figure(&self) -> Result<String, Failure> {
        let log = |x: Float| x.abs().log10().to_f64();
        let points: Vec<(f64, f64)> = (self.found.comparisons.iter())
            .map(|c| (log(Float::with_val(80, &c.small)), log(c.error.clone())))
            .filter(|(_, y)| y.is_finite())
            .collect();
        let name = &self.found.parameter;
        let labels = (format!("log10 |{name}|"), "log10 max |x_N - x|".to_owned());
        let expected = self.found.order as f64 + 1.0;
        let grey = RGBColor(150, 150, 150);
        let words = [format!("slope {expected}"), "measured".to_owned()];
        let marks = [plot::Mark::Line(grey, 2), plot::Mark::Disc(plot::BLUE)];
        let legend: Vec<(&str, plot::Mark)> = words.iter().map(String::as_str).zip(marks).collect();
        plot::chart(&self.title(), &labels, &legend, &points, |chart| {
            if let Some(&(x0, y0)) = points.last() {
                let line = points.iter().map(|(x, _)| (*x, y0 + expected * (x - x0)));
                chart.draw_series(LineSeries::new(line, plot::stroke(grey, 2)))?;
            }
            let radius = (5 * plot::FINE) as i32;
            chart
                .draw_series(points.iter().map(|p| Circle::new(*p, radius, plot::BLUE.filled())))?;
            Ok(())
        })
    }
}
