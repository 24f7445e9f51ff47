//! What the orders beyond N may add, judged by those that are known.
//!
//! The terms t_n of x, a'/a and psi' are taken to fall like q^n,
//!
//!   q = max (|t_n|/t)^(1/n),   t = |x_0|, omega_0, omega_0,
//!
//! over the last two orders n that do not vanish of each of the three: orders vanish by symmetry, two
//! in a row by accident (B_3 = B_4 = 0 for x'' + x + eps (x^2 + x'^2) = 0), and say nothing. The rest
//! is the larger of |t_n| q^(N - n) for these two n, and t q^(N + 1) where all orders vanish; but a' = 0
//! to every order where the motion can be run backwards. |t_n| is the largest among amplitudes passed
//! through and some below the largest one: a polynomial in a has zeros, as A_1 on a limit cycle.

use super::truncated::Truncated;
use lindstedt_derivation::averaging::numbers::{Numbers, Terms};
use rug::Float;
use rug::ops::Pow;

/// The orders of the rates apart from each other.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    /// eps^n A_n and eps^n B_n by n.
    rates: [Vec<Terms>; 2],
    /// N.
    order: usize,
    frequency: f64,
    is_reversible: bool,
}

/// Amplitudes from half the largest on that are looked at, besides those passed through.
const BELOW: u32 = 4;

/// |sum c a^n|.
fn size(terms: &Terms, a: &Float) -> f64 {
    let mut sum = Float::new(a.prec());
    for (n, c) in terms.iter().filter(|(_, c)| !c.is_zero()) {
        sum += Float::with_val(a.prec(), a.pow(*n)) * c;
    }
    sum.to_f64().abs()
}

/// What is looked at of amplitudes passed through.
pub(super) fn looked_at(passed: impl Iterator<Item = Float>) -> Vec<Float> {
    let mut list: Vec<Float> = passed.collect();
    if let Some(top) = list.iter().cloned().reduce(|a, b| a.max(&b)) {
        let part = |k: u32| top.clone() * (BELOW + k) / (2 * BELOW);
        list.extend((0..BELOW).map(part));
    }
    list
}

/// The last two of the sizes t_1, t_2, ... that do not vanish, with their n.
fn last_two(sizes: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let orders = sizes.iter().copied().enumerate().skip(1).rev();
    orders.filter(|(_, size)| *size != 0.0).take(2)
}

/// The larger one; NaN if one of them is.
fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn power(q: f64, n: usize) -> f64 {
    q.powi(i32::try_from(n).unwrap_or(i32::MAX))
}

impl Rest {
    pub(super) fn new(found: &Numbers, small: &Float, is_reversible: bool) -> Self {
        let scaled = |orders: &Vec<Terms>| -> Vec<Terms> {
            let times = |(terms, n): (&Terms, u32)| {
                let power = Float::with_val(small.prec(), small.pow(n));
                let times = |(m, c): &(i32, Float)| (*m, Float::with_val(power.prec(), c * &power));
                terms.iter().map(times).collect()
            };
            orders.iter().zip(0u32..).map(times).collect()
        };
        Self {
            rates: [scaled(&found.amplitude_rate), scaled(&found.phase_rate)],
            order: found.solution.len().saturating_sub(1),
            frequency: found.frequency.to_f64(),
            is_reversible,
        }
    }

    /// |A_n|/a or |B_n| by n, the largest among the amplitudes.
    fn sizes(&self, k: usize, amplitudes: &[Float]) -> Vec<f64> {
        let at = |terms: &Terms, a: &Float| {
            let divisor = if k == 0 { a.to_f64() } else { 1.0 };
            let size = size(terms, a);
            if size == 0.0 { 0.0 } else { size / divisor }
        };
        let largest = |terms| amplitudes.iter().map(|a| at(terms, a)).fold(0.0, largest);
        self.rates[k].iter().map(largest).collect()
    }

    fn of_x(&self, full: &Truncated, amplitudes: &[Float]) -> Vec<f64> {
        let at = |n: usize| amplitudes.iter().map(move |a| full.size(n, a).to_f64());
        (0..=self.order).map(|n| at(n).fold(0.0, largest)).collect()
    }

    /// q at the amplitudes; NaN where it has no value.
    pub(super) fn quotient(&self, full: &Truncated, amplitudes: &[Float]) -> f64 {
        let of_x = self.of_x(full, amplitudes);
        let scale = of_x.first().copied().unwrap_or_default();
        let rates = [0, 1].map(|k| (self.sizes(k, amplitudes), self.frequency));
        let [drift, turn] = rates;
        let lists = [(of_x, scale), drift, turn];
        let roots = lists.iter().flat_map(|(sizes, scale)| {
            last_two(sizes).map(move |(n, size)| (size / scale).powf(1.0 / n as f64))
        });
        roots.fold(0.0, largest)
    }

    /// The rests of a'/a and psi'.
    pub(super) fn rates(&self, q: f64, amplitudes: &[Float]) -> [f64; 2] {
        [0, 1].map(|k| {
            let sizes = self.sizes(k, amplitudes);
            let rests = last_two(&sizes).map(|(n, size)| size * power(q, self.order - n));
            let none = if k == 0 && self.is_reversible {
                0.0
            } else {
                self.frequency * power(q, self.order + 1)
            };
            rests.reduce(largest).unwrap_or(none)
        })
    }

    /// The rest of x.
    pub(super) fn displacement(&self, full: &Truncated, q: f64, amplitudes: &[Float]) -> f64 {
        let sizes = self.of_x(full, amplitudes);
        let rests = last_two(&sizes).map(|(n, size)| size * power(q, self.order - n));
        let none = sizes.first().copied().unwrap_or_default() * power(q, self.order + 1);
        rests.reduce(largest).unwrap_or(none)
    }
}
