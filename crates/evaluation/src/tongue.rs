//! Internal resonances beside a slow flow: what of them moves an unknown that rests.
//!
//! Where z_i = z_j = 0 in a steady state, the equation of x_j has terms K e^{i (Omega - nu_i) t} zbar_i, K made of the other amplitudes,
//! and x_{j,n} has them divided by nu_j^2 - (Omega - nu_i)^2. The slow flow takes them to be harmless, however small that is. In the
//! resonant flow they are kappa_ji zbar_i in z_j', kappa = K/(2 i nu_j), so that with z_i' = lambda_i z_i from the slow flow and
//! the same for j the growth s in the frame where these rest is
//!
//!   (s - lambda_j - i d) (s - conj lambda_i) = kappa_ji conj kappa_ij,   d = nu_i + nu_j - Omega:
//!
//! for i = j the tongue |kappa|^2 > (Re lambda)^2 + (Im lambda + d/2)^2 of a parametric resonance (Nayfeh and Mook, chapter 5).
//! kappa is that of the lowest order that has such a term, and lambda that of the flow up to it: higher orders have the small divisor
//! in both. Im lambda is what the state moves the frequency by, so that the tongue lies beside d = 0, and d need not be as small as the
//! small parameter's power of that order.

use crate::rotating::rotating;
use lindstedt_derivation::resonance::SlowFlow;
use lindstedt_orbit::steady::{Flow, System, Value};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// How much wider a tongue is taken to be: of its edge the leading order alone is known.
const WIDER: f64 = 1.5;

/// A term that multiplies zbar_i in the equation of x_j.
#[derive(Clone, Debug)]
struct Term {
    unknown: usize,
    conjugate: usize,
    order: i32,
    /// Omega.
    rate: Rational,
    /// kappa without its factors.
    kappa: [f64; 2],
    exponents: Vec<i32>,
}

/// The terms of a slow flow that may pump unknowns at rest.
#[derive(Clone, Debug)]
pub struct Tongues {
    terms: Vec<Term>,
    /// The flows up to the orders of the terms.
    flows: Vec<(i32, Flow)>,
    frequencies: Vec<f64>,
    first_symbol: usize,
}

/// A complex number.
type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// z^e, of the conjugate for the second exponent.
fn powers(w: &[f64], e: &[i32]) -> Complex {
    let product = (0..e[0]).fold([1.0, 0.0], |p, _| times(p, [w[0], w[1]]));
    (0..e[1]).fold(product, |p, _| times(p, [w[0], -w[1]]))
}

impl Term {
    /// Those of a term of x_{j,n} beside the frequency nu_j.
    fn list<'a>(
        slow: &'a SlowFlow,
        (j, n): (usize, i32),
        term: &'a AmplitudeTerm,
    ) -> impl Iterator<Item = Self> + 'a {
        let (nu, unknowns) = (&slow.system.frequencies, slow.unknowns());
        let (amplitudes, rest) = term.exponents.split_at(2 * unknowns);
        let pairs = amplitudes.chunks_exact(2).zip(nu);
        let own: Rational = pairs.map(|(e, nu)| Rational::from(nu * (e[0] - e[1]))).sum();
        let rates = slow.system.forces.iter().map(|phase| phase.number().unwrap_or_default());
        let forced: Rational = rest.iter().zip(rates).map(|(m, rate)| rate * m).sum();
        let harmonic = own + forced;
        let square = |q: &Rational| Rational::from(q * q);
        let scale = ((square(&nu[j]) - square(&harmonic)) / (Rational::from(2) * &nu[j])).to_f64();
        let is_near = Rational::from(&harmonic - &nu[j]).abs() * 2u32 <= nu[j];
        let pumped = move |i: &usize| is_near && amplitudes[2 * i..2 * i + 2] == [0, 1];
        (0..unknowns).filter(pumped).map(move |i| {
            let mut exponents = term.exponents.clone();
            exponents[2 * i + 1] = 0;
            Self {
                unknown: j,
                conjugate: i,
                order: n,
                rate: Rational::from(&harmonic + &nu[i]),
                // K/(2 i nu).
                kappa: [scale * term.im.to_f64(), -scale * term.re.to_f64()],
                exponents,
            }
        })
    }

    /// The two unknowns and Omega.
    fn pair(&self) -> (usize, usize, Rational) {
        let (i, j) = (self.unknown, self.conjugate);
        (i.min(j), i.max(j), self.rate.clone())
    }
}

impl Tongues {
    /// Of the orders of a forced flow up to this; the name is that of the small parameter. Cost: linear in the terms of the solution, but
    /// for sorting.
    #[must_use]
    pub fn of(slow: &SlowFlow, small: &str, order: usize) -> Self {
        let mut terms = Vec::new();
        let forced = slow.solution.iter().filter(|_| !slow.system.forces.is_empty());
        for (j, orders) in forced.enumerate() {
            for (n, list) in (0i32..).zip(orders).take(order + 1).skip(1) {
                terms.extend(list.iter().flat_map(|term| Term::list(slow, (j, n), term)));
            }
        }
        let mut first = BTreeMap::new();
        for term in &terms {
            let lowest = first.entry(term.pair()).or_insert(term.order);
            *lowest = term.order.min(*lowest);
        }
        terms.retain(|term| first.get(&term.pair()) == Some(&term.order));
        let orders: BTreeSet<i32> = terms.iter().map(|term| term.order).collect();
        let flow = |n: i32| Some((n, rotating(slow, small, usize::try_from(n).ok()?).ok()?.flow));
        let flows: Vec<_> = orders.into_iter().filter_map(flow).collect();
        let frequencies = slow.system.frequencies.iter().map(Rational::to_f64).collect();
        Self { terms, flows, frequencies, first_symbol: slow.first_symbol() }
    }

    /// The flows where parameters have these values, for [`Self::worst`].
    #[must_use]
    pub fn systems(&self, values: &[Option<Value>]) -> Vec<System> {
        self.flows.iter().map(|(_, flow)| flow.system(values)).collect()
    }

    /// Where a state lies in or beside a tongue, the largest Re s per unit of t; `at` is w and what varies besides, `values` those of
    /// the symbols and of eps there.
    #[must_use]
    pub fn worst(&self, systems: &[System], values: &[f64], at: &[f64], unit: f64) -> Option<f64> {
        let lists = systems.iter().zip(&self.flows);
        let found = lists.filter_map(|(system, (order, _))| {
            self.worst_of(*order, values, (at, &system.slopes(at)), unit)
        });
        found.reduce(f64::max)
    }

    fn worst_of(
        &self,
        order: i32,
        values: &[f64],
        (at, slopes): (&[f64], &[f64]),
        unit: f64,
    ) -> Option<f64> {
        let w = &at[..2 * self.frequencies.len()];
        let small = values.last().copied().unwrap_or(0.0);
        let size = w.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let rest = |j: usize| {
            w[2 * j].hypot(w[2 * j + 1]) < 1e-9 * size && {
                let [a, b, c, d] = block(slopes, at.len(), j);
                (a - d).hypot(b + c) <= 1e-9 * (a.hypot(b) + c.hypot(d))
            }
        };
        let exponent = |j: usize| {
            let [a, b, c, d] = block(slopes, at.len(), j);
            [0.5 * small * (a + d), 0.5 * small * (c - b)]
        };
        let pairs = self.terms.iter().filter(|t| t.order == order && t.unknown <= t.conjugate);
        let pairs = pairs.filter(|term| rest(term.unknown) && rest(term.conjugate));
        let tongues = pairs.filter_map(|term| {
            let (j, i, rate) = (term.unknown, term.conjugate, &term.rate);
            let [a, b] = [(j, i), (i, j)].map(|pair| self.kappa(pair, rate, values, w, unit));
            let pump = times(a, [b[0], -b[1]]);
            let detuning = unit * (self.frequencies[i] + self.frequencies[j] - rate.to_f64());
            let [own, other] = [exponent(j), exponent(i)];
            // (s - p)^2 = q^2 + kappa conj kappa, s = p + q and p - q without the pump.
            let p = [0.5 * (own[0] + other[0]), 0.5 * (own[1] + detuning - other[1])];
            let q = [0.5 * (own[0] - other[0]), 0.5 * (own[1] + detuning + other[1])];
            let growth = |wider: f64| -> f64 {
                let square = times(q, q);
                let sum = [0, 1].map(|k| square[k] + wider * wider * pump[k]);
                // |Re| of a square root.
                p[0] + (0.5 * (sum[0].hypot(sum[1]) + sum[0])).max(0.0).sqrt()
            };
            (growth(WIDER) > 0.0 && pump != [0.0, 0.0]).then(|| growth(1.0))
        });
        tongues.reduce(f64::max)
    }

    /// kappa_ji of one rate, per unit of t.
    fn kappa(
        &self,
        (j, i): (usize, usize),
        rate: &Rational,
        values: &[f64],
        w: &[f64],
        unit: f64,
    ) -> Complex {
        let same = |term: &&Term| term.unknown == j && term.conjugate == i && term.rate == *rate;
        let small = values.last().copied().unwrap_or(0.0);
        let term = |term: &Term| {
            let symbols = term.exponents.iter().skip(self.first_symbol).zip(values);
            let scale = symbols.fold(unit * small.powi(term.order), |p, (e, x)| p * x.powi(*e));
            let pairs = term.exponents.chunks_exact(2).zip(w.chunks_exact(2));
            pairs.fold(term.kappa.map(|x| scale * x), |p, (e, w)| times(p, powers(w, e)))
        };
        let list = self.terms.iter().filter(same).map(term);
        list.fold([0.0, 0.0], |sum, x| [sum[0] + x[0], sum[1] + x[1]])
    }
}

/// The derivative of an unknown's own part by itself, of rows with so many entries.
fn block(slopes: &[f64], columns: usize, j: usize) -> [f64; 4] {
    let at = |i: usize, k: usize| slopes[(2 * j + i) * columns + 2 * j + k];
    [at(0, 0), at(0, 1), at(1, 0), at(1, 1)]
}
