//! The orbit as a theorem.

use super::evaluate::time;
use super::{Pen, Present, problem_at};
use crate::figure::{Axis, Mark, colours};
use crate::{Document, Figure, Table, Text};
use lindstedt::evaluate::{ProofVerdict, ProvedOrbit, ProvedState};
use lindstedt::{Answer, Number, Status};

fn shown(number: &Number) -> String {
    let class = match number.status {
        Status::Proved => "proved",
        Status::Estimated => "estimated",
        _ => "no estimate",
    };
    match &number.error {
        Some(error) => format!("{} +- {error} ({class})", number.decimal),
        None => format!("{} ({class})", number.decimal),
    }
}

impl Present for Answer<ProvedOrbit> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let title = problem_at(&self.header);
        let page = orbit(Document::titled(title), value);
        let others = value.further.len();
        let page = match others {
            0 if !value.unknowns.is_empty() => page.words("There may be other orbits."),
            0 if value.exponent_sum.is_some() => page.words("There may be other responses."),
            0 => page,
            1 => page.words("One more orbit at the same values (there may be others):"),
            _ => page
                .words(format!("{others} more orbits at the same values (there may be others):")),
        };
        value.further.iter().fold(page, orbit)
    }

    /// x(t) of every orbit.
    fn figure(&self) -> Option<Figure> {
        let title = format!("{}: proved x(t)", self.header.problem);
        let frame = Figure::new(title, Axis::linear("t"), Axis::linear("x"));
        let orbits = self.value.all().zip(colours::CYCLE.iter().cycle());
        let figure = orbits.fold(frame, |frame, (orbit, colour)| {
            let double = |number: &Number| number.decimal.parse().unwrap_or(f64::NAN);
            let points = orbit.solution.iter().map(|state| (state.t.to_f64(), double(&state.x)));
            frame.layer(None, Mark::Line(2), *colour, points)
        });
        (!self.value.solution.is_empty()).then_some(figure)
    }

    fn table(&self) -> Option<Table> {
        let head = ["orbit", "t", "x", "x_error", "velocity", "velocity_error"].map(str::to_owned);
        let further = self.value.unknowns.iter().flat_map(|unknown| {
            let name = &unknown.name;
            ["", "_error", "_velocity", "_velocity_error"].map(|what| format!("{name}{what}"))
        });
        let head = Table::new(head.into_iter().chain(further));
        let table = self.value.all().enumerate().fold(head, |table, (index, orbit)| {
            orbit.solution.iter().fold(table, |table, state| {
                let error = |number: &Number| number.error.clone().unwrap_or_default();
                let states = numbers(state).flat_map(|n| [n.decimal.clone(), error(n)]);
                table.row([(index + 1).to_string(), time(&state.t)].into_iter().chain(states))
            })
        });
        (!self.value.solution.is_empty()).then_some(table)
    }
}

/// x, x', and the same of further unknowns.
fn numbers(state: &ProvedState) -> impl Iterator<Item = &Number> {
    let further = state.unknowns.iter().flat_map(|u| [&u.displacement, &u.velocity]);
    [&state.x, &state.velocity].into_iter().chain(further)
}

/// x and x' at the times asked for.
fn states(page: Document, value: &ProvedOrbit) -> Document {
    if value.solution.is_empty() {
        return page;
    }
    let number = |number: &Number| match &number.error {
        Some(error) => format!("{} +- {error}", number.decimal),
        None => number.decimal.clone(),
    };
    let names = value.unknowns.iter().flat_map(|unknown| {
        [format!("{} (proved)", unknown.name), format!("{}' (proved)", unknown.name)]
    });
    let head = ["t", "x (proved)", "x' (proved)"].map(str::to_owned);
    let head = Table::new(head.into_iter().chain(names));
    page.table(value.solution.iter().fold(head, |table, state| {
        table.row(std::iter::once(time(&state.t)).chain(numbers(state).map(number)))
    }))
}

/// What ties the expansion to an orbit.
fn of_the_expansion(page: Document, value: &ProvedOrbit) -> Document {
    match &value.expansion {
        None => page,
        Some(found) => page.words(match found.alone {
            true => format!(
                "The orbit of the expansion: its sum lies within {} of these Fourier coefficients, where no \
                 other orbit is.",
                found.distance.decimal
            ),
            false => format!(
                "The orbit of the expansion: Newton's method leads here from its sum, which is {} away.",
                found.distance.decimal
            ),
        }),
    }
}

/// One orbit.
fn orbit(page: Document, value: &ProvedOrbit) -> Document {
    let named = [
        ("period", &value.period),
        ("frequency", &value.frequency),
        ("x at phase 0", &value.amplitude),
        ("x' at phase 0", &value.velocity),
        ("largest x", &value.maximum),
        ("least x", &value.minimum),
        ("sum of the Floquet exponents", &value.exponent_sum),
        ("product of the multipliers", &value.multiplier_product),
    ];
    let known =
        named.into_iter().filter_map(|(name, number)| Some((name, shown(number.as_ref()?))));
    let unknowns = value.unknowns.iter().flat_map(|unknown| {
        let name = &unknown.name;
        [
            (format!("{name} at phase 0"), shown(&unknown.displacement)),
            (format!("{name}' at phase 0"), shown(&unknown.velocity)),
            (format!("largest {name}"), shown(&unknown.maximum)),
            (format!("least {name}"), shown(&unknown.minimum)),
        ]
    });
    let known = known.map(|(name, number)| (name.to_owned(), number)).chain(unknowns);
    let exponents =
        value.floquet_exponent.iter().map(|e| ("Floquet exponent".to_owned(), shown(e)));
    let page = states(page.lines(known.chain(exponents)), value);
    let page = of_the_expansion(page, value);
    match &value.proof {
        ProofVerdict::Failed { failed, why } => page
            .words(format!("Not proved ({failed}): {why}. This says nothing against the orbit.")),
        ProofVerdict::Proved { modes, weight, radius, unique_within, among, bounds } => {
            let among = among.map_or_else(String::new, |among| format!(", both among the {among}"));
            let stable = match value.stable {
                Some(true) => " It is stable.",
                Some(false) => " It is unstable.",
                None => "",
            };
            let words = format!(
                "Proved: there is exactly one periodic orbit within {} of these Fourier coefficients, and no \
                 second one within {}{among}.{stable}",
                radius.decimal, unique_within.decimal
            );
            page.words(Text::words(words)).lines([
                ("modes", modes.to_string()),
                ("weight nu", weight.to_string()),
                ("Y0", bounds.y0.decimal.clone()),
                ("Z0", format!("{:e}", bounds.z0)),
                ("Z1", format!("{:.4}", bounds.z1)),
                ("Z2", format!("{:.4}", bounds.z2)),
            ])
        }
    }
}
