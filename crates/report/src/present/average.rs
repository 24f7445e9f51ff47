//! Averaged equations.

use super::{Pen, Present, both, classification, condition_text, equation, head};
use crate::{Document, Formula};
use lindstedt::Answer;
use lindstedt::averaging::{
    self, Averaging, Coefficient, Cycles, RateTerm, SingleCycle, print_series,
};
use lindstedt::unstable::coeff::print::{Style, latex_name, power};
use lindstedt::unstable::equation::Condition;
use std::borrow::Cow;

/// Formulas longer than this are counted; JSON has them all.
const PRINTED_CHARACTERS: usize = 6000;

/// What a and psi are where the law jumps with the velocity.
const BETWEEN_TURNING_POINTS: &str = "a is the amplitude of the turning points, psi is counted between them (x = a at psi = 0, x = -a \
     at psi = pi); u_n holds for 0 <= psi <= pi, where x' < 0, and x(a, psi + pi) = -x(a, psi)";

impl Present for Answer<Averaging> {
    fn page(&self, pen: Pen) -> Document {
        page(&self.value, pen)
    }
}

pub(super) fn page(result: &Averaging, pen: Pen) -> Document {
    let problem = &result.problem;
    let mut page = head(problem);
    page = classification(page, result.description.as_ref());
    page = page.formula(equation(problem)).formula(ansatz(&problem.small));
    let normalisation = match result.between_turning_points() {
        true => BETWEEN_TURNING_POINTS,
        false => condition_text(Condition::FreeAmplitude),
    };
    page = page.words(format!("Normalisation: {normalisation}."));
    // The number pi has one.
    let open: Vec<&str> =
        result.symbols.iter().map(String::as_str).filter(|name| *name != "pi").collect();
    if !open.is_empty() {
        page = page.words(format!("Without a value, kept as symbols: {}.", open.join(", ")));
    }
    for n in 0..=result.order {
        page = page.formula(solution(result, n, pen));
        for (name, rates) in [("A", &result.amplitude_rate), ("B", &result.phase_rate)] {
            if n > 0 || name == "B" {
                let terms = rates.get(n).map_or(&[][..], Vec::as_slice);
                page = page.formula(pen.both(|style| {
                    format!("{} = {}", indexed(name, n, style), rate(terms, "a", style))
                }));
            }
        }
    }
    page = match (&result.cycles, &result.single_cycle) {
        (Some(found), _) => cycles(page, found, &problem.small),
        (None, Some(cycle)) => single_cycle(page, cycle, &problem.small),
        (None, None) => not_listed(result).into_iter().fold(page, Document::words),
    };
    page.words(residual(result))
}

/// Why limit cycles are not listed, where there may be some.
fn not_listed(result: &Averaging) -> Option<String> {
    let drifts = |terms: &Vec<RateTerm>| terms.iter().any(|term| term.exponent != 1);
    let order = result.amplitude_rate.iter().position(|terms| !terms.is_empty())?;
    let free = result.problem.impact.is_none() && !result.between_turning_points();
    if !free || !result.amplitude_rate.iter().any(drifts) {
        return None;
    }
    match &result.symbols[..] {
        [] if result.exact => None,
        [] => {
            let small = power(&result.problem.small, order as i64, Style::Text);
            Some(format!(
                "Limit cycles: not listed, for the coefficients are irrational. At a simple zero a_0 > 0 of A_{order} there is \
                 one, with the Floquet exponent A_{order}'(a_0)*{small} + ..."
            ))
        }
        names => Some(format!(
            "Limit cycles: not listed without the values of {}; where these (--set NAME=VALUE) make the coefficients rational \
             they are, with their Floquet exponents.",
            names.join(", ")
        )),
    }
}

/// The limit cycles, one after the other.
fn cycles(mut page: Document, found: &Cycles, small: &str) -> Document {
    let k = found.leading_order;
    page = page.words(match found.cycles.len() {
        0 => format!("No limit cycle whose amplitude tends to a number other than 0 with {small}: A_{k}(a) has no simple zero a > 0."),
        count => format!(
            "Limit cycles: {count}, at the simple zeros a_0 of A_{k}(a); r = a_0^2, lambda the Floquet exponent per unit of t:"
        ),
    });
    for cycle in &found.cycles {
        let root = |style| match cycle.is_rational() {
            true => String::new(),
            false if style == Style::Text => format!("   {} = 0", cycle.print_polynomial(style)),
            false => format!(",\\quad {} = 0", cycle.print_polynomial(style)),
        };
        let amplitude = cycle.amplitude.exact.as_ref().unwrap_or(&cycle.amplitude.decimal);
        page = page.formula(both(|style| {
            format!("{} = {amplitude}{}", indexed("a", 0, style), root(style))
        }));
        let square = |style| power("a", 2, style);
        let series: [(&dyn Fn(Style) -> String, _); 3] = [
            (&square, &cycle.squared_amplitude),
            (&|style| plain("omega", style), &cycle.frequency),
            (&|style| plain("lambda", style), &cycle.exponent),
        ];
        for (name, series) in series {
            let line = |style| {
                let small = plain(small, style);
                format!(
                    "{} = {}",
                    name(style),
                    shortened(print_series(series, &small, style), style)
                )
            };
            page = page.formula(both(line));
        }
        let stable = if cycle.stable { "stable" } else { "unstable" };
        page = page.words(format!("It is {stable} for small {small} > 0."));
    }
    for amplitude in &found.degenerate {
        let a = amplitude.exact.as_ref().unwrap_or(&amplitude.decimal);
        page = page.words(format!(
            "At a_0 = {a} A_{k} has a multiple zero: whether cycles are there, and how many, its order does not decide."
        ));
    }
    page
}

/// The limit cycle whose amplitude is a formula or enclosed.
fn single_cycle(mut page: Document, found: &SingleCycle, small: &str) -> Document {
    let k = found.leading_order;
    page = page.words(format!(
        "Limit cycle: one where a_0^2 > 0, at the simple zero a_0 of A_{k}(a); stable for small {small} > 0 where the first term of \
         lambda, the Floquet exponent per unit of t, is negative:"
    ));
    let series: [(&dyn Fn(Style) -> String, _); 3] = [
        (&|style| power("a", 2, style), &found.squared_amplitude),
        (&|style| plain("omega", style), &found.frequency),
        (&|style| plain("lambda", style), &found.exponent),
    ];
    for (name, series) in series {
        let zero = |c: &&(i32, &Coefficient)| matches!(c.1, Coefficient::Number(n) if n.exact.as_deref() == Some("0"));
        let term = |(exponent, c): (i32, &Coefficient)| RateTerm::new(exponent, c.clone());
        let terms: Vec<_> = (0..).zip(series).filter(|c| !zero(&c)).map(term).collect();
        page = page.formula(both(|style| {
            let sum = rate(&terms, &plain(small, style), style);
            format!("{} = {}", name(style), shortened(sum, style))
        }));
    }
    page
}

fn plain(name: &str, style: Style) -> String {
    if style == Style::Text { name.to_owned() } else { latex_name(name) }
}

fn indexed(name: &str, n: usize, style: Style) -> String {
    if style == Style::Text { format!("{name}_{n}") } else { format!("{name}_{{{n}}}") }
}

fn ansatz(small: &str) -> Formula {
    let latex = latex_name(small);
    Formula::new(
        format!(
            "x = u_0 + u_1*{small} + ...   a' = A_1(a)*{small} + A_2(a)*{small}^2 + ...   psi' = B_0 + B_1(a)*{small} + ..."
        ),
        format!(
            "x = u_0 + u_1\\,{latex} + \\dots,\\quad \\dot a = A_1(a)\\,{latex} + A_2(a)\\,{latex}^2 + \\dots,\\quad \\dot\\psi = B_0 + B_1(a)\\,{latex} + \\dots"
        ),
    )
}

fn solution(result: &Averaging, n: usize, pen: Pen) -> Formula {
    pen.both(|style| {
        let solution = result.solution.get(n).map_or(Cow::Borrowed("0"), |u| printed(u, style));
        format!("{} = {}", indexed("u", n, style), shortened(solution.into_owned(), style))
    })
}

fn residual(result: &Averaging) -> String {
    let last = result.checked_orders;
    if result.exact {
        return format!(
            "Residual: the expansion substituted into the equation vanishes identically at orders 0 to {last}."
        );
    }
    let rest = if last < result.order {
        "the orders above were not checked"
    } else {
        "all digits printed are certain"
    };
    format!(
        "Residual: the expansion substituted into the equation encloses zero at orders 0 to {last};\n{rest}."
    )
}

fn printed(formula: &averaging::Formula, style: Style) -> Cow<'_, str> {
    if style == Style::Latex { formula.latex().into() } else { formula.text().into() }
}

/// sum of c name^exponent.
fn rate(terms: &[RateTerm], name: &str, style: Style) -> String {
    let mut line = String::new();
    for term in terms {
        let coefficient: Cow<'_, str> = match &term.coefficient {
            Coefficient::ClosedForm { latex, .. } if style == Style::Latex => latex.into(),
            Coefficient::Number(number) | Coefficient::ClosedForm { number, .. } => {
                number.exact.as_ref().unwrap_or(&number.decimal).into()
            }
            Coefficient::Formula(formula) => printed(formula, style),
        };
        let is_sum = coefficient.trim_start_matches('-').contains([' ']);
        let name = (term.exponent != 0).then(|| power(name, term.exponent.into(), style));
        let (negative, magnitude) = match coefficient.strip_prefix('-') {
            Some(rest) if !is_sum => (true, rest),
            _ => (false, &*coefficient),
        };
        line += match (line.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let times = if style == Style::Text { "*" } else { "\\," };
        line += &match (name, is_sum) {
            (None, _) => magnitude.to_owned(),
            (Some(name), _) if magnitude == "1" => name,
            (Some(name), true) => format!("{name}{times}({magnitude})"),
            (Some(name), false) => format!("{magnitude}{times}{name}"),
        };
    }
    if line.is_empty() { "0".to_owned() } else { shortened(line, style) }
}

/// A formula, or how long it is.
pub(super) fn shortened(line: String, style: Style) -> String {
    let count = line.len();
    match style {
        _ if count <= PRINTED_CHARACTERS => line,
        Style::Text => format!("[{count} characters; in full with --format json]"),
        Style::Latex => format!("\\text{{[{count} characters; in full with --format json]}}"),
    }
}
