//! Charts: two parameters, the prediction and the truth at every point.

use super::known::Computed;
use super::request::{Request, Sweep};
use crate::failure::{Failure, UNDECIDED};
use crate::session::Session;
use lindstedt::Exact;
use lindstedt::number::real::Real;
use lindstedt_impact::ImpactError;
use lindstedt_impact::chart::{Agreement, Axis, Chart, LeftOut, Plan, Point, Swept, chart};
use lindstedt_impact::flip::flip_boundary;
use lindstedt_impact::map::Verdict;
use rayon::prelude::*;
use rug::Rational;
use serde_json::{Value as Json, json};
use std::fmt::Write;

/// Bits of the flip curve.
const FLIP_BITS: u32 = 96;
/// At most so many points of the flip curve are computed.
const FLIP_POINTS: usize = 201;
/// The largest chart in characters.
const WIDEST: usize = 100;
const TALLEST: usize = 50;

pub struct Grid {
    pub names: [String; 2],
    /// Whether both axes are swept, not one.
    pub two: bool,
    /// The values along both axes.
    pub values: [Vec<f64>; 2],
    pub plan: Plan,
    pub chart: Chart,
    pub agreement: Agreement,
    /// Points (column value, row value) of the flip curve G(-1) = 0.
    pub flip: Vec<(f64, f64)>,
    pub finished: bool,
}

/// How a point stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    BothStable,
    BothUnstable,
    FalseStable,
    FalseUnstable,
    /// Only one of the two was asked for or exists.
    OnlyStable,
    OnlyUnstable,
    Open,
}

pub fn standing(point: &Point, plan: &Plan) -> Standing {
    use Verdict::{Neutral, Stable, Unstable};
    // Where the true orbit does not exist a prediction is about nothing.
    if plan.exact.is_some() && point.exact.is_none() {
        return Standing::Open;
    }
    match (point.predicted, point.exact) {
        (Some(Neutral), _) | (_, Some(Neutral)) | (None, None) => Standing::Open,
        (Some(Stable), Some(Stable)) => Standing::BothStable,
        (Some(Unstable), Some(Unstable)) => Standing::BothUnstable,
        (Some(Stable), Some(Unstable)) => Standing::FalseStable,
        (Some(Unstable), Some(Stable)) => Standing::FalseUnstable,
        (Some(Stable), None) | (None, Some(Stable)) => Standing::OnlyStable,
        (Some(Unstable), None) | (None, Some(Unstable)) => Standing::OnlyUnstable,
    }
}

fn sign(standing: Standing) -> char {
    match standing {
        Standing::BothStable | Standing::OnlyStable => '#',
        Standing::BothUnstable | Standing::OnlyUnstable => '.',
        Standing::FalseStable => '!',
        Standing::FalseUnstable => 'o',
        Standing::Open => '?',
    }
}

impl Grid {
    pub fn compute(request: &Request, session: &Session<'_>) -> Result<Option<Self>, Failure> {
        let Some(plan) = request.plan() else { return Ok(None) };
        let points = plan.columns.count.saturating_mul(plan.rows.count);
        let bytes = points.saturating_mul(size_of::<Point>()) as u64;
        if bytes > session.memory() {
            return Err(Failure {
                exit: UNDECIDED,
                code: "too-large",
                message: format!("{points} points need {bytes} bytes"),
                hint: "fewer values, or raise --limit-memory".into(),
            });
        }
        let base = request.parameters.nearest();
        let rows = plan.rows.count;
        let observer = |done: usize| {
            session.say(format!("row {done} of {rows}"));
            session.goes_on()
        };
        let second = request.sweeps.get(1);
        let other = if plan.rows.parameter == Swept::VelocityGain { "B" } else { "A" };
        let first = request.sweeps.first();
        let name = |sweep: Option<&Sweep>| sweep.map_or(other.to_owned(), |s| s.name.clone());
        let along = |sweep: Option<&Sweep>, axis: &Axis| -> Vec<f64> {
            (0..axis.count).map(|n| sweep.map_or_else(|| axis.value(n), |s| s.value(n))).collect()
        };
        let names = [name(first), name(second)];
        let values = [along(first, &plan.columns), along(second, &plan.rows)];
        let two = second.is_some();
        let found = match &request.computed {
            Some(computed) => general(request, &**computed, &plan, &observer),
            None => chart(&base, &plan, &observer),
        };
        let chart = match found {
            Ok(chart) => chart,
            // Rows are finished in any order: nothing of a stopped chart is shown.
            Err(ImpactError::Cancelled) => {
                let chart = Chart { plan, points: Vec::new() };
                let agreement = Agreement::default();
                let flip = Vec::new();
                let finished = false;
                return Ok(Some(Self {
                    names,
                    two,
                    values,
                    plan,
                    chart,
                    agreement,
                    flip,
                    finished,
                }));
            }
            Err(error) => return Err(error.into()),
        };
        let agreement = chart.agreement();
        let flip = if request.computed.is_none() { flip(request, &plan) } else { Vec::new() };
        Ok(Some(Self { names, two, values, plan, chart, agreement, flip, finished: true }))
    }

    pub fn csv(&self) -> String {
        let [first, second] = &self.names;
        let mut text = if self.two {
            format!("{first},{second},kbm,exact\n")
        } else {
            format!("{first},kbm,exact\n")
        };
        let word = |verdict: Option<Verdict>| match verdict {
            Some(Verdict::Stable) => "stable",
            Some(Verdict::Unstable) => "unstable",
            Some(Verdict::Neutral) => "undecided",
            None => "",
        };
        let width = self.plan.columns.count;
        for (index, point) in self.chart.points.iter().enumerate() {
            let [columns, rows] = &self.values;
            let x = columns.get(index % width).copied().unwrap_or(f64::NAN);
            let _ = write!(text, "{x},");
            if self.two {
                let y = rows.get(index / width).copied().unwrap_or(f64::NAN);
                let _ = write!(text, "{y},");
            }
            let _ = writeln!(text, "{},{}", word(point.predicted), word(point.exact));
        }
        text
    }

    pub fn json(&self) -> Json {
        let axis = |name: &String, values: &Vec<f64>| json!({"name": name, "values": values});
        let matrix = |verdict: &dyn Fn(&Point) -> Option<Verdict>| -> Json {
            let cell = |point: &Point| match verdict(point) {
                Some(Verdict::Stable) => json!(true),
                Some(Verdict::Unstable) => json!(false),
                _ => Json::Null,
            };
            let rows = self.chart.points.chunks(self.plan.columns.count.max(1));
            rows.map(|row| row.iter().map(cell).collect::<Json>()).collect()
        };
        json!({
            "columns": axis(&self.names[0], &self.values[0]),
            "rows": axis(&self.names[1], &self.values[1]),
            "kbm": matrix(&|point| point.predicted),
            "exact": matrix(&|point| point.exact),
            "agreement": self.agreement_json(),
            "flip": self.flip,
            "status": "estimated",
            "finished": self.finished,
        })
    }

    fn agreement_json(&self) -> Json {
        let Agreement { compared, equal, false_stable, false_unstable } = self.agreement;
        let rate = (compared > 0).then(|| self.agreement.rate());
        let left_out = self.left_out();
        json!({
            "compared": compared, "equal": equal, "rate": rate,
            "false_stable": false_stable, "false_unstable": false_unstable,
            "left_out": {
                "penetrating": left_out.penetrating, "no_orbit": left_out.no_orbit,
                "no_prediction": left_out.no_prediction, "undecided": left_out.undecided,
            },
        })
    }

    /// One line for the text formats.
    pub fn summary(&self) -> String {
        let Agreement { compared, equal, false_stable, false_unstable } = self.agreement;
        let points = self.chart.points.len();
        if compared == 0 {
            let why = self.reasons();
            return format!("chart: {points} points; prediction and truth were not compared{why}");
        }
        format!(
            "chart: {points} points, {compared} compared: prediction and truth agree in {equal} \
             ({:.1} %); predicted stable but unstable {false_stable}, predicted unstable but \
             stable {false_unstable}{}",
            100.0 * self.agreement.rate(),
            self.reasons(),
        )
    }

    /// The chart in characters, the largest row value on top, with a legend; nothing where it does not
    /// fit on a screen.
    pub fn picture(&self) -> Option<String> {
        let [columns, rows] = &self.values;
        let fits =
            !self.chart.points.is_empty() && columns.len() <= WIDEST && rows.len() <= TALLEST;
        let (low, high) = columns.first().zip(columns.last()).filter(|_| fits)?;
        let [first, second] = &self.names;
        let mut text = format!("  {first} from {low} to {high}\n");
        let lines = self.chart.points.chunks(columns.len());
        for (value, line) in rows.iter().zip(lines).rev() {
            let signs: String =
                line.iter().map(|point| sign(standing(point, &self.plan))).collect();
            let label = if self.two { format!("{second} = {value:.6}") } else { String::new() };
            let _ = writeln!(text, "  {label:<20} {signs}");
        }
        let both = self.plan.predictor.is_some() && self.plan.exact.is_some();
        text += if both {
            "  # both stable, . both unstable, ! predicted stable but unstable, \
             o predicted unstable but stable, ? open"
        } else {
            "  # stable, . unstable, ? open"
        };
        Some(text)
    }

    /// Nothing is left out where not both verdicts were asked for.
    fn left_out(&self) -> LeftOut {
        match (self.plan.predictor, self.plan.exact) {
            (Some(_), Some(_)) => self.chart.left_out(),
            _ => LeftOut::default(),
        }
    }

    /// Why points are not compared, in words.
    fn reasons(&self) -> String {
        let LeftOut { penetrating, no_orbit, no_prediction, undecided } = self.left_out();
        let counts = [
            ("no orbit", no_orbit),
            ("flight through the wall", penetrating),
            ("no prediction", no_prediction),
            ("undecided", undecided),
        ];
        let some = counts.iter().filter(|(_, count)| *count > 0);
        let list: Vec<String> = some.map(|(why, count)| format!("{why} {count}")).collect();
        if list.is_empty() { String::new() } else { format!("; the rest: {}", list.join(", ")) }
    }
}

/// A chart over parameters of a file that those of section 2 are computed from: point by point.
fn general(
    request: &Request,
    computed: &Computed,
    plan: &Plan,
    observer: &(dyn Fn(usize) -> bool + Sync),
) -> Result<Chart, ImpactError> {
    let (width, height) = (plan.columns.count, plan.rows.count);
    let empty = Point::EMPTY;
    let point = |column: usize, row: usize| -> Result<Point, ImpactError> {
        let places = request.sweeps.iter().zip([column, row]);
        let changes: Option<Vec<(&str, Exact)>> =
            places.map(|(sweep, n)| Some((sweep.name.as_str(), sweep.exact(n)?))).collect();
        let Some(parameters) = changes.and_then(|changes| computed(&changes)) else {
            return Ok(empty);
        };
        let axis = |parameter, value| Axis { parameter, low: value, high: value, count: 1 };
        let columns = axis(Swept::DisplacementGain, parameters.displacement_gain);
        let rows = axis(Swept::VelocityGain, parameters.velocity_gain);
        let one = Plan { columns, rows, ..*plan };
        let found = chart(&parameters, &one, &|_| observer(row))?;
        Ok(found.points.first().copied().unwrap_or(empty))
    };
    let mut points = Vec::with_capacity(width.saturating_mul(height));
    for row in 0..height {
        let line: Vec<Point> = (0..width)
            .into_par_iter()
            .map(
                |column| {
                    if observer(row) { point(column, row) } else { Err(ImpactError::Cancelled) }
                },
            )
            .collect::<Result<_, _>>()?;
        points.extend(line);
    }
    Ok(Chart { plan: *plan, points })
}

/// The flip curve, where A is one of the axes: A as a function of the other axis.
fn flip(request: &Request, plan: &Plan) -> Vec<(f64, f64)> {
    if plan.exact.is_none() {
        return Vec::new();
    }
    let (along, across, transposed) = match (plan.columns.parameter, plan.rows.parameter) {
        (Swept::DisplacementGain, _) => (plan.columns, plan.rows, false),
        (_, Swept::DisplacementGain) => (plan.rows, plan.columns, true),
        _ => return Vec::new(),
    };
    let (low, high) = (along.low.min(along.high), along.low.max(along.high));
    let stride = across.count.div_ceil(FLIP_POINTS).max(1);
    let steps: Vec<usize> = (0..across.count).step_by(stride).collect();
    let values = |n: usize| -> Vec<(f64, f64)> {
        let value = across.value(n);
        let Some(q) = Rational::from_f64(value) else { return Vec::new() };
        let mut parameters = request.parameters.clone();
        *parameters.slot(across.parameter) = Exact::Rational(q);
        let found = flip_boundary(&parameters, request.kick, low, high, FLIP_BITS);
        let place = |a: f64| if transposed { (value, a) } else { (a, value) };
        found.unwrap_or_default().iter().map(|a| place(a.to_f64())).collect()
    };
    steps.into_par_iter().flat_map_iter(values).collect()
}
