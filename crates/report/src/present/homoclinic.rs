//! Homoclinic orbits to any order: the parameter, the orbit, the nonlinear time.

use super::derive::{coefficient, indexed};
use super::{Pen, Present, both, equation, head};
use crate::{Document, Formula, Text};
use lindstedt::threshold::HomoclinicSeries;
use lindstedt::unstable::coeff::print::{
    Style, Term, latex_name, power, print_rational, print_sum,
};
use lindstedt::{Answer, Exact, Number};

impl Present for Answer<HomoclinicSeries> {
    fn page(&self, _: Pen) -> Document {
        let found = &self.value;
        let problem = &found.problem;
        let name = &found.unknown;
        let mut page = head(problem).formula(equation(problem));
        page = page.words(format!(
            "Sought: {name}, for which the orbit that leaves the saddle returns to it."
        ));
        page = page.formula(orbit(found));
        for (n, list) in found.frequency.iter().enumerate() {
            page = page.formula(both(|style| {
                let omega = if style == Style::Text { "omega" } else { r"\omega" };
                format!("{} = {}", indexed(omega, n, style), in_tanh(list, style))
            }));
        }
        let small = Formula::new(&found.parameter, latex_name(&found.parameter));
        let rows = found
            .series
            .iter()
            .map(|(name, list)| (Text::from(Formula::new(name, latex_name(name))), list));
        let exponent = i64::from(found.power) - 1;
        let size = both(|style| {
            let sigma = if style == Style::Text { "sigma" } else { r"\sigma" };
            power(sigma, exponent, style)
        });
        for (name, list) in rows.chain([(Text::from(size), &found.amplitude)]) {
            page = page.words(name.and(" in powers of ").formula(small.clone()).and(":"));
            for (n, number) in list.iter().enumerate() {
                page = page.formula(coefficient(n, exact(number), number));
            }
        }
        page.words(format!(
            "Residual: the orbit substituted into the equation vanishes identically at orders 0 to {}.",
            found.residual.checked_orders
        ))
    }
}

/// x = c + sigma sech^p(xi), xi' = omega.
fn orbit(found: &HomoclinicSeries) -> Formula {
    both(|style| {
        let p = match (found.power, style) {
            (2, Style::Text) => "^2".to_owned(),
            (3, _) => String::new(),
            (k, Style::Text) => format!("^(2/{})", k - 1),
            (2, Style::Latex) => "^{2}".to_owned(),
            (k, Style::Latex) => format!("^{{2/{}}}", k - 1),
        };
        let shift = match found.saddle.to_string() {
            zero if zero == "0" => String::new(),
            c => format!("{c} + "),
        };
        match style {
            Style::Text => format!(
                "x = {shift}sigma*sech(xi){p},   xi' = omega = omega_0 + omega_1*{} + ...,   T = tanh(xi)",
                found.parameter
            ),
            Style::Latex => format!(
                r"x = {shift}\sigma\,\operatorname{{sech}}{p}\,\xi,\quad \dot\xi = \omega = \omega_0 + \omega_1\,{} + \dots,\quad T = \tanh\xi",
                latex_name(&found.parameter)
            ),
        }
    })
}

/// A polynomial in T = tanh xi.
fn in_tanh(list: &[Exact], style: Style) -> String {
    let term = |(m, q): (usize, &Exact)| {
        let coefficient = q.as_rational().filter(|q| !q.is_zero())?.clone();
        let factors = (m > 0).then(|| power("T", m as i64, style)).into_iter().collect();
        Some(Term { coefficient, factors })
    };
    print_sum(&list.iter().enumerate().filter_map(term).collect::<Vec<_>>(), style)
}

fn exact(number: &Number) -> Formula {
    let text = number.exact.clone().unwrap_or_else(|| number.decimal.clone());
    let latex = Exact::parse(&text).ok();
    let latex = latex.as_ref().and_then(Exact::as_rational);
    let latex = latex.map_or_else(|| text.clone(), |q| print_rational(q, Style::Latex));
    Formula::new(text, latex)
}
