//! What the words of a formula mean: elements of a field of quotients, and rational numbers at a
//! point by which most wrong formulas are told apart quickly.

use super::formula::Tree;
use lindstedt::unstable::coeff::quotient::{Quotient, Quotients};
use lindstedt_algebra::Rationals;
use rug::Rational;
use rug::ops::Pow;
use std::collections::BTreeMap;

/// The arithmetic that a formula needs.
pub(super) trait Arithmetic {
    type Value: Clone;
    fn number(&self, q: &Rational) -> Self::Value;
    fn add(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;
    fn mul(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;
    fn inverse(&self, a: &Self::Value) -> Option<Self::Value>;
    fn equal(&self, a: &Self::Value, b: &Self::Value) -> bool;
}

impl Arithmetic for Quotients {
    type Value = Quotient;
    fn number(&self, q: &Rational) -> Quotient {
        self.rational(q)
    }
    fn add(&self, a: &Quotient, b: &Quotient) -> Quotient {
        self.add(a, b)
    }
    fn mul(&self, a: &Quotient, b: &Quotient) -> Quotient {
        self.mul(a, b)
    }
    fn inverse(&self, a: &Quotient) -> Option<Quotient> {
        self.inverse(a)
    }
    fn equal(&self, a: &Quotient, b: &Quotient) -> bool {
        self.equal(a, b)
    }
}

impl Arithmetic for Rationals {
    type Value = Rational;
    fn number(&self, q: &Rational) -> Rational {
        q.clone()
    }
    fn add(&self, a: &Rational, b: &Rational) -> Rational {
        Rational::from(a + b)
    }
    fn mul(&self, a: &Rational, b: &Rational) -> Rational {
        Rational::from(a * b)
    }
    fn inverse(&self, a: &Rational) -> Option<Rational> {
        (!a.is_zero()).then(|| Rational::from(a.recip_ref()))
    }
    fn equal(&self, a: &Rational, b: &Rational) -> bool {
        a == b
    }
}

/// The words, the angles with cosine and sine, the exponents with their exponential.
#[derive(Clone, Debug)]
pub(super) struct Meaning<V> {
    pub words: BTreeMap<String, V>,
    pub angles: Vec<[V; 3]>,
    pub exponentials: Vec<[V; 2]>,
}

/// Exponents n x with |n| up to this are known where e^x is.
const MULTIPLES: i32 = 4;

impl<V: Clone> Meaning<V> {
    /// The value of a formula; nothing for unknown words and angles, and for a division by zero.
    pub fn value<A: Arithmetic<Value = V>>(&self, arithmetic: &A, tree: &Tree) -> Option<V> {
        let value = |tree: &Tree| self.value(arithmetic, tree);
        let one = || arithmetic.number(&Rational::from(1));
        let minus = |v: &V| arithmetic.mul(&arithmetic.number(&Rational::from(-1)), v);
        match tree {
            Tree::Number(q) => Some(arithmetic.number(q)),
            Tree::Symbol(name) => self.words.get(name).cloned(),
            Tree::Sum(terms) => {
                let zero = arithmetic.number(&Rational::new());
                terms.iter().try_fold(zero, |sum, t| Some(arithmetic.add(&sum, &value(t)?)))
            }
            Tree::Product(factors) => {
                factors.iter().try_fold(one(), |p, f| Some(arithmetic.mul(&p, &value(f)?)))
            }
            Tree::Negative(inner) => Some(minus(&value(inner)?)),
            Tree::Inverse(inner) => arithmetic.inverse(&value(inner)?),
            Tree::Power(base, exponent) => power(arithmetic, &value(base)?, *exponent),
            Tree::Apply(name, argument) => {
                let x = value(argument)?;
                if arithmetic.equal(&x, &minus(&x)) {
                    return match name.as_str() {
                        "cos" | "exp" => Some(one()),
                        "sin" => Some(x),
                        _ => None,
                    };
                }
                if name == "exp" {
                    return self.exponentials.iter().find_map(|[base, exponential]| {
                        let is = |n: &i32| {
                            let n = arithmetic.number(&Rational::from(*n));
                            arithmetic.equal(&x, &arithmetic.mul(&n, base))
                        };
                        let n = (-MULTIPLES..=MULTIPLES).find(is)?;
                        power(arithmetic, exponential, n)
                    });
                }
                self.angles.iter().find_map(|[angle, cos, sin]| {
                    let forward = arithmetic.equal(&x, angle);
                    if !forward && !arithmetic.equal(&x, &minus(angle)) {
                        return None;
                    }
                    match name.as_str() {
                        "cos" => Some(cos.clone()),
                        "sin" => Some(if forward { sin.clone() } else { minus(sin) }),
                        _ => None,
                    }
                })
            }
        }
    }
}

fn power<A: Arithmetic>(arithmetic: &A, base: &A::Value, exponent: i32) -> Option<A::Value> {
    let base = if exponent < 0 { arithmetic.inverse(base)? } else { base.clone() };
    let one = arithmetic.number(&Rational::from(1));
    Some((0..exponent.unsigned_abs()).fold(one, |product, _| arithmetic.mul(&product, &base)))
}

/// A field with the meaning of words.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub field: Quotients,
    pub meaning: Meaning<Quotient>,
}

impl Setting {
    /// Every parameter means itself.
    pub fn new(field: Quotients) -> Self {
        let names = field.field.ring.parameters.clone();
        let words = names.into_iter().map(|name| {
            let value = field.parameter(&name);
            (name, value)
        });
        let meaning =
            Meaning { words: words.collect(), angles: Vec::new(), exponentials: Vec::new() };
        Self { field, meaning }
    }

    /// Only these words; the others are not looked for.
    #[must_use]
    pub fn only(mut self, names: &[&str]) -> Self {
        self.meaning.words.retain(|name, _| names.contains(&name.as_str()));
        self
    }

    /// Adds a word that means a formula in the words known so far.
    #[must_use]
    pub fn word(mut self, name: &str, formula: &str) -> Self {
        if let Some(value) = self.read(formula) {
            self.meaning.words.insert(name.to_owned(), value);
        }
        self
    }

    /// Adds a word with its value.
    #[must_use]
    pub fn means(mut self, name: &str, value: Quotient) -> Self {
        self.meaning.words.insert(name.to_owned(), value);
        self
    }

    /// The value of a formula that is written here.
    pub fn read(&self, formula: &str) -> Option<Quotient> {
        self.value(&super::formula::parse(formula)?)
    }

    /// The value of a printed formula.
    pub fn value(&self, tree: &Tree) -> Option<Quotient> {
        self.meaning.value(&self.field, tree)
    }

    /// The meaning at a rational point, the cosines and sines on the unit circle.
    pub fn at_point(&self) -> Option<Meaning<Rational>> {
        let number = |q: &Quotient| self.number(q);
        let of = |values: &[Quotient]| values.iter().map(number).collect::<Option<Vec<_>>>();
        let words = self.meaning.words.iter().map(|(name, q)| Some((name.clone(), number(q)?)));
        let angles = self.meaning.angles.iter().map(|list| of(list)?.try_into().ok());
        let exponentials = self.meaning.exponentials.iter().map(|list| of(list)?.try_into().ok());
        Some(Meaning {
            words: words.collect::<Option<_>>()?,
            angles: angles.collect::<Option<_>>()?,
            exponentials: exponentials.collect::<Option<_>>()?,
        })
    }

    /// The value at that point.
    pub fn number(&self, value: &Quotient) -> Option<Rational> {
        let pairs = &self.field.field.pairs;
        let image = |index: u16| {
            // Distinct ratios of small primes: no coincidences among short formulas.
            let n = Rational::from((u32::from(index) * 14 + 11, u32::from(index) * 6 + 7));
            let pair = pairs.iter().find(|(cos, sin)| index == *cos || index == *sin);
            let Some(&(cos, _)) = pair else { return n };
            let t = Rational::from((u32::from(cos) * 2 + 3, u32::from(cos) * 3 + 8));
            let square = t.clone().pow(2);
            let below = Rational::from(&square + 1);
            if index == cos { (1 - square) / below } else { t * 2 / below }
        };
        self.field.evaluate(&Rationals, value, &image)
    }
}
