//! The exact rule: sinc indefinite integration at double-exponential nodes.

use super::grid::{Grid, node, sine_integrals};
use super::packed::Packed;
use super::{COS_EVEN, COS_ODD, Particular, SIN_EVEN};
use lindstedt_algebra::Stop;
use lindstedt_coeff::floats::Reals;
use rug::{Float, Rational};

/// Above so many bits sums of products go through long integers.
const LONG: u32 = 64;

/// Weights and values of Si.
#[derive(Clone, Debug)]
pub(super) struct Sinc<E> {
    nodes: usize,
    cos: Vec<E>,
    sin: Vec<E>,
    /// h dpsi/dt.
    weights: Vec<E>,
    /// Si(pi m)/pi for m = -(K-1)..=2K-1, and the same backwards.
    forward: Vec<E>,
    backward: Vec<E>,
    /// The same table for long numbers.
    packed: Option<Packed>,
}

impl<E: Clone + PartialEq + std::fmt::Debug + Send + Sync> Sinc<E> {
    /// The rule, and cos psi and sin psi at its nodes. Once `stop` says so, which is asked for every node, what is
    /// left of the tables is zero.
    pub(super) fn new<R: Reals<Element = E>>(
        reals: &R,
        grid: Grid,
        stop: &Stop,
    ) -> (Self, [Vec<E>; 2]) {
        let bits = reals.bits();
        let (mut cos, mut sin, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..grid.nodes {
            let node = (!stop.asked()).then(|| node(k as f64 * grid.step, bits));
            let [c, s, slope] = node.unwrap_or_else(|| [(); 3].map(|()| Float::new(2)));
            cos.push(reals.nearest(&c));
            sin.push(reals.nearest(&s));
            weights.push(reals.nearest(&(slope * grid.step)));
        }
        let table = sine_integrals(2 * grid.nodes, bits, stop);
        let positive: Vec<_> = table.iter().map(|x| reals.nearest(x)).collect();
        let negative = positive.iter().take(grid.nodes).skip(1).rev().map(|x| reals.neg(x));
        let forward: Vec<_> = negative.chain(positive.iter().cloned()).collect();
        let backward = forward.iter().rev().cloned().collect();
        let packed = (bits > LONG).then(|| {
            let table: Vec<Float> = forward.iter().map(|s| reals.to_float(s)).collect();
            Packed::new(&table, grid.nodes, bits)
        });
        let nodes = [cos.clone(), sin.clone()];
        (Self { nodes: grid.nodes, cos, sin, weights, forward, backward, packed }, nodes)
    }

    fn weighted<R: Reals<Element = E>>(reals: &R, f: &[E], g: &[E]) -> Vec<E> {
        f.iter().zip(g).map(|(x, y)| reals.mul(x, y)).collect()
    }

    /// The integral of f times cos psi or sin psi over the quarter period, for an even product.
    pub(super) fn quarter<R: Reals<Element = E>>(&self, reals: &R, f: &[E], cosine: bool) -> E {
        let basis = if cosine { &self.cos } else { &self.sin };
        let integrand = Self::weighted(reals, &Self::weighted(reals, f, basis), &self.weights);
        let mut values = integrand.iter();
        let first = values.next().map(|first| reals.scale(first, &Rational::from((1, 2))));
        let mut sum = first.unwrap_or_else(|| reals.zero());
        for value in values {
            reals.add_assign(&mut sum, value);
        }
        sum
    }

    /// int_0^infinity g dt h^-1 for odd g: the limit S -> 1/2 of [`Self::cumulative`],
    /// 2 sum_j g_j S(j).
    fn odd_total<R: Reals<Element = E>>(&self, reals: &R, g: &[E]) -> E {
        let table = self.forward.get(self.nodes - 1..).unwrap_or_default();
        let sum = reals.dot(g, table);
        reals.add(&sum, &sum)
    }

    /// int_0^(kh) g dt h^-1 for k = 0, 1, ..., with S(m) = Si(pi m)/pi: for even g
    ///
    ///   g_0 S(k) + sum_(j>=1) g_j (S(k - j) + S(k + j)),
    ///
    /// for odd g, g_0 = 0: sum_(j>=1) g_j (S(k - j) - S(k + j) + 2 S(j)).
    fn cumulative<R: Reals<Element = E>>(&self, reals: &R, g: &[E], even: bool) -> Vec<E> {
        let nodes = self.nodes;
        let Some((first, tail)) = g.split_first() else { return Vec::new() };
        // C(n) = sum_j g_j S(j + n); S is odd. forward[nodes - 1 + m] = S(m),
        // backward[2 nodes - 1 - m] = S(m).
        let dot = |list: &[E], from: usize| reals.dot(tail, list.get(from..).unwrap_or_default());
        let base = dot(&self.forward, nodes);
        let correlation = self.packed.as_ref().map(|packed| {
            let g: Vec<Float> = g.iter().map(|g| reals.to_float(g)).collect();
            let list = packed.correlation(&g);
            list.iter().map(|c| reals.nearest(c)).collect::<Vec<E>>()
        });
        let known = |index: usize| correlation.as_ref().and_then(|list| list.get(index));
        let value = |k: usize| {
            let (below, above) = match (known(nodes - 1 - k), known(nodes - 1 + k)) {
                (Some(below), Some(above)) => (reals.neg(below), above.clone()),
                _ => (dot(&self.backward, 2 * nodes - k), dot(&self.forward, nodes + k)),
            };
            let (sum, rest) = if even {
                let s = self.forward.get(nodes - 1 + k);
                let s = s.map_or_else(|| reals.zero(), |s| reals.mul(s, first));
                (reals.add(&below, &above), s)
            } else {
                (reals.sub(&below, &above), reals.add(&base, &base))
            };
            reals.add(&sum, &rest)
        };
        let mut values: Vec<E> = (0..nodes).map(value).collect();
        // Exactly zero, up to the rounding of an antisymmetric sum.
        if let Some(first) = values.first_mut() {
            *first = reals.zero();
        }
        values
    }

    /// u'' + u = f for a part f without resonance, by variation of constants.
    pub(super) fn particular<R: Reals<Element = E>>(
        &self,
        reals: &R,
        part: usize,
        f: &[E],
    ) -> Particular<E> {
        let weighted = Self::weighted(reals, f, &self.weights);
        let by_cos = Self::weighted(reals, &weighted, &self.cos);
        let by_sin = Self::weighted(reals, &weighted, &self.sin);
        let even = part == COS_EVEN || part == COS_ODD;
        let (mut cos_integral, mut sin_integral) = if self.packed.is_some() {
            rayon::join(
                || self.cumulative(reals, &by_cos, even),
                || self.cumulative(reals, &by_sin, !even),
            )
        } else {
            (self.cumulative(reals, &by_cos, even), self.cumulative(reals, &by_sin, !even))
        };
        let shift = |list: &mut Vec<E>, by: &E| {
            let by = reals.neg(by);
            list.iter_mut().for_each(|value| reals.add_assign(value, &by));
        };
        // The class asks u'(pi/2) = 0 (even cosines), u(pi/2) = 0 (even sines).
        let mut free = reals.zero();
        match part {
            COS_EVEN => {
                free = self.odd_total(reals, &by_sin);
                shift(&mut sin_integral, &free);
            }
            SIN_EVEN => {
                free = self.odd_total(reals, &by_cos);
                shift(&mut cos_integral, &free);
            }
            _ => {}
        }
        let rows = || (cos_integral.iter().zip(&sin_integral)).zip(self.cos.iter().zip(&self.sin));
        Particular {
            u: rows()
                .map(|((a, b), (c, s))| reals.sub(&reals.mul(s, a), &reals.mul(c, b)))
                .collect(),
            slope: rows()
                .map(|((a, b), (c, s))| reals.add(&reals.mul(c, a), &reals.mul(s, b)))
                .collect(),
            free,
        }
    }
}
