//! The harmonics of a motion from its values at the phases s_i = 2 pi (i + 1/2)/M, i < M, by the trapezoidal rule:
//!
//!   c_k = w_k sum_i x(s_i) cos(k s_i),   s_k = w_k sum_i x(s_i) sin(k s_i),   w_0 = 1/M, w_k = 2/M,
//!
//! exact but for the harmonics beyond M/2, each phase once that no symmetry takes to another. M is a multiple of 4, so that
//! harmonics that fold onto lower ones keep their parity.

use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::lobachevsky_function::Point;
use rug::Rational;

/// Times the geometric series of what lies beyond the harmonics that are seen: it covers
/// harmonics that fall like k^-4, too.
const SAFETY: f64 = 4.0;

/// Below this a weight is zero.
const ROUNDING: f64 = 1e-14;

/// What the harmonics beyond `kept` add at most: those that are seen, and what they let expect of those that are not
/// seen, which are left out and fold onto the ones that are. Sizes below the errors of the values show
/// nothing.
pub(crate) fn left_out(harmonics: &[(f64, f64)], kept: usize, error: f64) -> f64 {
    let size = |from: usize, to: usize| -> f64 {
        harmonics.iter().take(to).skip(from).map(|(c, s)| c.hypot(*s)).sum()
    };
    let count = harmonics.len();
    let middle = count.div_ceil(4) * 3;
    let (inner, outer) = (size(count / 2, middle), size(middle, count));
    let beyond = match outer / inner {
        _ if outer <= error => 0.0,
        ratio if ratio < 0.5 => SAFETY * outer * ratio / (1.0 - ratio),
        _ => f64::INFINITY,
    };
    size(kept + 1, count) + 2.0 * beyond
}

/// The coefficients x_n at the phases 2 pi (i + 1/2)/M, each sequence once: x(-s) = x(s) of a motion that starts at rest,
/// x(s + pi) = -x(s) under an odd force.
pub(crate) struct Phases {
    /// Of every sequence the first phase that has it.
    pub distinct: Vec<(Point, Vec<Ball>)>,
    /// The index in `distinct` and the sign of every phase.
    images: Vec<(usize, f64)>,
}

impl Phases {
    /// Nothing when stopped, or where a phase has no value.
    pub fn new(
        count: usize,
        balls: Balls,
        stop: &Stop,
        at: impl Fn(&Point) -> Option<Vec<Ball>>,
    ) -> Option<Self> {
        let (mut distinct, mut images): (Vec<(Point, Vec<Ball>)>, Vec<_>) =
            (Vec::new(), Vec::new());
        for i in 0..count {
            if stop.asked() {
                return None;
            }
            let point = Point::PiTimes(Rational::from((2 * i as u64 + 1, count as u64)));
            let list = at(&point)?;
            let negative: Vec<Ball> = list.iter().map(|c| balls.neg(c)).collect();
            let is = |other: &[Ball], list: &[Ball]| {
                list.iter().zip(other).all(|(one, other)| one.overlaps(other))
            };
            let known = distinct.iter().enumerate().find_map(|(index, (_, known))| {
                let sign = if is(known, &list) { 1.0 } else { -1.0 };
                (sign > 0.0 || is(known, &negative)).then_some((index, sign))
            });
            images.push(known.unwrap_or((distinct.len(), 1.0)));
            if known.is_none() {
                distinct.push((point, list));
            }
        }
        Some(Self { distinct, images })
    }

    /// The largest |x_0|.
    pub fn size(&self) -> f64 {
        let first = self.distinct.iter().filter_map(|(_, list)| list.first());
        first.map(|x| x.midpoint().to_f64().abs()).fold(0.0, f64::max)
    }

    /// The mean over all phases of what every distinct one has.
    pub fn mean(&self, list: impl Iterator<Item = f64>) -> f64 {
        let list: Vec<f64> = list.collect();
        let all = self.images.iter().filter_map(|(index, _)| list.get(*index));
        all.sum::<f64>() / self.images.len() as f64
    }

    /// The weights of [`Self::weights`] as balls; nothing when stopped.
    pub fn exact_weights(
        &self,
        balls: Balls,
        stop: &Stop,
    ) -> Option<[impl Iterator<Item = Vec<Ball>>; 2]> {
        let count = self.images.len();
        let turn =
            |j: usize| balls.mul_rational(&balls.pi(), &Rational::from((j as u64, count as u64)));
        let (mut cosines, mut sines) = (Vec::new(), Vec::new());
        for angle in (0..2 * count).map(turn) {
            if stop.asked() {
                return None;
            }
            cosines.push(balls.cos(&angle));
            sines.push(balls.sin(&angle));
        }
        let rows = |table: Vec<Ball>| {
            let row = move |k: usize| {
                let weight = Rational::from((if k == 0 { 1 } else { 2 }, count as u64));
                let mut row = vec![balls.zero(); self.distinct.len()];
                for (i, (index, sign)) in self.images.iter().enumerate() {
                    let at = &table[(k * (2 * i + 1)) % (2 * count)];
                    let sum = &row[*index];
                    row[*index] = if *sign > 0.0 { balls.add(sum, at) } else { balls.sub(sum, at) };
                }
                row.iter().map(|sum| balls.mul_rational(sum, &weight)).collect()
            };
            (0..count / 2).map(row)
        };
        Some([cosines, sines].map(rows))
    }

    /// The weights of the distinct phases in c_k, then in s_k, row by row, k < M/2.
    pub fn weights(&self) -> [impl Iterator<Item = Vec<f64>>; 2] {
        let count = self.images.len();
        let rows = |of: fn(f64) -> f64| {
            let angle = |turns: usize| turns as f64 * std::f64::consts::PI / count as f64;
            let table: Vec<f64> = (0..2 * count).map(|turns| of(angle(turns))).collect();
            let row = move |k: usize| {
                let mut row = vec![0.0; self.distinct.len()];
                let weight = if k == 0 { 1.0 } else { 2.0 } / count as f64;
                for (i, (index, sign)) in self.images.iter().enumerate() {
                    // Reduced before it is rounded.
                    row[*index] += sign * weight * table[(k * (2 * i + 1)) % (2 * count)];
                }
                // Weights that cancel.
                row.iter_mut().filter(|w| w.abs() < ROUNDING).for_each(|w| *w = 0.0);
                row
            };
            (0..count / 2).map(row)
        };
        [rows(f64::cos), rows(f64::sin)]
    }
}
