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
/// Halvings of the step of the tanh-sinh rule.
const LEVELS: u32 = 10;
/// The end of the tanh-sinh rule: nodes closer to an end of the interval round to it.
const REACH: f64 = 3.2;
/// An integral with an error above this part of that of the absolute value does not converge.
const UNRESOLVED: f64 = 1e-6;
/// As many amplitudes in a row without a sign are no zero at one of them.
const STEADY: usize = 3;

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
        let bends = arguments(&law, &|e| match e {
            Expression::Function(Function::Abs | Function::Sign, z) => Some(z),
            _ => None,
        });
        let divisors = arguments(&law, &|e| match e {
            Expression::Power(z, n) if n.as_number().is_some_and(|n| n.is_negative()) => Some(z),
            _ => None,
        });
        let mut found = Self {
            frequency: square.sqrt(),
            belt_speed: None,
            belt,
            factor: factor.unwrap_or_default(),
            law,
            value,
            bends,
            divisors,
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
        let value = |e: &Expression, psi: f64| Some(point(psi).local(e)?[0]);
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
        let terms = match &self.law {
            Expression::Sum(terms) => terms.as_slice(),
            single => std::slice::from_ref(single),
        };
        let (mut sums, mut absolute) = ([[0.0; 2]; 2], 0.0);
        for pair in cuts.windows(2) {
            let [from, to] = *pair else { continue };
            let part = tanh_sinh(from, to, &|psi| {
                let (mut g, mut absolute) = (0.0, 0.0);
                for term in terms {
                    let term = value(term, psi)?;
                    g += term;
                    absolute += term.abs();
                }
                let (sin, cos) = psi.sin_cos();
                Some([g * sin, g * cos, absolute])
            })?;
            for (sum, value) in sums.iter_mut().zip(part.values) {
                *sum = [sum[0] + value, sum[1] + part.error];
            }
            absolute += part.absolute;
        }
        if sums.iter().any(|[_, error]| error.is_nan() || *error > UNRESOLVED * absolute) {
            return None;
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
        PhaseCycles {
            cycles,
            touching: zeros.touching.into_iter().filter(within).collect(),
            steady: zeros.steady,
            unresolved: zeros.unresolved,
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

/// Different arguments of what is picked, none constant.
fn arguments(
    law: &Expression,
    pick: &dyn Fn(&Expression) -> Option<&Expression>,
) -> Vec<Expression> {
    let mut list: Vec<Expression> =
        law.nodes().filter_map(pick).filter(|z| !z.is_constant()).cloned().collect();
    list.sort_by_key(|e| format!("{e:?}"));
    list.dedup();
    list
}

/// What a grid shows of the zeros of a function: places with an error, intervals.
#[derive(Default)]
struct Zeros {
    roots: Vec<[f64; 2]>,
    touching: Vec<[f64; 2]>,
    steady: Vec<[f64; 2]>,
    unresolved: Vec<[f64; 2]>,
}

/// A function with its estimated error.
type Rate<'a> = dyn Fn(f64) -> Option<[f64; 2]> + 'a;
/// A place and the function there.
type Sampled = (f64, [f64; 2]);

/// Zero up to rounding errors has no sign.
fn sign((_, [value, error]): &Sampled) -> Option<bool> {
    (value.abs() > *error).then_some(*value > 0.0)
}

/// The changes of sign of a function between neighbouring points at which its sign is clear, its least sizes between
/// points of one sign, and where it is zero or nothing over several points.
fn zeros(points: &[f64], rate: &Rate<'_>, stop: &Stop) -> Zeros {
    let mut found = Zeros::default();
    let mut run: Vec<Sampled> = Vec::new();
    let mut lost: Option<[f64; 2]> = None;
    for a in points {
        if stop.asked() {
            break;
        }
        match rate(*a) {
            Some(here) => {
                found.unresolved.extend(lost.take());
                run.push((*a, here));
            }
            None => {
                found.of_run(&std::mem::take(&mut run), rate);
                lost = Some([lost.map_or(*a, |[from, _]| from), *a]);
            }
        }
    }
    found.unresolved.extend(lost);
    found.of_run(&run, rate);
    found
}

impl Zeros {
    fn of_run(&mut self, run: &[Sampled], rate: &Rate<'_>) {
        let clear: Vec<usize> = (0..run.len()).filter(|k| sign(&run[*k]).is_some()).collect();
        let ends = |from: usize, to: usize| {
            let unclear = run.get(from..to).filter(|list| list.len() >= STEADY)?;
            Some([unclear.first()?.0, unclear.last()?.0])
        };
        let (Some(first), Some(last)) = (clear.first(), clear.last()) else {
            self.steady.extend(ends(0, run.len()));
            return;
        };
        self.steady.extend(ends(0, *first));
        for pair in clear.windows(2) {
            let [left, right] = *pair else { continue };
            if let Some(steady) = ends(left + 1, right) {
                self.steady.push(steady);
            } else if sign(&run[left]) != sign(&run[right]) {
                self.root(run[left].0, run[right].0, rate);
            } else if right > left + 1 {
                self.least(run[left].0, run[right].0, rate);
            } else {
                // The least of three of one sign; of two equal ones the first.
                let size = |k: usize| run[k].1[0].abs();
                let after = run.get(right + 1).filter(|_| clear.contains(&(right + 1)));
                let same = after.is_some_and(|after| sign(after) == sign(&run[right]));
                if same && size(right) < size(left) && size(right) <= size(right + 1) {
                    self.least(run[left].0, run[right + 1].0, rate);
                }
            }
        }
        self.steady.extend(ends(last + 1, run.len()));
    }

    fn root(&mut self, low: f64, high: f64, rate: &Rate<'_>) {
        match root(low, high, rate) {
            Some(found) => self.roots.push(found),
            None => self.unresolved.push([low, high]),
        }
    }

    /// The least size of a function of one sign at both ends: two roots where it changes the sign in between.
    fn least(&mut self, low: f64, high: f64, rate: &Rate<'_>) {
        let Some(sign) = rate(low).map(|[value, _]| value.signum()) else { return };
        // Golden sections: of sign * f, until it is below zero or the places are one.
        let inner = (5f64.sqrt() - 1.0) / 2.0;
        let at = |a: f64| Some((a, sign * rate(a)?[0]));
        let (mut from, mut to) = (low, high);
        let places = [to - inner * (to - from), from + inner * (to - from)];
        let [Some(mut left), Some(mut right)] = places.map(at) else { return };
        for _ in 0..80 {
            let lower = if left.1 <= right.1 { left } else { right };
            if lower.1 < 0.0 && rate(lower.0).is_some_and(|[value, error]| value.abs() > error) {
                self.root(low, lower.0, rate);
                self.root(lower.0, high, rate);
                return;
            }
            if left.1 <= right.1 {
                (to, right) = (right.0, left);
                let Some(next) = at(to - inner * (to - from)) else { return };
                left = next;
            } else {
                (from, left) = (left.0, right);
                let Some(next) = at(from + inner * (to - from)) else { return };
                right = next;
            }
        }
        let a = f64::midpoint(left.0, right.0);
        let Some([value, error]) = rate(a) else { return };
        if value.abs() <= error {
            self.touching.push([a, flat(a, [low, high], error, rate)]);
        }
    }
}

/// How far from its least size, zero, a function stays within its error.
fn flat(a: f64, [low, high]: [f64; 2], error: f64, rate: &Rate<'_>) -> f64 {
    let within = |a: f64| rate(a).is_none_or(|[value, own]| value.abs() <= error.max(own));
    let reach = |end: f64| {
        // From the end on to the place: the first within the error.
        let (mut outside, mut inside) = (end, a);
        for _ in 0..60 {
            let middle = f64::midpoint(outside, inside);
            if within(middle) { inside = middle } else { outside = middle }
        }
        (outside - a).abs()
    };
    reach(low).max(reach(high)) + 4.0 * f64::EPSILON * a
}

/// The change of sign between two places of different signs, with an error from that of the function.
fn root(mut low: f64, mut high: f64, rate: &Rate<'_>) -> Option<[f64; 2]> {
    let sign = rate(low)?[0] > 0.0;
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if (rate(middle)?[0] > 0.0) == sign { low = middle } else { high = middle }
    }
    let a = f64::midpoint(low, high);
    let h = 1e-5 * a;
    let slope = (rate(a + h)?[0] - rate(a - h)?[0]) / (2.0 * h);
    Some([a, rate(a)?[1] / slope.abs() + 4.0 * f64::EPSILON * a])
}

/// Two integrals over an interval.
struct Integrals {
    values: [f64; 2],
    /// Of each, estimated.
    error: f64,
    /// The integral of the size of the terms.
    absolute: f64,
}

/// Two integrals over an interval, of an integrand that says the size of its terms as well, by which it is rounded;
/// integrable singularities at the ends do no harm. In doubles: some hundred integrals are wanted, to 12 digits.
fn tanh_sinh(from: f64, to: f64, f: &dyn Fn(f64) -> Option<[f64; 3]>) -> Option<Integrals> {
    let half = (to - from) / 2.0;
    if half <= 0.0 {
        return Some(Integrals { values: [0.0; 2], error: 0.0, absolute: 0.0 });
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
    let (mut before, mut size) = ([0.0; 2], sums[2]);
    for level in 0..LEVELS {
        let h = 0.5f64.powi(level as i32);
        let (mut t, stride) = if level == 0 { (1.0, 1.0) } else { (h, 2.0 * h) };
        while t < REACH {
            for t in [t, -t] {
                let value = term(t)?;
                size = size.max(value[2]);
                sums = [0, 1, 2].map(|k| sums[k] + value[k]);
            }
            t += stride;
        }
        let values = [sums[0] * h, sums[1] * h];
        let change = (values[0] - before[0]).abs().max((values[1] - before[1]).abs());
        if level > 2 && change < 1e-13 * size || level + 1 == LEVELS {
            // Of a singularity d^(p-1) the terms fall as exp(-p pi sinh t): what is beyond the last is the last over
            // p pi cosh t, p = 1/2 here; of a pole they do not fall.
            let beyond = 2.0 / (PI * REACH.cosh());
            let tail = (term(-REACH)?[2] + term(REACH)?[2]) * beyond;
            let error = change.max(4.0 * f64::EPSILON * size) + tail;
            return Some(Integrals { values, error, absolute: sums[2] * h });
        }
        before = values;
    }
    None
}
