//! Quotients of polynomials in named parameters, some of them cosine and sine of one angle.
//!
//! Elements n/d with n, d in a [`ParameterField`]; d = 1 wherever that field can divide (products
//! of parameters, linear forms). Nothing else is cancelled, so that n/d is not unique; equality is
//! decided exactly by n_1 d_2 = n_2 d_1, for the field has no zero divisors.

use crate::PolynomialRing;
use crate::parameters::{ParameterField, ParameterFraction};
use crate::print::{Print, Style};
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;

/// n/d, d not zero.
#[derive(Clone, Debug)]
pub struct Quotient {
    /// n.
    pub numerator: ParameterFraction,
    /// d.
    pub denominator: ParameterFraction,
}

/// The field of quotients.
#[derive(Clone, Debug, Default)]
pub struct Quotients {
    /// The parameters and the pairs (cosine, sine).
    pub field: ParameterField,
}

impl Quotients {
    /// The field with these parameters; `pairs` names cosines and sines among them (unknown names
    /// make no pair).
    #[must_use]
    pub fn new(names: &[&str], pairs: &[(&str, &str)]) -> Self {
        let ring =
            PolynomialRing { parameters: names.iter().map(|name| (*name).to_owned()).collect() };
        let plain = ParameterField { ring, ..ParameterField::default() };
        let position =
            |&(cos, sin): &(&str, &str)| Some((plain.position(cos)?, plain.position(sin)?));
        let pairs = pairs.iter().filter_map(position).collect();
        Self { field: ParameterField { pairs, ..plain } }
    }

    /// A parameter by its name; zero for a name that is none.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Quotient {
        let found = self.field.position(name).map(|index| self.field.parameter(index));
        self.whole(found.unwrap_or_else(|| self.field.zero()))
    }

    /// n/1.
    #[must_use]
    pub fn whole(&self, numerator: ParameterFraction) -> Quotient {
        Quotient { numerator, denominator: self.field.one() }
    }

    /// A rational number.
    #[must_use]
    pub fn rational(&self, q: &Rational) -> Quotient {
        self.whole(self.field.rational(q))
    }

    /// An integer.
    #[must_use]
    pub fn integer(&self, n: i64) -> Quotient {
        self.rational(&Rational::from(n))
    }

    /// Whether a = 0.
    #[must_use]
    pub fn is_zero(&self, a: &Quotient) -> bool {
        self.field.is_zero(&a.numerator)
    }

    /// a + b.
    #[must_use]
    pub fn add(&self, a: &Quotient, b: &Quotient) -> Quotient {
        let k = &self.field;
        if a.denominator == b.denominator {
            let numerator = k.add(&a.numerator, &b.numerator);
            return Quotient { numerator, denominator: a.denominator.clone() };
        }
        let left = k.mul(&a.numerator, &b.denominator);
        let right = k.mul(&b.numerator, &a.denominator);
        Quotient {
            numerator: k.add(&left, &right),
            denominator: k.mul(&a.denominator, &b.denominator),
        }
    }

    /// -a.
    #[must_use]
    pub fn neg(&self, a: &Quotient) -> Quotient {
        Quotient { numerator: self.field.neg(&a.numerator), denominator: a.denominator.clone() }
    }

    /// a - b.
    #[must_use]
    pub fn sub(&self, a: &Quotient, b: &Quotient) -> Quotient {
        self.add(a, &self.neg(b))
    }

    /// a b.
    #[must_use]
    pub fn mul(&self, a: &Quotient, b: &Quotient) -> Quotient {
        let k = &self.field;
        let (mut n, mut d) = (a.numerator.clone(), a.denominator.clone());
        // A denominator that is the other numerator cancels as a whole.
        if b.numerator == d {
            d = b.denominator.clone();
        } else if b.denominator == n {
            n = b.numerator.clone();
        } else {
            n = k.mul(&n, &b.numerator);
            d = k.mul(&d, &b.denominator);
        }
        Quotient { numerator: n, denominator: d }
    }

    /// The product of all factors.
    #[must_use]
    pub fn product(&self, factors: &[&Quotient]) -> Quotient {
        factors.iter().fold(self.integer(1), |product, factor| self.mul(&product, factor))
    }

    /// The sum of all terms.
    #[must_use]
    pub fn sum(&self, terms: &[&Quotient]) -> Quotient {
        terms.iter().fold(self.integer(0), |sum, term| self.add(&sum, term))
    }

    /// 1/a; nothing for a = 0.
    #[must_use]
    pub fn inverse(&self, a: &Quotient) -> Option<Quotient> {
        if self.is_zero(a) {
            return None;
        }
        Some(match self.field.reciprocal(&a.numerator) {
            Some(inverse) => self.whole(self.field.mul(&inverse, &a.denominator)),
            None => Quotient { numerator: a.denominator.clone(), denominator: a.numerator.clone() },
        })
    }

    /// a/b; nothing for b = 0.
    #[must_use]
    pub fn div(&self, a: &Quotient, b: &Quotient) -> Option<Quotient> {
        Some(self.mul(a, &self.inverse(b)?))
    }

    /// Whether a = b, exactly.
    #[must_use]
    pub fn equal(&self, a: &Quotient, b: &Quotient) -> bool {
        self.is_zero(&self.sub(a, b))
    }

    /// The image under the homomorphism that sends parameter i to `image(i)`; nothing where a
    /// denominator becomes zero.
    #[must_use]
    pub fn evaluate<R: RationalAlgebra>(
        &self,
        target: &R,
        a: &Quotient,
        image: &dyn Fn(u16) -> R::Element,
    ) -> Option<R::Element> {
        let numerator = self.field.evaluate(target, &a.numerator, image)?;
        let denominator = self.field.evaluate(target, &a.denominator, image)?;
        Some(target.mul(&numerator, &target.reciprocal(&denominator)?))
    }

    /// As one line of text.
    #[must_use]
    pub fn print(&self, a: &Quotient) -> String {
        let numerator = self.field.print(&a.numerator, Style::Text);
        if a.denominator == self.field.one() {
            return numerator;
        }
        format!("({numerator})/({})", self.field.print(&a.denominator, Style::Text))
    }
}
