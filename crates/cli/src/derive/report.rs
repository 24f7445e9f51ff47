//! A derivation as it is printed: order by order, and as JSON.

use super::number_json;
use crate::problems::{condition_name, condition_text};
use crate::session::Session;
use lindstedt::coeff::print::Style;
use lindstedt::equation::{AmplitudeRole, Condition, print};
use lindstedt::{Derivation, Error, Number, Solution};
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// Right sides and solutions with more terms are counted, not printed, in the text formats; the
/// JSON format has them all.
const PRINTED_TERMS: usize = 60;

/// How a formula and a heading are set.
pub(super) struct Frame {
    heading: &'static str,
    open: &'static str,
    close: &'static str,
}

impl Frame {
    pub(super) const TEXT: Self = Self { heading: "", open: "  ", close: "" };
    pub(super) const LATEX: Self = Self { heading: "\\paragraph*", open: "\\[ ", close: " \\]" };
    pub(super) const MARKDOWN: Self = Self { heading: "### ", open: "$$ ", close: " $$" };

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

/// A derivation with its numbers.
pub(super) struct Report<'a> {
    result: &'a Derivation,
    /// The numbers of every series.
    numbers: Vec<Vec<Number>>,
}

impl<'a> Report<'a> {
    pub(super) fn new(result: &'a Derivation, digits: usize) -> Result<Self, Error> {
        let numbers = result.series.iter().map(|series| result.numbers(series, digits));
        let numbers = numbers.collect::<Result<_, _>>()?;
        Ok(Self { result, numbers })
    }

    /// The number of orders whose solution is known.
    pub(super) fn solved(&self) -> usize {
        match self.result.solution {
            Solution::FrequencyOnly => 0,
            _ => self.result.order + 1,
        }
    }

    pub(super) fn json(&self, session: &Session<'_>) -> Json {
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
    pub(super) fn board(&self, style: Style, frame: &Frame) -> String {
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
