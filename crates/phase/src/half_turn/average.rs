//! Averaging to any order on half turns:
//!
//!   x'' + x + eps h_1(x, x') + eps^2 h_2(x, x') + ... = 0 where x' < 0, its point reflection where x' > 0,
//!   x = a cos psi + sum eps^n u_n(a, psi),   da/dt = sum eps^n A_n(a),   dpsi/dt = 1 + sum eps^n B_n(a).
//!
//! Order n reads u_n'' + u_n = f_n + 2 A_n sin psi + 2 a B_n cos psi. The halves match when
//! u_n(pi) = -u_n(0) and u_n'(pi) = -u_n'(0), which fixes A_n and B_n; u_n(0) = 0 makes +-a the turning
//! points, and x' = 0 at psi = 0 counts the phase between them.

use super::{HalfTurn, HalfTurnMonomial, amplitude, pi};
use lindstedt_algebra::Stop;
use rug::Rational;

/// A term (c_1 eps + c_2 eps^2 + ...) x^`displacement` x'^`velocity` of the law where x' < 0.
/// There sign x' = -1 and x'|x'| = -x'^2.
#[derive(Clone, Debug)]
pub struct FrictionTerm {
    /// c_1, c_2, ..., free of the phase and of the amplitude.
    pub factors: Vec<HalfTurn>,
    /// The power of x.
    pub displacement: usize,
    /// The power of x'.
    pub velocity: usize,
}

/// An averaged expansion on half turns; exact. The amplitude a is that of the turning points.
#[derive(Clone, Debug)]
pub struct HalfTurnExpansion {
    /// A_0 = 0, A_1(a), ...: da/dt, free of psi.
    pub amplitude_rate: Vec<HalfTurn>,
    /// B_0 = 0, B_1(a), ...: dpsi/dt - 1, free of psi.
    pub phase_rate: Vec<HalfTurn>,
    /// a cos psi, u_1, ... on 0 <= psi <= pi.
    pub solution: Vec<HalfTurn>,
    /// x', order by order.
    velocity: Vec<HalfTurn>,
    /// Asked within products, those of the check included.
    pub(super) stop: Stop,
}

/// Derives the averaged expansion of x'' + x + eps h(x, x'; eps) = 0 to an order; h is given where x' < 0 and
/// continued by h(-x, -x') = -h(x, x'). `go_on` is told every order with the terms of u_n; after its `false`, and
/// after `stop`, the orders that are finished are the answer.
///
/// Cost: O(N^2) products in the ring for every factor of h, whose elements grow with the order.
///
/// Dry friction, h = sign x': the amplitude falls by exactly 2 eps in each half turn of length pi.
/// ```
/// use lindstedt_algebra::Stop;
/// use lindstedt_coeff::PowerProduct;
/// use lindstedt_phase::half_turn::{FrictionTerm, HalfTurn, average_half_turn};
/// let minus = HalfTurn::constant((-1).into(), PowerProduct::default());
/// let coulomb = FrictionTerm { factors: vec![minus], displacement: 0, velocity: 0 };
/// let found = average_half_turn(&[coulomb], 3, &Stop::default(), &mut |_, _| true);
/// let rate = found.amplitude_rate[1].value(1.0, 0.0, &[]);
/// assert!((rate + 2.0 / std::f64::consts::PI).abs() < 1e-15);
/// assert!(found.amplitude_rate[2].is_zero() && found.phase_rate[1].is_zero());
/// ```
pub fn average_half_turn(
    law: &[FrictionTerm],
    order: usize,
    stop: &Stop,
    go_on: &mut dyn FnMut(usize, usize) -> bool,
) -> HalfTurnExpansion {
    let generating = HalfTurn::generating_solution();
    let mut found = HalfTurnExpansion {
        amplitude_rate: vec![HalfTurn::default()],
        phase_rate: vec![HalfTurn::default()],
        velocity: vec![generating.by_phase()],
        solution: vec![generating],
        stop: stop.clone(),
    };
    let mut products: Vec<Products> = law.iter().map(Products::new).collect();
    for n in 1..=order {
        let mut force = HalfTurn::default();
        for term in &mut products {
            term.add_next(&found, n - 1, &mut force);
        }
        if !found.step(n, &force) {
            found.forget(n);
            break;
        }
        if !go_on(n, found.solution[n].terms().count()) {
            break;
        }
    }
    found
}

impl HalfTurnExpansion {
    /// The series of both rates, of x and of x'.
    fn series(&mut self) -> [&mut Vec<HalfTurn>; 4] {
        [&mut self.amplitude_rate, &mut self.phase_rate, &mut self.solution, &mut self.velocity]
    }

    /// Throws order n away, in which the work was stopped.
    fn forget(&mut self, n: usize) {
        for series in self.series() {
            series.truncate(n);
        }
    }

    /// Order n, from the force of its order; `false` where the work was stopped in it.
    fn step(&mut self, n: usize, force: &HalfTurn) -> bool {
        let plus = Rational::from(1);
        let minus = Rational::from(-1);
        for series in self.series() {
            series.push(HalfTurn::default());
        }
        // Provisionally u_n = A_n = B_n = 0.
        self.velocity[n] = self.rate_of_change(&self.solution, n);
        let mut f = HalfTurn::default();
        f.add_scaled(&self.rate_of_change(&self.velocity, n), &minus);
        f.add_scaled(force, &minus);

        if self.stop.asked() {
            return false;
        }
        let mut u = f.oscillator_response();
        let slope = u.by_phase();
        let over_pi_a = HalfTurnMonomial { amplitude: -1, ..pi(-1) };
        // The halves match with -A_n psi cos psi + a B_n psi sin psi, the responses to the drifts.
        let mut amplitude_rate = HalfTurn::default();
        amplitude_rate.add_scaled(&mismatch(&u).times_monomial(pi(-1)), &minus);
        let phase_rate = mismatch(&slope).times_monomial(over_pi_a);

        let psi = HalfTurnMonomial { phase: 1, ..HalfTurnMonomial::default() };
        let mut cosine = u.at_start();
        cosine.add_scaled(&amplitude_rate.times_monomial(psi.clone()), &plus);
        let mut sine = self.velocity[n].at_start();
        sine.add_scaled(&slope.at_start(), &plus);
        sine.add_scaled(&phase_rate.times_monomial(amplitude(1)).times_monomial(psi), &minus);
        u.add_scaled(&cosine.times(&HalfTurn::cosine()), &minus);
        u.add_scaled(&sine.times(&HalfTurn::sine()), &minus);

        self.solution[n] = u;
        self.amplitude_rate[n] = amplitude_rate;
        self.phase_rate[n] = phase_rate;
        self.velocity[n] = self.rate_of_change(&self.solution, n);
        !self.stop.asked()
    }

    /// Order n of d/dt f = sum_k D_k f_{n-k}, D_0 = d/dpsi, D_k = A_k d/da + B_k d/dpsi.
    pub(super) fn rate_of_change(&self, f: &[HalfTurn], n: usize) -> HalfTurn {
        let mut sum = f[n].by_phase();
        for k in (1..=n).take_while(|_| !self.stop.asked()) {
            sum.add_product(&self.amplitude_rate[k], &f[n - k].by_amplitude(), &self.stop);
            sum.add_product(&self.phase_rate[k], &f[n - k].by_phase(), &self.stop);
        }
        sum
    }
}

/// u(0) + u(pi), which vanishes where a half turn joins its reflection.
pub(super) fn mismatch(u: &HalfTurn) -> HalfTurn {
    let mut sum = u.at_start();
    sum.add_scaled(&u.at_end(), &Rational::from(1));
    sum
}

/// A term of the law as a chain of products, each order by order.
struct Products<'a> {
    term: &'a FrictionTerm,
    /// Orders of the product of the first factors: one row for every number of factors.
    rows: Vec<Vec<HalfTurn>>,
}

impl<'a> Products<'a> {
    fn new(term: &'a FrictionTerm) -> Self {
        Self { term, rows: vec![Vec::new(); term.displacement + term.velocity + 1] }
    }

    /// Adds order n of the term to `sum`; the orders below n have been asked for before.
    fn add_next(&mut self, found: &HalfTurnExpansion, n: usize, sum: &mut HalfTurn) {
        let one = HalfTurn::monomial(HalfTurnMonomial::default(), Rational::from(1));
        let mut last = if n == 0 { one } else { HalfTurn::default() };
        for factors in 0..self.rows.len() {
            if factors > 0 {
                let displacement = factors <= self.term.displacement;
                let series = if displacement { &found.solution } else { &found.velocity };
                last = HalfTurn::default();
                for k in 0..=n {
                    last.add_product(&self.rows[factors - 1][k], &series[n - k], &found.stop);
                }
            }
            self.rows[factors].push(last.clone());
        }
        for (factor, product) in self
            .term
            .factors
            .iter()
            .zip(self.rows.last().into_iter().flat_map(|row| row.iter().rev()))
        {
            sum.add_product(product, factor, &found.stop);
        }
    }
}
