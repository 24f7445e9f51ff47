//! Periodic functions by their harmonics:
//!
//!   sum_k c_k cos(k w t) + s_k sin(k w t).

use std::f64::consts::PI;

/// By what share of the largest work of d two maxima may differ that count as one.
const TIE: f64 = 1e-9;

/// sum_k c_k cos(k w t) + s_k sin(k w t), from its values at equidistant times, twice as many as harmonics and two.
pub(super) struct Waves {
    frequency: f64,
    terms: Vec<[f64; 2]>,
}

impl Waves {
    pub fn new(period: f64, values: &[f64]) -> Self {
        let count = values.len();
        let term = |k: usize| {
            let factor = if k == 0 { 1.0 } else { 2.0 } / count as f64;
            let angle = |j: usize| 2.0 * PI * ((j * k) % count) as f64 / count as f64;
            let sum = |wave: fn(f64) -> f64| {
                values.iter().enumerate().map(|(j, value)| value * wave(angle(j))).sum::<f64>()
            };
            [factor * sum(f64::cos), factor * sum(f64::sin)]
        };
        Self { frequency: 2.0 * PI / period, terms: (0..count / 2).map(term).collect() }
    }

    /// The derivative of an order, every harmonic times a function of its frequency.
    pub fn value(&self, t: f64, order: u32, factor: &dyn Fn(f64) -> f64) -> f64 {
        let term = |(k, [c, s]): (usize, &[f64; 2])| {
            let w = k as f64 * self.frequency;
            let (sin, cos) = (w * t).sin_cos();
            let mut pair = [*c, *s];
            for _ in 0..order {
                pair = [w * pair[1], -w * pair[0]];
            }
            factor(w) * (pair[0] * cos + pair[1] * sin)
        };
        self.terms.iter().enumerate().map(term).sum()
    }

    /// The places and the values of the largest maxima of sign * this, in a period.
    pub fn largest(&self, sign: f64) -> Vec<(f64, f64)> {
        let cells = 64 * self.terms.len();
        let period = 2.0 * PI / self.frequency;
        let at = |n: usize| period * n as f64 / cells as f64;
        let of = |t: f64, order: u32| sign * self.value(t, order, &|_| 1.0);
        let mut found: Vec<(f64, f64)> = Vec::new();
        for n in 0..cells {
            if of(at(n), 1) > 0.0 && of(at(n + 1), 1) <= 0.0 {
                let (mut low, mut high) = (at(n), at(n + 1));
                for _ in 0..60 {
                    let middle = f64::midpoint(low, high);
                    if of(middle, 1) > 0.0 { low = middle } else { high = middle }
                }
                found.push((low, of(low, 0)));
            }
        }
        let largest = found.iter().map(|place| place.1).fold(0.0, f64::max);
        found.retain(|place| place.1 > 0.0 && place.1 >= (1.0 - TIE) * largest);
        found.iter().map(|(t, value)| (*t, sign * value)).collect()
    }
}
