//! The hyperbolic algebra Q[sech z, tanh z] / (tanh^2 z = 1 - sech^2 z).
//!
//! Homoclinic and heteroclinic orbits of polynomial potentials live here, in the scaled time
//! z = kappa t: the double well's is sech z, the kink of the softening Duffing oscillator tanh z,
//! the Helmholtz oscillator's sech^2 z. An element is a finite sum of c sech^p z tanh^q z with
//! c in Q, p >= 0 and q in {0, 1}; the relation removes every higher power of tanh, so elements
//! are canonical and an orbit is checked against its equation of motion exactly.

mod fourier;
mod gamma;
mod integral;
mod pi_polynomial;

pub use fourier::{FourierForm, FourierTransform, line_fourier};
pub use gamma::{beta, gamma};
pub use integral::{LineIntegral, line_integral};
pub use pi_polynomial::PiPolynomial;

use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;
use std::collections::BTreeMap;
use std::fmt;

/// sum c sech^p tanh^q with q in {0, 1}; no zero coefficients are stored.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hyperbolic {
    terms: BTreeMap<(u32, bool), Rational>,
}

/// The ring of [`Hyperbolic`] elements.
///
/// ```
/// use lindstedt_algebra::Ring;
/// use lindstedt_melnikov::hyperbolic::{Hyperbolic, HyperbolicRing};
///
/// let ring = HyperbolicRing;
/// let (sech, tanh) = (Hyperbolic::sech(1), Hyperbolic::tanh());
/// // tanh^2 = 1 - sech^2
/// assert_eq!(ring.mul(&tanh, &tanh), ring.sub(&ring.one(), &ring.mul(&sech, &sech)));
/// assert_eq!(ring.derivative(&sech).to_string(), "-sech tanh");
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct HyperbolicRing;

impl Hyperbolic {
    /// c sech^p tanh^q with q in {0, 1} (`true` for tanh).
    #[must_use]
    pub fn term(c: Rational, p: u32, tanh: bool) -> Self {
        let mut element = Self::default();
        element.add_term((p, tanh), &c);
        element
    }
    /// sech^p z.
    #[must_use]
    pub fn sech(p: u32) -> Self {
        Self::term(Rational::from(1), p, false)
    }
    /// tanh z.
    #[must_use]
    pub fn tanh() -> Self {
        Self::term(Rational::from(1), 0, true)
    }
    /// The terms as (coefficient, p, whether there is a factor tanh), p ascending.
    pub fn terms(&self) -> impl Iterator<Item = (&Rational, u32, bool)> {
        self.terms.iter().map(|(&(p, tanh), c)| (c, p, tanh))
    }
    /// Whether every term decays: sech to a power of at least 1 in each.
    #[must_use]
    pub fn decays(&self) -> bool {
        self.terms.keys().all(|&(p, _)| p > 0)
    }
    fn add_term(&mut self, key: (u32, bool), c: &Rational) {
        if c.is_zero() {
            return;
        }
        let entry = self.terms.entry(key).or_default();
        *entry += c;
        if entry.is_zero() {
            self.terms.remove(&key);
        }
    }
}

impl HyperbolicRing {
    /// d/dz: sech' = -sech tanh, tanh' = sech^2.
    #[must_use]
    pub fn derivative(self, a: &Hyperbolic) -> Hyperbolic {
        let mut result = Hyperbolic::default();
        for (c, p, tanh) in a.terms() {
            if tanh {
                // (sech^p tanh)' = -p sech^p tanh^2 + sech^(p+2) = -p sech^p + (p+1) sech^(p+2).
                result.add_term((p, false), &-(c * Rational::from(p)));
                result.add_term((p.saturating_add(2), false), &(c * (Rational::from(p) + 1u32)));
            } else {
                result.add_term((p, true), &-(c * Rational::from(p)));
            }
        }
        result
    }
}

impl Ring for HyperbolicRing {
    type Element = Hyperbolic;

    fn zero(&self) -> Hyperbolic {
        Hyperbolic::default()
    }
    fn one(&self) -> Hyperbolic {
        Hyperbolic::sech(0)
    }
    fn is_zero(&self, a: &Hyperbolic) -> bool {
        a.terms.is_empty()
    }
    fn add_assign(&self, a: &mut Hyperbolic, b: &Hyperbolic) {
        for (&key, c) in &b.terms {
            a.add_term(key, c);
        }
    }
    fn neg(&self, a: &Hyperbolic) -> Hyperbolic {
        self.scale(a, &Rational::from(-1))
    }
    fn mul(&self, a: &Hyperbolic, b: &Hyperbolic) -> Hyperbolic {
        let mut product = Hyperbolic::default();
        for (c, p, left) in a.terms() {
            for (d, r, right) in b.terms() {
                let coefficient = Rational::from(c * d);
                let power = p.saturating_add(r);
                product.add_term((power, left != right), &coefficient);
                if left && right {
                    product.add_term((power.saturating_add(2), false), &-coefficient);
                }
            }
        }
        product
    }
}

impl RationalAlgebra for HyperbolicRing {
    fn rational(&self, q: &Rational) -> Hyperbolic {
        Hyperbolic::term(q.clone(), 0, false)
    }
    fn scale(&self, a: &Hyperbolic, q: &Rational) -> Hyperbolic {
        let mut result = Hyperbolic::default();
        for (&key, c) in &a.terms {
            result.add_term(key, &Rational::from(c * q));
        }
        result
    }
    /// Only nonzero constants are inverted: cosh z is not an element.
    fn reciprocal(&self, a: &Hyperbolic) -> Option<Hyperbolic> {
        let q = self.as_rational(a).filter(|q| !q.is_zero())?;
        Some(self.rational(&q.recip()))
    }
    fn as_rational(&self, a: &Hyperbolic) -> Option<Rational> {
        if a.terms.is_empty() {
            return Some(Rational::new());
        }
        let constant = a.terms.get(&(0, false))?;
        (a.terms.len() == 1).then(|| constant.clone())
    }
}

impl fmt::Display for Hyperbolic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.terms.is_empty() {
            return write!(f, "0");
        }
        for (index, (c, p, tanh)) in self.terms().enumerate() {
            let negative = c.is_negative();
            match (index, negative) {
                (0, true) => write!(f, "-")?,
                (0, false) => {}
                (_, true) => write!(f, " - ")?,
                (_, false) => write!(f, " + ")?,
            }
            let mut factors = Vec::new();
            let size = Rational::from(c.abs_ref());
            if size != 1 || (p == 0 && !tanh) {
                factors.push(size.to_string());
            }
            match p {
                0 => {}
                1 => factors.push("sech".to_owned()),
                _ => factors.push(format!("sech^{p}")),
            }
            if tanh {
                factors.push("tanh".to_owned());
            }
            write!(f, "{}", factors.join(" "))?;
        }
        Ok(())
    }
}
