//! Frequencies that are formulas: parameters as symbols with inverses, and constant phases W = e^{i theta}.
//!
//! What a delay turns a phase by, e^{-i nu T}, is a monomial 1/W, where cosine and sine of one angle would have to be
//! reduced by their relation in every product. The one divisor of a linear equation with a harmonic force is a symbol,
//! too: D = 1/(nu^2 - Omega^2), for a symbol Omega, with Omega^2 = nu^2 - 1/D, so that
//!
//!   nu^i Omega^j D^k, j = 0 or 1, i and k of either sign,
//!
//! are a basis and elements stay canonical.

use super::words::{DIGITS, Word};
use super::{AmplitudeElement, Amplitudes, Late, Rates, Scalars};
use lindstedt_algebra::Ring;
use std::sync::atomic::Ordering;

/// D = 1/(nu^2 - Omega^2).
#[derive(Clone, Debug)]
pub(super) struct Divided<E> {
    /// The position of Omega among the exponents.
    omega: usize,
    /// nu^2 - 1/D.
    square: AmplitudeElement<E>,
}

impl<S: Scalars> Amplitudes<S> {
    /// The symbols and constant phases of an algebra of one unknown and one force (or none), whose rates
    /// [`Self::with_rates`] gives; nothing for more symbols and phases than words hold.
    ///
    /// ```
    /// use lindstedt_algebra::{AmplitudeAlgebra, RationalAlgebra, Ring};
    /// use lindstedt_phase::amplitudes::{Amplitudes, scalars::Integers};
    /// let symbols = Amplitudes::of_formulas(Integers, &["alpha", "omega", "D"], 1).ok_or("room")?;
    /// let [alpha, omega] = ["alpha", "omega"].map(|name| symbols.symbol(name));
    /// let (alpha, omega) = alpha.zip(omega).ok_or("symbols")?;
    /// let algebra = symbols.with_rates(&alpha, Some(&omega)).with_divisor("omega", "D").ok_or("D")?;
    /// // z' = i alpha z, and D (alpha^2 - omega^2) = 1.
    /// let z = algebra.amplitude(0);
    /// let square = algebra.neg(&algebra.by_time(&algebra.by_time(&z)));
    /// assert_eq!(square, algebra.mul(&algebra.mul(&alpha, &alpha), &z));
    /// let difference = algebra.sub(&algebra.mul(&alpha, &alpha), &algebra.mul(&omega, &omega));
    /// assert_eq!(algebra.reciprocal(&difference), algebra.symbol("D"));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn of_formulas(scalars: S, symbols: &[&str], turns: usize) -> Option<Self> {
        let algebra = Self::turning(scalars, Rates::single(Vec::new()), symbols, turns)?;
        Some(Self { units: true, refuses: true, ..algebra })
    }

    /// The algebra with the rates of the amplitude and the force: formulas of which no combination but nu itself is taken
    /// to meet nu.
    #[must_use]
    pub fn with_rates(
        mut self,
        frequency: &AmplitudeElement<S::Element>,
        force: Option<&AmplitudeElement<S::Element>>,
    ) -> Self {
        self.generators = [Some(frequency), force].into_iter().flatten().cloned().collect();
        let all = 0..=self.generators.len();
        // Without a force its rate is 0.
        self.rates =
            [1, 2].map(|rate| all.clone().map(|k| i128::from(k == rate)).collect()).to_vec();
        self.unknowns = self.of_own_rates();
        self
    }

    /// The algebra whose only generator is a symbol; nothing without that symbol.
    #[must_use]
    pub fn with_unit(mut self, name: &str) -> Option<Self> {
        self.generators = vec![self.symbol(name)?];
        self.unknowns = self.of_own_rates();
        Some(self)
    }

    /// The algebra whose symbols have inverses.
    #[must_use]
    pub fn with_inverses(self) -> Self {
        Self { units: true, ..self }
    }

    /// The algebra that divides by nu^2 - Omega^2: the force's rate is the symbol `omega`, and `inverse` becomes the
    /// symbol D. Nothing where nu contains one of them or is no product.
    #[must_use]
    pub fn with_divisor(self, omega: &str, inverse: &str) -> Option<Self> {
        let place = |name: &str| Some(self.phases() + self.position(name)?);
        let [omega, inverse] = [place(omega)?, place(inverse)?];
        let unit = self.layout.unit(omega);
        let [frequency, force] = &self.generators[..] else { return None };
        let (nu, _) = frequency.terms.first().filter(|_| frequency.terms.len() == 1)?;
        let (digits, rest) = self.layout.exponents(*nu, DIGITS);
        if rest != 0
            || digits[omega] != 0
            || digits[inverse] != 0
            || *force != self.monomial(unit, true)
        {
            return None;
        }
        let inverse = self.layout.unit(inverse);
        let square = self.sub(&self.mul(frequency, frequency), &self.monomial(-inverse, true));
        Some(Self { divided: Some(Divided { omega, square }), ..self })
    }

    /// W_j = e^{i theta_j} to a power; nothing beyond the phases or the exponents that words hold.
    pub fn constant_phase(&self, j: usize, power: i32) -> Option<AmplitudeElement<S::Element>> {
        let fits = power.checked_abs().is_some_and(|n| n <= self.layout.largest());
        let word = self.layout.unit(self.moving() + j) * Word::from(fits.then_some(power)?);
        (j < self.turns).then(|| self.monomial(word, word == 0))
    }

    /// The algebra with delays given as elements: T, and the factors e^{-i rate T} of the amplitudes and the forces.
    #[must_use]
    pub fn with_late(mut self, delays: Vec<Late<S::Element>>) -> Self {
        self.delays = delays;
        self
    }

    /// The inverse of the word of a constant, if it has one.
    pub(super) fn inverse_of(&self, word: Word) -> Option<Word> {
        if word == 0 {
            return Some(0);
        }
        let (digits, _) = self.layout.exponents(word, DIGITS.min(self.exponents()));
        let omega = self.divided.as_ref().map(|divided| divided.omega);
        let still = digits[..self.moving()].iter().all(|e| *e == 0);
        let invertible = self.units && omega.is_none_or(|omega| digits[omega] == 0);
        (still && invertible).then_some(-word)
    }

    /// Omega^2 = nu^2 - 1/D put in.
    pub(super) fn reduced(&self, f: AmplitudeElement<S::Element>) -> AmplitudeElement<S::Element> {
        let Some(Divided { omega, square }) = &self.divided else { return f };
        let pairs = |word: Word| self.layout.exponent(word, *omega).div_euclid(2);
        let highest = f.terms.iter().map(|(word, _)| pairs(*word)).max().unwrap_or(0);
        if highest <= 0 {
            return f;
        }
        // Horner's rule in Omega^2.
        let pair = 2 * self.layout.unit(*omega);
        let mut sum = self.zero();
        for k in (0..=highest).rev() {
            let mut part = f.clone();
            part.terms.retain(|(word, _)| pairs(*word) == k);
            part.terms.iter_mut().for_each(|(word, _)| *word -= Word::from(k) * pair);
            let part = self.canonical(part.denominator, part.terms, f.real);
            sum = self.total(self.mul(&sum, square), &part, f.real);
        }
        sum
    }

    /// Whether exponents up to these cannot be added; noted.
    pub(super) fn overflows(&self, a: i32, b: i32) -> bool {
        let beyond = i64::from(a) + i64::from(b) > i64::from(self.layout.largest());
        if beyond {
            self.overflow.store(true, Ordering::Relaxed);
        }
        beyond
    }
}
