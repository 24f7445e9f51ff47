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
//! order n costs O(n) products of constants and one division by L'(i nu); no function is differentiated. The
//! general scheme derives the same, slower, and is its judge in the tests.

use super::delayed::step_back;
use super::{Nearest, Resonant};
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::Scheme;
use lindstedt_algebra::{AmplitudeAlgebra, LinearPart, Ring, Split};
use rug::Rational;
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
    /// The last node of an equation up to an order; nothing where it is not linear with constant factors and sources off
    /// resonance.
    pub(super) fn of<A: AmplitudeAlgebra<Element = E>>(
        algebra: &A,
        equation: &Equation<A>,
        order: usize,
    ) -> Option<Self> {
        if equation.roots.len() != 1 || algebra.is_zero(&algebra.amplitude(0)) {
            return None;
        }
        let mut nodes: Vec<Self> = Vec::new();
        for node in &equation.nodes {
            let value = match node {
                Node::Constant(c) => Self::source(vec![c.clone()]),
                Node::Small => Self::source(vec![algebra.zero(), algebra.one()]),
                &Node::Forcing(index) => Self::source(vec![equation.forcing[index].clone()]),
                Node::Displacement => Self::unknown(algebra, (None, false)),
                Node::Velocity => Self::unknown(algebra, (None, true)),
                &Node::Unknown { index: 0, velocity, delay } => {
                    Self::unknown(algebra, (delay, velocity))
                }
                Node::Sum(terms) => {
                    let mut sum = Self::source(Vec::new());
                    for (q, term) in terms {
                        let q = [algebra.rational(q)];
                        sum.add(algebra, &nodes[*term].scaled(algebra, &q, order));
                    }
                    sum
                }
                &Node::Product(a, b) => nodes[a].times(algebra, &nodes[b], order)?,
                _ => return None,
            };
            nodes.push(value);
        }
        let last = nodes.pop()?;
        let off = |f: &E| algebra.is_off_resonance(0, f);
        last.source.iter().all(off).then_some(last)
    }

    fn source(source: Vec<E>) -> Self {
        Self { source, factors: BTreeMap::new() }
    }

    fn unknown<R: Ring<Element = E>>(ring: &R, unknown: Unknown) -> Self {
        let factors = BTreeMap::from([(unknown, vec![ring.one()])]);
        Self { source: Vec::new(), factors }
    }

    fn add<R: Ring<Element = E>>(&mut self, ring: &R, other: &Self) {
        add(ring, &mut self.source, &other.source);
        for (unknown, factor) in &other.factors {
            add(ring, self.factors.entry(*unknown).or_default(), factor);
        }
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

fn add<R: Ring>(ring: &R, sum: &mut Vec<R::Element>, list: &[R::Element]) {
    sum.resize_with(sum.len().max(list.len()), || ring.zero());
    sum.iter_mut().zip(list).for_each(|(a, b)| ring.add_assign(a, b));
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

/// The root and the response to the force, order by order.
pub(super) struct Linear<'a, A: AmplitudeAlgebra> {
    algebra: &'a A,
    linear: LinearPart<A::Element>,
    equation: Affine<A::Element>,
    /// lambda.
    root: Vec<A::Element>,
    /// e^(-i nu T) and G for every delay.
    delays: Vec<(A::Element, Vec<A::Element>)>,
    flow: Vec<A::Element>,
    solution: Vec<A::Element>,
    /// p.
    forced: Vec<A::Element>,
    nearest: Vec<Nearest>,
    /// Products formed so far.
    products: Cell<u64>,
}

impl<'a, A: AmplitudeAlgebra> Linear<'a, A> {
    /// From order zero of the general scheme.
    pub(super) fn start(start: &Resonant<'a, A>, equation: Affine<A::Element>) -> Option<Self> {
        let algebra = start.algebra;
        let amplitude = algebra.amplitude(0);
        let factor = |f: &A::Element| algebra.by_amplitude(f, 0);
        let delays = (0..algebra.delays())
            .map(|delay| Some((factor(&algebra.shift(&amplitude, delay)?), vec![algebra.one()])));
        let solution = start.x.first()?.clone();
        let free = algebra.twice_real(&amplitude);
        Some(Self {
            root: vec![factor(&algebra.by_time(&amplitude))],
            delays: delays.collect::<Option<_>>()?,
            linear: start.linear.first()?.clone(),
            equation,
            flow: start.flow.first()?.clone(),
            forced: solution.iter().map(|x| algebra.sub(x, &free)).collect(),
            solution,
            nearest: Vec::new(),
            products: Cell::new(0),
            algebra,
        })
    }

    /// f, x and the smallest divisors.
    pub(super) fn finish(self) -> (Vec<A::Element>, Vec<A::Element>, Vec<Nearest>) {
        (self.flow, self.solution, self.nearest)
    }

    /// sum_k a_k b_{n-k} over a range of k.
    fn convolution(
        &self,
        a: &[A::Element],
        b: &[A::Element],
        range: std::ops::RangeInclusive<usize>,
        n: usize,
    ) -> A::Element {
        let pairs: Vec<_> = range.filter_map(|k| Some((a.get(k)?, b.get(n - k)?))).collect();
        self.products.set(self.products.get() + pairs.len() as u64);
        self.algebra.sum_of_products(&pairs)
    }

    /// Order n of lambda^2 with lambda_n = 0, its products but the square once.
    fn square(&self, n: usize) -> A::Element {
        let twice = self.convolution(&self.root, &self.root, 1..=(n - 1) / 2, n);
        let mut sum = self.algebra.scale(&twice, &Rational::from(2));
        if n.is_multiple_of(2) {
            let square = self.convolution(&self.root, &self.root, n / 2..=n / 2, n);
            self.algebra.add_assign(&mut sum, &square);
        }
        sum
    }

    /// Order n of the factor of z that an unknown is.
    fn value(&self, (delay, velocity): Unknown, n: usize) -> A::Element {
        let one = [self.algebra.one()];
        let (turn, late) = match delay {
            Some(delay) => (&self.delays[delay].0, &self.delays[delay].1[..]),
            None => (&one[0], &one[..]),
        };
        let value = if velocity {
            self.convolution(&self.root, late, 0..=n, n)
        } else {
            late.get(n).cloned().unwrap_or_else(|| self.algebra.zero())
        };
        self.algebra.mul(turn, &value)
    }

    /// D_0 and the shift of an unknown applied to p_n.
    fn response(&self, (delay, velocity): Unknown, n: usize) -> Option<A::Element> {
        let p = self.forced.get(n)?;
        let p = if velocity { self.algebra.by_time(p) } else { p.clone() };
        delay.map_or(Some(p.clone()), |delay| self.algebra.shift(&p, delay))
    }

    /// G_n from lambda_1, ..., lambda_n as far as they are known.
    fn late(&self, delay: usize, n: usize) -> Option<A::Element> {
        let weighted = |k: usize| self.algebra.scale(&self.root[k], &Rational::from(k));
        let weighted: Vec<_> = (0..self.root.len()).map(weighted).collect();
        let sum = self.convolution(&weighted, &self.delays[delay].1, 1..=n, n);
        Some(self.algebra.mul(&sum, &step_back(self.algebra, delay, n)?))
    }

    /// Order n of what remains of the equation with lambda_n = p_n = 0: the factor of z, and a function of eta.
    fn rest(&self, n: usize) -> Option<[A::Element; 2]> {
        let algebra = self.algebra;
        let mut free = self.square(n);
        let mut forced = self.equation.source.get(n).cloned().unwrap_or_else(|| algebra.zero());
        for (&unknown, factors) in &self.equation.factors {
            for (k, factor) in factors.iter().enumerate().take(n + 1) {
                if algebra.is_zero(factor) {
                    continue;
                }
                let value = self.value(unknown, n - k);
                algebra.add_assign(&mut free, &algebra.mul(factor, &value));
                if k > 0 {
                    let value = self.response(unknown, n - k)?;
                    algebra.add_assign(&mut forced, &algebra.mul(&value, factor));
                }
            }
        }
        Some([free, forced])
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
            let late = self.late(delay, n).ok_or(broken.clone())?;
            self.delays[delay].1.push(late);
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
        for (delay, (_, late)) in self.delays.iter_mut().enumerate() {
            let step = step_back(algebra, delay, 1).ok_or(broken.clone())?;
            algebra.add_assign(&mut late[n], &algebra.mul(&root, &step));
        }
        self.root.push(root);
        self.flow.push(flow);
        self.solution.push(response.clone());
        self.forced.push(response);
        Ok(())
    }
}
