//! Derivatives, conjugation, and the split at resonance.

use super::words::{Word, exponents, unit};
use super::{AmplitudeElement, Amplitudes, Scalars};
use lindstedt_algebra::{AmplitudeAlgebra, PhaseError, RationalAlgebra, Split};
use rug::Rational;

impl<S: Scalars> Amplitudes<S> {
    fn conjugated(&self, f: &AmplitudeElement<S::Element>) -> AmplitudeElement<S::Element> {
        let mut terms = self.mirror(&f.terms);
        terms.sort_unstable_by_key(|(word, _)| *word);
        AmplitudeElement { denominator: f.denominator.clone(), terms, real: f.real }
    }

    /// f + conj f.
    pub(super) fn with_conjugate(
        &self,
        f: &AmplitudeElement<S::Element>,
    ) -> AmplitudeElement<S::Element> {
        self.total(f, &self.conjugated(f), true)
    }

    /// The terms whose words are kept.
    fn filtered(
        &self,
        f: &AmplitudeElement<S::Element>,
        keep: impl Fn(Word) -> bool,
    ) -> AmplitudeElement<S::Element> {
        let terms = f.terms.iter().filter(|(word, _)| keep(*word)).cloned().collect();
        self.canonical(f.denominator.clone(), terms, false)
    }
}

impl<S: Scalars> AmplitudeAlgebra for Amplitudes<S> {
    fn unknowns(&self) -> usize {
        self.rates.len() - 1
    }
    fn frequency(&self, j: usize) -> Rational {
        Rational::from((self.rates[j], self.common))
    }
    fn force_rate(&self) -> Self::Element {
        let omega = self.rates.last().copied().unwrap_or(0);
        self.rational(&Rational::from((omega, self.common)))
    }
    fn amplitude(&self, j: usize) -> Self::Element {
        self.monomial(unit(2 * j), false)
    }
    fn conjugate(&self, f: &Self::Element) -> Self::Element {
        self.conjugated(f)
    }
    fn twice_real(&self, f: &Self::Element) -> Self::Element {
        self.with_conjugate(f)
    }
    fn by_amplitude(&self, f: &Self::Element, j: usize) -> Self::Element {
        let exponent = |word: Word| exponents(word, 2 * j + 1).0[2 * j];
        let mut slope = self.weighted(f, false, |word| Rational::from(exponent(word)));
        // The order of the words stays.
        slope.terms.iter_mut().for_each(|(word, _)| *word -= unit(2 * j));
        slope.real &= slope.terms.is_empty();
        slope
    }
    fn by_force(&self, f: &Self::Element) -> Self::Element {
        let place = self.phases() - 1;
        self.weighted(f, true, |word| Rational::from(exponents(word, place + 1).0[place]))
    }
    fn by_time(&self, f: &Self::Element) -> Self::Element {
        self.weighted(f, true, |word| Rational::from((self.eigenvalue(word), self.common)))
    }
    fn split(&self, j: usize, g: &Self::Element) -> Result<Split<Self>, PhaseError> {
        let rate = self.rates[j];
        let square = |n: i64| i128::from(n) * i128::from(n);
        let divisor = |word: Word| {
            let gap = square(rate) - square(self.eigenvalue(word));
            Rational::from((gap, square(self.common)))
        };
        let resonant = self.filtered(g, |word| self.eigenvalue(word) == rate);
        // 1/(2 i nu) = -i/(2 nu).
        let flow = self.weighted(&resonant, true, |_| Rational::from((-self.common, 2 * rate)));
        let mut rest = self.filtered(g, |word| self.eigenvalue(word).abs() != rate);
        rest.real = g.real;
        let response = self.weighted(&rest, false, |word| divisor(word).recip());
        let gap = |(word, _): &(Word, _)| (divisor(*word).abs(), *word);
        let nearest = rest.terms.iter().map(gap).min_by(|(a, _), (b, _)| a.cmp(b));
        let nearest = nearest.map(|(_, word)| {
            let size = divisor(word) * square(self.common) / square(rate);
            (self.harmonic(&exponents(word, self.phases()).0), size)
        });
        Ok(Split { flow, response, nearest })
    }
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool {
        f.terms.iter().all(|(word, _)| self.eigenvalue(*word).abs() != self.rates[j])
    }
}
