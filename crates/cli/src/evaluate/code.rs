//! The solution as a function: its Fourier series in omega t, with the measured deviation.

use crate::arguments::Language;
use crate::failure::{Failure, UNDECIDED};
use lindstedt::equation::Problem;
use lindstedt::evaluate::{Fourier, Trajectory};
use std::fmt::Write;

/// One harmonic: k, coefficient of cos, coefficient of sin.
type Term = (usize, f64, f64);

pub fn write(
    problem: &Problem,
    trajectory: &Trajectory,
    language: Language,
    harmonics: u32,
) -> Result<String, Failure> {
    let found = trajectory.fourier(harmonics as usize);
    let Fourier { coefficients: list, deviation, error } = found.ok_or_else(|| Failure {
        exit: UNDECIDED,
        code: "no-value",
        message: "the expansion has no value at some phase".to_owned(),
        hint: "lower or raise --order, or --resum none".to_owned(),
    })?;
    let size = list.iter().fold(0.0f64, |m, (c, s)| m.max(c.abs()).max(s.abs()));
    // Below the error of the expansion a coefficient is noise; where some phase has no estimate, the
    // measured deviation stands for it.
    let small = (size * trajectory.negligible()).max(error.unwrap_or(deviation));
    let keep = |x: f64| if x.abs() > small { x } else { 0.0 };
    let terms: Vec<Term> = list
        .iter()
        .enumerate()
        .map(|(k, &(c, s))| (k, keep(c), keep(s)))
        .filter(|(_, c, s)| *c != 0.0 || *s != 0.0)
        .collect();
    // What is left out deviates, too.
    let left_out = |x: f64| x - keep(x);
    let deviation =
        list.iter().fold(deviation, |d, &(c, s)| d + left_out(c).abs() + left_out(s).abs());
    let omega = trajectory.frequency();
    let note = format!(
        "{}: x(t), expansion of order {}, its first {harmonics} harmonics; deviation from the \
         expansion {deviation:.1e}; {}",
        problem.name,
        trajectory.order(),
        match error {
            Some(_) => format!("terms below the error of the expansion, {small:.1e}, are left out"),
            None => "no estimate at some phases: terms below the deviation are left out".to_owned(),
        }
    );
    Ok(match language {
        Language::Rust => rust(&note, omega, &terms),
        Language::Python => python(&note, omega, &terms),
        Language::Latex => latex(&note, omega, &terms),
    })
}

fn rust(note: &str, omega: f64, terms: &[Term]) -> String {
    let mut text = format!("/// {note}.\npub fn displacement(t: f64) -> f64 {{\n");
    let _ = writeln!(text, "    let phase = {omega:?} * t;\n    [");
    for (k, c, s) in terms {
        let _ = writeln!(text, "        ({k}.0, {c:?}, {s:?}),");
    }
    text.push_str("    ]\n    .iter()\n    .map(|&(k, c, s): &(f64, f64, f64)| {\n");
    text.push_str("        c * (k * phase).cos() + s * (k * phase).sin()\n    })\n    .sum()\n}\n");
    text
}

fn python(note: &str, omega: f64, terms: &[Term]) -> String {
    let mut text = String::from("from math import cos, sin\n\n\ndef displacement(t):\n");
    let _ = writeln!(text, "    \"\"\"{note}.\"\"\"\n    phase = {omega:?} * t\n    terms = (");
    for (k, c, s) in terms {
        let _ = writeln!(text, "        ({k}, {c:?}, {s:?}),");
    }
    text.push_str(
        "    )\n    return sum(c * cos(k * phase) + s * sin(k * phase) for k, c, s in terms)\n",
    );
    text
}

fn latex(note: &str, omega: f64, terms: &[Term]) -> String {
    let number = |x: f64| {
        let text = format!("{x:e}");
        match text.split_once('e') {
            Some((mantissa, "0")) => mantissa.to_owned(),
            Some((mantissa, exponent)) => format!(r"{mantissa}\cdot 10^{{{exponent}}}"),
            None => text,
        }
    };
    let mut parts = Vec::new();
    for &(k, c, s) in terms {
        let angle = |name: &str| match k {
            0 => String::new(),
            1 => format!(r"\{name} \omega t"),
            _ => format!(r"\{name} {k}\omega t"),
        };
        for (x, name) in [(c, "cos"), (s, "sin")] {
            if x != 0.0 {
                parts.push(format!("{} {}", number(x), angle(name)));
            }
        }
    }
    let sum = parts.join(" + ").replace("+ -", "- ");
    format!("% {note}.\n\\[ x(t) = {sum}, \\qquad \\omega = {} \\]\n", number(omega))
}
