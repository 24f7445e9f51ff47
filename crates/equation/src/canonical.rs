//! One form for trees that addition and multiplication make equal, and the tree algebra that
//! loading a problem needs: searching, x'' set free.

use crate::{Expression, Function};
use rug::Rational;
use rug::ops::Pow;
use std::cmp::Ordering;

/// Powers of numbers with more bits are left as they stand.
const LARGEST_NUMBER: u64 = 100_000;

/// x'' does not occur linearly with a constant factor.
#[derive(Clone, Debug, PartialEq)]
pub enum AccelerationFault {
    /// x'' does not occur, or its factors cancel.
    Missing,
    /// x'' stands inside this term, which is not linear in it with a constant factor.
    Inside(Expression),
}

impl Expression {
    /// The same expression with sums in sums and products in products flat, the numbers of a
    /// sum and of a product collected into one (in front of a product), ones and zeros left out; what the small parameter
    /// is divided by cancels, and functions of 0 that are rational are numbers. Idempotent. Nothing is expanded or reordered; the cost is linear in the size of the tree.
    ///
    /// ```
    /// use lindstedt_equation::{Expression, Function};
    /// let x = || Expression::DISPLACEMENT;
    /// let e = Expression::Product(vec![x(), Expression::integer(2) * Expression::integer(3)]);
    /// assert_eq!(e.canonical(), 6 * x());
    /// let constant = (0 * Expression::Time).apply(Function::Cos);
    /// assert_eq!(constant.canonical(), Expression::integer(1));
    /// let once = Expression::Small.pow(2) * x() * Expression::Small.pow(-1);
    /// assert_eq!(once.canonical(), Expression::Small * x());
    /// ```
    #[must_use]
    pub fn canonical(&self) -> Self {
        match self.map_children(&mut Self::canonical) {
            Self::Sum(terms) => canonical_sum(terms),
            Self::Product(factors) => canonical_product(factors),
            Self::Power(base, exponent) => canonical_power(*base, *exponent),
            Self::Function(function, argument) => canonical_function(function, *argument),
            other => other,
        }
    }

    /// The first subexpression, from the outside and from the left, that `wanted` accepts.
    #[must_use]
    pub fn find(&self, wanted: &dyn Fn(&Self) -> bool) -> Option<&Self> {
        self.nodes().find(|e| wanted(e))
    }

    /// Whether the expression has a subexpression like this.
    #[must_use]
    pub fn contains(&self, part: &Self) -> bool {
        self.nodes().any(|e| e == part)
    }

    /// Whether neither x, x', x'', t, the small parameter nor a formal function occurs.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        let varies =
            |e: &Self| matches!(e, Self::Unknown(_) | Self::Time | Self::Small | Self::Formal(..));
        !self.nodes().any(varies)
    }

    /// The names of the parameters, each once, in the order of their first occurrence.
    #[must_use]
    pub fn parameters(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for e in self.nodes() {
            if let Self::Parameter(name) = e
                && !names.contains(name)
            {
                names.push(name.clone());
            }
        }
        names
    }

    /// The number, if the expression is one after [`Self::canonical`].
    #[must_use]
    pub fn as_number(&self) -> Option<Rational> {
        match self.canonical() {
            Self::Number(q) => Some(q),
            _ => None,
        }
    }

    /// The terms of a sum, or the expression itself as the only one.
    #[must_use]
    pub fn terms(&self) -> &[Self] {
        match self {
            Self::Sum(terms) => terms,
            single => std::slice::from_ref(single),
        }
    }

    /// The factors of a product, or the expression itself as the only one.
    #[must_use]
    pub fn factors(&self) -> &[Self] {
        match self {
            Self::Product(factors) => factors,
            single => std::slice::from_ref(single),
        }
    }

    /// x'' + ... = 0 for an equation c x'' + ... = 0 with a constant c other than zero; an
    /// equation in which x'' stands alone is returned unchanged. A factor c with parameters
    /// becomes c^(-1) on every other term.
    ///
    /// # Errors
    /// [`AccelerationFault`] when x'' does not occur linearly with a constant factor.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let x = Expression::DISPLACEMENT;
    /// let doubled = 2 * (Expression::ACCELERATION + x.clone());
    /// assert_eq!(doubled.acceleration_alone(), Ok(Expression::ACCELERATION + x));
    /// ```
    pub fn acceleration_alone(&self) -> Result<Self, AccelerationFault> {
        self.alone(&Self::ACCELERATION)
    }

    /// The same for x' where x'' does not occur: an equation of first order.
    ///
    /// # Errors
    /// As [`Self::acceleration_alone`], for the derivative that was to stand alone.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let x = Expression::DISPLACEMENT;
    /// let decay = 2 * Expression::VELOCITY + 2 * x.clone();
    /// assert_eq!(decay.highest_alone(), Ok(Expression::VELOCITY + x));
    /// ```
    pub fn highest_alone(&self) -> Result<Self, AccelerationFault> {
        let first = self.is_first_order();
        self.alone(&Self::unknown(0, if first { 1 } else { 2 }))
    }

    /// Whether x' occurs and x'' does not.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let decay = Expression::VELOCITY + Expression::DISPLACEMENT;
    /// assert!(decay.is_first_order() && !(Expression::ACCELERATION + decay).is_first_order());
    /// ```
    #[must_use]
    pub fn is_first_order(&self) -> bool {
        self.contains(&Self::VELOCITY) && !self.contains(&Self::ACCELERATION)
    }

    fn alone(&self, wanted: &Self) -> Result<Self, AccelerationFault> {
        let holds = |e: &Self| e.contains(wanted);
        let with: Vec<&Self> = self.terms().iter().filter(|term| holds(term)).collect();
        if with == [wanted] {
            return Ok(self.clone());
        }
        let (factor, rest) = split(self, wanted)?;
        let factor = Self::Sum(factor).canonical();
        let mut terms = vec![wanted.clone()];
        let scale = match &factor {
            Self::Number(c) if c.is_zero() => return Err(AccelerationFault::Missing),
            Self::Number(c) => Self::Number(Rational::from(c.recip_ref())),
            constant => constant.clone().pow(-1),
        };
        for term in rest {
            match Self::Product(vec![scale.clone(), term]).canonical() {
                Self::Number(q) if q.is_zero() => {}
                term => terms.push(term),
            }
        }
        Ok(Self::Sum(terms))
    }
}

/// c and r with e = c x'' + r, or with another derivative, as lists of terms.
fn split(
    e: &Expression,
    wanted: &Expression,
) -> Result<(Vec<Expression>, Vec<Expression>), AccelerationFault> {
    let holds = |e: &Expression| e.contains(wanted);
    match e {
        e if e == wanted => Ok((vec![Expression::integer(1)], Vec::new())),
        e if !holds(e) => Ok((Vec::new(), vec![e.clone()])),
        Expression::Sum(terms) => {
            let (mut factor, mut rest) = (Vec::new(), Vec::new());
            for term in terms {
                let (c, r) = split(term, wanted)?;
                factor.extend(c);
                rest.extend(r);
            }
            Ok((factor, rest))
        }
        Expression::Product(factors) => {
            let inside = || AccelerationFault::Inside(e.clone());
            let (with, others): (Vec<_>, Vec<_>) = factors.iter().cloned().partition(holds);
            let [with] = &with[..] else { return Err(inside()) };
            if !others.iter().all(Expression::is_constant) {
                return Err(inside());
            }
            let times = |list: Vec<Expression>| -> Vec<Expression> {
                let one = |t| Expression::Product(others.iter().cloned().chain([t]).collect());
                list.into_iter().map(one).collect()
            };
            let (factor, rest) = split(with, wanted)?;
            Ok((times(factor), times(rest)))
        }
        other => Err(AccelerationFault::Inside(other.clone())),
    }
}

fn canonical_sum(terms: Vec<Expression>) -> Expression {
    let mut list: Vec<Expression> = Vec::new();
    let mut number: Option<(usize, Rational)> = None;
    for term in terms.into_iter().flat_map(|t| match t {
        Expression::Sum(inner) => inner,
        single => vec![single],
    }) {
        match (term, &mut number) {
            (Expression::Number(q), Some((_, sum))) => *sum += q,
            (Expression::Number(q), None) if q.is_zero() => {}
            (Expression::Number(q), None) => number = Some((list.len(), q)),
            (other, _) => list.push(other),
        }
    }
    if let Some((at, sum)) = number.filter(|(_, sum)| !sum.is_zero()) {
        list.insert(at, Expression::Number(sum));
    }
    match list.len() {
        0 => Expression::integer(0),
        1 => list.remove(0),
        _ => Expression::Sum(list),
    }
}

fn canonical_product(factors: Vec<Expression>) -> Expression {
    let mut list: Vec<Expression> = Vec::new();
    let mut number = Rational::from(1);
    for factor in factors.into_iter().flat_map(|f| match f {
        Expression::Product(inner) => inner,
        single => vec![single],
    }) {
        match factor {
            Expression::Number(q) => number *= q,
            other => list.push(other),
        }
    }
    if number.is_zero() || list.is_empty() {
        return Expression::Number(number);
    }
    cancel_small(&mut list);
    if list.is_empty() {
        return Expression::Number(number);
    }
    if number != 1 {
        list.insert(0, Expression::Number(number));
    }
    if list.len() == 1 { list.remove(0) } else { Expression::Product(list) }
}

/// The exponent of the small parameter where a factor is a whole power of it.
fn small_power(factor: &Expression) -> Option<i32> {
    match factor {
        Expression::Small => Some(1),
        Expression::Power(base, n) if **base == Expression::Small => {
            n.as_number().filter(Rational::is_integer)?.numer().to_i32()
        }
        _ => None,
    }
}

/// eps^a eps^-b as one power, in the place of the first: eps/eps has no pole at eps = 0. Without a division nothing changes.
fn cancel_small(list: &mut Vec<Expression>) {
    let powers: Vec<i32> = list.iter().filter_map(small_power).collect();
    if powers.len() < 2 || powers.iter().all(|n| *n > 0) {
        return;
    }
    let Some(sum) = powers.iter().try_fold(0i32, |sum, n| sum.checked_add(*n)) else { return };
    let first = list.iter().position(|factor| small_power(factor).is_some()).unwrap_or_default();
    list.retain(|factor| small_power(factor).is_none());
    match sum {
        0 => {}
        1 => list.insert(first, Expression::Small),
        n => list.insert(first, Expression::Small.pow(i64::from(n))),
    }
}

/// sin 0 = 0, cos 0 = exp 0 = 1: a force of the frequency zero is a constant.
fn canonical_function(function: Function, argument: Expression) -> Expression {
    let zero = matches!(&argument, Expression::Number(q) if q.is_zero());
    match function {
        Function::Sin if zero => Expression::integer(0),
        Function::Cos | Function::Exp if zero => Expression::integer(1),
        _ => argument.apply(function),
    }
}

fn canonical_power(base: Expression, exponent: Expression) -> Expression {
    if let Expression::Number(n) = &exponent {
        if *n == 1 {
            return base;
        }
        if let (Expression::Number(q), true) = (&base, n.is_integer())
            && let Some(power) = number_power(q, n)
        {
            return Expression::Number(power);
        }
    }
    base.pow(exponent)
}

/// q^n for an integer n, unless it is undefined or too long.
fn number_power(q: &Rational, n: &Rational) -> Option<Rational> {
    let n = n.numer().to_i32()?;
    if n.cmp(&0) == Ordering::Less && q.is_zero() {
        return None;
    }
    let bits = u64::from(q.numer().significant_bits().max(q.denom().significant_bits()));
    let unit = Rational::from(q.abs_ref()) <= 1 && q.is_integer();
    if !unit && bits * u64::from(n.unsigned_abs()) > LARGEST_NUMBER {
        return None;
    }
    // Powers of 0, 1 and -1 are short whatever the exponent is.
    Some(if unit {
        q.clone().pow(if n == 0 { 0 } else { 2 - n.rem_euclid(2) })
    } else {
        q.clone().pow(n)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use Expression::Small;

    fn x() -> Expression {
        Expression::DISPLACEMENT
    }

    #[test]
    fn numbers_are_collected_and_nothing_else() {
        let e = Expression::Sum(vec![
            Expression::integer(1),
            Expression::Sum(vec![x(), Expression::integer(2)]),
            Expression::Product(vec![Expression::integer(0), Expression::VELOCITY]),
        ]);
        assert_eq!(e.canonical(), Expression::integer(3) + x());
        assert_eq!(e.canonical().canonical(), e.canonical());
        // Neither 0^(-1) nor a number that fills the memory.
        for (base, n) in [(0, -1), (9, 1_000_000_000)] {
            let power = Expression::integer(base).pow(n);
            assert_eq!(power.canonical(), power);
        }
        assert_eq!(
            Expression::integer(-1).pow(1_000_000_001).as_number(),
            Some(Rational::from(-1))
        );
    }

    #[test]
    fn a_constant_factor_of_the_acceleration_goes() {
        let rest = || x() + Small * x().pow(3);
        let expected = Expression::ACCELERATION + rest();
        for e in [
            2 * (Expression::ACCELERATION + rest()),
            Expression::integer(3) * Expression::ACCELERATION + 3 * x() + 3 * (Small * x().pow(3)),
            -(Expression::ACCELERATION + rest()),
        ] {
            assert_eq!(e.acceleration_alone().map(|e| e.canonical()), Ok(expected.clone()));
        }
        let mass = Expression::parameter("m") * Expression::ACCELERATION + x();
        let divided = Expression::ACCELERATION + Expression::parameter("m").pow(-1) * x();
        assert_eq!(mass.acceleration_alone(), Ok(divided));
        let steep = Expression::ACCELERATION * x() + x();
        let inside = AccelerationFault::Inside(Expression::ACCELERATION * x());
        assert_eq!(steep.acceleration_alone(), Err(inside));
        assert_eq!(
            (Expression::ACCELERATION - Expression::ACCELERATION + x()).acceleration_alone(),
            Err(AccelerationFault::Missing)
        );
    }
}
