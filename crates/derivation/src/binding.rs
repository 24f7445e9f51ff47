//! What the names of an equation mean in the rings of exact derivations.

use lindstedt_algebra::{RationalAlgebra, Rationals};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_expand::Binding;
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// The name of the formal function whose Taylor coefficients are the sums S_n.
pub const FORMAL: &str = "S";

/// Rational values given for parameters of the equation, and the formal sums.
pub(crate) struct Given<'a> {
    pub ring: &'a PolynomialRing,
    pub parameters: &'a BTreeMap<String, Exact>,
}

impl Given<'_> {
    /// The value of a parameter, where it is rational.
    pub fn value(&self, name: &str) -> Option<Rational> {
        self.parameters.get(name)?.as_rational().cloned()
    }
}

impl Binding<PolynomialRing> for Given<'_> {
    fn parameter(&self, name: &str) -> Option<Polynomial> {
        Some(self.ring.rational(&self.value(name)?))
    }
    fn formal(&self, name: &str, n: usize) -> Option<Polynomial> {
        let sum = Symbol::Sum(u16::try_from(n).ok()?);
        (name == FORMAL).then(|| self.ring.symbol(sum))
    }
}

impl Binding<Rationals> for Given<'_> {
    fn parameter(&self, name: &str) -> Option<Rational> {
        self.value(name)
    }
}
