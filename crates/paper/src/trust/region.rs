//! Section 2: the region of (17) against the stability of the delayed system.

use super::super::vibro_impact::{Sample, unstable_example};
use super::super::{Reader, Section, Verdict};
use super::{ESTIMATED, Finding, percent};
use crate::Text;
use crate::text::texts;
use lindstedt::Error;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::chart::{Axis, Chart, Plan, Predictor, Swept, chart};
use lindstedt_impact::prediction::Variant;
use serde::Serialize;

/// The plane of the gains A, B of one orbit, for one reading of (17).
#[derive(Clone, Debug)]
pub struct RegionChart {
    /// The reading.
    pub rule: &'static str,
    /// The verdicts: predicted, and by the zeros of G with the mean kick, which is the truth for B = 0
    /// and nearly so otherwise.
    pub chart: Chart,
}

/// How the region of (17) compares with the truth. Everything is estimated (doubles).
#[derive(Clone, Debug, Serialize)]
pub struct Region {
    /// The sample.
    #[serde(flatten)]
    pub sample: Sample,
    /// The orbit of the charts: the first of the sample that is unstable without the loop.
    #[serde(rename = "chart_orbit")]
    pub orbit: Text,
    /// The formulas (6), (7), (15), (16), (17), as far as they hold as printed.
    #[serde(skip)]
    pub formulas: Vec<String>,
    /// Two readings over the same plane: the orbit of (8) itself, the true orbit.
    #[serde(skip)]
    pub charts: Vec<RegionChart>,
    /// The class of the numbers.
    pub status: &'static str,
}

/// The largest gain of the charts.
const REACH: f64 = 0.3;

/// Draws the charts; the sample was counted before.
pub(in super::super) fn read(
    reader: &mut Reader<'_>,
    section: &mut Section,
) -> Result<bool, Error> {
    let Some(sample) = reader.sample.take() else { return Ok(true) };
    let Some((orbit, base)) = unstable_example() else { return Ok(true) };
    let holds = |number: &String| {
        let mut own = section.rows.iter().filter(|row| row.label.ends_with(number.as_str()));
        own.all(|row| row.verdict == Verdict::Agrees || row.label.starts_with("below"))
    };
    let formulas = [6, 7, 15, 16, 17].map(|n| format!("({n})")).into_iter().filter(holds).collect();
    let count = reader.options.chart.max(2);
    let axis = |parameter| Axis { parameter, low: -REACH, high: REACH, count };
    let mut charts = Vec::new();
    for (rule, variant) in [(OWN, Variant::E), (TRUE, Variant::S)] {
        let plan = Plan {
            columns: axis(Swept::DisplacementGain),
            rows: axis(Swept::VelocityGain),
            predictor: Some((Predictor::Kbm(variant), 1)),
            exact: Some(Kick::Mean),
            radius: false,
            part: None,
        };
        let chart = chart(&base, &plan, &|_| true).map_err(|_| Error::NoValue)?;
        charts.push(RegionChart { rule, chart });
    }
    reader.trust.region = Some(Region { sample, orbit, formulas, charts, status: ESTIMATED });
    Ok(true)
}

/// The rules, by the names of the table of agreement.
const OWN: &str = "(17), own orbit";
const TRUE: &str = "(17), true orbit";
const LETTER: &str = "(17), letter";

impl Region {
    pub(super) fn finding(&self) -> Finding {
        let share = |rule: &str| percent(self.sample.share(rule));
        let charts = self.charts.iter().map(|c| {
            let found = c.chart.agreement();
            format!(
                "{}: {} ({} points predicted stable are unstable, {} the other way round)",
                c.rule,
                percent(found.rate()),
                found.false_stable,
                found.false_unstable
            )
        });
        Finding {
            section: 2,
            method: "KBM with the delay loop, stability by (17)".into(),
            trusted: texts([
                format!(
                    "the formulas {}, read with the amplitude $a = F$ and not with that printed in \
                     (8): (6) and (7), without an amplitude, are the first order in the loop, (15) \
                     to (17) are exact for the motion (8)",
                    self.formulas.join(", ")
                ),
                format!(
                    "the characteristic function $G$, where $z(t - T) = z(t)/gamma$ takes the impact \
                     inside the delay into account: right at {} of {} points, {} orbits (for $B = 0$ \
                     it defines the truth; $B$ other than 0 tests it)",
                    share("G"),
                    self.sample.points,
                    super::super::vibro_impact::SAMPLED
                ),
            ]),
            not_trusted: texts([
                format!(
                    "the region of (17) as the stability region of (1): the true verdict at {} of \
                     the points to the letter, {} with the orbit of (8) itself (of the {} points where \
                     it exists), {} with the true orbit; to ignore the loop is right at {}",
                    share(LETTER),
                    share(OWN),
                    self.sample.compared(OWN),
                    share(TRUE),
                    share("no loop")
                ),
                format!("the sign of $R$ as a rule, which the paper does not claim: {}", share("R < 0")),
                format!(
                    "in the plane of the gains of {}, against the zeros of $G$ with the mean kick: {}",
                    self.orbit.marked(),
                    charts.collect::<Vec<_>>().join("; ")
                ),
            ]),
            class: "estimated: doubles; zeros of $G$ on the unit disc by their winding number; in the \
                    sample the growth of the piecewise linear return map for $B$ other than 0, in the \
                    plane of the gains zeros of $G$ throughout".into(),
        }
    }
}
