//! The expansion as a program: functions of time and the parameters,
//!
//!   omega = frequency(small, amplitude),   x = displacement(t, small, amplitude),
//!
//! polynomials by Horner's rule, cut off at an order and not resummed; without the amplitude where it does not vary.

use super::code::{escaped, number};
use super::compiled::few_harmonics;
use super::{Evaluate, Language};
use crate::refusal::Refused;
use crate::{Answer, Error, Oscillator, Work};
use lindstedt_evaluation::compiled::Varied;
use lindstedt_evaluation::{Carried, Expansion};
use serde::Serialize;
use std::fmt::Write;

const AMPLITUDE: &str = "amplitude";
/// The order where none is asked for.
const ORDER: usize = 8;
/// Names that a language has for something else.
const TAKEN: &[&str] = &[
    "None", "alignas", "alignof", "and", "as", "async", "auto", "await", "bool", "break", "c",
    "case", "char", "class", "const", "continue", "cos", "crate", "def", "default", "del",
    "displacement", "displacements", "do", "double", "else", "enum", "except", "extern", "float",
    "fn", "for", "frequency", "from", "global", "goto", "if", "impl", "import", "in", "int", "is",
    "lambda", "let", "long", "loop", "match", "mod", "mut", "n", "not", "or", "pass", "phase",
    "polynomial", "pow", "pub", "raise", "ref", "register", "return", "self", "short", "signed",
    "sin", "static", "struct", "switch", "t", "try", "type", "union", "use", "void", "where",
    "while", "with", "x", "yield",
];

/// A program of functions of time and the parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ExpansionCode {
    /// The language.
    pub language: Language,
    /// The arguments beside t, in their order.
    pub parameters: Vec<String>,
    /// |z| up to which the last term is below 1e-6 and 1e-12 of the first; nothing where there is no last term.
    pub reach: Option<[f64; 2]>,
    /// The program text.
    pub code: String,
}

impl Oscillator {
    /// The expansion as functions of time, the small parameter and, where a scaling of the equation carries it, the
    /// amplitude; all else has its value. Cut off at the order of the question (8 where there is none), not resummed: for
    /// larger parameters [`Oscillator::solution_function`] sums it, with an error at every point.
    ///
    /// # Errors
    /// As [`Oscillator::frequency_function`].
    ///
    /// ```
    /// use lindstedt::evaluate::Language;
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
    /// let question = Evaluate { order: Some(2), ..Evaluate::default() };
    /// let found = duffing.expansion_code(&question, Language::Python, 15, &Work::default())?.value;
    /// assert!(found.code.contains("def displacement(t, eps, amplitude):"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn expansion_code(
        &self,
        question: &Evaluate,
        language: Language,
        harmonics: usize,
        work: &Work,
    ) -> Result<Answer<ExpansionCode>, Error> {
        few_harmonics(harmonics)?;
        let order = question.order.unwrap_or(ORDER);
        let least = self.high_power()?.map_or(0, |power| power as usize);
        if order < least {
            let message = format!("order {order} has nothing of a term of order {least}");
            return Err(
                Refused::no_answer("high-power", message, format!("--order {least}")).into()
            );
        }
        let make = |varied: &Varied<'_>| Expansion::new(varied, order, harmonics, work);
        let varies = |it: &Expansion| (it.small.clone(), it.carried != Carried::Not, it.order);
        let found = self.function(make, varies)?;
        let value = Program::new(&self.problem().name, &found.value).write(language);
        let Answer { mut header, standing, remarks, .. } = found;
        // Nothing is summed: what is printed is cut off.
        header.tier = "truncation";
        Ok(Answer { header, value, standing, remarks })
    }
}

/// What the languages share.
struct Program<'a> {
    expansion: &'a Expansion,
    note: String,
    /// The small parameter as a name of every language, and the amplitude where it varies.
    names: Vec<String>,
    reach: Option<[f64; 2]>,
}

impl<'a> Program<'a> {
    fn new(problem: &str, expansion: &'a Expansion) -> Self {
        let small = &expansion.small;
        let taken = TAKEN.contains(&small.as_str()) || small == "z" || small == AMPLITUDE;
        let small = if taken { format!("{small}_") } else { small.clone() };
        let varies = expansion.carried != Carried::Not;
        let names: Vec<String> =
            [small].into_iter().chain(varies.then(|| AMPLITUDE.to_owned())).collect();
        let reach = expansion.reach(1e-6).zip(expansion.reach(1e-12)).map(|(a, b)| [a, b]);
        let z = match expansion.carried {
            Carried::BySmall(1) => format!("{}*amplitude", names[0]),
            Carried::BySmall(weight) if weight > 1 => format!("{}*amplitude^{weight}", names[0]),
            _ => names[0].clone(),
        };
        let last = match reach {
            Some([coarse, fine]) => format!(
                "the last term of x is below 1e-6 of the first for z up to {coarse:.1e} in size, below 1e-12 up to {fine:.1e}, \
                 which is no bound of the error"
            ),
            None => "the last term of x is zero".to_owned(),
        };
        let (order, harmonics) =
            (expansion.order, expansion.harmonics.last().map_or(0, |(k, ..)| *k));
        let left: f64 = expansion.left_out.iter().sum();
        let beyond = match left > 1e-12 * expansion.sizes.iter().sum::<f64>() {
            _ if left.is_infinite() => {
                " (the others are left out and fall so slowly that nothing bounds what they add)"
                    .to_owned()
            }
            true => format!(" (the others, {left:.1e} in all at z = 1, are left out)"),
            false => String::new(),
        };
        let note = format!(
            "{problem}: the expansion of order {order} in z = {z}, cut off, not resummed, x(t) by harmonics up to \
             {harmonics}{beyond}; {last}; the phase is wrong by t times the error of the frequency"
        );
        Self { expansion, note, names, reach }
    }

    fn write(self, language: Language) -> ExpansionCode {
        let code = match language {
            Language::Rust => self.rust(),
            Language::Python => self.python(),
            Language::C => self.c(),
            Language::Latex => self.latex(),
        };
        ExpansionCode { language, parameters: self.names, reach: self.reach, code }
    }

    /// `a, b` with something before each.
    fn arguments(&self, kind: &str) -> String {
        let all: Vec<String> = self.names.iter().map(|name| format!("{kind}{name}")).collect();
        all.join(", ")
    }

    /// z with its powers in a language.
    fn variable(&self, power: fn(&str, u32) -> String) -> String {
        let small = &self.names[0];
        match self.expansion.carried {
            Carried::BySmall(weight) if weight > 0 => {
                format!("{small} * {}", power(AMPLITUDE, weight))
            }
            _ => small.clone(),
        }
    }

    /// What T/2pi is beside its polynomial, and what x is beside its sum.
    fn factors(&self, power: impl Fn(&str, &str) -> String) -> [String; 2] {
        let f = format!("{:?}", self.expansion.factor);
        let small = &self.names[0];
        let b = match self.expansion.carried {
            Carried::Not => format!("{:?}", self.expansion.amplitude),
            _ => AMPLITUDE.to_owned(),
        };
        match self.expansion.carried {
            Carried::ByScale => [format!("{f} * {}", power(AMPLITUDE, &format!("-{small}"))), b],
            _ => [f, b],
        }
    }

    /// One line per sum of a harmonic: k, its coefficients, whether of the sine.
    fn terms(&self) -> impl Iterator<Item = (usize, &[f64], bool)> {
        self.expansion.harmonics.iter().flat_map(|(k, c, s)| {
            let both = [(*k, &**c, false), (*k, &**s, true)];
            both.into_iter().filter(|(_, list, _)| !list.is_empty())
        })
    }

    fn python(&self) -> String {
        let names = self.arguments("");
        let z = self.variable(|name, n| format!("{name}**{n}"));
        let [f, b] = self.factors(|a, n| format!("{a} ** ({n})"));
        let mut text = format!(
            "\"\"\"{}.\"\"\"\n\ntry:\n    from numpy import cos, sin\nexcept ImportError:\n    from math import cos, sin\n\n\n\
             def polynomial(z, *coefficients):\n    value = 0.0\n    for c in reversed(coefficients):\n        \
             value = value * z + c\n    return value\n\n\n\
             def frequency({names}):\n    z = {z}\n    return 1.0 / ({f} * polynomial(z, {}))\n\n\n\
             def displacement(t, {names}):\n    z = {z}\n    phase = frequency({names}) * t\n    x = 0.0 * z\n",
            self.note,
            listed(&self.expansion.period)
        );
        for (k, list, sine) in self.terms() {
            let name = if sine { "sin" } else { "cos" };
            let _ =
                writeln!(text, "    x = x + polynomial(z, {}) * {name}({k} * phase)", listed(list));
        }
        let _ = writeln!(text, "    return {b} * x");
        text
    }

    fn rust(&self) -> String {
        let (names, typed) = (self.arguments(""), format!("{}: f64", self.names.join(": f64, ")));
        let z = self.variable(|name, n| format!("{name}.powi({n})"));
        let [f, b] = self.factors(|a, n| format!("{a}.powf({n})"));
        let mut text = format!(
            "// {}.\n\nfn polynomial(z: f64, coefficients: &[f64]) -> f64 {{\n    \
             coefficients.iter().rev().fold(0.0, |value, c| value * z + c)\n}}\n\n\
             pub fn frequency({typed}) -> f64 {{\n    let z = {z};\n    1.0 / ({f} * polynomial(z, &[{}]))\n}}\n\n\
             pub fn displacement(t: f64, {typed}) -> f64 {{\n    let z = {z};\n    \
             let phase = frequency({names}) * t;\n    let mut x = 0.0;\n",
            self.note,
            listed(&self.expansion.period)
        );
        for (k, list, sine) in self.terms() {
            let name = if sine { "sin" } else { "cos" };
            let _ = writeln!(
                text,
                "    x += polynomial(z, &[{}]) * ({k}.0 * phase).{name}();",
                listed(list)
            );
        }
        let _ = write!(
            text,
            "    {b} * x\n}}\n\npub fn displacements(t: &[f64], {typed}) -> Vec<f64> {{\n    \
             t.iter().map(|&t| displacement(t, {names})).collect()\n}}\n"
        );
        text
    }

    fn c(&self) -> String {
        let (names, typed) = (self.arguments(""), self.arguments("double "));
        let (arrays, at) =
            (self.arguments("const double *"), format!("{}[i]", self.names.join("[i], ")));
        let z = self.variable(|name, n| format!("pow({name}, {n}.0)"));
        let [f, b] = self.factors(|a, n| format!("pow({a}, {n})"));
        let mut text = format!(
            "#include <math.h>\n#include <stddef.h>\n\n/* {}. */\n\n\
             static double polynomial(double z, const double *c, size_t n)\n{{\n    double value = 0.0;\n    \
             while (n > 0)\n        value = value * z + c[--n];\n    return value;\n}}\n\n\
             double frequency({typed})\n{{\n    static const double c[] = {{{}}};\n    const double z = {z};\n    \
             return 1.0 / ({f} * polynomial(z, c, {}));\n}}\n\n\
             double displacement(double t, {typed})\n{{\n    const double z = {z};\n    \
             const double phase = frequency({names}) * t;\n    double x = 0.0;\n",
            self.note,
            listed(&self.expansion.period),
            self.expansion.period.len()
        );
        for (k, list, sine) in self.terms() {
            let (name, count) = (if sine { "sin" } else { "cos" }, list.len());
            let _ = writeln!(
                text,
                "    {{\n        static const double c[] = {{{}}};\n        \
                 x += polynomial(z, c, {count}) * {name}({k}.0 * phase);\n    }}",
                listed(list)
            );
        }
        let _ = write!(
            text,
            "    return {b} * x;\n}}\n\n/* x[i] is the displacement at t[i] with the parameters number i, i < n. */\n\
             void displacements(size_t n, const double *t, {arrays}, double *x)\n{{\n    \
             for (size_t i = 0; i < n; i++)\n        x[i] = displacement(t[i], {at});\n}}\n"
        );
        text
    }

    fn latex(&self) -> String {
        let Expansion { carried, factor, period, amplitude, small, .. } = self.expansion;
        let small = lindstedt_coeff::print::latex_name(small);
        let (z, b) = match carried {
            Carried::BySmall(0) => (small.clone(), "a".to_owned()),
            Carried::BySmall(1) => (format!("{small} a"), "a".to_owned()),
            Carried::BySmall(weight) => (format!("{small} a^{{{weight}}}"), "a".to_owned()),
            Carried::ByScale => (small.clone(), "a".to_owned()),
            Carried::Not => (small.clone(), number(*amplitude)),
        };
        let scale = match carried {
            Carried::ByScale => format!(r"a^{{-{small}}}"),
            _ => String::new(),
        };
        let f = if *factor == 1.0 { String::new() } else { number(*factor) };
        let b = if b == "1" { String::new() } else { b };
        let terms = self.terms().map(|(k, list, sine)| {
            let name = if sine { "sin" } else { "cos" };
            let angle = match k {
                0 => String::new(),
                1 => format!(r"\{name}\omega t"),
                _ => format!(r"\{name} {k}\omega t"),
            };
            format!(r"\left({}\right){angle}", sum(list))
        });
        let terms: Vec<String> = terms.collect();
        format!(
            "\\[ \\omega^{{-1}} = {f}{scale}\\left({}\\right), \\qquad z = {z} \\]\n\
             \\[ x(t) = {b}\\left({}\\right) \\]\n{}.\n",
            sum(period),
            terms.join(" + "),
            escaped(&self.note)
        )
    }
}

/// Coefficients with commas.
fn listed(list: &[f64]) -> String {
    let all: Vec<String> = list.iter().map(|c| format!("{c:?}")).collect();
    all.join(", ")
}

/// c_0 + c_1 z + ... as LaTeX, zeros left out.
fn sum(list: &[f64]) -> String {
    let power = |n: usize| match n {
        0 => String::new(),
        1 => " z".to_owned(),
        _ => format!(" z^{{{n}}}"),
    };
    let terms = list.iter().enumerate().filter(|(_, c)| **c != 0.0);
    let terms: Vec<String> = terms.map(|(n, c)| format!("{}{}", number(*c), power(n))).collect();
    terms.join(" + ").replace("+ -", "- ")
}
