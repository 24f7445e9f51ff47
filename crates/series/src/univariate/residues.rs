//! Q[r]/m: sums of powers of a root r of m.

use super::{common_divisor, divided, plus, product, scaled};
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;

/// The ring `Q[r]/m` of a polynomial m without multiple roots: what holds here holds at every root of m. A
/// field where m is irreducible; otherwise an element that vanishes at some roots alone has no reciprocal.
///
/// An element is the list of its coefficients from the constant on, shorter than m, without leading zeros.
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Ring};
/// use lindstedt_series::univariate::Residues;
/// use rug::Rational;
/// let field = Residues::new([-8, 0, 1].map(Rational::from).to_vec());
/// let r = field.root();
/// assert_eq!(field.mul(&r, &r), field.rational(&8.into()));
/// assert_eq!(field.reciprocal(&r), Some(field.scale(&r, &(1, 8).into())));
/// ```
#[derive(Clone, Debug)]
pub struct Residues {
    modulus: Vec<Rational>,
}

impl Residues {
    /// The ring of a polynomial of positive degree.
    #[must_use]
    pub fn new(modulus: Vec<Rational>) -> Self {
        Self { modulus }
    }

    /// m.
    #[must_use]
    pub fn modulus(&self) -> &[Rational] {
        &self.modulus
    }

    /// r.
    #[must_use]
    pub fn root(&self) -> Vec<Rational> {
        self.reduced(&[Rational::new(), Rational::from(1)])
    }

    fn reduced(&self, a: &[Rational]) -> Vec<Rational> {
        let [_, rest] = divided(a, &self.modulus);
        rest
    }
}

impl Ring for Residues {
    type Element = Vec<Rational>;

    fn zero(&self) -> Vec<Rational> {
        Vec::new()
    }
    fn one(&self) -> Vec<Rational> {
        vec![Rational::from(1)]
    }
    fn is_zero(&self, a: &Vec<Rational>) -> bool {
        a.is_empty()
    }
    fn add_assign(&self, a: &mut Vec<Rational>, b: &Vec<Rational>) {
        *a = plus(std::mem::take(a), b);
    }
    fn neg(&self, a: &Vec<Rational>) -> Vec<Rational> {
        a.iter().map(|x| Rational::from(-x)).collect()
    }
    fn mul(&self, a: &Vec<Rational>, b: &Vec<Rational>) -> Vec<Rational> {
        self.reduced(&product(a, b))
    }
}

impl RationalAlgebra for Residues {
    fn rational(&self, q: &Rational) -> Vec<Rational> {
        scaled(&self.one(), q)
    }
    fn scale(&self, a: &Vec<Rational>, q: &Rational) -> Vec<Rational> {
        scaled(a, q)
    }
    /// By Euclid's algorithm: s a + t m = 1.
    fn reciprocal(&self, a: &Vec<Rational>) -> Option<Vec<Rational>> {
        if common_divisor(a, &self.modulus).len() != 1 {
            return None;
        }
        let (mut old, mut rest) = (self.modulus.clone(), a.clone());
        let (mut before, mut factor) = (self.zero(), self.one());
        while rest.len() > 1 {
            let [quotient, next] = divided(&old, &rest);
            let next_factor = self.sub(&before, &self.mul(&self.reduced(&quotient), &factor));
            (old, rest) = (rest, next);
            (before, factor) = (factor, next_factor);
        }
        Some(self.scale(&factor, &rest.first()?.clone().recip()))
    }
    fn as_rational(&self, a: &Vec<Rational>) -> Option<Rational> {
        match &a[..] {
            [] => Some(Rational::new()),
            [q] => Some(q.clone()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::laws;

    #[test]
    fn laws_of_a_field_and_of_no_field() {
        for modulus in [[-8, 0, 1], [6, -5, 1]] {
            let ring = Residues::new(modulus.map(Rational::from).to_vec());
            let r = ring.root();
            let other = ring.add(&ring.scale(&r, &(2, 3).into()), &ring.rational(&7.into()));
            let samples = [ring.zero(), ring.one(), r, other];
            assert_eq!(laws::rational_algebra(&ring, &samples), Ok(()));
        }
        // r - 2 vanishes at one root of r^2 - 5 r + 6.
        let ring = Residues::new([6, -5, 1].map(Rational::from).to_vec());
        assert_eq!(ring.reciprocal(&[-2, 1].map(Rational::from).to_vec()), None);
    }
}
