//! Averaging over symbols: the parameters in the words of the algebra, with what makes its constants formulas again.

use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::polynomial::Polynomial;
use lindstedt_coeff::sparse::{Monomial, Sparse};
use lindstedt_coeff::{PowerProduct, Symbol};
use lindstedt_number::Whole;
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, Delay, Late};
use rug::Rational;
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::collections::BTreeMap;

pub(super) type Element = AmplitudeElement<Whole>;

/// A polynomial in cosines and sines, by the places of its monomials.
type Wave = Vec<(usize, Whole)>;

/// The terms of a polynomial, in any order.
type Terms = Vec<(PowerProduct, Rational)>;

/// The name of 1/(nu^2 - Omega^2) among the symbols; no parameter is called so.
const DIVISOR: &str = "1/(nu^2 - Omega^2)";

/// A field of formulas and an algebra in which its parameters are symbols: those that are no cosine or sine by their
/// names, a cosine and a sine of theta_j as Re and Im of W_j = e^{i theta_j}.
pub(super) struct Formulas<'a> {
    field: &'a ParameterField,
    pub(super) algebra: Amplitudes<Integers>,
    /// The symbols in the order of the algebra.
    symbols: Vec<u16>,
    /// 1/(nu^2 - Omega^2), where the algebra divides by it.
    inverse: Option<ParameterFraction>,
    waves: RefCell<Waves>,
}

impl<'a> Formulas<'a> {
    /// The algebra of one unknown; nothing where words have no room or a rate is no polynomial.
    pub(super) fn new(
        field: &'a ParameterField,
        frequency: &ParameterFraction,
        force: Option<&ParameterFraction>,
        delays: &[Delay<ParameterFraction>],
    ) -> Option<Self> {
        let in_pair = |i: &u16| field.pairs.iter().any(|(cos, sin)| i == cos || i == sin);
        let count = u16::try_from(field.ring.parameters.len()).ok()?;
        let symbols: Vec<u16> = (0..count).filter(|i| !in_pair(i)).collect();
        let name = |i: &u16| &*field.ring.parameters[usize::from(*i)];
        let mut names: Vec<&str> = symbols.iter().map(name).collect();
        // A force whose rate is a symbol is off resonance by a formula.
        let is_force = |i: &u16| force.is_some_and(|force| *force == field.parameter(*i));
        let omega = symbols.iter().copied().find(is_force);
        let inverse = omega.and_then(|omega| {
            let factor = |sign: i32| {
                let force = field.scale(&field.parameter(omega), &sign.into());
                field.reciprocal(&field.add(frequency, &force))
            };
            Some(field.mul(&factor(1)?, &factor(-1)?))
        });
        if inverse.is_some() {
            names.push(DIVISOR);
        }
        let algebra = Amplitudes::of_formulas(Integers, &names, field.pairs.len())?;
        let formulas = Self { field, algebra, symbols, inverse, waves: RefCell::default() };
        let rates = [Some(frequency), force].map(|rate| rate.map(|rate| formulas.element(rate)));
        let [frequency, force] = rates;
        let (frequency, force) = (frequency??, force.map_or(Some(None), |force| force.map(Some))?);
        let late = |delay: &Delay<ParameterFraction>| {
            let [free, forced] = &delay.turns[..] else { return None };
            let turn = |turn| formulas.turned_back(turn);
            let turns = vec![turn(free)?, turn(forced)?];
            Some(Late { time: formulas.element(&delay.time)?, turns })
        };
        let late = delays.iter().map(late).collect::<Option<Vec<_>>>()?;
        let mut algebra = formulas.algebra.with_rates(&frequency, force.as_ref()).with_late(late);
        if let Some(omega) = omega.filter(|_| formulas.inverse.is_some()) {
            algebra = algebra.with_divisor(name(&omega), DIVISOR)?;
        }
        Some(Self { algebra, ..formulas })
    }

    /// The same with products that are broken off when `stop` says so.
    pub(super) fn with_stop(self, stop: Stop) -> Self {
        Self { algebra: self.algebra.with_stop(stop), ..self }
    }

    /// A polynomial without cosines and sines as a constant.
    pub(super) fn element(&self, formula: &ParameterFraction) -> Option<Element> {
        let algebra = &self.algebra;
        if !formula.denominator().is_empty() {
            return None;
        }
        let power = |(symbol, exponent): &(Symbol, i16)| {
            let Symbol::Parameter(index) = symbol else { return None };
            let position = self.symbols.iter().position(|known| known == index)?;
            let symbol = algebra.symbol(&algebra.symbols()[position])?;
            let symbol = if *exponent < 0 { algebra.reciprocal(&symbol)? } else { symbol };
            let power = exponent.unsigned_abs().into();
            Some(lindstedt_coeff::polynomial::power(algebra, &symbol, power))
        };
        let mut sum = algebra.zero();
        for (monomial, c) in formula.numerator().terms() {
            let mut product = algebra.rational(c);
            for factor in monomial.factors() {
                product = algebra.mul(&product, &power(factor)?);
            }
            algebra.add_assign(&mut sum, &product);
        }
        Some(sum)
    }

    /// e^{-i theta} for [cos theta, sin theta]: those of a pair, or 1 and 0.
    fn turned_back(&self, [cos, sin]: &[ParameterFraction; 2]) -> Option<Element> {
        let field = self.field;
        if *cos == field.one() && field.is_zero(sin) {
            return Some(self.algebra.one());
        }
        let pair = |(c, s): &(u16, u16)| *cos == field.parameter(*c) && *sin == field.parameter(*s);
        let position = field.pairs.iter().position(pair)?;
        self.algebra.constant_phase(position, -1)
    }

    /// The real and the imaginary part of a constant as formulas.
    pub(super) fn read(&self, c: &Element) -> Option<[Option<ParameterFraction>; 2]> {
        let first = 3 + self.field.pairs.len();
        let (terms, denominator) = self.algebra.numerators(c);
        let mut waves = self.waves.borrow_mut();
        // Re and Im by the power of 1/(nu^2 - Omega^2).
        let mut parts: BTreeMap<i32, [Terms; 2]> = BTreeMap::new();
        // Of what differs in the phases alone, by the powers of cosines and sines: words are sorted.
        let mut sums: Vec<[Whole; 2]> = Vec::new();
        let mut terms = terms.peekable();
        while let Some((exponents, [re, im])) = terms.next() {
            let (turns, own) = exponents[3..].split_at(first - 3);
            let [cos, sin] = waves.of(self, turns);
            let length = [cos, sin].into_iter().flatten().map(|(place, _)| place + 1).max();
            sums.resize(sums.len().max(length.unwrap_or(0)), [Whole::ZERO; 2]);
            // (re + i im)(cos + i sin).
            let minus = im.neg();
            for (part, c, wave) in [(0, re, cos), (0, &minus, sin), (1, re, sin), (1, im, cos)] {
                if !c.is_zero() {
                    wave.iter().for_each(|(place, n)| sums[*place][part].add_product(c, n));
                }
            }
            if terms.peek().is_some_and(|(next, _)| next[first..] == *own) {
                continue;
            }
            let (own, divided) = own.split_at_checked(self.symbols.len())?;
            let power = |(index, exponent): (&u16, &i32)| {
                Some((Symbol::Parameter(*index), i16::try_from(*exponent).ok()?))
            };
            let powers = self.symbols.iter().zip(own).map(power).collect::<Option<Vec<_>>>()?;
            let monomial = PowerProduct::increasing(powers.into_iter());
            let divided = if self.inverse.is_some() { divided.first().copied() } else { None };
            let lists = parts.entry(divided.unwrap_or(0)).or_default();
            for (wave, sum) in waves.monomials.iter().zip(&mut sums) {
                for (list, c) in lists.iter_mut().zip(sum).filter(|(_, c)| !c.is_zero()) {
                    list.push((wave.times(&monomial), c.over(denominator)));
                    *c = Whole::ZERO;
                }
            }
        }
        self.formulas(parts)
    }

    /// sum_k parts_k/(nu^2 - Omega^2)^k.
    fn formulas(&self, parts: BTreeMap<i32, [Terms; 2]>) -> Option<[Option<ParameterFraction>; 2]> {
        let field = self.field;
        let mut sums = [field.zero(), field.zero()];
        for (power, lists) in parts {
            for (sum, list) in sums.iter_mut().zip(lists) {
                let polynomial = Sparse::from_different(list, |m| m.rank(false));
                let mut part = field.polynomial(polynomial?);
                let factor = match (power, &self.inverse) {
                    (0, _) => None,
                    (_, None) => return None,
                    (1.., Some(inverse)) => Some(inverse.clone()),
                    (_, Some(inverse)) => Some(field.reciprocal(inverse)?),
                };
                for _ in 0..power.unsigned_abs() {
                    part = factor.as_ref().map_or(part.clone(), |factor| field.mul(&part, factor));
                }
                if field.is_zero(sum) {
                    *sum = part;
                } else {
                    field.add_assign(sum, &part);
                }
            }
        }
        Some(sums.map(|sum| (!field.is_zero(&sum)).then_some(sum)))
    }

    /// cos and sin of sum_j k_j theta_j in those of the theta_j.
    fn wave(&self, multiples: &[i32]) -> [Polynomial; 2] {
        let ring = &self.field.ring;
        let mut wave = [ring.one(), ring.zero()];
        for (&(cos, sin), k) in self.field.pairs.iter().zip(multiples) {
            let sine = self.field.scale(&self.field.parameter(sin), &k.signum().into());
            let turn = [self.field.parameter(cos), sine];
            for _ in 0..k.unsigned_abs() {
                let [c, s] = turn.each_ref().map(ParameterFraction::numerator);
                let [x, y] = &wave;
                let next = [
                    ring.sub(&ring.mul(x, c), &ring.mul(y, s)),
                    ring.add(&ring.mul(x, s), &ring.mul(y, c)),
                ];
                wave = next.map(|p| self.field.polynomial(p).numerator().clone());
            }
        }
        wave
    }
}

/// Cosines and sines of sums of multiples of the theta_j, as they are asked for.
#[derive(Default)]
struct Waves {
    /// The products of cos theta_j and sin theta_j that occur, and their places.
    monomials: Vec<PowerProduct>,
    places: FxHashMap<PowerProduct, usize>,
    known: FxHashMap<Vec<i32>, [Wave; 2]>,
}

impl Waves {
    fn of(&mut self, formulas: &Formulas<'_>, multiples: &[i32]) -> &[Wave; 2] {
        if !self.known.contains_key(multiples) {
            let wave = formulas.wave(multiples).map(|p| self.wave(&p));
            self.known.insert(multiples.to_vec(), wave);
        }
        &self.known[multiples]
    }

    /// Chebyshev's polynomials: the coefficients are integers.
    fn wave(&mut self, p: &Polynomial) -> Wave {
        let term = |(m, c): &(PowerProduct, Rational)| {
            let place = *self.places.entry(m.clone()).or_insert_with(|| {
                self.monomials.push(m.clone());
                self.monomials.len() - 1
            });
            (place, Whole::from(c.numer()))
        };
        p.terms().iter().map(term).collect()
    }
}
