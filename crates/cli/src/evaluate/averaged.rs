//! `lindstedt evaluate` with a free amplitude: a(t), psi(t), x(t) of the averaged equations.

use super::figure;
use super::trajectory::Request;
use crate::Outcome;
use crate::arguments::{EvaluateOptions, Format, Resum};
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output;
use crate::session::number_json;
use crate::session::{Loaded, Session, digits};
use crate::start::{Taken, compare};
use lindstedt::evaluate::averaged::{Moment, Motion, MotionSettings, Quantity, Start};
use lindstedt::number::ball::Balls;
use lindstedt::{Exact, Number, Progress};
use plotters::prelude::{BLUE, RGBColor};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// The order if none is asked for.
const ORDER: usize = 4;
/// Periods of the linear part shown where no times are given.
const PERIODS: f64 = 10.0;
const GREY: RGBColor = RGBColor(150, 150, 150);

pub fn run(
    options: &EvaluateOptions,
    loaded: &Loaded,
    parameters: BTreeMap<String, Exact>,
    session: &Session<'_>,
) -> Outcome {
    let problem = &loaded.problem;
    let refused = |what: &str, hint: &str| {
        Err(Failure::usage("averaged", format!("{what} does not belong to averaged motions"), hint))
    };
    if !matches!(options.resum, Resum::None | Resum::Auto) {
        return refused("--resum", "the averaged series is broken off at --order");
    }
    if options.code.is_some() {
        return refused("--code", "an averaged motion is no Fourier series in one phase");
    }
    if options.phase.trim() != "0" {
        return refused("--phase", "--start A,PSI has the phase");
    }
    let times = Request::read(options)?;
    let settings = MotionSettings {
        order: options.order.map_or(ORDER, |order| order as usize),
        start: start(options, loaded, &parameters, times.is_some())?,
        parameters,
        digits: digits(&options.precision)?,
    };
    output::check_writable(session)?;
    let mut observer = |progress: Progress| {
        if let Progress::Order(n, terms) = progress {
            session.say(format!("order {n} of {}: {terms} terms", settings.order));
        }
        session.goes_on()
    };
    let motion = Motion::new(problem, &settings, &mut observer);
    let mut motion = motion
        .map_err(|error| super::failure(error, loaded.file.as_ref(), &options.problem, session))?;
    let asked = times.map(|request| request.times(PERIODS * motion.turn()));
    let moments = asked.as_ref().map(|times| motion.at(times, &mut || session.goes_on()));
    session.done();
    let report = Report { loaded, motion: &motion, moments: moments.as_deref() };
    for path in &options.plot {
        let contents = report.file(path)?;
        std::fs::write(path, contents)
            .map_err(|error| output::trouble(&path.display().to_string(), &error))?;
    }
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report.json(session)),
        Format::Text => report.text(),
        Format::Latex => report.latex(),
        Format::Markdown => report.markdown(),
    };
    output::write(session, &text)?;
    let all =
        asked.as_ref().is_none_or(|asked| moments.as_ref().is_some_and(|m| m.len() == asked.len()));
    if motion.order < settings.order || !all {
        output::warn(match &motion.ended {
            Some(_) => "the averaged motion ends; the times after that are missing",
            None => "stopped; orders or times not reached are missing",
        });
        return Ok(match (session.interrupted(), &motion.ended) {
            (true, _) => INTERRUPTED,
            // No step short enough is no proof that there is no motion: 4, as for `simulate`.
            (false, Some(reason)) => Failure::from(reason.clone()).exit,
            (false, None) => UNDECIDED,
        });
    }
    Ok(0)
}

/// Two values separated by a comma.
fn pair(name: &'static str, text: &str) -> Result<[Exact; 2], Failure> {
    let shown: String = text.chars().take(60).collect();
    let (first, second) = text.split_once(',').ok_or_else(|| {
        let message = format!("--{name} {shown:?} is not two values");
        Failure::usage(name, message, "for example 1,0")
    })?;
    Ok([Exact::parse(first)?, Exact::parse(second)?])
}

/// The start given, that of the file, or the amplitude of the card at phase 0; without times an
/// amplitude 1 shows the rates.
fn start(
    options: &EvaluateOptions,
    loaded: &Loaded,
    parameters: &BTreeMap<String, Exact>,
    needed: bool,
) -> Result<Start, Failure> {
    let zero = || Exact::parse("0");
    if let Some(text) = &options.start {
        let [a, psi] = pair("start", text)?;
        let positive = a.ball(Balls::new(64)).is_positive();
        if !positive {
            let message = format!("the amplitude {a} is not positive");
            return Err(Failure::usage("start", message, "--start A,PSI with A > 0"));
        }
        return Ok(Start::Amplitude(a, psi));
    }
    if let Some(text) = &options.state {
        let [x, v] = pair("state", text)?;
        return Ok(Start::State(x, v));
    }
    if let Some([x, v]) = loaded.file.as_ref().and_then(|file| file.initial.as_ref()) {
        let taken = Taken::Initial("--start AMPLITUDE,0");
        compare(&loaded.problem, loaded.file.as_ref(), parameters, taken);
        return Ok(Start::State(Exact::parse(x)?, Exact::parse(v)?));
    }
    let card = loaded.problem.parameters.iter().find(|card| card.name == "amplitude");
    let amplitude = parameters.get("amplitude").cloned();
    let default = || card.and_then(|card| Exact::parse(&card.default).ok());
    if let Some(a) = amplitude.or_else(default) {
        return Ok(Start::Amplitude(a, zero()?));
    }
    if needed {
        let message = "the amplitude is free: where does the motion start?".to_owned();
        return Err(Failure::usage("start", message, "--start A,PSI or --state X,V"));
    }
    Ok(Start::Amplitude(Exact::parse("1")?, zero()?))
}

struct Report<'a> {
    loaded: &'a Loaded,
    motion: &'a Motion,
    moments: Option<&'a [Moment]>,
}

fn double(time: &Exact) -> f64 {
    time.ball(Balls::new(64)).midpoint().to_f64()
}

fn optional(number: Option<&Number>) -> Json {
    let none = json!({"exact": null, "decimal": null, "error": null, "status": "estimated"});
    number.map_or(none, number_json)
}

impl Report<'_> {
    fn json(&self, session: &Session<'_>) -> Json {
        let motion = self.motion;
        let at: serde_json::Map<String, Json> =
            motion.at.iter().map(|(n, v)| (n.clone(), Json::from(v.to_string()))).collect();
        let values: Option<Vec<Json>> = self.moments.map(|moments| {
            let one = |m: &Moment| {
                json!({
                    "t": m.time.to_string(),
                    "a": optional(m.amplitude.value.as_ref()),
                    "psi": optional(m.phase.value.as_ref()),
                    "x": optional(m.displacement.value.as_ref()),
                })
            };
            moments.iter().map(one).collect()
        });
        let [growth, frequency] = match &motion.linear {
            Some(numbers) => numbers.each_ref().map(|number| optional(number.as_ref())),
            None => [Json::Null, Json::Null],
        };
        json!({
            "problem": self.loaded.problem.name,
            "at": at,
            "order": motion.order,
            "resum": "none",
            "normalisation": "free-amplitude",
            "period": null,
            "frequency": frequency,
            "growth_rate": growth,
            "exact_period": null,
            "start": {"a": motion.start[0], "psi": motion.start[1]},
            "rates": {
                "amplitude": motion.rates()[0],
                "phase": motion.rates()[1],
                "amplitude_number": optional(motion.rate_numbers[0].as_ref()),
                "phase_number": optional(motion.rate_numbers[1].as_ref()),
            },
            "term_ratio": motion.ratio,
            "integration_error": motion.integration_error,
            "verdict": motion.verdict(),
            "solution": values.map(|values| json!({"order": motion.order, "resum": "none", "values": values})),
            "seconds": session.elapsed().as_secs_f64(),
        })
    }

    fn lines(&self) -> Vec<(String, String)> {
        let motion = self.motion;
        let shown = |number: &Option<Number>| match number {
            Some(number) => match &number.error {
                Some(error) => format!("{} +- {error} (estimated)", number.decimal),
                None => format!("{} (no estimate)", number.decimal),
            },
            None => "not one digit: the last orders differ by more than its size".to_owned(),
        };
        let [amplitude, phase] = motion.rate_numbers.each_ref().map(shown);
        let [a, psi] = motion.start;
        let mut lines = vec![
            ("start".to_owned(), format!("a = {a}, psi = {psi}")),
            ("a' there".to_owned(), amplitude),
            ("psi' there".to_owned(), phase),
        ];
        if let Some([growth, frequency]) = &motion.linear {
            lines.push(("growth rate a'/a".to_owned(), shown(growth)));
            lines.push(("frequency psi'".to_owned(), shown(frequency)));
        }
        lines.push(("verdict".to_owned(), motion.verdict()));
        lines
    }

    fn heading(&self) -> String {
        let parts: Vec<String> = self.motion.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        format!("{}: {}", self.loaded.problem.name, parts.join(", "))
    }

    /// Time and the three quantities with their errors.
    fn rows(&self) -> Vec<[String; 4]> {
        let shown = |q: &Quantity| match &q.value {
            Some(number) => match &number.error {
                Some(error) => format!("{} +- {error}", number.decimal),
                None => format!("{} (no estimate)", number.decimal),
            },
            // Without the sign of a zero.
            None => format!("{:.1e} +- {:.1e}", q.double + 0.0, q.error),
        };
        let row = |m: &Moment| {
            let time = format!("{:?}", double(&m.time));
            [time, shown(&m.amplitude), shown(&m.phase), shown(&m.displacement)]
        };
        self.moments.unwrap_or_default().iter().map(row).collect()
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n\n", self.heading());
        for (label, value) in self.lines() {
            let _ = writeln!(text, "  {label:<24} {value}");
        }
        let rows = self.rows();
        if rows.is_empty() {
            return text;
        }
        let heads = ["t", "a", "psi", "x"].map(str::to_owned);
        text.push('\n');
        let width = |k: usize, least: usize| {
            rows.iter().map(|row: &[String; 4]| row[k].len()).max().unwrap_or(0).max(least)
        };
        let [first, second, third] = [width(0, 10), width(1, 30), width(2, 30)];
        for [t, a, psi, x] in std::iter::once(&heads).chain(&rows) {
            let line = format!("  {t:<first$} {a:<second$} {psi:<third$} {x}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }

    fn markdown(&self) -> String {
        let mut text = format!("### {}\n\n| | |\n|---|---|\n", self.heading());
        for (label, value) in self.lines() {
            let _ = writeln!(text, "| {label} | {} |", value.replace('|', "\\|"));
        }
        let rows = self.rows();
        if !rows.is_empty() {
            text.push_str("\n| t | a | psi | x |\n|---|---|---|---|\n");
        }
        for [t, a, psi, x] in rows {
            let _ = writeln!(text, "| {t} | {a} | {psi} | {x} |");
        }
        text
    }

    fn latex(&self) -> String {
        let escape = |s: &str| s.replace('_', "\\_").replace("+-", "$\\pm$");
        let mut text = String::from("\\begin{tabular}{lp{0.7\\textwidth}}\n");
        for (label, value) in self.lines() {
            let _ = writeln!(text, "{} & {} \\\\", escape(&label), escape(&value));
        }
        text.push_str("\\end{tabular}\n");
        let rows = self.rows();
        if rows.is_empty() {
            return text;
        }
        text.push_str("\\begin{tabular}{llll}\n$t$ & $a$ & $\\psi$ & $x$ \\\\\n");
        for row in rows {
            let _ = writeln!(text, "{} \\\\", row.map(|cell| escape(&cell)).join(" & "));
        }
        text.push_str("\\end{tabular}\n");
        text
    }

    /// The contents of a .csv or .svg file.
    fn file(&self, path: &Path) -> Result<String, Failure> {
        let moments = self.moments.unwrap_or_default();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            let mut text = String::from("t,a,a_error,psi,psi_error,x,x_error\n");
            for m in moments {
                let _ = write!(text, "{:?}", double(&m.time));
                for q in [&m.amplitude, &m.phase, &m.displacement] {
                    let _ = write!(text, ",{:?},{:e}", q.double, q.error);
                }
                text.push('\n');
            }
            return Ok(text);
        }
        let curve = |f: &dyn Fn(&Moment) -> f64| -> Vec<(f64, f64)> {
            moments.iter().map(|m| (double(&m.time), f(m))).collect()
        };
        let name = &self.loaded.problem.name;
        let caption = format!("{name}: averaged to order {}, x and +-a", self.motion.order);
        let curves = [
            (curve(&|m| m.displacement.double), BLUE),
            (curve(&|m| m.amplitude.double), GREY),
            (curve(&|m| -m.amplitude.double), GREY),
        ];
        figure::draw(&caption, "x, a", &curves)
    }
}
