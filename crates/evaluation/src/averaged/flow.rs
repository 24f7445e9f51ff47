//! a(t) and psi(t): exponentials where the rates are linear, else integrated.

use super::truncated::Truncated;
use lindstedt_simulate::{Digits, Integrator, Report, Settings, SimulateError, Trajectory};
use rug::Float;
use std::ops::ControlFlow;

/// Digits of the second integration beyond those of the first.
const MORE: u32 = 8;

/// Steps in one period 2 pi/omega_0, on the average of an integration and after as many steps, beyond which a and
/// psi are not slow: a step is a fixed part of the radius of convergence.
const FAST: f64 = 1000.0;

/// Why an averaged motion ends.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Ended {
    /// The integration of a and psi.
    #[error(transparent)]
    Integration(#[from] SimulateError),
    /// a and psi change within a small part of the period over which they are averaged.
    #[error(
        "near t = {time:.6} a and psi change within a thousandth of a period, and averaging supposes that they are slow"
    )]
    Fast {
        /// Where.
        time: f64,
    },
}

/// a and psi at one time.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub values: [Float; 2],
    /// The estimated errors of the integration.
    pub errors: [f64; 2],
}

/// a and psi at the times asked for.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    /// In the order of the times; nothing beyond the end of the integration.
    pub states: Vec<Option<State>>,
    /// Why it ended early.
    pub ended: Option<Ended>,
}

impl Flow {
    pub(super) fn new(
        system: &Truncated,
        times: &[Float],
        digits: usize,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Self {
        if let Some([growth, frequency]) = system.linear() {
            let mut state = |t: &Float| {
                goes_on().then_some(())?;
                let bits = growth.prec();
                let power = Float::with_val(bits, &growth * t).exp() * &system.start[0];
                let turn = Float::with_val(bits, &frequency * t) + &system.start[1];
                Some(State { values: [power, turn], errors: [0.0; 2] })
            };
            return Self { states: times.iter().map(&mut state).collect(), ended: None };
        }
        let digits = u32::try_from(digits).unwrap_or(u32::MAX / 8).saturating_add(4);
        let (mut states, mut ended) = (vec![None; times.len()], None);
        for backward in [false, true] {
            let chosen: Vec<usize> =
                (0..times.len()).filter(|i| (times[*i] < 0) == backward).collect();
            if chosen.is_empty() {
                continue;
            }
            let wanted: Vec<Float> = chosen.iter().map(|i| times[*i].clone().abs()).collect();
            let mut run = |digits| integrate(system, (&wanted[..], backward), digits, goes_on);
            let (coarse, fine) = (run(digits), run(digits + MORE));
            for (place, (a, b)) in chosen.into_iter().zip(coarse.0.into_iter().zip(fine.0)) {
                let (Some(a), Some(b)) = (a, b) else { continue };
                let errors = [0, 1].map(|k| Float::with_val(53, &a[k] - &b[k]).to_f64().abs());
                states[place] = Some(State { values: b, errors });
            }
            ended = ended.or(fine.1);
        }
        Self { states, ended }
    }
}

type Values = Vec<Option<[Float; 2]>>;

/// The states at |t|, t = 0 included, and what ended the integration early.
fn integrate(
    system: &Truncated,
    (times, backward): (&[Float], bool),
    digits: u32,
    goes_on: &mut dyn FnMut() -> bool,
) -> (Values, Option<Ended>) {
    let real = Digits::for_digits(digits);
    let mut trajectory = Trajectory::new(real);
    let last = times.iter().fold(Float::new(53), |top, t| top.max(t));
    let outcome = if last.is_zero() {
        Ok(())
    } else {
        run(system, (&last, backward), digits, (&mut trajectory, goes_on))
    };
    let bits = real_bits(&real);
    let start = system.start.clone();
    let value = |t: &Float| {
        goes_on().then_some(())?;
        if t.is_zero() {
            return Some(start.clone());
        }
        let t = Float::with_val(bits, t);
        Some([trajectory.value(0, &t)?, trajectory.value(1, &t)?])
    };
    (times.iter().map(value).collect(), outcome.err())
}

fn real_bits(real: &Digits) -> u32 {
    lindstedt_simulate::Real::bits(real)
}

fn run(
    system: &Truncated,
    (last, backward): (&Float, bool),
    digits: u32,
    (trajectory, goes_on): (&mut Trajectory<Digits>, &mut dyn FnMut() -> bool),
) -> Result<(), Ended> {
    let real = Digits::for_digits(digits);
    let bits = real_bits(&real);
    let compiled = system.system(real, backward)?;
    let start: Vec<Float> = system.start.iter().map(|x| Float::with_val(bits, x)).collect();
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&compiled, &Float::new(bits), &start, settings)?;
    let (mut steps, mut fast) = (0.0, None);
    flow.advance(&Float::with_val(bits, last), &mut |report| {
        let _ = trajectory.record(report);
        if let Report::Segment(segment) = report {
            let time = segment.start.to_f64();
            steps += 1.0;
            fast = (steps > FAST * (1.0 + time / system.period())).then_some(time);
        }
        if fast.is_none() && goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    fast.map_or(Ok(()), |time| Err(Ended::Fast { time: if backward { -time } else { time } }))
}
