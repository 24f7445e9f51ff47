//! An expression as a truncated power series in x and its values at earlier times, about their rest at zero.
//!
//! Every subexpression is m f: m a product of powers of the unknowns, negative ones included, and f a power series, f
//! known up to some total degree W, in which all is multiplied. F(c + u) of a constant c and a series u without one is
//! sum F^(k)(c)/k! u^k. m f divides where f does not vanish at rest; where it does, m has to grow first, and it does so
//! where only one unknown occurs: f = u^k g with g(0) not 0 is read off the coefficients, whatever the degree. In several
//! unknowns only what stands there as a factor counts, so that nothing beyond W is taken for divisible.

use crate::monomials::{Expander, Monomial, Monomials, Terms, add};
use crate::print::Style;
use crate::taylor::{binomial, of_function};
use crate::{Expression, Function, Operations};
use rug::Rational;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Degrees beyond the one asked for that quotients may take.
const MORE: u32 = 64;

/// Why there is no such series.
#[derive(Clone, Debug, PartialEq)]
pub enum NoSeries {
    /// Too many terms on the way.
    TooLong,
    /// It depends on t.
    Time,
    /// This divides by what vanishes at rest, or nothing is known of the quotient.
    Singular(Expression),
    /// This has no power series about rest.
    NotAnalytic(Expression),
    /// This has one where what it takes abs or sign of is not zero at rest, which is not known.
    UnknownSign(Expression),
}

/// The terms up to a total degree in the unknowns, all of which are atoms: the cost follows the terms of that degree, not
/// those of the expression multiplied out.
///
/// ```
/// use lindstedt_equation::{Expression, monomials::expand, near_rest::near_rest};
/// let x = || Expression::DISPLACEMENT;
/// let hill = x() * ((x() + 1).pow(10) + 1).pow(-1);
/// let near = near_rest(&hill, 2)?;
/// let quadratic: Vec<_> = near.terms.iter().map(|(m, q)| near.tree(m, q)).collect();
/// let half = |e: Expression| (e * Expression::Number((1, 2).into())).canonical();
/// assert_eq!(quadratic, [half(x()), half(-5 * x().pow(2))]);
/// # Ok::<(), lindstedt_equation::near_rest::NoSeries>(())
/// ```
///
/// # Errors
/// [`NoSeries`].
pub fn near_rest(e: &Expression, degree: u32) -> Result<Monomials, NoSeries> {
    if let Some(formal) = e.find(&|e| matches!(e, Expression::Formal(..))) {
        return Err(NoSeries::NotAnalytic(formal.clone()));
    }
    let most = degree.saturating_add(MORE);
    let mut working = degree;
    loop {
        let mut near = Near { expander: Expander::up_to(working), working, lacking: 0, why: None };
        let found = e.evaluate(&mut near).and_then(|value| near.regular(e, value, degree));
        match (found, near.lacking) {
            (Some(terms), _) => {
                let terms = terms.into_iter().filter(|(m, _)| m.degree() <= degree).collect();
                return Ok(Monomials { terms, atoms: near.expander.atoms });
            }
            (None, lacking) if lacking > 0 && working < most => {
                working = working.saturating_add(lacking).min(most);
            }
            (None, _) => return Err(near.why.unwrap_or(NoSeries::TooLong)),
        }
    }
}

/// m f.
#[derive(Clone, Debug)]
struct Value {
    /// The exponents of m.
    shift: BTreeMap<String, i64>,
    /// f.
    terms: Terms,
    /// The total degree up to which f is known.
    known: u32,
    /// The unknowns that occur.
    names: BTreeSet<String>,
}

impl Value {
    fn of(terms: Terms) -> Self {
        Self { shift: BTreeMap::new(), terms, known: u32::MAX, names: BTreeSet::new() }
    }

    fn is_zero(&self) -> bool {
        self.terms.is_empty() && self.known == u32::MAX
    }

    fn is_constant(&self) -> bool {
        self.names.is_empty()
    }
}

struct Near {
    expander: Expander,
    /// W.
    working: u32,
    /// So much larger W should be.
    lacking: u32,
    why: Option<NoSeries>,
}

fn product_of(names: &BTreeMap<String, i64>) -> Option<Monomial> {
    let power = |(name, n): (&String, &i64)| Some((name.clone(), u32::try_from(*n).ok()?));
    let powers = names.iter().filter(|(_, n)| **n != 0).map(power);
    Some(Monomial { atoms: powers.collect::<Option<_>>()?, ..Monomial::default() })
}

impl Near {
    fn refuse<T>(&mut self, why: NoSeries) -> Option<T> {
        self.why.get_or_insert(why);
        None
    }

    fn lacks<T>(&mut self, degrees: u32, e: &Expression) -> Option<T> {
        self.lacking = self.lacking.max(degrees.max(1));
        self.refuse(NoSeries::Singular(e.clone()))
    }

    /// m f as one series, which is known at least up to a degree.
    fn regular(&mut self, e: &Expression, value: Value, degree: u32) -> Option<Terms> {
        let Some(m) = product_of(&value.shift) else {
            return match value.terms.is_empty() {
                true if value.is_zero() => Some(Terms::new()),
                // A zero so far.
                true => self.lacks(8, e),
                false => self.refuse(NoSeries::Singular(e.clone())),
            };
        };
        let known = value.known.saturating_add(m.degree());
        if known < degree {
            return self.lacks(degree - known, e);
        }
        self.expander.product(&Terms::from([(m, 1.into())]), &value.terms)
    }

    /// m f with f(0) not 0 where one unknown alone occurs and f is not zero as far as it is known. Terms beyond that are
    /// left out: were they the lowest, they would be taken for the beginning of f.
    fn reduced(&self, mut value: Value) -> Value {
        let known = if value.is_constant() { value.known } else { value.known.min(self.working) };
        value.terms.retain(|m, _| m.degree() <= known);
        let lowest = value.terms.keys().map(Monomial::degree).min().unwrap_or(0);
        let mut names = value.names.iter();
        if let (Some(name), None, true) = (names.next(), names.next(), lowest > 0) {
            *value.shift.entry(name.clone()).or_default() += i64::from(lowest);
            let lower = |(mut m, q): (Monomial, Rational)| {
                m.atoms.entry(name.clone()).and_modify(|n| *n -= lowest);
                m.atoms.retain(|_, n| *n > 0);
                (m, q)
            };
            value.terms = value.terms.into_iter().map(lower).collect();
            value.known = known - lowest;
        }
        value
    }

    /// The constant term, and the rest.
    fn split(&self, terms: &Terms) -> (Expression, Terms) {
        let (still, moving): (Terms, Terms) =
            terms.clone().into_iter().partition(|(m, _)| m.degree() == 0);
        let all = Monomials { terms: still, atoms: self.expander.atoms.clone() };
        (all.coefficient(|_| true), moving)
    }

    /// sum_k c_k u^k by Horner's rule; nothing for a coefficient without a value.
    fn compose(&mut self, u: &Terms, c: &dyn Fn(u32) -> Option<Expression>) -> Option<Terms> {
        let mut sum = Terms::new();
        // u vanishes at rest: u^k begins with the degree k.
        for k in (0..=if u.is_empty() { 0 } else { self.working }).rev() {
            sum = self.expander.product(&sum, u)?;
            for (m, q) in self.expander.terms(&c(k)?.canonical())? {
                add(&mut sum, m, &q);
            }
        }
        Some(sum)
    }

    /// (c + u)^q = sum binomial(q, k) c^(q-k) u^k, c not zero.
    fn binomial(&mut self, terms: &Terms, q: &Rational) -> Option<Terms> {
        let (c, u) = self.split(terms);
        let list = binomial(q, self.working as usize);
        self.compose(&u, &|k| {
            let power = known_value(c.clone().pow(Expression::Number(Rational::from(q - k))));
            Some(Expression::Number(list.get(k as usize)?.clone()) * power)
        })
    }

    /// m^n f^n.
    fn whole_power(&mut self, e: &Expression, value: &Value, n: i64) -> Option<Value> {
        let mut value = value.clone();
        if n < 0 {
            value = self.reduced(value);
            let (c, _) = self.split(&value.terms);
            if c == Expression::integer(0) {
                // A zero so far, or a divisor such as x + x(t - T).
                return match value.terms.is_empty() && !value.is_zero() {
                    true => self.lacks(8, e),
                    false => self.refuse(NoSeries::Singular(e.clone())),
                };
            }
        }
        for exponent in value.shift.values_mut() {
            *exponent = exponent.checked_mul(n)?;
        }
        let lowest = value.terms.keys().map(Monomial::degree).min();
        let vanishes = lowest.is_none_or(|d| d > 0);
        value.terms = match n {
            0.. if n <= i64::from(self.working) => {
                let mut power = Terms::from([(Monomial::default(), 1.into())]);
                for _ in 0..n {
                    power = self.expander.product(&power, &value.terms)?;
                }
                power
            }
            0.. if vanishes => Terms::new(),
            _ => self.binomial(&value.terms, &Rational::from(n))?,
        };
        value.known = value.known.min(self.working);
        Some(value)
    }

    fn constant(&mut self, e: &Expression) -> Option<Value> {
        Some(Value::of(self.expander.terms(&known_value(e.canonical()))?))
    }
}

/// The constant, where it is a simpler one: exp(ln q), and what sine and cosine are at quarter turns and below zero.
fn known_value(e: Expression) -> Expression {
    let (function, z) = match &e {
        Expression::Function(function, z) => (function, z),
        Expression::Power(one, _) if one.as_number().is_some_and(|q| q == 1) => return 1.into(),
        _ => return e,
    };
    let half = |z: &Expression| {
        let quarter = 2 * z.clone() * Expression::parameter("pi").pow(-1);
        let all = crate::monomials::expand(&quarter)?;
        let number = Monomials::coefficient(&all, |_| true).as_number()?;
        number.is_integer().then(|| number.numer().mod_u(4))
    };
    let negative = match &**z {
        Expression::Number(q) => *q < 0,
        Expression::Product(list) => list[0].as_number().is_some_and(|q| q < 0),
        _ => false,
    };
    let opposite = || (-(**z).clone()).canonical();
    match (function, &**z) {
        (Function::Exp, Expression::Function(Function::Ln, q))
            if q.as_number().is_none_or(|q| q > 0) =>
        {
            (**q).clone()
        }
        (Function::Exp, Expression::Number(q)) if q.is_zero() => 1.into(),
        (Function::Ln, Expression::Number(q)) if *q == 1 => 0.into(),
        (Function::Sin, z) if half(z).is_some() => {
            [0, 1, 0, -1][half(z).unwrap_or(0) as usize].into()
        }
        (Function::Cos, z) if half(z).is_some() => {
            [1, 0, -1, 0][half(z).unwrap_or(0) as usize].into()
        }
        (Function::Cos, _) if negative => opposite().apply(Function::Cos),
        (Function::Sin, _) if negative => -opposite().apply(Function::Sin),
        _ => e,
    }
}

/// The sign of a constant of numbers and pi, where all its terms have the same one; nothing for another one.
fn sign(c: &Expression) -> Option<Ordering> {
    let common = |list: &[Expression]| {
        let first = sign(list.first()?)?;
        list.iter().all(|e| sign(e) == Some(first)).then_some(first)
    };
    match c {
        Expression::Number(q) => Some(q.cmp0()),
        Expression::Parameter(name) => (name == "pi").then_some(Ordering::Greater),
        Expression::Sum(list) => common(list),
        Expression::Product(list) => list.iter().try_fold(Ordering::Greater, |product, e| {
            Some(match (product, sign(e)?) {
                (Ordering::Greater, own) => own,
                (product, Ordering::Greater) => product,
                (Ordering::Less, Ordering::Less) => Ordering::Greater,
                _ => Ordering::Equal,
            })
        }),
        Expression::Power(base, _) => sign(base).filter(|s| *s == Ordering::Greater),
        _ => None,
    }
}

/// F^(k)(c)/k!; nothing where F has no power series about c, or none is known.
fn coefficient(function: Function, c: &Expression, k: u32) -> Option<Expression> {
    let at = |f: Function| known_value(c.clone().apply(f));
    let scaled = |e: Expression, f: Function| {
        let factor = of_function(f, k as usize)?.pop()?;
        Some(Expression::Number(factor) * e)
    };
    let sign = sign(c);
    match function {
        Function::Exp => scaled(at(Function::Exp), Function::Exp),
        // sin(c + u) = sin c cos u + cos c sin u.
        Function::Sin | Function::Cos => {
            let even =
                if function == Function::Sin { at(Function::Sin) } else { at(Function::Cos) };
            let odd =
                if function == Function::Sin { at(Function::Cos) } else { -at(Function::Sin) };
            if k.is_multiple_of(2) {
                scaled(even, Function::Cos)
            } else {
                scaled(odd, Function::Sin)
            }
        }
        // ln(c + u) = ln c - sum (-u/c)^k/k.
        Function::Ln if sign.is_some_and(|s| s != Ordering::Greater) => None,
        Function::Ln if k == 0 => Some(at(Function::Ln)),
        Function::Ln => {
            let power = c.clone().pow(-i64::from(k));
            let factor = Rational::from((if k % 2 == 1 { 1 } else { -1 }, k));
            Some(power * Expression::Number(factor))
        }
        Function::Abs | Function::Sign => {
            let sign = match sign? {
                Ordering::Equal => return None,
                Ordering::Greater => 1,
                Ordering::Less => -1,
            };
            Some(match (function, k) {
                (Function::Abs, 0) => sign * c.clone(),
                (Function::Abs, 1) | (Function::Sign, 0) => sign.into(),
                _ => 0.into(),
            })
        }
    }
}

impl Operations for Near {
    type Value = Value;

    fn number(&mut self, q: &Rational) -> Option<Value> {
        self.constant(&Expression::Number(q.clone()))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Value> {
        match leaf {
            Expression::Unknown(_) => {
                let name = leaf.print("eps", Style::Text);
                self.expander.atoms.insert(name.clone(), leaf.clone());
                let mut value = self.number(&Rational::from(1))?;
                value.shift.insert(name.clone(), 1);
                value.names.insert(name);
                Some(value)
            }
            Expression::Time => self.refuse(NoSeries::Time),
            constant => Some(Value::of(self.expander.terms(constant)?)),
        }
    }

    fn add(&mut self, a: Value, b: Value) -> Option<Value> {
        if a.is_zero() || b.is_zero() {
            return Some(if a.is_zero() { b } else { a });
        }
        let names: BTreeSet<String> = a.names.union(&b.names).cloned().collect();
        let exponent = |v: &Value, name: &String| v.shift.get(name).copied().unwrap_or(0);
        let common = |name: &String| (name.clone(), exponent(&a, name).min(exponent(&b, name)));
        let shift: BTreeMap<String, i64> = names.iter().map(common).collect();
        let (mut sum, mut known) = (Terms::new(), u32::MAX);
        for part in [&a, &b] {
            let above = |name: &String| (name.clone(), exponent(part, name) - shift[name]);
            let m = product_of(&names.iter().map(above).collect())?;
            known = known.min(part.known.saturating_add(m.degree()));
            for (m, q) in self.expander.product(&Terms::from([(m, 1.into())]), &part.terms)? {
                add(&mut sum, m, &q);
            }
        }
        known = if names.is_empty() { known } else { known.min(self.working) };
        Some(self.reduced(Value { shift, terms: sum, known, names }))
    }

    fn multiply(&mut self, mut a: Value, b: Value) -> Option<Value> {
        for (name, n) in &b.shift {
            *a.shift.entry(name.clone()).or_default() += n;
        }
        a.terms = self.expander.product(&a.terms, &b.terms)?;
        let constants = a.is_constant() && b.is_constant();
        a.known = a.known.min(b.known);
        a.names.extend(b.names);
        a.known = if constants { a.known } else { a.known.min(self.working) };
        Some(a)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Value> {
        let whole = base.clone().pow(exponent.clone());
        let value = base.evaluate(self)?;
        if value.is_constant() && exponent.is_constant() {
            return self.constant(&whole);
        }
        let Some(q) = exponent.as_number() else {
            return self.refuse(NoSeries::NotAnalytic(whole));
        };
        if q.is_integer() {
            let Some(n) = q.numer().to_i64() else { return self.refuse(NoSeries::TooLong) };
            return self.whole_power(&whole, &value, n);
        }
        let (names, known) = (value.names.clone(), value.known.min(self.working));
        let terms = self.regular(base, value, 0)?;
        let (c, _) = self.split(&terms);
        if c.as_number().is_some_and(|c| c <= 0) {
            return self.refuse(NoSeries::NotAnalytic(whole));
        }
        Some(Value { names, known, ..Value::of(self.binomial(&terms, &q)?) })
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Value> {
        let value = argument.evaluate(self)?;
        let whole = argument.clone().apply(function);
        if value.is_constant() {
            return self.constant(&whole);
        }
        let (names, shift, f) = (value.names.clone(), value.shift.clone(), value.terms.clone());
        let known = value.known.min(self.working);
        let terms = self.regular(argument, value, 0)?;
        let (c, u) = self.split(&terms);
        if coefficient(function, &c, 0).is_none() {
            let unknown = matches!(function, Function::Abs | Function::Sign) && sign(&c).is_none();
            return self.refuse(match unknown {
                true => NoSeries::UnknownSign(whole),
                false => NoSeries::NotAnalytic(whole),
            });
        }
        // sin z = z (1 - z^2/6 + ...): what divides z divides it.
        if function == Function::Sin && c == Expression::integer(0) {
            let quotient = self.compose(&u, &|k| coefficient(Function::Sin, &c, k + 1))?;
            let terms = self.expander.product(&f, &quotient)?;
            return Some(Value { shift, terms, known, names });
        }
        let terms = self.compose(&u, &|k| coefficient(function, &c, k))?;
        Some(self.reduced(Value { names, known, ..Value::of(terms) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quotients whose first terms cancel: the terms up to a degree are those of a higher one.
    #[test]
    fn coefficients_do_not_depend_on_the_degree() {
        let x = || Expression::DISPLACEMENT;
        let (sine, cosine) = (|| x().apply(Function::Sin), || x().apply(Function::Cos));
        let half = || (x() * Expression::Number(Rational::from((1, 2)))).apply(Function::Sin);
        let versed = || (-cosine() + 1).pow(-1);
        let quotients = [
            x().pow(2) * versed() - x() * sine().pow(-1) - 1,
            5 * x().pow(2) * versed() - 5 * x().pow(2) * (2 * half().pow(2)).pow(-1),
            (x().pow(2) * versed() - 2) * x().pow(-1),
            (sine() - x()) * (x() * (-cosine() + 1)).pow(-1),
        ];
        // x^2/(1 - cos x) = 2 + x^2/6 + x^4/120 + ..., x/sin x = 1 + x^2/6 + 7 x^4/360 + ...,
        // sin x - x = -x^3/6 + x^5/120 - ..., x (1 - cos x) = x^3/2 - x^5/24 + ...
        let expected = [
            vec![(4, (-1, 90))],
            vec![],
            vec![(1, (1, 6)), (3, (1, 120))],
            vec![(0, (-1, 3)), (2, (-1, 90))],
        ];
        for (quotient, expected) in quotients.iter().zip(expected) {
            for degree in 4..12 {
                let found = near_rest(quotient, degree).unwrap();
                let low = found.terms.iter().filter(|(m, _)| m.degree() <= 4);
                let low: Vec<_> = low.map(|(m, q)| (m.degree(), q.clone())).collect();
                let known = expected.iter().map(|(d, q)| (*d, Rational::from(*q)));
                let known: Vec<_> = known.collect();
                let shown = low.iter().filter(|(d, _)| known.iter().any(|(k, _)| k == d));
                assert!(shown.eq(known.iter()), "{quotient:?} {degree}: {low:?}");
                let first = near_rest(quotient, 4).unwrap().terms;
                let first: Vec<_> = first.iter().map(|(m, q)| (m.degree(), q.clone())).collect();
                assert_eq!(low, first, "{degree}");
            }
        }
    }
}
