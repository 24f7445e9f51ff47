//! The response in the time domain along a parameter: every value starts from the end of the one before, and the harmonic
//! of the response is read over its own period.
//!
//! x at n equidistant times of the period 2 pi q/Omega of a response with the harmonics k_j = p_j/q gives
//! a_j e^(i phi_j) = (2/n) sum_m x_j(t_m) e^(-2 pi i p_j m/n), but for harmonics n - p_j and higher.

use super::set_up;
use super::{Start, precomputed};
use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, Progress, Work};
use lindstedt_simulate::{
    DiagramSettings, Doubles, Point, Quantity, Section, Settings, Sweep, diagram,
};
use rug::{Integer, Rational};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Samples of the fastest harmonic per period of it.
const SAMPLES: u32 = 32;
/// Periods of the force at every value before the harmonic is read.
const PERIODS: u32 = 100;
/// So many times as long at most, while the harmonic still moves: after a jump.
const MOST_STAYS: usize = 10;
/// What is left of that, in parts of the harmonic.
const SETTLED: f64 = 1e-3;
/// A harmonic that falls and is below this part of the largest amplitudes looked at tends to zero.
const ZERO: f64 = 1e-6;

/// The harmonics at one value.
pub(crate) struct Reading {
    pub value: Exact,
    /// a_j e^(i phi_j); nothing where the motion ended or did not settle.
    pub harmonics: Option<Vec<[f64; 2]>>,
}

/// What is read off a motion.
pub(crate) struct Harmonics {
    /// k_j.
    pub turns: Vec<Rational>,
    /// P^-1 of q = P^-1 x, of which the harmonics are; nothing where q is x.
    pub modes: Option<Vec<Vec<f64>>>,
}

/// Bits of the denominators of harmonics that have a period with the others.
const LONGEST: u32 = 10;

impl Harmonics {
    /// p_j and q of the k_j = p_j/q; of one that has no period with the others p_j is no number: in a periodic motion this
    /// harmonic is zero.
    pub fn of_one_period(&self) -> (Vec<f64>, Integer) {
        let is_whole = |k: &&Rational| k.denom().significant_bits() <= LONGEST;
        let q = self.turns.iter().filter(is_whole).fold(Integer::from(1), |q, k| q.lcm(k.denom()));
        let whole = |k: &Rational| match is_whole(&k) {
            true => Rational::from(k * &q).to_f64(),
            false => f64::NAN,
        };
        (self.turns.iter().map(whole).collect(), q)
    }
}

/// The harmonics of the points of one period.
type Reader<'a> = dyn Fn(&[Point<f64>]) -> Vec<[f64; 2]> + 'a;

/// How the period of a response is sampled.
struct Sampling {
    /// p_j.
    harmonics: Vec<f64>,
    /// n.
    count: u32,
    /// q/n.
    part: f64,
    /// Periods of the response before.
    periods: u32,
}

impl Sampling {
    fn of(wanted: &Harmonics) -> Self {
        let (harmonics, q) = wanted.of_one_period();
        let most = harmonics.iter().fold(1.0f64, |most, p| most.max(p.abs()));
        let count = SAMPLES * (most as u32).min(64);
        let periods = PERIODS.div_ceil(q.to_u32().unwrap_or(1).max(1));
        Self { harmonics, count, part: q.to_f64() / f64::from(count), periods }
    }
}

impl Oscillator {
    /// The harmonics k_j of the forced motion at the values of an axis, upwards and then downwards; fewer where the work
    /// is stopped. `largest` is the largest amplitude looked at.
    ///
    /// # Errors
    /// [`Refused`] for a parameter that cannot be varied, and without a force of one period.
    pub(crate) fn followed(
        &self,
        axis: &Axis,
        wanted: &Harmonics,
        largest: f64,
        work: &Work,
    ) -> Result<[Vec<Reading>; 2], Error> {
        let setup = set_up(self, &Start::default(), true, precomputed(work))?;
        let usage = |message: String| Refused::usage("follow", message, "lindstedt simulate");
        if !setup.sweepable.contains(&axis.name) {
            return Err(usage(format!("{} cannot be varied in time", axis.name)).into());
        }
        let forcing = setup.forcing_at(axis)?.map(|period| period.float(64).to_f64());
        let forcing = forcing.ok_or_else(|| usage("no force with one period".to_owned()))?;
        let Sampling { harmonics, count, part, periods } = Sampling::of(wanted);
        let mut found = [Vec::new(), Vec::new()];
        let mut start: Vec<f64> = setup.flow.states().map(|x| x.float(64).to_f64()).collect();
        for (k, list) in found.iter_mut().enumerate() {
            let mut values = axis.values.clone();
            if k == 1 {
                values.reverse();
            }
            let quantities: Vec<Quantity> = values.iter().cloned().map(Quantity::from).collect();
            let own = |value: &Quantity| setup.period_at(&axis.name, value);
            let forces: Vec<f64> = quantities.iter().filter_map(own).collect::<Result<_, _>>()?;
            let mut settings = DiagramSettings {
                time: 0.0,
                start: start.clone(),
                section: Section::Period(part * forcing),
                periods: forces.into_iter().map(|period| part * period).collect(),
                transient: 0,
                kept: (periods + 1) * count,
                follow: true,
                integration: Settings::for_digits(16),
            };
            let sweep = Sweep {
                model: &setup.flow.model,
                parameters: &setup.flow.parameters,
                name: &axis.name,
                values: &quantities,
            };
            let all = values.len();
            let read = |points: &[Point<f64>]| read(points, &harmonics, wanted.modes.as_deref());
            let reader: (&Reader<'_>, f64) = (&read, ZERO * largest);
            for (index, value) in values.into_iter().enumerate() {
                let harmonics = settled(&sweep, &mut settings, index, count as usize, reader, work);
                if work.stop.asked() {
                    return Ok(found);
                }
                list.push(Reading { value, harmonics });
                if !work.goes_on(Progress::Parts(k * all + list.len(), 2 * all)) {
                    return Ok(found);
                }
            }
            start = settings.start;
        }
        Ok(found)
    }
}

/// The harmonics at one value once they do not move any more, as [`is_settled`] has it; the start becomes the end.
fn settled(
    sweep: &Sweep<'_>,
    settings: &mut DiagramSettings<f64>,
    index: usize,
    count: usize,
    (read, zero): (&Reader<'_>, f64),
    work: &Work,
) -> Option<Vec<[f64; 2]>> {
    let flow = |on| if on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    for _ in 0..MOST_STAYS {
        let mut found = None;
        let tick = || flow(!work.stop.asked());
        diagram(sweep, &Doubles, settings, index..index + 1, &tick, &mut |column| {
            found = column.points.ok();
            flow(true)
        });
        let points = found.filter(|points| points.len() == settings.kept as usize)?;
        settings.start.clone_from(&points.last()?.state);
        let last = points.len() / count - 1;
        let three = [0, last / 2, last].map(|k| read(&points[k * count..(k + 1) * count]));
        if falls_to_zero(&three, zero) {
            return Some(vec![[0.0; 2]; three[2].len()]);
        }
        if is_settled(&three) {
            let [.., last] = three;
            return Some(last);
        }
    }
    None
}

/// The largest |a_j e^(i phi_j)|.
fn size(read: &[[f64; 2]]) -> f64 {
    read.iter().fold(0.0f64, |size, w| size.max(w[0].hypot(w[1])))
}

/// Whether what is read at three times falls, and is below what counts as zero.
fn falls_to_zero(three: &[Vec<[f64; 2]>; 3], zero: f64) -> bool {
    let [a, b, c] = three.each_ref().map(|read| size(read));
    c <= zero && c <= b && b <= a
}

/// Whether what is read at three equidistant times is at rest: a difference that shrinks by r from one to the next leaves
/// r/(1 - r) of the second.
fn is_settled([a, b, c]: &[Vec<[f64; 2]>; 3]) -> bool {
    let apart = |a: &[[f64; 2]], b: &[[f64; 2]]| {
        let pairs = a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        pairs.fold(0.0, f64::max)
    };
    let size = size(c);
    let (first, second) = (apart(a, b), apart(b, c));
    second <= 1e-8 * size || (second < first && second * second < SETTLED * size * (first - second))
}

/// The harmonics of the points of one period, the last of them at its end.
fn read(points: &[Point<f64>], harmonics: &[f64], modes: Option<&[Vec<f64>]>) -> Vec<[f64; 2]> {
    let n = points.len() as f64;
    let unknown = |point: &Point<f64>, i: usize| point.state.get(2 * i).copied();
    let mode = |point: &Point<f64>, j: usize| match modes {
        None => unknown(point, j),
        Some(rows) => {
            rows.get(j)?.iter().enumerate().map(|(i, p)| Some(p * unknown(point, i)?)).sum()
        }
    };
    let harmonic = |(j, p): (usize, &f64)| {
        if p.is_nan() {
            return [0.0; 2];
        }
        let mut sum = [0.0, 0.0];
        for (m, point) in (1..).zip(points) {
            let angle = TAU * p * f64::from(m) / n;
            let x = mode(point, j).unwrap_or(f64::NAN);
            sum = [sum[0] + x * angle.cos(), sum[1] - x * angle.sin()];
        }
        sum.map(|s| 2.0 * s / n)
    };
    harmonics.iter().enumerate().map(harmonic).collect()
}
