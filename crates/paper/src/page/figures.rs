//! The figures of the summary, as SVG text.

use crate::trust::{Onset, OnsetPoint, Region, Truncation};
use crate::{Text, Trust};
use lindstedt_impact::chart::{Chart, Point};
use lindstedt_impact::map::Verdict;
use lindstedt_report::figure::{Axis, Colour, Mark, Raster, colours};
use lindstedt_report::{Figure, FigureError};

/// Letters stay readable when a page is narrow: the pictures are small and are scaled up.
const SIZE: (u32, u32) = (640, 420);
/// The band in which a threshold is called right.
const BAND: f64 = 0.1;

/// How a point of the plane of the gains stands, with its colour.
const STANDINGS: [(&str, Colour); 4] = [
    ("predicted stable, is stable", colours::VERDICTS[0]),
    ("predicted unstable, is unstable", colours::VERDICTS[1]),
    ("predicted stable, IS UNSTABLE", colours::VERDICTS[2]),
    ("predicted unstable, is stable", colours::VERDICTS[3]),
];

/// The cases whose truncation is drawn: their name, whether re-expanded, and the colour.
const CURVES: [(&str, bool, Colour); 5] = [
    ("n = 3", false, colours::BLUE),
    ("n = 5", false, colours::PURPLE),
    ("pendulum", false, colours::VERMILION),
    ("n = 3", true, colours::GREEN),
    ("n = 9", true, colours::ORANGE),
];

/// A figure of the summary.
pub(super) struct Drawing {
    /// Its name as a file, without ".svg".
    pub name: &'static str,
    /// The section of the paper it belongs to.
    pub section: u32,
    /// What it shows.
    pub caption: Text,
    /// The picture.
    pub svg: String,
}

/// All figures whose measurements are finished.
pub(super) fn draw(trust: &Trust) -> Result<Vec<Drawing>, FigureError> {
    let mut list = Vec::new();
    if let Some(region) = &trust.region {
        list.push(agreement(region));
        list.push(plane(region));
    }
    list.extend(trust.onset.as_ref().map(onset));
    if !trust.truncations.is_empty() {
        list.push(orders(&trust.truncations));
    }
    list.into_iter().collect()
}

type Drawn = Result<Drawing, FigureError>;

fn framed(title: &str, across: Axis, up: Axis) -> Figure {
    Figure { size: SIZE, ..Figure::new(title, across, up) }
}

/// How often each rule has the true verdict: bars.
fn agreement(region: &Region) -> Drawn {
    let rates = &region.sample.rates;
    let across = Axis::linear("share of true verdicts in percent");
    let mut figure = framed(
        "Rules against the truth",
        across,
        Axis::named("rule", rates.iter().map(|r| r.rule)),
    );
    for (n, rate) in (1u32..).zip(rates) {
        let colour = match rate.rule {
            "G" => colours::GREEN,
            rule if rule.starts_with("(17)") => colours::VERMILION,
            _ => colours::GREY,
        };
        let (share, place) = (100.0 * rate.rate, f64::from(n));
        let name = format!("{}: {share:.1} %", rate.rule);
        let bar = [(0.0, place), (share, place)];
        figure = figure.layer(Some(&name), Mark::Line(14), colour, bar);
    }
    // A rule that says something at a part of the points is judged there.
    let parts: Vec<String> = (rates.iter().filter(|rate| rate.compared < region.sample.points))
        .map(|rate| format!(" {}: of the {} points where it exists.", rate.rule, rate.compared))
        .collect();
    Ok(Drawing {
        name: "agreement",
        section: 2,
        caption: format!(
            "Share of {} points (8 orbits, gains $|A|$, $|B| <= 0.3$) at which a rule has the verdict of \
             the delayed system; {} of them are truly stable.{}",
            region.sample.points,
            region.sample.stable,
            parts.concat()
        )
        .into(),
        svg: figure.svg()?,
    })
}

/// The plane of the gains: where the region of (17) and the truth agree and where not.
fn plane(region: &Region) -> Drawn {
    let panel = |chart: &Chart, rule: &str| {
        let rate = 100.0 * chart.agreement().rate();
        let (columns, rows) = (chart.plan.columns, chart.plan.rows);
        let colour = |n: usize| STANDINGS.get(n).map(|(_, colour)| *colour);
        let point = |column, row| chart.point(column, row).and_then(standing).and_then(colour);
        let cells = (0..rows.count).flat_map(|row| (0..columns.count).map(move |c| (c, row)));
        let legend = STANDINGS.iter().map(|(word, colour)| ((*word).to_owned(), Some(*colour)));
        let raster = Raster {
            columns: (columns.low, columns.high, columns.count),
            rows: (rows.low, rows.high, rows.count),
            cells: cells.map(|(column, row)| point(column, row)).collect(),
            legend: legend.collect(),
        };
        let title = format!("{rule}: {rate:.1} %");
        let figure = framed(&title, Axis::linear("gain A"), Axis::linear("gain B"));
        let figure = figure.layer(None, Mark::Cross(5), colours::BLACK, [(0.0, 0.0)]);
        Figure { raster: Some(raster), ..figure }
    };
    let panels: Vec<Figure> =
        region.charts.iter().map(|chart| panel(&chart.chart, chart.rule)).collect();
    let silent = region.charts.iter().any(|c| c.chart.points.iter().any(|p| standing(p).is_none()));
    Ok(Drawing {
        name: "region",
        section: 2,
        caption: format!(
            "The plane of the gains for {}, the first of the sample that is unstable without the \
             loop: (17) against the zeros of $G$ with the mean kick. The cross is the orbit without loop.{}",
            region.orbit.marked(),
            if silent { " White: (17) predicts nothing, its orbit does not exist." } else { "" }
        )
        .into(),
        svg: Figure::panels(&panels.iter().collect::<Vec<_>>())?,
    })
}

fn standing(point: &Point) -> Option<usize> {
    use Verdict::{Stable, Unstable};
    match (point.predicted?, point.exact?) {
        (Stable, Stable) => Some(0),
        (Unstable, Unstable) => Some(1),
        (Stable, Unstable) => Some(2),
        (Unstable, Stable) => Some(3),
        _ => None,
    }
}

/// Marks of the curves in their order: they are told apart without colours.
const MARKS: [Mark; 5] =
    [Mark::Disc(4), Mark::Triangle(5), Mark::Cross(4), Mark::Ring(4), Mark::Square(4)];

/// The figure with points that are joined by a line.
fn curve(figure: Figure, name: &str, colour: Colour, points: &[(f64, f64)]) -> Figure {
    let points = || points.iter().copied();
    let mark = MARKS[(figure.layers.len() / 2) % MARKS.len()];
    let figure = figure.layer(None, Mark::Line(2), colour, points());
    figure.layer(Some(name), mark, colour, points())
}

/// The first tangency of both loops as eps grows, beside Melnikov's threshold.
fn onset(onset: &Onset) -> Drawn {
    let side = |pick: fn(&OnsetPoint) -> Option<(f64, f64)>| -> Vec<(f64, f64)> {
        onset.points.iter().filter_map(|p| Some((p.eps, pick(p)?.0))).collect()
    };
    let last = onset.points.last().map_or(1.0, |p| p.eps);
    let level = |factor: f64| [(0.0, factor * onset.threshold), (last, factor * onset.threshold)];
    let up = Axis::linear("gamma at the tangency");
    let mut figure = framed("Where the tangle begins", Axis::linear("eps"), up).layer(
        Some("threshold (27)"),
        Mark::Line(2),
        colours::GREY,
        level(1.0),
    );
    for factor in [1.0 - BAND, 1.0 + BAND] {
        figure = figure.layer(Some("within 10 %"), Mark::Dashed(1), colours::GREY, level(factor));
    }
    figure = curve(figure, "right loop", colours::VERMILION, &side(|p| p.right));
    figure = curve(figure, "left loop", colours::BLUE, &side(|p| p.left));
    Ok(Drawing {
        name: "onset",
        section: 3,
        caption: "The homoclinic tangency of the stick-slip oscillator that is the first one at small \
                  $eps$, followed to $eps = 1$, where on the left loop others have come before it, against \
                  Melnikov's threshold, which does not depend on $eps$ ($a = b = 1$, $alpha = beta = T0 = \
                  0.3$, $omega = 2$, $v* = 0.4$)."
            .into(),
        svg: figure.svg()?,
    })
}

/// The true error of the period against the order of the delta expansion.
fn orders(list: &[Truncation]) -> Drawn {
    let up = Axis::logarithmic("relative error of T");
    let title = "Error of the period by the small delta method";
    let mut figure = framed(title, Axis::linear("order N"), up);
    for (name, resummed, colour) in CURVES {
        let Some(found) = list.iter().find(|t| t.name == name) else { continue };
        let errors = if resummed { &found.resummed } else { &found.errors };
        let points = errors.iter().enumerate().map(|(n, error)| (n as f64, error.max(1e-300)));
        let word = if resummed { format!("{name}, in u") } else { name.to_owned() };
        figure = curve(figure, &word, colour, &points.collect::<Vec<_>>());
    }
    Ok(Drawing {
        name: "orders",
        section: 4,
        caption: "True error of the period cut off after order $N$; the curves in $u$: the same coefficients \
                  re-expanded in $u = delta/(1 + delta)$ with the factor $sqrt(1 - u)$."
            .into(),
        svg: figure.svg()?,
    })
}
