//! The competitor: the period from the equation in the time domain.

use super::run::Found;
use crate::Error;
use crate::evaluate::setting::Setting;
use lindstedt_algebra::Stop;
use lindstedt_equation::{AmplitudeRole, Condition, Expression};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{
    Digits, Doubles, Event, EventKind, Integrator, Model, Parameters, Real, Report, Settings,
    System, Trajectory,
};
use rug::Float;
use std::ops::ControlFlow;

/// Turns after which a limit cycle must have been reached.
const MOST_TURNS: usize = 1000;
/// The second run, which tells the error of the first, has so many digits less.
const LESS: u32 = 3;
/// Digits of the motion that is sampled.
const SAMPLED: u32 = 12;

pub(super) fn in_doubles(setting: &Setting, digits: u32, stop: &Stop) -> Result<Found, Error> {
    both(setting, (Doubles, Doubles), digits, stop)
}

pub(super) fn in_digits(setting: &Setting, digits: u32, stop: &Stop) -> Result<Found, Error> {
    let less = Digits::for_digits(digits.saturating_sub(LESS).max(4));
    both(setting, (Digits::for_digits(digits), less), digits, stop)
}

/// Two runs: the result of the finer, four times the difference as its error (which is that of
/// the coarser one), and the rounding errors of some hundred steps.
fn both<R: Real>(
    setting: &Setting,
    (fine, coarse): (R, R),
    digits: u32,
    stop: &Stop,
) -> Result<Found, Error> {
    let bits = fine.bits();
    let period = turn(setting, &fine, digits, stop)?.period;
    let other = turn(setting, &coarse, digits.saturating_sub(LESS).max(4), stop)?.period;
    let difference = Float::with_val(53, &period - &other).abs() * 4u32;
    let rounding = (Float::with_val(53, period.abs_ref()) * 64u32) >> (bits - 1);
    let step = Float::with_val(53, period.abs_ref())
        * Float::with_val(53, Float::i_pow_u(10, digits)).recip();
    // Two states and some ten operations of the equation, each a Taylor polynomial.
    let order = 1.15 * f64::from(digits) + 4.0;
    let value = if bits <= 53 { 8 } else { bits / 8 + 32 };
    let bytes = (order * 12.0) as u64 * u64::from(value);
    let (summation, seconds, again) = (None, 0.0, 0.0);
    Ok(Found { summation, seconds, again, bytes, period, error: difference + rounding + step })
}

/// x at n equal steps of one period, in doubles, from a turning point on.
pub(super) fn samples(setting: &Setting, n: usize, stop: &Stop) -> Result<Vec<f64>, Error> {
    let (real, found) = (Doubles, turn(setting, &Doubles, SAMPLED, stop)?);
    let (system, _) = system(setting, &real)?;
    let (start, period) = ([found.x.to_f64(), 0.0], found.period.to_f64());
    let settings = Settings::for_digits(SAMPLED);
    let mut trajectory = Trajectory::new(real);
    let mut flow = Integrator::new(&system, &0.0, &start, settings)?;
    flow.advance(&period, &mut |report| trajectory.record(report))?;
    let at = |j: usize| trajectory.value(0, &(period * j as f64 / n as f64));
    (0..n).map(|j| at(j).ok_or(Error::NoValue)).collect()
}

/// The equation with its values, and where the motion starts.
fn system<R: Real>(setting: &Setting, real: &R) -> Result<(System<R>, [R::Element; 2]), Error> {
    let bits = real.bits() + 16;
    let problem = &setting.problem;
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
    let model = Model::of_problem(problem)?.with_section(Expression::VELOCITY);
    let system = model.compile(real.clone(), &parameters)?;
    Ok((system, [real.float(&start), real.zero()]))
}

/// A turn of the motion.
struct Turn {
    /// Its time.
    period: Float,
    /// x at its end.
    x: Float,
}

/// The time between turning points x' = 0 on the same side; of a limit cycle, when two turns take
/// equally long.
fn turn<R: Real>(setting: &Setting, real: &R, digits: u32, stop: &Stop) -> Result<Turn, Error> {
    let bits = real.bits() + 16;
    let cycle = match setting.condition {
        Condition::LimitCycle => true,
        Condition::InitialAmplitude => false,
        // Where the solution starts is part of the expansion.
        _ => return Err(Error::NoValue),
    };
    let (system, start) = system(setting, real)?;
    let mut flow = Integrator::new(&system, &real.zero(), &start, Settings::for_digits(digits))?;
    let tolerance = 10f64.powi(-(digits.min(300) as i32));
    let mut last = real.to_float(&real.zero());
    let mut length: Option<Float> = None;
    let mut found = None;
    let mut turns = 0;
    let mut observe = |event: &Event<'_, R>| {
        let time = real.to_float(event.time);
        let turn = Float::with_val(bits, &time - &last);
        let near = |before: &Float| Float::with_val(53, &turn - before).abs() <= 10.0 * tolerance;
        turns += 1;
        if !cycle || length.as_ref().is_some_and(near) {
            let x = event.before.first().map_or_else(|| Float::new(bits), |x| real.to_float(x));
            found = Some(Turn { period: turn.clone(), x });
        }
        (last, length) = (time, Some(turn));
        found.is_some() || turns >= MOST_TURNS
    };
    flow.advance(&real.double(1e6), &mut |report| {
        let ends = stop.asked()
            || matches!(report, Report::Event(event)
                if event.kind == (EventKind::Section { section: 0, rising: false })
                    && observe(event));
        if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if turns >= MOST_TURNS && found.is_none() {
        let (parameter, value) =
            (setting.problem.small.to_string(), setting.small(Balls::new(bits)));
        let value = value.midpoint().to_f64().to_string();
        return Err(Error::NoPeriodicOrbit { parameter, value });
    }
    found.ok_or_else(|| ExpandError::Interrupted { order: 0 }.into())
}
