//! The limit cycles of an averaged oscillator and their Floquet exponents, as exact series.
//!
//! a -> -a with psi -> psi + pi changes nothing, so that A_n = a R_n(a^2) and B_n are polynomials in
//! rho = a^2. With R_k the first that does not vanish, a cycle is a zero of
//!
//!   G(rho) = sum_{n >= k} eps^{n-k} R_n(rho),   rho = r + eps rho_1 + ...,   R_k(r) = 0, r > 0:
//!
//! rho_j is algebraic over Q, an element of Q\[r\]/m for every factor m of R_k with simple roots, and one
//! series holds at all roots of m. The nontrivial exponent per unit of t is A'(a) there,
//!
//!   lambda = 2 rho eps^k dG/drho,   of order k: 2 r R_k'(r) eps^k + ...,   not zero at a simple root;
//!
//! the other one is 0, along psi. The frequency is psi' there. At a multiple root of R_k there is no such
//! series (cycles may meet): it is named.

use super::{AveragedExpansion, Coefficient};
use crate::error::DerivationError as Error;
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePower};
use lindstedt_coeff::print::{Style, Term, parenthesize, power, print_sum};
use lindstedt_number::Number;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::Series;
use lindstedt_series::univariate::{
    Residues, positive_roots, rational_root, refined, simple_and_multiple, trim,
};
use rug::Rational;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::cmp::Ordering;

/// The limit cycles of an averaged oscillator whose amplitude tends to a number other than 0 with the small parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Cycles {
    /// k: the first order with A_k != 0.
    pub leading_order: usize,
    /// All of them, by increasing amplitude.
    pub cycles: Vec<Cycle>,
    /// a_0 of the multiple roots, where amplitude and exponent are no power series in the small parameter.
    pub degenerate: Vec<Number>,
}

/// One limit cycle, exact: coefficients are polynomials in r = a_0^2.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Cycle {
    /// m, monic, from the constant on: m(r) = 0. Of degree 1 where r is rational.
    pub polynomial: Vec<Rational>,
    /// An interval with r and no other root of m.
    root: [Rational; 2],
    /// a_0, the amplitude at order zero.
    pub amplitude: Number,
    /// Orders 0, 1, ... of a^2.
    pub squared_amplitude: Vec<Algebraic>,
    /// Orders 0, 1, ... of the Floquet exponent per unit of t.
    pub exponent: Vec<Algebraic>,
    /// Orders 0, 1, ... of the frequency.
    pub frequency: Vec<Algebraic>,
    /// Whether the exponent is negative for small positive values of the small parameter.
    pub stable: bool,
}

/// c_0 + c_1 r + ... and its value.
#[derive(Clone, Debug, Serialize)]
pub struct Algebraic {
    /// c_0, c_1, ...
    #[serde(skip)]
    pub element: Vec<Rational>,
    /// The value, with the polynomial as its exact form.
    #[serde(flatten)]
    pub number: Number,
}

impl Serialize for Cycle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("polynomial", &self.print_polynomial(Style::Text))?;
        map.serialize_entry("amplitude", &self.amplitude)?;
        map.serialize_entry("squared_amplitude", &self.squared_amplitude)?;
        map.serialize_entry("floquet_exponent", &self.exponent)?;
        // Its older name.
        map.serialize_entry("exponent", &self.exponent)?;
        map.serialize_entry("frequency", &self.frequency)?;
        map.serialize_entry("stable", &self.stable)?;
        map.end()
    }
}

/// The terms of a polynomial in r.
fn terms(list: &[Rational], style: Style) -> Vec<Term> {
    let terms = (0i64..).zip(list).filter(|(_, c)| !c.is_zero());
    let term = |(k, c): (i64, &Rational)| Term {
        coefficient: c.clone(),
        factors: (k > 0).then(|| power("r", k, style)).into_iter().collect(),
    };
    terms.map(term).collect()
}

fn print(list: &[Rational], style: Style) -> String {
    print_sum(&terms(list, style), style)
}

/// c_0 + c_1 small + ... with polynomials in r as coefficients.
#[must_use]
pub fn print_series(series: &[Algebraic], small: &str, style: Style) -> String {
    let mut sum = Vec::new();
    for (n, c) in (0i64..).zip(series).filter(|(_, c)| !c.element.is_empty()) {
        let factor = (n > 0).then(|| power(small, n, style));
        sum.push(match <[Term; 1]>::try_from(terms(&c.element, style)) {
            Ok([single]) => single.times(factor),
            Err(list) => {
                let line = print_sum(&list, style);
                let line = if n > 0 { parenthesize(&line, style) } else { line };
                Term { coefficient: Rational::from(1), factors: vec![line] }.times(factor)
            }
        });
    }
    print_sum(&sum, style)
}

impl Cycle {
    /// m(r), whose root r = a_0^2 is.
    #[must_use]
    pub fn print_polynomial(&self, style: Style) -> String {
        print(&self.polynomial, style)
    }

    /// A coefficient with so many bits.
    #[must_use]
    pub fn enclosed(&self, coefficient: &Algebraic, balls: Balls) -> Ball {
        value(&coefficient.element, &enclosed(&self.polynomial, &self.root, balls), balls)
    }

    /// Whether a_0^2 is rational: then all coefficients are.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.polynomial.len() <= 2
    }
}

/// The limit cycle of rates of which R_k has one zero r = a_0^2 other than 0, by formulas or enclosures: where r > 0.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SingleCycle {
    /// k: the first order with A_k != 0.
    pub leading_order: usize,
    /// Orders 0, 1, ... of a^2.
    pub squared_amplitude: Vec<Coefficient>,
    /// Orders 0, 1, ... of the Floquet exponent per unit of t.
    #[serde(rename = "floquet_exponent")]
    pub exponent: Vec<Coefficient>,
    /// Orders 0, 1, ... of the frequency.
    pub frequency: Vec<Coefficient>,
}

/// Coefficients of a polynomial in rho.
type InSquare<E> = Vec<E>;

/// f/a^offset as a polynomial in a^2, if it is one.
fn in_square<K: Ring>(
    ring: &K,
    f: &AmplitudePolynomial<K::Element>,
    offset: i32,
) -> Option<InSquare<K::Element>> {
    let mut list = InSquare::new();
    for (AmplitudePower(exponent), c) in f.terms() {
        let twice = usize::try_from(exponent - offset).ok().filter(|e| e % 2 == 0)?;
        list.resize(list.len().max(twice / 2 + 1), ring.zero());
        ring.add_assign(&mut list[twice / 2], c);
    }
    Some(list)
}

/// What the cycles come from: R_n and B_n, from n = 0.
struct Rates<E> {
    amplitude: Vec<InSquare<E>>,
    phase: Vec<InSquare<E>>,
    leading_order: usize,
}

/// a^2, the Floquet exponent and the frequency, order by order.
type CycleSeries<E> = [Vec<E>; 3];

/// The one cycle of R_k = rho^m (c_0 + c_1 rho) over any ring with its k; nothing where R_k has another form, or c_1 cannot be divided
/// by or told from zero.
pub(super) fn single_cycle<K: RationalAlgebra>(
    ring: &K,
    frequency: &K::Element,
    expansion: &AveragedExpansion<K::Element>,
) -> Option<(usize, CycleSeries<K::Element>)> {
    let rates = Rates::of(ring, frequency, expansion)?;
    let leading = &rates.amplitude[rates.leading_order];
    let known = |c: &&K::Element| ring.is_zero(c) || !ring.may_vanish(c);
    let mut others = leading.iter().filter(|c| !ring.is_zero(c));
    let ([.., constant, slope], 2) = (&leading[..], others.by_ref().count()) else { return None };
    if !leading.iter().all(|c| known(&c)) || ring.is_zero(constant) {
        return None;
    }
    let root = ring.neg(&ring.mul(constant, &ring.reciprocal(slope)?));
    Some((rates.leading_order, series(ring, &rates, root)?))
}

/// The cycles, their coefficients with so many digits; nothing where every A_n vanishes, none depends on
/// a, or the rates are not of that form.
pub(super) fn cycles(
    frequency: &Rational,
    expansion: &AveragedExpansion<Rational>,
    digits: usize,
) -> Result<Option<Cycles>, Error> {
    let Some(rates) = Rates::of(&Rationals, frequency, expansion) else { return Ok(None) };
    let leading_order = rates.leading_order;
    let at_zero = |c: &&Rational| c.is_zero();
    let zeros = rates.amplitude[leading_order].iter().take_while(at_zero).count();
    let [mut simple, multiple] = simple_and_multiple(&rates.amplitude[leading_order][zeros..]);
    let mut found = Vec::new();
    while let Some(root) = rational_root(&simple).filter(|_| simple.len() > 2) {
        let factor = vec![-root, Rational::from(1)];
        [simple, _] = lindstedt_series::univariate::divided(&simple, &factor);
        found.extend(rates.at_roots(factor, digits)?);
    }
    if simple.len() > 1 {
        found.extend(rates.at_roots(simple, digits)?);
    }
    found.sort_by(by_amplitude);
    let mut degenerate = Vec::new();
    for root in positive_roots(&multiple) {
        degenerate.push(root_of_root(&multiple, &root, digits)?);
    }
    Ok(Some(Cycles { leading_order, cycles: found, degenerate }))
}

/// Two different roots, in intervals that are made so short that they lie apart.
fn by_amplitude(a: &Cycle, b: &Cycle) -> Ordering {
    for doublings in 0..16 {
        let [x, y] = [a, b].map(|cycle| refined(&cycle.polynomial, &cycle.root, 32 << doublings));
        if x[1] < y[0] {
            return Ordering::Less;
        }
        if y[1] < x[0] {
            return Ordering::Greater;
        }
    }
    Ordering::Equal
}

/// c_0 + c_1 r + ...
fn value(element: &[Rational], r: &Ball, balls: Balls) -> Ball {
    let step = |sum: Ball, c| balls.add(&balls.mul(&sum, r), &balls.from_rational(c));
    element.iter().rev().fold(balls.zero(), step)
}

/// The sign of an element that is not 0 at a root.
fn is_negative(element: &[Rational], polynomial: &[Rational], root: &[Rational; 2]) -> bool {
    let at = |bits| {
        let balls = Balls::new(bits);
        value(element, &enclosed(polynomial, root, balls), balls)
    };
    let apart = (0..16).map(|doublings| at(32 << doublings)).find(|ball| !ball.contains_zero());
    apart.is_some_and(|ball| ball.is_negative())
}

/// A root of a polynomial at so many bits.
fn enclosed(polynomial: &[Rational], root: &[Rational; 2], balls: Balls) -> Ball {
    let [low, high] = refined(polynomial, root, balls.bits());
    balls.hull(&balls.from_rational(&low), &balls.from_rational(&high))
}

/// sqrt r, exact where it is rational.
fn root_of_root(
    polynomial: &[Rational],
    root: &[Rational; 2],
    digits: usize,
) -> Result<Number, Error> {
    let [low, high] = refined(polynomial, root, 1);
    let rational =
        if low == high { lindstedt_equation::classify::rational_root(&low) } else { None };
    let exact = rational.map(|q| q.to_string());
    let value = |balls: Balls| balls.sqrt(&enclosed(polynomial, root, balls));
    Ok(lindstedt_number::certified(exact, digits, value)?)
}

impl<E: Clone> Rates<E> {
    /// Nothing where every A_n vanishes, none depends on a, or the rates are not of that form.
    fn of<K: RationalAlgebra<Element = E>>(
        ring: &K,
        frequency: &E,
        expansion: &AveragedExpansion<E>,
    ) -> Option<Self> {
        let in_squares = |list: &[AmplitudePolynomial<E>], offset| {
            list.iter().map(|f| in_square(ring, f, offset)).collect::<Option<Vec<_>>>()
        };
        let amplitude = in_squares(&expansion.amplitude_rate, 1)?;
        let mut phase = in_squares(&expansion.phase_rate, 0)?;
        if amplitude.iter().all(|r| r.len() < 2) {
            return None;
        }
        phase[0] = vec![frequency.clone()];
        let leading_order = amplitude.iter().position(|r| !r.is_empty())?;
        Some(Self { amplitude, phase, leading_order })
    }

    fn map<T>(&self, f: impl Fn(&E) -> T) -> Rates<T> {
        let each =
            |lists: &[InSquare<E>]| lists.iter().map(|p| p.iter().map(&f).collect()).collect();
        Rates {
            amplitude: each(&self.amplitude),
            phase: each(&self.phase),
            leading_order: self.leading_order,
        }
    }
}

impl Rates<Rational> {
    /// One cycle for every positive root of a factor.
    fn at_roots(&self, modulus: Vec<Rational>, digits: usize) -> Result<Vec<Cycle>, Error> {
        let roots = positive_roots(&modulus);
        let field = Residues::new(modulus);
        let over = self.map(|c| field.rational(c));
        let found = series(&field, &over, field.root()).filter(|_| !roots.is_empty());
        let Some(found) = found else { return Ok(Vec::new()) };
        let [square, exponent, frequency] =
            found.map(|list| list.into_iter().map(trim).collect::<Vec<_>>());
        let mut list = Vec::new();
        for root in roots {
            let modulus = field.modulus();
            let number = |element: &Vec<Rational>| {
                let value = |balls| Some(value(element, &enclosed(modulus, &root, balls), balls));
                let exact = Some(print(element, Style::Text));
                let number = lindstedt_number::certified(exact, digits, value)?;
                Ok(Algebraic { element: element.clone(), number })
            };
            let numbers =
                |list: &[Vec<Rational>]| list.iter().map(number).collect::<Result<Vec<_>, Error>>();
            let exponent = numbers(&exponent)?;
            let leading = &exponent[self.leading_order].element;
            list.push(Cycle {
                polynomial: modulus.to_vec(),
                amplitude: root_of_root(modulus, &root, digits)?,
                squared_amplitude: numbers(&square)?,
                stable: is_negative(leading, modulus, &root),
                frequency: numbers(&frequency)?,
                exponent,
                root,
            });
        }
        Ok(list)
    }
}

/// a^2, lambda and the frequency over a ring with a zero r of R_k, as far as the orders of the rates reach; nothing where
/// the slope there cannot be divided by.
fn series<F: RationalAlgebra>(
    field: &F,
    rates: &Rates<F::Element>,
    root: F::Element,
) -> Option<CycleSeries<F::Element>> {
    let k = rates.leading_order;
    let orders = rates.amplitude.len() - k;
    let slope = |r: &InSquare<F::Element>| {
        let term = |(n, c): (u32, &F::Element)| field.scale(c, &Rational::from(n));
        (1u32..).zip(&r[r.len().min(1)..]).map(term).collect()
    };
    let slopes: Vec<InSquare<F::Element>> = rates.amplitude.iter().map(slope).collect();
    let mut square = vec![root];
    let slope = sum(field, &slopes[k..], &square, 1).swap_remove(0);
    let inverse = field.reciprocal(&slope)?;
    for n in 1..orders {
        square.push(field.zero());
        let gap = sum(field, &rates.amplitude[k..], &square, n + 1).swap_remove(n);
        square[n] = field.neg(&field.mul(&gap, &inverse));
    }
    let slope = sum(field, &slopes[k..], &square, orders);
    let twice = Series::truncated(square.clone()).map(|c| field.scale(c, &Rational::from(2)));
    let exponent = twice.mul(field, &Series::truncated(slope), orders - 1).coefficients;
    let exponent = std::iter::repeat_n(field.zero(), k).chain(exponent).collect();
    // B_0 does not depend on a.
    let frequency = sum(field, &rates.phase, &square, orders + 1);
    Some([square, exponent, frequency])
}

/// The first orders of sum eps^n p_n(rho) along the series of rho; of order 0 of p_n rho is not needed
/// where p_0 is constant.
fn sum<F: RationalAlgebra>(
    field: &F,
    list: &[InSquare<F::Element>],
    square: &[F::Element],
    orders: usize,
) -> Vec<F::Element> {
    let mut rho = square.to_vec();
    rho.resize(orders, field.zero());
    let rho = Series::truncated(rho);
    let mut total = vec![field.zero(); orders];
    for (n, p) in list.iter().enumerate().take(orders) {
        let constant = |c: F::Element| {
            let mut list = vec![field.zero(); orders];
            list[0] = c;
            Series::truncated(list)
        };
        let step = |sum: Series<_>, c: &F::Element| {
            sum.mul(field, &rho, orders - 1).add(field, &constant(c.clone()))
        };
        let value = p.iter().rev().fold(constant(field.zero()), step);
        for (own, c) in total[n..].iter_mut().zip(&value.coefficients) {
            field.add_assign(own, c);
        }
    }
    total
}
