//! The period from the equation in the time domain, which shares nothing with an expansion.
//!
//! A turn is the time between turning points x' = 0 on the same side; of a limit cycle, when two turns
//! take equally long and end at the same x (turns into a focus take equally long, too). An unstable
//! cycle is approached backwards in time.

use super::setting::Setting;
use crate::{Error, Exact};
use lindstedt_algebra::Stop;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_orbit::Start;
use lindstedt_simulate::{
    Doubles, Event, EventKind, Integrator, Model, Parameters, Real, Report, Settings, System,
    Trajectory,
};
use rug::{Float, Rational};
use std::cell::Cell;
use std::collections::BTreeMap;
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
    subject: Subject<'a>,
    /// Whether time runs backwards.
    reversed: bool,
}

/// What moves.
#[derive(Clone, Copy)]
enum Subject<'a> {
    /// What an expansion is made of.
    Expanded(&'a Setting),
    /// An equation with its values, from x(0) at rest or into a limit cycle.
    Equation(&'a Problem, &'a BTreeMap<String, Rational>, Option<&'a Rational>),
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
        Self::of(Subject::Expanded(setting), stop)
    }

    /// The motion of an equation that need have no expansion: from x(0) at rest, or without one into a limit cycle.
    pub fn of_equation(
        problem: &'a Problem,
        values: &'a BTreeMap<String, Rational>,
        start: Option<&'a Rational>,
        stop: &Stop,
    ) -> Self {
        Self::of(Subject::Equation(problem, values, start), stop)
    }

    fn of(subject: Subject<'a>, stop: &Stop) -> Self {
        let [forwards, backwards] = [false, true].map(|reversed| Self { subject, reversed });
        if forwards.condition() != Condition::LimitCycle {
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
        match self.subject {
            // The equation that was integrated is that of x/a.
            Subject::Expanded(setting)
                if setting.problem.amplitude == AmplitudeRole::InSmallParameter =>
            {
                let amplitude = setting.amplitude.ball(Balls::new(64)).midpoint().to_f64();
                samples.iter_mut().for_each(|x| *x *= amplitude);
            }
            _ => {}
        }
        Ok(Start::from_samples(period, &samples))
    }

    fn condition(&self) -> Condition {
        match self.subject {
            Subject::Expanded(setting) => setting.condition,
            Subject::Equation(_, _, None) => Condition::LimitCycle,
            Subject::Equation(_, _, Some(_)) => Condition::InitialAmplitude,
        }
    }

    /// The values of the parameters and the first x.
    fn values(&self, balls: Balls) -> (Parameters, Float) {
        let mut parameters = Parameters::new();
        let float = |exact: &Exact| exact.ball(balls).midpoint().clone();
        let cycle = || Float::with_val(53, 2);
        match self.subject {
            Subject::Expanded(setting) => {
                let problem = &setting.problem;
                for (name, value) in setting.at.iter().filter(|(name, _)| *name != *problem.small) {
                    parameters.set(name, value.clone());
                }
                match setting.rational_small() {
                    Some(small) => parameters.set(&problem.small, small),
                    None => parameters.set(&problem.small, setting.small(balls).midpoint().clone()),
                }
                // The pendulum's equation is in y = x/a, Duffing's in rho = eps a^2; those of files are in x.
                let start = match (setting.condition, problem.amplitude) {
                    (Condition::LimitCycle, _) => cycle(),
                    (_, AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::Scaled) => {
                        float(&setting.amplitude)
                    }
                    _ => Float::with_val(53, 1),
                };
                (parameters, start)
            }
            Subject::Equation(_, values, start) => {
                values.iter().for_each(|(name, value)| parameters.set(name, value.clone()));
                (parameters, start.map_or_else(cycle, |x| float(&Exact::Rational(x.clone()))))
            }
        }
    }

    /// The equation with its values, and where the motion starts.
    fn system<R: Real>(&self, real: &R) -> Result<(System<R>, [R::Element; 2]), Error> {
        let mut problem = match self.subject {
            Subject::Expanded(setting) => setting.problem.clone(),
            Subject::Equation(problem, ..) => problem.clone(),
        };
        if self.reversed {
            let turned =
                |leaf: &Expression| (*leaf == Expression::VELOCITY).then(|| -Expression::VELOCITY);
            problem.equation = problem.equation.map(&turned);
        }
        let (parameters, start) = self.values(Balls::new(real.bits() + 16));
        let model = Model::of_problem(&problem)?.with_section(Expression::VELOCITY);
        let system = model.compile(real.clone(), &parameters)?;
        Ok((system, [real.float(&start), real.zero()]))
    }

    /// The first turn; of a limit cycle the first that has settled to 10^(1-digits), x to the root of
    /// that: the period is the more exact one of both.
    pub fn turn<R: Real>(&self, real: &R, digits: u32, stop: &Stop) -> Result<Turn, Error> {
        let bits = real.bits() + 16;
        let cycle = match self.condition() {
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
        // The first turning point is on the other side than the start at rest, which may be the least x.
        let side = Cell::new(cycle.then_some(false));
        let ends_turn = |kind| match (kind, side.get()) {
            (EventKind::Section { section: 0, rising }, Some(side)) => rising == side,
            (EventKind::Section { section: 0, rising }, None) => {
                side.set(Some(!rising));
                false
            }
            _ => false,
        };
        flow.advance(&real.double(1e6), &mut |report| {
            let busy = matches!(report, Report::Busy);
            segments.set(segments.get() + u32::from(!busy));
            let ends = stop.asked()
                || segments.get() > MOST_SEGMENTS
                || matches!(report, Report::Event(event) if ends_turn(event.kind) && observe(event));
            if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        found.ok_or_else(|| {
            if stop.asked() {
                return ExpandError::Interrupted { order: 0 }.into();
            }
            let Subject::Expanded(setting) = self.subject else { return Error::NoValue };
            let small = setting.small(Balls::new(bits)).midpoint().to_f64();
            let (parameter, value) = (setting.problem.small.to_string(), small.to_string());
            Error::NoPeriodicOrbit { parameter, value }
        })
    }
}
