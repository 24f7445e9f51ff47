//! First-order averaging of any law, one integral over the phase:
//!
//!   x'' + omega^2 x + eps g(x, x') = 0,   x = a cos psi, x' = -a omega sin psi,
//!   a' = eps A_1(a),              A_1 = 1/(2 pi omega) int_0^2pi g sin psi dpsi,
//!   psi' = omega + eps B_1(a),    B_1 = 1/(2 pi omega a) int_0^2pi g cos psi dpsi.
//!
//! The integral is cut where a sign or an absolute value in g changes. Simple zeros of A_1 are cycles with the Floquet
//! exponent eps A_1'(a); on a belt with the speed v* they are slower than it where a omega < |v*|, and where v* is a
//! parameter, those with a omega = |v*| are where sticking begins.

use crate::bound::{bind, missing, multiply_out, rest};
use crate::local::Point;
use crate::refusal::{Refusal, Why};
use lindstedt_algebra::Stop;
use lindstedt_equation::monomials::expand;
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;
use std::f64::consts::PI;

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

/// Cells of the search for cuts in a turn, and for cycles.
const CELLS: u32 = 256;
/// Halvings of the step of the tanh-sinh rule.
const LEVELS: u32 = 7;

impl OnePhase {
    /// Reads the equation of a problem with the values of its parameters; the small one needs none.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit.
    pub fn new(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Self, Refusal> {
        let rest = rest(problem)?;
        missing(&rest.parameters(), values)?;
        let belt = belt(&rest);
        let mut others = values.clone();
        let (belt, factor) = belt.unzip();
        let value = belt.as_ref().and_then(|name| others.remove(name)).map_or(0.0, |v| v.to_f64());
        let all = multiply_out(&bind(&rest, &others))?;
        let (mut square, mut law) = (0.0, Vec::new());
        for (m, q) in &all.terms {
            let term = || all.tree(m, q);
            let refused = |why| Refusal::Term { term: Box::new(term()), why };
            let holds = |wanted: &dyn Fn(&Expression) -> bool| term().find(wanted).is_some();
            if holds(&|e| matches!(e, Expression::Time)) {
                return Err(refused(Why::Forced));
            }
            if holds(&Expression::is_delayed) {
                return Err(refused(Why::Late));
            }
            if holds(&|e| matches!(e, Expression::Formal(..))) {
                return Err(refused(Why::Formal));
            }
            match m.order {
                0 => {
                    let spring = m.is_power(1, 0) && m.atoms.is_empty();
                    let value = Point::at(0.0, 1.0, 0.0).local(&term()).filter(|_| spring);
                    square += value.ok_or_else(|| refused(Why::NotSpring))?[0];
                }
                1 => {
                    let mut bare = m.clone();
                    bare.order = 0;
                    law.push(all.tree(&bare, q));
                }
                _ => return Err(refused(Why::HigherOrder)),
            }
        }
        if square.is_nan() || square <= 0.0 {
            return Err(Refusal::NoSpring);
        }
        let law = Expression::Sum(law).canonical();
        let bends = law.nodes().filter_map(|e| match e {
            Expression::Function(Function::Abs | Function::Sign, z) if !z.is_constant() => {
                Some((**z).clone())
            }
            _ => None,
        });
        let mut bends: Vec<Expression> = bends.collect();
        bends.sort_by_key(|e| format!("{e:?}"));
        bends.dedup();
        let mut found = Self {
            frequency: square.sqrt(),
            belt_speed: None,
            belt,
            factor: factor.unwrap_or_default(),
            law,
            value,
            bends,
        };
        found.belt_speed = found.speed();
        Ok(found)
    }

    /// v* where all signs and absolute values change at one x' other than zero.
    fn speed(&self) -> Option<f64> {
        if self.belt.is_some() {
            return Some(self.factor * self.value);
        }
        let mut speeds = self.bends.iter().map(|z| {
            let [at, by_x, slope] = Point::at(0.0, 0.0, 0.0).local(z)?;
            let [other, ..] = Point::at(0.0, 1.0, 2.0).local(z)?;
            let linear = by_x == 0.0 && (other - at - 2.0 * slope).abs() < 1e-12 * (1.0 + at.abs());
            (linear && slope != 0.0).then(|| -at / slope)
        });
        let first = speeds.next()??;
        let same =
            |speed: Option<f64>| speed.is_some_and(|v| (v - first).abs() <= 1e-12 * first.abs());
        (first != 0.0 && speeds.all(same)).then_some(first)
    }

    /// A_1 and B_1 at an amplitude a > 0; nothing where the law has no finite value. Estimated: the error is the
    /// difference of the last two steps of the quadrature, rounding errors with it.
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
        let value = |e: &Expression, psi: f64| Some(point(psi).local(e)?[0]);
        let mut cuts: Vec<f64> = (0..=4).map(|quarter| f64::from(quarter) * PI / 2.0).collect();
        // Off the symmetric points, where zeros like to be.
        let at = |n: u32| 2.0 * PI * (f64::from(n) + 0.137) / f64::from(CELLS);
        for z in &self.bends {
            for n in 0..CELLS {
                let (mut low, mut high) = (at(n), at(n + 1));
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
        let mut sums = [[0.0; 2]; 2];
        for pair in cuts.windows(2) {
            let [from, to] = *pair else { continue };
            let part = tanh_sinh(from, to, &|psi| {
                let g = value(&self.law, psi)?;
                let (sin, cos) = psi.sin_cos();
                Some([g * sin, g * cos])
            })?;
            for (sum, part) in sums.iter_mut().zip(part) {
                *sum = [sum[0] + part[0], sum[1] + part[1]];
            }
        }
        let unsure = self.touching(&value, a);
        sums.iter_mut().for_each(|sum| sum[1] += unsure);
        let scaled = |[value, error]: [f64; 2], factor: f64| [value * factor, error * factor];
        let factor = 1.0 / (2.0 * PI * self.frequency);
        Some(Rates { amplitude: scaled(sums[0], factor), phase: scaled(sums[1], factor / a) })
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

    /// The cycles of first order with amplitudes up to `largest`: the changes of sign of A_1 on a grid of 256 cells
    /// (two that are closer are missed), by amplitude. Fewer when it is asked to stop.
    #[must_use]
    pub fn cycles(&self, largest: f64, stop: &Stop) -> Vec<PhaseCycle> {
        let rate = |a: f64| Some(self.rates(a)?.amplitude);
        let mut points = grid(largest);
        // Two cycles about the speed of the belt may be close.
        points.extend(
            self.belt_speed.map(|speed| speed.abs() / self.frequency).filter(|a| *a < largest),
        );
        points.sort_by(f64::total_cmp);
        // The grid goes on by a cell, for a cycle at its end.
        let roots =
            roots(&points, &rate, stop).into_iter().filter(|(a, error)| *a <= largest + error);
        roots.filter_map(|(a, error)| self.cycle(a, error)).collect()
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
        let exponent = [last, (last - fine).abs() + noise];
        Some(PhaseCycle { amplitude: [a, error], exponent, phase: self.rates(a)?.phase })
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
        let roots = roots(&grid(largest), &rate, stop).into_iter();
        let roots = roots.filter(|(a, error)| *a <= largest + error);
        let found = |(a, error): (f64, f64)| Sticking {
            parameter: [parameter(a), parameter(error).abs()],
            amplitude: [a, error],
        };
        roots.map(found).collect()
    }

    /// Whether a cycle of this amplitude sticks at this eps: it meets the belt where the spring is weaker than friction.
    #[must_use]
    pub fn sticks(&self, a: f64, eps: f64) -> bool {
        let Some(speed) = self.belt_speed.filter(|speed| speed.abs() < a * self.frequency) else {
            return false;
        };
        let x = (a * a - (speed / self.frequency).powi(2)).sqrt();
        let near = 1e-9 * speed.abs();
        let parameter = self.belt.as_deref().map(|name| (name, self.value));
        let friction = [x, -x].into_iter().flat_map(|x| {
            [near, -near].map(|w| Point::at(0.0, x, speed + w).with(parameter).local(&self.law))
        });
        let largest = friction.flatten().map(|g| g[0].abs()).fold(0.0, f64::max);
        self.frequency.powi(2) * x <= eps.abs() * largest
    }
}

/// The parameter p with x' - c p the argument of every sign and absolute value of x', and c.
fn belt(rest: &Expression) -> Option<(String, f64)> {
    let mut found: Option<(String, Rational)> = None;
    for e in rest.nodes() {
        let Expression::Function(Function::Abs | Function::Sign, z) = e else { continue };
        if !z.contains(&Expression::VELOCITY) {
            continue;
        }
        let all = expand(z)?;
        let (mut slope, mut constant) = (Rational::new(), None);
        for (m, q) in &all.terms {
            let single = m.x == 0 && m.velocity == 0 && m.order == 0 && m.atoms.is_empty();
            match m.parameters.iter().collect::<Vec<_>>()[..] {
                [] if m.is_power(0, 1) && m.order == 0 => slope += q,
                [(name, 1)] if single && name != "pi" && constant.is_none() => {
                    constant = Some((name.clone(), q.clone()))
                }
                _ => return None,
            }
        }
        let (name, q) = constant?;
        if slope.is_zero() {
            return None;
        }
        let this = (name, -q / slope);
        if found.as_ref().is_some_and(|found| *found != this) {
            return None;
        }
        found = Some(this);
    }
    found.map(|(name, factor)| (name, factor.to_f64()))
}

/// Amplitudes up to a largest one.
fn grid(largest: f64) -> Vec<f64> {
    let at = |n: u32| largest * (f64::from(n) + 0.618) / (f64::from(CELLS) + 0.618);
    (0..=CELLS + 1).map(at).collect()
}

/// The changes of sign of a function between neighbouring points at which its sign is clear, with an error from that of
/// the function.
fn roots(points: &[f64], rate: &dyn Fn(f64) -> Option<[f64; 2]>, stop: &Stop) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let mut before = None;
    for a in points {
        if stop.asked() {
            break;
        }
        let Some(here) = rate(*a).map(|rate| (*a, rate)) else {
            before = None;
            continue;
        };
        // Zero up to rounding errors has no sign: its neighbours have.
        if here.1[0].abs() > here.1[1] {
            found.extend(before.and_then(|left| root(left, here, rate)));
            before = Some(here);
        }
    }
    found
}

fn root(
    low: (f64, [f64; 2]),
    high: (f64, [f64; 2]),
    rate: &dyn Fn(f64) -> Option<[f64; 2]>,
) -> Option<(f64, f64)> {
    let sign = low.1[0] > 0.0;
    if (high.1[0] > 0.0) == sign {
        return None;
    }
    let (mut low, mut high) = (low.0, high.0);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if (rate(middle)?[0] > 0.0) == sign { low = middle } else { high = middle }
    }
    let a = f64::midpoint(low, high);
    let h = 1e-5 * a;
    let slope = (rate(a + h)?[0] - rate(a - h)?[0]) / (2.0 * h);
    Some((a, rate(a)?[1] / slope.abs() + 4.0 * f64::EPSILON * a))
}

/// Two integrals over an interval with their estimated errors; singularities at the ends do no harm.
fn tanh_sinh(from: f64, to: f64, f: &dyn Fn(f64) -> Option<[f64; 2]>) -> Option<[[f64; 2]; 2]> {
    let half = (to - from) / 2.0;
    if half <= 0.0 {
        return Some([[0.0; 2]; 2]);
    }
    let term = |t: f64| {
        let s = PI / 2.0 * t.sinh();
        // The distance to the nearer end keeps its digits.
        let near = 2.0 * half / (1.0 + (2.0 * s.abs()).exp());
        let place = if s < 0.0 { from + near } else { to - near };
        let weight = half * PI / 2.0 * t.cosh() / s.cosh().powi(2);
        Some(f(place)?.map(|value| value * weight))
    };
    let mut sums = term(0.0)?;
    let (mut before, mut size) = ([0.0; 2], 0.0f64);
    for level in 0..LEVELS {
        let h = 0.5f64.powi(level as i32);
        let (mut t, stride) = if level == 0 { (1.0, 1.0) } else { (h, 2.0 * h) };
        while t < 3.2 {
            for t in [t, -t] {
                let value = term(t)?;
                size = size.max(value[0].abs()).max(value[1].abs());
                sums = [sums[0] + value[0], sums[1] + value[1]];
            }
            t += stride;
        }
        let values = sums.map(|sum| sum * h);
        let changes = [(values[0] - before[0]).abs(), (values[1] - before[1]).abs()];
        if level > 2 && changes.iter().all(|change| *change < 1e-13 * size) || level + 1 == LEVELS {
            return Some([0, 1].map(|k| [values[k], changes[k].max(4.0 * f64::EPSILON * size)]));
        }
        before = values;
    }
    None
}
