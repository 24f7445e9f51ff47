//! Functions of the phase by their values on the quarter period.
//!
//! A function splits into four parts by its symmetries under psi -> -psi and psi -> pi - psi
//! (cosines and sines of even and of odd multiples); each is given by its values at the nodes of a
//! [`Grid`] on [0, pi/2). Products are taken point by point, so any function with singularities at
//! multiples of pi/2 alone has a place here: logarithms and powers of |cos psi|, signs of x,
//! sines of x, quotients.
//!
//! The equation u'' + u = f is solved by variation of constants,
//!
//!   u = sin psi int_0^psi f cos - cos psi int_0^psi f sin,
//!
//! with sinc indefinite integration in t (see [`Grid`] for the map psi(t)),
//!
//!   int_(-infinity)^(kh) g dt = h sum_j g(jh) (1/2 + Si(pi (k - j))/pi),
//!
//! whose error is exp(-pi^2/(2h)). Numbers are estimates: compare two grids. The derivative of an
//! element is known for solutions (u', and u'' = f - u), for cos, sin and constants, and for linear
//! combinations of such; of anything else it is NaN, never a wrong number.
//!
//! Cost: a product K multiplications, a solution 8 K^2, K the number of nodes.

mod grid;
mod phase;

pub use grid::Grid;

use lindstedt_coeff::floats::Reals;
use std::sync::Arc;

/// The parts: index 0 even cosines, 1 odd cosines, 2 even sines, 3 odd sines. The part of a
/// product is the bitwise sum of the parts of its factors.
const PARTS: usize = 4;
/// Even cosines.
const COS_EVEN: usize = 0;
/// Odd cosines.
const COS_ODD: usize = 1;
/// Even sines.
const SIN_EVEN: usize = 2;
/// Odd sines.
const SIN_ODD: usize = 3;

/// A function: per part, nothing if it vanishes, or its values at the nodes.
#[derive(Clone, Debug)]
pub struct Sampled<E> {
    values: [Option<Arc<Vec<E>>>; PARTS],
    /// df/dpsi, where it is known.
    derivative: Option<Arc<Sampled<E>>>,
}

impl<E: PartialEq> PartialEq for Sampled<E> {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

/// The algebra of sampled functions over numbers of a context R.
///
/// ```
/// use lindstedt_algebra::{PhaseAlgebra, Ring};
/// use lindstedt_coeff::floats::Doubles;
/// use lindstedt_phase::collocation::{Collocation, Grid};
///
/// let (grid, _) = Grid::for_digits(14, 4);
/// let a = Collocation::new(Doubles, grid);
/// let cubed = a.mul(&a.cosine(), &a.mul(&a.cosine(), &a.cosine()));
/// // cos^3 = (3 cos + cos 3 psi)/4.
/// let split = a.resolve(&cubed)?;
/// assert!((split.cos_amplitude - 0.75).abs() < 1e-14);
/// # Ok::<(), lindstedt_algebra::PhaseError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Collocation<R: Reals> {
    reals: R,
    grid: Grid,
    cos: Arc<Vec<R::Element>>,
    sin: Arc<Vec<R::Element>>,
    /// h dpsi/dt.
    weights: Vec<R::Element>,
    /// Si(pi m)/pi for m = -(K-1)..=2(K-1), and the same backwards.
    forward: Vec<R::Element>,
    backward: Vec<R::Element>,
}

impl<R: Reals> Collocation<R> {
    /// The algebra on a grid. Cost: a Si value per node, about 10 ms at 100 digits.
    pub fn new(reals: R, grid: Grid) -> Self {
        let bits = reals.bits();
        let (mut cos, mut sin, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..grid.nodes {
            let [c, s, slope] = grid::node(k as f64 * grid.step, bits);
            cos.push(reals.from_float(&c));
            sin.push(reals.from_float(&s));
            weights.push(reals.from_float(&(slope * grid.step)));
        }
        let table = grid::sine_integrals(2 * grid.nodes, bits);
        let positive: Vec<_> = table.iter().map(|x| reals.from_float(x)).collect();
        let negative = positive.iter().take(grid.nodes).skip(1).rev().map(|x| reals.neg(x));
        let forward: Vec<_> = negative.chain(positive.iter().cloned()).collect();
        let backward = forward.iter().rev().cloned().collect();
        Self { reals, grid, cos: Arc::new(cos), sin: Arc::new(sin), weights, forward, backward }
    }

    /// The nodes.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The values of f at psi_k, k = 0, 1, ..., in the first quarter.
    pub fn values(&self, f: &Sampled<R::Element>) -> Vec<R::Element> {
        let [values, ..] = self.images(f);
        values
    }

    fn from_parts(&self, values: [Option<Vec<R::Element>>; PARTS]) -> Sampled<R::Element> {
        let absent = |list: &Vec<R::Element>| list.iter().all(|v| self.reals.is_zero(v));
        let values = values.map(|part| part.filter(|list| !absent(list)).map(Arc::new));
        Sampled { values, derivative: None }
    }

    fn of_part(&self, part: usize, values: Arc<Vec<R::Element>>) -> Sampled<R::Element> {
        let mut f = Sampled { values: [const { None }; PARTS], derivative: None };
        if let Some(slot) = f.values.get_mut(part) {
            *slot = Some(values);
        }
        f
    }

    /// The function with a NaN for every value.
    fn unknown(&self) -> Sampled<R::Element> {
        let nan = self.reals.from_float(&rug::Float::with_val(2, rug::float::Special::Nan));
        self.of_part(COS_EVEN, Arc::new(vec![nan; self.grid.nodes]))
    }

    /// The values at psi, pi - psi, -psi and pi + psi.
    fn images(&self, f: &Sampled<R::Element>) -> [Vec<R::Element>; 4] {
        let signs: [[bool; PARTS]; 4] = [
            [true, true, true, true],
            [true, false, false, true],
            [true, true, false, false],
            [true, false, true, false],
        ];
        signs.map(|signs| {
            let mut sum = vec![self.reals.zero(); self.grid.nodes];
            for (part, sign) in f.values.iter().zip(signs) {
                for (s, v) in sum.iter_mut().zip(part.iter().flat_map(|list| list.iter())) {
                    let term = if sign { v.clone() } else { self.reals.neg(v) };
                    self.reals.add_assign(s, &term);
                }
            }
            sum
        })
    }

    /// The function with these values at psi, pi - psi, -psi and pi + psi.
    fn from_images(&self, images: &[Vec<R::Element>; 4]) -> Sampled<R::Element> {
        let quarter = rug::Rational::from((1, 4));
        let combine = |signs: [bool; 2]| -> Vec<R::Element> {
            let [a, b, c, d] = images;
            let join = |x: &R::Element, y: &R::Element, plus: bool| {
                if plus { self.reals.add(x, y) } else { self.reals.sub(x, y) }
            };
            let pairs = a.iter().zip(b).zip(c.iter().zip(d));
            let value = |((a, b), (c, d))| {
                let sum = join(&join(a, c, signs[0]), &join(b, d, signs[0]), signs[1]);
                self.reals.scale(&sum, &quarter)
            };
            pairs.map(value).collect()
        };
        self.from_parts([
            Some(combine([true, true])),
            Some(combine([true, false])),
            Some(combine([false, false])),
            Some(combine([false, true])),
        ])
    }

    /// g(f) point by point; nothing where an image changes its sign or vanishes (if that is
    /// forbidden), is negative (if that is), or where a value is not finite.
    fn pointwise(
        &self,
        f: &Sampled<R::Element>,
        domain: Domain,
        g: impl Fn(&R::Element) -> R::Element,
    ) -> Option<Sampled<R::Element>> {
        let images = self.images(f);
        for image in &images {
            let positive = image.iter().filter(|v| self.reals.is_positive(v)).count();
            let negative =
                image.iter().filter(|v| self.reals.is_positive(&self.reals.neg(v))).count();
            let allowed = match domain {
                Domain::Everywhere => true,
                Domain::NoZeros => positive == image.len() || negative == image.len(),
                Domain::Positive => positive == image.len(),
            };
            if !allowed {
                return None;
            }
        }
        let result = images.map(|image| image.iter().map(&g).collect::<Vec<_>>());
        let finite = result.iter().flatten().all(|v| self.reals.is_finite(v));
        finite.then(|| self.from_images(&result))
    }

    /// int_0^infinity g dt h^-1 for even g.
    fn total(&self, g: &[R::Element]) -> R::Element {
        let Some((first, rest)) = g.split_first() else { return self.reals.zero() };
        let mut sum = self.reals.scale(first, &rug::Rational::from((1, 2)));
        for value in rest {
            self.reals.add_assign(&mut sum, value);
        }
        sum
    }

    /// int_0^(kh) g dt h^-1 for k = 0, 1, ..., with S(m) = Si(pi m)/pi: for even g
    ///
    ///   g_0 S(k) + sum_(j>=1) g_j (S(k - j) + S(k + j)),
    ///
    /// for odd g, g_0 = 0: sum_(j>=1) g_j (S(k - j) - S(k + j) + 2 S(j)).
    fn cumulative(&self, g: &[R::Element], even: bool) -> Vec<R::Element>
    where
        R::Element: Send + Sync,
    {
        let nodes = self.grid.nodes;
        let Some(tail) = g.get(1..) else { return Vec::new() };
        // forward[nodes - 1 + m] = S(m), backward[2 nodes - 1 - m] = S(m).
        let dot = |start: Option<&[R::Element]>| {
            start.map_or_else(|| self.reals.zero(), |list| self.reals.dot(tail, list))
        };
        let base = dot(self.forward.get(nodes..));
        let value = |k: usize| {
            let below = dot(self.backward.get(2 * nodes - k..));
            let above = dot(self.forward.get(nodes + k..));
            if even {
                let first = self.forward.get(nodes - 1 + k);
                let first = first.zip(g.first()).map(|(s, g)| self.reals.mul(s, g));
                let sum = self.reals.add(&below, &above);
                first.map_or(sum.clone(), |first| self.reals.add(&sum, &first))
            } else {
                let sum = self.reals.sub(&below, &above);
                self.reals.add(&sum, &self.reals.add(&base, &base))
            }
        };
        let mut values = self.map_nodes(value);
        // Exactly zero, up to the rounding of an antisymmetric sum.
        if let Some(first) = values.first_mut() {
            *first = self.reals.zero();
        }
        values
    }

    /// One value per node, on both cores where a value is long work.
    fn map_nodes(&self, value: impl Fn(usize) -> R::Element + Send + Sync) -> Vec<R::Element> {
        use rayon::prelude::*;
        if self.reals.bits() <= 64 {
            return (0..self.grid.nodes).map(value).collect();
        }
        (0..self.grid.nodes).into_par_iter().map(value).collect()
    }
}

/// Where a pointwise function is defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Domain {
    /// For all numbers.
    Everywhere,
    /// A zero between the nodes is a singularity that they do not resolve.
    NoZeros,
    /// For positive numbers.
    Positive,
}

#[cfg(test)]
mod tests;
