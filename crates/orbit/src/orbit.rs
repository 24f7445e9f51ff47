//! What follows from a proof: the orbit at any phase and time, and its extrema, enclosed.

use crate::centre::Component;
use crate::upward::{UNIT, Up};
use lindstedt_number::ball::{Ball, Balls};
use nalgebra::Complex;
use rug::float::Round;
use rug::{Float, Rational};

/// The numerical solution with the radius within which the orbit is.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    pub(crate) centre: Component,
    /// |x - xbar| and |dx/dtau - dxbar/dtau| for all tau.
    pub(crate) radius: Float,
    pub(crate) frequency: Ball,
    pub(crate) balls: Balls,
}

/// e^(i k p), k = 0, 1, ..., each the product of the one before and the first.
struct Waves {
    first: [Float; 2],
    now: [Float; 2],
    k: u32,
    balls: Balls,
}

impl Waves {
    fn new(phase: &Float, bits: u32) -> Self {
        let bits = bits + 32;
        let first =
            [Float::with_val(bits, phase.cos_ref()), Float::with_val(bits, phase.sin_ref())];
        let now = [Float::with_val(bits, 1), Float::new(bits)];
        Self { first, now, k: 0, balls: Balls::new(bits) }
    }

    /// (cos k q, sin k q) for all q within `radius` of the phase: |q - p| <= radius moves the wave
    /// by at most k radius, and every product adds less than 8 units of its precision.
    fn next(&mut self, radius: &Float) -> (Ball, Ball) {
        let bits = self.balls.bits();
        let unit = Float::with_val(53, Float::i_exp(8, -(bits as i32)));
        let each = Float::with_val_round(53, &unit + radius, Round::Up).0;
        let error = Float::with_val_round(53, &each * self.k, Round::Up).0;
        let pair = [&self.now[0], &self.now[1]].map(|x| self.balls.from_parts(x, &error));
        let [c, s] = &self.first;
        let [x, y] = &self.now;
        let re = Float::with_val(bits, x * c) - Float::with_val(bits, y * s);
        let im = Float::with_val(bits, x * s) + Float::with_val(bits, y * c);
        self.now = [re, im];
        self.k += 1;
        let [cos, sin] = pair;
        (cos, sin)
    }
}

/// Cells of the circle from which the search for extrema starts; they are divided by three.
const CELLS: u64 = 243;
const MOST_DIVISIONS: u32 = 9;
/// Cells that may survive one division.
const MOST_CELLS: usize = 20_000;

impl Orbit {
    fn coefficient(&self, k: usize) -> (Ball, Ball) {
        let modes = &self.centre.modes;
        let factor = if k == 0 { 1 } else { 2 };
        let of = |n: &rug::Integer, sign: i64| {
            let integer = self.balls.from_integer(&rug::Integer::from(n * (sign * factor)));
            self.balls.mul_power_of_two(&integer, -(self.centre.bits as i32))
        };
        match (modes.re.get(k), modes.im.get(k)) {
            (Some(re), Some(im)) => (of(re, 1), of(im, -1)),
            _ => (self.balls.zero(), self.balls.zero()),
        }
    }

    /// The coefficients of cos k tau and sin k tau of the orbit.
    pub(crate) fn harmonic(&self, k: usize) -> (Ball, Ball) {
        let (a, b) = self.coefficient(k);
        // |x_k| max(k, 1) <= r.
        let error = Float::with_val_round(53, &self.radius / k.max(1) as u32, Round::Up).0;
        (self.balls.add_error(&a, &error), self.balls.add_error(&b, &error))
    }

    /// xbar, dxbar/dtau, d^2xbar/dtau^2 at a phase.
    fn centre_at(&self, phase: &Ball) -> [Ball; 3] {
        let balls = self.balls;
        let mut sums = [balls.zero(), balls.zero(), balls.zero()];
        let mut waves = Waves::new(phase.midpoint(), balls.bits());
        for k in 0..self.centre.modes.re.len() {
            let (cos, sin) = waves.next(phase.radius());
            let (a, b) = self.coefficient(k);
            if a.midpoint().is_zero() && b.midpoint().is_zero() {
                continue;
            }
            let value = balls.add(&balls.mul(&a, &cos), &balls.mul(&b, &sin));
            let slope = balls.sub(&balls.mul(&b, &cos), &balls.mul(&a, &sin));
            let k = k as i64;
            sums[0] = balls.add(&sums[0], &value);
            sums[1] = balls.add(&sums[1], &balls.mul_i64(&slope, k));
            sums[2] = balls.sub(&sums[2], &balls.mul_i64(&balls.mul_i64(&value, k), k));
        }
        sums
    }

    /// (x, x') at a phase tau.
    pub(crate) fn at_phase(&self, phase: &Ball) -> (Ball, Ball) {
        let [x, slope, _] = self.centre_at(phase);
        let balls = self.balls;
        let slope = balls.add_error(&slope, &self.radius);
        (balls.add_error(&x, &self.radius), balls.mul(&slope, &self.frequency))
    }

    /// (x, x') at a time t: the phase omega t is known up to |t| times the radius of omega.
    pub(crate) fn at(&self, time: &Rational) -> (Ball, Ball) {
        self.at_phase(&self.balls.mul_rational(&self.frequency, time))
    }

    /// (min x, max x). An orbit of an autonomous equation of second order meets x' = 0 twice in its
    /// least period (between, x is monotone; more often a closed curve in the plane cannot without crossing
    /// itself): where it is even in time, at tau = 0 and tau = pi, unless these are the same state. Where the
    /// unknown is odd under the shift by pi the least value is minus the largest.
    pub(crate) fn extrema(&self, even_and_autonomous: bool, odd: bool) -> (Ball, Ball) {
        if even_and_autonomous {
            let ends = [self.balls.zero(), self.balls.pi()].map(|phase| self.at_phase(&phase).0);
            let [a, b] = ends;
            if !a.overlaps(&b) {
                return if a.midpoint() < b.midpoint() { (a, b) } else { (b, a) };
            }
        }
        let largest = self.largest(1.0);
        let least = if odd { self.balls.neg(&largest) } else { self.largest(-1.0) };
        (least, largest)
    }

    /// The largest value of x on the orbit, or of -x.
    fn largest(&self, sign: f64) -> Ball {
        let ball = Search::new(&self.centre, sign).run(self);
        let ball = self.balls.add_error(&ball, &self.radius);
        if sign < 0.0 { self.balls.neg(&ball) } else { ball }
    }

    /// A critical point of x near a phase, by Newton's method (not rigorous).
    pub(crate) fn critical(&self, phase: f64) -> Ball {
        let mut at = Float::with_val(self.balls.bits(), phase);
        let mut before = f64::INFINITY;
        for _ in 0..60 {
            let exact = self.balls.from_parts(&at, &Float::new(53));
            let [_, slope, bend] = self.centre_at(&exact);
            let step = Float::with_val(self.balls.bits(), slope.midpoint() / bend.midpoint());
            let size = step.to_f64().abs();
            if !step.is_finite() || size > before || size > 0.1 {
                break;
            }
            at -= step;
            before = size / 2.0;
        }
        self.balls.from_parts(&at, &Float::new(53))
    }
}

/// Branch and bound for max x on cells of the circle, in doubles with their errors.
struct Search {
    /// s times c_k.
    modes: Vec<Complex<f64>>,
    /// Bounds of the second and third derivative.
    bend: f64,
    twist: f64,
    /// Errors of x, dx/dtau, d^2x/dtau^2 in doubles.
    errors: [f64; 3],
    sign: f64,
}

impl Search {
    fn new(centre: &Component, sign: f64) -> Self {
        let modes: Vec<_> = centre.doubles().iter().map(|c| c * sign).collect();
        let norm = |power: i32| -> f64 {
            let size = |(k, c): (usize, &Complex<f64>)| c.norm() * (k as f64).powi(power);
            2.0 * modes.iter().enumerate().map(size).sum::<f64>() * (1.0 + 1e-9)
        };
        // e^(i k tau) by k products has an error below 8 k units, sums of M terms below M units;
        // the derivatives bring a factor k each.
        let unit = 16.0 * UNIT;
        let sums = |p: i32| unit * (norm(p + 1) + norm(p) * (modes.len() as f64 + 8.0));
        let errors = [sums(0), sums(1), sums(2)];
        let (bend, twist) = (norm(2), norm(3));
        Self { modes, bend, twist, errors, sign }
    }

    /// s x and its derivatives at 2 pi cell/cells.
    fn at(&self, cell: u64, cells: u64) -> [f64; 3] {
        let turn = Float::with_val(80, cell) * 2u32 / cells;
        let angle = turn * Float::with_val(80, rug::float::Constant::Pi);
        let (sin, cos) = angle.sin_cos(Float::new(80));
        let wave = Complex::new(cos.to_f64(), sin.to_f64());
        let mut power = Complex::new(1.0, 0.0);
        let mut sums = [0.0; 3];
        for (k, c) in self.modes.iter().enumerate() {
            let factor = if k == 0 { 1.0 } else { 2.0 };
            let term = c * power * factor;
            let k = k as f64;
            sums[0] += term.re;
            sums[1] -= k * term.im;
            sums[2] -= k * k * term.re;
            power *= wave;
        }
        sums
    }

    /// An enclosure of max s xbar: sharp where the cells isolate it, as wide as the last cells
    /// where they do not (a maximum too flat for its third derivative).
    fn run(&self, orbit: &Orbit) -> Ball {
        let mut cells = CELLS;
        let mut alive: Vec<u64> = (0..cells).collect();
        let (mut best, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
        for _ in 0..MOST_DIVISIONS {
            let half = (std::f64::consts::PI / cells as f64).next_up().next_up();
            let values: Vec<_> = alive.iter().map(|j| (*j, self.at(*j, cells))).collect();
            best = values.iter().map(|(_, v)| v[0] - self.errors[0]).fold(best, f64::max);
            let reach = |v: &[f64; 3]| self.reach(v, half);
            most = values.iter().map(|(_, v)| reach(v)).fold(f64::NEG_INFINITY, f64::max);
            let kept: Vec<_> =
                values.into_iter().filter(|(_, v)| reach(v) >= best || reach(v).is_nan()).collect();
            let curved = |v: &[f64; 3]| -v[2] - self.errors[2] - self.twist * half * (1.0 + 1e-12);
            if kept.iter().all(|(_, v)| curved(v) > 0.0)
                && let Some(ball) = self.enclose(orbit, &kept, cells, curved)
            {
                return ball;
            }
            if kept.len() > MOST_CELLS {
                break;
            }
            alive = kept.iter().flat_map(|(j, _)| children(*j, cells)).collect();
            cells *= 3;
        }
        let end = |x: f64| orbit.balls.from_f64(x).unwrap_or(orbit.balls.indeterminate());
        orbit.balls.hull(&end(best.next_down()), &end(most))
    }

    /// An upper bound of s x on a cell with these values at its centre.
    fn reach(&self, v: &[f64; 3], half: f64) -> f64 {
        let slope = v[1].abs() + self.errors[1];
        let rise = slope * half + 0.5 * self.bend * half * half;
        let sum = v[0] + self.errors[0] + rise;
        sum + 4.0 * f64::EPSILON * (v[0].abs() + self.errors[0] + rise)
    }

    /// On a run of neighbouring cells x is concave with d^2x/dtau^2 <= -c, so that
    /// max x <= x(p) + (dx/dtau)(p)^2/(2 c) for any p in it.
    fn enclose(
        &self,
        orbit: &Orbit,
        kept: &[(u64, [f64; 3])],
        cells: u64,
        curved: impl Fn(&[f64; 3]) -> f64,
    ) -> Option<Ball> {
        let balls = orbit.balls;
        let mut largest: Option<Ball> = None;
        for run in runs(kept, cells) {
            let best = run.iter().max_by(|a, b| a.1[0].total_cmp(&b.1[0]))?;
            let least = run.iter().map(|(_, v)| curved(v)).fold(f64::INFINITY, f64::min);
            let angle = std::f64::consts::TAU * best.0 as f64 / cells as f64;
            let mut point = orbit.critical(angle);
            // It must lie in the run: else the middle of the best cell serves.
            let width = std::f64::consts::PI / cells as f64 * (1.0 - 1e-9);
            let ends = [run.first()?.0 as f64, run.last()?.0 as f64];
            let angle_of = |j: f64| std::f64::consts::TAU * j / cells as f64;
            let within = *point.midpoint() >= angle_of(ends[0]) - width
                && *point.midpoint() <= angle_of(ends[1]) + width;
            if !within {
                point = balls.from_f64(angle)?;
            }
            let [x, slope, _] = orbit.centre_at(&point);
            let x = if self.sign < 0.0 { balls.neg(&x) } else { x };
            let steep = Up::of_float(&slope.abs_upper());
            let rise = (steep * steep).over(2.0 * least * (1.0 - 1e-12));
            let ball = balls.add_error(&x, &Float::with_val(53, rise.0));
            largest = Some(match largest {
                None => ball,
                Some(other) => maximum(balls, &ball, &other),
            });
        }
        largest
    }
}

/// A ball with max(a, b).
fn maximum(balls: Balls, a: &Ball, b: &Ball) -> Ball {
    if a.lower() >= b.upper() {
        a.clone()
    } else if b.lower() >= a.upper() {
        b.clone()
    } else {
        balls.hull(a, b)
    }
}

/// The three cells of thrice as many that cover a cell: centres 3j - 1, 3j, 3j + 1.
fn children(j: u64, cells: u64) -> [u64; 3] {
    [(3 * j + 3 * cells - 1) % (3 * cells), 3 * j, 3 * j + 1]
}

/// Runs of neighbouring cells; a run across tau = 0 begins with negative numbers.
fn runs(kept: &[(u64, [f64; 3])], cells: u64) -> Vec<Vec<(i64, [f64; 3])>> {
    let mut sorted: Vec<_> = kept.iter().map(|(j, v)| (*j as i64, *v)).collect();
    sorted.sort_by_key(|(j, _)| *j);
    let mut list: Vec<Vec<(i64, [f64; 3])>> = Vec::new();
    for cell in sorted {
        match list.last_mut() {
            Some(run) if run.last().is_some_and(|(j, _)| j + 1 == cell.0) => run.push(cell),
            _ => list.push(vec![cell]),
        }
    }
    let across = list.len() > 1
        && list[0][0].0 == 0
        && list.last().and_then(|run| run.last()).is_some_and(|(j, _)| j + 1 == cells as i64);
    if across && let Some(last) = list.pop() {
        let before = last.into_iter().map(|(j, v)| (j - cells as i64, v));
        list[0].splice(0..0, before);
    }
    list
}
