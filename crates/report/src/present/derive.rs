//! A derivation as one would write it on the board, order by order.

use super::{Pen, Present, classification, condition_text, equation, head};
use crate::{Document, Formula, Text};
use lindstedt::unstable::coeff::print::{Style, latex_name};
use lindstedt::unstable::equation::{AmplitudeRole, Condition, Quantity};
use lindstedt::{Answer, Derivation, Number, Route, Solution};

/// Right sides and solutions with more terms are counted, not printed; JSON has them all.
const PRINTED_TERMS: usize = 60;

const RING: &str = "$\\ell = -\\ln|\\cos\\tau|$, $\\Lambda_m = \\int_0^\\tau(\\ell^m/m! - \\mu_m)$ (periodic), \
                    $\\mu_m = \\langle\\ell^m/m!\\rangle$, $f_n$ is the right side without $W_n x_0''$.";
const RING_TEXT: &str = "l = -ln|cos(tau)|, Lambda_m = integral of l^m/m! - mu_m from 0 to tau (periodic),\n\
                         mu_m = mean of l^m/m!, f_n = right side without W_n x_0''.";

impl Present for Answer<Derivation> {
    fn page(&self, pen: Pen) -> Document {
        Board { value: &self.value, pen }.page()
    }
}

/// A derivation with what is written of it.
struct Board<'a> {
    value: &'a Derivation,
    pen: Pen,
}

impl Board<'_> {
    fn page(&self) -> Document {
        let problem = &self.value.problem;
        let mut page = head(problem);
        page = classification(page, self.value.description.as_ref());
        page = page.formula(equation(problem)).formula(self.ansatz());
        page = page.words(format!("Normalisation: {}.", condition_text(self.value.condition)));
        for words in self.scalings() {
            page = page.words(words);
        }
        if matches!(self.value.solution, Solution::Clock(_) | Solution::Lobachevsky(_)) {
            page = page.words(Formula::new(RING_TEXT, RING).into_sentence());
        }
        for n in 0..self.value.solved() {
            page = self.order(page, n);
        }
        page = page.heading("Result");
        page = self.result(page);
        page = self.closing().into_iter().fold(page, Document::formula);
        page.words(self.residual())
    }

    fn small(&self, style: Style) -> String {
        let name = &self.value.problem.small;
        if style == Style::Latex { latex_name(name) } else { name.to_string() }
    }

    /// tau = omega t, omega^2 = kappa (1 + W_1 eps + ...), x = x_0 + x_1 eps + ...
    fn ansatz(&self) -> Formula {
        self.pen.both(|style| {
            let (small, kappa) = (self.small(style), self.value.ring_print(style));
            let (tau, omega, times, gap, dots) = match style {
                Style::Text => ("tau", "omega", "*", "   ", "..."),
                Style::Latex => ("\\tau", "\\omega", "\\,", "\\quad ", "\\dots"),
            };
            let sum = format!("1 + W_1{times}{small} + W_2{times}{small}^2 + {dots}");
            let sum = if kappa == "1" { sum } else { format!("{kappa}{times}({sum})") };
            format!(
                "{tau} = {omega}{times}t,{gap}{omega}^2 = {sum},{gap}x = x_0({tau}) + \
                 x_1({tau}){times}{small} + {dots}"
            )
        })
    }

    /// What x and the symbols stand for where the equation is not the one that was written.
    fn scalings(&self) -> Vec<Text> {
        let result = self.value;
        let mut list = Vec::new();
        if let Some(value) = &result.amplitude {
            let small = self.small(Style::Text);
            let scaled = value.to_string() != "1";
            let words = match result.problem.amplitude {
                AmplitudeRole::ScalesFrequency { .. } if scaled => Some(format!(
                    "Amplitude a = {value}: x/a is expanded below, W_n belongs to amplitude one; the \
                     result contains the factor a^(2 {small}) of omega^2."
                )),
                AmplitudeRole::InSums => {
                    Some(format!("Amplitude a = {value} (in the S_n): x/a is expanded below."))
                }
                AmplitudeRole::Scaled if scaled => {
                    Some(format!("Amplitude a = {value}: y = x/a is expanded, written x below."))
                }
                _ => None,
            };
            list.extend(words);
        }
        if !result.bound.is_empty() {
            let values = result.bound.iter().map(|(n, q)| format!("{n} = {q}"));
            list.push(format!("With {}.", values.collect::<Vec<_>>().join(", ")));
        }
        if result.time_scale != 1 {
            list.push(format!(
                "Time is in units of 1/{} below; the result has omega in the time of the problem.",
                result.time_scale
            ));
        }
        list.into_iter().map(Text::words).collect()
    }

    fn order(&self, page: Document, n: usize) -> Document {
        let result = self.value;
        let mut page = page.heading(format!("Order {n}"));
        if n == 0 {
            page = page.formula(Formula::new("x_0'' + x_0 = 0", "x_0'' + x_0 = 0"));
        } else {
            page = page.formula(self.right_side(n)).formula(self.secular(n));
            if result.condition == Condition::LimitCycle && n > 1 {
                page = page.formula(self.pen.both(|style| {
                    let (before, value) = (n - 1, result.amplitude_correction(n - 1, style));
                    match style {
                        Style::Text => format!(
                            "2*mean(f_{n}*sin(tau)) = 0 fixes the amplitude a_{before} = {value}"
                        ),
                        Style::Latex => format!(
                            "2\\langle f_{{{n}}}\\sin\\tau\\rangle = 0 \\;\\Rightarrow\\; \
                             a_{{{before}}} = {value}"
                        ),
                    }
                }));
            }
        }
        page.formula(self.pen.both(|style| {
            let terms = result.terms(n);
            let solution = if terms > PRINTED_TERMS {
                counted(terms, style)
            } else {
                result.print_solution(n, style)
            };
            format!("{} = {solution}", indexed("x", n, style))
        }))
    }

    /// x_n'' + x_n = f_n - W_n x_0'', with f_n by its name where it is too long to be formed.
    fn right_side(&self, n: usize) -> Formula {
        let (value, most) = (self.value, PRINTED_TERMS);
        // It is formed once for both.
        let (printed, latex) = if self.pen.latex {
            let found = value.print_right_side(n, [Style::Text, Style::Latex], most);
            found.map(|([text, latex], terms)| ((text, terms), latex)).unzip()
        } else {
            let found = value.print_right_side(n, [Style::Text], most);
            (found.map(|([text], terms)| (text, terms)), None)
        };
        self.pen.both(|style| {
            let right_side = match (&printed, style) {
                (None, _) => indexed("f", n, style),
                (Some((_, 0)), _) => String::new(),
                (Some((text, 1..=PRINTED_TERMS)), Style::Text) => text.clone(),
                (Some((_, 1..=PRINTED_TERMS)), Style::Latex) => latex.clone().unwrap_or_default(),
                (Some((_, terms)), _) => counted(*terms, style),
            };
            let (x, w) = (indexed("x", n, style), indexed("W", n, style));
            let times = if style == Style::Text { "*" } else { "\\," };
            format!("{x}'' + {x} = {right_side} - {w}{times}x_0''").replace("=  -", "= -")
        })
    }

    /// The condition that leaves no secular term, and the W_n that it gives.
    fn secular(&self, n: usize) -> Formula {
        self.pen.both(|style| {
            let w = indexed("W", n, style);
            let value = self.value.frequency_correction(n, style);
            let leading = self.value.amplitude_correction(0, style);
            let times = if style == Style::Text { "*" } else { "\\," };
            let factor = if leading == "1" { String::new() } else { format!("{leading}{times}") };
            match style {
                Style::Text => format!(
                    "no secular term: 2*mean(f_{n}*cos(tau)) + {factor}{w} = 0, so {w} = {value}"
                ),
                Style::Latex => format!(
                    "2\\langle f_{{{n}}}\\cos\\tau\\rangle + {factor}{w} = 0 \\;\\Rightarrow\\; {w} = {value}"
                ),
            }
        })
    }

    /// The series, coefficient by coefficient.
    fn result(&self, mut page: Document) -> Document {
        let result = self.value;
        let small = self.pen.both(|style| self.small(style));
        for (series, numbers) in result.series.iter().zip(&result.numbers) {
            let name = series.quantity.name().replace('_', " ");
            let line = Text::words(format!("{name} in powers of ")).formula(small.clone()).and(":");
            page = page.words(line);
            for (n, number) in numbers.iter().enumerate() {
                let print = |style| result.print_coefficient(series, n, style);
                // A long coefficient is not written once more.
                let text = number.exact.clone().unwrap_or_else(|| print(Style::Text));
                let latex = if self.pen.latex { print(Style::Latex) } else { String::new() };
                let exact = Formula::new(text, latex);
                page = page.formula(coefficient(n, exact, number));
            }
        }
        page
    }

    /// omega and x(t) in one formula each, to be copied: not in text, whose lines are too short for them. Where the
    /// amplitude stands in a factor of omega there is none.
    fn closing(&self) -> Vec<Formula> {
        let (result, small) = (self.value, self.small(Style::Latex));
        let series = result.series.iter().find(|series| series.quantity == Quantity::Frequency);
        let scaled = result.amplitude.as_ref().map(ToString::to_string).filter(|a| a != "1");
        let in_factor = matches!(result.problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        let Some(series) = series.filter(|_| self.pen.latex && (scaled.is_none() || !in_factor))
        else {
            return Vec::new();
        };
        let count = series.coefficients.len();
        let omega = (0..count).map(|n| result.print_coefficient(series, n, Style::Latex));
        let only = |latex: String| Formula::new("", latex);
        let mut list = vec![only(format!(r"\omega = {}", powers(omega, &small, count)))];
        let (solved, terms) = (result.solved(), |n| result.terms(n));
        if solved > 0 && (0..solved).map(terms).sum::<usize>() <= PRINTED_TERMS {
            let x = (0..solved).map(|n| result.print_solution(n, Style::Latex));
            let sum = powers(x, &small, solved);
            let x = match scaled {
                Some(a) => format!(r"{a}\left({sum}\right)"),
                None => sum,
            };
            list.push(only(format!(r"x(t) = {x}, \qquad \tau = \omega t")));
        }
        list
    }

    fn residual(&self) -> String {
        let vanishes = |last: usize| {
            format!(
                "Residual: the expansion substituted into the equation vanishes identically at orders 0 to {last}"
            )
        };
        match (&self.value.solution, self.value.checked_orders) {
            (Solution::Rational(proved), Some(last)) => format!(
                "{}\n(proved modulo {} primes of 30 bits, more than its numbers can hold).",
                vanishes(last),
                proved.proof_primes
            ),
            (_, Some(last)) if self.value.route == Route::Clock => format!(
                "{}\n(proved by its one clock: dx/dLambda_m = -c_m D x term by term, then at Lambda = 0;\n\
                 of W, omega and T multiplied out at one point modulo two primes, a wrong one passes with a chance below 2^-48).",
                vanishes(last)
            ),
            (_, Some(last)) => vanishes(last) + ".",
            (Solution::FrequencyOnly { images: Some(images) }, None) => format!(
                "From {} primes below 2^30, more than its numbers can hold by bounds proved in advance; no solution.\n\
                 All that was formed modulo them was held against its operands at three numbers in the place of eps: that\n\
                 something is wrong modulo one of them and passes has a chance below {:.1e}.",
                images.primes, images.chance
            ),
            (Solution::FrequencyOnly { images: None }, None) => {
                "By the energy integral; no solution, so nothing to substitute.".to_owned()
            }
            (_, None) => "Not substituted into the equation: not checked.".to_owned(),
        }
    }
}

/// `n: exact` with its decimal below; zero and small integers need no second form.
pub(super) fn coefficient(n: usize, exact: Formula, number: &Number) -> Formula {
    let second = number.error.is_some() || number.decimal != exact.text;
    let shown =
        |sign: &str| if second { format!("{sign}{}", number.decimal) } else { String::new() };
    Formula::new(
        format!("{n}: {}{}", exact.text, shown("\n   =  ")),
        format!("{n}:\\quad {}{}", exact.latex, shown(" = ")),
    )
}

pub(super) fn indexed(name: &str, n: usize, style: Style) -> String {
    if style == Style::Text { format!("{name}_{n}") } else { format!("{name}_{{{n}}}") }
}

/// c_0 + c_1 small + ... + O(small^count), zeros left out.
fn powers(list: impl Iterator<Item = String>, small: &str, count: usize) -> String {
    let power = |n: usize| match n {
        0 => String::new(),
        1 => small.to_owned(),
        n => format!("{small}^{{{n}}}"),
    };
    let mut sum = String::new();
    for (n, coefficient) in list.enumerate().filter(|(_, coefficient)| coefficient != "0") {
        // One that is a sum stands in brackets.
        let inner = coefficient.trim_start_matches('-');
        let term = match (n, &*coefficient) {
            (0, _) => coefficient,
            (_, "1") => power(n),
            (_, "-1") => format!("-{}", power(n)),
            _ if inner.contains(" + ") || inner.contains(" - ") => {
                format!(r"\left({coefficient}\right){}", power(n))
            }
            _ => format!(r"{coefficient}\,{}", power(n)),
        };
        sum += &match term.strip_prefix('-') {
            _ if sum.is_empty() => term,
            Some(term) => format!(" - {term}"),
            None => format!(" + {term}"),
        };
    }
    format!(r"{sum} + O\left({}\right)", power(count))
}

fn counted(terms: usize, style: Style) -> String {
    match style {
        Style::Text => format!("[{terms} terms; all of them with --format json]"),
        Style::Latex => format!("\\text{{[{terms} terms; all of them with --format json]}}"),
    }
}
