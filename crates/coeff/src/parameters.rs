//! Rational functions of named parameters with factored denominators.
//!
//! Elements are p/(f_1^e_1 f_2^e_2 ...) with a polynomial p over Q (Laurent exponents allowed) and
//! primitive linear forms f_i = n_0 + n_1 s_1 + n_2 s_2 + ... of two or more terms, such as the
//! alpha - omega and 2 alpha + omega of a forced oscillator, or 1 - omega. Some parameters may be the sine and
//! the cosine of one angle; then sin^2 = 1 - cos^2 is used, so that sin occurs to the power 0 or 1.
//!
//! Canonical: distinct primitive forms are coprime, and none divides p. Divisibility is decided by
//! division in the last parameter of the form; it is the same with and without the relation
//! sin^2 + cos^2 = 1 because the reduced monomials in the other symbols are a basis.

use crate::polynomial::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use crate::print::{Print, Style, Term, parenthesize, power, print_sum};
use crate::sparse::{Monomial, Sparse};
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// A primitive linear form: a constant first, parameters increasing, coprime integers, the first one positive.
pub type LinearForm = Vec<(Option<u16>, Integer)>;

/// p/(f_1^e_1 ...).
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterFraction {
    numerator: Polynomial,
    denominator: BTreeMap<LinearForm, u32>,
}

impl ParameterFraction {
    /// p.
    pub fn numerator(&self) -> &Polynomial {
        &self.numerator
    }
    /// The factors f_i with their exponents e_i.
    pub fn denominator(&self) -> &BTreeMap<LinearForm, u32> {
        &self.denominator
    }
}

/// The field of fractions that expansions with symbolic parameters need.
#[derive(Clone, Debug, Default)]
pub struct ParameterField {
    /// The names of all parameters, of the sines and cosines too.
    pub ring: PolynomialRing,
    /// (cosine, sine) positions of parameters with sin^2 + cos^2 = 1.
    pub pairs: Vec<(u16, u16)>,
    /// Whether sums with a constant, such as 1 - omega, can be divided by. It takes omega to be no number, in particular
    /// not 1.
    pub affine: bool,
}

impl ParameterField {
    /// The parameter of that position.
    pub fn parameter(&self, index: u16) -> ParameterFraction {
        polynomial(self.ring.symbol(Symbol::Parameter(index)))
    }

    /// A polynomial.
    pub fn polynomial(&self, p: Polynomial) -> ParameterFraction {
        polynomial(self.reduce(p))
    }

    /// The position of a name.
    pub fn position(&self, name: &str) -> Option<u16> {
        let position = self.ring.parameters.iter().position(|known| known == name)?;
        u16::try_from(position).ok()
    }

    /// The image under the homomorphism that sends parameter i to `image(i)`; nothing where the
    /// image of a denominator cannot be inverted.
    pub fn evaluate<R: RationalAlgebra>(
        &self,
        target: &R,
        a: &ParameterFraction,
        mut image: impl FnMut(u16) -> R::Element,
    ) -> Option<R::Element> {
        let mut of_symbol = |symbol| match symbol {
            Symbol::Parameter(index) => image(index),
            _ => target.zero(),
        };
        let mut value = self.ring.substitute(target, &a.numerator, &mut of_symbol)?;
        for (form, &exponent) in &a.denominator {
            let factor = self.ring.substitute(target, &expand(form), &mut of_symbol)?;
            let inverse = target.reciprocal(&factor)?;
            for _ in 0..exponent {
                value = target.mul(&value, &inverse);
            }
        }
        Some(value)
    }

    /// sin^e with e >= 2 becomes sin^(e mod 2) (1 - cos^2)^(e div 2).
    fn reduce(&self, mut p: Polynomial) -> Polynomial {
        for &(cos, sin) in &self.pairs {
            let (cos, sin) = (Symbol::Parameter(cos), Symbol::Parameter(sin));
            let exponent =
                |m: &PowerProduct| m.factors().iter().find(|f| f.0 == sin).map_or(0, |f| f.1);
            if p.terms().iter().all(|(m, _)| exponent(m) < 2) {
                continue;
            }
            let square = self.ring.sub(&self.ring.one(), &self.ring.power(cos, 2));
            let mut by_power: BTreeMap<i16, Vec<(PowerProduct, Rational)>> = BTreeMap::new();
            for (m, c) in p.terms() {
                let pairs = exponent(m).div_euclid(2).max(0);
                let lowered = m.times(&PowerProduct::power(sin, -2 * pairs));
                by_power.entry(pairs).or_default().push((lowered, c.clone()));
            }
            // Horner's rule in sin^2.
            let highest = by_power.keys().next_back().copied().unwrap_or(0);
            let mut sum = self.ring.zero();
            for k in (0..=highest).rev() {
                sum = self.ring.mul(&sum, &square);
                let terms = by_power.remove(&k).unwrap_or_default();
                self.ring.add_assign(&mut sum, &Sparse::collect(&Rationals, terms));
            }
            p = sum;
        }
        p
    }

    fn canonical(
        &self,
        numerator: Polynomial,
        denominator: BTreeMap<LinearForm, u32>,
    ) -> ParameterFraction {
        let mut fraction = polynomial(self.reduce(numerator));
        if fraction.numerator.is_zero() {
            return fraction;
        }
        for (form, mut exponent) in denominator {
            while exponent > 0 {
                let Some(quotient) = self.divide(&fraction.numerator, &form) else { break };
                fraction.numerator = quotient;
                exponent -= 1;
            }
            if exponent > 0 {
                fraction.denominator.insert(form, exponent);
            }
        }
        fraction
    }

    /// p/form if the form divides p: with w the last parameter, form = q (w + r), Horner's rule
    /// gives the quotient of p by w + r.
    fn divide(&self, p: &Polynomial, form: &LinearForm) -> Option<Polynomial> {
        let (last, q) = form.last()?;
        let w = Symbol::Parameter((*last)?);
        let inverse = Rational::from(q).recip();
        let rest = self.ring.scale(&expand(&form[..form.len() - 1]), &inverse);
        let mut by_power: BTreeMap<i16, Vec<(PowerProduct, Rational)>> = BTreeMap::new();
        for (m, c) in p.terms() {
            let exponent = m.factors().iter().find(|f| f.0 == w).map_or(0, |f| f.1);
            let without = m.times(&PowerProduct::power(w, exponent.checked_neg()?));
            by_power.entry(exponent).or_default().push((without, c.clone()));
        }
        let (&lowest, &highest) = (by_power.keys().next()?, by_power.keys().next_back()?);
        let (mut carry, mut quotient) = (self.ring.zero(), self.ring.zero());
        for k in (lowest..=highest).rev() {
            let terms = by_power.remove(&k).unwrap_or_default();
            let own = Sparse::collect(&Rationals, terms);
            carry = self.ring.sub(&own, &self.ring.mul(&carry, &rest));
            if k > lowest {
                let shifted = self.ring.mul(&carry, &self.ring.power(w, k - 1));
                self.ring.add_assign(&mut quotient, &shifted);
            }
        }
        carry.is_zero().then(|| self.ring.scale(&quotient, &inverse))
    }
}

fn polynomial(numerator: Polynomial) -> ParameterFraction {
    ParameterFraction { numerator, denominator: BTreeMap::new() }
}

fn expand(form: &[(Option<u16>, Integer)]) -> Polynomial {
    let term = |(index, n): &(Option<u16>, Integer)| {
        let power = |index| PowerProduct::power(Symbol::Parameter(index), 1);
        (index.map_or_else(PowerProduct::unit, power), Rational::from(n))
    };
    Sparse::collect(&Rationals, form.iter().map(term))
}

/// p = factor * form with a single term and a primitive linear form of two or more terms.
fn split_linear(p: &Polynomial) -> Option<((PowerProduct, Rational), LinearForm)> {
    let mut common: Option<BTreeMap<Symbol, i16>> = None;
    for (m, _) in p.terms() {
        let own: BTreeMap<Symbol, i16> = m.factors().iter().copied().collect();
        common = Some(match common {
            None => own,
            Some(known) => {
                let symbols = known.keys().chain(own.keys()).copied().collect::<Vec<_>>();
                let get = |map: &BTreeMap<Symbol, i16>, s| map.get(&s).copied().unwrap_or(0);
                symbols.into_iter().map(|s| (s, get(&known, s).min(get(&own, s)))).collect()
            }
        });
    }
    let mut monomial = PowerProduct::unit();
    for (symbol, exponent) in common? {
        monomial = monomial.times(&PowerProduct::power(symbol, exponent));
    }
    let mut inverse = PowerProduct::unit();
    for &(symbol, exponent) in monomial.factors() {
        inverse = inverse.times(&PowerProduct::power(symbol, exponent.checked_neg()?));
    }
    let (mut numerators, mut denominators) = (Integer::new(), Integer::from(1));
    let mut linear = BTreeMap::new();
    for (m, c) in p.terms() {
        let reduced = m.times(&inverse);
        let index = match reduced.factors() {
            [] => None,
            [(Symbol::Parameter(index), 1)] => Some(*index),
            _ => return None,
        };
        numerators.gcd_mut(c.numer());
        denominators.lcm_mut(c.denom());
        linear.insert(index, c.clone());
    }
    let mut content = Rational::from((numerators, denominators));
    if linear.values().next()?.is_negative() {
        content = -content;
    }
    let integral = |(index, c): (Option<u16>, Rational)| (index, (c / &content).numer().clone());
    let form: LinearForm = linear.into_iter().map(integral).collect();
    (form.len() > 1).then_some(((monomial, content), form))
}

impl Ring for ParameterField {
    type Element = ParameterFraction;

    fn zero(&self) -> ParameterFraction {
        polynomial(self.ring.zero())
    }
    fn one(&self) -> ParameterFraction {
        polynomial(self.ring.one())
    }
    fn is_zero(&self, a: &ParameterFraction) -> bool {
        a.numerator.is_zero()
    }
    fn add_assign(&self, a: &mut ParameterFraction, b: &ParameterFraction) {
        if a.denominator.is_empty() && b.denominator.is_empty() {
            self.ring.add_assign(&mut a.numerator, &b.numerator);
            return;
        }
        let mut common = a.denominator.clone();
        for (form, &exponent) in &b.denominator {
            let known = common.entry(form.clone()).or_insert(0);
            *known = exponent.max(*known);
        }
        let over = |f: &ParameterFraction| {
            let mut numerator = f.numerator.clone();
            for (form, exponent) in &common {
                let own = f.denominator.get(form).copied().unwrap_or(0);
                for _ in own..*exponent {
                    numerator = self.ring.mul(&numerator, &expand(form));
                }
            }
            numerator
        };
        let sum = self.ring.add(&over(a), &over(b));
        *a = self.canonical(sum, common);
    }
    fn neg(&self, a: &ParameterFraction) -> ParameterFraction {
        ParameterFraction {
            numerator: self.ring.neg(&a.numerator),
            denominator: a.denominator.clone(),
        }
    }
    fn mul(&self, a: &ParameterFraction, b: &ParameterFraction) -> ParameterFraction {
        let numerator = self.ring.mul(&a.numerator, &b.numerator);
        let mut denominator = a.denominator.clone();
        for (form, exponent) in &b.denominator {
            *denominator.entry(form.clone()).or_insert(0) += exponent;
        }
        self.canonical(numerator, denominator)
    }
    /// Products over the same denominator are reduced once, in their sum.
    fn sum_of_products(
        &self,
        pairs: &[(&ParameterFraction, &ParameterFraction)],
    ) -> ParameterFraction {
        let mut groups: BTreeMap<BTreeMap<&LinearForm, u32>, Vec<_>> = BTreeMap::new();
        for (a, b) in pairs {
            let mut denominator: BTreeMap<_, u32> = BTreeMap::new();
            for (form, exponent) in a.denominator.iter().chain(&b.denominator) {
                *denominator.entry(form).or_default() += exponent;
            }
            groups.entry(denominator).or_default().push((&a.numerator, &b.numerator));
        }
        let mut sum = self.zero();
        for (denominator, list) in groups {
            let denominator = denominator.into_iter().map(|(form, n)| (form.clone(), n)).collect();
            let part = self.canonical(self.ring.sum_of_products(&list), denominator);
            self.add_assign(&mut sum, &part);
        }
        sum
    }
}

impl RationalAlgebra for ParameterField {
    fn rational(&self, q: &Rational) -> ParameterFraction {
        polynomial(self.ring.rational(q))
    }
    fn scale(&self, a: &ParameterFraction, q: &Rational) -> ParameterFraction {
        if q.is_zero() {
            return self.zero();
        }
        ParameterFraction {
            numerator: self.ring.scale(&a.numerator, q),
            denominator: a.denominator.clone(),
        }
    }
    /// Of a single term without sines and cosines, or of such a term times a linear form.
    fn reciprocal(&self, a: &ParameterFraction) -> Option<ParameterFraction> {
        let is_pair = |symbol: Symbol| {
            let matches = |i: u16| symbol == Symbol::Parameter(i);
            self.pairs.iter().any(|&(cos, sin)| matches(cos) || matches(sin))
        };
        let has_pair = |p: &Polynomial| {
            p.terms().iter().any(|(m, _)| m.factors().iter().any(|&(s, _)| is_pair(s)))
        };
        if has_pair(&a.numerator) {
            return None;
        }
        let mut denominator = BTreeMap::new();
        let plain = |form: &LinearForm| self.affine || form.iter().all(|(i, _)| i.is_some());
        let inverse = match split_linear(&a.numerator).filter(|(_, form)| plain(form)) {
            Some(((monomial, content), form)) => {
                denominator.insert(form, 1);
                self.ring.reciprocal(&Sparse::term(&Rationals, monomial, content))?
            }
            None => self.ring.reciprocal(&a.numerator)?,
        };
        let mut numerator = inverse;
        for (form, exponent) in &a.denominator {
            for _ in 0..*exponent {
                numerator = self.ring.mul(&numerator, &expand(form));
            }
        }
        Some(self.canonical(numerator, denominator))
    }
    fn as_rational(&self, a: &ParameterFraction) -> Option<Rational> {
        let whole = a.denominator.is_empty();
        whole.then(|| self.ring.as_rational(&a.numerator)).flatten()
    }
}

impl Print for ParameterField {
    fn print_terms(&self, a: &ParameterFraction, style: Style) -> Vec<Term> {
        if a.denominator.is_empty() {
            return self.ring.print_terms(&a.numerator, style);
        }
        let factor = |(form, &exponent): (&LinearForm, &u32)| {
            let base = parenthesize(&self.ring.print(&expand(form), style), style);
            power(&base, -i64::from(exponent), style)
        };
        vec![self.ring.factor(&a.numerator, style).times(a.denominator.iter().map(factor))]
    }

    fn print(&self, a: &ParameterFraction, style: Style) -> String {
        match a.denominator.is_empty() {
            true => self.ring.print(&a.numerator, style),
            false => print_sum(&self.print_terms(a, style), style),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::laws;

    /// Parameters alpha, omega, P, cos, sin.
    fn field() -> ParameterField {
        let names = ["alpha", "omega", "P0", "cos(phi)", "sin(phi)"].map(str::to_owned);
        let ring = PolynomialRing { parameters: names.to_vec() };
        ParameterField { ring, pairs: vec![(3, 4)], affine: true }
    }

    #[test]
    fn laws_hold() {
        let k = field();
        let [alpha, omega, p, cos, sin] = [0, 1, 2, 3, 4].map(|i| k.parameter(i));
        let difference = k.sub(&alpha, &omega);
        let inverse = k.reciprocal(&difference).unwrap_or_else(|| k.zero());
        let sum = k.add(
            &k.scale(&alpha, &Rational::from((4, 3))),
            &k.scale(&omega, &Rational::from((2, 3))),
        );
        let other = k.reciprocal(&sum).unwrap_or_else(|| k.zero());
        let mixed = k.add(&k.mul(&p, &inverse), &k.mul(&sin, &other));
        let trigonometric = k.add(&k.mul(&sin, &sin), &k.mul(&cos, &cos));
        assert_eq!(trigonometric, k.one());
        assert_eq!(k.mul(&difference, &inverse), k.one());
        let samples = [k.zero(), k.one(), difference, inverse, other, mixed, sin];
        assert_eq!(laws::rational_algebra(&k, &samples), Ok(()));
    }

    #[test]
    fn fractions_are_canonical_and_factored() {
        let k = field();
        let [alpha, omega, p] = [0, 1, 2].map(|i| k.parameter(i));
        let inverse = |f: &ParameterFraction| k.reciprocal(f).unwrap_or_else(|| k.zero());
        let (minus, plus) = (k.sub(&alpha, &omega), k.add(&alpha, &omega));
        // 1/(alpha - omega) + 1/(alpha + omega) = 2 alpha/((alpha - omega)(alpha + omega)).
        let sum = k.add(&inverse(&minus), &inverse(&plus));
        let product = k.mul(&inverse(&minus), &inverse(&plus));
        assert_eq!(sum, k.scale(&k.mul(&alpha, &product), &Rational::from(2)));
        let amplitude = k.mul(&p, &product);
        let shown = "P0*(alpha - omega)^(-1)*(alpha + omega)^(-1)";
        assert_eq!(k.print(&amplitude, Style::Text), shown);
        // (alpha^2 - omega^2)/(alpha - omega) cancels.
        let squares = k.sub(&k.mul(&alpha, &alpha), &k.mul(&omega, &omega));
        assert_eq!(k.mul(&squares, &inverse(&minus)), plus);
        // 1/(1 - omega) - 1/(2 - 2 omega) = 1/(2 (1 - omega)), and 1 - omega^2 contains it.
        let [single, double] = [1, 2].map(|n| {
            let n = Rational::from(n);
            inverse(&k.sub(&k.rational(&n), &k.scale(&omega, &n)))
        });
        assert_eq!(k.sub(&single, &double), k.scale(&single, &Rational::from((1, 2))));
        let squares = k.sub(&k.one(), &k.mul(&omega, &omega));
        assert_eq!(k.mul(&squares, &single), k.add(&k.one(), &omega));
        assert_eq!(k.print(&single, Style::Text), "(1 - omega)^(-1)");
        let homogeneous = ParameterField { affine: false, ..field() };
        assert_eq!(homogeneous.reciprocal(&k.sub(&k.one(), &omega)), None);
        // A product of two is no linear form: refused, not expanded.
        assert_eq!(k.reciprocal(&squares), None);
        let value = |i: u16| Rational::from(i + 2);
        assert_eq!(k.evaluate(&Rationals, &amplitude, value), Some(Rational::from((4, -5))));
        assert_eq!(k.evaluate(&Rationals, &amplitude, |_| Rational::from(1)), None);
    }
}
