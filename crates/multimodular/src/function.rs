//! x_n as integers over one denominator, and its coefficients in lowest terms.

use crate::denominator::{Denominator, over};
use crate::place::Place;
use lindstedt_phase::trigonometric::TrigonometricPolynomial;
use rug::{Integer, Rational};

/// A trigonometric polynomial over Q: numerators over a common denominator, which is known by its primes. What two
/// numbers have in common is then found by divisions, and only of what is asked for.
#[derive(Clone, Debug)]
pub struct Function {
    denominator: Denominator,
    terms: Vec<(Place, Integer)>,
}

/// One coefficient, in lowest terms and not zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fraction {
    /// k of cos k psi or sin k psi.
    pub harmonic: usize,
    /// Whether it belongs to the sine.
    pub sine: bool,
    /// With the sign.
    pub numerator: Integer,
    /// Positive.
    pub denominator: Integer,
}

impl Function {
    /// `terms` are coefficients of harmonics.
    pub(crate) fn new(denominator: Denominator, terms: Vec<(Place, Integer)>) -> Self {
        Self { denominator, terms }
    }

    /// The number of coefficients that do not vanish.
    #[must_use]
    pub fn terms(&self) -> usize {
        self.terms.iter().filter(|(_, c)| !c.is_zero()).count()
    }

    /// The bits of all numerators and of the denominator.
    #[must_use]
    pub fn bits(&self) -> u64 {
        let numerators = self.terms.iter().map(|(_, c)| u64::from(c.significant_bits()));
        numerators.sum::<u64>() + u64::from(self.denominator.number().significant_bits())
    }

    /// The value at zero.
    pub(crate) fn at_zero(&self) -> Rational {
        let cosines = self.terms.iter().filter(|(place, _)| matches!(place, Place::Cosine(_)));
        over(cosines.map(|(_, c)| c).sum(), &self.denominator.factors())
    }

    /// The denominator, and for every coefficient the harmonic, whether it belongs to the sine, and its numerator.
    pub fn numerators(&self) -> (&Integer, impl Iterator<Item = (usize, bool, &Integer)>) {
        let place = |(place, c)| match place {
            &Place::Cosine(k) => Some((k, false, c)),
            &Place::Sine(k) => Some((k, true, c)),
            Place::Squared | Place::Frequency | Place::Period => None,
        };
        let terms = self.terms.iter().map(|(place, c)| (place, c));
        (self.denominator.number(), terms.filter_map(place))
    }

    /// The coefficients by harmonics, a cosine before the sine.
    #[must_use]
    pub fn fractions(&self) -> Vec<Fraction> {
        self.scaled(|_| 1)
    }

    /// Those of f + f''.
    #[must_use]
    pub fn force(&self) -> Vec<Fraction> {
        self.scaled(|k| 1 - (k * k) as i64)
    }

    /// The number of terms of f + f''.
    #[must_use]
    pub fn force_terms(&self) -> usize {
        let acts = |(place, c): &&(Place, Integer)| place.harmonic() != Some(1) && !c.is_zero();
        self.terms.iter().filter(acts).count()
    }

    fn scaled(&self, factor: impl Fn(usize) -> i64) -> Vec<Fraction> {
        let fraction = |(place, c): &(Place, Integer)| {
            let (harmonic, sine) = match *place {
                Place::Cosine(k) => (k, false),
                Place::Sine(k) => (k, true),
                Place::Squared | Place::Frequency | Place::Period => return None,
            };
            let (numerator, denominator) =
                self.denominator.lowest(Integer::from(c * factor(harmonic)))?;
            Some(Fraction { harmonic, sine, numerator, denominator })
        };
        let mut list: Vec<Fraction> = self.terms.iter().filter_map(fraction).collect();
        list.sort_by_key(|f| (f.harmonic, f.sine));
        list
    }

    /// The same with rational coefficients.
    #[must_use]
    pub fn polynomial(&self) -> TrigonometricPolynomial<Rational> {
        let factors = self.denominator.factors();
        let mut f = TrigonometricPolynomial { cos: Vec::new(), sin: Vec::new() };
        for (place, c) in &self.terms {
            let (list, k) = match *place {
                Place::Cosine(k) => (&mut f.cos, k),
                Place::Sine(k) => (&mut f.sin, k),
                Place::Squared | Place::Frequency | Place::Period => continue,
            };
            list.resize_with(k, Rational::new);
            list.push(over(c.clone(), &factors));
        }
        f
    }
}
