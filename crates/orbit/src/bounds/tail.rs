//! Z1: what the inverse neglects, wave by wave up to the bandwidth of g_x and g_y.

use super::{DROPPED, Frame, LESS, Measure, Weights};
use crate::exact::ERROR;
use crate::linear::{Linear, at};
use crate::space::Wave;
use crate::upward::{Up, raised};

impl Frame<'_> {
    /// Z1: the tail rows of all columns, and the finite rows of the tail columns.
    pub(super) fn z1(&self, measure: Measure, alpha: &[f64], weights: &Weights) -> Up {
        let (modes, band) = (self.inverse.modes, self.band());
        let tails: Vec<f64> =
            (0..=modes + 2 * band + 1).map(|k| self.tail(measure, k.max(1), weights)).collect();
        let mut largest = self.frequency_column(measure, weights);
        for h in &self.inverse.basis {
            if h.k + band > modes {
                let below = self.tail_rows(*h, &tails);
                largest = largest.max(below.over(weights.below(h.k) * h.k.max(1) as f64 * LESS));
            }
        }
        // Beyond modes + band no finite row is met: the last columns stand for all further ones.
        let unknowns = self.linear.unknowns;
        for (i, k) in (0..unknowns).flat_map(|i| (modes + 1..=modes + band).map(move |k| (i, k))) {
            for h in self.linear.rows.parity.waves(i, k) {
                let sum = self.finite_rows(h, alpha) + self.tail_rows(h, &tails);
                largest = largest.max(sum.over(weights.below(k) * k as f64 * LESS));
            }
        }
        largest.max(self.far(measure, alpha, weights))
    }

    /// The column of the frequency in the tail rows: sum_(k > N) |dF/domega|_k nu^k/(omega^2 k s).
    fn frequency_column(&self, measure: Measure, weights: &Weights) -> Up {
        if self.extra() == 0 {
            return Up::ZERO;
        }
        self.tail_of(&self.linear.by_frequency, measure, weights).over(self.scale)
    }

    /// The tail rows of the column of a wave: sum_(k > N) |coupling| nu^k/(omega^2 k).
    fn tail_rows(&self, h: Wave, tails: &[f64]) -> Up {
        let (mut sum, mut sizes) = (0.0, 0.0);
        let from = (self.inverse.modes + 1).max(h.k.saturating_sub(self.band()));
        for i in 0..self.linear.unknowns {
            let rows = tails.iter().enumerate().take(h.k + self.band() + 1).skip(from);
            for (k, tail) in rows.filter(|(k, _)| self.linear.rows.parity.has(i, *k)) {
                let c = self.linear.coupling(i, k, h);
                sum += 2.0 * (c.re.abs() + c.im.abs()) * tail;
                sizes += self.linear.coupling_size(i, k, h) * tail;
            }
        }
        let terms = 2 * self.linear.unknowns * (self.band() + 1) + 8;
        raised(sum, terms) + Linear::coupling_error() * raised(sizes, terms)
    }

    /// The finite rows of a tail column: sum_c |A e_c| |coupling|, and the condition.
    fn finite_rows(&self, h: Wave, alpha: &[f64]) -> Up {
        let (mut sum, mut sizes) = (0.0, 0.0);
        let extra = self.extra();
        for (w, a) in self.inverse.basis.iter().zip(alpha.iter().skip(extra)) {
            if w.k + self.band() >= h.k {
                sum += w.of(self.linear.coupling(w.unknown, w.k, h)).abs() * a;
                sizes += self.linear.coupling_size(w.unknown, w.k, h) * a;
            }
        }
        if let Some(condition) = self.linear.rows.condition {
            sum += condition.of(h).abs() * alpha[0];
        }
        let terms = alpha.len() + 8;
        raised(sum, terms) + Linear::coupling_error() * raised(sizes, terms)
    }

    /// A bound for all columns beyond J = N + band: it decreases with the mode,
    /// sum_l (|u_l|/j + |v_l|) nu^l/(omega^2 (j + l)) at j = J + 1.
    fn far(&self, measure: Measure, alpha: &[f64], weights: &Weights) -> Up {
        let j = self.inverse.modes + self.band() + 1;
        let square = (self.frequency_below * self.frequency_below).next_down();
        let n = self.linear.unknowns;
        let column = |h: usize| {
            let mut sum = 0.0;
            for (i, l) in (0..n)
                .flat_map(|i| (-(self.band() as i64)..=self.band() as i64).map(move |l| (i, l)))
            {
                let entry = i * n + h;
                let (u, v) = (at(&self.linear.by_x[entry], l), at(&self.linear.by_slope[entry], l));
                let size = (u.re.abs() + u.im.abs()) / j as f64 + v.re.abs() + v.im.abs();
                let k = (j as i64 + l) as f64;
                sum += size * weights.above(l.max(0) as usize) / (square * k);
            }
            raised(sum, n * (2 * self.band() + 16)) * (Up::ONE + ERROR)
        };
        let rows = match measure {
            Measure::Norm => (0..n).map(column).fold(Up::ZERO, Up::max),
            Measure::Frequency => Up::ZERO,
        };
        let condition = self.linear.rows.condition.map_or(Up::ZERO, |_| Up(alpha[0]));
        rows + condition.over(weights.below(j) * j as f64 * LESS)
    }

    /// |A| times the norms of what was cut from g_x and omega g_y; a function and its slope are
    /// bounded by the norm.
    pub(super) fn outside_band(&self, weights: &Weights) -> Up {
        let n = self.linear.unknowns;
        let kept = [&self.linear.by_x, &self.linear.by_slope];
        let column = |h: usize| {
            let (mut sum, mut terms) = (0.0, 8);
            let entries = || (0..n).map(|i| i * n + h);
            for (lists, kept) in self.whole.iter().zip(kept) {
                for entry in entries() {
                    for (k, c) in lists[entry].iter().enumerate() {
                        let size =
                            if k < kept[entry].len() { 0.0 } else { c.re.abs() + c.im.abs() };
                        sum += 2.0 * (size + DROPPED) * weights.above(k);
                    }
                    terms += lists[entry].len();
                }
            }
            raised(sum, terms) * (Up::ONE + ERROR)
        };
        (0..n).map(column).fold(Up::ZERO, Up::max)
    }
}
