//! Polynomials in complex amplitudes z_1, zbar_1, ..., z_M, zbar_M, in E = e^{i eta} and 1/E, and in named
//! symbols, with complex coefficients: what averaging with resonance computes with
//! ([`AmplitudeAlgebra`](lindstedt_algebra::AmplitudeAlgebra)).
//!
//! A monomial is one word ([`words`]), an element a list sorted by words with numerators over one common
//! denominator ([`scalars`]), reduced: canonical. The ratios of the frequencies are rational numbers, so
//! that the eigenvalue of every monomial under D_0, and with it every resonance, is decided exactly.
//!
//! A product costs one product of coefficients per pair of terms; of two real elements (which are equal to
//! their conjugates) half of that: the upper half of one of them times the other, and the conjugate.

mod calculus;
mod ring;
pub mod scalars;
pub mod words;

use lindstedt_algebra::Stop;
use rug::{Integer, Rational};
use scalars::Scalars;
use std::sync::atomic::{AtomicBool, Ordering};
use words::{DIGITS, Word};

/// A word with the real and the imaginary numerator of its coefficient.
type Term<E> = (Word, [E; 2]);

/// A polynomial; it means nothing without its [`Amplitudes`].
#[derive(Clone, Debug)]
pub struct AmplitudeElement<E> {
    /// The common denominator, positive.
    denominator: Integer,
    /// Words with real and imaginary numerators, sorted, none of which vanishes.
    terms: Vec<Term<E>>,
    /// Whether it is known to be its own conjugate; only a hint.
    real: bool,
}

impl<E: PartialEq> PartialEq for AmplitudeElement<E> {
    fn eq(&self, other: &Self) -> bool {
        self.denominator == other.denominator && self.terms == other.terms
    }
}

/// A term with a rational coefficient re + i im.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeTerm {
    /// The exponents of z_1, zbar_1, ..., z_M, zbar_M, E and the symbols.
    pub exponents: Vec<i32>,
    /// The real part.
    pub re: Rational,
    /// The imaginary part.
    pub im: Rational,
}

/// The algebra over numerators S, with the frequencies nu_j > 0 of the z_j, the frequency Omega of the force
/// (0 where there is none), and named symbols, for parameters.
///
/// At most sixteen exponents (2 M + 1 + symbols) of at most 127 each; beyond, products are not formed and
/// [`Self::overflowed`] says so.
#[derive(Debug)]
pub struct Amplitudes<S> {
    scalars: S,
    symbols: Vec<String>,
    /// q nu_j of the amplitudes and q Omega with the common denominator q.
    rates: Vec<i64>,
    common: i64,
    /// nu_j^2 of the unknowns.
    squares: Vec<Rational>,
    /// The force is e^{i step eta}.
    step: i32,
    stop: Stop,
    overflow: AtomicBool,
}

impl<S: Scalars> Amplitudes<S> {
    /// The algebra; nothing without an unknown, for frequencies that are not positive or too long, or for
    /// too many symbols.
    pub fn new(
        scalars: S,
        frequencies: &[Rational],
        force: &Rational,
        symbols: &[&str],
    ) -> Option<Self> {
        let positive = frequencies.iter().all(|nu| *nu > 0) && !frequencies.is_empty();
        if !positive || 2 * frequencies.len() + 1 + symbols.len() > DIGITS {
            return None;
        }
        let all = || frequencies.iter().chain([force]);
        let common = all().fold(Integer::from(1), |q, nu| q.lcm(nu.denom()));
        let rate = |nu: &Rational| Rational::from(nu * &common).numer().to_i32().map(i64::from);
        Some(Self {
            squares: frequencies.iter().map(|nu| nu.clone().square()).collect(),
            rates: all().map(rate).collect::<Option<_>>()?,
            common: i64::from(common.to_i32()?),
            step: 1,
            scalars,
            symbols: symbols.iter().map(|name| (*name).to_owned()).collect(),
            stop: Stop::default(),
            overflow: AtomicBool::new(false),
        })
    }

    /// The algebra whose products are broken off when `stop` says so.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// The algebra for more unknowns than there are amplitudes, with nu_j^2 of all of them: those behind have no
    /// amplitude of their own, and nu_j need not be rational.
    #[must_use]
    pub fn with_unknowns(self, squares: Vec<Rational>) -> Self {
        Self { squares, ..self }
    }

    /// The algebra in which eta has a whole part of the force's frequency: cos m eta of the equation is the
    /// harmonic m times `step` here.
    #[must_use]
    pub fn with_step(self, step: i32) -> Self {
        Self { step, ..self }
    }

    /// (cos m eta, sin m eta); nothing for exponents that words do not hold.
    pub fn wave(&self, m: i32) -> Option<[AmplitudeElement<S::Element>; 2]> {
        let place = words::unit(self.phases() - 1);
        let fits = m.checked_abs().is_some_and(|m| m <= words::LARGEST);
        let power = self.monomial(place * Word::from(fits.then_some(m)?), false);
        let half = self.weighted(&power, false, |_| Rational::from((1, 2)));
        // sin = (E - 1/E)/(2 i).
        let turned = self.weighted(&power, true, |_| Rational::from((-1, 2)));
        Some([half, turned].map(|f| self.with_conjugate(&f)))
    }

    /// Whether an exponent beyond 127 was needed.
    pub fn overflowed(&self) -> bool {
        self.overflow.load(Ordering::Relaxed)
    }

    /// The names of the symbols.
    pub fn symbols(&self) -> &[String] {
        &self.symbols
    }

    /// A symbol by its name, if there is one.
    pub fn symbol(&self, name: &str) -> Option<AmplitudeElement<S::Element>> {
        let i = self.symbols.iter().position(|known| known == name)?;
        Some(self.monomial(words::unit(self.phases() + i), true))
    }

    /// An element e of S as a constant e/1.
    pub fn constant(&self, e: S::Element) -> AmplitudeElement<S::Element> {
        self.single(0, [e, self.scalars.zero()], Integer::from(1), true)
    }

    /// The terms with their coefficients, where those are rational.
    pub fn rational_terms(&self, f: &AmplitudeElement<S::Element>) -> Option<Vec<AmplitudeTerm>> {
        let n = self.phases() + self.symbols.len();
        let term = |(word, [re, im]): &Term<S::Element>| {
            Some(AmplitudeTerm {
                exponents: words::exponents(*word, n).0[..n].to_vec(),
                re: self.scalars.quotient(re, &f.denominator)?,
                im: self.scalars.quotient(im, &f.denominator)?,
            })
        };
        f.terms.iter().map(term).collect()
    }

    /// 2 M + 1: the exponents that D_0 and conjugation know.
    fn phases(&self) -> usize {
        2 * self.rates.len() - 1
    }

    /// q lambda.
    fn eigenvalue(&self, word: Word) -> i64 {
        let (digits, _) = words::exponents(word, self.phases());
        self.harmonic(&digits).iter().zip(&self.rates).map(|(k, rate)| i64::from(*k) * rate).sum()
    }

    /// q^2 nu_j^2, where it is whole: otherwise no eigenvalue is resonant.
    fn square(&self, j: usize) -> Option<i128> {
        let square = Rational::from(&self.squares[j] * Integer::from(self.common).square());
        square.is_integer().then(|| square.numer().to_i128()).flatten()
    }

    /// p_1 - q_1, ..., p_M - q_M, m.
    fn harmonic(&self, digits: &[i32; DIGITS]) -> Vec<i32> {
        let m = self.rates.len() - 1;
        (0..m).map(|j| digits[2 * j] - digits[2 * j + 1]).chain([digits[2 * m]]).collect()
    }

    /// The word of the conjugate.
    fn mirrored(&self, word: Word) -> Word {
        let n = self.phases();
        let (mut digits, rest) = words::exponents(word, n);
        for pair in digits[..n - 1].chunks_exact_mut(2) {
            pair.swap(0, 1);
        }
        digits[n - 1] = -digits[n - 1];
        words::pack(&digits[..n], rest)
    }

    fn single(
        &self,
        word: Word,
        coefficient: [S::Element; 2],
        denominator: Integer,
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        self.canonical(denominator, vec![(word, coefficient)], real)
    }

    fn monomial(&self, word: Word, real: bool) -> AmplitudeElement<S::Element> {
        let (one, denominator) = self.scalars.fraction(&Rational::from(1));
        self.single(word, [one, self.scalars.zero()], denominator, real)
    }

    /// Zeros left out, the denominator reduced. The words are sorted.
    fn canonical(
        &self,
        mut denominator: Integer,
        mut terms: Vec<Term<S::Element>>,
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        let scalars = &self.scalars;
        terms.retain(|(_, c)| !c.iter().all(|part| scalars.is_zero(part)));
        if terms.is_empty() {
            return AmplitudeElement { denominator: Integer::from(1), terms, real: true };
        }
        let mut content = denominator.clone();
        for part in terms.iter().flat_map(|(_, c)| c) {
            if content == 1 {
                break;
            }
            scalars.content(&mut content, part);
        }
        if content != 1 {
            denominator.div_exact_mut(&content);
            for part in terms.iter_mut().flat_map(|(_, c)| c) {
                scalars.divide(part, &content);
            }
        }
        AmplitudeElement { denominator, terms, real }
    }

    /// Every term with its coefficient times a rational number of its word, all of them over one
    /// denominator; nothing stays of a term whose factor is zero. `turn` multiplies by i.
    fn weighted(
        &self,
        f: &AmplitudeElement<S::Element>,
        turn: bool,
        factor: impl Fn(Word) -> Rational,
    ) -> AmplitudeElement<S::Element> {
        let factors: Vec<_> =
            f.terms.iter().map(|(word, _)| self.scalars.fraction(&factor(*word))).collect();
        let common = factors.iter().fold(Integer::from(1), |d, (_, own)| d.lcm(own));
        let term = |((word, [re, im]), (e, own)): (&Term<_>, (S::Element, _))| {
            let e = match Integer::from(&common / &own) {
                one if one == 1 => e,
                n => self.scalars.times(&e, &n),
            };
            let [re, im] = [re, im].map(|part| self.scalars.product(part, &e));
            (*word, if turn { [self.scalars.neg(&im), re] } else { [re, im] })
        };
        let terms = f.terms.iter().zip(factors).map(term).collect();
        self.canonical(common * &f.denominator, terms, f.real)
    }
}
