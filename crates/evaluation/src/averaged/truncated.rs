//! The averaged expansion broken off at an order, as functions of amplitude and phase.

use lindstedt_derivation::averaging::numbers::{Harmonic, Numbers, Terms};
use lindstedt_equation::{Expression, Function};
use lindstedt_simulate::{Digits, Model, Parameters, SimulateError, System};
use rug::Float;
use rug::ops::Pow;
use std::collections::BTreeMap;

/// Steps of Newton's method; with a Jacobian from differences every step gains a third of the bits.
const MOST_STEPS: usize = 200;

/// x_N of an averaged expansion at one value of the small parameter: a' and psi' as sums of c a^n, x as
/// harmonics c(a) cos(k psi + m omega t) + s(a) sin(k psi + m omega t).
#[derive(Clone, Debug)]
pub struct Truncated {
    pub(super) rates: [Terms; 2],
    /// eps^n u_n by order.
    solution: Vec<Vec<Harmonic>>,
    forcing: Float,
    frequency: Float,
    /// a(0), psi(0).
    pub(super) start: [Float; 2],
    bits: u32,
}

/// sum c a^n and its derivative.
fn polynomial(terms: &Terms, a: &Float) -> [Float; 2] {
    let bits = a.prec();
    let mut sums = [Float::new(bits), Float::new(bits)];
    for (n, c) in terms {
        sums[0] += Float::with_val(bits, a.pow(*n)) * c;
        if *n != 0 {
            sums[1] += Float::with_val(bits, a.pow(*n - 1)) * c * *n;
        }
    }
    sums
}

fn collect(orders: &[Terms], powers: &[Float], order: usize) -> Terms {
    let mut sum: Terms = Vec::new();
    for (terms, power) in orders.iter().zip(powers).take(order + 1) {
        for (n, c) in terms {
            let c = Float::with_val(power.prec(), c * power);
            match sum.iter_mut().find(|(m, _)| m == n) {
                Some((_, known)) => *known += c,
                None => sum.push((*n, c)),
            }
        }
    }
    sum
}

/// f(a) as an expression in the tree of a.
fn tree(f: &Terms, a: &Expression) -> Expression {
    let term = |(n, c): &(i32, Float)| number(c) * a.clone().pow(i64::from(*n));
    Expression::Sum(f.iter().filter(|(_, c)| !c.is_zero()).map(term).collect())
}

fn number(c: &Float) -> Expression {
    Expression::Number(c.to_rational().unwrap_or_default())
}

impl Truncated {
    /// The expansion broken off at an order, at rest at a = psi = 0; `small` has the precision of all
    /// that follows.
    #[must_use]
    pub fn new(found: &Numbers, small: &Float, order: usize) -> Self {
        let bits = small.prec();
        let power = |n: u32| Float::with_val(bits, small.pow(n));
        let powers: Vec<Float> = (0u32..).take(order + 1).map(power).collect();
        let scaled = |(list, power): (&Vec<Harmonic>, &Float)| {
            let mut list = list.clone();
            for (_, c) in list.iter_mut().flat_map(|h| h.amplitudes.iter_mut().flatten()) {
                *c *= power;
            }
            list
        };
        let mut phase = collect(&found.phase_rate, &powers, order);
        let frequency = Float::with_val(bits, &found.frequency);
        match phase.iter_mut().find(|(n, _)| *n == 0) {
            Some((_, c)) => *c += &frequency,
            None => phase.push((0, frequency.clone())),
        }
        Self {
            rates: [collect(&found.amplitude_rate, &powers, order), phase],
            solution: found.solution.iter().zip(&powers).map(scaled).collect(),
            forcing: Float::with_val(bits, &found.forcing),
            frequency,
            start: [Float::new(bits), Float::new(bits)],
            bits,
        }
    }

    /// The same with other rates: `rest` is added to a'/a and psi'.
    pub(super) fn changed(&self, rest: [f64; 2]) -> Self {
        let mut changed = self.clone();
        for ((rates, rest), exponent) in changed.rates.iter_mut().zip(rest).zip([1, 0]) {
            match rates.iter_mut().find(|(n, _)| *n == exponent) {
                Some((_, known)) => *known += rest,
                None => rates.push((exponent, Float::with_val(self.bits, rest))),
            }
        }
        changed
    }

    /// 2 pi/omega_0, over which is averaged.
    pub(super) fn period(&self) -> f64 {
        std::f64::consts::TAU / self.frequency.to_f64().abs()
    }

    /// R and psi' where a' = R a and psi' is free of a.
    pub(super) fn linear(&self) -> Option<[Float; 2]> {
        let only = |terms: &Terms, exponent: i32| {
            let mut sum = Float::new(self.bits);
            for (n, c) in terms {
                (*n == exponent).then_some(())?;
                sum += c;
            }
            Some(sum)
        };
        Some([only(&self.rates[0], 1)?, only(&self.rates[1], 0)?])
    }

    /// a' and psi'.
    pub(super) fn rate(&self, a: &Float) -> [Float; 2] {
        [&self.rates[0], &self.rates[1]].map(|terms| {
            let [value, _] = polynomial(terms, a);
            value
        })
    }

    /// x, dx/da, dx/dpsi, dx/deta.
    fn gradient(&self, a: &Float, psi: &Float, eta: &Float) -> [Float; 4] {
        let bits = self.bits;
        let mut sums = [0; 4].map(|_| Float::new(bits));
        for harmonic in self.solution.iter().flatten() {
            let angle = Float::with_val(bits, psi * harmonic.free)
                + Float::with_val(bits, eta * harmonic.forced);
            let (sin, cos) = angle.sin_cos(Float::new(bits));
            let [[c, dc], [s, ds]] =
                [&harmonic.amplitudes[0], &harmonic.amplitudes[1]].map(|t| polynomial(t, a));
            sums[0] += Float::with_val(bits, &c * &cos) + Float::with_val(bits, &s * &sin);
            sums[1] += Float::with_val(bits, dc * &cos) + Float::with_val(bits, ds * &sin);
            let turned = Float::with_val(bits, s * cos) - Float::with_val(bits, c * sin);
            sums[2] += Float::with_val(bits, &turned * harmonic.free);
            sums[3] += turned * harmonic.forced;
        }
        sums
    }

    /// x at a, psi and a time.
    #[must_use]
    pub fn value(&self, [a, psi]: &[Float; 2], time: &Float) -> Float {
        let eta = Float::with_val(self.bits, &self.forcing * time);
        let [x, ..] = self.gradient(a, psi, &eta);
        x
    }

    /// x and x' at t = 0.
    #[must_use]
    pub fn state(&self, [a, psi]: &[Float; 2]) -> [Float; 2] {
        let [x, by_a, by_psi, by_eta] = self.gradient(a, psi, &Float::new(self.bits));
        let [rate, turn] = self.rate(a);
        [x, by_a * rate + by_psi * turn + by_eta * &self.forcing]
    }

    /// The flow of a and psi, in t or backwards.
    ///
    /// # Errors
    /// Those of [`Model::compile`].
    pub fn system(&self, real: Digits, backward: bool) -> Result<System<Digits>, SimulateError> {
        let mut parameters = Parameters::new();
        let mut sides = Vec::new();
        for (name, terms) in ["A", "B"].iter().zip(&self.rates) {
            let mut sum = vec![Expression::integer(0)];
            for (n, c) in terms {
                let symbol = format!("{name}{n}").replace('-', "m");
                let c = if backward { Float::with_val(c.prec(), -c) } else { c.clone() };
                parameters.set(&symbol, c);
                let power = Expression::DISPLACEMENT.pow(i64::from(*n));
                sum.push(Expression::parameter(&symbol) * power);
            }
            sides.push(Expression::Sum(sum).canonical());
        }
        Model::first_order(&["a", "psi"], &sides)?.compile(real, &parameters)
    }

    /// x_N(t) with a(t) and psi(t) as given expressions in t.
    #[must_use]
    pub fn history(&self, [a, psi]: &[Expression; 2]) -> Expression {
        let mut merged: BTreeMap<(i32, i32), [Vec<Terms>; 2]> = BTreeMap::new();
        for harmonic in self.solution.iter().flatten() {
            let lists = merged.entry((harmonic.free, harmonic.forced)).or_default();
            for (list, terms) in lists.iter_mut().zip(&harmonic.amplitudes) {
                list.push(terms.clone());
            }
        }
        let one = Float::with_val(self.bits, 1);
        let mut terms = Vec::new();
        for ((k, m), lists) in merged {
            let forced = number(&Float::with_val(self.bits, &self.forcing * m));
            let angle = Expression::integer(i64::from(k)) * psi.clone() + forced * Expression::Time;
            for (list, function) in lists.iter().zip([Function::Cos, Function::Sin]) {
                let ones = vec![one.clone(); list.len()];
                let amplitude = collect(list, &ones, list.len());
                if amplitude.iter().any(|(_, c)| !c.is_zero()) {
                    terms.push(tree(&amplitude, a) * angle.clone().apply(function));
                }
            }
        }
        Expression::Sum(terms)
    }

    /// Bounds of |dx/da| and |dx/dpsi| over all phases.
    pub(super) fn sensitivity(&self, a: &Float) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for harmonic in self.solution.iter().flatten() {
            for terms in &harmonic.amplitudes {
                let [c, dc] = polynomial(terms, a);
                sums[0] += dc.to_f64().abs();
                sums[1] += (c * harmonic.free).to_f64().abs();
            }
        }
        sums
    }

    /// A bound of |eps^n u_n| over all phases.
    pub(super) fn size(&self, n: usize, a: &Float) -> Float {
        let mut sum = Float::new(53);
        for harmonic in self.solution.get(n).into_iter().flatten() {
            for terms in &harmonic.amplitudes {
                let [c, _] = polynomial(terms, a);
                sum += Float::with_val(53, c.abs_ref());
            }
        }
        sum
    }

    /// a(0), psi(0) with the given x(0), x'(0), by Newton's method from order zero.
    pub(super) fn invert(&self, wanted: &[Float; 2]) -> Option<[Float; 2]> {
        let bits = self.bits;
        let first = Self { solution: self.solution.get(..1)?.to_vec(), ..self.clone() };
        let still = [Float::new(bits), Float::new(bits)];
        // Without the free part; a power a^-n has no value there, and then it is left out.
        let [forced, speed] = first.state(&still);
        let or_zero = |x: Float| if x.is_finite() { x } else { Float::new(bits) };
        let x = Float::with_val(bits, &wanted[0] - or_zero(forced));
        let v = Float::with_val(bits, &wanted[1] - or_zero(speed)) / &self.frequency;
        let psi = Float::with_val(bits, -&v).atan2(&x);
        let mut at = [x.hypot(&v), psi];
        if at[0].is_zero() {
            // At the forced response itself there is no phase.
            let same = self.state(&at).iter().zip(wanted).all(|(a, b)| a == b);
            return same.then_some(at);
        }
        let tolerance = Float::with_val(bits, 1) >> (bits - 24);
        for _ in 0..MOST_STEPS {
            let now = self.state(&at);
            let residual = [0, 1].map(|k| Float::with_val(bits, &wanted[k] - &now[k]));
            if residual.iter().any(|r| !r.is_finite()) {
                return None;
            }
            let scale = Float::with_val(bits, wanted[0].abs_ref())
                + Float::with_val(bits, wanted[1].abs_ref())
                + 1u32;
            let limit = Float::with_val(bits, &tolerance * &scale);
            if residual.iter().all(|r| Float::with_val(bits, r.abs_ref()) <= limit) {
                return (at[0] > 0).then_some(at);
            }
            let step = Float::with_val(bits, 1) >> (bits / 3);
            let column = |k: usize| {
                let mut near = at.clone();
                near[k] += &step;
                let there = self.state(&near);
                [0, 1].map(|j| Float::with_val(bits, &there[j] - &now[j]) / &step)
            };
            let (of_a, of_psi) = (column(0), column(1));
            let minor = |p: &Float, q: &Float, r: &Float, s: &Float| {
                Float::with_val(bits, p * s) - Float::with_val(bits, q * r)
            };
            let determinant = minor(&of_a[0], &of_psi[0], &of_a[1], &of_psi[1]);
            if determinant.is_zero() {
                return None;
            }
            at[0] += minor(&residual[0], &of_psi[0], &residual[1], &of_psi[1]) / &determinant;
            at[1] += minor(&of_a[0], &residual[0], &of_a[1], &residual[1]) / &determinant;
        }
        None
    }
}
