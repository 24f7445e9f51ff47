//! The competitor: the period from the equation in the time domain.

use super::Reason;
use crate::Error;
use crate::evaluate::setting::Setting;
use lindstedt_equation::{AmplitudeRole, Condition, Expression};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Real, Report, Settings,
};
use rug::Float;
use std::ops::ControlFlow;

/// Turns after which a limit cycle must have been reached.
const MOST_TURNS: usize = 1000;
/// The second run, which tells the error of the first, has so many digits less.
const LESS: u32 = 3;

type Outcome = Result<(Float, Float, u64), Reason>;

pub(super) fn in_doubles(
    setting: &Setting,
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> Outcome {
    both(setting, (Doubles, Doubles), digits, goes_on)
}

pub(super) fn in_digits(
    setting: &Setting,
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> Outcome {
    let less = Digits::for_digits(digits.saturating_sub(LESS).max(4));
    both(setting, (Digits::for_digits(digits), less), digits, goes_on)
}

/// Two runs: the result of the finer, four times the difference as its error (which is that of
/// the coarser one), and the rounding errors of some hundred steps.
fn both<R: Real>(
    setting: &Setting,
    (fine, coarse): (R, R),
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> Outcome {
    let (value, bytes) = period(setting, &fine, digits, goes_on)?;
    let (other, _) = period(setting, &coarse, digits.saturating_sub(LESS).max(4), goes_on)?;
    let difference = Float::with_val(53, &value - &other).abs() * 4u32;
    let rounding = (Float::with_val(53, value.abs_ref()) * 64u32) >> (fine.bits() - 1);
    let step = Float::with_val(53, value.abs_ref())
        * Float::with_val(53, Float::i_pow_u(10, digits)).recip();
    Ok((value, difference + rounding + step, bytes))
}

/// The time between turning points x' = 0 on the same side; of a limit cycle, when two turns take
/// equally long.
fn period<R: Real>(
    setting: &Setting,
    real: &R,
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<(Float, u64), Reason> {
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
    let cycle = match setting.condition {
        Condition::LimitCycle => true,
        Condition::InitialAmplitude => false,
        // Where the solution starts is part of the expansion.
        _ => return Err(Reason::Refused(Error::NoValue)),
    };
    // The pendulum's equation is in y = x/a, Duffing's in rho = eps a^2; those of files are in x.
    let start = match problem.amplitude {
        _ if cycle => Float::with_val(bits, 2),
        AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::Scaled => {
            Float::with_val(bits, setting.amplitude.ball(balls).midpoint())
        }
        _ => Float::with_val(bits, 1),
    };
    let failed = Reason::NotIntegrated;
    let model = Model::of_problem(problem).map_err(failed)?.with_section(Expression::VELOCITY);
    let system = model.compile(real.clone(), &parameters).map_err(failed)?;
    let start = [real.float(&start), real.zero()];
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).map_err(failed)?;
    let tolerance = 10f64.powi(-(digits.min(300) as i32));
    let mut last = real.to_float(&real.zero());
    let mut length: Option<Float> = None;
    let mut found = None;
    let mut turns = 0;
    let outcome = flow.advance(&real.double(1e6), &mut |report| {
        if !goes_on() {
            return ControlFlow::Break(());
        }
        let Report::Event(event) = report else { return ControlFlow::Continue(()) };
        if event.kind != (EventKind::Section { section: 0, rising: false }) {
            return ControlFlow::Continue(());
        }
        let time = real.to_float(event.time);
        let turn = Float::with_val(bits, &time - &last);
        let settled = length
            .as_ref()
            .is_some_and(|before| Float::with_val(53, &turn - before).abs() <= 10.0 * tolerance);
        turns += 1;
        if !cycle || settled {
            found = Some(turn.clone());
        }
        if found.is_some() || turns >= MOST_TURNS {
            return ControlFlow::Break(());
        }
        (last, length) = (time, Some(turn));
        ControlFlow::Continue(())
    });
    outcome.map_err(failed)?;
    if turns >= MOST_TURNS && found.is_none() {
        let (parameter, value) = (problem.small.to_string(), setting.small(balls));
        let value = value.midpoint().to_f64().to_string();
        return Err(Reason::Refused(Error::NoPeriodicOrbit { parameter, value }));
    }
    let interrupted = || Reason::Refused(Error::from(ExpandError::Interrupted { order: 0 }));
    let found = found.ok_or_else(interrupted)?;
    // Two states and some ten operations of the equation, each a Taylor polynomial.
    let order = 1.15 * f64::from(digits) + 4.0;
    let value = if real.bits() <= 53 { 8 } else { real.bits() / 8 + 32 };
    Ok((found, (order * 12.0) as u64 * u64::from(value)))
}
