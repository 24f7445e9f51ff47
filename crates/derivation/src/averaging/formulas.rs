//! Averaging over symbols: the parameters in the words of the algebra, with what makes its constants formulas again.

use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_coeff::sparse::{Monomial, Sparse};
use lindstedt_coeff::{Polynomial, PowerProduct, Symbol};
use lindstedt_number::Whole;
use lindstedt_phase::amplitudes::scalars::Integers;
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, Delay};
use rug::Rational;
use std::collections::BTreeMap;

pub(super) type Element = AmplitudeElement<Whole>;

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
        let mut formulas = Self { field, algebra, symbols, inverse };
        let rates = [Some(frequency), force].map(|rate| rate.map(|rate| formulas.element(rate)));
        let [frequency, force] = rates;
        let (frequency, force) = (frequency??, force.map_or(Some(None), |force| force.map(Some))?);
        let late = |delay: &Delay<ParameterFraction>| {
            let [free, forced] = &delay.turns[..] else { return None };
            let turn = |turn| formulas.turned_back(turn);
            Some([formulas.element(&delay.time)?, turn(free)?, turn(forced)?])
        };
        let late = delays.iter().map(late).collect::<Option<Vec<_>>>()?;
        let Self { algebra, inverse, .. } = formulas;
        let mut algebra = algebra.with_rates(&frequency, force.as_ref()).with_late(late);
        if let Some(omega) = omega.filter(|_| inverse.is_some()) {
            algebra = algebra.with_divisor(name(&omega), DIVISOR)?;
        }
        formulas = Self { field, algebra, symbols: formulas.symbols, inverse };
        Some(formulas)
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
        let (field, turns) = (self.field, self.field.pairs.len());
        let mut waves: BTreeMap<Vec<i32>, [Polynomial; 2]> = BTreeMap::new();
        // Re and Im of the terms by the power of 1/(nu^2 - Omega^2).
        let mut parts: BTreeMap<i32, [Vec<(PowerProduct, Rational)>; 2]> = BTreeMap::new();
        for term in self.algebra.rational_terms(c)? {
            let (phases, symbols) = term.exponents.split_at_checked(3 + turns)?;
            let wave = match waves.get(&phases[3..]) {
                Some(wave) => wave,
                None => waves.entry(phases[3..].to_vec()).or_insert(self.wave(&phases[3..])),
            };
            let (own, divided) = symbols.split_at_checked(self.symbols.len())?;
            let mut monomial = PowerProduct::unit();
            for (index, exponent) in self.symbols.iter().zip(own).filter(|(_, e)| **e != 0) {
                let exponent = i16::try_from(*exponent).ok()?;
                let power = PowerProduct::power(Symbol::Parameter(*index), exponent);
                monomial = monomial.times(&power);
            }
            let lists = parts.entry(divided.first().copied().unwrap_or(0)).or_default();
            let minus = Rational::from(-&term.im);
            // (re + i im)(cos + i sin).
            for (part, q, wave) in [
                (0, &term.re, &wave[0]),
                (0, &minus, &wave[1]),
                (1, &term.re, &wave[1]),
                (1, &term.im, &wave[0]),
            ] {
                if !q.is_zero() {
                    let of = |(m, c): &(PowerProduct, Rational)| {
                        (m.times(&monomial), Rational::from(c * q))
                    };
                    lists[part].extend(wave.terms().iter().map(of));
                }
            }
        }
        let mut sums = [field.zero(), field.zero()];
        for (power, lists) in parts {
            for (sum, list) in sums.iter_mut().zip(lists) {
                let mut part = field.polynomial(Sparse::collect(&Rationals, list));
                let factor = match (power, &self.inverse) {
                    (0, _) => None,
                    (_, None) => return None,
                    (1.., Some(inverse)) => Some(inverse.clone()),
                    (_, Some(inverse)) => Some(field.reciprocal(inverse)?),
                };
                for _ in 0..power.unsigned_abs() {
                    part = factor.as_ref().map_or(part.clone(), |factor| field.mul(&part, factor));
                }
                field.add_assign(sum, &part);
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
