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
//! whose error is exp(-pi^2/(2h)). The cheap alternative are equidistant points and truncated
//! Fourier series ([`Collocation::fourier`]). Numbers are estimates: compare two grids. The derivative of an
//! element is known for solutions (u', and u'' = f - u), for cos, sin and constants, and for linear
//! combinations of such; of anything else it is NaN, never a wrong number.
//!
//! Cost: a product K multiplications, a solution 8 K^2 in
//! doubles and two products of integers of K numbers at higher precision, K the number of nodes.

mod fourier;
mod grid;
mod packed;
mod phase;
mod sinc;

pub use grid::Grid;

use fourier::Fourier;
use sinc::Sinc;

use lindstedt_algebra::Stop;
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
/// let a = Collocation::new(Doubles, grid, Default::default());
/// let cubed = a.mul(&a.cosine(), &a.mul(&a.cosine(), &a.cosine()));
/// // cos^3 = (3 cos + cos 3 psi)/4.
/// let split = a.resolve(&cubed)?;
/// assert!((split.cos_amplitude - 0.75).abs() < 1e-14);
/// # Ok::<(), lindstedt_algebra::PhaseError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Collocation<R: Reals> {
    reals: R,
    nodes: usize,
    cos: Arc<Vec<R::Element>>,
    sin: Arc<Vec<R::Element>>,
    rule: Rule<R::Element>,
    stop: Stop,
}

impl<R: Reals> Collocation<R> {
    /// The algebra on a grid, whose tables and expansions end when `stop` says so. Cost: a Si value per node, about 10 ms at
    /// 100 digits.
    pub fn new(reals: R, grid: Grid, stop: Stop) -> Self {
        let (sinc, [cos, sin]) = Sinc::new(&reals, grid, &stop);
        Self {
            reals,
            nodes: grid.nodes,
            cos: Arc::new(cos),
            sin: Arc::new(sin),
            rule: Rule::Sinc(sinc),
            stop,
        }
    }

    /// The algebra whose expansions end when `stop` says so.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// Truncated Fourier series: `harmonics` of them (at least one) in each symmetry class.
    pub fn fourier(reals: R, harmonics: usize) -> Self {
        let fourier = Fourier::new(&reals, harmonics.max(1));
        let [cos, sin] = fourier.nodes();
        let rule = Rule::Fourier(fourier);
        Self {
            reals,
            nodes: cos.len(),
            cos: Arc::new(cos),
            sin: Arc::new(sin),
            rule,
            stop: Stop::default(),
        }
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// The values of f at the nodes in the first quarter, from psi = 0 to pi/2.
    pub fn values(&self, f: &Sampled<R::Element>) -> Vec<R::Element> {
        let [values, ..] = self.images(f);
        values
    }

    fn with_parts(&self, values: [Option<Vec<R::Element>>; PARTS]) -> Sampled<R::Element> {
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
        let nan = self.reals.nearest(&rug::Float::with_val(2, rug::float::Special::Nan));
        self.of_part(COS_EVEN, Arc::new(vec![nan; self.nodes]))
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
            let mut sum = vec![self.reals.zero(); self.nodes];
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
    fn with_images(&self, images: &[Vec<R::Element>; 4]) -> Sampled<R::Element> {
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
        self.with_parts([
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
        finite.then(|| self.with_images(&result))
    }

    /// One value per node, on both cores where a value is long work.
    fn map_nodes(&self, value: impl Fn(usize) -> R::Element + Send + Sync) -> Vec<R::Element> {
        use rayon::prelude::*;
        if self.reals.bits() <= 64 {
            return (0..self.nodes).map(value).collect();
        }
        (0..self.nodes).into_par_iter().map(value).collect()
    }
}

/// How mean values and solutions are found.
#[derive(Clone, Debug)]
enum Rule<E> {
    /// Sinc indefinite integration.
    Sinc(Sinc<E>),
    /// Fourier coefficients.
    Fourier(Fourier<E>),
}

/// A solution of u'' + u = f in the symmetry class of f.
struct Particular<E> {
    u: Vec<E>,
    slope: Vec<E>,
    /// A0: u - A0 cos psi (even cosines) or u + A0 sin psi (even sines) starts at rest.
    free: E,
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
