//! Bifurcation diagrams: the points of a Poincare section after the transients, per value of a
//! parameter.
//!
//! Every column depends on its parameter value and the start alone, so columns are computed in
//! parallel, in doubles several of a stroboscopic section side by side on each thread, handed over in order, and a diagram broken off anywhere goes on from the first column
//! that is missing with the same numbers as in one go.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Next, Settings};
use crate::poincare::{PoincareMap, Point, Section};
use crate::quantity::{Parameters, Quantity};
use crate::system::{Model, System};
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};

/// A model with one parameter that takes many values.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    /// The model.
    pub model: &'a Model,
    /// The other parameters.
    pub parameters: &'a Parameters,
    /// The name of the parameter.
    pub name: &'a str,
    /// Its values: one column each.
    pub values: &'a [Quantity],
}

impl Sweep<'_> {
    /// The compiled system of a column; nothing if there is no such column.
    pub fn system<R: Real>(
        &self,
        real: R,
        column: usize,
    ) -> Option<Result<System<R>, SimulateError>> {
        let value = self.values.get(column)?;
        let mut parameters = self.parameters.clone();
        parameters.set(self.name, value.clone());
        Some(self.model.compile(real, &parameters))
    }
}

/// What to compute per column.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramSettings<E> {
    /// The start time of every column.
    pub time: E,
    /// The start state of every column (of the first, if they follow each other).
    pub start: Vec<E>,
    /// Where the state is looked at.
    pub section: Section<E>,
    /// Columns with a stroboscopic section of their own: one period each, where the frequency of
    /// the force varies; empty where `section` is that of every column.
    pub periods: Vec<E>,
    /// Points thrown away.
    pub transient: u32,
    /// Points kept.
    pub kept: u32,
    /// Every column starts from the last point of the column before (at the start time), along
    /// an attractor; one after the other then. After a column without points: from `start`.
    pub follow: bool,
    /// The integration.
    pub integration: Settings,
}

impl<E: Clone> DiagramSettings<E> {
    fn section_of(&self, column: usize) -> Section<E> {
        let own = self.periods.get(column).map(|period| Section::Period(period.clone()));
        own.unwrap_or_else(|| self.section.clone())
    }
    fn count(&self) -> u64 {
        u64::from(self.transient) + u64::from(self.kept)
    }
}

/// The points over one parameter value, in order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Column<E> {
    /// Which value of the sweep.
    pub index: usize,
    /// The points kept; fewer where the events of the section cease. An integration that fails
    /// fails for its column only.
    pub points: Result<Vec<Point<E>>, SimulateError>,
}

/// Computes the columns `range` of the diagram, in parallel in rayon's current pool, and hands
/// them over in order of their index on the calling thread; the observer breaks the diagram off.
/// `tick` is asked at every step, on the computing threads, whether to go on (cancellation
/// inside of long columns: unfinished columns are dropped). Returns the index of the first column
/// that was not handed over: `range.end` when the diagram is complete.
///
/// To resume, begin the range there; with `follow` also set `start` to the last point of the
/// last column. The numbers are the same as in one go, bit by bit. Columns outside of the sweep
/// are left out.
///
/// Cost: (transient + kept) periods of the integration per column; memory: the points of 16
/// columns per thread.
///
/// ```
/// use lindstedt_equation::{Expression, Function};
/// use lindstedt_simulate::{
///     DiagramSettings, Doubles, Model, Parameters, Quantity, Section, Settings, Sweep, diagram,
/// };
/// use std::ops::ControlFlow;
///
/// // A damped, forced oscillator: x'' + x' + x = F cos t has the answer F sin t.
/// let x = Expression::DISPLACEMENT;
/// let force = Expression::parameter("F") * Expression::Time.apply(Function::Cos);
/// let equation = Expression::ACCELERATION + Expression::VELOCITY + x - force;
/// let model = Model::second_order(&equation)?;
/// let values = [1, 2, 3].map(Quantity::from);
/// let sweep = Sweep { model: &model, parameters: &Parameters::new(), name: "F", values: &values };
/// let settings = DiagramSettings {
///     time: 0.0,
///     start: vec![0.0, 0.0],
///     section: Section::Period(2.0 * std::f64::consts::PI),
///     periods: Vec::new(),
///     transient: 12,
///     kept: 1,
///     follow: false,
///     integration: Settings::for_digits(16),
/// };
/// let mut speeds = Vec::new();
/// let next = diagram(&sweep, &Doubles, &settings, 0..3, &|| ControlFlow::Continue(()), &mut |column| {
///     speeds.extend(column.points.iter().flatten().map(|point| point.state[1]));
///     ControlFlow::Continue(())
/// });
/// assert_eq!(next, 3);
/// assert!(speeds.iter().zip(1..).all(|(speed, force)| (speed - f64::from(force)).abs() < 1e-12));
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
pub fn diagram<R: Real>(
    sweep: &Sweep<'_>,
    real: &R,
    settings: &DiagramSettings<R::Element>,
    range: Range<usize>,
    tick: &(dyn Fn() -> ControlFlow<()> + Sync),
    observer: &mut dyn FnMut(Column<R::Element>) -> ControlFlow<()>,
) -> usize {
    let end = range.end.min(sweep.values.len());
    let block = if settings.follow { 1 } else { 16 * rayon::current_num_threads() };
    let mut start = settings.start.clone();
    let mut next = range.start;
    while next < end {
        let indices = next..end.min(next + block);
        let columns: Vec<_> = if settings.follow {
            indices.map(|index| column(sweep, real, settings, &start, index, tick)).collect()
        } else {
            let groups: Vec<_> = indices.clone().step_by(R::LANES).collect();
            let group = |first: usize| {
                several(sweep, real, settings, first..indices.end.min(first + R::LANES), tick)
            };
            let parallel = groups.into_par_iter().with_max_len(1);
            parallel.map(group).collect::<Vec<_>>().into_iter().flatten().collect()
        };
        for column in columns {
            let Some(column) = column else { return next };
            if settings.follow {
                let last = column.points.as_ref().ok().and_then(|points| points.last());
                start = last.map_or_else(|| settings.start.clone(), |point| point.state.clone());
            }
            next += 1;
            if observer(column).is_break() {
                return next;
            }
        }
    }
    next
}

/// One column, or nothing if it was broken off.
fn column<R: Real>(
    sweep: &Sweep<'_>,
    real: &R,
    settings: &DiagramSettings<R::Element>,
    start: &[R::Element],
    index: usize,
    tick: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Option<Column<R::Element>> {
    let points = sweep.system(real.clone(), index)?;
    let points = match points {
        Ok(system) => {
            collect(&system, settings, settings.section_of(index), start, tick).transpose()?
        }
        Err(error) => Err(error),
    };
    Some(Column { index, points })
}

type Points<E> = Vec<Point<E>>;

fn collect<R: Real>(
    system: &System<R>,
    settings: &DiagramSettings<R::Element>,
    section: Section<R::Element>,
    start: &[R::Element],
    tick: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Result<Option<Points<R::Element>>, SimulateError> {
    let mut map = PoincareMap::new(system, &settings.time, start, section, settings.integration)?;
    let mut points = Vec::new();
    for count in 0..settings.count() {
        if tick().is_break() {
            return Ok(None);
        }
        let point = match map.next_point(tick) {
            Err(SimulateError::Stopped) => return Ok(None),
            point => point?,
        };
        let Some(point) = point else { break };
        if count >= u64::from(settings.transient) {
            points.push(point);
        }
    }
    Ok(Some(points))
}

/// A column in progress among others: its points, or nothing if it was broken off.
struct Run<'s, R: Real> {
    map: PoincareMap<'s, R>,
    /// When the next point is.
    target: Option<R::Element>,
    found: u64,
    points: Result<Option<Points<R::Element>>, SimulateError>,
}

impl<R: Real> Run<'_, R> {
    /// Looks for the next point, if there is one to look for.
    fn aim(&mut self, count: u64, tick: &(dyn Fn() -> ControlFlow<()> + Sync)) {
        if self.target.is_some() || self.found == count || !matches!(self.points, Ok(Some(_))) {
            return;
        }
        match tick() {
            ControlFlow::Break(()) => self.points = Ok(None),
            ControlFlow::Continue(()) => self.target = self.map.next_time(),
        }
    }

    fn hear(&mut self, told: Result<Next, SimulateError>, transient: u32) {
        match told {
            Ok(Next::Idle | Next::Moved) => return,
            Ok(Next::Reached) => {
                let point = self.target.take().map(|time| self.map.point_at(time));
                if let (Ok(Some(points)), true) =
                    (&mut self.points, self.found >= u64::from(transient))
                {
                    points.extend(point);
                }
                self.found += 1;
            }
            Ok(Next::Stopped) | Err(SimulateError::Stopped) => self.points = Ok(None),
            Err(error) => self.points = Err(error),
        }
        self.target = None;
    }
}

/// Some columns, side by side as many as can be: a value that equals another constant makes other recurrences.
fn several<R: Real>(
    sweep: &Sweep<'_>,
    real: &R,
    settings: &DiagramSettings<R::Element>,
    indices: Range<usize>,
    tick: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Vec<Option<Column<R::Element>>> {
    if indices.len() < 2 {
        let start = &settings.start;
        return indices.map(|index| column(sweep, real, settings, start, index, tick)).collect();
    }
    together(sweep, real, settings, indices.clone(), tick).unwrap_or_else(|| {
        let middle = indices.start + indices.len() / 2;
        let half = |indices| several(sweep, real, settings, indices, tick);
        [half(indices.start..middle), half(middle..indices.end)].concat()
    })
}

/// Some columns side by side; nothing where that cannot be.
fn together<R: Real>(
    sweep: &Sweep<'_>,
    real: &R,
    settings: &DiagramSettings<R::Element>,
    indices: Range<usize>,
    tick: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Option<Vec<Option<Column<R::Element>>>> {
    if indices.len() < 2 || indices.clone().any(|index| !settings.section_of(index).is_strobe()) {
        return None;
    }
    let system = |index| sweep.system(real.clone(), index)?.ok();
    let systems: Vec<System<R>> = indices.clone().map(system).collect::<Option<_>>()?;
    let run = |(index, system)| {
        let (time, start, section) = (&settings.time, &settings.start, settings.section_of(index));
        let map = PoincareMap::new(system, time, start, section, settings.integration).ok()?;
        Some(Run { map, target: None, found: 0, points: Ok(Some(Vec::new())) })
    };
    let mut runs: Vec<Run<'_, R>> =
        indices.clone().zip(&systems).map(run).collect::<Option<_>>()?;
    let flows: Vec<_> = runs.iter().map(|run| run.map.flow()).collect();
    let mut group = R::together(&flows)?;
    loop {
        runs.iter_mut().for_each(|run| run.aim(settings.count(), tick));
        if runs.iter().all(|run| run.target.is_none()) {
            break;
        }
        let mut flows: Vec<_> =
            runs.iter_mut().map(|run| (run.map.flow_mut(), run.target.clone())).collect();
        let told = group.round(&mut flows, tick);
        runs.iter_mut().zip(told).for_each(|(run, told)| run.hear(told, settings.transient));
    }
    let column =
        |(index, run): (usize, Run<'_, R>)| Some(Column { index, points: run.points.transpose()? });
    Some(indices.zip(runs).map(column).collect())
}
