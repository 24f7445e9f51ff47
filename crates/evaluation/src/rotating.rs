//! A slow flow in the rotating frame, where it is autonomous: z_j = w_j e^{i k_j eta}, k_j eta = sum_l k_{jl} eta_l, with
//! k_j = nu_j/Omega for one phase.
//!
//! Every term z^p zbar^q E^m of f_j asks that sum_i (p_i - q_i) k_i + m = k_j; one phase fulfils that, for what is
//! resonant stays in f, and several do where their detunings do not pull at the same amplitude. Then
//!
//!   w_j' = sum_n eps^n (f_{j,n}(w, wbar, 1) - i sum_l k_{jl} sigma_{l,n} w_j).
//!
//! What is evaluated is w'/eps. Its steady states are the periodic (of several phases quasi-periodic) responses; k_j = 1 at
//! a primary resonance, 1/2 at the principal parametric one, 1/3 and 3 at the sub- and superharmonic ones.
//!
//! Without a force k_j = nu_j/nu_1, eta turns with nu_1 and one phase is free at least: two unknowns that a resonance ties
//! together lock where w_j' = i k_j delta w_j, at the frequency nu_1 + eps delta.

use lindstedt_derivation::resonance::{Phase, SlowFlow, Terms};
use lindstedt_orbit::steady::{ComplexTerm, Flow, FreePhase, Polynomial};
use rug::Rational;
use std::collections::BTreeSet;

/// The autonomous slow flow.
#[derive(Clone, Debug)]
pub struct Rotating {
    /// w'/eps; its parameters are the symbols of the slow flow, then the small parameter.
    pub flow: Flow,
    /// Whether it has every term of the slow flow; one that cannot be told from zero is missing where it would depend on
    /// the time in this frame.
    pub whole: bool,
    /// k_{j,1}, k_{j,2}, ...
    pub turns: Vec<Vec<Rational>>,
    /// How many of the k_j the resonances fix, the rank of their relations: where it is less than the number of
    /// unknowns, a motion may be steady in another frame than this.
    pub fixed: usize,
    /// Unknowns of which the force fixes a combination of the phases alone.
    pub combination: Option<Vec<usize>>,
    /// The flow of two unknowns where one phase is free.
    pub free: Option<FreePhase>,
    /// Im (w'/w)/eps of free motion as a polynomial in |w| and the parameters, of a single unknown: zero on the
    /// backbone.
    pub backbone: Option<Flow>,
}

/// Why a slow flow is autonomous in no rotating frame.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoFrame {
    /// There is no force, and not two but so many unknowns.
    NoForce(usize),
    /// The rate of a force is no number.
    NoNumber,
    /// Forces of different detunings act on the same amplitudes.
    SeveralRates,
}

/// The slow flow up to an order in the rotating frame.
///
/// # Errors
/// [`NoFrame`] where there is none.
pub fn rotating(slow: &SlowFlow, small: &str, order: usize) -> Result<Rotating, NoFrame> {
    let system = &slow.system;
    let rates = system.forces.iter().map(|phase| phase.number());
    let rates = rates.collect::<Option<Vec<_>>>().ok_or(NoFrame::NoNumber)?;
    let first = match (rates.first(), &system.frequencies[..]) {
        (Some(rate), _) => rate,
        (None, [first, _]) => first,
        (None, all) => return Err(NoFrame::NoForce(all.len())),
    };
    let relations = Relations::of(slow, &slow.flow, order);
    let free = |nu: &Rational| {
        let mut turn = vec![Rational::new(); slow.forces()];
        turn[0] = Rational::from(nu / first);
        turn
    };
    let turns: Vec<_> = system.frequencies.iter().map(free).collect();
    // What may vanish is resonant, too, but ties no phase.
    let all = relations.clone().and(Relations::of(slow, &slow.doubtful, order));
    let (turns, mut whole) = match all.solved(turns.clone()) {
        Some(turns) => (turns, true),
        None => (relations.solved(turns).ok_or(NoFrame::SeveralRates)?, false),
    };
    whole &= slow.doubtful.is_empty() || relations.combination().is_none();
    let of = |j| equation(slow, j, &turns[j], (order, whole));
    let equations: Vec<Vec<ComplexTerm>> = (0..turns.len()).map(of).collect();
    let energy = energy(slow);
    let family = energy.as_ref().map(|_| FAMILY);
    let names = system.symbols.iter().map(String::as_str).chain([small]).chain(family);
    let names: Vec<&str> = names.collect();
    let backbone = (turns.len() == 1).then(|| backbone(slow, &turns[0], &names, order));
    let (fixed, combination) = (relations.fixed(), relations.combination());
    let flow = Flow::of_complex(&equations, &names);
    let free = relations.weights().zip(<[_; 2]>::try_from(equations).ok());
    let parameters = flow.parameters.clone();
    let free = free.filter(|_| fixed > 0 || system.forces.is_empty());
    let definite = energy.as_ref().is_some_and(|[one, two]| one.is_positive_times(two));
    let free = free.map(|(weights, equations)| FreePhase {
        equations,
        weights,
        parameters,
        energy,
        definite,
    });
    Ok(Rotating { flow, whole, turns, fixed, combination, free, backbone })
}

/// The name of the parameter of a family of normal modes.
pub const FAMILY: &str = "amplitude";

/// The coefficients of z_j zbar_j in the energy of two unknowns.
fn energy(slow: &SlowFlow) -> Option<[Polynomial; 2]> {
    let mut sums = [Polynomial::default(), Polynomial::default()];
    let pair = slow.unknowns() == 2 && slow.system.forces.is_empty();
    for term in slow.energy.first().filter(|_| pair)? {
        let powers: Vec<u32> =
            term.exponents[slow.first_symbol()..].iter().map(|e| power(*e)).collect();
        match term.exponents[..4] {
            [1, 1, 0, 0] => sums[0].add_term(&powers, &term.re),
            [0, 0, 1, 1] => sums[1].add_term(&powers, &term.re),
            _ => return None,
        }
    }
    Some(sums)
}

/// What fixes the k_j: every term z^p zbar^q E^m of f_j is a relation (p - q - e_j) k = -m.
#[derive(Clone, Default)]
struct Relations {
    /// Independent ones, each free of the first unknown of those before it, and -m.
    rows: Vec<(Vec<Rational>, Vec<Rational>)>,
    /// Whether they contradict each other.
    contradictory: bool,
    /// Sets of unknowns that relations tie together, and whether one of these knows the force.
    groups: Vec<(BTreeSet<usize>, bool)>,
}

impl Rotating {
    /// The flow of two unknowns without a force.
    #[must_use]
    pub fn unforced(&self) -> Option<&FreePhase> {
        self.free.as_ref().filter(|_| self.fixed == 0)
    }
}

impl Relations {
    fn of(slow: &SlowFlow, flow: &[Vec<Terms>], order: usize) -> Self {
        let mut relations = Self::default();
        for (j, orders) in flow.iter().enumerate() {
            for term in orders.iter().take(order + 1).skip(1).flatten() {
                let (amplitudes, rest) = term.exponents.split_at(2 * slow.unknowns());
                relations.add(j, amplitudes, &rest[..slow.forces()]);
            }
        }
        relations
    }

    /// Both.
    fn and(mut self, other: Self) -> Self {
        self.contradictory |= other.contradictory;
        other.rows.into_iter().for_each(|(row, right)| self.reduce(row, right));
        self
    }

    fn add(&mut self, j: usize, amplitudes: &[i32], phases: &[i32]) {
        let relation = |(k, pair): (usize, &[i32])| pair[0] - pair[1] - i32::from(k == j);
        let relations = amplitudes.chunks_exact(2).enumerate().map(relation);
        let row: Vec<Rational> = relations.map(Rational::from).collect();
        let right: Vec<Rational> = phases.iter().map(|m| Rational::from(-m)).collect();
        let mut tied: BTreeSet<usize> = (0..row.len()).filter(|k| !row[*k].is_zero()).collect();
        if tied.is_empty() {
            self.contradictory |= right.iter().any(|m| !m.is_zero());
            return;
        }
        let mut forced = phases.iter().any(|m| *m != 0);
        self.groups.retain(|(group, knows)| {
            let apart = group.is_disjoint(&tied);
            if !apart {
                tied.extend(group);
                forced |= knows;
            }
            apart
        });
        self.groups.push((tied, forced));
        self.reduce(row, right);
    }

    fn reduce(&mut self, mut row: Vec<Rational>, mut right: Vec<Rational>) {
        for (known, own) in &self.rows {
            let Some(pivot) = known.iter().position(|x| !x.is_zero()) else { continue };
            let factor = Rational::from(&row[pivot] / &known[pivot]);
            row.iter_mut().zip(known).for_each(|(x, y)| *x -= Rational::from(&factor * y));
            right.iter_mut().zip(own).for_each(|(x, y)| *x -= Rational::from(&factor * y));
        }
        if row.iter().any(|x| !x.is_zero()) {
            self.rows.push((row, right));
        } else {
            self.contradictory |= right.iter().any(|m| !m.is_zero());
        }
    }

    /// The k_j, those given where they are free; nothing where no k_j fulfil the relations.
    fn solved(&self, mut turns: Vec<Vec<Rational>>) -> Option<Vec<Vec<Rational>>> {
        for (row, right) in self.rows.iter().rev() {
            let pivot = row.iter().position(|x| !x.is_zero())?;
            let value = |l: usize| {
                let others = row.iter().zip(&turns).enumerate().filter(|(k, _)| *k != pivot);
                let sum: Rational = others.map(|(_, (x, turn))| Rational::from(x * &turn[l])).sum();
                (&right[l] - sum) / &row[pivot]
            };
            turns[pivot] = (0..right.len()).map(value).collect();
        }
        (!self.contradictory).then_some(turns)
    }

    /// How many of the k_j are fixed: none where no term knows the force.
    fn fixed(&self) -> usize {
        if self.groups.iter().any(|(_, forced)| *forced) { self.rows.len() } else { 0 }
    }

    /// d_1, d_2 of the phases that the only relation of two unknowns does not see.
    fn weights(&self) -> Option<[Rational; 2]> {
        let [(row, _)] = &self.rows[..] else { return None };
        let [a, b] = &row[..] else { return None };
        (!a.is_zero() && !b.is_zero()).then(|| [Rational::from(1), -Rational::from(a / b)])
    }

    /// Unknowns of which the force fixes a combination of the phases alone.
    fn combination(&self) -> Option<Vec<usize>> {
        let within = |group: &BTreeSet<usize>| {
            let touches = |(row, _): &&(Vec<Rational>, _)| group.iter().any(|k| !row[*k].is_zero());
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
fn parameters(slow: &SlowFlow, exponents: &[i32], n: usize) -> Vec<u32> {
    let symbols = exponents.iter().skip(slow.first_symbol()).map(|e| power(*e));
    symbols.chain([n as u32 - 1]).collect()
}

/// The terms of -sum_l k_l sigma_{l,n}.
fn detuning<'a>(
    slow: &'a SlowFlow,
    turn: &'a [Rational],
    n: usize,
) -> impl Iterator<Item = (&'a [i32], Rational)> {
    turn.iter().zip(&slow.detuning).flat_map(move |(k, orders)| {
        let terms = orders.get(n - 1).into_iter().flatten();
        terms.map(move |term| (&term.exponents[..], -Rational::from(k * &term.re)))
    })
}

fn equation(
    slow: &SlowFlow,
    j: usize,
    turn: &[Rational],
    (order, whole): (usize, bool),
) -> Vec<ComplexTerm> {
    let unknowns = slow.unknowns();
    let radius = slow.enclosed.map_or(0.0, |enclosed| enclosed.radius);
    let doubtful = slow.doubtful.get(j).filter(|_| whole);
    let mut terms = Vec::new();
    for n in 1..=order {
        let doubtful = doubtful.and_then(|orders| orders.get(n));
        for term in slow.flow[j].get(n).into_iter().chain(doubtful).flatten() {
            terms.push(ComplexTerm {
                amplitudes: term.exponents[..2 * unknowns].iter().map(|e| power(*e)).collect(),
                parameters: parameters(slow, &term.exponents, n),
                re: term.re.clone(),
                im: term.im.clone(),
                radius,
            });
        }
        for (exponents, im) in detuning(slow, turn, n) {
            let mut amplitudes = vec![0; 2 * unknowns];
            amplitudes[2 * j] = 1;
            let parameters = parameters(slow, exponents, n);
            terms.push(ComplexTerm { amplitudes, parameters, re: Rational::new(), im, radius });
        }
    }
    terms
}

/// The terms z^(q + 1) zbar^q of f, which do not know the phase of the force, divided by z; their imaginary part.
fn backbone(slow: &SlowFlow, turn: &[Rational], names: &[&str], order: usize) -> Flow {
    let mut row = Polynomial::default();
    for n in 1..=order {
        let free = |exponents: &[i32]| exponents[2..slow.first_symbol()].iter().all(|m| *m == 0);
        let terms = slow.flow[0].get(n).into_iter().flatten();
        for term in terms.filter(|t| free(&t.exponents)) {
            let radius = power(term.exponents[0] + term.exponents[1] - 1);
            let exponents = [vec![radius], parameters(slow, &term.exponents, n)].concat();
            row.add_term(&exponents, &term.im);
        }
        for (exponents, im) in detuning(slow, turn, n) {
            row.add_term(&[vec![0], parameters(slow, exponents, n)].concat(), &im);
        }
    }
    let parameters = names.iter().map(|name| (*name).to_owned()).collect();
    Flow::of_rows(vec![row], parameters)
}

/// The sum of the moduli of terms at |w_j| and the values of the symbols.
fn size(slow: &SlowFlow, terms: &Terms, values: &[f64], moduli: &[f64]) -> f64 {
    let sizes = terms.iter().map(|term| {
        let scale = term.re.to_f64().hypot(term.im.to_f64());
        let amplitudes = term.exponents[..2 * slow.unknowns()].chunks_exact(2).zip(moduli);
        let scale = amplitudes.fold(scale, |p, (e, w)| p * w.powi(e[0] + e[1]));
        let symbols = term.exponents.iter().skip(slow.first_symbol()).zip(values);
        symbols.fold(scale, |product, (e, x)| product * x.abs().powi(*e))
    });
    sizes.sum()
}

/// sum_j nu_j |w_j| (in the time of the unit of frequency) and, order by order, eps^n sum_j |f_{j,n} - i sum_l k_{jl} sigma_{l,n} w_j|
/// with every term taken by its modulus: what the orders add to w' at a state of these |w_j|, from above. The values are those
/// of the symbols and of eps.
#[must_use]
pub fn order_sizes(
    slow: &SlowFlow,
    turns: &[Vec<Rational>],
    values: &[f64],
    moduli: &[f64],
    order: usize,
) -> Vec<f64> {
    let size = |terms: &Terms| size(slow, terms, values, moduli);
    let free = slow.system.frequencies.iter().zip(moduli).map(|(nu, w)| nu.to_f64() * w).sum();
    let small = values.last().copied().unwrap_or(0.0).abs();
    let power = |n: usize| small.powi(i32::try_from(n).unwrap_or(i32::MAX));
    let flow = |n: usize| -> f64 { slow.flow.iter().filter_map(|f| f.get(n)).map(size).sum() };
    let turning = |l: usize| -> f64 {
        let shares = turns.iter().zip(moduli);
        shares.map(|(k, w)| k.get(l).map_or(0.0, |k| k.to_f64().abs()) * w).sum()
    };
    let detuning = |n: usize| -> f64 {
        let rates = slow.detuning.iter().enumerate();
        rates.filter_map(|(l, sigma)| Some(size(sigma.get(n - 1)?) * turning(l))).sum()
    };
    let orders = (1..=order).map(|n| power(n) * (flow(n) + detuning(n)));
    std::iter::once(free).chain(orders).collect()
}

/// eps sum_j (|u_{j,1}| + |f_{j,1}|/nu_j) with every term taken by its modulus: by how much w at the start of a motion differs
/// from its leading order, but for terms of order eps^2.
#[must_use]
pub fn start_error(slow: &SlowFlow, values: &[f64], moduli: &[f64]) -> f64 {
    let first = |list: &Vec<Terms>| list.get(1).map_or(0.0, |it| size(slow, it, values, moduli));
    let motion: f64 = slow.solution.iter().map(first).sum();
    let flow = slow.flow.iter().zip(&slow.system.frequencies);
    let flow: f64 = flow.map(|(list, nu)| first(list) / nu.to_f64()).sum();
    values.last().copied().unwrap_or(0.0).abs() * (motion + flow)
}

/// The response of an unknown to the forces at order zero and its rate at eta_l = 0 in the time of the unit of frequency,
/// where the symbols have these values.
#[must_use]
pub fn forced_part(slow: &SlowFlow, unknown: usize, values: &[f64]) -> [f64; 2] {
    let unknowns = slow.unknowns();
    let mut sums = [0.0, 0.0];
    let terms: &[_] =
        slow.solution.get(unknown).and_then(|x| x.first()).map_or(&[], Terms::as_slice);
    for term in terms.iter().filter(|t| t.exponents[..2 * unknowns].iter().all(|e| *e == 0)) {
        let symbols = term.exponents.iter().skip(slow.first_symbol()).zip(values);
        let scale: f64 = symbols.fold(1.0, |product, (e, x)| product * x.powi(*e));
        let turns = slow.system.forces.iter().zip(&term.exponents[2 * unknowns..]);
        let rate = |phase: &Phase| phase.number().unwrap_or_default().to_f64();
        let rate: f64 = turns.map(|(phase, m)| rate(phase) * f64::from(*m)).sum();
        sums[0] += scale * term.re.to_f64();
        sums[1] -= rate * scale * term.im.to_f64();
    }
    sums
}
