//! DF applied in doubles: products of trigonometric polynomials by sums where the modes are few, by the fast
//! Fourier transform where they are many. Nothing depends on which: the residual is formed exactly elsewhere.

use crate::Condition;
use crate::linear::{Linear, Step, at};
use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

type C = Complex<f64>;

/// DF for steps with so many modes.
pub(crate) struct Products<'a> {
    linear: &'a Linear,
    modes: usize,
    way: Way,
}

/// g_x and omega g_y by entries of their matrices: coefficients -M..=M, or samples.
enum Way {
    Sums([Vec<Vec<C>>; 2]),
    Transform(Box<Grid>, [Vec<Vec<f64>>; 2]),
}

/// Points of a period on which a product of two functions has its modes without aliases.
struct Grid {
    points: usize,
    to_values: Arc<dyn ComplexToReal<f64>>,
    to_modes: Arc<dyn RealToComplex<f64>>,
}

/// What a multiplication of the sums takes of one of the transforms, the plan of these included: measured, they
/// are level near 8 modes.
const OF_A_SUM: usize = 2;

/// Modes below this fraction of the largest are rounding errors of a transform.
const NOISE: f64 = 4.0 * f64::EPSILON;

/// Multiplications of one application by sums and by transforms.
pub(crate) fn work(unknowns: usize, modes: usize, band: usize) -> [usize; 2] {
    let points = points(modes, band);
    let transform = points * points.ilog2() as usize;
    let sums = unknowns * unknowns * 2 * (modes + 1) * (2 * band + 1).min(modes + band + 1);
    [sums * OF_A_SUM, unknowns * (3 * transform + 2 * unknowns * points)]
}

/// The least number of points that is a small odd number times a power of 2.
fn points(modes: usize, band: usize) -> usize {
    let least = 2 * modes + band.min(2 * modes) + 2;
    let of = |odd: usize| odd * least.div_ceil(odd).next_power_of_two().max(2);
    [1, 3, 5].map(of).into_iter().min().unwrap_or(least)
}

impl Grid {
    fn new(points: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        let (to_values, to_modes) =
            (planner.plan_fft_inverse(points), planner.plan_fft_forward(points));
        Self { points, to_values, to_modes }
    }

    /// The values of a function on the grid; of the modes given none is half the number of points.
    fn values(&self, half: &[C]) -> Vec<f64> {
        let mut modes = self.to_values.make_input_vec();
        modes.iter_mut().zip(half).for_each(|(to, c)| *to = *c);
        modes[0].im = 0.0;
        let mut values = self.to_values.make_output_vec();
        match self.to_values.process(&mut modes, &mut values) {
            Ok(()) => values,
            Err(_) => vec![f64::NAN; self.points],
        }
    }

    /// The modes up to the last one asked for.
    fn modes(&self, mut values: Vec<f64>, last: usize) -> Vec<C> {
        let mut modes = self.to_modes.make_output_vec();
        if self.to_modes.process(&mut values, &mut modes).is_err() {
            modes.fill(C::new(f64::NAN, 0.0));
        }
        modes.truncate(last + 1);
        modes.iter_mut().for_each(|c| *c /= self.points as f64);
        // A sum has sixteen digits of every mode, a transform sixteen of the largest: the rest is noise.
        let noise = NOISE * modes.iter().map(|c| c.norm()).fold(0.0, f64::max);
        modes.iter_mut().filter(|c| c.norm() < noise).for_each(|c| *c = C::default());
        modes
    }
}

impl<'a> Products<'a> {
    pub(crate) fn new(linear: &'a Linear, modes: usize) -> Self {
        let [sums, transforms] = work(linear.unknowns, modes, linear.band());
        Self::by(linear, modes, transforms < sums)
    }

    fn by(linear: &'a Linear, modes: usize, transform: bool) -> Self {
        let lists = [&linear.by_x, &linear.by_slope];
        let way = if transform {
            let grid = Grid::new(points(modes, linear.band()));
            // A step and its rows are not farther apart.
            let near = |f: &Vec<C>| grid.values(&f[..f.len().min(2 * modes + 1)]);
            let values = lists.map(|list| list.iter().map(near).collect());
            Way::Transform(Box::new(grid), values)
        } else {
            Way::Sums(lists.map(|list| list.iter().map(|f| full(f)).collect()))
        };
        Self { linear, modes, way }
    }

    /// DF applied to a step, up to its own modes: (condition, coefficients).
    pub(crate) fn apply(&self, step: &Step) -> (f64, Vec<Vec<C>>) {
        let linear = self.linear;
        let square = linear.frequency * linear.frequency;
        let mut rows = self.products(step);
        for (i, row) in rows.iter_mut().enumerate() {
            for (k, product) in row.iter_mut().enumerate() {
                let inertia = step.unknowns[i][k] * -(square * (k * k) as f64);
                *product =
                    inertia - *product + at(&linear.by_frequency[i], k as i64) * step.frequency;
            }
        }
        let of = |condition: Condition| {
            let waves = linear.basis(self.modes);
            waves.iter().map(|w| condition.of(*w) * w.of(step.unknowns[w.unknown][w.k])).sum()
        };
        (linear.rows.condition.map_or(0.0, of), rows)
    }

    /// sum_j (g_x h_j + omega g_y h_j').
    fn products(&self, step: &Step) -> Vec<Vec<C>> {
        let n = self.linear.unknowns;
        let slope = |h: &Vec<C>| -> Vec<C> {
            let each = h.iter().enumerate();
            each.map(|(k, c)| c * C::new(0.0, k as f64)).collect()
        };
        let steps = [step.unknowns.clone(), step.unknowns.iter().map(slope).collect()];
        match &self.way {
            Way::Sums(entries) => {
                let steps = steps.map(|list| list.iter().map(|h| full(h)).collect::<Vec<_>>());
                let sum = |i: usize, k: usize| -> C {
                    let pairs = entries.iter().zip(&steps);
                    let row = |(f, h): (&Vec<Vec<C>>, &Vec<Vec<C>>)| -> C {
                        (0..n).map(|j| convolution(&f[i * n + j], &h[j], k)).sum()
                    };
                    pairs.map(row).sum()
                };
                (0..n).map(|i| (0..=self.modes).map(|k| sum(i, k)).collect()).collect()
            }
            Way::Transform(grid, entries) => {
                let steps =
                    steps.map(|list| list.iter().map(|h| grid.values(h)).collect::<Vec<_>>());
                let row = |i: usize| {
                    let mut sum = vec![0.0; grid.points];
                    for (f, h) in entries.iter().zip(&steps) {
                        for (f, h) in f[i * n..].iter().zip(h) {
                            sum.iter_mut().zip(f.iter().zip(h)).for_each(|(s, (f, h))| *s += f * h);
                        }
                    }
                    grid.modes(sum, self.modes)
                };
                (0..n).map(row).collect()
            }
        }
    }
}

/// c_k, k = -M..=M.
fn full(half: &[C]) -> Vec<C> {
    let negative = half.iter().skip(1).rev().map(C::conj);
    negative.chain(half.iter().copied()).collect()
}

/// sum_l f_l g_(k-l) of two full lists.
fn convolution(f: &[C], g: &[C], k: usize) -> C {
    let (m, n) = ((f.len() / 2) as i64, (g.len() / 2) as i64);
    let k = k as i64;
    let (from, to) = ((k - n).max(-m), (k + n).min(m));
    if from > to {
        return C::default();
    }
    let part = &f[(from + m) as usize..=(to + m) as usize];
    let other = &g[(k - to + n) as usize..=(k - from + n) as usize];
    let (mut re, mut im) = (0.0, 0.0);
    for (a, b) in part.iter().zip(other.iter().rev()) {
        re += a.re * b.re - a.im * b.im;
        im += a.re * b.im + a.im * b.re;
    }
    C::new(re, im)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rows;
    use crate::space::Parity;

    /// Two unknowns with couplings up to mode `band`.
    fn linear(band: usize) -> Linear {
        let list = |seed: usize| -> Vec<C> {
            let number = |k: usize, s: usize| ((k * 7919 + s * 104_729) % 23) as f64 - 11.0;
            let one =
                |k: usize| C::new(number(k, seed), if k == 0 { 0.0 } else { number(k, seed + 5) });
            (0..=band).map(one).collect()
        };
        let rows = Rows { parity: Parity::default(), condition: None };
        let lists = |seed: usize| (0..4).map(|i| list(seed + i)).collect();
        let by_frequency = vec![Vec::new(); 2];
        Linear {
            frequency: 1.5,
            unknowns: 2,
            by_x: lists(1),
            by_slope: lists(11),
            by_frequency,
            rows,
        }
    }

    #[test]
    fn transforms_agree_with_sums() {
        for (modes, band) in [(5, 3), (40, 17), (3, 30)] {
            let linear = linear(band);
            let wave = |k: usize| C::new(1.0 / (k + 1) as f64, if k == 0 { 0.0 } else { 0.3 });
            let unknowns =
                vec![(0..=modes).map(wave).collect(), (0..=modes).map(|k| -wave(k)).collect()];
            let step = Step { frequency: 0.0, unknowns };
            let [sums, transform] = [false, true]
                .map(|transform| Products::by(&linear, modes, transform).apply(&step).1.concat());
            let size: f64 = sums.iter().map(|c| c.norm()).sum();
            let apart: f64 = sums.iter().zip(&transform).map(|(a, b)| (a - b).norm()).sum();
            assert!(apart < 1e-13 * size && size > 1.0, "{modes} {band}: {apart} {size}");
        }
    }

    /// Few modes by sums, many by transforms; the work of many grows like modes log modes.
    #[test]
    fn the_work_of_many_modes_is_that_of_transforms() {
        let [sums, transforms] = work(1, 5, 5);
        assert!(sums < transforms);
        let [sums, many] = work(1, 4000, 2000);
        assert!(100 * many < sums);
        assert!(many < 5 * work(1, 1000, 500)[1]);
    }
}
