//! Averaging at resonance, for any number of unknowns and to any order, over an algebra of complex
//! amplitudes ([`AmplitudeAlgebra`]):
//!
//!   x_j'' + nu_j^2 x_j + force_j(eta) + eps F_j(x, x', eta; eps) = 0,   j = 1, ..., M,
//!   x_j = z_j + zbar_j + the response to force_j + sum eps^n u_{j,n}(z, zbar, e^{i eta}),
//!   z_j' = i nu_j z_j + sum eps^n f_{j,n}(z, zbar, e^{i eta}),   eta_l' = Omega_l + sum eps^n sigma_{l,n},
//!
//! with the phases eta_1, ..., eta_L of the forces, so that d/dt = D = sum eps^n D_n with D_0 diagonal on
//! monomials (i lambda) and
//! D_n f = sum_j (f_{j,n} df/dz_j + conj f_{j,n} df/dzbar_j) + sum_l sigma_{l,n} df/deta_l. Order n reads
//!
//!   (D_0^2 + nu_j^2) u_{j,n} + 2 i nu_j f_{j,n} + conj(2 i nu_j f_{j,n}) = g_{j,n},
//!
//! -g_{j,n} being order n of the equation formed with u_n = f_n = 0. **The split**: every monomial of g
//! with lambda = nu_j goes to f, whatever resonance made it so; all others are divided. The u_{j,n}
//! have no monomial with |lambda| = nu_j, so the solution is unique, and z_j is the complex amplitude of
//! the harmonic nu_j in x_j. Without force and with M = 1 this is the averaging of Krylov, Bogoliubov
//! and Mitropolsky in other coordinates: f = z h(|z|^2), a = 2 |z|, a' = a Re h, psi' = nu + Im h.

mod balance;
mod check;

pub use check::{check_flow, checked_residual, energy};

use balance::Balance;

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{OrderWork, Scheme, run};
use crate::evaluator::Evaluator;
use lindstedt_algebra::{AmplitudeAlgebra, Split};
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
/// polynomials, whose length grows like N^(symbols + 1).
///
/// # Errors
/// [`ExpandError::NotTheFrequency`] where order zero is not the oscillator of the algebra or the force at
/// order zero is in resonance; [`ExpandError::Phase`] where the coefficients cannot be divided.
///
/// # Example
/// The primary resonance of Duffing's oscillator, x'' + x + eps (x^3 - F cos t) = 0:
/// ```
/// use lindstedt_equation::{Expression, Function};
/// use lindstedt_expand::{Binding, compile_system, resonance::{check_flow, resonant}};
/// use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, scalars::Integers};
/// use rug::{Integer, Rational};
///
/// struct Symbols<'a>(&'a Amplitudes<Integers>);
/// impl Binding<Amplitudes<Integers>> for Symbols<'_> {
///     fn parameter(&self, name: &str) -> Option<AmplitudeElement<Integer>> { self.0.symbol(name) }
///     fn formal(&self, _: &str, _: usize) -> Option<AmplitudeElement<Integer>> { None }
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
/// [`resonant`]: the same split, whose resonant part p removes.
///
/// # Errors
/// As [`resonant`]; [`ExpandError::NotBalanced`] at the order at which no p does.
pub fn periodic<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    order: usize,
    detuning: &[Vec<A::Element>],
    generating: Vec<A::Element>,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<SlowFlow<A::Element>, ExpandError> {
    let mut loops = Resonant::start(algebra, equation, detuning, generating)?;
    loops.balance = Some(Balance::new(algebra, equation, &loops.x, &loops.velocity)?);
    loops.finish(order, observer)
}

struct Resonant<'a, A: AmplitudeAlgebra> {
    algebra: &'a A,
    evaluator: Evaluator<'a, A>,
    detuning: &'a [Vec<A::Element>],
    /// f_{j,n}, x_{j,n} and order n of x_j'.
    flow: Vec<Vec<A::Element>>,
    x: Vec<Vec<A::Element>>,
    velocity: Vec<Vec<A::Element>>,
    /// Whether coefficient n of a node depends on x_{j,n} or its rate.
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
        self.assign(n);
        let mut parts = Vec::new();
        for j in 0..self.x.len() {
            let g = self.right_side(j, n)?;
            let phase = |source| ExpandError::Phase { order: n, source };
            parts.push(algebra.split(j, &g).map_err(phase)?);
        }
        if let Some(balance) = &mut self.balance {
            balance.settle(&mut self.evaluator, n, &mut parts)?;
        }
        for (j, Split { flow, response, nearest }) in parts.into_iter().enumerate() {
            let change = algebra.add(&algebra.by_time(&response), &algebra.twice_real(&flow));
            algebra.add_assign(&mut self.velocity[j][n], &change);
            self.flow[j][n] = flow;
            self.x[j][n] = response;
            self.nearest.extend(nearest.map(|(harmonic, size)| Nearest {
                order: n,
                unknown: j,
                harmonic,
                size,
            }));
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
        let x: Vec<_> = generating.into_iter().map(|x| vec![x]).collect();
        let velocity = x.iter().map(|x| vec![algebra.by_time(&x[0])]).collect();
        let evaluator = Evaluator::new(algebra, equation);
        let flow = (0..unknowns).map(|_| vec![algebra.zero()]).collect();
        let (sensitive, nearest, balance) = (Vec::new(), Vec::new(), None);
        let mut averaging =
            Self { algebra, evaluator, detuning, flow, x, velocity, sensitive, nearest, balance };
        averaging.assign(0);
        averaging.sensitive = averaging.linearise()?;
        averaging.evaluator = Evaluator::new(algebra, equation);
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
        // An order that was interrupted has provisional values.
        let finished = work.len() + 1;
        let Self { mut flow, mut x, mut nearest, balance, .. } = self;
        flow.iter_mut().chain(&mut x).for_each(|list| list.truncate(finished));
        nearest.retain(|near| near.order < finished);
        let mut parameter = balance.map_or_else(Vec::new, |balance| balance.values);
        parameter.truncate(finished - 1);
        let detuning = self.detuning.to_vec();
        Ok(SlowFlow { flow, solution: x, detuning, parameter, nearest, work })
    }

    /// Checks that order zero is x_j'' + nu_j^2 x_j + what depends on eta alone; the nodes whose order n
    /// depends on order n of an unknown.
    fn linearise(&mut self) -> Result<Vec<bool>, ExpandError> {
        let algebra = self.algebra;
        let roots = &self.evaluator.equation.roots;
        let mut sensitive = vec![false; self.evaluator.equation.nodes.len()];
        for (index, velocity) in (0..roots.len()).flat_map(|j| [(j, false), (j, true)]) {
            let variable = Node::unknown(index, velocity, None);
            let unit =
                |node: &Node<_>| (*node == variable).then(|| [algebra.one(), algebra.zero()]);
            let tangents = self.evaluator.tangents(&unit)?;
            for (flag, tangent) in sensitive.iter_mut().zip(&tangents) {
                *flag |= !algebra.is_zero(&tangent[0]);
            }
            for (j, root) in roots.iter().enumerate() {
                let expected = match j == index && !velocity {
                    true => algebra.frequency_squared(j),
                    false => algebra.zero(),
                };
                let gap = algebra.sub(&tangents[*root][0], &expected);
                if !algebra.may_vanish(&gap) {
                    return Err(ExpandError::NotTheFrequency { unknown: j });
                }
            }
        }
        Ok(sensitive)
    }

    /// Adds the responses to the forces at order zero.
    fn order_zero(&mut self) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        self.assign(0);
        for j in 0..self.x.len() {
            let force = self.right_side(j, 0)?;
            let phase = |source| ExpandError::Phase { order: 0, source };
            let Split { flow, response, .. } = algebra.split(j, &force).map_err(phase)?;
            if !algebra.may_vanish(&flow) {
                return Err(ExpandError::NotTheFrequency { unknown: j });
            }
            let rate = algebra.by_time(&response);
            algebra.add_assign(&mut self.velocity[j][0], &rate);
            algebra.add_assign(&mut self.x[j][0], &response);
        }
        self.assign(0);
        for unknown in 0..self.x.len() {
            if !algebra.may_vanish(&self.right_side(unknown, 0)?) {
                return Err(ExpandError::NotTheFrequency { unknown });
            }
        }
        Ok(())
    }

    /// Order n of D f for a real series f.
    fn rate_of_change(&self, f: &[A::Element], n: usize) -> A::Element {
        let algebra = self.algebra;
        let mut sum = f.get(n).map_or_else(|| algebra.zero(), |f| algebra.by_time(f));
        let mut slopes = Vec::new();
        let mut turns = Vec::new();
        for (k, f) in (1..=n).filter_map(|k| Some((k, f.get(n - k)?))) {
            for (j, flow) in self.flow.iter().enumerate() {
                if let Some(flow) = flow.get(k).filter(|flow| !algebra.is_zero(flow)) {
                    slopes.push((flow, algebra.by_amplitude(f, j)));
                }
            }
            for (l, sigmas) in self.detuning.iter().enumerate() {
                if let Some(sigma) = sigmas.get(k - 1) {
                    turns.push((sigma, algebra.by_force(f, l)));
                }
            }
        }
        let along = |list: &[(&A::Element, A::Element)]| {
            let pairs: Vec<_> = list.iter().map(|(rate, slope)| (*rate, slope)).collect();
            algebra.sum_of_products(&pairs)
        };
        algebra.add_assign(&mut sum, &algebra.twice_real(&along(&slopes)));
        algebra.add_assign(&mut sum, &along(&turns));
        sum
    }

    /// g_{j,n}, with the provisional values of order n.
    fn right_side(&mut self, j: usize, n: usize) -> Result<A::Element, ExpandError> {
        let root = self.evaluator.equation.roots[j];
        let force = self.evaluator.coefficient(root, n)?;
        let acceleration = self.rate_of_change(&self.velocity[j], n);
        Ok(self.algebra.neg(&self.algebra.add(&acceleration, &force)))
    }

    /// Hands order n of the unknowns and their rates to the evaluator.
    fn assign(&mut self, n: usize) {
        self.evaluator.forget_from(n, &self.sensitive);
        for j in 0..self.x.len() {
            self.evaluator.assign(&Node::unknown(j, false, None), n, self.x[j][n].clone());
            self.evaluator.assign(&Node::unknown(j, true, None), n, self.velocity[j][n].clone());
        }
    }
}
