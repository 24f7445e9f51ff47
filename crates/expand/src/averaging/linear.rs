//! The linear case: a root of the characteristic equation, order by order.
//!
//! Where the equation is linear in x, x' and their delayed values, and a force does not multiply them, x =
//! Re(a e^(i psi)) + p(eta). On Re(z a e^(i psi)) the operator D is the product with
//!
//!   lambda = i omega_0 + sum eps^n (A_n/a + i B_n),
//!
//! and on p it is D_0, since D_n p = 0. So lambda is the root of lambda^2 + sum_j (b_j + c_j lambda) e^(-lambda T_j)
//! = 0 (b_j, c_j polynomials in eps, T_0 = 0) that begins with i omega_0. With delta = lambda - i omega_0 and
//! e^(-lambda T) = e^(-i omega_0 T) G, G = exp(-T delta),
//!
//!   n G_n = -T sum_{k=1}^n k lambda_k G_{n-k}:
//!
//! order n costs O(n) products of constants and one division by L'(i omega_0); no function is differentiated. The
//! general scheme derives the same, slower, and is its judge in the tests.

use super::complex::{Complex, Pair, factor, oscillation};
use super::{AveragedExpansion, Averaging, Constant, finished, step_back};
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{OrderWork, Scheme};
use lindstedt_algebra::{
    Averaged, AveragingAlgebra, FunctionAlgebra, LinearPart, RationalAlgebra, Ring,
};
use rug::Rational;
use std::cell::Cell;
use std::collections::BTreeMap;

/// A complex constant.
type Number<A> = Pair<Constant<A>>;

/// An unknown: its delay, and whether it is the velocity.
type Unknown = (Option<usize>, bool);

/// A node: polynomials in eps, of functions of eta and as the factor of every unknown.
pub(super) struct Affine<A: FunctionAlgebra> {
    source: Vec<A::Element>,
    factors: BTreeMap<Unknown, Vec<Constant<A>>>,
}

impl<A: AveragingAlgebra> Affine<A> {
    /// The last node of an equation up to an order; nothing where it is not linear with constant factors.
    pub(super) fn of(algebra: &A, equation: &Equation<A>, order: usize) -> Option<Self> {
        let mut nodes: Vec<Self> = Vec::new();
        for node in &equation.nodes {
            let value = match node {
                Node::Constant(c) => Self::source(vec![algebra.embed(c)]),
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
                        let q = [algebra.constants().rational(q)];
                        sum.add(algebra, &nodes[*term].scaled(algebra, &q, order));
                    }
                    sum
                }
                &Node::Product(a, b) => nodes[a].times(algebra, &nodes[b], order)?,
                _ => return None,
            };
            nodes.push(value);
        }
        nodes.pop()
    }

    fn source(source: Vec<A::Element>) -> Self {
        Self { source, factors: BTreeMap::new() }
    }

    fn unknown(algebra: &A, unknown: Unknown) -> Self {
        let factors = BTreeMap::from([(unknown, vec![algebra.constants().one()])]);
        Self { source: Vec::new(), factors }
    }

    fn add(&mut self, algebra: &A, other: &Self) {
        add(algebra, &mut self.source, &other.source);
        for (unknown, factor) in &other.factors {
            add(algebra.constants(), self.factors.entry(*unknown).or_default(), factor);
        }
    }

    fn scaled(&self, algebra: &A, q: &[Constant<A>], order: usize) -> Self {
        let by: Vec<_> = q.iter().map(|c| algebra.embed(c)).collect();
        let of = |(unknown, list): (&Unknown, &Vec<_>)| {
            (*unknown, product(algebra.constants(), q, list, order))
        };
        Self {
            source: product(algebra, &by, &self.source, order),
            factors: self.factors.iter().map(of).collect(),
        }
    }

    fn times(&self, algebra: &A, other: &Self, order: usize) -> Option<Self> {
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
pub(super) struct Linear<'a, A: AveragingAlgebra> {
    algebra: &'a A,
    complex: Complex<'a, A::Constants>,
    linear: LinearPart<Constant<A>>,
    equation: Affine<A>,
    /// lambda.
    root: Vec<Number<A>>,
    /// e^(-i omega_0 T) and G for every delay.
    delays: Vec<(Number<A>, Vec<Number<A>>)>,
    /// A, B and u.
    rates: [Vec<Constant<A>>; 2],
    solution: Vec<A::Element>,
    /// p.
    forced: Vec<A::Element>,
    /// Complex products formed so far.
    products: Cell<u64>,
}

impl<'a, A: AveragingAlgebra> Linear<'a, A> {
    /// From order zero of the general scheme.
    pub(super) fn start(start: Averaging<'a, A>, equation: Affine<A>) -> Option<Self> {
        let Averaging { algebra, linear, x, amplitude_rate, phase_rate, .. } = start;
        let cosine = algebra.by_amplitude(&algebra.generating_solution());
        let complex = Complex(algebra.constants());
        let delays = (0..algebra.delays()).map(|delay| {
            Some((factor(algebra, &algebra.shift(&cosine, delay)?), vec![complex.one()]))
        });
        let forced = x.iter().map(|x| algebra.sub(x, &algebra.generating_solution())).collect();
        Some(Self {
            root: vec![factor(algebra, &algebra.by_time(&cosine))],
            delays: delays.collect::<Option<_>>()?,
            algebra,
            complex,
            linear,
            equation,
            rates: [amplitude_rate, phase_rate],
            solution: x,
            forced,
            products: Cell::new(0),
        })
    }

    /// The expansion with the orders that are finished.
    pub(super) fn finish(self, work: Vec<OrderWork>) -> AveragedExpansion<A> {
        finished(self.linear, self.rates, self.solution, work)
    }

    /// sum_k a_k b_{n-k} over a range of k.
    fn convolution(
        &self,
        a: &[Number<A>],
        b: &[Number<A>],
        range: std::ops::RangeInclusive<usize>,
        n: usize,
    ) -> Number<A> {
        let pairs: Vec<_> = range.filter_map(|k| Some((a.get(k)?, b.get(n - k)?))).collect();
        self.products.set(self.products.get() + pairs.len() as u64);
        self.complex.sum_of_products(&pairs)
    }

    /// Order n of the factor of a e^(i psi) that an unknown is.
    fn value(&self, (delay, velocity): Unknown, n: usize) -> Number<A> {
        let one = [self.complex.one()];
        let (turn, late) = match delay {
            Some(delay) => (&self.delays[delay].0, &self.delays[delay].1[..]),
            None => (&one[0], &one[..]),
        };
        let value = if velocity {
            self.convolution(&self.root, late, 0..=n, n)
        } else {
            late.get(n).cloned().unwrap_or_else(|| self.complex.zero())
        };
        self.complex.mul(turn, &value)
    }

    /// D_0 and the shift of an unknown applied to p_n.
    fn response(&self, (delay, velocity): Unknown, n: usize) -> Option<A::Element> {
        let p = self.forced.get(n)?;
        let p = if velocity { self.algebra.by_time(p) } else { p.clone() };
        delay.map_or(Some(p.clone()), |delay| self.algebra.shift(&p, delay))
    }

    /// G_n from lambda_1, ..., lambda_n as far as they are known.
    fn late(&self, delay: usize, n: usize) -> Option<Number<A>> {
        let constants = self.complex.0;
        let weighted = |k: usize| {
            let weight = Rational::from(k);
            self.root[k].each_ref().map(|part| constants.scale(part, &weight))
        };
        let weighted: Vec<_> = (0..self.root.len()).map(weighted).collect();
        let sum = self.convolution(&weighted, &self.delays[delay].1, 1..=n, n);
        let step = step_back(self.algebra, delay, n)?;
        Some(sum.map(|part| constants.mul(&part, &step)))
    }

    /// Order n of what remains of the equation with lambda_n = p_n = 0: the factor of a e^(i psi), and a function of
    /// eta.
    fn rest(&self, n: usize) -> Option<(Number<A>, A::Element)> {
        let (algebra, zero) = (self.algebra, self.complex.0.zero());
        let mut free = self.convolution(&self.root, &self.root, 1..=n - 1, n);
        let mut forced = self.equation.source.get(n).cloned().unwrap_or_else(|| algebra.zero());
        for (&unknown, factors) in &self.equation.factors {
            for (k, factor) in factors.iter().enumerate().take(n + 1) {
                if self.complex.0.is_zero(factor) {
                    continue;
                }
                let value = self.value(unknown, n - k);
                let own = self.complex.mul(&[factor.clone(), zero.clone()], &value);
                self.complex.add_assign(&mut free, &own);
                if k > 0 {
                    let value = self.response(unknown, n - k)?;
                    algebra.add_assign(&mut forced, &algebra.scale_by(&value, factor));
                }
            }
        }
        Some((free, forced))
    }
}

impl<A: AveragingAlgebra> Scheme for Linear<'_, A> {
    fn products(&self) -> u64 {
        self.products.get()
    }

    fn terms(&self) -> usize {
        self.solution.last().map_or(0, |x| self.algebra.terms(x))
    }

    fn step(&mut self, n: usize) -> Result<(), ExpandError> {
        let (algebra, constants) = (self.algebra, self.complex.0);
        let broken = ExpandError::NotWeaklyNonlinear;
        for delay in 0..self.delays.len() {
            let late = self.late(delay, n).ok_or(broken.clone())?;
            self.delays[delay].1.push(late);
        }
        let (free, forced) = self.rest(n).ok_or(broken.clone())?;
        let f = algebra.neg(&algebra.add(&oscillation(algebra, &free), &forced));
        let averaged = algebra.average(&self.linear, &f);
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        let phase = |source| ExpandError::Phase { order: n, source };
        let Averaged { amplitude_rate, phase_rate, response } = averaged.map_err(phase)?;
        let growth = algebra.by_amplitude(&algebra.embed(&amplitude_rate));
        let root = [algebra.as_constant(&growth).ok_or(broken.clone())?, phase_rate.clone()];
        for (delay, (_, late)) in self.delays.iter_mut().enumerate() {
            let step = step_back(algebra, delay, 1).ok_or(broken.clone())?;
            let change = root.each_ref().map(|part| constants.mul(part, &step));
            self.complex.add_assign(&mut late[n], &change);
        }
        self.root.push(root);
        self.rates[0].push(amplitude_rate);
        self.rates[1].push(phase_rate);
        self.solution.push(response.clone());
        self.forced.push(response);
        Ok(())
    }
}
