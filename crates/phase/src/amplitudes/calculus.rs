//! Derivatives, conjugation, and the split at resonance.

use super::words::{Word, exponents, unit};
use super::{AmplitudeElement, Amplitudes, Multiples, Scalars};
use lindstedt_algebra::{AmplitudeAlgebra, PhaseError, Ring, Split};
use rug::{Integer, Rational};

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
        self.unknowns.len()
    }
    fn forces(&self) -> usize {
        self.rates.len() - self.amplitudes
    }
    fn frequency_squared(&self, j: usize) -> Self::Element {
        let (e, denominator) = self.unknowns[j].square.clone();
        self.single(0, [e, self.scalars.zero()], denominator, true)
    }
    fn force_rate(&self, l: usize) -> Self::Element {
        let Some(rate) = self.rates.get(self.amplitudes + l) else { return self.zero() };
        let (e, denominator) = self.value(rate);
        self.single(0, [e, self.scalars.zero()], denominator, true)
    }
    fn amplitude(&self, j: usize) -> Self::Element {
        if j < self.amplitudes { self.monomial(unit(2 * j), false) } else { self.zero() }
    }
    fn conjugate(&self, f: &Self::Element) -> Self::Element {
        self.conjugated(f)
    }
    fn twice_real(&self, f: &Self::Element) -> Self::Element {
        self.with_conjugate(f)
    }
    fn by_amplitude(&self, f: &Self::Element, j: usize) -> Self::Element {
        if j >= self.amplitudes {
            return self.zero();
        }
        let exponent = |word: Word| exponents(word, 2 * j + 1).0[2 * j];
        let mut slope = self.weighted(f, false, |word| Rational::from(exponent(word)));
        // The order of the words stays.
        slope.terms.iter_mut().for_each(|(word, _)| *word -= unit(2 * j));
        slope.real &= slope.terms.is_empty();
        slope
    }
    fn by_force(&self, f: &Self::Element, l: usize) -> Self::Element {
        let place = 2 * self.amplitudes + l;
        self.weighted(f, true, |word| Rational::from(exponents(word, place + 1).0[place]))
    }
    fn by_time(&self, f: &Self::Element) -> Self::Element {
        let rates = f.terms.iter().map(|(word, _)| self.value(&self.eigenvalue(*word)));
        self.times_each(f, true, rates.collect())
    }
    fn split(&self, j: usize, g: &Self::Element) -> Result<Split<Self>, PhaseError> {
        let resonant = self.filtered(g, |word| self.resonance(j, word) == Some(true));
        // 1/(2 i nu) = -i/(2 nu).
        let half = Rational::from((-1, 2));
        let mut inverse = self.scalars.fraction(&half);
        if let Some((word, _)) = resonant.terms.first() {
            let nu = self.value(&self.eigenvalue(*word));
            let one_over = self.scalars.inverse(&nu.0, &nu.1);
            let one_over = one_over.ok_or_else(|| self.undecided(*word))?;
            inverse = self.product_of(&one_over, &inverse);
        }
        let flow = self.times_each(&resonant, true, vec![inverse; resonant.terms.len()]);
        let mut rest = self.filtered(g, |word| self.resonance(j, word).is_none());
        rest.real = g.real;
        let divisors: Vec<_> =
            rest.terms.iter().map(|(word, _)| self.divisor(j, *word)).collect::<Result<_, _>>()?;
        let nearest = divisors.iter().zip(&rest.terms).filter_map(|(d, (word, _))| {
            let size = d.size.clone()?;
            Some((size.clone().abs(), *word, size))
        });
        let nearest = nearest
            .min_by(|(a, ..), (b, ..)| a.cmp(b))
            .map(|(_, word, size)| (self.harmonic(&exponents(word, self.phases()).0), size));
        let inverses = divisors.into_iter().map(|d| d.inverse).collect();
        let response = self.times_each(&rest, false, inverses);
        Ok(Split { flow, response, nearest })
    }
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool {
        f.terms.iter().all(|(word, _)| self.resonance(j, *word).is_none())
    }
}

/// 1/(nu^2 - lambda^2), and (nu^2 - lambda^2)/nu^2 where it is a number.
struct Divisor<E> {
    inverse: (E, Integer),
    size: Option<Rational>,
}

impl<S: Scalars> Amplitudes<S> {
    /// Whether lambda = nu_j (true) or -nu_j (false); nothing where it is neither.
    fn resonance(&self, j: usize, word: Word) -> Option<bool> {
        let (lambda, nu) = (self.eigenvalue(word), self.unknowns[j].rate.as_ref()?);
        if lambda == *nu {
            return Some(true);
        }
        lambda.iter().zip(nu).all(|(a, b)| *a == -b).then_some(false)
    }

    fn undecided(&self, word: Word) -> PhaseError {
        let harmonic = self.harmonic(&exponents(word, self.phases()).0);
        PhaseError::Undecided { harmonic }
    }

    fn divisor(&self, j: usize, word: Word) -> Result<Divisor<S::Element>, PhaseError> {
        let (lambda, unknown) = (self.eigenvalue(word), &self.unknowns[j]);
        let rational = self.rational_rate(&lambda).zip(unknown.rational.as_ref());
        if let Some((lambda, square)) = rational {
            let divisor = square - lambda.square();
            let size = Some(Rational::from(&divisor / square));
            return Ok(Divisor { inverse: self.scalars.fraction(&divisor.recip()), size });
        }
        let undecided = || self.undecided(word);
        let inverse = |(e, d): &(S::Element, Integer)| self.scalars.inverse(e, d);
        let divisor = match &unknown.rate {
            // (nu - lambda)(nu + lambda), whose factors are linear in the generators.
            Some(nu) => {
                let sum = |sign: i64| -> Multiples {
                    nu.iter().zip(&lambda).map(|(a, b)| a + sign * b).collect()
                };
                [sum(-1), sum(1)].map(|factor| self.value(&factor))
            }
            None => {
                let value = self.value(&lambda);
                let (square, below) = self.product_of(&value, &value);
                let (own, d) = &unknown.square;
                let mut gap = self.scalars.times(&self.scalars.neg(&square), d);
                self.scalars.add(&mut gap, &self.scalars.times(own, &below));
                [(gap, below * d), self.scalars.fraction(&Rational::from(1))]
            }
        };
        let [a, b] = divisor.each_ref().map(inverse);
        let whole = self.product_of(&divisor[0], &divisor[1]);
        let size = self.scalars.middle(&whole.0, &whole.1);
        let own = self.scalars.middle(&unknown.square.0, &unknown.square.1);
        let inverse = a.zip(b).map(|(a, b)| self.product_of(&a, &b)).ok_or_else(undecided)?;
        Ok(Divisor { inverse, size: size.zip(own).map(|(size, own)| size / own) })
    }
}
