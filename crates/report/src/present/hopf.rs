//! Hopf points: the parameter and the frequency in powers of the amplitude, the cycle, what they say.

use super::derive::{coefficient, indexed};
use super::resonance::sought;
use super::{Pen, Present, both, equation, head, stability_word};
use crate::{Document, Formula, Text};
use lindstedt::unstable::coeff::print::{Style, latex_name, power};
use lindstedt::unstable::hopf::{Coefficient, Law};
use lindstedt::{Answer, HopfSeries, SoughtSeries};

/// The page of either form.
impl Present for Answer<SoughtSeries> {
    fn page(&self, pen: Pen) -> Document {
        match &self.value {
            SoughtSeries::Edges(value) => sought(value, pen),
            SoughtSeries::Cycle(value) => page(value),
        }
    }
}

impl Present for Answer<HopfSeries> {
    fn page(&self, _: Pen) -> Document {
        page(&self.value)
    }
}

fn page(found: &HopfSeries) -> Document {
    let problem = &found.problem;
    let page = head(problem).formula(equation(problem));
    let page = series(found, motion(found, points(found, page)));
    let page = laws(found, page);
    page.words(match (found.cycle.checked_orders, found.cycle.exact) {
            (None, _) => "Not put into the equation: not checked.".to_owned(),
            (Some(last), exact) => {
                let how = if exact { "vanishes identically" } else { "encloses zero" };
                format!("Residual: the series put into the equation and multiplied out {how} at orders 1 to {last}.")
            }
        })
}

/// Where it was looked, and what was found.
fn points(found: &HopfSeries, page: Document) -> Document {
    let (name, points) = (&found.unknown, &found.cycle.points);
    let [low, high] = points.interval;
    let list = points.points.iter().map(|point| {
        let [alpha, omega] = HopfSeries::listed(point);
        format!("({}, {})", alpha.decimal, omega.decimal)
    });
    let page = page.words(format!(
        "Sought: {name}, where a pair of roots i*omega, -i*omega of the characteristic function crosses the axis and a cycle is \
         born at x = 0."
    ));
    page.words(format!(
        "All with {low} <= {name} <= {high}, as ({name}, omega): {}. Taken: the nearest to {name} = {}.",
        list.collect::<Vec<_>>().join(", "),
        found.near
    ))
}

/// x in powers of eps.
fn motion(found: &HopfSeries, page: Document) -> Document {
    let small = &found.problem.small;
    let mut page = page.formula(both(|style| match style {
        Style::Text => format!(
            "x = {small}*x_1 + {small}^2*x_2 + ...,   s = omega*t,   x_2, x_3, ... without cos(s), sin(s)"
        ),
        Style::Latex => {
            let small = latex_name(small);
            format!(
                r"x = {small}\,x_1 + {small}^2\,x_2 + \dots,\quad s = \omega t,\quad x_2, x_3, \dots \text{{ without }} \cos s, \sin s"
            )
        }
    }));
    for (n, x) in found.cycle.solution.iter().enumerate() {
        page = page.formula(both(|style| {
            let shown = &x[usize::from(style == Style::Latex)];
            format!("{} = {shown}", indexed("x", n + 1, style))
        }));
    }
    page
}

fn series(found: &HopfSeries, mut page: Document) -> Document {
    let small = Formula::new(&*found.problem.small, latex_name(&found.problem.small));
    let name = Text::from(Formula::new(&*found.unknown, latex_name(&found.unknown)));
    let lists = [(name, &found.cycle.parameter), ("omega".into(), &found.cycle.frequency)];
    for (name, list) in lists {
        page = page.words(name.and(" in powers of ").formula(small.clone()).and(":"));
        for (n, c) in list.iter().enumerate() {
            let own = printed(c);
            page = page.formula(match c.number.exact {
                Some(_) => coefficient(n, own, &c.number),
                None => {
                    Formula::new(format!("{n}: {}", own.text), format!(r"{n}:\quad {}", own.latex))
                }
            });
        }
    }
    page
}

fn printed(c: &Coefficient) -> Formula {
    Formula::new(&*c.printed[0], &*c.printed[1])
}

/// What is the same in every normalisation.
fn laws(found: &HopfSeries, page: Document) -> Document {
    let (name, cycle) = (&found.unknown, &found.cycle);
    let [re, im] = &cycle.crossing;
    let page =
        page.words(format!("The roots at {name}_0, and what holds near it in leading order:"));
    let slope = |part: &str| {
        both(|style| match style {
            Style::Text => format!("{part} dlambda/d{name}"),
            Style::Latex => format!(r"\operatorname{{{part}}}\, d\lambda/d{}", latex_name(name)),
        })
    };
    let page = page.formula(quotient(slope("Re"), re)).formula(quotient(slope("Im"), im));
    let Some(law) = &cycle.law else {
        let how = if cycle.exact { "is zero" } else { "is zero, or cannot be told from it" };
        return page.words(format!(
            "Every coefficient of {name} after the first {how}: up to this order the size of the cycle does not follow from \
             {name}."
        ));
    };
    let page = law_of(found, law, page);
    let others = match cycle.unstable_roots {
        Some(0) => "no other root has a positive real part".to_owned(),
        Some(1) => "one other root has a positive real part".to_owned(),
        Some(count) => format!("{count} other roots have a positive real part"),
        None => "how many other roots have a positive real part is not decided".to_owned(),
    };
    let side = if law.above { ">" } else { "<" };
    let kind = if law.supercritical { "Supercritical" } else { "Subcritical" };
    let verdict = stability_word(cycle.is_stable(), "of undecided stability");
    page.words(format!(
        "{kind}: the cycle lives at {name} {side} {name}_0; {others}: the cycle is {verdict}."
    ))
}

/// The leading terms of amplitude, frequency and Floquet exponent beta.
fn law_of(found: &HopfSeries, law: &Law, page: Document) -> Document {
    let names = |style| {
        let [small, name] = [&*found.problem.small, &*found.unknown].map(|name| match style {
            Style::Text => name.to_owned(),
            Style::Latex => latex_name(name),
        });
        let start =
            if style == Style::Text { format!("{name}_0") } else { format!("{{{name}}}_0") };
        (power(&small, law.order as i64, style), format!("({name} - {start})"))
    };
    let greek = |name: &str, style| match style {
        Style::Text => name.to_owned(),
        Style::Latex => format!(r"\{name}"),
    };
    let size = both(|style| {
        let (small, distance) = names(style);
        format!("{small}/{distance}")
    });
    let frequency = both(|style| {
        let omega = greek("omega", style);
        format!("({omega} - {omega}_0)/{}", names(style).1)
    });
    let exponent = both(|style| format!("{}/{}", greek("beta", style), names(style).0));
    let page = page.formula(quotient(size, &law.amplitude));
    let page = page.formula(quotient(frequency, &law.frequency_slope));
    let page = page.formula(quotient(exponent, &law.floquet_exponent));
    page.words(format!(
        "(2*{} is the amplitude of the first harmonic, beta the Floquet exponent of the cycle.)",
        found.problem.small
    ))
}

/// name = exact, its decimal below.
fn quotient(name: Formula, c: &Coefficient) -> Formula {
    let (own, second) = (printed(c), c.number.exact.is_some() && c.number.error.is_some());
    let decimal =
        |sign: &str| if second { format!("{sign}{}", c.number.decimal) } else { String::new() };
    Formula::new(
        format!("{} = {}{}", name.text, own.text, decimal("\n   =  ")),
        format!("{} = {}{}", name.latex, own.latex, decimal(" = ")),
    )
}
