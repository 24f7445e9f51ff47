//! The stability of an impact orbit: its numbers and its charts.

use super::Present;
use crate::figure::{Axis, Colour, Mark, Raster, colours};
use crate::{Block, Document, Figure, Formula, Table, Text};
use lindstedt::averaging::Finite;
use lindstedt::impact::chart::{Agreement, LeftOut, Point};
use lindstedt::impact::map::Verdict;
use lindstedt::stability::{
    Aware, Chart, Found, OrbitStability, Predicted, PredictedOrbit, TrueOrbit, Truth,
};
use lindstedt::{Answer, Number};

/// The largest chart in characters.
const WIDEST: usize = 100;
const TALLEST: usize = 50;

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
        Found::Missing { reason, .. } => {
            return vec![line("exists", "no"), line("reason", reason.as_str())];
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
        // A difference of two doubles that agree says nothing of digits.
        let spread = match map.spread {
            0.0 => String::new(),
            spread => format!(", spread {}", double(spread)),
        };
        let rate = double(map.growth_per_impact);
        line("return map", format!("growth per impact {rate}{spread} (estimated), {}", map.verdict))
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

/// How a point stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stands {
    BothStable,
    BothUnstable,
    FalseStable,
    FalseUnstable,
    /// Only one of the two was asked for or exists.
    OnlyStable,
    OnlyUnstable,
    Open,
}

/// All of them: sign, colour; colours differ in brightness and for colour-blind readers.
const STANDS: [(Stands, char, Option<Colour>); 7] = [
    (Stands::BothStable, '#', Some(colours::GREEN)),
    (Stands::BothUnstable, '.', Some((226, 226, 226))),
    (Stands::FalseStable, '!', Some(colours::VERMILION)),
    (Stands::FalseUnstable, 'o', Some(colours::SKY)),
    (Stands::OnlyStable, '#', Some((160, 214, 180))),
    (Stands::OnlyUnstable, '.', Some((240, 240, 240))),
    (Stands::Open, '?', None),
];

fn stands(point: Option<&Point>, chart: &Chart) -> Stands {
    use Verdict::{Neutral, Stable, Unstable};
    let Some(point) = point else { return Stands::Open };
    // Where the true orbit does not exist a prediction is about nothing.
    if chart.asked[1] && point.exact.is_none() {
        return Stands::Open;
    }
    match (point.predicted, point.exact) {
        (Some(Neutral), _) | (_, Some(Neutral)) | (None, None) => Stands::Open,
        (Some(Stable), Some(Stable)) => Stands::BothStable,
        (Some(Unstable), Some(Unstable)) => Stands::BothUnstable,
        (Some(Stable), Some(Unstable)) => Stands::FalseStable,
        (Some(Unstable), Some(Stable)) => Stands::FalseUnstable,
        (Some(Stable), None) | (None, Some(Stable)) => Stands::OnlyStable,
        (Some(Unstable), None) | (None, Some(Unstable)) => Stands::OnlyUnstable,
    }
}

fn label(stands: Stands, chart: &Chart) -> &'static str {
    let [predicted, exact] = chart.asked;
    match stands {
        Stands::BothStable => "predicted stable, is stable",
        Stands::BothUnstable => "predicted unstable, is unstable",
        Stands::FalseStable => "predicted stable, IS UNSTABLE",
        Stands::FalseUnstable => "predicted unstable, is stable",
        Stands::OnlyStable if !exact => "predicted stable",
        Stands::OnlyUnstable if !exact => "predicted unstable",
        Stands::OnlyStable if !predicted => "stable",
        Stands::OnlyUnstable if !predicted => "unstable",
        Stands::OnlyStable => "stable, no predicted orbit",
        Stands::OnlyUnstable => "unstable, no predicted orbit",
        Stands::Open => "undecided or no orbit",
    }
}

/// How prediction and truth compare, in one line.
fn summary(chart: &Chart) -> String {
    let Agreement { compared, equal, false_stable, false_unstable } = chart.agreement.agreement;
    let LeftOut { penetrating, no_orbit, no_prediction, undecided } = chart.agreement.left_out;
    let counts = [
        ("no orbit", no_orbit),
        ("flight through the wall", penetrating),
        ("no prediction", no_prediction),
        ("undecided", undecided),
    ];
    let some = counts.iter().filter(|(_, count)| *count > 0);
    let list: Vec<String> = some.map(|(why, count)| format!("{why} {count}")).collect();
    let rest = match list.as_slice() {
        [] => String::new(),
        list => format!("; the rest: {}", list.join(", ")),
    };
    let points = chart.grid.points.len();
    if compared == 0 {
        return format!("chart: {points} points; prediction and truth were not compared{rest}");
    }
    format!(
        "chart: {points} points, {compared} compared: prediction and truth agree in {equal} \
         ({:.1} %); predicted stable but unstable {false_stable}, predicted unstable but stable \
         {false_unstable}{rest}",
        100.0 * chart.agreement.agreement.rate(),
    )
}

/// The chart in characters, the largest row value on top, with a legend; nothing where it does not
/// fit on a screen.
fn picture(chart: &Chart) -> Option<String> {
    let [(first, columns), (second, rows)] = chart.values();
    let fits = chart.finished && columns.len() <= WIDEST && rows.len() <= TALLEST;
    let (low, high) = columns.first().zip(columns.last()).filter(|_| fits)?;
    let mut text = format!("{first} from {low} to {high}\n");
    let sign = |point: &Option<Point>| {
        let own = stands(point.as_ref(), chart);
        STANDS.iter().find(|(known, ..)| *known == own).map_or('?', |(_, sign, _)| *sign)
    };
    for (value, line) in rows.iter().zip(chart.grid.points.chunks(columns.len())).rev() {
        let signs: String = line.iter().map(sign).collect();
        let name =
            chart.grid.rows.as_ref().map_or(String::new(), |_| format!("{second} = {value:.6}"));
        text += &format!("{name:<20} {signs}\n");
    }
    text += match chart.asked {
        [true, true] => {
            "# both stable, . both unstable, ! predicted stable but unstable, o predicted unstable \
             but stable, ? open"
        }
        _ => "# stable, . unstable, ? open",
    };
    Some(text)
}

fn listed(list: &[(String, String)], between: &str) -> String {
    let parts: Vec<String> = list.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    parts.join(between)
}

impl Present for Answer<OrbitStability> {
    fn document(&self) -> Document {
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
        let page = page.words(summary(chart));
        picture(chart).into_iter().fold(page, |page, text| page.with(Block::Code(text)))
    }

    /// Where prediction and truth agree and where not, the flip curve, the point.
    fn figure(&self) -> Option<Figure> {
        let chart = self.value.grid.as_ref()?;
        let rows = chart.grid.rows.as_ref()?;
        let columns = &chart.grid.columns;
        if !columns.is_equidistant() || !rows.is_equidistant() {
            return None;
        }
        let prediction = match &self.value.kbm {
            Some(kbm) => format!("averaging of order {}, variant {}", kbm.order, kbm.variant),
            None => "exact".to_owned(),
        };
        let agreement = match chart.agreement.agreement {
            Agreement { compared: 0, .. } => String::new(),
            some => format!("; verdicts agree at {:.1} % of the points", 100.0 * some.rate()),
        };
        let title = format!("Stability of the impact orbit: {prediction}{agreement}");
        let raster = raster(chart)?;
        let (x, y) = (*chart.point.first()?, *chart.point.get(1)?);
        let inside = |x: f64, (low, high, count): (f64, f64, usize)| {
            let half = 0.5 * (high - low) / (count.max(2) - 1) as f64;
            (low - half..high + half).contains(&x)
        };
        let shown = inside(x, raster.columns) && inside(y, raster.rows);
        let [across, up] = [&columns.name, &rows.name].map(Axis::linear);
        let cross = format!("cross: {} = {x}, {} = {y}", columns.name, rows.name);
        let names = [&columns.name, &rows.name];
        let fixed = self.header.at.iter().filter(|(name, _)| !names.contains(&name));
        let fixed: Vec<(String, String)> = fixed.cloned().collect();
        let mut figure = Figure {
            raster: Some(raster),
            footer: listed(&fixed, ",  "),
            size: (960, 720),
            ..Figure::new(title, across, up)
        };
        if !chart.flip.is_empty() {
            let name = "dots: flip, a multiplier at -1 (G(-1) = 0)";
            let flip = chart.flip.iter().copied();
            figure = figure.layer(Some(name), Mark::Disc(2), colours::BLACK, flip);
        }
        let point = shown.then_some((x, y));
        Some(figure.layer(Some(&cross), Mark::Cross(7), colours::BLACK, point))
    }

    fn table(&self) -> Option<Table> {
        let chart = self.value.grid.as_ref()?;
        let [(first, columns), (second, rows)] = chart.values();
        let two = chart.grid.rows.is_some();
        let word = |verdict: Option<Verdict>| match verdict {
            Some(Verdict::Stable) => "stable",
            Some(Verdict::Unstable) => "unstable",
            Some(Verdict::Neutral) => "undecided",
            None => "",
        };
        let head = [first, second].into_iter().take(if two { 2 } else { 1 });
        let mut table = Table::new(head.chain(["kbm", "exact"]));
        for (index, point) in chart.grid.points.iter().enumerate() {
            let place = [columns.get(index % columns.len())?, rows.get(index / columns.len())?];
            let place = place.into_iter().take(if two { 2 } else { 1 }).map(|x| x.to_string());
            let verdicts = [point.and_then(|p| p.predicted), point.and_then(|p| p.exact)];
            let verdicts = verdicts.map(|verdict| word(verdict).to_owned());
            table = table.row(place.chain(verdicts).collect::<Vec<_>>());
        }
        Some(table)
    }
}

/// The cells of a chart, with a legend of what occurs.
fn raster(chart: &Chart) -> Option<Raster> {
    let [(_, columns), (_, rows)] = chart.values();
    let own: Vec<Stands> =
        chart.grid.points.iter().map(|point| stands(point.as_ref(), chart)).collect();
    let colour = |own: &Stands| STANDS.iter().find(|(known, ..)| known == own)?.2;
    let present = STANDS.iter().filter(|(known, ..)| own.contains(known));
    let mut legend: Vec<(String, Option<Colour>)> =
        present.map(|(known, _, colour)| (label(*known, chart).to_owned(), *colour)).collect();
    legend.sort();
    let range = |values: &[f64]| Some((*values.first()?, *values.last()?, values.len()));
    let cells = own.iter().map(colour).collect();
    Some(Raster { columns: range(&columns)?, rows: range(&rows)?, cells, legend })
}
