//! The solution as a function: its Fourier series in omega t, with the measured deviation.

use super::{Fourier, Trajectory};
use crate::refusal::Refused;
use lindstedt_algebra::Stop;
use serde::Serialize;
use std::fmt::Write;

/// A language in which a solution can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    /// A function of doubles.
    Rust,
    /// A function of numbers, and of arrays where NumPy is installed.
    Python,
    /// C99: a function of doubles, and one of arrays.
    C,
    /// A displayed formula.
    Latex,
}

/// One harmonic: k, coefficient of cos, coefficient of sin.
type Term = (usize, f64, f64);

/// A solution as a function of time.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SolutionCode {
    /// The language.
    pub language: Language,
    /// omega.
    pub frequency: f64,
    /// k, c_k and s_k of c_k cos(k omega t) + s_k sin(k omega t); those below the error are left out.
    pub terms: Vec<Term>,
    /// The largest deviation from the expansion that was measured, what is left out included.
    pub deviation: f64,
    /// Terms below this are left out.
    pub left_out_below: f64,
    /// The program text.
    pub code: String,
}

impl SolutionCode {
    /// A trajectory by its harmonics.
    pub(super) fn new(
        problem: &str,
        trajectory: &Trajectory,
        fourier: Fourier,
        language: Language,
    ) -> Self {
        let Fourier { coefficients: list, deviation, error, largest_error } = fourier;
        let size = list.iter().fold(0.0f64, |m, (c, s)| m.max(c.abs()).max(s.abs()));
        // Below the error of the expansion a coefficient is noise; where some phase has no estimate,
        // the measured deviation stands for it.
        let small = (size * trajectory.negligible()).max(error.unwrap_or(deviation));
        let note = format!("expansion of order {}", trajectory.order());
        // In doubles.
        let own = largest_error.max(size * f64::EPSILON);
        let left_out = match error {
            Some(_) => format!(
                "the expansion's own error at small t {own:.1e} (estimated); terms below \
                 {small:.1e} are left out"
            ),
            None => {
                "the expansion's own error is not known: more orders may tell; terms below the \
                     deviation are left out"
                    .to_owned()
            }
        };
        let words = [note, "the expansion".to_owned(), left_out];
        let series = (list, deviation, trajectory.frequency());
        Self::written(problem, series, small, language, words)
    }

    /// An orbit of Newton's method in Fourier space by its harmonics, and omega.
    pub(super) fn by_newton(
        problem: &str,
        (series, omega): (Fourier, f64),
        language: Language,
    ) -> Self {
        let small = series.error.unwrap_or_default();
        let words = [
            "Newton's method in Fourier space",
            "it",
            "terms of the size of rounding are left out",
        ];
        let series = (series.coefficients, series.deviation, omega);
        Self::written(problem, series, small, language, words.map(str::to_owned))
    }

    /// The program text of (c_k, s_k), deviation and omega, without what is below `small`; in words what was
    /// computed, what the deviation is from and what is left out.
    fn written(
        problem: &str,
        (list, deviation, frequency): (Vec<(f64, f64)>, f64, f64),
        small: f64,
        language: Language,
        [what, from, rest]: [String; 3],
    ) -> Self {
        let keep = |x: f64| if x.abs() > small { x } else { 0.0 };
        let terms = list.iter().enumerate().map(|(k, &(c, s))| (k, keep(c), keep(s)));
        let terms: Vec<Term> = terms.filter(|(_, c, s)| *c != 0.0 || *s != 0.0).collect();
        // What is left out deviates, too.
        let left_out = |x: f64| x - keep(x);
        let deviation =
            list.iter().fold(deviation, |d, &(c, s)| d + left_out(c).abs() + left_out(s).abs());
        let harmonics = list.len().saturating_sub(1);
        let note = format!(
            "{problem}: x(t), {what}, its first {harmonics} harmonics; deviation from {from} \
             {deviation:.1e}; {rest}"
        );
        let code = match language {
            Language::Rust => rust(&note, frequency, &terms),
            Language::Python => python(&note, frequency, &terms),
            Language::C => c(&note, frequency, &terms),
            Language::Latex => latex(&note, frequency, &terms),
        };
        Self { language, frequency, terms, deviation, left_out_below: small, code }
    }
}

/// The harmonics of a trajectory up to one.
pub(super) fn sampled(
    trajectory: &Trajectory,
    harmonics: usize,
    stop: &Stop,
) -> Result<Fourier, Refused> {
    trajectory.fourier(harmonics).ok_or_else(|| match stop.asked() {
        true => Refused::stopped("stopped before the phases were sampled", ""),
        false => Refused::undecided(
            "no-value",
            "the expansion has no value at some phase",
            "lower or raise --order, or --resum none",
        ),
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
    let mut text = String::from(
        "try:\n    from numpy import cos, sin\nexcept ImportError:\n    from math import cos, sin\n\n\n\
         def displacement(t):\n",
    );
    let _ = writeln!(text, "    \"\"\"{note}.\"\"\"\n    phase = {omega:?} * t\n    terms = (");
    for (k, c, s) in terms {
        let _ = writeln!(text, "        ({k}, {c:?}, {s:?}),");
    }
    text.push_str(
        "    )\n    return sum(c * cos(k * phase) + s * sin(k * phase) for k, c, s in terms)\n",
    );
    text
}

fn c(note: &str, omega: f64, terms: &[Term]) -> String {
    let mut text = format!(
        "#include <math.h>\n#include <stddef.h>\n\n/* {note}. */\ndouble displacement(double t)\n{{\n    \
         const double phase = {omega:?} * t;\n    double x = 0.0;\n"
    );
    for &(k, c, s) in terms {
        for (x, name) in [(c, "cos"), (s, "sin")] {
            if x != 0.0 {
                let _ = writeln!(text, "    x += {x:?} * {name}({k}.0 * phase);");
            }
        }
    }
    text.push_str(
        "    return x;\n}\n\n/* x[i] is the displacement at t[i], i < n. */\n\
         void displacements(size_t n, const double *t, double *x)\n{\n    \
         for (size_t i = 0; i < n; i++)\n        x[i] = displacement(t[i]);\n}\n",
    );
    text
}

fn latex(note: &str, omega: f64, terms: &[Term]) -> String {
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
    let omega = number(omega);
    format!("\\[ x(t) = {sum}, \\qquad \\omega = {omega} \\]\n{}.\n", escaped(note))
}

/// A double as LaTeX.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:e}");
    match text.split_once('e') {
        Some((mantissa, "0")) => mantissa.to_owned(),
        Some((mantissa, exponent)) => format!(r"{mantissa}\cdot 10^{{{exponent}}}"),
        None => text,
    }
}

/// Words as LaTeX: the name of the problem is anybody's.
pub(super) fn escaped(note: &str) -> String {
    let mut words = String::new();
    for c in note.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => words.extend(['\\', c]),
            '\\' | '^' | '~' => words.push('-'),
            c => words.push(c),
        }
    }
    words
}
