//! Derivatives, conjugation, and the split at resonance.

use super::words::{Word, exponents, unit};
use super::{AmplitudeElement, Amplitudes, Scalars};
use lindstedt_algebra::{AmplitudeAlgebra, PhaseError, RationalAlgebra, Ring, Split};
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
        self.squares.len()
    }
    fn frequency_squared(&self, j: usize) -> Rational {
        self.squares[j].clone()
    }
    fn force_rate(&self) -> Self::Element {
        let omega = self.rates.last().copied().unwrap_or(0);
        self.rational(&Rational::from((omega, self.common)))
    }
    fn amplitude(&self, j: usize) -> Self::Element {
        if j + 1 < self.rates.len() { self.monomial(unit(2 * j), false) } else { self.zero() }
    }
    fn conjugate(&self, f: &Self::Element) -> Self::Element {
        self.conjugated(f)
    }
    fn twice_real(&self, f: &Self::Element) -> Self::Element {
        self.with_conjugate(f)
    }
    fn by_amplitude(&self, f: &Self::Element, j: usize) -> Self::Element {
        if j + 1 >= self.rates.len() {
            return self.zero();
        }
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
        let resonance = self.square(j);
        let square = |n: i64| i128::from(n) * i128::from(n);
        let is_resonant = |word: Word| resonance == Some(square(self.eigenvalue(word)));
        // nu_j^2 - lambda^2.
        let divisor = |word: Word| {
            let lambda = Rational::from((square(self.eigenvalue(word)), square(self.common)));
            &self.squares[j] - lambda
        };
        let resonant = self.filtered(g, |word| self.eigenvalue(word) > 0 && is_resonant(word));
        // 1/(2 i nu) = -i/(2 nu).
        let half = |word| Rational::from((-self.common, 2 * self.eigenvalue(word)));
        let flow = self.weighted(&resonant, true, half);
        let mut rest = self.filtered(g, |word| !is_resonant(word));
        rest.real = g.real;
        let response = self.weighted(&rest, false, |word| divisor(word).recip());
        let gap = |(word, _): &(Word, _)| (divisor(*word).abs(), *word);
        let nearest = rest.terms.iter().map(gap).min_by(|(a, _), (b, _)| a.cmp(b));
        let nearest = nearest.map(|(_, word)| {
            let size = divisor(word) / &self.squares[j];
            (self.harmonic(&exponents(word, self.phases()).0), size)
        });
        Ok(Split { flow, response, nearest })
    }
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool {
        let resonance = self.square(j);
        let square = |word| i128::from(self.eigenvalue(word)).pow(2);
        f.terms.iter().all(|(word, _)| resonance != Some(square(*word)))
    }
}
