//! Walks over the tree, each written once: over all nodes, from the leaves upwards to a result, from the
//! outside inwards to another tree, and to a value over any operations.

use crate::{Expression, Function, Unknown};
use rug::Rational;
use std::collections::BTreeMap;

/// What an expression is evaluated over. Nothing, from any of them, is nothing in the end.
pub trait Operations {
    /// What expressions become.
    type Value;
    /// The value of a number.
    fn number(&mut self, q: &Rational) -> Option<Self::Value>;
    /// The value of a parameter, the small parameter, an unknown or the time.
    fn leaf(&mut self, leaf: &Expression) -> Option<Self::Value>;
    /// a + b.
    fn add(&mut self, a: Self::Value, b: Self::Value) -> Option<Self::Value>;
    /// a b.
    fn multiply(&mut self, a: Self::Value, b: Self::Value) -> Option<Self::Value>;
    /// base^exponent.
    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Self::Value>;
    /// F(argument) for an elementary function F.
    fn function(&mut self, function: Function, argument: &Expression) -> Option<Self::Value>;
}

impl Expression {
    /// What the expression is made of, one level down: terms, factors, base and exponent, argument, delay.
    pub fn children(&self) -> impl DoubleEndedIterator<Item = &Self> {
        let (list, pair): (&[Self], [Option<&Self>; 2]) = match self {
            Self::Sum(list) | Self::Product(list) => (list, [None, None]),
            Self::Power(base, exponent) => (&[], [Some(base), Some(exponent)]),
            Self::Function(_, argument) | Self::Formal(_, argument) => {
                (&[], [Some(argument), None])
            }
            Self::Unknown(unknown) => (&[], [unknown.delay.as_deref(), None]),
            Self::Number(_) | Self::Parameter(_) | Self::Small | Self::Time => (&[], [None, None]),
        };
        list.iter().chain(pair.into_iter().flatten())
    }

    /// Every subexpression, from the outside and from the left.
    pub fn nodes(&self) -> impl Iterator<Item = &Self> {
        let mut open = vec![self];
        std::iter::from_fn(move || {
            let next = open.pop()?;
            open.extend(next.children().rev());
            Some(next)
        })
    }

    /// A result for the expression from those for its [`Self::children`], from the leaves upwards.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// let x = || Expression::DISPLACEMENT;
    /// let depth = (x() + x().pow(2)).fold(&mut |_, below: &[u32]| 1 + below.iter().max().unwrap_or(&0));
    /// assert_eq!(depth, 3);
    /// ```
    pub fn fold<T>(&self, combine: &mut dyn FnMut(&Self, &[T]) -> T) -> T {
        let below: Vec<T> = self.children().map(|child| child.fold(combine)).collect();
        combine(self, &below)
    }

    /// The same node with every child replaced by what `change` makes of it.
    #[must_use]
    pub fn map_children(&self, change: &mut dyn FnMut(&Self) -> Self) -> Self {
        match self {
            Self::Sum(terms) => Self::Sum(terms.iter().map(change).collect()),
            Self::Product(factors) => Self::Product(factors.iter().map(change).collect()),
            Self::Power(base, exponent) => change(base).pow(change(exponent)),
            Self::Function(function, argument) => change(argument).apply(*function),
            Self::Formal(name, argument) => change(argument).formal(name),
            Self::Unknown(unknown) => {
                let delay = unknown.delay.as_deref().map(|delay| Box::new(change(delay)));
                Self::Unknown(Unknown { delay, ..*unknown })
            }
            leaf => leaf.clone(),
        }
    }

    /// The expression with every subexpression, from the outside, that `change` has something for replaced
    /// by it; inside of what is replaced nothing else is.
    #[must_use]
    pub fn map(&self, change: &dyn Fn(&Self) -> Option<Self>) -> Self {
        change(self).unwrap_or_else(|| self.map_children(&mut |child| child.map(change)))
    }

    /// The expression with every leaf (number, name, x, x', x'', t) that `change` has something
    /// for replaced by it; what stands for x stands for it at earlier times, too.
    #[must_use]
    pub fn substitute(&self, change: &dyn Fn(&Self) -> Option<Self>) -> Self {
        self.map(&|e| match e {
            Self::Unknown(Unknown { index, derivative, delay: Some(delay) }) => {
                let now = Self::unknown(*index, *derivative);
                let then = delay.substitute(change);
                Some(change(&now).unwrap_or(now).delayed(then))
            }
            leaf => leaf.children().next().is_none().then(|| change(leaf)).flatten(),
        })
    }

    /// The expression with the values of parameters.
    #[must_use]
    pub fn with_values(&self, values: &BTreeMap<String, Rational>) -> Self {
        self.substitute(&|e| match e {
            Self::Parameter(name) => values.get(name).cloned().map(Self::Number),
            _ => None,
        })
    }

    /// The expression at the time t - delay: delays add up, t becomes t - delay.
    ///
    /// ```
    /// use lindstedt_equation::{Expression, print::Style};
    /// let late = Expression::DISPLACEMENT.pow(2).delayed(Expression::parameter("T"));
    /// assert_eq!(late.print("eps", Style::Text), "x(t - T)^2");
    /// ```
    #[must_use]
    pub fn delayed(self, delay: impl Into<Self>) -> Self {
        let delay = delay.into();
        self.map(&|e| match e {
            Self::Unknown(unknown) => {
                let total = match unknown.delay.as_deref() {
                    Some(before) => before.clone() + delay.clone(),
                    None => delay.clone(),
                };
                Some(Self::Unknown(Unknown { delay: Some(Box::new(total)), ..*unknown }))
            }
            Self::Time => Some(Self::Time - delay.clone()),
            _ => None,
        })
    }

    /// The value over these operations; nothing where one of them has none, or for a formal function.
    /// The cost is linear in the size of the tree.
    pub fn evaluate<O: Operations>(&self, over: &mut O) -> Option<O::Value> {
        match self {
            Self::Number(q) => over.number(q),
            Self::Sum(terms) => {
                let zero = over.number(&Rational::new())?;
                terms.iter().try_fold(zero, |sum, term| {
                    let term = term.evaluate(over)?;
                    over.add(sum, term)
                })
            }
            Self::Product(factors) => {
                let one = over.number(&Rational::from(1))?;
                factors.iter().try_fold(one, |product, factor| {
                    let factor = factor.evaluate(over)?;
                    over.multiply(product, factor)
                })
            }
            Self::Power(base, exponent) => over.power(base, exponent),
            Self::Function(function, argument) => over.function(*function, argument),
            Self::Formal(..) => None,
            Self::Parameter(_) | Self::Small | Self::Unknown(_) | Self::Time => over.leaf(self),
        }
    }
}
