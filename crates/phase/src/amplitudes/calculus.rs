//! Derivatives, conjugation, and the split at resonance.

use super::words::Word;
use super::{AmplitudeElement, Amplitudes, Multiples, Scalars};
use lindstedt_algebra::{
    AmplitudeAlgebra, LinearPart, LinearParts, NEAR_MISS, PhaseError, RationalAlgebra, Ring, Split,
};
use lindstedt_number::Whole;
use rug::Rational;
use rustc_hash::{FxHashMap, FxHashSet};

impl<S: Scalars> Amplitudes<S> {
    pub(super) fn conjugated(
        &self,
        f: &AmplitudeElement<S::Element>,
    ) -> AmplitudeElement<S::Element> {
        let mut terms = self.mirror(&f.terms);
        terms.sort_unstable_by_key(|(word, _)| *word);
        AmplitudeElement { denominator: f.denominator.clone(), terms, real: f.real }
    }

    /// f + conj f.
    pub(super) fn with_conjugate(
        &self,
        f: &AmplitudeElement<S::Element>,
    ) -> AmplitudeElement<S::Element> {
        self.total(self.conjugated(f), f, true)
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
        self.unknowns[j].square.clone()
    }
    fn force_rate(&self, l: usize) -> Self::Element {
        let Some(rate) = self.rates.get(self.amplitudes + l) else { return self.zero() };
        self.value(rate)
    }
    fn amplitude(&self, j: usize) -> Self::Element {
        if j < self.amplitudes {
            self.monomial(self.layout.unit(2 * j), false)
        } else {
            self.zero()
        }
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
        let exponent = |word: Word| self.layout.exponent(word, 2 * j);
        let mut slope = self.weighted(f, exponent);
        // The order of the words stays.
        slope.terms.iter_mut().for_each(|(word, _)| *word -= self.layout.unit(2 * j));
        slope.real &= slope.terms.is_empty();
        slope
    }
    fn along(&self, j: usize, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        if S::GATHERS && pairs.iter().all(|(_, g)| g.real) {
            return self.gathered_along(j, pairs);
        }
        let slopes: Vec<_> = pairs.iter().map(|(_, g)| self.by_amplitude(g, j)).collect();
        let pairs: Vec<_> = pairs.iter().zip(&slopes).map(|((f, _), slope)| (*f, slope)).collect();
        self.with_conjugate(&self.sum_of_products(&pairs))
    }
    fn linear_parts(&self, f: &Self::Element) -> Option<LinearParts<Self::Element>> {
        let places = 2 * self.amplitudes;
        let part = |unit: Word| {
            let own = self.layout.lowest(unit, places);
            let mut part = self.filtered(f, |word| self.layout.lowest(word, places) == own);
            part.terms.iter_mut().for_each(|(word, _)| *word -= unit);
            part
        };
        let of = |j: usize| [2 * j, 2 * j + 1].map(|place| part(self.layout.unit(place)));
        let (parts, rest): (Vec<_>, _) = ((0..self.amplitudes).map(of).collect(), part(0));
        let all = parts.iter().flatten().chain([&rest]);
        let found: usize = all.map(|part| part.terms.len()).sum();
        let rest = AmplitudeElement { real: f.real || rest.real, ..rest };
        (found == f.terms.len()).then_some((parts, rest))
    }
    fn by_force(&self, f: &Self::Element, l: usize) -> Self::Element {
        let place = 2 * self.amplitudes + l;
        let slope = self.weighted(f, |word| self.layout.exponent(word, place));
        AmplitudeElement { real: f.real, ..self.turned(&slope) }
    }
    fn by_time(&self, f: &Self::Element) -> Self::Element {
        let mut rate = |word| Ok(self.turned(&self.rate(word)));
        // There is no error.
        self.times_constants(f, f.real, &mut rate).unwrap_or_else(|_| self.zero())
    }
    fn shift(&self, f: &Self::Element, delay: usize) -> Option<Self::Element> {
        let mut turn = |word| self.turn(delay, word).ok_or_else(|| self.undecided(word));
        self.times_constants(f, f.real, &mut turn).ok()
    }
    fn delay(&self, delay: usize) -> Option<Self::Element> {
        Some(self.delays.get(delay)?.time.clone())
    }
    fn split(
        &self,
        j: usize,
        linear: &LinearPart<Self::Element>,
        g: &Self::Element,
    ) -> Result<Split<Self>, PhaseError> {
        let resonances = self.resonances(j, g);
        let of = |word| resonances.get(&self.layout.lowest(word, self.moving())).copied().flatten();
        let resonant = self.filtered(g, |word| of(word) == Some(true));
        let mut slope = |word| {
            let slope = self.slope(linear, word).ok_or_else(|| self.undecided(word))?;
            self.reciprocal(&slope).ok_or_else(|| self.refusal(word, &slope))
        };
        let flow = self.times_constants(&resonant, false, &mut slope)?;
        let mut rest = self.filtered(g, |word| of(word).is_none());
        rest.real = g.real;
        let free = linear.is_free(self);
        let mut nearest: Option<(Rational, Word, Rational)> = None;
        let mut inverse = |word| {
            let Divisor { inverse, size } = match free {
                true => self.divisor(j, word)?,
                false => self.characteristic(linear, word)?,
            };
            if let Some(size) = size {
                let least = size.clone().abs();
                if self.refuses && least < Rational::from(NEAR_MISS) {
                    let (free, forced) = self.single_harmonic(word);
                    return Err(PhaseError::NearMiss { free, forced, size });
                }
                if nearest.as_ref().is_none_or(|(known, ..)| least < *known) {
                    nearest = Some((least, word, size));
                }
            }
            Ok(inverse)
        };
        let response = self.times_constants(&rest, g.real, &mut inverse)?;
        let nearest = nearest.map(|(_, word, size)| (self.harmonic_of(word), size));
        Ok(Split { flow, response, nearest })
    }
    fn is_off_resonance(&self, j: usize, f: &Self::Element) -> bool {
        self.resonances(j, f).values().all(Option::is_none)
    }
}

/// 1/L(i lambda) as a constant; where L(i lambda) = nu^2 - lambda^2 is a number, its ratio to nu^2.
struct Divisor<E> {
    inverse: AmplitudeElement<E>,
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

    /// [`Self::resonance`] of the terms by the exponents that turn.
    fn resonances(
        &self,
        j: usize,
        f: &AmplitudeElement<S::Element>,
    ) -> FxHashMap<Word, Option<bool>> {
        let mut known = FxHashMap::default();
        for (word, _) in &f.terms {
            let digits = self.layout.lowest(*word, self.moving());
            known.entry(digits).or_insert_with(|| self.resonance(j, *word));
        }
        known
    }

    fn harmonic_of(&self, word: Word) -> Vec<i32> {
        self.harmonic(&self.layout.exponents(word, self.phases()).0)
    }

    /// k and m of one unknown and one force.
    fn single_harmonic(&self, word: Word) -> (i32, i32) {
        match self.harmonic_of(word)[..] {
            [free, forced, ..] => (free, forced),
            _ => (0, 0),
        }
    }

    fn undecided(&self, word: Word) -> PhaseError {
        PhaseError::Undecided { harmonic: self.harmonic_of(word) }
    }

    /// What a divisor that has no inverse says.
    fn refusal(&self, word: Word, divisor: &AmplitudeElement<S::Element>) -> PhaseError {
        let (free, forced) = self.single_harmonic(word);
        match self.refuses {
            false => self.undecided(word),
            true if self.is_zero(divisor) => PhaseError::Resonance { free, forced },
            true => PhaseError::Indivisible { free, forced },
        }
    }

    /// i f.
    pub(super) fn turned(&self, f: &AmplitudeElement<S::Element>) -> AmplitudeElement<S::Element> {
        let mut turned = f.clone();
        for (_, parts) in &mut turned.terms {
            parts.swap(0, 1);
            parts[0] = self.scalars.neg(&parts[0]);
        }
        turned.real = f.terms.is_empty();
        turned
    }

    /// lambda.
    fn rate(&self, word: Word) -> AmplitudeElement<S::Element> {
        self.value(&self.eigenvalue(word))
    }

    /// e^{-i lambda T}.
    fn turn(&self, delay: usize, word: Word) -> Option<AmplitudeElement<S::Element>> {
        let late = self.delays.get(delay)?;
        let mut product = self.one();
        for (turn, k) in late.turns.iter().zip(self.harmonic_of(word)) {
            let turn = if k < 0 { &self.conjugated(turn) } else { turn };
            for _ in 0..k.unsigned_abs() {
                product = self.mul(&product, turn);
            }
        }
        Some(product)
    }

    /// L(i lambda) = stiffness - lambda^2 + i lambda damping + sum_j (b_j + i lambda c_j) e^{-i lambda T_j}.
    fn characteristic(
        &self,
        linear: &LinearPart<AmplitudeElement<S::Element>>,
        word: Word,
    ) -> Result<Divisor<S::Element>, PhaseError> {
        let lambda = self.turned(&self.rate(word));
        let mut sum = linear.stiffness.clone();
        self.add_assign(
            &mut sum,
            &self.sum_of_products(&[(&lambda, &lambda), (&linear.damping, &lambda)]),
        );
        for (delay, (b, c)) in linear.delayed.iter().enumerate() {
            let turn = self.turn(delay, word).ok_or_else(|| self.undecided(word))?;
            let gain = self.add(b, &self.mul(c, &lambda));
            self.add_assign(&mut sum, &self.mul(&gain, &turn));
        }
        let inverse = self.reciprocal(&sum).ok_or_else(|| self.refusal(word, &sum))?;
        Ok(Divisor { inverse, size: None })
    }

    /// L'(i nu), L'(s) = 2 s + damping + sum_j (c_j - T_j (b_j + c_j s)) e^{-s T_j}.
    fn slope(
        &self,
        linear: &LinearPart<AmplitudeElement<S::Element>>,
        word: Word,
    ) -> Option<AmplitudeElement<S::Element>> {
        let root = self.turned(&self.rate(word));
        let mut sum = self.add(&linear.damping, &self.scale(&root, &Rational::from(2)));
        for (delay, (b, c)) in linear.delayed.iter().enumerate() {
            let late = &self.delays.get(delay)?.time;
            let gain = self.add(b, &self.mul(c, &root));
            let factor = self.sub(c, &self.mul(late, &gain));
            self.add_assign(&mut sum, &self.mul(&factor, &self.turn(delay, word)?));
        }
        Some(sum)
    }

    /// nu_j^2 - lambda^2, where nu_j is a frequency in its factors, which are linear in the generators.
    fn divisor(&self, j: usize, word: Word) -> Result<Divisor<S::Element>, PhaseError> {
        let (lambda, unknown) = (self.eigenvalue(word), &self.unknowns[j]);
        let rational = self.rational_rate(&lambda).zip(unknown.rational.as_ref());
        if let Some((lambda, square)) = rational {
            let divisor = square - lambda.square();
            let size = Some(Rational::from(&divisor / square));
            return Ok(Divisor { inverse: self.rational(&divisor.recip()), size });
        }
        let factors = match &unknown.rate {
            Some(nu) => [-1, 1].map(|sign: i128| {
                let sum: Multiples = nu.iter().zip(&lambda).map(|(a, b)| a + sign * b).collect();
                self.value(&sum)
            }),
            None => {
                let value = self.value(&lambda);
                [self.sub(&unknown.square, &self.mul(&value, &value)), self.one()]
            }
        };
        let divided = self.divided.as_ref().map(|_| self.mul(&factors[0], &factors[1]));
        if let Some(inverse) = divided.and_then(|product| self.reciprocal(&product)) {
            return Ok(Divisor { inverse, size: None });
        }
        let [a, b] = factors
            .each_ref()
            .map(|factor| self.reciprocal(factor).ok_or_else(|| self.refusal(word, factor)));
        let (a, b) = (a?, b?);
        let middle = |f: &AmplitudeElement<S::Element>| match &f.terms[..] {
            [(0, [re, _])] => self.scalars.middle(re, &f.denominator),
            _ => None,
        };
        let size = middle(&self.mul(&factors[0], &factors[1]));
        let size = size.zip(middle(&unknown.square)).map(|(size, own)| size / own);
        let ratio = || match (&unknown.rate.as_ref()?[..], &lambda[..]) {
            // Multiples of one symbol.
            ([0, nu], [0, lambda]) => Some(Rational::from((*lambda, *nu))),
            _ => None,
        };
        let size = size.or_else(|| Some(Rational::from(1) - ratio()?.square()));
        Ok(Divisor { inverse: self.mul(&a, &b), size })
    }

    /// The harmonics of f, of two opposite ones one, with a word of each. Where resonances are refused they increase, k > 0
    /// or k = 0 and m >= 0.
    fn harmonics_of(&self, f: &AmplitudeElement<S::Element>) -> Vec<(Vec<i32>, Word)> {
        let mut list: Vec<(Vec<i32>, Word)> = Vec::new();
        let (mut known, mut seen) = (FxHashSet::default(), FxHashSet::default());
        for (word, _) in &f.terms {
            let mut word = *word;
            if !seen.insert(self.layout.lowest(word, self.moving())) {
                continue;
            }
            let mut harmonic = self.harmonic_of(word);
            let opposite: Vec<i32> = harmonic.iter().map(|k| -k).collect();
            if known.contains(&opposite) || known.contains(&harmonic) {
                continue;
            }
            if self.refuses && harmonic < opposite {
                (word, harmonic) = (self.mirrored(word), opposite);
            }
            known.insert(harmonic.clone());
            list.push((harmonic, word));
        }
        if self.refuses {
            list.sort();
        }
        list
    }

    /// Every term times the constant of its harmonic, which is asked for once; that of the opposite harmonic is its
    /// conjugate.
    fn times_constants(
        &self,
        f: &AmplitudeElement<S::Element>,
        real: bool,
        constant: &mut dyn FnMut(Word) -> Result<AmplitudeElement<S::Element>, PhaseError>,
    ) -> Result<AmplitudeElement<S::Element>, PhaseError> {
        let scalars = &self.scalars;
        let mut constants = Vec::new();
        for (harmonic, word) in self.harmonics_of(f) {
            constants.push((harmonic, constant(word)?));
        }
        if constants.iter().any(|(_, c)| c.terms.len() > 1) {
            return Ok(self.times_sums(f, real, &constants));
        }
        let all = || constants.iter().map(|(_, c)| c);
        let largest = || all().map(|c| self.largest(c)).max().unwrap_or(0);
        let small = self.is_small(f) && all().all(|c| self.is_small(c));
        if !small && self.overflows(self.largest(f), largest()) {
            return Ok(self.zero());
        }
        let common = constants.iter().fold(Whole::ONE, |d, (_, c)| d.lcm(&c.denominator));
        let (mut factors, mut moved) = (FxHashMap::default(), false);
        for (harmonic, c) in constants {
            let n = common.divided(&c.denominator);
            let single = c.terms.into_iter().next();
            let (word, [x, y]) = single.unwrap_or_else(|| (0, [scalars.zero(), scalars.zero()]));
            let [x, y] =
                if n == Whole::ONE { [x, y] } else { [&x, &y].map(|e| scalars.times(e, &n)) };
            let minus = scalars.neg(&y);
            let opposite: Vec<i32> = harmonic.iter().map(|k| -k).collect();
            moved |= word != 0;
            let mirrored = if word == 0 { 0 } else { self.mirrored(word) };
            factors.insert(opposite, (mirrored, [x.clone(), minus.clone(), y.clone()]));
            factors.insert(harmonic, (word, [x, y, minus]));
        }
        let mut by_digits = FxHashMap::default();
        for (word, _) in &f.terms {
            let factor = || factors.get(&self.harmonic_of(*word));
            by_digits.entry(self.layout.lowest(*word, self.moving())).or_insert_with(factor);
        }
        let term = |(word, [re, im]): &(Word, [S::Element; 2])| {
            let digits = self.layout.lowest(*word, self.moving());
            let (by, [x, y, minus]) = by_digits.get(&digits).copied().flatten()?;
            Some((word + by, [self.sum([(re, x), (im, minus)]), self.sum([(re, y), (im, x)])]))
        };
        let mut terms: Vec<_> = match f.real && real {
            true => {
                let above = |(word, _): &&(Word, _)| *word >= self.mirrored(*word);
                f.terms.iter().filter(above).filter_map(term).collect()
            }
            false => f.terms.iter().filter_map(term).collect(),
        };
        match f.real && real {
            true => self.complete(&mut terms),
            false if moved => terms.sort_unstable_by_key(|(word, _)| *word),
            false => {}
        }
        Ok(self.reduced(self.canonical(common.mul(&f.denominator), terms, real)))
    }

    /// Every term times the sum of its harmonic.
    fn times_sums(
        &self,
        f: &AmplitudeElement<S::Element>,
        real: bool,
        constants: &[(Vec<i32>, AmplitudeElement<S::Element>)],
    ) -> AmplitudeElement<S::Element> {
        let mut parts = Vec::new();
        for (harmonic, c) in constants {
            let opposite: Vec<i32> = harmonic.iter().map(|k| -k).collect();
            parts.push((self.filtered(f, |word| self.harmonic_of(word) == *harmonic), c.clone()));
            if opposite != *harmonic {
                let part = self.filtered(f, |word| self.harmonic_of(word) == opposite);
                parts.push((part, self.conjugated(c)));
            }
        }
        let pairs: Vec<_> = parts.iter().map(|(part, c)| (part, c)).collect();
        AmplitudeElement { real, ..self.sum_of_products(&pairs) }
    }
}
