//! Charts: one or two parameters, the prediction and the truth at every point.

use super::reading::stable;
use super::subject::{Range, Subject};
use crate::grid::{Axis, Grid, check_room};
use crate::{Error, Exact, Progress, Status, Work};
use lindstedt_impact::ImpactError;
use lindstedt_impact::chart::{
    self as kernel, Agreement, LeftOut, Plan, Point, Predictor, Swept, chart,
};
use lindstedt_impact::flip::flip_boundary;
use lindstedt_impact::map::Verdict;
use lindstedt_number::real::Real;
use rayon::prelude::*;
use serde::{Serialize, Serializer};

/// Bits of the flip curve.
const FLIP_BITS: u32 = 96;
/// At most so many points of the flip curve are computed.
const FLIP_POINTS: usize = 201;

/// Prediction and truth over one or two parameters, in doubles.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Chart {
    /// The verdicts; nothing where the work was stopped.
    pub grid: Grid<Point>,
    /// A parameter that is held, in the place of a second axis.
    pub held: (&'static str, f64),
    /// The values of the swept parameters at the point of the answer.
    pub point: Vec<f64>,
    /// Whether a prediction and the truth were asked for.
    pub asked: [bool; 2],
    /// How they compare, and why points were not compared.
    pub agreement: LeftOutAndAgreement,
    /// Points (column value, row value) of the flip curve G(-1) = 0.
    pub flip: Vec<(f64, f64)>,
    /// Whether every point was reached.
    pub finished: bool,
}

/// Counts of a comparison.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct LeftOutAndAgreement {
    /// Of the points that were compared.
    pub agreement: Agreement,
    /// Of the others, where both verdicts were asked for.
    pub left_out: LeftOut,
}

impl Chart {
    /// The doubles along both axes, of a held parameter its value.
    #[must_use]
    pub fn values(&self) -> [(&str, Vec<f64>); 2] {
        let axis = |axis: &'_ Axis| axis.doubles();
        let columns = &self.grid.columns;
        let rows = match &self.grid.rows {
            Some(rows) => (&*rows.name, axis(rows)),
            None => (self.held.0, vec![self.held.1]),
        };
        [(&columns.name, axis(columns)), rows]
    }
}

pub(super) fn compute(
    subject: &Subject<'_>,
    sweep: &[Range],
    work: &Work,
) -> Result<Option<Chart>, Error> {
    let Some(first) = sweep.first() else { return Ok(None) };
    let second = sweep.get(1);
    let height = second.map_or(1, |second| second.axis.part(subject.question.part).values.len());
    let points = first.axis.values.len().saturating_mul(height);
    let bytes = size_of::<Option<Point>>();
    check_room(points, bytes, work)?;
    let plan = plan(subject, sweep);
    let part = plan.part;
    let fast = sweep.iter().all(|range| is_canonical(range) && range.axis.is_equidistant());
    let grid = if fast {
        kernel(subject, sweep, &plan, work)?
    } else {
        general(subject, sweep, &plan, work)?
    };
    let finished = grid.is_complete();
    let both = plan.predictor.is_some() && plan.exact.is_some();
    let compared = || grid.points.iter().flatten();
    let agreement = Agreement::of(compared());
    let left_out = if both { LeftOut::of(compared()) } else { LeftOut::default() };
    Ok(Some(Chart {
        grid,
        held: (if plan.rows.parameter == Swept::VelocityGain { "B" } else { "A" }, plan.rows.low),
        point: sweep.iter().map(|range| range.base).collect(),
        asked: [plan.predictor.is_some(), plan.exact.is_some()],
        agreement: LeftOutAndAgreement { agreement, left_out },
        flip: if fast && finished && part.is_none() {
            flip(subject, &plan, work)
        } else {
            Vec::new()
        },
        finished,
    }))
}

/// Whether the values are those of a canonical parameter: a force or a frequency that is negative belongs to others.
fn is_canonical(range: &Range) -> bool {
    range.known.is_some_and(|known| match known {
        Swept::Force | Swept::Omega | Swept::Alpha => {
            range.axis.doubles().iter().all(|value| *value > 0.0)
        }
        _ => true,
    })
}

/// The question to the kernel; what is no canonical parameter has an axis in name only.
fn plan(subject: &Subject<'_>, sweep: &[Range]) -> Plan {
    let question = subject.question;
    let axis = |range: &Range| {
        let values = range.axis.doubles();
        let end = |x: Option<&f64>| x.copied().unwrap_or(range.base);
        let (low, high, count) = (end(values.first()), end(values.last()), values.len());
        let parameter = range.known.unwrap_or(Swept::VelocityGain);
        kernel::Axis { parameter, low, high, count }
    };
    let columns = sweep.first().map_or(single(Swept::VelocityGain, 0.0), axis);
    let base = subject.found.parameters.nearest();
    let held = if columns.parameter == Swept::VelocityGain {
        single(Swept::DisplacementGain, base.displacement_gain)
    } else {
        single(Swept::VelocityGain, base.velocity_gain)
    };
    let predictor = if question.impact_aware {
        Predictor::ImpactAware(question.kick)
    } else {
        Predictor::Kbm(question.variant)
    };
    Plan {
        columns,
        rows: sweep.get(1).map_or(held, axis),
        predictor: question.predict.then_some((predictor, question.order)),
        exact: question.exact.then_some(question.kick),
        radius: question.radius,
        part: question.part.filter(|_| sweep.len() > 1),
    }
}

fn single(parameter: Swept, value: f64) -> kernel::Axis {
    kernel::Axis { parameter, low: value, high: value, count: 1 }
}

/// Over canonical parameters in equal steps: all at once.
fn kernel(
    subject: &Subject<'_>,
    sweep: &[Range],
    plan: &Plan,
    work: &Work,
) -> Result<Grid<Point>, Error> {
    let rows = plan.computed().len();
    let observer = |done: usize| work.goes_on(Progress::Parts(done, rows));
    let found = chart(&subject.found.parameters.nearest(), plan, &observer)?;
    let points = found.points.into_iter().map(Some).collect();
    let axis = |n: usize| sweep.get(n).map(|range| range.axis.clone());
    let columns = axis(0).unwrap_or(Axis { name: String::new(), values: Vec::new() });
    Ok(Grid { columns, rows: axis(1).map(|rows| rows.part(plan.part)), points })
}

/// Over parameters that the canonical ones are computed from: point by point.
fn general(
    subject: &Subject<'_>,
    sweep: &[Range],
    plan: &Plan,
    work: &Work,
) -> Result<Grid<Point>, Error> {
    let point = |first: &Exact, second: Option<&Exact>| -> Result<Point, ImpactError> {
        let names = sweep.iter().map(|range| &*range.axis.name);
        let changes: Vec<_> =
            names.zip([Some(first), second]).filter_map(|(name, v)| Some((name, v?))).collect();
        let Some(parameters) = subject.changed(&changes) else { return Ok(Point::EMPTY) };
        let columns = single(Swept::DisplacementGain, parameters.displacement_gain);
        let rows = single(Swept::VelocityGain, parameters.velocity_gain);
        let one = Plan { columns, rows, part: None, ..*plan };
        let found = chart(&parameters, &one, &|_| !work.stop.asked())?;
        found.points.first().copied().ok_or(ImpactError::Cancelled)
    };
    let axis = |n: usize| sweep.get(n).map(|range| range.axis.clone());
    let columns = axis(0).unwrap_or(Axis { name: String::new(), values: Vec::new() });
    let found = Grid::compute(columns, axis(1).map(|rows| rows.part(plan.part)), work, point);
    let refused = |point: &Result<Point, ImpactError>| match point {
        Err(ImpactError::Cancelled) | Ok(_) => None,
        Err(error) => Some(error.clone()),
    };
    match found.points.iter().flatten().find_map(refused) {
        Some(error) => Err(error.into()),
        None => Ok(found.map(Result::ok)),
    }
}

/// The flip curve, where A is one of the axes: A as a function of the other axis, as far as there is time.
fn flip(subject: &Subject<'_>, plan: &Plan, work: &Work) -> Vec<(f64, f64)> {
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
        if work.stop.asked() {
            return Vec::new();
        }
        let value = across.value(n);
        let Some(exact) = Exact::from_f64(value) else { return Vec::new() };
        let mut parameters = subject.found.parameters.clone();
        *parameters.slot(across.parameter) = exact;
        let found = flip_boundary(&parameters, subject.question.kick, low, high, FLIP_BITS);
        let place = |a: f64| if transposed { (value, a) } else { (a, value) };
        found.unwrap_or_default().iter().map(|a| place(a.to_f64())).collect()
    };
    steps.into_par_iter().flat_map_iter(values).collect()
}

/// An axis in JSON.
#[derive(Serialize)]
struct Named<'a> {
    name: &'a str,
    values: &'a [f64],
}

/// The counts in JSON.
#[derive(Serialize)]
struct Counts {
    compared: usize,
    equal: usize,
    rate: Option<f64>,
    false_stable: usize,
    false_unstable: usize,
    left_out: Left,
}

#[derive(Serialize)]
struct Left {
    penetrating: usize,
    no_orbit: usize,
    no_prediction: usize,
    undecided: usize,
}

/// A chart in JSON.
#[derive(Serialize)]
struct Keys<'a> {
    columns: Named<'a>,
    rows: Named<'a>,
    kbm: Vec<Vec<Option<bool>>>,
    exact: Vec<Vec<Option<bool>>>,
    agreement: Counts,
    flip: &'a [(f64, f64)],
    status: Status,
    finished: bool,
}

impl Serialize for Chart {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [(column, columns), (row, rows)] = &self.values();
        let verdicts = |pick: fn(&Point) -> Option<Verdict>| {
            let cell = |point: &Option<Point>| point.as_ref().and_then(pick).and_then(stable);
            let lines = self.grid.points.chunks(self.grid.width());
            lines.map(|line| line.iter().map(cell).collect()).collect()
        };
        let LeftOutAndAgreement { agreement, left_out } = self.agreement;
        let keys = Keys {
            columns: Named { name: column, values: columns },
            rows: Named { name: row, values: rows },
            kbm: verdicts(|point| point.predicted),
            exact: verdicts(|point| point.exact),
            agreement: Counts {
                compared: agreement.compared,
                equal: agreement.equal,
                rate: (agreement.compared > 0).then(|| agreement.rate()),
                false_stable: agreement.false_stable,
                false_unstable: agreement.false_unstable,
                left_out: Left {
                    penetrating: left_out.penetrating,
                    no_orbit: left_out.no_orbit,
                    no_prediction: left_out.no_prediction,
                    undecided: left_out.undecided,
                },
            },
            flip: &self.flip,
            status: Status::Estimated,
            finished: self.finished,
        };
        keys.serialize(serializer)
    }
}
