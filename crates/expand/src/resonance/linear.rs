//! The linear case: a root of the characteristic equation, order by order.
//!
//! Where one equation is linear in x, x' and their delayed values, and forces, off resonance, do not multiply them, x = z
//! + zbar + p(eta) with f_n = h_n z. On z the operator D is the product with
//!
//!   lambda = i nu + sum eps^n h_n,
//!
//! and on p it is D_0, since D_n p = 0. So lambda is the root of lambda^2 + sum_j (b_j + c_j lambda) e^(-lambda T_j)
//! = 0 (b_j, c_j polynomials in eps, T_0 = 0) that begins with i nu. With delta = lambda - i nu and
//! e^(-lambda T) = e^(-i nu T) G, G = exp(-T delta),
//!
//!   n G_n = -T sum_{k=1}^n k lambda_k G_{n-k}:
//!
//! order n costs O(n) products of constants and one division by L'(i nu); no function is differentiated. Where delays are
//! in weak terms alone, G_n counts from order n + 1 on and is formed then. The
//! general scheme derives the same, slower, and is its judge in the tests.

use super::delayed::step_back;
use super::{Nearest, SlowFlow};
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{Scheme, run};
use crate::expansion::OrderWork;
use lindstedt_algebra::{AmplitudeAlgebra, LinearPart, Ring, Split};
use rug::Rational;
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::BTreeMap;

/// An unknown: its delay, and whether it is the velocity.
type Unknown = (Option<usize>, bool);

/// A node: polynomials in eps, of functions of eta and as the factor of every unknown.
pub(super) struct Affine<E> {
    source: Vec<E>,
    factors: BTreeMap<Unknown, Vec<E>>,
}

impl<E: Clone> Affine<E> {
    /// An equation up to an order; nothing where it is not linear with constant factors and sources off resonance.
    pub(super) fn of<A: AmplitudeAlgebra<Element = E>>(
        algebra: &A,
        equation: &Equation<A>,
        order: usize,
    ) -> Option<Self> {
        let read = Self::read(algebra, equation, order)?;
        let off = |f: &E| algebra.is_off_resonance(0, f);
        read.source.iter().all(off).then_some(read)
    }

    /// The same with sources of any frequency. What is multiplied with zero up to that order need not be linear.
    pub(super) fn read<A: AmplitudeAlgebra<Element = E>>(
        algebra: &A,
        equation: &Equation<A>,
        order: usize,
    ) -> Option<Self> {
        if equation.roots.len() != 1 || algebra.is_zero(&algebra.amplitude(0)) {
            return None;
        }
        let mut nodes: Vec<Option<Self>> = Vec::new();
        for node in &equation.nodes {
            let value = match node {
                Node::Constant(c) => Some(Self::source(vec![c.clone()])),
                Node::Small if order == 0 => Some(Self::source(Vec::new())),
                Node::Small => Some(Self::source(vec![algebra.zero(), algebra.one()])),
                &Node::Forcing(index) => Some(Self::source(vec![equation.forcing[index].clone()])),
                Node::Displacement => Some(Self::unknown(algebra, (None, false))),
                Node::Velocity => Some(Self::unknown(algebra, (None, true))),
                &Node::Unknown { index: 0, velocity, delay } => {
                    Some(Self::unknown(algebra, (delay, velocity)))
                }
                Node::Sum(terms) => terms.iter().try_fold(Self::source(Vec::new()), |sum, term| {
                    let (q, term) = (algebra.rational(&term.0), nodes[term.1].as_ref()?);
                    Some(sum.plus(algebra, term.scaled(algebra, &[q], order)))
                }),
                &Node::Product(a, b) => match (&nodes[a], &nodes[b]) {
                    (Some(a), Some(b)) => a.times(algebra, b, order),
                    (Some(zero), None) | (None, Some(zero)) if zero.vanishes(algebra) => {
                        Some(Self::source(Vec::new()))
                    }
                    _ => None,
                },
                _ => None,
            };
            nodes.push(value);
        }
        nodes.swap_remove(equation.root())
    }

    /// The factors of order zero.
    pub(super) fn linear_part<R: Ring<Element = E>>(
        &self,
        ring: &R,
        delays: usize,
    ) -> LinearPart<E> {
        let factor = |delay, velocity| {
            let factor = self.factors.get(&(delay, velocity)).and_then(|list| list.first());
            factor.cloned().unwrap_or_else(|| ring.zero())
        };
        let delayed = |delay| (factor(Some(delay), false), factor(Some(delay), true));
        LinearPart {
            stiffness: factor(None, false),
            damping: factor(None, true),
            delayed: (0..delays).map(delayed).collect(),
        }
    }

    fn vanishes<R: Ring<Element = E>>(&self, ring: &R) -> bool {
        self.factors.values().chain([&self.source]).flatten().all(|c| ring.is_zero(c))
    }

    fn source(source: Vec<E>) -> Self {
        Self { source, factors: BTreeMap::new() }
    }

    fn unknown<R: Ring<Element = E>>(ring: &R, unknown: Unknown) -> Self {
        let factors = BTreeMap::from([(unknown, vec![ring.one()])]);
        Self { source: Vec::new(), factors }
    }

    fn plus<R: Ring<Element = E>>(mut self, ring: &R, other: Self) -> Self {
        add(ring, &mut self.source, other.source);
        for (unknown, factor) in other.factors {
            add(ring, self.factors.entry(unknown).or_default(), factor);
        }
        self
    }

    fn scaled<R: Ring<Element = E>>(&self, ring: &R, q: &[E], order: usize) -> Self {
        let of = |(unknown, list): (&Unknown, &Vec<_>)| (*unknown, product(ring, q, list, order));
        Self {
            source: product(ring, q, &self.source, order),
            factors: self.factors.iter().map(of).collect(),
        }
    }

    fn times<A: AmplitudeAlgebra<Element = E>>(
        &self,
        algebra: &A,
        other: &Self,
        order: usize,
    ) -> Option<Self> {
        if self.factors.is_empty() && other.factors.is_empty() {
            let source = product(algebra, &self.source, &other.source, order);
            return Some(Self::source(source));
        }
        let (numbers, linear) = if self.factors.is_empty() { (self, other) } else { (other, self) };
        if !numbers.factors.is_empty() {
            return None;
        }
        let constant = |f| algebra.as_constant(f);
        let numbers: Vec<_> = numbers.source.iter().map(constant).collect::<Option<_>>()?;
        Some(linear.scaled(algebra, &numbers, order))
    }
}

fn add<R: Ring>(ring: &R, sum: &mut Vec<R::Element>, mut list: Vec<R::Element>) {
    if sum.len() < list.len() {
        std::mem::swap(sum, &mut list);
    }
    sum.iter_mut().zip(&list).for_each(|(a, b)| ring.add_assign(a, b));
}

fn product<R: Ring>(ring: &R, a: &[R::Element], b: &[R::Element], order: usize) -> Vec<R::Element> {
    let mut product = Vec::new();
    for (k, x) in a.iter().enumerate().filter(|(_, x)| !ring.is_zero(x)) {
        for (j, y) in b.iter().enumerate().take((order + 1).saturating_sub(k)) {
            let length = product.len().max(j + k + 1);
            product.resize_with(length, || ring.zero());
            ring.add_assign(&mut product[j + k], &ring.mul(x, y));
        }
    }
    product
}

impl<E> Affine<E> {
    /// The lowest order of the factors of x(t - T) and its rate.
    pub(super) fn first<R: Ring<Element = E>>(&self, ring: &R, delay: usize) -> Option<usize> {
        let late = self.factors.iter().filter(|((own, _), _)| *own == Some(delay));
        late.filter_map(|(_, list)| list.iter().position(|c| !ring.is_zero(c))).min()
    }
}

/// The root and the response to the force, order by order.
pub(super) struct Linear<'a, A: AmplitudeAlgebra> {
    algebra: &'a A,
    linear: LinearPart<A::Element>,
    equation: Affine<A::Element>,
    /// lambda_n and n lambda_n.
    root: Vec<A::Element>,
    weighted: Vec<A::Element>,
    /// 1, the displacement.
    one: [A::Element; 1],
    /// Of every delay.
    delays: Vec<Delayed<A::Element>>,
    flow: Vec<A::Element>,
    solution: Vec<A::Element>,
    /// p.
    forced: Vec<A::Element>,
    nearest: Vec<Nearest>,
    /// Products formed so far.
    products: Cell<u64>,
}

struct Delayed<E> {
    /// e^(-i nu T).
    turn: E,
    /// G; of a delay in weak terms up to the order before.
    late: Vec<E>,
    /// Whether it enters at order 0.
    strong: bool,
}

/// A product of a sum.
type Product<'a, E> = (E, Cow<'a, E>);

impl<'a, A: AmplitudeAlgebra> Linear<'a, A> {
    /// Order zero: z of the frequency nu, and the response to the force.
    pub(super) fn start(algebra: &'a A, equation: Affine<A::Element>) -> Result<Self, ExpandError> {
        let other = ExpandError::NotTheFrequency { unknown: 0 };
        let amplitude = algebra.amplitude(0);
        let factor = |f: &A::Element| algebra.by_amplitude(f, 0);
        let delays = (0..algebra.delays()).map(|delay| {
            let turn = factor(&algebra.shift(&amplitude, delay)?);
            let strong = equation.first(algebra, delay) == Some(0);
            Some(Delayed { turn, late: vec![algebra.one()], strong })
        });
        let delays = delays.collect::<Option<_>>().ok_or(ExpandError::NotWeaklyNonlinear)?;
        let mut start = Self {
            root: vec![factor(&algebra.by_time(&amplitude))],
            weighted: vec![algebra.zero()],
            one: [algebra.one()],
            delays,
            linear: equation.linear_part(algebra, algebra.delays()),
            equation,
            flow: vec![algebra.zero()],
            forced: Vec::new(),
            solution: Vec::new(),
            nearest: Vec::new(),
            products: Cell::new(0),
            algebra,
        };
        // L(i nu) = 0; nothing responds yet.
        let [free, force] = start.rest(0).ok_or(ExpandError::NotWeaklyNonlinear)?;
        if !algebra.may_vanish(&free) {
            return Err(other);
        }
        let phase = |source| ExpandError::Phase { order: 0, source };
        let split = algebra.split(0, &start.linear, &algebra.neg(&force)).map_err(phase)?;
        let mut left = algebra.add(&force, &algebra.by_time(&algebra.by_time(&split.response)));
        start.solution = vec![algebra.add(&algebra.twice_real(&amplitude), &split.response)];
        start.forced = vec![split.response];
        for (&unknown, factors) in &start.equation.factors {
            if let Some(factor) = factors.first().filter(|factor| !algebra.is_zero(factor)) {
                let value = start.response(unknown, 0).ok_or(ExpandError::NotWeaklyNonlinear)?;
                algebra.add_assign(&mut left, &algebra.mul(&value, factor));
            }
        }
        if algebra.may_vanish(&left) { Ok(start) } else { Err(other) }
    }

    /// Derives the orders.
    pub(super) fn finish(
        mut self,
        order: usize,
        observer: &mut dyn FnMut(&OrderWork) -> bool,
    ) -> Result<SlowFlow<A::Element>, ExpandError> {
        let work = run(&mut self, 1..=order, observer)?;
        let (flow, solution) = (vec![self.flow], vec![self.solution]);
        let (parameter, turned) = (Vec::new(), Vec::new());
        let detuning = Vec::new();
        Ok(SlowFlow { flow, solution, detuning, parameter, turned, nearest: self.nearest, work })
    }

    /// sum_k a_k b_{n-k} as far as both are known.
    fn convolution(&self, a: &[A::Element], b: &[A::Element], n: usize) -> A::Element {
        let pair = |(k, a)| Some((a, b.get(n - k)?));
        let pairs: Vec<_> = a.iter().take(n + 1).enumerate().filter_map(pair).collect();
        self.products.set(self.products.get() + pairs.len() as u64);
        self.algebra.sum_of_products(&pairs)
    }

    /// Order n of lambda^2 with lambda_n = 0, its products but the square once.
    fn square(&self, n: usize) -> Vec<Product<'_, A::Element>> {
        let (root, two) = (&self.root, Rational::from(2));
        let twice = |k: usize| (self.algebra.scale(&root[k], &two), Cow::Borrowed(&root[n - k]));
        let middle =
            n.is_multiple_of(2).then(|| (root[n / 2].clone(), Cow::Borrowed(&root[n / 2])));
        (1..n.div_ceil(2)).map(twice).chain(middle).collect()
    }

    /// Order n of the factor of z that an unknown is, times a constant.
    fn value(
        &self,
        (delay, velocity): Unknown,
        factor: &A::Element,
        n: usize,
    ) -> Option<Product<'_, A::Element>> {
        let Some(delay) = delay else {
            let value = if velocity { self.root.get(n) } else { self.one.get(n) };
            return Some((factor.clone(), Cow::Borrowed(value?)));
        };
        let Delayed { turn, late, .. } = &self.delays[delay];
        let value = match velocity {
            true => Cow::Owned(self.convolution(&self.root, late, n)),
            false => Cow::Borrowed(late.get(n)?),
        };
        Some((self.algebra.mul(factor, turn), value))
    }

    /// D_0 and the shift of an unknown applied to p_n.
    fn response(&self, (delay, velocity): Unknown, n: usize) -> Option<A::Element> {
        let p = self.forced.get(n)?;
        let p = if velocity { self.algebra.by_time(p) } else { p.clone() };
        delay.map_or(Some(p.clone()), |delay| self.algebra.shift(&p, delay))
    }

    /// G_n from lambda_1, ..., lambda_n as far as they are known.
    fn late(&self, delay: usize, n: usize) -> Option<A::Element> {
        let sum = self.convolution(&self.weighted, &self.delays[delay].late, n);
        Some(self.algebra.mul(&sum, &step_back(self.algebra, delay, n)?))
    }

    /// Order n of what remains of the equation with lambda_n = p_n = 0: the factor of z, and a function of eta.
    fn rest(&self, n: usize) -> Option<[A::Element; 2]> {
        let algebra = self.algebra;
        let mut free = self.square(n);
        let mut forced = self.equation.source.get(n).cloned().unwrap_or_else(|| algebra.zero());
        for (&unknown, factors) in &self.equation.factors {
            let known = factors.iter().enumerate().take(n + 1);
            for (k, factor) in known.filter(|(_, factor)| !algebra.is_zero(factor)) {
                free.extend(self.value(unknown, factor, n - k));
                if k > 0 {
                    let value = self.response(unknown, n - k)?;
                    algebra.add_assign(&mut forced, &algebra.mul(&value, factor));
                }
            }
        }
        self.products.set(self.products.get() + free.len() as u64);
        let free: Vec<_> = free.iter().map(|(a, b)| (a, &**b)).collect();
        Some([algebra.sum_of_products(&free), forced])
    }
}

impl<A: AmplitudeAlgebra> Scheme for Linear<'_, A> {
    fn products(&self) -> u64 {
        self.products.get()
    }

    fn terms(&self) -> usize {
        self.solution.last().map_or(0, |x| self.algebra.terms(x))
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        let broken = ExpandError::NotWeaklyNonlinear;
        for delay in 0..self.delays.len() {
            let order = if self.delays[delay].strong { n } else { n - 1 };
            if order > 0 {
                let late = self.late(delay, order).ok_or(broken.clone())?;
                self.delays[delay].late.push(late);
            }
        }
        let [free, forced] = self.rest(n).ok_or(broken.clone())?;
        let free = algebra.twice_real(&algebra.mul(&free, &algebra.amplitude(0)));
        let split = algebra.split(0, &self.linear, &algebra.neg(&algebra.add(&free, &forced)));
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        let phase = |source| ExpandError::Phase { order: n, source };
        let Split { flow, response, nearest } = split.map_err(phase)?;
        let near = |(harmonic, size)| Nearest { order: n, unknown: 0, harmonic, size };
        self.nearest.extend(nearest.map(near));
        let root = algebra.by_amplitude(&flow, 0);
        for (delay, own) in self.delays.iter_mut().enumerate().filter(|(_, own)| own.strong) {
            let step = step_back(algebra, delay, 1).ok_or(broken.clone())?;
            algebra.add_assign(&mut own.late[n], &algebra.mul(&root, &step));
        }
        self.weighted.push(algebra.scale(&root, &Rational::from(n)));
        self.root.push(root);
        self.flow.push(flow);
        self.solution.push(response.clone());
        self.forced.push(response);
        Ok(())
    }
}
