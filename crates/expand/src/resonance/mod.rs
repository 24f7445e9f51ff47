//! Averaging at resonance, for any number of unknowns and to any order, over an algebra of complex
//! amplitudes ([`AmplitudeAlgebra`]):
//!
//!   x_j'' + nu_j^2 x_j + force_j(eta) + eps F_j(x, x', x(t - T), eta; eps) = 0,   j = 1, ..., M,
//!   x_j = z_j + zbar_j + the response to force_j + sum eps^n u_{j,n}(z, zbar, e^{i eta}),
//!   z_j' = i nu_j z_j + sum eps^n f_{j,n}(z, zbar, e^{i eta}),   eta_l' = Omega_l + sum eps^n sigma_{l,n},
//!
//! with the phases eta_1, ..., eta_L of the forces, so that d/dt = D = sum eps^n D_n with D_0 diagonal on
//! monomials (i lambda) and
//! D_n f = sum_j (f_{j,n} df/dz_j + conj f_{j,n} df/dzbar_j) + sum_l sigma_{l,n} df/deta_l. With L_j the
//! characteristic function of the linear part at order zero, lambda^2 + nu_j^2 or one with damping and delays of which
//! i nu_j is a root, order n reads
//!
//!   L_j(D_0) u_{j,n} + L_j'(i nu_j) f_{j,n} + conj(L_j'(i nu_j) f_{j,n}) = g_{j,n},
//!
//! -g_{j,n} being order n of the equation formed with u_n = f_n = 0. **The split**: every monomial of g
//! with lambda = nu_j goes to f, whatever resonance made it so (an algebra that takes all others to be off resonance
//! refuses them); all others are divided. Delayed values are exp(-T D) x; since D_0 commutes with all D_n,
//! exp(-T D) = exp(-T D_0) exp(-T (eps D_1 + eps^2 D_2 + ...)), and the powers of the second exponential are built
//! order by order, in `delayed`. The u_{j,n}
//! have no monomial with |lambda| = nu_j, so the solution is unique, and z_j is the complex amplitude of
//! the harmonic nu_j in x_j. Without force and with M = 1 this is the averaging of Krylov, Bogoliubov
//! and Mitropolsky in other coordinates: f = z h(|z|^2), a = 2 |z|, a' = a Re h, psi' = nu + Im h.

mod balance;
mod check;
mod delayed;
mod linear;
mod linearise;
#[cfg(test)]
mod tests;

pub use check::{check_flow, checked_residual, energy};
pub use linearise::linear_part;

use balance::Balance;
use delayed::{Rates, Tower};
use linear::{Affine, Linear};
use linearise::linearise;

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{Scheme, run};
use crate::evaluator::Evaluator;
use crate::expansion::OrderWork;
use lindstedt_algebra::{AmplitudeAlgebra, LinearPart, Split};
use rug::Rational;

/// The slow flow and the motion, order by order; see [`resonant`].
#[derive(Clone, Debug)]
pub struct SlowFlow<E> {
    /// f_{j,n} at `[j][n]`; f_{j,0} = 0 stands for i nu_j z_j.
    pub flow: Vec<Vec<E>>,
    /// x_{j,n} at `[j][n]`: z_j + zbar_j + the response to the force, u_{j,1}, ...
    pub solution: Vec<Vec<E>>,
    /// sigma_{l,n} of eta_l' = Omega_l + sum eps^n sigma_{l,n} at `[l][n - 1]`, as it was given.
    pub detuning: Vec<Vec<E>>,
    /// p_0, p_1, ... of the parameter that was sought, known to the order before the last; see [`periodic`].
    pub parameter: Vec<E>,
    /// The part of order n of that motion with which it turns from its start; see [`periodic`].
    pub turned: Vec<E>,
    /// The smallest divisor of every order and unknown.
    pub nearest: Vec<Nearest>,
    /// The work, order by order.
    pub work: Vec<OrderWork>,
}

/// The harmonic of an order that is nearest to resonance without being in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// The order.
    pub order: usize,
    /// The unknown, from 0.
    pub unknown: usize,
    /// k_1, ..., k_M, m_1, ..., m_L of the harmonic sum_j k_j nu_j + sum_l m_l Omega_l.
    pub harmonic: Vec<i32>,
    /// 1 - lambda^2/nu^2; over enclosures its middle.
    pub size: Rational,
}

impl<E> SlowFlow<E> {
    /// The highest order derived.
    pub fn order(&self) -> usize {
        self.solution.first().map_or(0, |x| x.len() - 1)
    }
}

/// Derives the slow flow up to an order, for an equation of [`crate::compile_system`] over the same
/// algebra; `detuning[l]` is sigma_{l,1}, sigma_{l,2}, ... (real; empty where eta_l' = Omega_l); `observer` as in
/// [`crate::expand`], false ends the derivation with the orders found so far.
///
/// Exact over exact coefficients; over balls every coefficient is an enclosure. Cost: O(N^2) products of
/// polynomials, whose length grows like N^(symbols + 1), O(N^3) with delays; where one equation is linear, O(N^2)
/// products of constants (`linear`).
///
/// # Errors
/// [`ExpandError::NotTheFrequency`] where order zero is not the oscillator of the algebra, [`ExpandError::ForcedAtResonance`] where the
/// force at order zero is in resonance; [`ExpandError::Phase`] where the coefficients cannot be divided.
///
/// # Example
/// The primary resonance of Duffing's oscillator, x'' + x + eps (x^3 - F cos t) = 0:
/// ```
/// use lindstedt_equation::{Expression, Function};
/// use lindstedt_expand::{Binding, compile_system, resonance::{check_flow, resonant}};
/// use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes};
/// use lindstedt_phase::amplitudes::scalars::{Integers, Scalars};
/// use rug::Rational;
///
/// struct Symbols<'a>(&'a Amplitudes<Integers>);
/// impl Binding<Amplitudes<Integers>> for Symbols<'_> {
///     fn parameter(&self, name: &str) -> Option<AmplitudeElement<<Integers as Scalars>::Element>> { self.0.symbol(name) }
/// }
/// let one = Rational::from(1);
/// let algebra = Amplitudes::new(Integers, &[one.clone()], &one, &["F"]).ok_or("frequencies")?;
/// let (x, t) = (Expression::DISPLACEMENT, Expression::Time);
/// let force = Expression::parameter("F") * t.apply(Function::Cos);
/// let equation = Expression::ACCELERATION + x.clone() + Expression::Small * (x.pow(3) - force);
/// let graph = compile_system(&algebra, &[equation], &Symbols(&algebra), 3)?;
/// let found = resonant(&algebra, &graph, 3, &[], &mut |_| true)?;
/// check_flow(&algebra, &graph, &found)?;
/// // f_1 = -(i/4) F E + (3/2) i z^2 zbar: exponents of z, zbar, E, F.
/// let terms = algebra.rational_terms(&found.flow[0][1]).ok_or("rational")?;
/// let mut shown: Vec<_> = terms.into_iter().map(|t| (t.exponents, t.im)).collect();
/// shown.sort();
/// assert_eq!(shown, [(vec![0, 0, 1, 1], (-1, 4).into()), (vec![2, 1, 0, 0], (3, 2).into())]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resonant<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    order: usize,
    detuning: &[Vec<A::Element>],
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<SlowFlow<A::Element>, ExpandError> {
    if detuning.concat().is_empty()
        && let Some(affine) = Affine::of(algebra, equation, order)
    {
        return Linear::start(algebra, affine)?.finish(order, observer);
    }
    let generating = |j| algebra.twice_real(&algebra.amplitude(j));
    let generating = (0..algebra.unknowns()).map(generating).collect();
    Resonant::start(algebra, equation, detuning, generating)?.finish(order, observer)
}

/// The motion x_j = `generating[j]` + sum eps^n u_{j,n} without slow change, for functions of the force's
/// phase alone (of the harmonics nu_j), and the parameter p = p_0 + eps p_1 + ... that keeps it so: order n
/// of the equations has no part in the harmonics nu_j for one p_{n-1}. The equation contains eps p, p where
/// the binding says it is sought, and at order one not its powers.
///
/// Lindstedt's loop: the edges of the tongues of Mathieu's equation, where a = nu^2 + eps p. A policy of
/// [`resonant`]: the same split, whose resonant part p removes. Where p alone does not, the motion of one unknown
/// turns: x_{n-1} has a part beta_{n-1} x_0' of the harmonic nu beside.
///
/// # Errors
/// As [`resonant`]; [`ExpandError::NotBalanced`] at the order at which no p does, [`ExpandError::TurnsBySymbols`] where
/// beta is no polynomial.
pub fn periodic<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    order: usize,
    detuning: &[Vec<A::Element>],
    generating: Vec<A::Element>,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<SlowFlow<A::Element>, ExpandError> {
    let mut loops = Resonant::start(algebra, equation, detuning, generating)?;
    loops.balance =
        Some(Balance::new(algebra, equation, &loops.linear, [&loops.x, &loops.velocity])?);
    loops.finish(order, observer)
}

struct Resonant<'a, A: AmplitudeAlgebra> {
    algebra: &'a A,
    evaluator: Evaluator<'a, A>,
    linear: Vec<LinearPart<A::Element>>,
    detuning: &'a [Vec<A::Element>],
    /// f_{j,n}, x_{j,n} and order n of x_j'.
    flow: Vec<Vec<A::Element>>,
    x: Vec<Vec<A::Element>>,
    velocity: Vec<Vec<A::Element>>,
    /// x_j(t - T) for every delay.
    towers: Vec<Vec<Tower<A::Element>>>,
    /// Whether coefficient n of a node depends on x_{j,n}, its rate or their delayed values.
    sensitive: Vec<bool>,
    nearest: Vec<Nearest>,
    /// The parameter that is sought, if one is.
    balance: Option<Balance<A::Element>>,
}

impl<A: AmplitudeAlgebra> Scheme for Resonant<'_, A> {
    fn products(&self) -> u64 {
        self.evaluator.products
    }

    fn terms(&self) -> usize {
        let last = self.x.iter().filter_map(|x| x.last());
        last.map(|x| self.algebra.terms(x)).sum()
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        // Provisionally u_n = f_n = 0.
        for j in 0..self.x.len() {
            self.flow[j].push(algebra.zero());
            self.x[j].push(algebra.zero());
        }
        for j in 0..self.x.len() {
            let rate = self.rate_of_change(&self.x[j], n);
            self.velocity[j].push(rate);
        }
        self.extend_delayed(n)?;
        self.assign(n);
        let mut parts = self.parts(n)?;
        self.turn(n, &mut parts)?;
        if let Some(balance) = &mut self.balance {
            balance.settle(&mut self.evaluator, n, &mut parts)?;
        }
        for (j, Split { flow, response, nearest }) in parts.into_iter().enumerate() {
            self.amend(j, n, &response, &algebra.twice_real(&flow))?;
            self.flow[j][n] = flow;
            let near = |(harmonic, size)| Nearest { order: n, unknown: j, harmonic, size };
            self.nearest.extend(nearest.map(near));
        }
        self.assign(n);
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        Ok(())
    }
}

impl<'a, A: AmplitudeAlgebra> Resonant<'a, A> {
    fn start(
        algebra: &'a A,
        equation: &'a Equation<A>,
        detuning: &'a [Vec<A::Element>],
        generating: Vec<A::Element>,
    ) -> Result<Self, ExpandError> {
        let unknowns = equation.roots.len();
        if unknowns != algebra.unknowns() || unknowns != generating.len() {
            return Err(ExpandError::NotTheFrequency { unknown: unknowns });
        }
        let (linear, sensitive) = linearise(algebra, equation, &generating)?;
        for (unknown, part) in linear.iter().enumerate().filter(|(_, part)| part.is_free(algebra)) {
            let gap = algebra.sub(&part.stiffness, &algebra.frequency_squared(unknown));
            if !algebra.may_vanish(&gap) {
                return Err(ExpandError::NotTheFrequency { unknown });
            }
        }
        let towers = || (0..algebra.delays()).map(Tower::new).collect();
        let mut averaging = Self {
            algebra,
            // Anew: coefficients of order 1 that the linear part needed depend on x_0, which a force changes.
            evaluator: Evaluator::new(algebra, equation),
            linear,
            detuning,
            flow: generating.iter().map(|_| vec![algebra.zero()]).collect(),
            velocity: generating.iter().map(|x| vec![algebra.by_time(x)]).collect(),
            towers: generating.iter().map(|_| towers()).collect(),
            x: generating.into_iter().map(|x| vec![x]).collect(),
            sensitive,
            nearest: Vec::new(),
            balance: None,
        };
        averaging.order_zero()?;
        Ok(averaging)
    }

    /// Derives the orders.
    fn finish(
        mut self,
        order: usize,
        observer: &mut dyn FnMut(&OrderWork) -> bool,
    ) -> Result<SlowFlow<A::Element>, ExpandError> {
        let work = run(&mut self, 1..=order, observer)?;
        Ok(self.finished(work))
    }

    /// The orders that are finished: an order that was interrupted has provisional values.
    fn finished(self, work: Vec<OrderWork>) -> SlowFlow<A::Element> {
        let finished = work.len() + 1;
        let Self { mut flow, mut x, mut nearest, balance, .. } = self;
        flow.iter_mut().chain(&mut x).for_each(|list| list.truncate(finished));
        nearest.retain(|near| near.order < finished);
        let (mut parameter, mut turned) =
            balance.map_or_else(Default::default, |balance| (balance.values, balance.turned));
        [&mut parameter, &mut turned].into_iter().for_each(|list| list.truncate(finished - 1));
        let detuning = self.detuning.to_vec();
        SlowFlow { flow, solution: x, detuning, parameter, turned, nearest, work }
    }

    /// Adds the responses to the forces at order zero.
    fn order_zero(&mut self) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        self.extend_delayed(0)?;
        self.assign(0);
        for j in 0..self.x.len() {
            let force = self.right_side(j, 0)?;
            let phase = |source| ExpandError::Phase { order: 0, source };
            let split = algebra.split(j, &self.linear[j], &force).map_err(phase)?;
            if !algebra.may_vanish(&split.flow) {
                return Err(ExpandError::ForcedAtResonance { unknown: j });
            }
            self.amend(j, 0, &split.response, &algebra.zero())?;
        }
        self.assign(0);
        for unknown in 0..self.x.len() {
            if !algebra.may_vanish(&self.right_side(unknown, 0)?) {
                return Err(ExpandError::NotTheFrequency { unknown });
            }
        }
        Ok(())
    }

    fn rates(&self) -> Rates<'_, A::Element> {
        Rates { flow: &self.flow, detuning: self.detuning }
    }

    /// Order n of the right sides, split.
    fn parts(&mut self, n: usize) -> Result<Vec<Split<A>>, ExpandError> {
        let mut parts = Vec::new();
        for j in 0..self.x.len() {
            let g = self.right_side(j, n)?;
            let split = self.algebra.split(j, &self.linear[j], &g);
            if self.algebra.interrupted() {
                return Err(ExpandError::Interrupted { order: n });
            }
            parts.push(split.map_err(|source| ExpandError::Phase { order: n, source })?);
        }
        Ok(parts)
    }

    /// Turns the motion in order n - 1, so that a parameter balances order n; see [`balance`].
    fn turn(&mut self, n: usize, parts: &mut Vec<Split<A>>) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        let Some(balance) = &mut self.balance else { return Ok(()) };
        balance.turned.resize(n, algebra.zero());
        let (w, aside) = (balance.tangent.clone(), balance.aside(algebra, parts));
        let one = self.x.len() == 1 && algebra.delays() == 0;
        if !one || n == 1 || algebra.may_vanish(&aside) {
            return Ok(());
        }
        self.shift(n, &w)?;
        let turned = self.parts(n)?;
        let Some(balance) = &mut self.balance else { return Ok(()) };
        let slope = algebra.sub(&balance.aside(algebra, &turned), &aside);
        if algebra.may_vanish(&slope) {
            return Err(ExpandError::NotBalanced { order: n });
        }
        // Both are imaginary.
        let square = algebra.mul(&slope, &algebra.conjugate(&slope));
        let inverse = algebra.reciprocal(&square).filter(|_| algebra.as_constant(&aside).is_some());
        let inverse = inverse.ok_or(ExpandError::TurnsBySymbols { order: n })?;
        let beta = algebra.mul(&algebra.mul(&aside, &slope), &inverse);
        balance.turned[n - 1] = algebra.mul(&beta, &w);
        let rest = algebra.sub(&balance.turned[n - 1], &w);
        self.shift(n, &rest)?;
        *parts = self.parts(n)?;
        Ok(())
    }

    /// Adds u, of the harmonic nu, to x_{n-1}.
    fn shift(&mut self, n: usize, u: &A::Element) -> Result<(), ExpandError> {
        self.amend(0, n - 1, u, &self.algebra.zero())?;
        self.velocity[0][n] = self.rate_of_change(&self.x[0], n);
        self.evaluator.forget_from(n - 1, &vec![true; self.sensitive.len()]);
        self.assign(n - 1);
        self.assign(n);
        Ok(())
    }

    /// Order n of D f for a real series f.
    fn rate_of_change(&self, f: &[A::Element], n: usize) -> A::Element {
        let mut sum = self.rates().drift(self.algebra, f, n);
        if let Some(f) = f.get(n) {
            self.algebra.add_assign(&mut sum, &self.algebra.by_time(f));
        }
        sum
    }

    /// g_{j,n}, with the provisional values of order n.
    fn right_side(&mut self, j: usize, n: usize) -> Result<A::Element, ExpandError> {
        let root = self.evaluator.equation.roots[j];
        let force = self.evaluator.coefficient(root, n)?;
        let acceleration = self.rate_of_change(&self.velocity[j], n);
        Ok(self.algebra.neg(&self.algebra.add(&acceleration, &force)))
    }

    fn extend_delayed(&mut self, n: usize) -> Result<(), ExpandError> {
        let rates = Rates { flow: &self.flow, detuning: self.detuning };
        for (towers, x) in self.towers.iter_mut().zip(&self.x) {
            for tower in towers {
                tower.extend(self.algebra, &rates, x, n).ok_or(ExpandError::NotWeaklyNonlinear)?;
            }
        }
        Ok(())
    }

    /// Adds u to x_{j,n}, and D_n x_{j,0} = `drift` to the rate, with what follows for the delayed values.
    fn amend(
        &mut self,
        j: usize,
        n: usize,
        u: &A::Element,
        drift: &A::Element,
    ) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        let rate = algebra.add(&algebra.by_time(u), drift);
        algebra.add_assign(&mut self.velocity[j][n], &rate);
        for tower in &mut self.towers[j] {
            tower.amend(algebra, n, u, drift).ok_or(ExpandError::NotWeaklyNonlinear)?;
        }
        algebra.add_assign(&mut self.x[j][n], u);
        Ok(())
    }

    /// Hands order n of the unknowns, their rates and delayed values to the evaluator.
    fn assign(&mut self, n: usize) {
        let algebra = self.algebra;
        self.evaluator.forget_from(n, &self.sensitive);
        for j in 0..self.x.len() {
            self.evaluator.assign(&Node::unknown(j, false, None), n, self.x[j][n].clone());
            self.evaluator.assign(&Node::unknown(j, true, None), n, self.velocity[j][n].clone());
            for (delay, tower) in self.towers[j].iter().enumerate() {
                let late = Node::unknown(j, false, Some(delay));
                self.evaluator.assign(&late, n, tower.values()[n].clone());
                // exp(-T D) commutes with D: the delayed velocity is the rate of the delayed value.
                let rates = Rates { flow: &self.flow, detuning: self.detuning };
                let mut rate = rates.drift(algebra, tower.values(), n);
                algebra.add_assign(&mut rate, &algebra.by_time(&tower.values()[n]));
                self.evaluator.assign(&Node::unknown(j, true, Some(delay)), n, rate);
            }
        }
    }
}
