//! Slow flows: averaged equations at resonance, in complex amplitudes and, for one unknown, in polar form.

use super::average::{self, shortened};
use super::{Pen, Present, equation, head};
use crate::Document;
use lindstedt::unstable::coeff::print::Style;
use lindstedt::unstable::derivation::resonance::{
    Enclosed, NormalMode, Polar, Sought, SoughtBranch, Terms, Unit, print_name, print_turns,
};
use lindstedt::{Answer, Averaged, SlowFlow};

impl Present for Answer<SlowFlow> {
    fn page(&self, pen: Pen) -> Document {
        Board { value: &self.value, pen }.page()
    }
}

/// The page of either form.
impl Present for Answer<Averaged> {
    fn page(&self, pen: Pen) -> Document {
        match &self.value {
            Averaged::Polar(value) => average::page(value, pen),
            Averaged::Flow(value) => Board { value, pen }.page(),
        }
    }
}

impl Present for Answer<Sought> {
    fn page(&self, pen: Pen) -> Document {
        sought(&self.value, pen)
    }
}

/// Where a motion stays periodic.
pub(super) fn sought(found: &Sought, pen: Pen) -> Document {
    let problem = &found.problem;
    let mut page = head(problem).formula(equation(problem));
    let (name, nu) = (&found.parameter, &found.frequency);
    let turns = found.branches.iter().any(SoughtBranch::turns);
    let own = if turns { "but multiples of x_0' no part" } else { "no part" };
    page = page.words(format!(
            "Sought: {name}, for which x stays periodic with the frequency {nu}; corrections have {own} of that frequency."
        ));
    if !found.all {
        page = page.words(
            "Motions that start with cos or sin alone; other mixtures were not tried.".to_owned(),
        );
    }
    for branch in &found.branches {
        page = page.formula(pen.both(|style| {
            format!("{} = {}", print_name(name, style), found.print_series(branch, style))
        }));
        if branch.origin != "0" {
            let origin = &branch.origin;
            page =
                page.words(format!("Below, t is counted from the time {origin} of the equation."));
        }
        for (n, terms) in branch.solution.iter().enumerate() {
            page = page.formula(pen.both(|style| {
                let x = shortened(found.print_motion(terms, style), style);
                format!("{} = {x}", print_name(&format!("x_{n}"), style))
            }));
        }
        page = page.words(residual(branch.checked_orders));
    }
    page
}

impl Present for Answer<NormalMode> {
    fn page(&self, pen: Pen) -> Document {
        let mode = &self.value;
        let problem = &mode.problem;
        let mut page = head(problem).formula(equation(problem));
        page = page.words(format!(
            "Normal mode {}: nu^2 = {}; a is the amplitude of its first harmonic, rho = a^2, psi' = Omega.",
            mode.mode,
            mode.print_square(Style::Text)
        ));
        page = page.formula(pen.both(|style| {
            let line = shortened(mode.print_in_amplitude(&mode.frequency_squared, style), style);
            match style {
                Style::Text => format!("Omega^2/nu^2 = {line}"),
                Style::Latex => format!(r"\Omega^2/\nu^2 = {line}"),
            }
        }));
        if mode.growth.iter().any(|terms| !terms.is_empty()) {
            page = page.formula(pen.both(|style| {
                let line = shortened(mode.print_in_amplitude(&mode.growth, style), style);
                match style {
                    Style::Text => format!("a'/(nu*a) = {line}"),
                    Style::Latex => format!(r"\dot a/(\nu a) = {line}"),
                }
            }));
        }
        for n in 0..=mode.order {
            for (i, orders) in mode.solution.iter().enumerate() {
                page = page.formula(pen.both(|style| {
                    let x = print_name(&problem.unknown(i), style);
                    let index =
                        if style == Style::Text { format!("{n}") } else { format!("{{({n})}}") };
                    let mark = if style == Style::Text { "_" } else { "^" };
                    format!(
                        "{x}{mark}{index} = {}",
                        shortened(mode.print_shape(&orders[n], style), style)
                    )
                }));
            }
        }
        let residual = residual_within(mode.enclosed, mode.checked_orders);
        with_unit(page, mode.unit.as_ref()).words(residual)
    }
}

/// What is taken of a unit of frequency that is a symbol.
fn with_unit(page: Document, unit: Option<&Unit>) -> Document {
    let Some(Unit { name, square: None, .. }) = unit else { return page };
    page.words(format!(
        "Without a value, and positive: {name}, of which the frequencies are multiples."
    ))
}

/// What became of the substitution into the equation.
fn residual(checked_orders: Option<usize>) -> String {
    match checked_orders {
        Some(last) => format!(
            "Residual: the expansion substituted into the equation vanishes identically at orders 0 to {last}."
        ),
        None => "Residual: the orders were not checked.".to_owned(),
    }
}

/// The same where coefficients are enclosed.
fn residual_within(enclosed: Option<Enclosed>, checked_orders: Option<usize>) -> String {
    let (Some(enclosed), Some(last)) = (enclosed, checked_orders) else {
        return residual(checked_orders);
    };
    format!(
        "Coefficients within {:.1e}. Residual: the expansion substituted into the equation encloses zero at orders 0 to {last}, \
         within {:.1e}.",
        enclosed.radius, enclosed.residual
    )
}

/// A slow flow with what is written of it.
struct Board<'a> {
    value: &'a SlowFlow,
    pen: Pen,
}

impl Board<'_> {
    fn page(&self) -> Document {
        let problem = &self.value.problem;
        let page = head(problem).formula(equation(problem));
        self.checks(self.polar(self.flow(self.system(page))))
    }

    /// z, or z_2 of several unknowns.
    fn indexed(&self, stem: &str, j: usize) -> String {
        if self.value.unknowns() == 1 { stem.to_owned() } else { format!("{stem}_{}", j + 1) }
    }

    /// u_n, or u_{jn} of several unknowns.
    fn order(&self, stem: &str, j: usize, n: usize, style: Style) -> String {
        let index = if self.value.unknowns() == 1 { String::new() } else { (j + 1).to_string() };
        print_name(&format!("{stem}_{index}{n}"), style)
    }

    fn polynomial(&self, terms: &Terms, style: Style) -> String {
        shortened(self.value.print(terms, style), style)
    }

    /// The unknowns, their modes, the force.
    fn system(&self, mut page: Document) -> Document {
        let (flow, pen) = (self.value, self.pen);
        let amplitude = "Normalisation: z is the complex amplitude of the first harmonic: corrections have none.";
        page = page.words(amplitude);
        for i in 0..flow.system.shapes.as_ref().map_or(0, Vec::len) {
            page = page.formula(pen.both(|style| flow.print_shapes(style).swap_remove(i)));
        }
        if !flow.system.is_exact() {
            for (j, square) in flow.system.squares.iter().enumerate() {
                let stem = self.indexed("nu", j);
                let nu = flow.number(&flow.system.frequencies[j]);
                let square = flow.number_of_modes(square);
                page = page.formula(pen.both(|style| {
                    let name = print_name(&stem, style);
                    format!("{name}^2 = {square}, {name} = {nu}")
                }));
            }
        }
        for (j, coordinate) in flow.coordinates().iter().enumerate() {
            page = page.formula(pen.both(|style| {
                let z = ["z", "zbar"].map(|z| print_name(&self.indexed(z, j), style));
                let x = print_name(coordinate, style);
                self.series(&format!("{x} = {} + {}", z[0], z[1]), "u", j, style)
            }));
        }
        for l in 0..flow.system.forces.len() {
            let indexed = |stem: &str, style| match flow.forces() {
                1 => print_name(stem, style),
                _ => print_name(&format!("{stem}_{}", l + 1), style),
            };
            page = page.formula(pen.both(|style| {
                let (e, eta) = (indexed("E", style), indexed("eta", style));
                let rate = flow.print_force(l, style);
                match style {
                    Style::Text => format!("{e} = exp(i*{eta})   {eta}' = {rate}"),
                    Style::Latex => {
                        format!(r"{e} = e^{{i{eta}}},\quad \dot{eta} = {rate}")
                    }
                }
            }));
            if flow.print_start(l, Style::Text).is_some() {
                let start = |style| flow.print_start(l, style).unwrap_or_default();
                page = page.formula(
                    pen.both(|style| format!("{}(0) = {}", indexed("eta", style), start(style))),
                );
            }
        }
        if !flow.system.independent.is_empty() {
            let names = flow.system.independent.join(", ");
            page = page.words(format!(
                "Without a value, and independent of each other and of all numbers: {names}. Where a denominator vanishes \
                 there is a resonance, and the expansion does not hold."
            ));
        }
        page = with_unit(page, flow.system.unit.as_deref());
        let Some(beside) = &flow.system.beside else { return page };
        let [rate, at] =
            [&beside.rate, &flow.system.force()].map(|rate| flow.print_multiple(rate, Style::Text));
        let small = &flow.problem.small;
        let symbol = &beside.symbol;
        page.words(format!("{symbol} = ({rate} - {at})/{small}: the force is detuned."))
    }

    /// left + u_1 eps + ...
    fn series(&self, left: &str, stem: &str, j: usize, style: Style) -> String {
        let first = self.order(stem, j, 1, style);
        let small = print_name(&self.value.problem.small, style);
        match style {
            Style::Text => format!("{left} + {first}*{small} + ..."),
            Style::Latex => format!(r"{left} + {first}\,{small} + \dots"),
        }
    }

    /// f_n and u_n, order by order.
    fn flow(&self, mut page: Document) -> Document {
        let flow = self.value;
        for j in 0..flow.unknowns() {
            page = page.formula(self.pen.both(|style| {
                let z = print_name(&self.indexed("z", j), style);
                let left =
                    if style == Style::Text { format!("{z}'") } else { format!(r"\dot {z}") };
                let rate = self.polynomial(&flow.flow[j][0], style);
                self.series(&format!("{left} = {rate}"), "f", j, style)
            }));
        }
        for n in 0..=flow.order {
            for j in 0..flow.unknowns() {
                let lists = [("f", &flow.flow[j][n]), ("u", &flow.solution[j][n])];
                for (stem, terms) in lists.into_iter().skip(usize::from(n == 0)) {
                    page = page.formula(self.pen.both(|style| {
                        let left = self.order(stem, j, n, style);
                        format!("{left} = {}", self.polynomial(terms, style))
                    }));
                }
            }
        }
        page
    }

    /// a' and a gamma', or a psi', of one unknown.
    fn polar(&self, page: Document) -> Document {
        let Some(Polar { slow, amplitude, phase }) = self.value.polar() else { return page };
        let gamma = |style| {
            let [t, s] = slow?;
            let turns = [(t, "eta"), (s, "psi")].map(|(n, phase)| print_turns(n, phase, style));
            Some(turns.join(" - "))
        };
        let ansatz = self.pen.both(|style| match (style, gamma(style)) {
            (Style::Text, None) => "z = a/2*exp(i*psi)".to_owned(),
            (Style::Text, Some(gamma)) => format!("z = a/2*exp(i*psi)   gamma = {gamma}"),
            (Style::Latex, None) => r"z = \frac{a}{2}\,e^{i\psi}".to_owned(),
            (Style::Latex, Some(gamma)) => {
                format!(r"z = \frac{{a}}{{2}}\,e^{{i\psi}},\quad \gamma = {gamma}")
            }
        });
        // In the frame of the force nothing is left at order zero.
        let (second, nu) = match slow {
            Some(_) => (["a*gamma'", r"a\,\dot\gamma"], None),
            None => (["a*psi'", r"a\,\dot\psi"], self.value.system.frequencies.first()),
        };
        let rates = [(["a'", r"\dot a"], None, &amplitude), (second, nu, &phase)];
        let mut page = page.heading("Polar form").formula(ansatz);
        for (left, nu, orders) in rates {
            page = page.formula(self.pen.both(|style| {
                let rate = self.value.print_rate(nu.cloned(), orders, style);
                let left = left[usize::from(style == Style::Latex)];
                format!("{left} = {}", shortened(rate, style))
            }));
        }
        page
    }

    /// The energy and the quadratic invariants, where there are any.
    fn conserved(&self, mut page: Document) -> Document {
        let orders = &self.value.energy;
        for (n, terms) in orders.iter().enumerate() {
            page = page.formula(self.pen.both(|style| {
                format!(
                    "{} = {}",
                    print_name(&format!("H_{n}"), style),
                    self.polynomial(terms, style)
                )
            }));
        }
        for form in self.value.quadratic_invariants() {
            page = page.formula(
                self.pen.both(|style| format!("Q = {}", self.polynomial(&form.terms, style))),
            );
            let last = match form.orders {
                1 => String::new(),
                n => format!(" to f_{n}"),
            };
            page = page
                .words(format!("Quadratic invariant: Q is conserved by f_1{last}, identically."));
        }
        if orders.is_empty() {
            return page;
        }
        page.words(format!(
            "Energy: H_0 + H_1*{} + ... is conserved by the flow, identically at orders 0 to {}.",
            self.value.problem.small,
            orders.len() - 1
        ))
    }

    fn checks(&self, page: Document) -> Document {
        let mut page = self.conserved(page);
        if let Some(near) = self.value.nearest() {
            let unknown = &self.value.coordinates()[near.unknown];
            let (size, order) = (self.value.size(&near.size), near.order);
            let harmonic: Vec<String> = near.harmonic.iter().map(ToString::to_string).collect();
            let harmonic = harmonic.join(", ");
            page = page.words(format!(
                "Nearest divisor: {size} of the square of the frequency of {unknown}, harmonic ({harmonic}), \
                 order {order}."
            ));
        }
        page.words(residual_within(self.value.enclosed, self.value.checked_orders))
    }
}
