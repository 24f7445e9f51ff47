//! How many primes prove a residual to vanish, and which denominators the next order has.
//!
//! From the denominators and norms of an expansion, order by order, follow those of everything that enters
//! the residual, through the same graph of operations ([`size`](crate::size)). If a residual vanishes modulo primes whose
//! product exceeds denominator times norm, and none of which divides the denominator, it vanishes.
//!
//! The same bounds, with x_n left out, say what denominators order n can have before it is known: those of
//! f_n, times the divisors 1 - k^2 of its harmonics. That is a guess only to the one who lifts:
//! nothing that is proved depends on it.

mod ahead;

pub use ahead::{Expected, FrequencyBound};

use crate::ExpandError;
use crate::bound::equation_numbers;
use crate::compile::{Equation, Node};
use crate::size::{Generators, List, Size, convolution, norm, sum};
use lindstedt_algebra::{PhaseAlgebra, Ring};
use rug::{Float, Integer, Rational};
use std::collections::VecDeque;

/// Orders whose surplus of the predicted over the true denominators is subtracted from the next one.
const REMEMBERED: usize = 4;

/// The numbers of one order of an expansion over Q.
#[derive(Clone, Debug)]
pub struct OrderNumbers {
    /// A common denominator of the Fourier coefficients of x_n.
    pub denominator: Integer,
    /// Their numerators c over it, with the harmonic k of each: cosines and sines.
    pub numerators: Vec<(usize, Integer)>,
    /// W_n.
    pub squared: Rational,
    /// omega_n: the series of omega^2 = W.
    pub frequency: Rational,
    /// T_n: the series of T omega = 1.
    pub period: Rational,
}

/// The bound of the proof, order by order.
#[derive(Clone)]
pub struct ResidualBound {
    nodes: Vec<Node<Rational>>,
    root: usize,
    stiffness: Rational,
    /// The order after the last fixes the last amplitude.
    limit_cycle: bool,
    largest: usize,
    generators: Generators,
    taken: Vec<Taken>,
    sizes: Sizes,
    /// The exponents expected of the next order, and the surplus of the last ones.
    expected: Vec<u32>,
    surplus: VecDeque<Vec<i64>>,
}

#[derive(Clone)]
struct Taken {
    denominator: Integer,
    /// sum |c|, sum k |c|, sum k^2 |c| over the denominator.
    norms: [Float; 3],
    /// W_n, omega_n, T_n.
    series: [Rational; 3],
}

#[derive(Clone, Default)]
struct Sizes {
    /// x, x' and x'' with respect to the phase.
    functions: [List; 3],
    /// W, omega and T.
    series: [List; 3],
    nodes: Vec<List>,
    stiffness: Option<Size>,
    inverse_stiffness: Option<Size>,
    unit: Option<Size>,
}

impl ResidualBound {
    /// Of x'' + F = 0 with the linear stiffness kappa; `largest` is the highest harmonic of the expansion,
    /// and `limit_cycle` whether the amplitude of each order follows from the next one.
    ///
    /// # Errors
    /// [`ExpandError::UnsupportedTerm`] where the equation is not polynomial.
    pub fn new<A>(
        equation: &Equation<A>,
        stiffness: &Rational,
        largest: usize,
        limit_cycle: bool,
    ) -> Result<Self, ExpandError>
    where
        A: PhaseAlgebra,
        A::Constants: Ring<Element = Rational>,
    {
        let polynomial = |node: &Node<Rational>| {
            use Node::{Constant, Displacement, Product, Small, Sum, Velocity};
            matches!(node, Constant(_) | Small | Displacement | Velocity | Sum(_) | Product(..))
        };
        if !equation.nodes.iter().all(polynomial) {
            return Err(ExpandError::UnsupportedTerm {
                term: "a term that is not polynomial".into(),
            });
        }
        let mut bound = Self {
            nodes: equation.nodes.clone(),
            root: equation.root(),
            stiffness: stiffness.clone(),
            limit_cycle,
            largest,
            generators: Generators::new(2, std::iter::empty()),
            taken: Vec::new(),
            sizes: Sizes::default(),
            expected: Vec::new(),
            surplus: VecDeque::new(),
        };
        bound.rebuild(&[]);
        Ok(bound)
    }

    /// New generators for the numbers of the equation, those taken so far and some more, and everything anew.
    fn rebuild(&mut self, more: &[Rational]) {
        let numbers = equation_numbers(&self.nodes);
        let own = [&self.stiffness].into_iter().chain(&numbers).chain(more);
        let mut denominators: Vec<Integer> = own.map(|q| q.denom().clone()).collect();
        denominators.push(self.stiffness.numer().clone().abs());
        for taken in &self.taken {
            denominators.push(taken.denominator.clone());
            denominators.extend(taken.series.iter().map(|q| q.denom().clone()));
        }
        self.generators = Generators::new(self.largest + 1, denominators.iter());
        self.surplus.clear();
        self.expected.clear();
        let number = |q: &Rational| self.generators.number(q);
        self.sizes = Sizes {
            nodes: vec![Vec::new(); self.nodes.len()],
            stiffness: number(&self.stiffness),
            inverse_stiffness: number(&Rational::from(self.stiffness.recip_ref())),
            unit: number(&Rational::from(1)),
            ..Sizes::default()
        };
        for n in 0..self.taken.len() {
            self.measure(n);
        }
    }

    /// The sizes of order n, which is taken, and of the nodes there. Whether the generators know them.
    fn measure(&mut self, n: usize) -> bool {
        let taken = &self.taken[n];
        let Some(mut exponents) = self.generators.exponents(&taken.denominator) else {
            return false;
        };
        // cos k psi = (z^k + z^-k)/2 adds a factor 2 to the denominator.
        exponents[0] += 1;
        for (list, norm) in self.sizes.functions.iter_mut().zip(&taken.norms) {
            let size = Size { exponents: exponents.clone(), norm: norm.clone() };
            list.push((!norm.is_zero()).then_some(size));
        }
        for (list, q) in self.sizes.series.iter_mut().zip(&taken.series) {
            let size = self.generators.number(q);
            if size.is_none() && !q.is_zero() {
                return false;
            }
            list.push(size);
        }
        self.evaluate(n);
        true
    }

    /// Coefficient n of every node from what is known of x.
    fn evaluate(&mut self, n: usize) {
        let sizes = &mut self.sizes;
        let number = |q: &Rational| self.generators.number(q);
        for (id, node) in self.nodes.iter().enumerate() {
            let nodes = &sizes.nodes;
            let size = match node {
                Node::Constant(c) if n == 0 => number(c),
                Node::Small if n == 1 => sizes.unit.clone(),
                Node::Displacement => sizes.functions[0].get(n).cloned().flatten(),
                Node::Velocity => convolution(&sizes.series[1], &sizes.functions[1], 0..=n, n),
                Node::Sum(terms) => sum(terms
                    .iter()
                    .map(|(q, term)| Some(nodes[*term].get(n)?.as_ref()?.times(&number(q)?)))),
                &Node::Product(a, b) => convolution(&nodes[a], &nodes[b], 0..=n, n),
                _ => None,
            };
            sizes.nodes[id].truncate(n);
            sizes.nodes[id].push(size);
        }
    }

    /// kappa sum_k W_k x''_(n-k) + F_n over a range of k, from what is known.
    fn residual(&self, range: std::ops::RangeInclusive<usize>, n: usize) -> Option<Size> {
        let sizes = &self.sizes;
        let inertia = convolution(&sizes.series[0], &sizes.functions[2], range, n);
        let inertia = inertia.zip(sizes.stiffness.as_ref()).map(|(a, b)| a.times(b));
        sum([inertia, sizes.nodes[self.root].get(n).cloned().flatten()])
    }

    /// f_n of x_n'' + x_n = f_n - W_n x_0'', from the orders below.
    fn right_side(&mut self, n: usize) -> Option<Size> {
        self.evaluate(n);
        let residual = self.residual(1..=n.saturating_sub(1), n);
        residual.zip(self.sizes.inverse_stiffness.as_ref()).map(|(a, b)| a.times(b))
    }

    /// A common denominator that the numbers of the next order probably have: what the recurrence allows, less
    /// what it allowed too much in each of the last orders. `harmonics` are those of x_n.
    pub fn expected(&mut self, harmonics: &[usize]) -> Integer {
        let n = self.taken.len();
        let mut exponents =
            self.right_side(n).map_or(vec![0; self.generators.len()], |f| f.exponents);
        for (index, exponent) in exponents.iter_mut().enumerate() {
            let divisors =
                harmonics.iter().filter(|k| **k != 1).map(|&k| (k * k).abs_diff(1) as u64);
            let valuations =
                divisors.filter(|d| *d > 0).map(|d| self.generators.valuation(index, d));
            *exponent += valuations.max().unwrap_or(0);
        }
        if self.limit_cycle {
            // The amplitude of order n comes with order n + 1.
            for list in &mut self.sizes.functions {
                list.push(Some(Size {
                    exponents: exponents.clone(),
                    norm: Float::with_val(64, 1),
                }));
            }
            self.evaluate(n);
            if let Some(next) = self.right_side(n + 1) {
                exponents.iter_mut().zip(next.exponents).for_each(|(e, f)| *e = (*e).max(f));
            }
            self.sizes.functions.iter_mut().for_each(|list| list.truncate(n));
        }
        let surplus = |index: usize| self.surplus.iter().map(|list| list[index]).min().unwrap_or(0);
        let less =
            |(index, e): (usize, &u32)| u32::try_from(i64::from(*e) - surplus(index)).unwrap_or(0);
        let expected: Vec<u32> = exponents.iter().enumerate().map(less).collect();
        self.expected = exponents;
        self.generators.product(&expected)
    }

    /// Takes the numbers of the next order n and returns more bits than any numerator has in: the residual
    /// of order n; omega^2 - W and omega T - 1 there; the normalisation; and, for a limit cycle, the secular term of order
    /// n + 1 with x_(n+1) = W_(n+1) = 0. So each of them vanishes if it does modulo primes, none of which
    /// divides a denominator, whose product has as many bits.
    pub fn take(&mut self, numbers: &OrderNumbers) -> u64 {
        let n = self.taken.len();
        let mut norms = [const { Integer::new() }; 3];
        for (k, c) in &numbers.numerators {
            let mut weighted = Integer::from(c.abs_ref());
            for sum in &mut norms {
                *sum += &weighted;
                weighted *= *k as u32;
            }
        }
        self.taken.push(Taken {
            denominator: numbers.denominator.clone(),
            norms: norms.map(|sum| norm(&sum, &numbers.denominator)),
            series: [&numbers.squared, &numbers.frequency, &numbers.period].map(Clone::clone),
        });
        let expected = std::mem::take(&mut self.expected);
        if !self.measure(n) {
            self.rebuild(&[]);
        } else if let (false, Some(Some(x))) = (expected.is_empty(), self.sizes.functions[0].get(n))
        {
            let surplus = expected.iter().zip(&x.exponents).enumerate();
            let of_z = |index: usize| i64::from(index == 0);
            let surplus = surplus.map(|(i, (e, x))| i64::from(*e) - i64::from(*x) + of_z(i));
            self.surplus.push_back(surplus.collect());
            if self.surplus.len() > REMEMBERED {
                self.surplus.pop_front();
            }
        }
        self.bits(n)
    }

    /// Forgets the last order taken.
    pub fn give_back(&mut self) {
        self.taken.pop();
        let n = self.taken.len();
        let sizes = &mut self.sizes;
        let lists = sizes.functions.iter_mut().chain(&mut sizes.series);
        lists.chain(&mut sizes.nodes).for_each(|list| list.truncate(n));
        self.surplus.pop_back();
    }

    fn bits(&mut self, n: usize) -> u64 {
        let own = self.sizes.functions[..2].iter().map(|list| list[n].clone());
        let normalisation = sum(own);
        let residual = self.residual(0..=n, n);
        let [squared, frequency, period] = &self.sizes.series;
        let square = convolution(frequency, frequency, 0..=n, n);
        let square = sum([square, squared[n].clone()]);
        let inverse = sum([convolution(frequency, period, 0..=n, n), self.sizes.unit.clone()]);
        let next = if self.limit_cycle {
            self.evaluate(n + 1);
            self.residual(1..=n, n + 1)
        } else {
            None
        };
        let sizes = [normalisation, residual, square, inverse, next];
        sizes.iter().flatten().map(|size| self.generators.bits(size)).max().unwrap_or(0)
    }
}
