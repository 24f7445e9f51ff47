//! The orbit as a theorem.

use super::Present;
use crate::{Document, Text};
use lindstedt::evaluate::{ProofVerdict, ProvedOrbit};
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
    fn document(&self) -> Document {
        let value = &self.value;
        let values: Vec<String> =
            self.header.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        let title = match &values[..] {
            [] => self.header.problem.clone(),
            _ => format!("{}: {}", self.header.problem, values.join(", ")),
        };
        let page = orbit(Document::titled(title), value);
        let others = value.further.len();
        let page = match others {
            0 => page,
            1 => page.words("One more orbit at the same values (there may be others):"),
            _ => page
                .words(format!("{others} more orbits at the same values (there may be others):")),
        };
        value.further.iter().fold(page, orbit)
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
    let page = page.lines(known.chain(exponents));
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
