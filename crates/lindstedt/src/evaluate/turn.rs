//! The period from the equation in the time domain, which shares nothing with an expansion.
//!
//! A turn is the time between turning points x' = 0 on the same side; of a limit cycle, when two turns
//! take equally long and end at the same x (turns into a focus take equally long, too). An unstable
//! cycle is approached backwards in time.

use super::setting::Setting;
use crate::Error;
use lindstedt_algebra::Stop;
use lindstedt_equation::{AmplitudeRole, Condition, Expression};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_orbit::Start;
use lindstedt_simulate::{
    Doubles, Event, EventKind, Integrator, Model, Parameters, Real, Report, Settings, System,
    Trajectory,
};
use rug::Float;
use std::cell::Cell;
use std::ops::ControlFlow;

/// Turns after which a limit cycle must have been reached.
const MOST_TURNS: usize = 1000;
/// Pieces of the solution without a turning point after which the motion has escaped.
const MOST_SEGMENTS: u32 = 20_000;
/// Digits of the motion that a guess is made from.
const ROUGH: u32 = 8;
/// Points of that motion: a quarter as many harmonics.
const SAMPLES: usize = 256;

/// The motion of a problem with a value for everything.
pub(crate) struct TimeDomain<'a> {
    setting: &'a Setting,
    /// Whether time runs backwards.
    reversed: bool,
}

/// A turn of the motion.
pub(crate) struct Turn {
    /// Its time.
    pub period: Float,
    /// x at its end.
    x: Float,
}

impl<'a> TimeDomain<'a> {
    /// The motion in the direction of time in which it approaches a limit cycle.
    pub fn new(setting: &'a Setting, stop: &Stop) -> Self {
        let [forwards, backwards] = [false, true].map(|reversed| Self { setting, reversed });
        if setting.condition != Condition::LimitCycle {
            return forwards;
        }
        let settles = |motion: &Self| motion.turn(&Doubles, ROUGH, stop).is_ok();
        if !settles(&forwards) && settles(&backwards) { backwards } else { forwards }
    }

    /// A guess for the contraction test, from the motion in doubles.
    pub fn start(&self, stop: &Stop) -> Result<Start, Error> {
        let (real, found) = (Doubles, self.turn(&Doubles, ROUGH, stop)?);
        let (system, _) = self.system(&real)?;
        let (start, period) = ([found.x.to_f64(), 0.0], found.period.to_f64());
        let mut trajectory = Trajectory::new(real);
        let mut flow = Integrator::new(&system, &0.0, &start, Settings::for_digits(ROUGH))?;
        flow.advance(&period, &mut |report| trajectory.record(report))?;
        let at = |j: usize| trajectory.value(0, &(period * j as f64 / SAMPLES as f64));
        let samples: Option<Vec<f64>> = (0..SAMPLES).map(at).collect();
        let mut samples = samples.ok_or(Error::NoValue)?;
        if self.reversed {
            samples.reverse();
        }
        if self.setting.problem.amplitude == AmplitudeRole::InSmallParameter {
            // The equation that was integrated is that of x/a.
            let amplitude = self.setting.amplitude.ball(Balls::new(64)).midpoint().to_f64();
            samples.iter_mut().for_each(|x| *x *= amplitude);
        }
        Ok(Start::from_samples(period, &samples))
    }

    /// The equation with its values, and where the motion starts.
    fn system<R: Real>(&self, real: &R) -> Result<(System<R>, [R::Element; 2]), Error> {
        let (setting, bits) = (self.setting, real.bits() + 16);
        let mut problem = setting.problem.clone();
        if self.reversed {
            let turned =
                |leaf: &Expression| (*leaf == Expression::VELOCITY).then(|| -Expression::VELOCITY);
            problem.equation = problem.equation.map(&turned);
        }
        let balls = Balls::new(bits);
        let mut parameters = Parameters::new();
        for (name, value) in setting.at.iter().filter(|(name, _)| *name != *problem.small) {
            parameters.set(name, value.clone());
        }
        match setting.rational_small() {
            Some(small) => parameters.set(&problem.small, small),
            None => parameters.set(&problem.small, setting.small(balls).midpoint().clone()),
        }
        // The pendulum's equation is in y = x/a, Duffing's in rho = eps a^2; those of files are in x.
        let start = match (setting.condition, problem.amplitude) {
            (Condition::LimitCycle, _) => Float::with_val(bits, 2),
            (_, AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::Scaled) => {
                Float::with_val(bits, setting.amplitude.ball(balls).midpoint())
            }
            _ => Float::with_val(bits, 1),
        };
        let model = Model::of_problem(&problem)?.with_section(Expression::VELOCITY);
        let system = model.compile(real.clone(), &parameters)?;
        Ok((system, [real.float(&start), real.zero()]))
    }

    /// The first turn; of a limit cycle the first that has settled to 10^(1-digits), x to the root of
    /// that: the period is the more exact one of both.
    pub fn turn<R: Real>(&self, real: &R, digits: u32, stop: &Stop) -> Result<Turn, Error> {
        let bits = real.bits() + 16;
        let cycle = match self.setting.condition {
            Condition::LimitCycle => true,
            Condition::InitialAmplitude => false,
            // Where the solution starts is part of the expansion.
            _ => return Err(Error::NoValue),
        };
        let (system, start) = self.system(real)?;
        let settings = Settings::for_digits(digits);
        let mut flow = Integrator::new(&system, &real.zero(), &start, settings)?;
        let tolerance = 10f64.powi(1 - (digits.min(300) as i32));
        let near = |a: &Float, b: &Float, most: f64| Float::with_val(53, a - b).abs() <= most;
        let mut last = Float::new(bits);
        let mut before: Option<Turn> = None;
        let mut found = None;
        let mut turns = 0;
        let segments = Cell::new(0);
        let mut observe = |event: &Event<'_, R>| {
            let time = real.to_float(event.time);
            let x = event.before.first().map_or_else(|| Float::new(bits), |x| real.to_float(x));
            let turn = Turn { period: Float::with_val(bits, &time - &last), x };
            let size = turn.x.to_f64().abs();
            let settled = before.as_ref().is_some_and(|before| {
                near(&before.period, &turn.period, tolerance)
                    && near(&before.x, &turn.x, tolerance.sqrt() * size)
            });
            (turns, last) = (turns + 1, time);
            segments.set(0);
            if !cycle || settled {
                found = Some(turn);
            } else {
                before = Some(turn);
            }
            found.is_some() || turns >= MOST_TURNS
        };
        flow.advance(&real.double(1e6), &mut |report| {
            let busy = matches!(report, Report::Busy);
            segments.set(segments.get() + u32::from(!busy));
            let ends = stop.asked()
                || segments.get() > MOST_SEGMENTS
                || matches!(report, Report::Event(event)
                    if event.kind == (EventKind::Section { section: 0, rising: false })
                        && observe(event));
            if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        found.ok_or_else(|| {
            if stop.asked() {
                return ExpandError::Interrupted { order: 0 }.into();
            }
            let small = self.setting.small(Balls::new(bits)).midpoint().to_f64();
            let (parameter, value) = (self.setting.problem.small.to_string(), small.to_string());
            Error::NoPeriodicOrbit { parameter, value }
        })
    }
}
