//! `lindstedt derive`: the expansion, order by order, as one would write it on the board.

use crate::Outcome;
use crate::arguments::{self, DeriveOptions, Format};
use crate::averaging;
use crate::classification;
use crate::failure::{Failure, INTERRUPTED, UNDECIDED};
use crate::output;
use crate::problems::{condition_name, condition_text};
use crate::session::{Loaded, Session, digits, load, parameters};
use crate::start::{self, Taken};
use lindstedt::coeff::print::Style;
use lindstedt::equation::classify::polynomial;
use lindstedt::equation::{AmplitudeRole, Condition, print};
use lindstedt::expand::ExpandError;
use lindstedt::{
    Derivation, Error, Number, ProblemFile, Progress, Route, Settings, Solution, Status, Value,
};
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// Right sides and solutions with more terms are counted, not printed, in the text formats; the
/// JSON format has them all.
const PRINTED_TERMS: usize = 60;

pub fn run(options: &DeriveOptions, session: &Session<'_>) -> Outcome {
    let mut loaded = load(&options.problem)?;
    let condition =
        classification::condition(options.normalisation, &mut loaded, &options.problem)?;
    let Loaded { problem, file } = loaded;
    let digits = digits(&options.precision)?;
    let settings = Settings {
        order: options.order as usize,
        condition,
        parameters: parameters(&options.set)?,
        memory: session.memory(),
        route: match options.route {
            arguments::Route::Driver => Route::Driver,
            arguments::Route::Energy => Route::EnergyIntegral,
        },
        stop: session.stop(),
    };
    output::check_writable(session)?;
    // The equation of a file is looked at before any work starts; built-in ones are known.
    let mut header = String::new();
    if let Some(file) = &file
        && let Ok(parts) = classification::of(&problem, &settings.parameters)
    {
        classification::check(&parts, file, settings.condition, &options.problem)?;
        if session.format() == Format::Text {
            header = classification::text(&parts, &problem.small) + "\n";
        }
    }
    let condition = settings.condition.or(problem.conditions.first().copied());
    if condition == Some(Condition::FreeAmplitude)
        && problem.conditions.contains(&Condition::FreeAmplitude)
    {
        // A file gives its values; the parameters of a built-in problem stay symbols.
        let mut settings = settings;
        if file.is_some() {
            let known = lindstedt::known_values(&problem, &settings.parameters);
            let known = known.into_iter().map(|(name, q)| (name, Value::Rational(q)));
            settings.parameters = known.chain(settings.parameters).collect();
        }
        let read = file.as_ref().map(|file| (file, &*options.problem));
        return averaging::run(&problem, &settings, digits, &header, session, read);
    }
    if options.tier != arguments::TierName::Exact {
        let file = file.as_ref();
        return crate::derive_numeric::run(options, (&problem, file), &settings, digits, session);
    }
    let mut primes = 0;
    let mut observer = |progress: Progress| {
        if let Progress::Primes(n) = progress {
            primes = n;
        }
        session.say(match progress {
            Progress::Order(n, terms) => format!("order {n} of {}: {terms} terms", settings.order),
            Progress::Primes(n) => format!("{n} primes done"),
            Progress::Integrating(n) => format!("{n} values compared"),
            Progress::Checking => "substituting into the equation".to_owned(),
        });
        session.goes_on()
    };
    let result = lindstedt::derive(&problem, &settings, &mut observer);
    let result = result.map_err(|error| match error {
        // Over Q all orders are finished together, so there is nothing to show.
        Error::Expand(ExpandError::Interrupted { .. }) if !session.interrupted() => Failure {
            exit: UNDECIDED,
            code: "limit-seconds",
            message: unfinished(primes > 0 || polynomial(&problem.equation).is_some(), primes),
            hint: "raise --limit-seconds or lower --order".to_owned(),
        },
        other => classification::refusal(other, file.as_ref(), &options.problem),
    })?;
    let report = Report::new(&result, digits)?;
    session.done();
    if result.condition == Condition::InitialAmplitude {
        start::compare(&problem, file.as_ref(), &settings.parameters, Taken::Amplitude);
    }
    say_missing(file.as_ref(), &|name| {
        result.series.iter().any(|series| series.name == name)
            || name == "solution" && report.solved() > 0
    });
    let text = match session.format() {
        Format::Json => format!("{:#}\n", report.json(session)),
        Format::Text => header + &report.board(Style::Text, &Frame::TEXT),
        Format::Latex => report.board(Style::Latex, &Frame::LATEX),
        Format::Markdown => report.board(Style::Latex, &Frame::MARKDOWN),
    };
    output::write(session, &text)?;
    let unchecked =
        result.checked_orders.is_none() && !matches!(result.solution, Solution::FrequencyOnly);
    if result.order < settings.order || unchecked {
        let reason = if session.interrupted() { "interrupted" } else { "time limit" };
        let checked = if unchecked { "but not checked" } else { "and checked" };
        output::warn(&format!("{reason}: orders 0 to {} are finished {checked}", result.order));
        return Ok(if session.interrupted() { INTERRUPTED } else { UNDECIDED });
    }
    Ok(0)
}

/// The message of an expansion without a single order. Over Q every order is reconstructed from all
/// primes together and proved by substitution at the end.
fn unfinished(over_q: bool, primes: usize) -> String {
    let message = "the time limit was reached before the expansion was finished";
    if over_q {
        format!(
            "{message}: over Q all orders are reconstructed together from many primes ({primes} \
             done) and proved at the end; before that no order is"
        )
    } else {
        message.to_owned()
    }
}

/// Says what a problem file asks for and the derivation does not have.
pub fn say_missing(file: Option<&ProblemFile>, has: &dyn Fn(&str) -> bool) {
    let Some(file) = file else { return };
    let missing: Vec<&str> =
        file.asked.iter().map(String::as_str).filter(|name| !has(name)).collect();
    if !missing.is_empty() {
        output::warn(&format!(
            "asked for in the file, but not in this result: {}",
            missing.join(", ")
        ));
    }
}

/// A number of the JSON contract.
pub fn number_json(number: &Number) -> Json {
    json!({
        "exact": number.exact,
        "decimal": number.decimal,
        "error": number.error,
        "status": match number.status {
            Status::Exact => "exact",
            Status::Certified => "certified",
            Status::Estimated => "estimated",
            Status::NoEstimate => "no-estimate",
        },
    })
}

/// How a formula and a heading are set.
struct Frame {
    heading: &'static str,
    open: &'static str,
    close: &'static str,
}

impl Frame {
    const TEXT: Self = Self { heading: "", open: "  ", close: "" };
    const LATEX: Self = Self { heading: "\\paragraph*", open: "\\[ ", close: " \\]" };
    const MARKDOWN: Self = Self { heading: "### ", open: "$$ ", close: " $$" };

    fn title(&self, text: &str) -> String {
        if self.heading.starts_with('\\') {
            format!("{}{{{text}}}\n", self.heading)
        } else {
            format!("{}{text}\n", self.heading)
        }
    }

    /// What sets a line of words off from the formulas around it.
    fn gap(&self) -> &'static str {
        if self.heading.starts_with('#') { "\n" } else { "" }
    }

    fn formula(&self, text: &str) -> String {
        format!("{}{text}{}\n", self.open, self.close)
    }
}

struct Report<'a> {
    result: &'a Derivation,
    /// The numbers of every series.
    numbers: Vec<Vec<Number>>,
}

impl<'a> Report<'a> {
    fn new(result: &'a Derivation, digits: usize) -> Result<Self, Error> {
        let numbers = result.series.iter().map(|series| result.numbers(series, digits));
        let numbers = numbers.collect::<Result<_, _>>()?;
        Ok(Self { result, numbers })
    }

    /// The number of orders whose solution is known.
    fn solved(&self) -> usize {
        match self.result.solution {
            Solution::FrequencyOnly => 0,
            _ => self.result.order + 1,
        }
    }

    fn json(&self, session: &Session<'_>) -> Json {
        let result = self.result;
        let mut series = serde_json::Map::new();
        for (named, numbers) in result.series.iter().zip(&self.numbers) {
            series.insert(named.name.to_owned(), numbers.iter().map(number_json).collect());
        }
        let orders = self.solved();
        let solution: Vec<String> =
            (0..orders).map(|n| result.print_solution(n, Style::Text)).collect();
        let method = match &result.solution {
            Solution::Rational(proved) => json!({
                "name": "multi-modular, proved",
                "primes": proved.primes,
                "proof_primes": proved.proof_primes,
            }),
            Solution::FrequencyOnly => json!({"name": "energy integral"}),
            _ => json!({"name": "Lobachevsky ring over Q[mu_m]"}),
        };
        json!({
            "problem": result.problem.name,
            "equation": format!("{} = 0", result.problem.equation.print(&result.problem.small, print::Style::Text)),
            "parameter": result.problem.small,
            "at": self.at(),
            "order": result.order,
            "tier": "exact",
            "normalisation": condition_name(result.condition),
            "series": series,
            "solution": solution,
            "terms": (0..orders).map(|n| result.terms(n)).collect::<Vec<_>>(),
            "residual": {
                "checked_orders": result.checked_orders,
                "zero": result.checked_orders.map(|_| true),
            },
            "method": method,
            "seconds": session.elapsed().as_secs_f64(),
        })
    }

    /// The parameters that the numbers depend on.
    fn at(&self) -> Json {
        let enters = matches!(
            self.result.problem.amplitude,
            AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSums | AmplitudeRole::Scaled
        );
        let mut at = serde_json::Map::new();
        if let (Some(value), true) = (&self.result.amplitude, enters) {
            at.insert("amplitude".into(), value.to_string().into());
        }
        for (name, value) in &self.result.bound {
            at.insert(name.clone(), value.to_string().into());
        }
        at.into()
    }

    /// What x stands for when the amplitude is not one.
    fn scaling(&self) -> String {
        let Some(value) = &self.result.amplitude else { return String::new() };
        match self.result.problem.amplitude {
            AmplitudeRole::ScalesFrequency { .. } if value.to_string() != "1" => format!(
                "Amplitude a = {value}: x/a is expanded below, W_n belongs to amplitude one; the \
                 result contains the factor a^(2 {}) of omega^2.\n",
                self.result.problem.small
            ),
            AmplitudeRole::InSums => {
                format!("Amplitude a = {value} (in the S_n): x/a is expanded below.\n")
            }
            AmplitudeRole::Scaled if value.to_string() != "1" => {
                format!("Amplitude a = {value}: y = x/a is expanded, written x below.\n")
            }
            _ => String::new(),
        }
    }

    /// What the symbols of the equation stand for when it is not the one that was written.
    fn values(&self, omega: &str) -> String {
        let result = self.result;
        let mut text = String::new();
        if !result.bound.is_empty() {
            let list: Vec<String> =
                result.bound.iter().map(|(n, q)| format!("{n} = {q}")).collect();
            text += &format!("With {}.\n", list.join(", "));
        }
        if result.time_scale != 1 {
            text += &format!(
                "Time is in units of 1/{w} below; the result has {omega} in the time of the problem.\n",
                w = result.time_scale
            );
        }
        text
    }

    /// The derivation: equation, secular condition, solution of every order.
    fn board(&self, style: Style, frame: &Frame) -> String {
        let result = self.result;
        let mut text = String::new();
        let small = match style {
            Style::Text => result.problem.small.to_string(),
            Style::Latex => lindstedt::coeff::print::latex_name(&result.problem.small),
        };
        let print_style = match style {
            Style::Text => print::Style::Text,
            Style::Latex => print::Style::Latex,
        };
        let equation = result.problem.equation.print(&result.problem.small, print_style);
        text += &frame.title(&format!("{}: {}", result.problem.name, result.problem.title));
        text += &frame.formula(&format!("{equation} = 0"));
        let names = Names::new(style);
        let kappa = result.ring_print(style);
        let Names { tau, omega, times, gap, w, dots, .. } = &names;
        let sum = format!("1 + {w}_1{times}{small} + {w}_2{times}{small}^2 + {dots}");
        let sum = if kappa == "1" { sum } else { format!("{kappa}{times}({sum})") };
        text += &frame.formula(&format!(
            "{tau} = {omega}{times}t,{gap}{omega}^2 = {sum},{gap}\
             x = x_0({tau}) + x_1({tau}){times}{small} + {dots}"
        ));
        let _ = writeln!(text, "Normalisation: {}.", condition_text(result.condition));
        text += &self.scaling();
        text += &self.values(omega);
        text.push('\n');
        if matches!(result.solution, Solution::Lobachevsky(_)) {
            text += names.ring;
        }
        for n in 0..self.solved() {
            text += &self.order(n, style, frame, &names);
        }
        text += &frame.title("Result");
        for (named, numbers) in result.series.iter().zip(&self.numbers) {
            let _ = writeln!(
                text,
                "{}{} in powers of {small}:{}",
                frame.gap(),
                named.name.replace('_', " "),
                frame.gap(),
                small = match style {
                    Style::Text => small.clone(),
                    Style::Latex => format!("${small}$"),
                },
            );
            for (n, number) in numbers.iter().enumerate() {
                let exact = result.print_coefficient(named, n, style);
                let shown = match number.error {
                    // Zero and small integers need no second form.
                    None if number.decimal == exact => String::new(),
                    _ => format!("  {}", number.decimal),
                };
                let _ = match (frame.heading, style) {
                    (_, Style::Text) => writeln!(
                        text,
                        "  {n}: {exact}{}",
                        if shown.is_empty() { shown } else { format!("\n     ={shown}") }
                    ),
                    _ => write!(text, "{}", frame.formula(&format!("{n}:\\quad {exact} ={shown}"))),
                };
            }
        }
        match (&result.solution, result.checked_orders) {
            (Solution::Rational(proved), Some(last)) => {
                let _ = writeln!(
                    text,
                    "\nResidual: the expansion substituted into the equation vanishes identically \
                     at orders 0 to {last}\n(proved modulo {} primes of 61 bits, more than its \
                     numbers can hold).",
                    proved.proof_primes
                );
            }
            (_, Some(last)) => {
                let _ = writeln!(
                    text,
                    "\nResidual: the expansion substituted into the equation vanishes identically \
                     at orders 0 to {last}."
                );
            }
            (Solution::FrequencyOnly, None) => {
                text += "\nBy the energy integral; no solution, so nothing to substitute.\n";
            }
            (_, None) => text += "\nNot substituted into the equation: not checked.\n",
        }
        text
    }

    fn order(&self, n: usize, style: Style, frame: &Frame, names: &Names) -> String {
        let result = self.result;
        let mut text = frame.title(&format!("Order {n}"));
        let Names { times, w, prime, .. } = names;
        if n == 0 {
            text += &frame.formula(&format!("x_0{prime} + x_0 = 0"));
        } else {
            let (right_side, terms) = result.print_right_side(n, style);
            let right_side = if terms > PRINTED_TERMS {
                counted(terms, style)
            } else if terms == 0 {
                String::new()
            } else {
                right_side
            };
            let inertia = format!("- {w}_{{{n}}}{times}x_0{prime}");
            let inertia =
                if style == Style::Text { inertia.replace(['{', '}'], "") } else { inertia };
            let lower = if style == Style::Text { format!("x_{n}") } else { format!("x_{{{n}}}") };
            text += &frame.formula(&format!("{lower}{prime} + {lower} = {right_side} {inertia}"));
            let index = |name: &str| match style {
                Style::Text => format!("{name}_{n}"),
                Style::Latex => format!("{name}_{{{n}}}"),
            };
            let value = result.frequency_correction(n, style);
            text += &frame.formula(&match style {
                Style::Text => format!(
                    "no secular term: 2*mean(f_{n}*cos(tau)) + {a}{} = 0, so {} = {value}",
                    index(w), index(w), a = names.leading(result),
                ),
                Style::Latex => format!(
                    "2\\langle f_{{{n}}}\\cos\\tau\\rangle + {a}{} = 0 \\;\\Rightarrow\\; {} = {value}",
                    index(w), index(w), a = names.leading(result),
                ),
            });
            if result.condition == Condition::LimitCycle && n > 1 {
                let before = n - 1;
                let value = result.amplitude_correction(before, style);
                text += &frame.formula(&match style {
                    Style::Text => format!("2*mean(f_{n}*sin(tau)) = 0 fixes the amplitude a_{before} = {value}"),
                    Style::Latex => format!("2\\langle f_{{{n}}}\\sin\\tau\\rangle = 0 \\;\\Rightarrow\\; a_{{{before}}} = {value}"),
                });
            }
        }
        let terms = result.terms(n);
        let solution = if terms > PRINTED_TERMS {
            counted(terms, style)
        } else {
            result.print_solution(n, style)
        };
        let lower = if style == Style::Text { format!("x_{n}") } else { format!("x_{{{n}}}") };
        text += &frame.formula(&format!("{lower} = {solution}"));
        text.push('\n');
        text
    }
}

fn counted(terms: usize, style: Style) -> String {
    match style {
        Style::Text => format!("[{terms} terms; all of them with --format json]"),
        Style::Latex => format!("\\text{{[{terms} terms; all of them with --format json]}}"),
    }
}

/// Notation in the two styles.
struct Names {
    tau: &'static str,
    omega: &'static str,
    times: &'static str,
    gap: &'static str,
    w: &'static str,
    prime: &'static str,
    dots: &'static str,
    /// What stands for what in the Lobachevsky ring.
    ring: &'static str,
}

impl Names {
    /// The leading amplitude as a factor, when it is not one.
    fn leading(&self, result: &Derivation) -> String {
        match result.amplitude_correction(0, Style::Text).as_str() {
            "1" => String::new(),
            amplitude => format!("{amplitude}{}", self.times),
        }
    }

    fn new(style: Style) -> Self {
        match style {
            Style::Text => Self {
                tau: "tau",
                omega: "omega",
                times: "*",
                gap: "   ",
                w: "W",
                prime: "''",
                dots: "...",
                ring: "l = -ln|cos(tau)|, Lambda_m = integral of l^m/m! - mu_m from 0 to tau (periodic),\nmu_m = mean of l^m/m!, f_n = right side without W_n x_0''.\n\n",
            },
            Style::Latex => Self {
                tau: "\\tau",
                omega: "\\omega",
                times: "\\,",
                gap: "\\quad ",
                w: "W",
                prime: "''",
                dots: "\\dots",
                ring: "$\\ell = -\\ln|\\cos\\tau|$, \
                       $\\Lambda_m = \\int_0^\\tau(\\ell^m/m! - \\mu_m)$ (periodic), \
                       $\\mu_m = \\langle\\ell^m/m!\\rangle$, \
                       $f_n$ is the right side without $W_n\\,x_0''$.\n\n",
            },
        }
    }
}
