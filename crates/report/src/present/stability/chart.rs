//! The chart of an impact orbit: in characters, as a figure, as a table.

use super::super::parameter;
use crate::figure::{Colour, Mark, Raster, colours};
use crate::format::line;
use crate::{Figure, Table, Text};
use lindstedt::Answer;
use lindstedt::stability::{Chart, OrbitStability};
use lindstedt::unstable::impact::chart::{Agreement, LeftOut, Point};
use lindstedt::unstable::impact::map::Verdict;

/// The largest chart in characters.
const WIDEST: usize = 100;
const TALLEST: usize = 50;

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

/// All of them: sign, colour.
const STANDS: [(Stands, char, Option<Colour>); 7] = [
    (Stands::BothStable, '#', Some(colours::VERDICTS[0])),
    (Stands::BothUnstable, '.', Some(colours::VERDICTS[1])),
    (Stands::FalseStable, '!', Some(colours::VERDICTS[2])),
    (Stands::FalseUnstable, 'o', Some(colours::VERDICTS[3])),
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
pub(super) fn summary(chart: &Chart) -> String {
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
    let [(_, columns), (_, rows)] = chart.values();
    let points = match (chart.grid.points.len(), columns.len() * rows.len()) {
        (some, all) if some < all => format!("{some} of {all}"),
        (all, _) => all.to_string(),
    };
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
pub(super) fn picture(chart: &Chart) -> Option<String> {
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

/// Where prediction and truth agree and where not, the flip curve, the point.
pub(super) fn figure(answer: &Answer<OrbitStability>) -> Option<Figure> {
    let chart = answer.value.grid.as_ref()?;
    let rows = chart.grid.rows.as_ref()?;
    let columns = &chart.grid.columns;
    if !columns.is_equidistant() || !rows.is_equidistant() {
        return None;
    }
    let prediction = match &answer.value.kbm {
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
    let [across, up] = [&columns.name, &rows.name].map(|name| parameter(&answer.header, name));
    let cross = format!("cross: {} = {x}, {} = {y}", columns.name, rows.name);
    let names = [&columns.name, &rows.name];
    let fixed = answer.header.at.iter().filter(|(name, _)| !names.contains(&name));
    let fixed: Vec<(String, String)> = fixed.cloned().collect();
    let mut figure = Figure {
        raster: Some(raster),
        footer: super::listed(&fixed, ",  "),
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

/// The names of the columns, then every point with both verdicts; whether `take` took all.
fn rows(chart: &Chart, take: &mut dyn FnMut(&[&str]) -> bool) -> bool {
    let [(first, columns), (second, rows)] = chart.values();
    let two = chart.grid.rows.is_some();
    let word = |verdict: Option<Verdict>| match verdict {
        Some(Verdict::Stable) => "stable",
        Some(Verdict::Unstable) => "unstable",
        Some(Verdict::Neutral) => "undecided",
        None => "",
    };
    let [columns, rows] =
        [columns, rows].map(|axis| axis.iter().map(f64::to_string).collect::<Vec<_>>());
    let mut line = |[x, y, kbm, exact]: [&str; 4]| match two {
        true => take(&[x, y, kbm, exact]),
        false => take(&[x, kbm, exact]),
    };
    let places = rows.iter().flat_map(|y| columns.iter().map(move |x| (x, y)));
    let points = chart.grid.points.iter().map(|point| point.unwrap_or(Point::EMPTY));
    line([first, second, "kbm", "exact"])
        && places
            .zip(points)
            .all(|((x, y), point)| line([x, y, word(point.predicted), word(point.exact)]))
}

/// Every point with both verdicts.
pub(super) fn table(chart: &Chart) -> Option<Table> {
    let mut lines: Vec<Vec<Text>> = Vec::new();
    rows(chart, &mut |cells| {
        lines.push(cells.iter().copied().map(Text::from).collect());
        true
    });
    let columns = lines.drain(..1).next()?;
    Some(Table { columns, rows: lines })
}

/// The same as comma-separated values: a chart may have millions of points.
pub(super) fn csv(chart: &Chart, take: &mut dyn FnMut(&str) -> bool) -> bool {
    rows(chart, &mut |cells| take(&line(cells)))
}

/// The cells of a chart, with a legend of what occurs.
fn raster(chart: &Chart) -> Option<Raster> {
    let [(_, columns), (_, rows)] = chart.values();
    let at = |index: usize| Some(stands(chart.grid.points.get(index)?.as_ref(), chart));
    let own: Vec<Option<Stands>> = Raster::cells((columns.len(), rows.len()), at);
    let colour = |own: &Option<Stands>| STANDS.iter().find(|(known, ..)| Some(*known) == *own)?.2;
    let present = STANDS.iter().filter(|(known, ..)| own.contains(&Some(*known)));
    let mut legend: Vec<(String, Option<Colour>)> =
        present.map(|(known, _, colour)| (label(*known, chart).to_owned(), *colour)).collect();
    legend.sort();
    let range = |values: &[f64]| Some((*values.first()?, *values.last()?, values.len()));
    let cells = own.iter().map(colour).collect();
    Some(Raster { columns: range(&columns)?, rows: range(&rows)?, cells, legend })
}
