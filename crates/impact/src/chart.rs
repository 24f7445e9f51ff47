//! Stability charts over two parameters in doubles, in parallel.

use crate::aware::impact_aware;
use crate::characteristic::{Characteristic, Kick};
use crate::error::ImpactError;
use crate::flight::clearance;
use crate::flow::{Flow, Scratch, free_delay};
use crate::lanes::{Columns, LANES, Lanes};
use crate::map::{ImpactMap, Verdict};
use crate::orbit::{Orbit, orbit};
use crate::parameters::Parameters;
pub use crate::parameters::Swept;
use crate::prediction::{Ground, Variant};
use crate::zeros::{exact_verdict, leading_modulus};
use lindstedt_algebra::Stop;
use lindstedt_number::complex::Complex;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// So many points are shared out at a time, and as many rows at least.
const BLOCK: usize = 1 << 16;
const FEWEST_ROWS: usize = 64;

/// Equidistant values of one parameter.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Which.
    pub parameter: Swept,
    /// First value.
    pub low: f64,
    /// Last value.
    pub high: f64,
    /// Number of values, at least 1.
    pub count: usize,
}

impl Axis {
    /// The value number n.
    #[must_use]
    pub fn value(&self, n: usize) -> f64 {
        if self.count < 2 {
            return self.low;
        }
        self.low + (self.high - self.low) * (n as f64 / (self.count - 1) as f64)
    }
    /// Whether the parameter acts through the delay loop only.
    fn is_gain(&self) -> bool {
        matches!(self.parameter, Swept::DisplacementGain | Swept::VelocityGain)
    }
    fn set(&self, n: usize, parameters: &mut Parameters<f64>) {
        *parameters.slot(self.parameter) = self.value(n);
    }
}

/// A prediction for every point.
#[derive(Clone, Copy, Debug)]
pub enum Predictor {
    /// The paper's prediction in a variant; its orbit is not checked for penetration.
    Kbm(Variant),
    /// The impact-aware prediction with this kick.
    ImpactAware(Kick),
}

/// What to compute.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// First axis: the faster index.
    pub columns: Axis,
    /// Second axis.
    pub rows: Axis,
    /// Prediction and its order.
    pub predictor: Option<(Predictor, usize)>,
    /// The exact verdict by G with this kick.
    pub exact: Option<Kick>,
    /// Whether the spectral radii are wanted besides the verdicts.
    pub radius: bool,
    /// The first of the rows that are computed, and how many; all if nothing. Their values are those of the whole.
    pub part: Option<(usize, usize)>,
}

impl Plan {
    /// The rows that are computed.
    #[must_use]
    pub fn computed(&self) -> Range<usize> {
        let Some((first, count)) = self.part else { return 0..self.rows.count };
        first.min(self.rows.count)..first.saturating_add(count).min(self.rows.count)
    }
}

/// One point.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The predicted verdict; `None` without a predicted orbit or flow, or if not asked for.
    pub predicted: Option<Verdict>,
    /// The exact verdict; `None` without a true orbit (its flight is checked for penetration) or if
    /// not asked for; neutral if undecided.
    pub exact: Option<Verdict>,
    /// Predicted max |gamma|; NaN if not asked for or if there is none.
    pub predicted_radius: f64,
    /// Exact max |gamma|; NaN if not asked for or not found.
    pub exact_radius: f64,
    /// Whether the flight of the periodic solution passes through the wall, so that `exact` is
    /// `None`.
    pub penetrates: bool,
}

impl Point {
    /// A point of which nothing is known.
    pub const EMPTY: Self = Self {
        predicted: None,
        exact: None,
        predicted_radius: f64::NAN,
        exact_radius: f64::NAN,
        penetrates: false,
    };
}

/// A chart: the points row by row; of one that was stopped the first points.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What was computed.
    pub plan: Plan,
    /// The computed rows of `columns.count` points, fewer where the work was stopped.
    pub points: Vec<Point>,
}

/// Computes a chart on rayon's threads. `observer` receives the number of finished rows, after each
/// and now and then within a long one, and stops the work by returning false: then the points up to the first that is
/// not computed are kept.
///
/// Cost per point: a prediction of order n some n^2 products, and for variant E the orbit of the predicted flow; an
/// exact verdict some 50 evaluations of G. Estimated: doubles without error bounds.
///
/// # Errors
/// [`ImpactError::BadAxes`], [`ImpactError::OrderZero`].
pub fn chart(
    base: &Parameters<f64>,
    plan: &Plan,
    observer: &(dyn Fn(usize) -> bool + Sync),
) -> Result<Chart, ImpactError> {
    let (width, rows) = (plan.columns.count, plan.computed());
    let height = rows.len();
    if width == 0 || height == 0 || plan.columns.parameter == plan.rows.parameter {
        return Err(ImpactError::BadAxes);
    }
    let order = plan.predictor.map_or(1, |(_, order)| order);
    if order == 0 {
        return Err(ImpactError::OrderZero);
    }
    width.checked_mul(height).ok_or(ImpactError::BadAxes)?;
    // Blocks of rows one after the other: what is finished when the work is stopped begins with the first row.
    let (done, mut points) = (AtomicUsize::new(0), Vec::new());
    let columns = Fixed::of_columns(base, plan);
    let block = (BLOCK / width).max(FEWEST_ROWS);
    for first in (0..height).step_by(block) {
        let before = points.len();
        let mut filled = vec![0; block.min(height - first)];
        points.resize(before + width * filled.len(), Point::EMPTY);
        let lines = points[before..].par_chunks_mut(width).zip(&mut filled).enumerate();
        let finished = lines.try_for_each_init(
            || (Scratch::new(order), Scratch::new(order)),
            |scratch, (row, (line, filled))| {
                let row = rows.start + first + row;
                *filled = fill(base, (plan, &columns), row, (line, scratch), &|| {
                    observer(done.load(Ordering::Relaxed))
                });
                if *filled < width {
                    return None;
                }
                observer(done.fetch_add(1, Ordering::Relaxed) + 1).then_some(())
            },
        );
        if finished.is_none() {
            let rows = filled.iter().take_while(|count| **count == width).count();
            points.truncate(before + width * rows + filled.get(rows).unwrap_or(&0));
            break;
        }
    }
    Ok(Chart { plan: *plan, points })
}

/// One row, unless `goes_on` says no: a long one is not waited for. How many of its points were computed.
fn fill(
    base: &Parameters<f64>,
    (plan, known): (&Plan, &[Fixed]),
    row: usize,
    (line, scratch): (&mut [Point], &mut Buffers),
    goes_on: &dyn Fn() -> bool,
) -> usize {
    let mut parameters = base.clone();
    plan.rows.set(row, &mut parameters);
    let mut seeds = Vec::new();
    let row = Fixed::new(&parameters, plan);
    let mut columns = match (plan.predictor, &row.ground) {
        (Some((_, order)), Some(ground)) if plan.columns.is_gain() => {
            Some(Columns::new(plan.columns.parameter, order, &parameters, ground))
        }
        _ => None,
    };
    for (n, points) in line.chunks_mut(LANES).enumerate() {
        let first = n * LANES;
        let whole = columns.as_mut().filter(|_| points.len() == LANES);
        let values = || std::array::from_fn(|l| plan.columns.value(first + l));
        let maps = whole.map(|columns| columns.maps(values(), &mut scratch.1));
        for (k, point) in points.iter_mut().enumerate() {
            if maps.is_none() || plan.exact.is_some() {
                plan.columns.set(first + k, &mut parameters);
            }
            let own = (!plan.columns.is_gain() && known.is_empty())
                .then(|| Fixed::new(&parameters, plan));
            let fixed = known.get(first + k).or(own.as_ref()).unwrap_or(&row);
            let map = match &maps {
                Some(maps) => maps[k].clone(),
                None => fixed.map(&parameters, plan, &mut scratch.0),
            };
            *point = evaluate(&parameters, fixed, plan, map, &mut seeds);
        }
        if (first + LANES).is_multiple_of(256) && !goes_on() {
            return first + points.len();
        }
    }
    line.len()
}

/// For single points, and for several side by side.
type Buffers = (Scratch<f64>, Scratch<Lanes>);

/// What does not depend on the gains A, B.
struct Fixed {
    time: f64,
    delay: Complex<f64>,
    /// What the predicted map takes besides the flow, for a prediction by averaging.
    ground: Option<Ground<f64>>,
    orbit: Option<Result<Orbit<f64>, ImpactError>>,
    /// Whether the flight of the true orbit passes through the wall: then there is no such orbit.
    penetrates: bool,
}

impl Fixed {
    /// Of every column, where the rows are a gain, so that it is the same in all of them; nothing where it is not, and for
    /// so many columns that one asked to stop would be waited for.
    fn of_columns(base: &Parameters<f64>, plan: &Plan) -> Vec<Self> {
        if plan.columns.is_gain() || !plan.rows.is_gain() || plan.columns.count > BLOCK {
            return Vec::new();
        }
        let column = |n| {
            let mut parameters = base.clone();
            plan.columns.set(n, &mut parameters);
            Self::new(&parameters, plan)
        };
        (0..plan.columns.count).into_par_iter().map(column).collect()
    }
    fn new(parameters: &Parameters<f64>, plan: &Plan) -> Self {
        let time = parameters.period();
        let needs_orbit = plan.exact.is_some()
            || matches!(
                plan.predictor,
                Some((Predictor::Kbm(Variant::S) | Predictor::ImpactAware(_), _))
            );
        let orbit = needs_orbit.then(|| orbit(parameters));
        let through = |orbit: &Orbit<f64>| {
            let found = clearance(parameters, orbit, &Stop::default());
            matches!(found, Ok(Some(found)) if found.margin > 0.0)
        };
        let found = orbit.as_ref().and_then(|found| found.as_ref().ok());
        let ground = match plan.predictor {
            // Refuses c >= 2 alpha, as the single prediction does.
            Some((Predictor::Kbm(variant), _))
                if Flow::uncontrolled(parameters).is_ok()
                    && (variant != Variant::S || found.is_some()) =>
            {
                Ground::new(variant, parameters, found).ok()
            }
            _ => None,
        };
        Self {
            penetrates: plan.exact.is_some() && found.is_some_and(through),
            time,
            delay: free_delay(parameters, &time),
            ground,
            orbit,
        }
    }
    /// The map that averaging predicts.
    fn map(
        &self,
        parameters: &Parameters<f64>,
        plan: &Plan,
        scratch: &mut Scratch<f64>,
    ) -> Option<ImpactMap<f64>> {
        let (ground, (_, order)) = (self.ground.as_ref()?, plan.predictor?);
        scratch.fill(parameters, &self.time, &self.delay, order);
        ground.map(&scratch.flow()?).ok()
    }
    fn orbit(&self) -> Option<&Orbit<f64>> {
        self.orbit.as_ref().and_then(|found| found.as_ref().ok())
    }
}

fn evaluate(
    parameters: &Parameters<f64>,
    fixed: &Fixed,
    plan: &Plan,
    map: Option<ImpactMap<f64>>,
    seeds: &mut Vec<Complex<f64>>,
) -> Point {
    let mut point = Point { penetrates: fixed.penetrates, ..Point::EMPTY };
    let predicted = match (plan.predictor, fixed.orbit()) {
        (Some((Predictor::Kbm(_), _)), _) => {
            map.map(|map| (map.verdict(), plan.radius.then(|| map.spectral_radius())))
        }
        (Some((Predictor::ImpactAware(kick), order)), Some(orbit)) => {
            let found = impact_aware(parameters, orbit, kick, order, &Stop::default()).ok();
            found.map(|found| (found.verdict(), plan.radius.then(|| found.spectral_radius())))
        }
        _ => None,
    };
    if let Some((verdict, radius)) = predicted {
        point.predicted = Some(verdict);
        point.predicted_radius = radius.unwrap_or(f64::NAN);
    }
    if let (Some(kick), Some(orbit)) = (plan.exact, fixed.orbit().filter(|_| !fixed.penetrates)) {
        let g = Characteristic::new(parameters, orbit, kick);
        point.exact = Some(exact_verdict(&g).0);
        if plan.radius {
            point.exact_radius = leading_modulus(&g, seeds).unwrap_or(f64::NAN);
        }
    }
    point
}

/// How prediction and truth compare over a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Agreement {
    /// Points where both verdicts exist and neither is neutral.
    pub compared: usize,
    /// Of these, the points with equal verdicts.
    pub equal: usize,
    /// Predicted stable, truly unstable.
    pub false_stable: usize,
    /// Predicted unstable, truly stable.
    pub false_unstable: usize,
}

/// Why points were not compared; each counts once, by the first reason in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct LeftOut {
    /// The flight passes through the wall.
    pub penetrating: usize,
    /// No periodic solution with one impact, or values that were refused.
    pub no_orbit: usize,
    /// No predicted orbit or flow.
    pub no_prediction: usize,
    /// One of the verdicts is neutral.
    pub undecided: usize,
}

impl Agreement {
    /// equal/compared; NaN if nothing was compared.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.equal as f64 / self.compared as f64
    }
}

impl Chart {
    /// The point of a column and a row.
    #[must_use]
    pub fn point(&self, column: usize, row: usize) -> Option<&Point> {
        if column >= self.plan.columns.count {
            return None;
        }
        let row = row.checked_sub(self.plan.computed().start)?;
        self.points.get(row.checked_mul(self.plan.columns.count)? + column)
    }
    /// Counts of agreement between prediction and exact verdict.
    #[must_use]
    pub fn agreement(&self) -> Agreement {
        Agreement::of(&self.points)
    }
}

impl LeftOut {
    /// Why the points that an [`Agreement`] does not count are left out, where both prediction and truth were asked
    /// for.
    #[must_use]
    pub fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Self {
        let mut left_out = Self::default();
        for point in points {
            match (point.predicted, point.exact) {
                (_, None) if point.penetrates => left_out.penetrating += 1,
                (_, None) => left_out.no_orbit += 1,
                (None, _) => left_out.no_prediction += 1,
                (Some(Verdict::Neutral), _) | (_, Some(Verdict::Neutral)) => {
                    left_out.undecided += 1;
                }
                _ => {}
            }
        }
        left_out
    }
}

impl Agreement {
    /// Of some points.
    #[must_use]
    pub fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Self {
        let mut agreement = Self::default();
        for point in points {
            match (point.predicted, point.exact) {
                (Some(Verdict::Neutral), _) | (_, Some(Verdict::Neutral)) => continue,
                (Some(predicted), Some(exact)) => {
                    agreement.compared += 1;
                    agreement.equal += usize::from(predicted == exact);
                    let wrong = predicted != exact;
                    agreement.false_stable += usize::from(wrong && predicted == Verdict::Stable);
                    agreement.false_unstable += usize::from(wrong && exact == Verdict::Stable);
                }
                _ => {}
            }
        }
        agreement
    }
}
