//! The largest Lyapunov exponent, through impacts, switchings and sliding.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::integrator::{Integrator, Next, Settings, Together, go_on};
use crate::system::System;
use std::ops::ControlFlow;

/// How long to follow a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovSettings<E> {
    /// Time between two renormalisations: the period of the forcing, say.
    pub interval: E,
    /// Intervals thrown away; the directions turn to the fastest meanwhile.
    pub transient: u32,
    /// Intervals averaged over.
    pub averaged: u32,
    /// The integration.
    pub integration: Settings,
}

/// An exponent in 1/time, natural logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovExponent {
    /// The average; minus infinity if everything is forgotten (a rigid orbit).
    pub value: f64,
    /// An estimate: the standard error of the mean, from up to 20 blocks of the average (it tells
    /// of chaotic fluctuations, not of slow transients); infinite for fewer than 2.
    pub error: f64,
}

/// lim 1/t ln ||D flow_t||, the largest Lyapunov exponent of the solution from `state` at `time`:
/// all directions of the linearisation, carried through events by their saltation matrices
/// (Mueller, Chaos, Solitons and Fractals 5, 1995, 1671-1681), divided by their common norm after
/// every interval.
///
/// The system must be compiled from a model with [`crate::Model::linearised`]. The observer is
/// asked after every interval; nothing if it breaks off, or if no interval is averaged over. Errors:
/// as of [`Integrator::advance`]; [`SimulateError::NotFinite`] where a direction overflows, or for
/// an interval of length 0.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{
///     Doubles, LyapunovSettings, Model, Parameters, Settings, largest_lyapunov_exponent,
/// };
/// use std::ops::ControlFlow;
///
/// // x'' = x: the exponents are 1 and -1.
/// let equation = Expression::ACCELERATION - Expression::DISPLACEMENT;
/// let system = Model::second_order(&equation)?.linearised().compile(Doubles, &Parameters::new())?;
/// let integration = Settings::for_digits(16);
/// let settings = LyapunovSettings { interval: 1.0, transient: 20, averaged: 50, integration };
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let exponent = largest_lyapunov_exponent(&system, &0.0, &[0.0, 0.0], &settings, go_on)?;
/// assert!(exponent.is_some_and(|exponent| (exponent.value - 1.0).abs() < 1e-14));
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
pub fn largest_lyapunov_exponent<R: Real>(
    system: &System<R>,
    time: &R::Element,
    state: &[R::Element],
    settings: &LyapunovSettings<R::Element>,
    observer: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<Option<LyapunovExponent>, SimulateError> {
    let found = largest_lyapunov_exponents(&[system], time, state, settings, observer).pop();
    found.unwrap_or(Ok(None))
}

/// [`largest_lyapunov_exponent`] of several systems from one start, in order; in doubles those that differ in their
/// numbers alone are followed side by side, with the exponents that each has alone. The observer is told how many
/// intervals were followed; systems too many for one side by side follow one another, and the exponents found before it
/// breaks off stand.
pub fn largest_lyapunov_exponents<R: Real>(
    systems: &[&System<R>],
    time: &R::Element,
    state: &[R::Element],
    settings: &LyapunovSettings<R::Element>,
    observer: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Vec<Result<Option<LyapunovExponent>, SimulateError>> {
    let mut all: Vec<_> =
        systems.iter().map(|system| Growth::new(*system, time, state, settings)).collect();
    let (mut stopped, mut followed) = (false, 0u32);
    for lanes in all.chunks_mut(R::LANES) {
        let mut running: Vec<_> = lanes.iter_mut().filter_map(|one| one.as_mut().ok()).collect();
        let flows: Vec<_> = running.iter().map(|one| &one.flow).collect();
        let mut group = R::together(&flows);
        for interval in 1..=settings.transient.saturating_add(settings.averaged) {
            if running.iter().all(|one| one.ended.is_some()) || stopped {
                break;
            }
            let mut target = settings.interval.clone();
            let real = &running[0].flow.system.real;
            real.times_integer(&mut target, interval as i32);
            let target = real.sum(time, &target);
            // Who has ended keeps his lane.
            let mut told: Vec<_> =
                running.iter().map(|one| one.ended.is_some().then_some(Ok(()))).collect();
            let mut flows: Vec<_> =
                running.iter_mut().map(|one| (&mut one.flow, &mut one.carried)).collect();
            advance_all(&mut flows, group.as_deref_mut(), &target, &mut told);
            for (one, told) in running.iter_mut().zip(told.into_iter().flatten()) {
                if one.ended.is_none() {
                    one.hear(told, interval > settings.transient);
                }
            }
            if running.iter().any(|one| one.ended.is_none()) {
                followed = followed.saturating_add(1);
                stopped = observer(followed).is_break();
            }
        }
        if stopped {
            for one in running {
                one.ended.get_or_insert(Ok(None));
            }
        }
    }
    let interval = |system: &System<R>| system.real.to_f64(&settings.interval);
    let exponent = |(one, system): (Result<Growth<'_, R>, _>, &&System<R>)| match one? {
        Growth { ended: Some(ended), .. } => ended,
        one => one.exponent(interval(system)),
    };
    all.into_iter().zip(systems).map(exponent).collect()
}

/// Every integration of which nothing is told yet to the target, side by side where they are a group, and ln of what its
/// directions were divided by on the way.
fn advance_all<R: Real>(
    flows: &mut [(&mut Integrator<'_, R>, &mut f64)],
    mut group: Option<&mut (dyn Together<R> + '_)>,
    target: &R::Element,
    told: &mut [Option<Result<(), SimulateError>>],
) {
    while told.iter().any(Option::is_none) {
        let aim = |told: &Option<_>| told.is_none().then(|| target.clone());
        let pairs = flows.iter_mut().zip(&*told).map(|((flow, _), told)| (&mut **flow, aim(told)));
        let next: Vec<_> = match group.as_deref_mut() {
            Some(group) => group.round(&mut pairs.collect::<Vec<_>>(), &go_on),
            None => pairs
                .map(|(flow, aim)| aim.map_or(Ok(Next::Idle), |aim| flow.next(&aim, &go_on)))
                .collect(),
        };
        for ((told, next), (flow, carried)) in told.iter_mut().zip(next).zip(flows.iter_mut()) {
            match next {
                Ok(Next::Idle) => {}
                Ok(Next::Moved) => **carried += flow.bound_directions(),
                Ok(Next::Reached) => *told = Some(Ok(())),
                Ok(Next::Stopped) => *told = Some(Err(SimulateError::Stopped)),
                Err(error) => *told = Some(Err(error)),
            }
        }
    }
}

/// One solution with its directions.
struct Growth<'s, R: Real> {
    flow: Integrator<'s, R>,
    growths: Vec<f64>,
    left: f64,
    /// ln of what the directions were divided by within the interval.
    carried: f64,
    ended: Option<Result<Option<LyapunovExponent>, SimulateError>>,
}

impl<'s, R: Real> Growth<'s, R> {
    fn new(
        system: &'s System<R>,
        time: &R::Element,
        state: &[R::Element],
        settings: &LyapunovSettings<R::Element>,
    ) -> Result<Self, SimulateError> {
        let n = system.variables;
        if system.directions() != n {
            let given = system.directions();
            return Err(SimulateError::WrongDimension { states: n, given });
        }
        let flow = Integrator::new(system, time, state, settings.integration)?;
        Ok(Self { flow, growths: Vec::new(), left: 0.0, carried: 0.0, ended: None })
    }

    /// The end of an interval.
    fn hear(&mut self, told: Result<(), SimulateError>, counts: bool) {
        if let Err(error) = told {
            self.ended = Some(Err(error));
            return;
        }
        let growth =
            self.flow.normalise_directions(&mut self.left) + std::mem::take(&mut self.carried);
        if growth == f64::NEG_INFINITY && !counts {
            // Forgotten in the transient, by a rest say: what comes after it has perturbations of its own.
            self.flow.restart_directions();
            self.left = 0.0;
        } else if growth == f64::NEG_INFINITY {
            // All directions are zero, for good.
            self.ended = Some(Ok(Some(LyapunovExponent { value: growth, error: 0.0 })));
        } else if !growth.is_finite() {
            self.ended = Some(Err(SimulateError::NotFinite { time: self.flow.seconds() }));
        } else if counts {
            self.growths.push(growth);
        }
    }

    fn exponent(&self, interval: f64) -> Result<Option<LyapunovExponent>, SimulateError> {
        if self.growths.is_empty() {
            return Ok(None);
        }
        let (value, error) = mean(&self.growths);
        let error = error.max(wandering(&self.growths, value));
        let (value, error) = (value / interval, error / interval);
        if value.is_finite() && !error.is_nan() {
            Ok(Some(LyapunovExponent { value, error }))
        } else {
            Err(SimulateError::NotFinite { time: self.flow.seconds() })
        }
    }
}

/// log2 of what directions may grow or decay to within an interval.
const FAR: f64 = 300.0;

impl<R: Real> Integrator<'_, R> {
    /// Divides all directions by a power of two where they leave the middle of the range of doubles; returns its ln.
    fn bound_directions(&mut self) -> f64 {
        let real = &self.system.real;
        let directions = &mut self.state[self.system.variables..];
        let power = real.log2_of_largest(directions.iter()).round();
        if !(power.is_finite() && power.abs() > FAR) {
            return 0.0;
        }
        let factor = real.double((-power).exp2());
        directions.iter_mut().for_each(|x| real.scale(x, &factor));
        power * std::f64::consts::LN_2
    }

    /// The directions of a start.
    fn restart_directions(&mut self) {
        let (real, n) = (&self.system.real, self.system.variables);
        for (place, x) in self.state[n..].iter_mut().enumerate() {
            *x = real.double(if place / n == place % n { 1.0 } else { 0.0 });
        }
    }

    /// Divides all directions by a power of two near their largest component (no rounding errors);
    /// `left` is ln of what is left of it. Returns the growth since the time before.
    fn normalise_directions(&mut self, left: &mut f64) -> f64 {
        let real = &self.system.real;
        let directions = &mut self.state[self.system.variables..];
        let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        let largest = directions.iter().map(|x| real.log2(x)).fold(f64::NEG_INFINITY, larger);
        let power = largest.round().clamp(-900.0, 900.0);
        let factor = real.double((-power).exp2());
        directions.iter_mut().for_each(|x| real.scale(x, &factor));
        let before = std::mem::replace(left, (largest - power) * std::f64::consts::LN_2);
        largest * std::f64::consts::LN_2 - before
    }
}

/// How far the sums of the values go from those of their mean, per value: what an oscillation of the
/// growth leaves in a mean over a time that is no multiple of its period, which blocks of nearly whole
/// periods do not show. For independent values it is about as large as the standard error.
fn wandering(values: &[f64], mean: f64) -> f64 {
    let mut sum = 0.0;
    let (mut least, mut largest) = (0.0f64, 0.0f64);
    for value in values {
        sum += value - mean;
        (least, largest) = (least.min(sum), largest.max(sum));
    }
    (largest - least) / values.len() as f64
}

/// The mean and its standard error from at most 20 blocks; infinite for one.
fn mean(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let size = values.len().div_ceil(20).max(1);
    let blocks: Vec<f64> =
        values.chunks_exact(size).map(|block| block.iter().sum::<f64>() / size as f64).collect();
    if blocks.len() < 2 {
        return (mean, f64::INFINITY);
    }
    let count = blocks.len() as f64;
    let variance = blocks.iter().map(|block| (block - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}
