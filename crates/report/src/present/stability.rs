//! The stability of an impact orbit: its numbers and its charts.

mod chart;

use super::{Pen, Present};
use crate::{Block, Document, Figure, Formula, Table, Text};
use lindstedt::stability::{
    Aware, Found, OrbitStability, Predicted, PredictedOrbit, TrueOrbit, Truth,
};
use lindstedt::unstable::impact::Finite;
use lindstedt::{Answer, Number};

type Line = (Text, Text);

fn line(name: impl Into<Text>, value: impl Into<Text>) -> Option<Line> {
    Some((name.into(), value.into()))
}

fn number<'a>(name: impl Into<Text>, value: impl Into<Option<&'a Number>>) -> Option<Line> {
    line(name, Text::number(value.into()?))
}

fn symbol(text: &str, latex: &str) -> Text {
    Formula::new(text, latex).into()
}

fn yes(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

/// Yes, no, or neither.
fn decided(value: Option<bool>) -> &'static str {
    value.map_or("-", yes)
}

/// An estimate: six digits are plenty.
fn double(x: f64) -> String {
    match x.abs() {
        size if size != 0.0 && !(1e-3..1e6).contains(&size) => format!("{x:.5e}"),
        _ => format!("{x:.6}"),
    }
}

fn multipliers(list: &[[Number; 2]]) -> Vec<Option<Line>> {
    let one = |[re, im]: &[Number; 2]| match im.decimal.as_str() {
        "0" | "0e0" => re.decimal.clone(),
        imaginary => format!("{} + ({imaginary})*i", re.decimal),
    };
    list.iter().map(|pair| line("multiplier", one(pair))).collect()
}

fn orbit(orbit: &Found<TrueOrbit>) -> Vec<Option<Line>> {
    let orbit = match orbit {
        Found::There(orbit) => orbit,
        Found::Missing { exists, reason } => {
            return vec![line("exists", decided(*exists)), line("reason", reason.as_str())];
        }
    };
    vec![
        line("exists", decided(orbit.exists)),
        number("impact velocity", &orbit.impact_velocity),
        number(Text::words("phase ").formula(Formula::new("phi", r"\phi")), orbit.phase.as_ref()),
        number(symbol("C", "C"), orbit.cosine.as_ref()),
        number(symbol("D", "D"), orbit.sine.as_ref()),
        line("passes through the wall", decided(orbit.penetrates)),
        line("clearance", orbit.clearance.as_ref().map_or("-".into(), Text::number)),
        number("phase of the force", &orbit.force_phase),
        number("acceleration before the impact", &orbit.acceleration_before),
        number("acceleration after the impact", &orbit.acceleration_after),
        number("saltation", &orbit.saltation),
        number("discriminant", &orbit.discriminant),
    ]
}

fn predicted_orbit(orbit: Option<&Found<PredictedOrbit>>) -> Option<Line> {
    line(
        "orbit",
        match orbit {
            None => "-".to_owned(),
            Some(Found::Missing { reason, .. }) => format!("none: {reason}"),
            Some(Found::There(orbit)) => format!(
                "impact velocity {}, phase {}, C {}, D {}",
                orbit.impact_velocity.decimal,
                orbit.phase.decimal,
                orbit.cosine.decimal,
                orbit.sine.decimal
            ),
        },
    )
}

fn predicted(kbm: &Predicted) -> Vec<Option<Line>> {
    let mut lines = vec![
        line("order", kbm.order.to_string()),
        line("variant", kbm.variant),
        number(symbol("R", "R"), kbm.growth_rate.as_ref()),
        number(symbol("alpha0", r"\alpha_0"), kbm.alpha0.as_ref()),
        number(symbol("b2", "b_2"), kbm.b2.as_ref()),
        number(symbol("b1", "b_1"), kbm.b1.as_ref()),
        number(symbol("b0", "b_0"), kbm.b0.as_ref()),
        number("trace", kbm.trace.as_ref()),
        number("determinant", kbm.determinant.as_ref()),
    ];
    lines.extend(kbm.multipliers.iter().flat_map(|list| multipliers(list)));
    let value = |x: &Option<Finite>| match x {
        Some(Finite::Number(x)) => double(*x),
        Some(Finite::Word(word)) => word.clone(),
        None => "-".to_owned(),
    };
    let convergence = &kbm.convergence;
    let (radius, ratio) = (value(&convergence.radius), value(&convergence.ratio));
    let diverges = yes(convergence.diverges);
    let words = format!("radius {radius}, ratio {ratio}, diverges {diverges} (estimated)");
    lines.extend([
        line("stable", decided(kbm.stable)),
        kbm.verdict.and_then(|verdict| line("verdict", verdict)),
        predicted_orbit(kbm.orbit.as_ref()),
        number("mismatch", kbm.mismatch.as_ref()),
        number("residual", kbm.residual.as_ref()),
        line("convergence", words),
    ]);
    lines
}

fn aware(aware: &Aware) -> Vec<Option<Line>> {
    match aware {
        Aware::Missing { reason } => vec![line("reason", reason.as_str())],
        Aware::There { multipliers: list, stable, order, .. } => {
            let mut lines = multipliers(list);
            lines.push(line("stable", decided(*stable)));
            lines.push(line("order", order.to_string()));
            lines
        }
    }
}

fn truth(exact: &Truth) -> Vec<Option<Line>> {
    let mut lines = vec![line("stable", decided(exact.stable)), line("verdict", exact.verdict)];
    lines.extend(multipliers(&exact.multipliers));
    let missing = exact.multipliers_missing.as_ref();
    let zeros = exact.zeros_in_unit_disc.map_or("-".to_owned(), |n| n.to_string());
    let growth = exact.return_map.as_ref().and_then(|map| {
        let (rate, error) = (map.growth_per_impact, map.error);
        // One digit more than the error knows.
        let places = (1.0 - error.log10()).ceil().clamp(1.0, 17.0) as usize;
        let words = format!("growth per impact {rate:.places$} +- {error:.1e} (estimated)");
        line("return map", format!("{words}, {}", map.verdict))
    });
    lines.extend([
        missing.and_then(|reason| line("no multipliers", reason.as_str())),
        exact.multipliers_of.and_then(|words| line("multipliers are", words)),
        exact.complete_to_modulus.and_then(|x| line("complete to modulus", double(x))),
        exact.kick.and_then(|_| line("zeros in the unit disc", zeros)),
        exact.kick.and_then(|kick| line("kick", kick)),
        growth,
    ]);
    lines
}

fn listed(list: &[(String, String)], between: &str) -> String {
    let parts: Vec<String> = list.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    parts.join(between)
}

impl Present for Answer<OrbitStability> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let mapped = value.exact.as_ref().is_some_and(|exact| exact.return_map.is_some());
        let truth_is = if mapped {
            "The truth: growth of the piecewise linear return map (B is not 0: the characteristic \
             function G and its multipliers are an approximation)"
        } else {
            "The truth: zeros of the characteristic function G in the unit disc"
        };
        let sections = [
            (
                "The orbit of the true system (without perturbation the loop is silent)",
                Some(orbit(&value.orbit)),
            ),
            (
                "What averaging predicts (not the stability of the delayed system)",
                value.kbm.as_ref().map(predicted),
            ),
            (
                "Averaging that knows of the impact within the delay (estimated)",
                value.impact_aware.as_ref().map(aware),
            ),
            (truth_is, value.exact.as_ref().map(truth)),
        ];
        let title = format!("{} at {}", self.header.problem, listed(&self.header.at, ", "));
        let mut page = Document::titled(title);
        if !value.canonical.is_empty() {
            let canonical = listed(&value.canonical, ", ");
            page = page.words(format!("As the oscillator of section 2: {canonical}"));
        }
        for (title, lines) in sections {
            let Some(lines) = lines else { continue };
            page = page.heading(title).lines(lines.into_iter().flatten());
        }
        let Some(chart) = &value.grid else { return page };
        let page = page.words(chart::summary(chart));
        chart::picture(chart).into_iter().fold(page, |page, text| page.with(Block::Code(text)))
    }

    fn figure(&self) -> Option<Figure> {
        chart::figure(self)
    }

    fn table(&self) -> Option<Table> {
        chart::table(self.value.grid.as_ref()?)
    }

    fn csv(&self, take: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
        Some(chart::csv(self.value.grid.as_ref()?, take))
    }
}
