//! The cheap rule: truncated Fourier series by their values at equidistant points.
//!
//! At the points psi_j = (2j + 1) pi/(4Q), j = 0..Q, each symmetry class has the first Q of its
//! harmonics; sums over the points are exact for them, and harmonics beyond are folded back
//! (aliasing). u'' + u = f divides the coefficient of harmonic m by 1 - m^2. A logarithm has
//! coefficients like 1/m, so the solution converges like a low power of 1/Q.

use super::{COS_EVEN, COS_ODD, Particular, SIN_ODD};
use lindstedt_coeff::floats::Reals;
use rug::float::Constant;
use rug::{Float, Rational};

/// cos and sin of i pi/(4Q), i = 0..8Q.
#[derive(Clone, Debug)]
pub(super) struct Fourier<E> {
    points: usize,
    cos: Vec<E>,
    sin: Vec<E>,
}

impl<E: Clone + PartialEq> Fourier<E> {
    pub(super) fn new<R: Reals<Element = E>>(reals: &R, points: usize) -> Self {
        let bits = reals.bits() + 16;
        let angle = |i: usize| Float::with_val(bits, Constant::Pi) * i as u64 / (4 * points as u64);
        let table = |f: fn(Float) -> Float| {
            (0..8 * points).map(|i| reals.from_float(&f(angle(i)))).collect::<Vec<_>>()
        };
        Self { points, cos: table(Float::cos), sin: table(Float::sin) }
    }

    /// cos psi_j and sin psi_j.
    pub(super) fn nodes(&self) -> [Vec<E>; 2] {
        [&self.cos, &self.sin]
            .map(|list| list.iter().skip(1).step_by(2).take(self.points).cloned().collect())
    }

    /// The k-th harmonic of a part: 0, 2, 4 (even cosines), 2, 4, 6 (even sines) or 1, 3, 5.
    fn harmonic(part: usize, k: usize) -> usize {
        match part {
            COS_EVEN => 2 * k,
            COS_ODD | SIN_ODD => 2 * k + 1,
            _ => 2 * k + 2,
        }
    }

    /// Multiples m and coefficients of a part.
    pub(super) fn coefficients<R: Reals<Element = E>>(
        &self,
        reals: &R,
        part: usize,
        values: &[E],
    ) -> Vec<(usize, E)> {
        let coefficient = |k: usize| {
            let m = Self::harmonic(part, k);
            let mut sum = reals.zero();
            for (j, v) in values.iter().enumerate() {
                reals.accumulate(&mut sum, v, self.basis(part, m, j));
            }
            // The constant and sin 2Q psi have twice the norm.
            let norm = if m == 0 || m == 2 * self.points { 1 } else { 2 };
            (m, reals.scale(&sum, &Rational::from((norm, self.points))))
        };
        (0..self.points).map(coefficient).collect()
    }

    /// cos(m psi_j), or the sine.
    fn basis(&self, part: usize, m: usize, j: usize) -> &E {
        let list = if part == COS_EVEN || part == COS_ODD { &self.cos } else { &self.sin };
        &list[m * (2 * j + 1) % list.len()]
    }

    fn values<R: Reals<Element = E>>(
        &self,
        reals: &R,
        part: usize,
        coefficients: &[(usize, E)],
    ) -> Vec<E> {
        let value = |j: usize| {
            let mut sum = reals.zero();
            for (m, c) in coefficients {
                reals.accumulate(&mut sum, c, self.basis(part, *m, j));
            }
            sum
        };
        (0..self.points).map(value).collect()
    }

    /// u'' + u = f for a part f without resonance.
    pub(super) fn particular<R: Reals<Element = E>>(
        &self,
        reals: &R,
        part: usize,
        f: &[E],
    ) -> Particular<E> {
        let cosine = part == COS_EVEN || part == COS_ODD;
        let mut u = self.coefficients(reals, part, f);
        // u(0) of cosines, u'(0) of sines.
        let mut initial = reals.zero();
        for (m, c) in &mut u {
            let square = (*m * *m) as i64;
            *c = if *m == 1 {
                reals.zero()
            } else {
                reals.scale(c, &Rational::from((1, 1 - square)))
            };
            let rate = if cosine { 1 } else { *m };
            reals.add_assign(&mut initial, &reals.scale(c, &Rational::from(rate)));
        }
        let mut free = reals.zero();
        match (part, u.first_mut()) {
            (COS_ODD | SIN_ODD, Some((_, first))) => *first = reals.neg(&initial),
            (COS_EVEN, _) => free = initial,
            _ => free = reals.neg(&initial),
        }
        let slope: Vec<(usize, E)> = u
            .iter()
            .map(|(m, c)| {
                let sign = if cosine { -1 } else { 1 };
                (*m, reals.scale(c, &Rational::from(sign * *m as i64)))
            })
            .collect();
        Particular {
            u: self.values(reals, part, &u),
            slope: self.values(reals, part ^ super::SIN_EVEN, &slope),
            free,
        }
    }
}
