//! Polynomials in complex amplitudes z_1, zbar_1, ..., z_M, zbar_M, in E_l = e^{i eta_l} and 1/E_l, and in
//! named symbols, with complex coefficients: what averaging with resonance computes with
//! ([`AmplitudeAlgebra`](lindstedt_algebra::AmplitudeAlgebra)).
//!
//! A monomial is one word ([`words`]), an element a list sorted by words with numerators over one common
//! denominator ([`scalars`]), reduced: canonical. The eigenvalue of every monomial under D_0, and with it
//! every resonance, is decided exactly where the numbers of [`Rates`] are independent over Q; where they are
//! only taken to be, no divisor that may be zero passes.
//!
//! A product costs one product of coefficients per pair of terms; of two real elements (which are equal to
//! their conjugates) half of that: the upper half of one of them times the other, and the conjugate.
//!
//! Where frequencies are formulas ([`Amplitudes::of_formulas`]) the parameters are symbols of the words, and what a delay
//! turns the phases by is a phase of its own that stands still.

mod calculus;
mod delay;
mod formulas;
mod gather;
pub mod polar;
mod ring;
pub mod scalars;
mod sums;
#[cfg(test)]
mod tests;
pub mod words;

pub use delay::{Delay, Late};
use lindstedt_algebra::{RationalAlgebra, Ring, Stop, common_measure};
use lindstedt_number::Whole;
use rug::{Integer, Rational};
use scalars::Scalars;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use formulas::Divided;
pub use words::DIGITS as MOST_EXPONENTS;
use words::{DIGITS, Layout, Word};

/// A word with the real and the imaginary numerator of its coefficient.
type Term<E> = (Word, [E; 2]);

/// A polynomial; it means nothing without its [`Amplitudes`].
#[derive(Clone, Debug)]
pub struct AmplitudeElement<E> {
    /// The common denominator, positive.
    denominator: Whole,
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
    /// The exponents of z_1, zbar_1, ..., z_M, zbar_M, E_1, ..., E_L and the symbols.
    pub exponents: Vec<i32>,
    /// The real part.
    pub re: Rational,
    /// The imaginary part.
    pub im: Rational,
}

/// nu_1, ..., nu_M > 0 and Omega_1, ..., Omega_L as sums of rational multiples of 1, g_1, g_2, ..., numbers of
/// which no such sum is zero, or symbols.
#[derive(Clone, Debug)]
pub struct Rates<E> {
    /// The multiples of 1, g_1, ... in nu_j, zeros at the end left out.
    pub amplitudes: Vec<Vec<Rational>>,
    /// Those in Omega_l.
    pub forces: Vec<Vec<Rational>>,
    /// g_1, g_2, ... with denominators.
    pub generators: Vec<(E, Whole)>,
}

impl<E> Rates<E> {
    /// Of one amplitude and one force: the first generator or 1, and the second or 0.
    pub fn single(generators: Vec<(E, Whole)>) -> Self {
        let unit = |k: usize| (0..=k).map(|i| u32::from(i == k).into()).collect();
        let amplitudes = vec![unit(generators.len().min(1))];
        let forces = vec![if generators.len() > 1 { unit(2) } else { vec![Rational::new()] }];
        Self { amplitudes, forces, generators }
    }
}

/// The multiples of 1, g_1, ... in a rate, over their common measure.
type Multiples = Vec<i128>;

/// Bits of such a multiple: sixteen of them times exponents of 31 bits add up in a word.
const RATE_BITS: u32 = 90;

/// What an unknown is compared with.
#[derive(Clone, Debug)]
struct Unknown<E> {
    /// nu^2 where it is a rational number, and as a number in any case.
    rational: Option<Rational>,
    square: AmplitudeElement<E>,
    /// nu, if it is among the sums of the generators: otherwise no eigenvalue is resonant.
    rate: Option<Multiples>,
}

/// The algebra over numerators S, with the frequencies nu_j > 0 of the z_j, the frequencies Omega_l of the
/// forces, and named symbols, for parameters.
///
/// At most sixteen exponents (2 M + L + symbols), of which none exceeds [`Self::largest_exponent`]; beyond, products are
/// not formed and [`Self::overflowed`] says so.
#[derive(Debug)]
pub struct Amplitudes<S: Scalars> {
    scalars: S,
    layout: Layout,
    symbols: Vec<String>,
    /// M.
    amplitudes: usize,
    /// nu_j/q of the amplitudes and Omega_l/q with the common measure q.
    rates: Vec<Multiples>,
    common: Rational,
    generators: Vec<AmplitudeElement<S::Element>>,
    /// How many constant phases e^{i theta} follow those of the forces.
    turns: usize,
    /// Whether symbols have inverses.
    units: bool,
    divided: Option<Divided<S::Element>>,
    unknowns: Vec<Unknown<S::Element>>,
    delays: Vec<Late<S::Element>>,
    /// Whether monomials that meet the frequency without being z are refused.
    refuses: bool,
    stop: Stop,
    overflow: AtomicBool,
    /// The exponents, a bit each, that told words apart in the last sum of many products.
    independent: AtomicU32,
}

impl<S: Scalars> Amplitudes<S> {
    /// The algebra of rational frequencies and one force (of the frequency 0 where there is none); nothing
    /// without an unknown, for frequencies that are not positive or too long, or for too many symbols.
    pub fn new(
        scalars: S,
        frequencies: &[Rational],
        force: &Rational,
        symbols: &[&str],
    ) -> Option<Self> {
        if frequencies.iter().any(|nu| *nu <= 0) {
            return None;
        }
        let amplitudes = frequencies.iter().map(|nu| vec![nu.clone()]).collect();
        let forces = vec![vec![force.clone()]];
        Self::of_rates(scalars, Rates { amplitudes, forces, generators: Vec::new() }, symbols)
    }

    /// The algebra of any frequencies; nothing without an unknown or the rate of a force (0 where there is none),
    /// for rates that are too long or too many symbols.
    pub fn of_rates(scalars: S, rates: Rates<S::Element>, symbols: &[&str]) -> Option<Self> {
        let Rates { amplitudes, forces, generators } = rates;
        let count = amplitudes.len();
        if count == 0 || forces.is_empty() {
            return None;
        }
        let layout = Layout::of(2 * count + forces.len() + symbols.len())?;
        let all = || amplitudes.iter().chain(&forces);
        let common =
            all().flatten().fold(Rational::new(), |common, nu| common_measure(&common, nu));
        if common == 0 {
            return None;
        }
        let whole = |q: &Rational| {
            let multiple = Rational::from(q / &common).into_numer_denom().0;
            multiple.to_i128().filter(|_| multiple.significant_bits() <= RATE_BITS)
        };
        let multiples = |rate: &Vec<Rational>| -> Option<Multiples> {
            let mut list: Multiples = rate.iter().map(whole).collect::<Option<_>>()?;
            list.resize(1 + generators.len(), 0);
            Some(list)
        };
        let mut algebra = Self {
            rates: all().map(multiples).collect::<Option<_>>()?,
            common,
            amplitudes: count,
            generators: Vec::new(),
            turns: 0,
            units: false,
            divided: None,
            unknowns: Vec::new(),
            delays: Vec::new(),
            refuses: false,
            scalars,
            layout,
            symbols: symbols.iter().map(|name| (*name).to_owned()).collect(),
            stop: Stop::default(),
            overflow: AtomicBool::new(false),
            independent: AtomicU32::new(0),
        };
        let own = |(e, d)| algebra.single(0, [e, algebra.scalars.zero()], d, true);
        algebra.generators = generators.into_iter().map(own).collect();
        algebra.unknowns = algebra.of_own_rates();
        Some(algebra)
    }

    /// The unknowns that have amplitudes.
    fn of_own_rates(&self) -> Vec<Unknown<S::Element>> {
        let unknown = |rate: &Multiples| {
            let rational = self.rational_rate(rate).map(|nu| nu.square());
            let square = match &rational {
                Some(square) => self.rational(square),
                None => {
                    let nu = self.value(rate);
                    self.mul(&nu, &nu)
                }
            };
            Unknown { rational, square, rate: Some(rate.clone()) }
        };
        self.rates[..self.amplitudes].iter().map(unknown).collect()
    }

    /// The algebra whose products are broken off when `stop` says so.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// The algebra for more unknowns than there are amplitudes, with nu_j^2 of all of them: those behind have no
    /// amplitude of their own, and nu_j need not be rational.
    #[must_use]
    pub fn with_unknowns(mut self, squares: &[Rational]) -> Self {
        let behind = squares.iter().skip(self.amplitudes).map(|square| {
            let scaled = square / self.common.clone().square();
            let root = scaled.numer().clone().sqrt();
            let is_square = scaled.is_integer() && root.clone().square() == *scaled.numer();
            let rate = root.to_i128().filter(|_| is_square).map(|nu| {
                let mut rate = vec![0; 1 + self.generators.len()];
                rate[0] = nu;
                rate
            });
            Unknown { rational: Some(square.clone()), square: self.rational(square), rate }
        });
        let behind: Vec<_> = behind.collect();
        self.unknowns.truncate(self.amplitudes);
        self.unknowns.extend(behind);
        self
    }

    /// (cos m eta_l, sin m eta_l); nothing for exponents that words do not hold.
    pub fn wave(&self, l: usize, m: i32) -> Option<[AmplitudeElement<S::Element>; 2]> {
        let place = self.layout.unit(2 * self.amplitudes + l);
        let fits = m.checked_abs().is_some_and(|m| m <= self.layout.largest());
        let power = self.monomial(place * Word::from(fits.then_some(m)?), false);
        let half = self.scaled(&power, &Rational::from((1, 2)));
        // sin = (E - 1/E)/(2 i).
        let turned = self.turned(&self.scaled(&power, &Rational::from((-1, 2))));
        Some([half, turned].map(|f| self.with_conjugate(&f)))
    }

    /// The largest exponent that monomials hold: 127, and far more where there are few.
    pub fn largest_exponent(&self) -> i32 {
        self.layout.largest()
    }

    /// Whether an exponent beyond the largest was needed.
    pub fn overflowed(&self) -> bool {
        self.overflow.load(Ordering::Relaxed)
    }

    /// The names of the symbols.
    pub fn symbols(&self) -> &[String] {
        &self.symbols
    }

    /// A symbol by its name, if there is one.
    pub fn symbol(&self, name: &str) -> Option<AmplitudeElement<S::Element>> {
        Some(self.monomial(self.layout.unit(self.phases() + self.position(name)?), true))
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.symbols.iter().position(|known| known == name)
    }

    /// An element e of S as a constant e/1.
    pub fn constant(&self, e: S::Element) -> AmplitudeElement<S::Element> {
        self.single(0, [e, self.scalars.zero()], Whole::ONE, true)
    }

    /// The terms with their coefficients, where those are rational.
    pub fn rational_terms(&self, f: &AmplitudeElement<S::Element>) -> Option<Vec<AmplitudeTerm>> {
        let term = |exponents, [re, im]: [Option<Rational>; 2]| {
            Some(AmplitudeTerm { exponents, re: re?, im: im? })
        };
        let read = |e: &S::Element, d: &Whole| self.scalars.quotient(e, d);
        self.terms_as(f, &read).into_iter().map(|(exponents, c)| term(exponents, c)).collect()
    }

    /// The exponents of the terms with the numerators of their coefficients, and the common denominator.
    pub fn numerators<'a>(
        &'a self,
        f: &'a AmplitudeElement<S::Element>,
    ) -> (impl Iterator<Item = ([i32; DIGITS], &'a [S::Element; 2])>, &'a Whole) {
        let n = self.exponents();
        let term = move |(word, c): &'a Term<S::Element>| (self.layout.exponents(*word, n).0, c);
        (f.terms.iter().map(term), &f.denominator)
    }

    /// The exponents of the terms with what `read` makes of the real and the imaginary part e/d of their
    /// coefficients.
    pub fn terms_as<C>(
        &self,
        f: &AmplitudeElement<S::Element>,
        read: &dyn Fn(&S::Element, &Whole) -> C,
    ) -> Vec<(Vec<i32>, [C; 2])> {
        let n = self.exponents();
        let term = |(word, c): &Term<S::Element>| {
            let exponents = self.layout.exponents(*word, n).0[..n].to_vec();
            (exponents, c.each_ref().map(|part| read(part, &f.denominator)))
        };
        f.terms.iter().map(term).collect()
    }

    /// 2 M + L: the exponents that D_0 knows.
    fn moving(&self) -> usize {
        self.amplitudes + self.rates.len()
    }

    /// The exponents that conjugation knows: those of constant phases, too.
    fn phases(&self) -> usize {
        self.moving() + self.turns
    }

    fn exponents(&self) -> usize {
        self.phases() + self.symbols.len()
    }

    /// lambda/q.
    fn eigenvalue(&self, word: Word) -> Multiples {
        let (digits, _) = self.layout.exponents(word, self.moving());
        let mut sum = vec![0; 1 + self.generators.len()];
        for (k, rate) in self.harmonic(&digits).iter().zip(&self.rates) {
            sum.iter_mut().zip(rate).for_each(|(sum, rate)| *sum += i128::from(*k) * rate);
        }
        sum
    }

    /// A rate that has no part in the generators.
    fn rational_rate(&self, rate: &[i128]) -> Option<Rational> {
        let alone = rate[1..].iter().all(|n| *n == 0);
        alone.then(|| Rational::from(&self.common * Integer::from(rate[0])))
    }

    /// A rate as a constant.
    fn value(&self, rate: &[i128]) -> AmplitudeElement<S::Element> {
        let times = |n: i128| Rational::from(&self.common * Integer::from(n));
        let start = self.rational(&times(rate[0]));
        let parts = rate[1..].iter().zip(&self.generators).filter(|(n, _)| **n != 0);
        parts.fold(start, |sum, (n, generator)| {
            let part = self.scale(generator, &times(*n));
            if sum.terms.is_empty() { part } else { self.total(sum, &part, true) }
        })
    }

    /// p_1 - q_1, ..., p_M - q_M, m_1, ..., m_L.
    fn harmonic(&self, digits: &[i32; DIGITS]) -> Vec<i32> {
        let m = self.amplitudes;
        let turns = (0..m).map(|j| digits[2 * j] - digits[2 * j + 1]);
        turns.chain(digits[2 * m..self.moving()].iter().copied()).collect()
    }

    /// The word of the conjugate.
    fn mirrored(&self, word: Word) -> Word {
        let mut mirrored = word;
        for j in 0..self.amplitudes {
            let turn = self.layout.exponent(word, 2 * j) - self.layout.exponent(word, 2 * j + 1);
            if turn != 0 {
                let pair = self.layout.unit(2 * j + 1) - self.layout.unit(2 * j);
                mirrored += Word::from(turn) * pair;
            }
        }
        for i in 2 * self.amplitudes..self.phases() {
            let m = self.layout.exponent(word, i);
            if m != 0 {
                mirrored -= 2 * Word::from(m) * self.layout.unit(i);
            }
        }
        mirrored
    }

    fn single(
        &self,
        word: Word,
        coefficient: [S::Element; 2],
        denominator: Whole,
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
        denominator: Whole,
        terms: Vec<Term<S::Element>>,
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        let within = denominator.clone();
        self.canonical_within(within, denominator, terms, real)
    }

    /// The same where a multiple of all that can be cancelled is known.
    fn canonical_within(
        &self,
        mut content: Whole,
        mut denominator: Whole,
        mut terms: Vec<Term<S::Element>>,
        real: bool,
    ) -> AmplitudeElement<S::Element> {
        let scalars = &self.scalars;
        terms.retain(|(_, c)| !c.iter().all(|part| scalars.is_zero(part)));
        if terms.is_empty() {
            return AmplitudeElement { denominator: Whole::ONE, terms, real: true };
        }
        for part in terms.iter().flat_map(|(_, c)| c) {
            if content == Whole::ONE {
                break;
            }
            scalars.content(&mut content, part);
        }
        if content != Whole::ONE {
            denominator.divide(&content);
            for part in terms.iter_mut().flat_map(|(_, c)| c) {
                scalars.divide(part, &content);
            }
        }
        AmplitudeElement { denominator, terms, real }
    }

    /// Every term with its coefficient times an integer of its word; nothing stays of a term whose factor is zero.
    fn weighted(
        &self,
        f: &AmplitudeElement<S::Element>,
        factor: impl Fn(Word) -> i32,
    ) -> AmplitudeElement<S::Element> {
        let term = |(word, c): &Term<S::Element>| match factor(*word) {
            0 => None,
            1 => Some((*word, c.clone())),
            n => Some((*word, c.each_ref().map(|e| self.scalars.multiple(e, n)))),
        };
        let terms = f.terms.iter().filter_map(term).collect();
        self.canonical(f.denominator.clone(), terms, f.real)
    }

    /// q f.
    fn scaled(
        &self,
        f: &AmplitudeElement<S::Element>,
        q: &Rational,
    ) -> AmplitudeElement<S::Element> {
        if S::GATHERS {
            let term = |(word, c): &Term<S::Element>| {
                (*word, c.each_ref().map(|e| self.scalars.scale(e, q)))
            };
            return self.canonical(Whole::ONE, f.terms.iter().map(term).collect(), f.real);
        }
        // What the numerator of q and the denominator of f share is cancelled first; what is left of one divides the other
        // no more.
        let [n, rest] = [q.numer(), q.denom()].map(Whole::from);
        let mut common = f.denominator.clone();
        n.gcd(&mut common);
        let n = n.divided(&common);
        let denominator = f.denominator.divided(&common).mul(&rest);
        let term =
            |(word, c): &Term<S::Element>| (*word, c.each_ref().map(|e| self.scalars.times(e, &n)));
        let terms =
            if n == Whole::ONE { f.terms.clone() } else { f.terms.iter().map(term).collect() };
        self.canonical_within(rest, denominator, terms, f.real)
    }
}
