//! The integrator: steps, and the loop over them.

pub(crate) mod arithmetic;
mod escape;
mod lanes;
pub(crate) mod real;

use crate::error::{SimulateError, Surface};
use crate::outcome::Outcome;
use crate::past::{Clock, Past};
use crate::report::{Report, Work};
use crate::roots::RootFinder;
use crate::series::{Phase, Series};
use crate::system::System;
use escape::Runaway;
use real::Real;
use std::ops::ControlFlow;

/// How precisely to integrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Decimal digits of one step, relative to the largest state; the arithmetic needs some
    /// digits more (see [`crate::Digits::for_digits`]); 16 in f64.
    pub digits: u32,
    /// The order of the Taylor series; by default 1.15 digits + 3, where a result costs least
    /// (Jorba and Zou 2005).
    pub order: Option<usize>,
    /// More impacts than this are an error.
    pub most_impacts: u64,
}

impl Settings {
    /// For a number of decimal digits.
    #[must_use]
    pub fn for_digits(digits: u32) -> Self {
        Self { digits, order: None, most_impacts: u64::MAX }
    }

    fn order(&self) -> usize {
        let automatic = || (1.151_293 * f64::from(self.digits) + 3.0).ceil() as usize;
        self.order.unwrap_or_else(automatic).max(3)
    }
}

/// A running integration.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{Doubles, Integrator, Model, Parameters, Settings};
/// use std::ops::ControlFlow;
///
/// let x = Expression::DISPLACEMENT;
/// let model = Model::second_order(&(Expression::ACCELERATION + x))?;
/// let system = model.compile(Doubles, &Parameters::new())?;
/// let mut flow = Integrator::new(&system, &0.0, &[1.0, 0.0], Settings::for_digits(16))?;
/// flow.advance(&10.0, &mut |_| ControlFlow::Continue(()))?;
/// assert!((flow.state()[0] - 10f64.cos()).abs() < 1e-14);
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Integrator<'s, R: Real> {
    pub(crate) system: &'s System<R>,
    pub(crate) settings: Settings,
    pub(crate) log2_tolerance: f64,
    pub(crate) series: Series<R>,
    pub(crate) state: Vec<R::Element>,
    pub(crate) before: Vec<R::Element>,
    pub(crate) clock: Clock<R::Element>,
    pub(crate) phase: Phase,
    /// How many leading coefficients of each surface vanish at the start of the step: walls,
    /// switches, sections.
    pub(crate) vanishing: Vec<usize>,
    pub(crate) sides: Vec<i8>,
    /// log2 of the rounding errors of sections, where the step starts on a switch.
    pub(crate) rounding: Option<f64>,
    pub(crate) past: Option<Past<R>>,
    pub(crate) finder: RootFinder<R::Element>,
    pub(crate) polynomial: Vec<R::Element>,
    /// The wall of the impact that began the step.
    pub(crate) rebound: Option<usize>,
    pub(crate) smooth: bool,
    stalled: u32,
    /// log2 of the largest state of the start; 0 for a start in zero.
    pub(crate) log2_start: f64,
    /// Where the present run towards infinity began.
    runaway: Option<Runaway>,
    /// Whether the series is that about the present state.
    expanded: bool,
    pub(crate) work: Work,
}

/// Several integrations side by side, up to [`Real::LANES`] of them.
pub trait Together<R: Real>: Send {
    /// One step of every integration that has a target, or none where it is reached.
    fn round(
        &mut self,
        flows: &mut [(&mut Integrator<'_, R>, Option<R::Element>)],
        tick: &Tick<'_>,
    ) -> Vec<Result<Next, SimulateError>>;
}

/// What one step towards a target came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// There is no target.
    Idle,
    /// It goes on.
    Moved,
    /// The target is reached; there was no step.
    Reached,
    /// The tick broke it off.
    Stopped,
}

/// The observer of an integration: told of every segment and event; breaks it off if it likes.
pub type Observer<'o, R> = dyn FnMut(&Report<'_, R>) -> ControlFlow<()> + 'o;

/// Asked at every step of a long computation whether to go on. Where there is no partial answer
/// the computation ends with [`SimulateError::Stopped`].
pub type Tick<'t> = dyn Fn() -> ControlFlow<()> + 't;

/// A tick that never breaks off.
pub fn go_on() -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// An event ahead: after which part of the step, on which surface.
pub(crate) struct Hit<E> {
    pub(crate) at: E,
    pub(crate) surface: Surface,
    /// The sign of the surface's function after it.
    pub(crate) after: i8,
}

impl<'s, R: Real> Integrator<'s, R> {
    /// Starts at `time` with the given states (one per dimension; the directions of the
    /// linearisation start at the identity). A state exactly on a switch is classified by the
    /// fields on both sides, a state at a wall by its velocity and the force.
    pub fn new(
        system: &'s System<R>,
        time: &R::Element,
        state: &[R::Element],
        settings: Settings,
    ) -> Result<Self, SimulateError> {
        let real = &system.real;
        let (n, given) = (system.variables, state.len());
        if given != n {
            return Err(SimulateError::WrongDimension { states: n, given });
        }
        if !system.delays.is_empty() && system.history.is_none() {
            return Err(SimulateError::MissingHistory);
        }
        let mut all = state.to_vec();
        for direction in 0..system.directions() {
            all.extend((0..n).map(|k| real.double(if k == direction { 1.0 } else { 0.0 })));
        }
        let log2_start = state.iter().map(|x| real.log2(x)).fold(f64::NEG_INFINITY, f64::max);
        let order = settings.order();
        let clock = Clock::new(real, time);
        let past = (!system.delays.is_empty()).then(|| Past::new(system, &clock, order));
        let surfaces = system.walls.len() + system.switches.len() + system.sections.len();
        let mut flow = Self {
            system,
            settings,
            log2_tolerance: -f64::from(settings.digits + 1) * std::f64::consts::LOG2_10,
            series: Series::new(system, order),
            before: all.clone(),
            state: all,
            clock,
            phase: Phase { modes: vec![1; system.switches.len()], contact: None },
            vanishing: vec![0; surfaces],
            sides: vec![0; system.sections.len()],
            rounding: None,
            past,
            finder: RootFinder::new(),
            polynomial: Vec::new(),
            rebound: None,
            smooth: false,
            stalled: 0,
            log2_start: if log2_start.is_finite() { log2_start } else { 0.0 },
            runaway: None,
            expanded: false,
            work: Work::default(),
        };
        R::begin(&mut flow)?;
        Ok(flow)
    }

    /// The time.
    #[must_use]
    pub fn time(&self) -> &R::Element {
        &self.clock.high
    }

    /// The states; those of the linearisation, direction by direction, behind them.
    #[must_use]
    pub fn state(&self) -> &[R::Element] {
        &self.state
    }

    /// The signs of the switches; 0: sliding (sticking).
    #[must_use]
    pub fn modes(&self) -> &[i8] {
        &self.phase.modes
    }

    /// The wall that the body rests at.
    #[must_use]
    pub fn contact(&self) -> Option<usize> {
        self.phase.contact
    }

    /// The work so far.
    #[must_use]
    pub fn work(&self) -> Work {
        self.work
    }

    /// Replaces the states by the given ones (one per dimension) at the present time: a jump from
    /// outside. Directions of the linearisation stay as they are; a body at rest at a wall is
    /// free again (and at rest in the next moment, if the new state and the force say so).
    pub fn set_state(&mut self, state: &[R::Element]) -> Result<(), SimulateError> {
        let (n, given) = (self.system.variables, state.len());
        if given != n {
            return Err(SimulateError::WrongDimension { states: n, given });
        }
        self.state[..n].clone_from_slice(state);
        self.smooth = false;
        self.rebound = None;
        self.phase.contact = None;
        self.vanishing.iter_mut().for_each(|skip| *skip = 0);
        self.rounding = None;
        R::begin(self)
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.system.real.to_f64(&self.clock.high)
    }

    /// Integrates up to `target` (which is met exactly; nothing happens if it is past) or until
    /// the observer breaks it off, after which the state is that at the end of the step (of one that takes long and
    /// is broken off within, told [`Report::Busy`], that at its start). May be
    /// called again with a later target: stroboscopic sections are a loop over targets. Cost: per step O(operations order^2).
    pub fn advance(
        &mut self,
        target: &R::Element,
        observer: &mut Observer<'_, R>,
    ) -> Result<Outcome, SimulateError> {
        R::advance(self, target, observer)
    }

    pub(crate) fn advance_here(
        &mut self,
        target: &R::Element,
        observer: &mut Observer<'_, R>,
    ) -> Result<Outcome, SimulateError> {
        let target = Clock::new(&self.system.real, target);
        loop {
            let remaining = target.since(&self.system.real, &self.clock);
            if self.system.real.sign(&remaining) <= 0 {
                return Ok(Outcome::Reached);
            }
            if self.step(&remaining, &target, observer)?.is_break() {
                return Ok(Outcome::Stopped);
            }
        }
    }

    /// [`Self::advance`] with nothing to tell but whether to go on.
    pub(crate) fn advance_while(
        &mut self,
        target: &R::Element,
        tick: &Tick<'_>,
    ) -> Result<(), SimulateError> {
        match self.advance(target, &mut |_| tick())? {
            Outcome::Reached => Ok(()),
            Outcome::Stopped => Err(SimulateError::Stopped),
        }
    }

    /// Whether a target is not ahead.
    fn has_reached(&self, target: &R::Element) -> bool {
        let real = &self.system.real;
        real.sign(&Clock::new(real, target).since(real, &self.clock)) <= 0
    }

    /// One step of [`Self::advance_while`].
    pub(crate) fn next(
        &mut self,
        target: &R::Element,
        tick: &Tick<'_>,
    ) -> Result<Next, SimulateError> {
        let target = Clock::new(&self.system.real, target);
        let remaining = target.since(&self.system.real, &self.clock);
        if self.system.real.sign(&remaining) <= 0 {
            return Ok(Next::Reached);
        }
        let told = self.step(&remaining, &target, &mut |_| tick())?;
        Ok(if told.is_break() { Next::Stopped } else { Next::Moved })
    }

    fn step(
        &mut self,
        remaining: &R::Element,
        target: &Clock<R::Element>,
        observer: &mut Observer<'_, R>,
    ) -> Result<ControlFlow<()>, SimulateError> {
        let order = self.series.order;
        let expanded = match std::mem::take(&mut self.expanded) {
            true => Ok(None),
            false => self.expand_while(order, &mut || observer(&Report::Busy)),
        };
        let limit = match expanded {
            // The state is that at the end of the step before.
            Err(SimulateError::Stopped) => return Ok(ControlFlow::Break(())),
            found => found?,
        };
        if let Some(hit) = self.hit_at_start() {
            // Events without a step between them: a sequence that does not end is no motion.
            self.stalled += 1;
            if self.stalled > 100 {
                return Err(SimulateError::StepTooSmall { time: self.seconds() });
            }
            return self.arrive(&hit, observer);
        }
        self.stalled = 0;
        if self.rebound.is_some()
            && let Some((duration, log2_error)) = self.accumulation(remaining)?
        {
            return self.accumulate(&duration, log2_error, observer);
        }
        self.rebound = None;
        if let Some(error) = self.runs_away() {
            return Err(error);
        }
        let branch = self.branch_ahead();
        if let Some(branch) = &branch
            && let Some(told) = self.leap(branch, remaining, observer)?
        {
            return Ok(told);
        }
        let real = &self.system.real;
        let time = self.seconds();
        let step = self.series.step(self.system, self.log2_tolerance);
        let step = step.ok_or_else(|| match &branch {
            // Coefficients near the branch point overflow before it can be leapt over.
            Some(_) => self.stuck(time),
            None if self.escapes() => self.stuck(time),
            None if self.overflows() => SimulateError::Overflow { time },
            None => SimulateError::NotFinite { time },
        })?;
        let mut h = real.double(step.min(f64::MAX));
        let mut last = false;
        if let Some(limit) = limit.filter(|limit| *limit < h) {
            h = limit;
        }
        if let Some(branch) = branch {
            // No closer than half the way: the root itself is no place to expand about.
            let half = real.product(&branch.after, &real.double(0.5));
            if half < h {
                h = half;
            }
        }
        if h >= *remaining {
            h = remaining.clone();
            last = true;
        }
        loop {
            let end = real.sum(&self.clock.high, &h);
            // What remains to the target may be less than a rounding error of the time: an event
            // fell on the target.
            if !last && (end <= self.clock.high || real.log2(&h).is_nan()) {
                return Err(self.stuck(time));
            }
            if self.series.holds(self.system, &end, &self.phase, &h, self.log2_tolerance) {
                break;
            }
            real.scale(&mut h, &real.double(0.5));
            last = false;
            self.work.rejected += 1;
        }
        let hit = self.next_hit(&h)?;
        if let Some(hit) = &hit {
            real.set(&mut h, &hit.at);
            last = last && h == *remaining;
        }
        self.work.steps += 1;
        // The state is consistent whenever the observer breaks off: the step is finished first.
        let switches = |hit: &Hit<_>| matches!(hit.surface, Surface::Switch(_) | Surface::Limit(_));
        let told = self.segment(&h, hit.as_ref().is_some_and(switches), observer)?;
        self.rounding = None;
        self.move_by(&h);
        if last {
            self.clock = target.clone();
        }
        let flat = self.system.walls.len() + self.system.switches.len();
        self.vanishing.iter_mut().take(flat).for_each(|skip| *skip = 0);
        let event = match hit {
            Some(hit) => self.arrive(&hit, observer)?,
            None => ControlFlow::Continue(()),
        };
        Ok(if told.is_break() { told } else { event })
    }

    /// The series about the present state; returns how long the delayed rows hold.
    pub(crate) fn expand(&mut self) -> Result<Option<R::Element>, SimulateError> {
        let order = self.series.order;
        self.expand_to(order)
    }

    pub(crate) fn expand_to(&mut self, levels: usize) -> Result<Option<R::Element>, SimulateError> {
        self.expand_while(levels, &mut go_on)
    }

    fn expand_while(
        &mut self,
        levels: usize,
        tick: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Option<R::Element>, SimulateError> {
        let system = self.system;
        for (state, value) in self.state.iter().enumerate() {
            system.real.set(self.series.rows.at_mut(state, 0), value);
        }
        let mut limit = None;
        if let Some(past) = &mut self.past {
            let rows = &mut self.series.rows;
            limit = past.fill(system, &self.clock, rows, self.log2_tolerance);
            if limit.is_none() {
                return Err(SimulateError::StepTooSmall { time: self.seconds() });
            }
        }
        self.series.expand(system, &self.clock.high, &self.phase, levels, tick)?;
        Ok(limit)
    }

    pub(crate) fn grazing(&self, surface: Surface, at: &R::Element) -> SimulateError {
        SimulateError::Grazing { surface, time: self.seconds() + self.system.real.to_f64(at) }
    }

    /// Moves the state to start + h.
    pub(crate) fn move_by(&mut self, h: &R::Element) {
        let real = &self.system.real;
        self.series.states_at(real, &mut self.state, h);
        self.clock.advance(real, h);
    }

    /// An event happened: the states jump or the right side does; `impacts` more impacts.
    pub(crate) fn interrupted(&mut self, impacts: u64, jump: bool) -> Result<(), SimulateError> {
        self.work.impacts += impacts;
        self.smooth &= !jump;
        if self.work.impacts > self.settings.most_impacts {
            let (impacts, time) = (self.work.impacts, self.seconds());
            return Err(SimulateError::TooManyImpacts { impacts, time });
        }
        Ok(())
    }
}
