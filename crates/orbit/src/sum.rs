//! Sums of products of waves in time, powers of the variables and of parameters, with their derivatives: what
//! an equation is read into.

use crate::operation::Operation;
use rug::{Complete, Rational};
use std::collections::BTreeMap;

/// a cos q t + b sin q t by q.
pub(crate) type Waves = BTreeMap<Rational, (Rational, Rational)>;

/// By what a derivative is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum By<'a> {
    Variable(usize),
    Parameter(&'a str),
}

/// A product of powers.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    /// x_1..x_N, x_1'..x_N', the functions, without zeros at the end.
    pub(crate) powers: Vec<u32>,
    /// Of parameters that are known within balls.
    pub(crate) parameters: BTreeMap<String, i32>,
    /// Of t, in the argument of a cosine or sine.
    pub(crate) time: u32,
}

/// A sum of products.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sum(pub(crate) BTreeMap<Key, Waves>);

impl Key {
    fn times(&self, other: &Self) -> Option<Self> {
        let (long, short) = match self.powers.len() >= other.powers.len() {
            true => (self, other),
            false => (other, self),
        };
        let mut product = long.clone();
        for (power, n) in product.powers.iter_mut().zip(&short.powers) {
            *power = power.checked_add(*n)?;
        }
        for (name, n) in &short.parameters {
            *product.parameters.entry(name.clone()).or_default() += n;
        }
        product.parameters.retain(|_, n| *n != 0);
        product.time += short.time;
        Some(product)
    }
}

impl Sum {
    pub(crate) fn number(q: Rational) -> Self {
        Self::term(Key::default(), q)
    }

    pub(crate) fn term(key: Key, q: Rational) -> Self {
        let waves = Waves::from([(Rational::new(), (q, Rational::new()))]);
        Self(BTreeMap::from([(key, waves)])).cleared()
    }

    pub(crate) fn variable(v: usize) -> Self {
        Self::power_of(v, 1)
    }

    fn power_of(v: usize, n: u32) -> Self {
        let mut powers = vec![0; v + 1];
        powers[v] = n;
        Self::term(Key { powers, ..Key::default() }, Rational::from(1))
    }

    /// cos q t or sin q t.
    pub(crate) fn wave(q: &Rational, sine: bool) -> Self {
        let mut waves = Waves::new();
        let one = Rational::from(1);
        match sine {
            true => add(&mut waves, q.clone(), Rational::new(), one),
            false => add(&mut waves, q.clone(), one, Rational::new()),
        }
        Self(BTreeMap::from([(Key::default(), waves)])).cleared()
    }

    fn cleared(mut self) -> Self {
        for waves in self.0.values_mut() {
            waves.retain(|_, (a, b)| !(a.is_zero() && b.is_zero()));
        }
        self.0.retain(|_, waves| !waves.is_empty());
        self
    }

    pub(crate) fn plus(mut self, other: &Self) -> Self {
        for (key, waves) in &other.0 {
            let sum = self.0.entry(key.clone()).or_default();
            waves.iter().for_each(|(q, (a, b))| add(sum, q.clone(), a.clone(), b.clone()));
        }
        self.cleared()
    }

    pub(crate) fn scaled(&self, q: &Rational) -> Self {
        let mut scaled = self.clone();
        for (a, b) in scaled.0.values_mut().flat_map(BTreeMap::values_mut) {
            *a *= q;
            *b *= q;
        }
        scaled.cleared()
    }

    /// The product; nothing where a power is beyond all bounds or there are too many terms.
    pub(crate) fn times(&self, other: &Self) -> Option<Self> {
        if self.0.len().saturating_mul(other.0.len()) > MOST_PRODUCTS {
            return None;
        }
        let mut product = Self::default();
        for (k, f) in &self.0 {
            for (l, g) in &other.0 {
                let sum = product.0.entry(k.times(l)?).or_default();
                multiply(sum, f, g);
            }
        }
        let product = product.cleared();
        (product.0.len() <= MOST_TERMS).then_some(product)
    }

    pub(crate) fn power(&self, n: u32) -> Option<Self> {
        (0..n).try_fold(Self::number(Rational::from(1)), |power, _| power.times(self))
    }

    /// The number that this is.
    pub(crate) fn as_number(&self) -> Option<Rational> {
        match self.0.iter().next() {
            None => Some(Rational::new()),
            Some((key, waves))
                if self.0.len() == 1 && *key == Key::default() && waves.len() == 1 =>
            {
                waves.get(&Rational::new()).map(|(a, _)| a.clone())
            }
            _ => None,
        }
    }

    /// The total derivative, the functions being those of `functions` from the variable `first` on.
    pub(crate) fn by(
        &self,
        by: By<'_>,
        first: usize,
        functions: &[(Operation, Self)],
    ) -> Option<Self> {
        let mut sum = Self::default();
        for (key, waves) in &self.0 {
            let term = |lower: Key| Self(BTreeMap::from([(lower, waves.clone())]));
            if let By::Parameter(name) = by
                && let Some(n) = key.parameters.get(name)
            {
                let mut lower = key.clone();
                lower.parameters.insert(name.to_owned(), n - 1);
                lower.parameters.retain(|_, n| *n != 0);
                sum = sum.plus(&term(lower).scaled(&Rational::from(*n)));
            }
            for (w, n) in key.powers.iter().enumerate().filter(|(_, n)| **n > 0) {
                let inner = match w.checked_sub(first) {
                    None if by == By::Variable(w) => Self::number(Rational::from(1)),
                    None => continue,
                    Some(i) => derivative(i, first, functions)?
                        .times(&functions[i].1.by(by, first, functions)?)?,
                };
                let mut lower = key.clone();
                lower.powers[w] -= 1;
                while lower.powers.last() == Some(&0) {
                    lower.powers.pop();
                }
                sum = sum.plus(&term(lower).scaled(&Rational::from(*n)).times(&inner)?);
            }
        }
        Some(sum)
    }
}

/// The derivative of a function by its argument.
fn derivative(i: usize, first: usize, functions: &[(Operation, Sum)]) -> Option<Sum> {
    let at = first + i;
    Some(match functions[i].0 {
        Operation::Exponential => Sum::variable(at),
        Operation::Sine => Sum::variable(at + 1),
        Operation::Cosine => Sum::variable(at - 1).scaled(&Rational::from(-1)),
        Operation::Root(q) => Sum::power_of(at, q + 1).scaled(&Rational::from((-1, q))),
    })
}

/// Products and terms that are formed at most.
const MOST_PRODUCTS: usize = 100_000;
const MOST_TERMS: usize = 2000;

fn add(sum: &mut Waves, angle: Rational, a: Rational, b: Rational) {
    // cos and sin of a negative angle.
    let (angle, b) = if angle < 0 { (-angle, -b) } else { (angle, b) };
    let b = if angle.is_zero() { Rational::new() } else { b };
    let entry = sum.entry(angle).or_default();
    entry.0 += a;
    entry.1 += b;
}

/// sum += f g.
fn multiply(sum: &mut Waves, f: &Waves, g: &Waves) {
    for (p, (a, b)) in f {
        for (q, (c, d)) in g {
            let half = |x: Rational| x / 2u32;
            let (plus, minus) = ((p + q).complete(), (p - q).complete());
            let (ac, bd) = ((a * c).complete(), (b * d).complete());
            let (ad, bc) = ((a * d).complete(), (b * c).complete());
            // cos p cos q, sin p sin q, cos p sin q, sin p cos q.
            add(sum, plus, half((&ac - &bd).complete()), half((&ad + &bc).complete()));
            add(sum, minus, half(ac + bd), half(bc - ad));
        }
    }
}
