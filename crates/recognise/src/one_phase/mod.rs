//! First-order averaging of any law, one integral over the phase:
//!
//!   x'' + omega^2 x + eps g(x, x') = 0,   x = a cos psi, x' = -a omega sin psi,
//!   a' = eps A_1(a),              A_1 = 1/(2 pi omega) int_0^2pi g sin psi dpsi,
//!   psi' = omega + eps B_1(a),    B_1 = 1/(2 pi omega a) int_0^2pi g cos psi dpsi.
//!
//! The integral is cut where a sign or an absolute value in g changes. Simple zeros of A_1 are cycles with the Floquet
//! exponent eps A_1'(a); on a belt with the speed v* they are slower than it where a omega < |v*|, and where v* is a
//! parameter, those with a omega = |v*| are where sticking begins.

mod integrals;
mod reading;
mod zeros;

use crate::local::Point;
use integrals::tanh_sinh;
use lindstedt_algebra::Stop;
use lindstedt_equation::{Expression, Function};
use std::f64::consts::PI;
use zeros::zeros;

/// An oscillator with a linear spring and a small law.
#[derive(Clone, Debug)]
pub struct OnePhase {
    /// omega.
    pub frequency: f64,
    /// v*, where the law jumps or bends at one x' = v*.
    pub belt_speed: Option<f64>,
    /// The parameter that v* is a multiple of, where there is one.
    pub belt: Option<String>,
    /// v* over that parameter.
    factor: f64,
    /// g with the values of the parameters, but for that one.
    law: Expression,
    /// The value of that one.
    value: f64,
    /// The arguments of signs and absolute values.
    bends: Vec<Expression>,
    /// What g divides by.
    divisors: Vec<Expression>,
}

/// The rates at an amplitude, each with its estimated error.
#[derive(Clone, Copy, Debug)]
pub struct Rates {
    /// A_1, a' over eps.
    pub amplitude: [f64; 2],
    /// B_1, psi' - omega over eps.
    pub phase: [f64; 2],
}

/// A cycle of first order; numbers with their estimated errors.
#[derive(Clone, Copy, Debug)]
pub struct PhaseCycle {
    /// a.
    pub amplitude: [f64; 2],
    /// The Floquet exponent over eps.
    pub exponent: [f64; 2],
    /// B_1 there.
    pub phase: [f64; 2],
}

/// Where a cycle is as fast as the belt.
#[derive(Clone, Copy, Debug)]
pub struct Sticking {
    /// The value of the parameter of the belt.
    pub parameter: [f64; 2],
    /// a = |v*|/omega.
    pub amplitude: [f64; 2],
}

/// The zeros of A_1 up to an amplitude, as far as a grid shows them.
#[derive(Clone, Debug, Default)]
pub struct PhaseCycles {
    /// Where A_1 changes its sign, by rising amplitude.
    pub cycles: Vec<PhaseCycle>,
    /// a with its error, where A_1 has an extremum that is not told from zero: one semistable cycle, two close
    /// ones or none.
    pub touching: Vec<[f64; 2]>,
    /// From a to a, where A_1 is zero within its error at every amplitude tried: steady states.
    pub steady: Vec<[f64; 2]>,
    /// From a to a, where an integral does not converge.
    pub unresolved: Vec<[f64; 2]>,
    /// The distance of the amplitudes that were tried.
    pub cell: f64,
}

/// Cells of the search for cuts in a turn, and for cycles.
const CELLS: u32 = 256;
/// An integral with an error above this part of that of the absolute value does not converge.
const UNRESOLVED: f64 = 1e-6;

impl OnePhase {
    /// A_1 and B_1 at an amplitude a > 0; nothing where the law has no finite value or an integral does not
    /// converge, to 10^-6 of that of its absolute value. Estimated: the error is the difference of the last two steps
    /// of the quadrature with what is beyond its last nodes, rounding errors with it.
    #[must_use]
    pub fn rates(&self, a: f64) -> Option<Rates> {
        self.rates_with(a, self.value)
    }

    fn rates_with(&self, a: f64, belt: f64) -> Option<Rates> {
        let parameter = self.belt.as_deref().map(|name| (name, belt));
        let point = |psi: f64| {
            let (sin, cos) = psi.sin_cos();
            Point::at(0.0, a * cos, -a * self.frequency * sin).with(parameter)
        };
        let value = |e: &Expression, psi: f64| point(psi).value(e);
        let mut cuts: Vec<f64> = (0..=4).map(|quarter| f64::from(quarter) * PI / 2.0).collect();
        // Off the symmetric points, where zeros like to be, and these as well: two zeros about a turn are close.
        let between = (0..=CELLS).map(|n| 2.0 * PI * (f64::from(n) + 0.137) / f64::from(CELLS));
        let turns = (1..=4).map(|quarter| f64::from(quarter) * PI / 2.0);
        let mut places: Vec<f64> = between.chain(turns).collect();
        places.sort_by(f64::total_cmp);
        for z in self.bends.iter().chain(&self.divisors) {
            for pair in places.windows(2) {
                let [mut low, mut high] = *pair else { continue };
                let side = value(z, low)? > 0.0;
                if (value(z, high)? > 0.0) == side {
                    continue;
                }
                for _ in 0..60 {
                    let middle = f64::midpoint(low, high);
                    if (value(z, middle)? > 0.0) == side { low = middle } else { high = middle }
                }
                cuts.push(low.rem_euclid(2.0 * PI));
            }
        }
        cuts.sort_by(f64::total_cmp);
        let terms = self.law.terms();
        let works: Vec<bool> = terms.iter().map(works).collect();
        let (mut sums, mut absolute) = ([[0.0; 2]; 2], [0.0; 2]);
        for pair in cuts.windows(2) {
            let [from, to] = *pair else { continue };
            let part = tanh_sinh(from, to, &|psi| {
                let (mut work, mut all) = ([0.0; 2], [0.0; 2]);
                for (term, works) in terms.iter().zip(&works) {
                    let term = value(term, psi)?;
                    for sum in [Some(&mut all), works.then_some(&mut work)].into_iter().flatten() {
                        *sum = [sum[0] + term, sum[1] + term.abs()];
                    }
                }
                let (sin, cos) = psi.sin_cos();
                Some([[work[0] * sin, work[1]], [all[0] * cos, all[1]]])
            })?;
            for k in [0, 1] {
                sums[k] = [sums[k][0] + part.values[k], sums[k][1] + part.errors[k]];
                absolute[k] += part.absolute[k];
            }
        }
        let lost = |error: f64, size: f64| error.is_nan() || error > UNRESOLVED * size;
        if sums.iter().zip(absolute).any(|([_, error], size)| lost(*error, size)) {
            return None;
        }
        let unsure = self.touching(&value, a);
        sums.iter_mut().for_each(|sum| sum[1] += unsure);
        let scaled = |[value, error]: [f64; 2], factor: f64| [value * factor, error * factor];
        let factor = 1.0 / (2.0 * PI * self.frequency);
        Some(Rates { amplitude: scaled(sums[0], factor), phase: scaled(sums[1], factor / a) })
    }

    /// What is beyond all doubles at some time of a motion of this amplitude, though its own argument is not: an exponential or
    /// a power. Of a smaller amplitude it is not: a pole would be larger there.
    #[must_use]
    pub fn overflow(&self, a: f64) -> Option<&Expression> {
        let parameter = self.belt.as_deref().map(|name| (name, self.value));
        let value = |e: &Expression, a: f64, psi: f64| {
            let (sin, cos) = psi.sin_cos();
            let mut point = Point::at(0.0, a * cos, -a * self.frequency * sin).with(parameter);
            e.evaluate(&mut point).map(|local| local[0])
        };
        // Off the turns, where rounding makes numbers of zeros.
        let turn = || (0..CELLS).map(|n| 2.0 * PI * (f64::from(n) + 0.137) / f64::from(CELLS));
        let beyond = |e: &Expression, z: &Expression, a: f64| {
            turn().any(|psi| {
                let [from, to] = [z, e].map(|e| value(e, a, psi).unwrap_or(f64::NAN));
                from.is_finite() && to.is_infinite()
            })
        };
        self.law.find(&|e| match e {
            Expression::Power(z, _) | Expression::Function(Function::Exp, z) => {
                beyond(e, z, a) && !beyond(e, z, 1e-3 * a)
            }
            _ => false,
        })
    }

    /// What the integrals may be wrong by where a jump or bend is touched at a turn of x or of x': cos psi rounds to 1 within
    /// sqrt(2 u) of it, so that the side is not known there.
    fn touching(&self, value: &dyn Fn(&Expression, f64) -> Option<f64>, a: f64) -> f64 {
        let turns = || (0..4).map(|quarter| f64::from(quarter) * PI / 2.0);
        let rounding = 4.0 * f64::EPSILON * a * self.frequency;
        // Not crossed: the same side before and after.
        let one_side = |z: &Expression, psi: f64| {
            let beside = [psi - 1e-3, psi + 1e-3].map(|psi| value(z, psi).is_some_and(|z| z > 0.0));
            beside[0] == beside[1]
        };
        let met = |z: &Expression, psi: f64| value(z, psi).is_some_and(|z| z.abs() <= rounding);
        let touched = |psi: f64| self.bends.iter().any(|z| met(z, psi) && one_side(z, psi));
        let sides = turns().filter(|psi| touched(*psi)).flat_map(|psi| [psi - 1e-3, psi + 1e-3]);
        let sizes = sides.filter_map(|psi| Some(value(&self.law, psi)?.abs()));
        2.0 * (2.0 * f64::EPSILON).sqrt() * sizes.fold(0.0, f64::max)
    }

    /// The cycles of first order with amplitudes up to `largest`: the changes of sign of A_1 on a grid of 256 cells,
    /// and what else it shows of zeros. Two zeros between neighbours at which |A_1| has no least value are missed.
    /// Fewer when it is asked to stop.
    #[must_use]
    pub fn cycles(&self, largest: f64, stop: &Stop) -> PhaseCycles {
        let rate = |a: f64| Some(self.rates(a)?.amplitude);
        let mut points = grid(largest);
        // Two cycles about the speed of the belt may be close.
        points.extend(
            self.belt_speed.map(|speed| speed.abs() / self.frequency).filter(|a| *a < largest),
        );
        points.sort_by(f64::total_cmp);
        let mut zeros = zeros(&points, &rate, stop);
        // The grid goes on by a cell, for a cycle at its end.
        let within = |[a, error]: &[f64; 2]| *a <= largest + error;
        let mut cycles = Vec::new();
        for [a, error] in zeros.roots.into_iter().filter(within) {
            match self.cycle(a, error) {
                Some(cycle) => cycles.push(cycle),
                None => zeros.unresolved.push([a - error, a + error]),
            }
        }
        let asked = |list: Vec<[f64; 2]>| {
            let starts = list.into_iter().filter(|[from, _]| *from <= largest);
            starts.map(|[from, to]| [from, to.min(largest)]).collect()
        };
        PhaseCycles {
            cycles,
            touching: zeros.touching.into_iter().filter(within).collect(),
            steady: asked(zeros.steady),
            unresolved: asked(zeros.unresolved),
            cell: largest / f64::from(CELLS),
        }
    }

    fn cycle(&self, a: f64, error: f64) -> Option<PhaseCycle> {
        // The slope on the side towards zero and away, far from a jump of it: at two steps.
        let slope = |h: f64| {
            Some((self.rates(a + h)?.amplitude[0] - self.rates(a - h)?.amplitude[0]) / (2.0 * h))
        };
        // Symmetric differences at three steps, extrapolated.
        let h = 2e-2 * a.min(self.gap(a));
        let [one, two, three] = [slope(h)?, slope(h / 2.0)?, slope(h / 4.0)?];
        let (coarse, fine) = ((4.0 * two - one) / 3.0, (4.0 * three - two) / 3.0);
        let last = (16.0 * fine - coarse) / 15.0;
        let noise = 8.0 * self.rates(a)?.amplitude[1] / h;
        let mut exponent = [last, (last - fine).abs() + noise];
        if self.belt_speed.is_some() && self.is_slower([a, error]).is_none() {
            // As fast as the belt A_1 has two slopes, and the symmetric difference is neither.
            exponent[1] += last.abs();
        }
        // The rate of the phase where the amplitude may be.
        let mut phase = self.rates(a)?.phase;
        let ends = [self.rates(a - error)?.phase[0], self.rates(a + error)?.phase[0]];
        phase[1] += ends.iter().map(|end| (end - phase[0]).abs()).fold(0.0, f64::max);
        Some(PhaseCycle { amplitude: [a, error], exponent, phase })
    }

    /// The distance to the amplitude that is as fast as the belt.
    fn gap(&self, a: f64) -> f64 {
        let speed = self.belt_speed.map(|speed| speed.abs() / self.frequency);
        speed.map_or(a, |speed| (a - speed).abs().max(1e-9 * a))
    }

    /// Where the speed of the belt is that of a cycle with an amplitude up to `largest`; empty where the belt has no
    /// parameter.
    #[must_use]
    pub fn sticking(&self, largest: f64, stop: &Stop) -> Vec<Sticking> {
        if self.belt.is_none() {
            return Vec::new();
        }
        let sign = if self.value < 0.0 { -1.0 } else { 1.0 };
        let parameter = |a: f64| sign * a * self.frequency / self.factor.abs();
        // Rounded so that the cycle is not faster: where it touches the speed of the belt a sign would count.
        let slower = 1.0 + 8.0 * f64::EPSILON;
        let rate = |a: f64| Some(self.rates_with(a, parameter(a) * slower)?.amplitude);
        let roots = zeros(&grid(largest), &rate, stop).roots.into_iter();
        let roots = roots.filter(|[a, error]| *a <= largest + error);
        let found = |[a, error]: [f64; 2]| Sticking {
            parameter: [parameter(a), parameter(error).abs()],
            amplitude: [a, error],
        };
        roots.map(found).collect()
    }

    /// Whether an amplitude is slower than the belt at all times; nothing within its error of the speed of the belt.
    #[must_use]
    pub fn is_slower(&self, [a, error]: [f64; 2]) -> Option<bool> {
        let gap = self.belt_speed?.abs() / self.frequency - a;
        (gap.abs() > error).then_some(gap > 0.0)
    }

    /// Whether a cycle of this amplitude sticks at this eps: it meets the belt where the spring is weaker than friction.
    /// Nothing where its error decides.
    #[must_use]
    pub fn sticks(&self, [a, error]: [f64; 2], eps: f64) -> Option<bool> {
        let [low, high] = [a - error, a + error].map(|a| self.sticks_at(a, eps));
        (low == high).then_some(low)
    }

    fn sticks_at(&self, a: f64, eps: f64) -> bool {
        let Some(speed) = self.belt_speed.filter(|speed| speed.abs() < a * self.frequency) else {
            return false;
        };
        let x = (a * a - (speed / self.frequency).powi(2)).sqrt();
        let near = 1e-9 * speed.abs();
        let parameter = self.belt.as_deref().map(|name| (name, self.value));
        let friction = [x, -x].into_iter().flat_map(|x| {
            [near, -near].map(|w| Point::at(0.0, x, speed + w).with(parameter).value(&self.law))
        });
        let largest = friction.flatten().map(f64::abs).fold(0.0, f64::max);
        self.frequency.powi(2) * x <= eps.abs() * largest
    }
}

/// Whether a term may do work in a turn: a force of x does none; rounded, it would hide what does.
fn works(term: &Expression) -> bool {
    term.contains(&Expression::VELOCITY) || !term.contains(&Expression::DISPLACEMENT)
}

/// Amplitudes up to a largest one.
fn grid(largest: f64) -> Vec<f64> {
    let at = |n: u32| largest * (f64::from(n) + 0.618) / (f64::from(CELLS) + 0.618);
    (0..=CELLS + 1).map(at).collect()
}
