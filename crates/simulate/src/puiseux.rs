//! Series in the fractional powers d^(i + j theta) of the distance d >= 0 from a branch point.
//!
//! Where |w|^p meets w = 0 the solution is such a series (theta the fractional part of p), and
//! sums, products, quotients and functions of such series are again. Coefficients follow from
//! those of the Taylor recurrences with the exponents in place of the orders: with u = c d^e + ...
//! and d u' = e c d^e + ..., b = (1 + u)^p has e b_e = sum_f (p f - (e - f)) u_f b_(e-f).

use crate::integrator::real::Real;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// i + j theta.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exponent {
    pub(crate) value: f64,
    whole: i32,
    parts: i32,
}

impl PartialEq for Exponent {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Exponent {}
impl PartialOrd for Exponent {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Exponent {
    fn cmp(&self, other: &Self) -> Ordering {
        let keys = (self.whole, self.parts).cmp(&(other.whole, other.parts));
        self.value.total_cmp(&other.value).then(keys)
    }
}

/// A series: the coefficients that are not zero, by increasing exponent.
pub(crate) type Terms<E> = BTreeMap<Exponent, E>;

/// Functions with more terms have exponents too close together (theta near 0) to be worth while.
pub(crate) const MOST_TERMS: usize = 2000;
/// Powers of the argument of a sine, likewise.
const MOST_POWERS: u32 = 200;

/// The same as a list.
type List<E> = Vec<(Exponent, E)>;

/// The exponents, and where the series are cut off.
#[derive(Clone, Debug)]
pub(crate) struct Lattice<R: Real> {
    pub(crate) real: R,
    theta: R::Element,
    value: f64,
    /// theta = a/b with small b: j is reduced to 0..b, so that no exponent has two names.
    ratio: Option<(i32, i32)>,
    pub(crate) cut: f64,
    /// Whether a function has had too many terms.
    dense: Arc<AtomicBool>,
}

impl<R: Real> Lattice<R> {
    /// For |w|^power; nothing for an integer.
    pub(crate) fn new(real: &R, power: &R::Element, cut: f64) -> Option<Self> {
        let whole = real.to_f64(power).floor();
        let theta = real.difference(power, &real.double(whole));
        let value = real.to_f64(&theta);
        if real.sign(&theta) <= 0 || whole.abs() > 1000.0 {
            return None;
        }
        let ratio = (2..=64).find_map(|b: i32| {
            let mut multiple = theta.clone();
            real.times_integer(&mut multiple, b);
            let a = real.to_f64(&multiple).round();
            let rest = real.log2(&real.difference(&multiple, &real.double(a)));
            (rest < 8.0 - f64::from(real.bits())).then_some((a as i32, b))
        });
        let dense = Arc::default();
        Some(Self { real: real.clone(), theta, value, ratio, cut, dense })
    }

    /// Whether a function was refused for having too many terms.
    pub(crate) fn is_dense(&self) -> bool {
        self.dense.load(Relaxed)
    }

    fn exponent(&self, whole: i32, parts: i32) -> Exponent {
        let (whole, parts) = match self.ratio {
            Some((a, b)) => (whole + a * parts.div_euclid(b), parts.rem_euclid(b)),
            None => (whole, parts),
        };
        Exponent { value: f64::from(whole) + f64::from(parts) * self.value, whole, parts }
    }

    /// The exponent of a constant (0) or of d itself (1).
    pub(crate) fn integer(&self, n: i32) -> Exponent {
        self.exponent(n, 0)
    }

    fn sum_of(&self, a: Exponent, b: Exponent) -> Exponent {
        self.exponent(a.whole + b.whole, a.parts + b.parts)
    }

    /// i + j theta as an element.
    fn element(&self, e: Exponent) -> R::Element {
        let mut element = self.theta.clone();
        self.real.times_integer(&mut element, e.parts);
        self.real.sum(&element, &self.real.double(f64::from(e.whole)))
    }

    pub(crate) fn constant(&self, c: &R::Element) -> Terms<R::Element> {
        let mut terms = Terms::new();
        self.put(&mut terms, self.integer(0), c);
        terms
    }

    /// Adds a term, if it is not zero and not beyond the cut.
    pub(crate) fn put(&self, terms: &mut Terms<R::Element>, e: Exponent, c: &R::Element) {
        if e.value > self.cut || self.real.sign(c) == 0 {
            return;
        }
        let place = terms.entry(e).or_insert_with(|| self.real.zero());
        self.real.increase(place, c);
        if self.real.sign(place) == 0 {
            terms.remove(&e);
        }
    }

    /// a + b, or a - b.
    pub(crate) fn sum(
        &self,
        a: &Terms<R::Element>,
        b: &Terms<R::Element>,
        sign: i32,
    ) -> Terms<R::Element> {
        let mut total = a.clone();
        for (e, c) in b {
            let mut c = c.clone();
            self.real.times_integer(&mut c, sign);
            self.put(&mut total, *e, &c);
        }
        total
    }

    pub(crate) fn scale(&self, a: &Terms<R::Element>, factor: &R::Element) -> Terms<R::Element> {
        a.iter().map(|(e, c)| (*e, self.real.product(c, factor))).collect()
    }

    pub(crate) fn product(
        &self,
        a: &Terms<R::Element>,
        b: &Terms<R::Element>,
    ) -> Terms<R::Element> {
        let mut total = Terms::new();
        for (e, x) in a {
            for (f, y) in b {
                if e.value + f.value > self.cut + 1e-9 {
                    break;
                }
                self.put(&mut total, self.sum_of(*e, *f), &self.real.product(x, y));
            }
        }
        total
    }

    /// a^p; nothing where it is no such series.
    pub(crate) fn power(&self, a: &Terms<R::Element>, p: &R::Element) -> Option<Terms<R::Element>> {
        let real = &self.real;
        let (lead, first) = a.first_key_value()?;
        let floor = real.to_f64(p).floor();
        let fraction = real.difference(p, &real.double(floor));
        let whole = floor as i32;
        let integer = real.sign(&fraction) == 0;
        if floor.abs() > 1000.0 || !integer && real.sign(first) < 0 {
            return None;
        }
        let shift = match (lead.whole, lead.parts) {
            (0, 0) => *lead,
            (i, j) if integer => self.exponent(i.checked_mul(whole)?, j.checked_mul(whole)?),
            // d^(i p), p = floor + theta.
            (i, 0) if fraction == self.theta => self.exponent(i.checked_mul(whole)?, i),
            _ => return None,
        };
        let mut front = real.zero();
        real.power(&mut front, &real.absolute(first), p);
        if real.sign(first) < 0 && whole % 2 != 0 {
            real.times_integer(&mut front, -1);
        }
        let inverse = real.quotient(&real.double(1.0), first);
        let back = self.exponent(-lead.whole, -lead.parts);
        let u: List<R::Element> = (a.iter().skip(1))
            .map(|(e, c)| (self.sum_of(*e, back), real.product(c, &inverse)))
            .collect();
        // The result begins at `shift`: it needs 1 + u up to cut - shift.
        let reach = self.cut - shift.value;
        let series = self.recurrence(&u, reach, real.double(1.0), |e, f| {
            real.difference(&real.product(p, f), e)
        })?;
        let mut total = Terms::new();
        for (e, c) in &series {
            self.put(&mut total, self.sum_of(*e, shift), &real.product(c, &front));
        }
        Some(total)
    }

    /// b with b_0 given and (e + f) b_(e+f) = sum weight(e, f) u_f b_e: every coefficient, once
    /// known, is pushed on to those that need it.
    fn recurrence(
        &self,
        u: &[(Exponent, R::Element)],
        reach: f64,
        first: R::Element,
        weight: impl Fn(&R::Element, &R::Element) -> R::Element,
    ) -> Option<Terms<R::Element>> {
        let real = &self.real;
        let u: Vec<(Exponent, R::Element, R::Element)> =
            u.iter().map(|(f, c)| (*f, c.clone(), self.element(*f))).collect();
        if u.first().is_some_and(|(f, ..)| f.value < 1e-9) {
            return None;
        }
        let mut done = Terms::new();
        let mut open = Terms::from([(self.integer(0), first)]);
        while let Some((e, value)) = open.pop_first() {
            let exponent = self.element(e);
            let known = if done.is_empty() { value } else { real.quotient(&value, &exponent) };
            for (f, c, order) in &u {
                if e.value + f.value > reach + 1e-9 {
                    break;
                }
                let part = real.product(&real.product(&weight(&exponent, order), c), &known);
                let place = open.entry(self.sum_of(e, *f)).or_insert_with(|| real.zero());
                real.increase(place, &part);
            }
            done.insert(e, known);
            if done.len() > MOST_TERMS {
                self.dense.store(true, Relaxed);
                return None;
            }
        }
        Some(done)
    }

    /// a/b.
    pub(crate) fn quotient(
        &self,
        a: &Terms<R::Element>,
        b: &Terms<R::Element>,
    ) -> Option<Terms<R::Element>> {
        Some(self.product(a, &self.power(b, &self.real.double(-1.0))?))
    }

    /// The constant, and the rest; nothing if there are negative powers.
    fn split(&self, a: &Terms<R::Element>) -> Option<(R::Element, List<R::Element>)> {
        let zero = self.integer(0);
        if a.first_key_value().is_some_and(|(e, _)| *e < zero) {
            return None;
        }
        let constant = a.get(&zero).cloned().unwrap_or_else(|| self.real.zero());
        let rest = a.iter().filter(|(e, _)| **e != zero).map(|(e, c)| (*e, c.clone()));
        Some((constant, rest.collect()))
    }

    pub(crate) fn exp(&self, a: &Terms<R::Element>) -> Option<Terms<R::Element>> {
        let (constant, u) = self.split(a)?;
        let mut first = self.real.zero();
        self.real.exp(&mut first, &constant);
        self.recurrence(&u, self.cut, first, |_, f| f.clone())
    }

    /// ln a = ln a_0 + integral of a'/a.
    pub(crate) fn ln(&self, a: &Terms<R::Element>) -> Option<Terms<R::Element>> {
        let real = &self.real;
        let (constant, u) = self.split(a)?;
        if real.sign(&constant) <= 0 {
            return None;
        }
        let slope = u.iter().map(|(e, c)| (*e, real.product(c, &self.element(*e)))).collect();
        let mut first = real.zero();
        real.ln(&mut first, &constant);
        let mut total = self.constant(&first);
        for (e, c) in self.quotient(&slope, a)? {
            self.put(&mut total, e, &real.quotient(&c, &self.element(e)));
        }
        Some(total)
    }

    /// (sin a, cos a), with sin(a_0 + u) and so on from the series of sin u and cos u in u; nothing
    /// with too many terms.
    pub(crate) fn sine(&self, a: &Terms<R::Element>) -> Option<[Terms<R::Element>; 2]> {
        let real = &self.real;
        let (constant, rest) = self.split(a)?;
        let u: Terms<R::Element> = rest.into_iter().collect();
        let (mut sin, mut cos) = (Terms::new(), self.constant(&real.double(1.0)));
        let mut term = cos.clone();
        for k in 1u32.. {
            term = self.product(&term, &u);
            if term.is_empty() {
                break;
            }
            if term.len() > MOST_TERMS || k > MOST_POWERS {
                self.dense.store(term.len() > MOST_TERMS, Relaxed);
                return None;
            }
            for c in term.values_mut() {
                real.over_integer(c, k);
            }
            let (to, sign) = if k % 2 == 1 { (&mut sin, k / 2) } else { (&mut cos, k / 2) };
            *to = self.sum(to, &term, if sign % 2 == 0 { 1 } else { -1 });
        }
        let (mut s, mut c) = (real.zero(), real.zero());
        real.sin(&mut s, &constant);
        real.cos(&mut c, &constant);
        let turned = |a: &R::Element, b: &R::Element, sign| {
            self.sum(&self.scale(&sin, a), &self.scale(&cos, b), sign)
        };
        let second = turned(&real.negative(&s), &c, 1);
        Some([turned(&c, &s, 1), second])
    }

    /// The integral from d = 0; nothing if it diverges.
    pub(crate) fn integral(&self, a: &Terms<R::Element>) -> Option<Terms<R::Element>> {
        let mut total = Terms::new();
        for (e, c) in a {
            let next = self.exponent(e.whole + 1, e.parts);
            if next.value < 1e-9 {
                return None;
            }
            self.put(&mut total, next, &self.real.quotient(c, &self.element(next)));
        }
        Some(total)
    }

    fn term(&self, e: Exponent, c: &R::Element, d: &R::Element) -> R::Element {
        let mut power = self.real.zero();
        self.real.power(&mut power, d, &self.element(e));
        self.real.scale(&mut power, c);
        power
    }

    /// The value at d without the constant.
    pub(crate) fn change(&self, a: &Terms<R::Element>, d: &R::Element) -> R::Element {
        let mut total = self.real.zero();
        if self.real.sign(d) > 0 {
            // The smallest first.
            for (e, c) in a.iter().rev().filter(|(e, _)| **e != self.integer(0)) {
                self.real.increase(&mut total, &self.term(*e, c, d));
            }
        }
        total
    }

    /// log2 of the sum of |terms| at d with exponents in (above, up_to], without the constant.
    pub(crate) fn size(
        &self,
        a: &Terms<R::Element>,
        d: &R::Element,
        (above, up_to): (f64, f64),
    ) -> f64 {
        let log = self.real.log2(d);
        let sizes = (a.iter())
            .filter(|(e, _)| e.value > above && e.value <= up_to && **e != self.integer(0))
            .map(|(e, c)| self.real.log2(c) + e.value * log);
        let (mut largest, mut count) = (f64::NEG_INFINITY, 0.0f64);
        for size in sizes {
            if size.is_nan() {
                return f64::INFINITY;
            }
            largest = largest.max(size);
            count += 1.0;
        }
        largest + count.max(1.0).log2()
    }
}
