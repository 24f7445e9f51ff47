//! The frequency of a clock: omega^2 = kappa nu/M^2 with M = 1 + sum_m mu_m c_m, and its judge.

use crate::ExpandError;
use lindstedt_algebra::{RationalAlgebra, Rationals};
use lindstedt_series::Series;
use rug::Rational;

/// Powers of the frequency as series in the small parameter.
#[derive(Clone, Debug)]
pub struct ClockFrequency<E> {
    /// W = nu/M^2: omega^2 = kappa W.
    pub squared: Vec<E>,
    /// nu^(1/2)/M, omega over the root of kappa.
    pub first: Vec<E>,
    /// M nu^(-1/2), T/2pi times the root of kappa; linear in the mu_m where nu is rational.
    pub period: Vec<E>,
}

/// M, 1/M and 1/M^2 as series in the small parameter.
#[derive(Clone, Debug)]
pub struct ClockMean<E> {
    powers: [Series<E>; 3],
}

impl<E: Clone + PartialEq + std::fmt::Debug + Send + Sync> ClockMean<E> {
    /// The powers of M, of leading coefficient one.
    ///
    /// Checked: M M^(-1) = 1 and M M^(-2) = M^(-1) are multiplied out. Cost: as M is linear in the mu_m, a product of
    /// numbers for every term of 1/M^2 and order.
    ///
    /// # Errors
    /// [`ExpandError::Residual`] with the first order at which a product differs (a defect), 0 where the leading
    /// coefficient is not one.
    pub fn new<R: RationalAlgebra<Element = E>>(
        ring: &R,
        mean: Vec<E>,
    ) -> Result<Self, ExpandError> {
        let broken = || ExpandError::Residual { order: 0 };
        let order = mean.len().saturating_sub(1);
        let m = Series::truncated(mean);
        let inverse = m.reciprocal(ring).ok_or_else(broken)?;
        let square = inverse.divided_by(ring, &m).ok_or_else(broken)?;
        let mut one = vec![ring.zero(); order + 1];
        one[0] = ring.one();
        must_agree(&m.mul(ring, &inverse, order), &Series::truncated(one))?;
        must_agree(&m.mul(ring, &square, order), &inverse)?;
        Ok(Self { powers: [m, inverse, square] })
    }

    /// The highest order.
    pub fn order(&self) -> usize {
        self.powers[0].coefficients.len().saturating_sub(1)
    }

    /// The powers of the frequency for nu.
    ///
    /// Checked: nu^(1/2) nu^(1/2) = nu and nu^(1/2) nu^(-1/2) = 1, multiplied out.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn frequency<R: RationalAlgebra<Element = E>>(
        &self,
        ring: &R,
        pace: &[E],
    ) -> Result<ClockFrequency<E>, ExpandError> {
        let order = pace.len().saturating_sub(1);
        let nu = Series::truncated(pace.to_vec());
        let product = |a: &Series<E>, b: &Series<E>| a.mul(ring, b, order);
        let broken = || ExpandError::Residual { order: 0 };
        let root = nu.square_root(ring).ok_or_else(broken)?;
        let over_root = nu.power(ring, &Rational::from((-1, 2))).ok_or_else(broken)?;
        must_agree(&product(&root, &root.clone()), &nu)?;
        must_agree(&product(&product(&root, &over_root), &nu), &nu)?;
        let [m, inverse, square] = &self.powers;
        Ok(ClockFrequency {
            squared: product(&nu, square).coefficients,
            first: product(&root, inverse).coefficients,
            period: product(&over_root, m).coefficients,
        })
    }
}

/// Refuses the first order at which two series differ or one is not known.
fn must_agree<E: PartialEq>(a: &Series<E>, b: &Series<E>) -> Result<(), ExpandError> {
    let (a, b) = (&a.coefficients, &b.coefficients);
    match a.iter().zip(b).position(|(a, b)| a != b) {
        Some(order) => Err(ExpandError::Residual { order }),
        None if a.len() != b.len() => Err(ExpandError::Residual { order: a.len().min(b.len()) }),
        None => Ok(()),
    }
}

/// The series c with c_m = c^m for all m and orders, if there is one; `numbers[n][m - 1]` = c_mn.
#[must_use]
pub fn clock_variable(numbers: &[Vec<Rational>]) -> Option<Vec<Rational>> {
    let order = numbers.len().checked_sub(1)?;
    let at = |m: usize, n: usize| numbers[n].get(m - 1).cloned().unwrap_or_default();
    let series = |m: usize| Series::truncated((0..=order).map(|n| at(m, n)).collect());
    let c = series(1);
    let largest = numbers.iter().map(Vec::len).max().unwrap_or(0);
    let mut power = c.clone();
    for m in 2..=largest.max(order) {
        power = power.mul(&Rationals, &c, order);
        if series(m).coefficients != power.coefficients {
            return None;
        }
    }
    c.coefficients.first().is_some_and(|q| q.is_zero()).then_some(c.coefficients)
}
