//! What an equation is made of, and which methods take it.

use crate::Document;
use lindstedt::classification::{Description, shortened};

/// Terms of one kind that are listed at most.
const MOST_TERMS: usize = 40;

/// The page with a description after it.
pub(super) fn classification(page: Document, parts: Option<&Description>) -> Document {
    match parts {
        Some(parts) => page.lines(lines(parts)),
        None => page,
    }
}

/// A description, line by line.
pub(super) fn lines(parts: &Description) -> Vec<(&'static str, String)> {
    let linear = match &parts.linear {
        None => "none".to_owned(),
        Some(linear) => {
            format!("{}, frequency omega_0 = {}", shortened(linear), shortened(&parts.frequency))
        }
    };
    let mut list = vec![("linear part", linear)];
    list.extend(parts.strong.iter().take(MOST_TERMS).map(|t| ("strong term", shortened(&t.term))));
    for term in parts.weak.iter().take(MOST_TERMS) {
        let order = match term.order {
            0 => "the small parameter inside, every order from 0".to_owned(),
            order => format!("order {order}"),
        };
        list.push(("weak term", format!("{}  ({order})", shortened(&term.term))));
    }
    if parts.weak.len() > MOST_TERMS {
        list.push(("weak term", format!("... {} in all", parts.weak.len())));
    }
    list.extend(forcing(parts));
    list.extend(parts.delays.iter().map(|delay| ("delay", shortened(delay))));
    list.extend(parts.non_smooth.iter().map(|term| ("non-smooth", shortened(term))));
    if parts.impact {
        list.push(("impact", "a rigid wall".to_owned()));
    }
    let symmetry = match parts.odd {
        true if !parts.forcing.is_empty() => "odd under x -> -x, the forcing apart",
        true => "odd under x -> -x: odd harmonics only",
        false => "none: harmonics of both parities",
    };
    let backwards = if parts.reversible { "; reversible in time" } else { "" };
    list.push(("symmetry", format!("{symmetry}{backwards}")));
    list.push(("algebra", parts.algebra.to_owned()));
    for method in &parts.methods {
        let verdict = match method.applies {
            true => "applies".to_owned(),
            false if method.only_condition => "applies with --normalisation free".to_owned(),
            false => format!("no: {}", method.against.join("; ")),
        };
        list.push((method.method, verdict));
    }
    list
}

fn forcing(parts: &Description) -> impl Iterator<Item = (&'static str, String)> {
    parts.forcing.iter().map(|force| {
        let kind = if force.parametric { "parametric, " } else { "" };
        let frequency = match &force.frequency {
            Some(frequency) => format!("frequency {}", shortened(frequency)),
            None => "not harmonic".to_owned(),
        };
        let resonance = force.resonance.as_ref();
        let resonance =
            resonance.map_or(String::new(), |it| format!(", in resonance {it} with omega_0"));
        let order = force.order;
        let term = shortened(&force.term);
        ("forcing", format!("{term}  ({kind}order {order}, {frequency}{resonance})"))
    })
}
