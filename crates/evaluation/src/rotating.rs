//! A slow flow in the rotating frame, where it is autonomous: z_j = w_j e^{i k_j eta} with k_j = nu_j/Omega.
//!
//! Every term of f_j has the eigenvalue nu_j (what is resonant stays in f), so that all of them turn with e^{i k_j eta}:
//!
//!   w_j' = sum_n eps^n (f_{j,n}(w, wbar, 1) - i k_j sigma_n w_j).
//!
//! What is evaluated is w'/eps. Its steady states are the periodic responses; k_j = 1 at a primary resonance, 1/2 at the
//! principal parametric one, 1/3 and 3 at the sub- and superharmonic ones.

use lindstedt_derivation::resonance::{SlowFlow, Terms};
use lindstedt_orbit::steady::{ComplexTerm, Flow, Polynomial};
use rug::Rational;
use rug::ops::Pow;
use std::collections::BTreeSet;

/// The autonomous slow flow.
#[derive(Clone, Debug)]
pub struct Rotating {
    /// w'/eps; its parameters are the symbols of the slow flow, then the small parameter.
    pub flow: Flow,
    /// k_j.
    pub turns: Vec<Rational>,
    /// How many of the k_j the resonances fix, the rank of their relations: where it is less than the number of
    /// unknowns, a motion may be steady in another frame than this.
    pub fixed: usize,
    /// Unknowns of which the force fixes a combination of the phases alone.
    pub combination: Option<Vec<usize>>,
    /// Im (w'/w)/eps of free motion as a polynomial in |w| and the parameters, of a single unknown: zero on the
    /// backbone.
    pub backbone: Option<Flow>,
}

/// The slow flow up to an order in the rotating frame; nothing without a force.
#[must_use]
pub fn rotating(slow: &SlowFlow, small: &str, order: usize) -> Option<Rotating> {
    let system = &slow.system;
    if system.force.is_zero() {
        return None;
    }
    let turns: Vec<Rational> =
        system.frequencies.iter().map(|nu| Rational::from(nu / &system.force)).collect();
    let names: Vec<&str> = system.symbols.iter().map(String::as_str).chain([small]).collect();
    let equations: Vec<Vec<ComplexTerm>> =
        (0..turns.len()).map(|j| equation(slow, j, &turns[j], order)).collect();
    let backbone = (turns.len() == 1).then(|| backbone(slow, &turns[0], &names, order));
    let relations = Relations::of(slow, order);
    let (fixed, combination) = (relations.fixed(), relations.combination());
    let flow = Flow::of_complex(&equations, &names);
    Some(Rotating { flow, turns, fixed, combination, backbone })
}

/// What fixes the k_j: every term z^p zbar^q E^m of f_j is a relation (p - q - e_j) k = -m.
#[derive(Default)]
struct Relations {
    /// Independent ones.
    rows: Vec<Vec<Rational>>,
    /// Sets of unknowns that relations tie together, and whether one of these knows the force.
    groups: Vec<(BTreeSet<usize>, bool)>,
}

impl Relations {
    fn of(slow: &SlowFlow, order: usize) -> Self {
        let mut relations = Self::default();
        for j in 0..slow.unknowns() {
            for term in slow.flow[j].iter().take(order + 1).skip(1).flatten() {
                relations.add(j, &term.exponents, slow.unknowns());
            }
        }
        relations
    }

    fn add(&mut self, j: usize, exponents: &[i32], unknowns: usize) {
        let relation = |k: usize| exponents[2 * k] - exponents[2 * k + 1] - i32::from(k == j);
        let mut row: Vec<Rational> = (0..unknowns).map(|k| relation(k).into()).collect();
        let mut tied: BTreeSet<usize> = (0..unknowns).filter(|k| !row[*k].is_zero()).collect();
        if tied.is_empty() {
            return;
        }
        let mut forced = exponents[2 * unknowns] != 0;
        self.groups.retain(|(group, knows)| {
            let apart = group.is_disjoint(&tied);
            if !apart {
                tied.extend(group);
                forced |= knows;
            }
            apart
        });
        self.groups.push((tied, forced));
        for known in &self.rows {
            let Some(pivot) = known.iter().position(|x| !x.is_zero()) else { continue };
            let factor = Rational::from(&row[pivot] / &known[pivot]);
            row.iter_mut().zip(known).for_each(|(x, y)| *x -= Rational::from(&factor * y));
        }
        if row.iter().any(|x| !x.is_zero()) {
            self.rows.push(row);
        }
    }

    /// How many of the k_j are fixed: none where no term knows the force.
    fn fixed(&self) -> usize {
        if self.groups.iter().any(|(_, forced)| *forced) { self.rows.len() } else { 0 }
    }

    /// Unknowns of which the force fixes a combination of the phases alone.
    fn combination(&self) -> Option<Vec<usize>> {
        let within = |group: &BTreeSet<usize>| {
            let touches = |row: &&Vec<Rational>| group.iter().any(|k| !row[*k].is_zero());
            self.rows.iter().filter(touches).count()
        };
        let found =
            self.groups.iter().find(|(group, forced)| *forced && within(group) < group.len());
        found.map(|(group, _)| group.iter().copied().collect())
    }
}

fn power(e: i32) -> u32 {
    u32::try_from(e).unwrap_or(0)
}

/// The exponents of the symbols and of eps in a term of order n.
fn parameters(exponents: &[i32], unknowns: usize, n: usize) -> Vec<u32> {
    let symbols = exponents.iter().skip(2 * unknowns + 1).map(|e| power(*e));
    symbols.chain([n as u32 - 1]).collect()
}

fn equation(slow: &SlowFlow, j: usize, turn: &Rational, order: usize) -> Vec<ComplexTerm> {
    let unknowns = slow.unknowns();
    let mut terms = Vec::new();
    for n in 1..=order {
        for term in slow.flow[j].get(n).into_iter().flatten() {
            terms.push(ComplexTerm {
                amplitudes: term.exponents[..2 * unknowns].iter().map(|e| power(*e)).collect(),
                parameters: parameters(&term.exponents, unknowns, n),
                re: term.re.clone(),
                im: term.im.clone(),
            });
        }
        for term in slow.detuning.get(n - 1).into_iter().flatten() {
            let mut amplitudes = vec![0; 2 * unknowns];
            amplitudes[2 * j] = 1;
            terms.push(ComplexTerm {
                amplitudes,
                parameters: parameters(&term.exponents, unknowns, n),
                re: Rational::new(),
                im: -Rational::from(turn * &term.re),
            });
        }
    }
    terms
}

/// The terms z^(q + 1) zbar^q of f, which do not know the phase of the force, divided by z; their imaginary part.
fn backbone(slow: &SlowFlow, turn: &Rational, names: &[&str], order: usize) -> Flow {
    let mut row = Polynomial::default();
    for n in 1..=order {
        for term in slow.flow[0].get(n).into_iter().flatten().filter(|t| t.exponents[2] == 0) {
            let radius = power(term.exponents[0] + term.exponents[1] - 1);
            let exponents = [vec![radius], parameters(&term.exponents, 1, n)].concat();
            row.add_term(&exponents, &term.im);
        }
        for term in slow.detuning.get(n - 1).into_iter().flatten() {
            let exponents = [vec![0], parameters(&term.exponents, 1, n)].concat();
            row.add_term(&exponents, &-Rational::from(turn * &term.re));
        }
    }
    let parameters = names.iter().map(|name| (*name).to_owned()).collect();
    Flow { rows: vec![row], parameters }
}

/// The response to the force at order zero of a single unknown and its rate at eta = 0, where the symbols have these
/// values.
#[must_use]
pub fn forced_part(slow: &SlowFlow, values: &[Rational]) -> [f64; 2] {
    let unknowns = slow.unknowns();
    let mut sums = [0.0, 0.0];
    let terms: &[_] = slow.solution.first().and_then(|x| x.first()).map_or(&[], Terms::as_slice);
    for term in terms.iter().filter(|t| t.exponents[..2 * unknowns].iter().all(|e| *e == 0)) {
        let symbols = term.exponents.iter().skip(2 * unknowns + 1).zip(values);
        let scale: Rational =
            symbols.fold(Rational::from(1), |product, (e, q)| product * q.clone().pow(*e));
        let rate = slow.system.force.to_f64() * f64::from(term.exponents[2 * unknowns]);
        sums[0] += Rational::from(&scale * &term.re).to_f64();
        sums[1] -= rate * Rational::from(&scale * &term.im).to_f64();
    }
    sums
}
