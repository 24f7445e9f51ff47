//! `R[[eps]]/eps^(N+1)`: truncated power series over a ring, multiplied in full.
//!
//! The driver does not use this crate for its own step (it computes one coefficient at a time);
//! it serves the residual check, which must share no code with the driver, and the series of
//! the results: the frequency from its square, the period from the frequency.

pub mod harmonics;
pub mod resummation;
pub mod univariate;

use lindstedt_algebra::{RationalAlgebra, Ring};
use rayon::prelude::*;
use rug::Rational;

/// Products of coefficients of a word that take no longer than waking other cores is worth: a millisecond.
const ALONE: usize = 1 << 18;

/// Coefficients from order 0; everything beyond the list is unknown, unless the series is a
/// polynomial.
///
/// ```
/// use lindstedt_algebra::Rationals;
/// use lindstedt_series::Series;
/// use rug::Rational;
/// let square = Series::truncated([1, 1, 0].map(Rational::from).to_vec());
/// // sqrt(1 + eps) = 1 + eps/2 - eps^2/8 + ...
/// let root = square.power(&Rationals, &Rational::from((1, 2))).ok_or("no root")?;
/// assert_eq!(root.coefficients[2], Rational::from((-1, 8)));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Series<E> {
    /// The coefficients from order 0.
    pub coefficients: Vec<E>,
    /// Whether all further coefficients are known to vanish.
    pub is_polynomial: bool,
}

impl<E: Clone + PartialEq + std::fmt::Debug + Send + Sync> Series<E> {
    /// A series known up to the order of its last coefficient.
    pub fn truncated(coefficients: Vec<E>) -> Self {
        Self { coefficients, is_polynomial: false }
    }

    /// A polynomial in the small parameter.
    pub fn polynomial(coefficients: Vec<E>) -> Self {
        Self { coefficients, is_polynomial: true }
    }

    /// The number of known coefficients.
    pub fn known(&self) -> usize {
        if self.is_polynomial { usize::MAX } else { self.coefficients.len() }
    }

    /// The number of leading coefficients known to vanish.
    fn valuation<R: Ring<Element = E>>(&self, ring: &R) -> usize {
        let leading = self.coefficients.iter().take_while(|c| ring.is_zero(c)).count();
        if leading == self.coefficients.len() { self.known() } else { leading }
    }

    /// self + other, known as far as both are.
    #[must_use]
    pub fn add<R: Ring<Element = E>>(&self, ring: &R, other: &Self) -> Self {
        let known = self.known().min(other.known());
        let length = self.coefficients.len().max(other.coefficients.len()).min(known);
        let coefficient = |n| match (self.coefficients.get(n), other.coefficients.get(n)) {
            (Some(a), Some(b)) => ring.add(a, b),
            (Some(a), None) | (None, Some(a)) => a.clone(),
            (None, None) => ring.zero(),
        };
        Self {
            coefficients: (0..length).map(coefficient).collect(),
            is_polynomial: known == usize::MAX,
        }
    }

    /// self * other up to `order`, known as far as the factors and their valuations allow. The
    /// coefficients are independent of each other and, where they cost more than that, computed on all cores.
    #[must_use]
    pub fn mul<R: Ring<Element = E>>(&self, ring: &R, other: &Self, order: usize) -> Self {
        self.mul_from(ring, other, 0, order)
    }

    /// The same with zero in place of the coefficients below `first`, which are not computed.
    #[must_use]
    pub fn mul_from<R: Ring<Element = E>>(
        &self,
        ring: &R,
        other: &Self,
        first: usize,
        order: usize,
    ) -> Self {
        let (u, v) = (self.valuation(ring), other.valuation(ring));
        let known = self.known().saturating_add(v).min(other.known().saturating_add(u));
        let length = known.min(order + 1);
        let (a, b) = (&self.coefficients, &other.coefficients);
        let is_square = std::ptr::eq(self, other);
        let coefficient = |n: usize| {
            if n < first {
                return ring.zero();
            }
            if is_square {
                let pairs: Vec<(&E, &E)> =
                    (0..n.div_ceil(2)).filter_map(|k| Some((a.get(k)?, a.get(n - k)?))).collect();
                let middle = n.is_multiple_of(2).then(|| a.get(n / 2)).flatten();
                return ring.coefficient_of_square(&pairs, middle);
            }
            let range = n.saturating_sub(b.len().saturating_sub(1))..a.len().min(n + 1);
            let mut pairs: Vec<(&E, &E)> = Vec::with_capacity(range.len());
            pairs.extend(range.filter_map(|k| Some((a.get(k)?, b.get(n - k)?))));
            ring.sum_of_products(&pairs)
        };
        let size = |list: &[E]| -> usize { list.iter().map(|c| ring.size(c)).sum() };
        if size(a).saturating_mul(size(b)) < ALONE {
            return Self::truncated((0..length).map(coefficient).collect());
        }
        // Late coefficients cost most: hand them out first.
        let mut coefficients: Vec<E> = (0..length).into_par_iter().rev().map(coefficient).collect();
        coefficients.reverse();
        Self::truncated(coefficients)
    }

    /// Applies a map to every coefficient.
    #[must_use]
    pub fn map(&self, f: impl Fn(&E) -> E) -> Self {
        Self {
            coefficients: self.coefficients.iter().map(f).collect(),
            is_polynomial: self.is_polynomial,
        }
    }

    /// self^exponent for a series with leading coefficient one:
    ///
    ///   n y_n = sum_{k=1}^n ((r + 1) k - n) x_k y_{n-k},   y = x^r,
    ///
    /// from x y' = r x' y. Exact; O(N^2) products. Nothing unless the leading coefficient is one.
    pub fn power<R: RationalAlgebra<Element = E>>(
        &self,
        ring: &R,
        exponent: &Rational,
    ) -> Option<Self> {
        self.power_while(ring, exponent, &|| true)
    }

    /// The square root of a series with leading coefficient one, from 2 y_n = x_n - sum_{k=1}^{n-1} y_k
    /// y_{n-k}. Exact; O(N^2) products, half as many as [`Self::power`] forms. Nothing unless the leading
    /// coefficient is one.
    pub fn square_root<R: RationalAlgebra<Element = E>>(&self, ring: &R) -> Option<Self> {
        let half = Rational::from((1, 2));
        let mut y = vec![self.coefficients.first().filter(|c| **c == ring.one())?.clone()];
        for (n, x) in self.coefficients.iter().enumerate().skip(1) {
            let pairs: Vec<(&E, &E)> = (1..n.div_ceil(2)).map(|k| (&y[k], &y[n - k])).collect();
            let middle = n.is_multiple_of(2).then(|| &y[n / 2]);
            let rest = ring.sub(x, &ring.coefficient_of_square(&pairs, middle));
            y.push(ring.scale(&rest, &half));
        }
        Some(Self::truncated(y))
    }

    /// The reciprocal of a series with leading coefficient one. Nothing unless the leading coefficient is one.
    pub fn reciprocal<R: RationalAlgebra<Element = E>>(&self, ring: &R) -> Option<Self> {
        let mut one = vec![ring.zero(); self.coefficients.len()];
        one.first_mut()?.clone_from(&ring.one());
        Self::truncated(one).divided_by(ring, self)
    }

    /// self/other for a series `other` with leading coefficient one, from y_n = z_n - sum_{k=1}^n x_k y_{n-k}, as far
    /// as both are known. Exact; O(N^2) products. Nothing unless the leading coefficient is one.
    pub fn divided_by<R: RationalAlgebra<Element = E>>(
        &self,
        ring: &R,
        other: &Self,
    ) -> Option<Self> {
        let x = &other.coefficients;
        x.first().filter(|c| **c == ring.one())?;
        let mut y: Vec<E> = Vec::new();
        for (n, z) in self.coefficients.iter().take(x.len()).enumerate() {
            let pairs: Vec<(&E, &E)> = (1..=n).map(|k| (&x[k], &y[n - k])).collect();
            y.push(ring.sub(z, &ring.sum_of_products(&pairs)));
        }
        Some(Self::truncated(y))
    }

    /// exp(self) for a series without a constant term,
    ///
    ///   n y_n = sum_{k=1}^n k x_k y_{n-k},   y = exp(x),
    ///
    /// from y' = x' y. Exact; O(N^2) products. Nothing unless the leading coefficient is zero.
    pub fn exponential<R: RationalAlgebra<Element = E>>(&self, ring: &R) -> Option<Self> {
        self.coefficients.first().filter(|c| ring.is_zero(c))?;
        let weighted = self.coefficients.iter().enumerate();
        let weighted: Vec<E> = weighted.map(|(k, x)| ring.scale(x, &Rational::from(k))).collect();
        let mut y = vec![ring.one()];
        for n in 1..weighted.len() {
            let pairs: Vec<_> = weighted[1..=n].iter().zip(y.iter().rev()).collect();
            y.push(ring.scale(&ring.sum_of_products(&pairs), &Rational::from((1, n))));
        }
        Some(Self::truncated(y))
    }

    /// As [`Self::power`] as long as `go_on`, asked several times per order, says so; else nothing.
    pub fn power_while<R: RationalAlgebra<Element = E>>(
        &self,
        ring: &R,
        exponent: &Rational,
        go_on: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let x = &self.coefficients;
        if *x.first()? != ring.one() {
            return None;
        }
        let mut y = vec![ring.one()];
        for n in 1..x.len() {
            let factor =
                |k: usize| Rational::from(exponent + 1u32) * Rational::from(k) - Rational::from(n);
            let weighted: Vec<E> = (1..=n).map(|k| ring.scale(&x[k], &factor(k))).collect();
            let pairs: Vec<_> = weighted.iter().zip(y.iter().rev()).collect();
            let mut sum = ring.zero();
            for part in pairs.chunks(16) {
                if !go_on() {
                    return None;
                }
                ring.add_assign(&mut sum, &ring.sum_of_products(part));
            }
            y.push(ring.scale(&sum, &Rational::from((1, n))));
        }
        Some(Self::truncated(y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::Rationals;

    fn series(values: &[(i32, u32)]) -> Series<Rational> {
        Series::truncated(values.iter().map(|&v| Rational::from(v)).collect())
    }

    #[test]
    fn powers_multiply() {
        let x = series(&[(1, 1), (2, 3), (-1, 5), (7, 2), (0, 1), (1, 9)]);
        let third = Rational::from((1, 3));
        let Some(root) = x.power(&Rationals, &third) else { panic!("leading one") };
        let cube = root.mul(&Rationals, &root, 5).mul(&Rationals, &root, 5);
        assert_eq!(cube, x);
        assert_eq!(series(&[(2, 1), (1, 1)]).power(&Rationals, &third), None);
        let Some(root) = x.square_root(&Rationals) else { panic!("leading one") };
        assert_eq!(root.mul(&Rationals, &root, 5), x);
        assert_eq!(root.mul(&Rationals, &root.clone(), 5), x);
        assert_eq!(series(&[(2, 1), (1, 1)]).square_root(&Rationals), None);
        let inverse = x.reciprocal(&Rationals);
        assert_eq!(inverse, x.power(&Rationals, &Rational::from(-1)));
        let quotient = root.divided_by(&Rationals, &x).map(|q| q.mul(&Rationals, &x, 5));
        assert_eq!(quotient, Some(root));
    }

    #[test]
    fn exponentials_of_sums_are_products() {
        let all = [&[(0, 1), (1, 1), (2, 3), (-1, 5)], &[(0, 1), (0, 1), (7, 2), (1, 9)]];
        let [x, y] = all.map(|list| series(list));
        let of = |x: &Series<Rational>| match x.exponential(&Rationals) {
            Some(y) => y,
            None => panic!("no constant term"),
        };
        assert_eq!(of(&x.add(&Rationals, &y)), of(&x).mul(&Rationals, &of(&y), 3));
        assert_eq!(
            of(&series(&[(0, 1), (2, 1), (0, 1), (0, 1)])),
            series(&[(1, 1), (2, 1), (2, 1), (4, 3)])
        );
        assert_eq!(series(&[(1, 1), (2, 1)]).exponential(&Rationals), None);
    }

    #[test]
    fn products_know_what_the_factors_allow() {
        let x = series(&[(0, 1), (1, 1), (1, 1)]);
        let small = Series::polynomial(vec![Rational::new(), Rational::from(1)]);
        assert_eq!(small.mul(&Rationals, &x, 9).coefficients.len(), 4);
        assert_eq!(x.mul(&Rationals, &x, 9), series(&[(0, 1), (0, 1), (1, 1), (2, 1)]));
        assert_eq!(x.mul_from(&Rationals, &x, 3, 9), series(&[(0, 1), (0, 1), (0, 1), (2, 1)]));
    }
}
