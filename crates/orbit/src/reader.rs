//! An expression as a sum of products; sines, cosines, exponentials and powers that are no polynomial
//! become functions.

use crate::Failure;
use crate::operation::Operation;
use crate::sum::{Key, Sum};
use lindstedt_equation::{Expression, Function, Operations, Unknown};
use rug::Rational;
use rug::ops::Pow;

/// The largest power, and the largest denominator of one.
const MOST_POWER: u32 = 64;
const MOST_ROOT: u32 = 12;
/// Functions of one field.
const MOST_FUNCTIONS: usize = 40;

/// Reads expressions and gathers the functions in them.
pub(crate) struct Reader {
    unknowns: usize,
    /// Each with its argument; the variable 2 N + i.
    pub(crate) functions: Vec<(Operation, Sum)>,
    /// x_k'' stands for these numbers.
    accelerations: Vec<i64>,
    refusal: Option<Failure>,
}

impl Reader {
    pub(crate) fn new(unknowns: usize) -> Self {
        Self { unknowns, functions: Vec::new(), accelerations: Vec::new(), refusal: None }
    }

    /// The left side of an equation where each x_k'' is the number given, or 0.
    pub(crate) fn rest(&mut self, e: &Expression, accelerations: &[i64]) -> Result<Sum, Failure> {
        self.accelerations = accelerations.to_vec();
        let sum = e.evaluate(self);
        // Without a reason of its own, a product was too long.
        let refused = self.refusal.take().unwrap_or(Failure::TooManyTerms);
        let sum = sum.ok_or(refused)?;
        match sum.0.keys().any(|key| key.time > 0) {
            true => Err(Failure::NotPolynomial(Expression::Time)),
            false => Ok(sum),
        }
    }

    fn refuse<T>(&mut self, failure: Failure) -> Option<T> {
        self.refusal.get_or_insert(failure);
        None
    }

    fn too_high<T>(&mut self, exponent: &Rational) -> Option<T> {
        let exponent = exponent.clone();
        self.refuse(Failure::Exponent { exponent, most: MOST_POWER, root: MOST_ROOT })
    }

    /// A function as a variable.
    fn named(&mut self, operation: Operation, argument: Sum) -> Option<Sum> {
        if argument.0.keys().any(|key| key.time > 0) {
            return self.refuse(Failure::NotPolynomial(Expression::Time));
        }
        let (list, at) = (operation.list(), usize::from(operation == Operation::Cosine));
        let known = (list[0], argument);
        let found = self.functions.iter().position(|f| *f == known);
        let found = found.unwrap_or_else(|| {
            let first = self.functions.len();
            self.functions.extend(list.iter().map(|operation| (*operation, known.1.clone())));
            first
        });
        let few = self.functions.len() <= MOST_FUNCTIONS;
        few.then(|| Sum::variable(2 * self.unknowns + found + at))
    }

    /// cos or sin of q t + p: by the sums of angles.
    fn wave(&mut self, argument: Sum, sine: bool) -> Option<Sum> {
        let mut rest = argument;
        let time = Key { time: 1, ..Key::default() };
        let only =
            Sum(rest.0.remove(&time).map(|waves| (Key::default(), waves)).into_iter().collect());
        let Some(rate) = only.as_number() else {
            return self.refuse(Failure::NotPolynomial(Expression::Time));
        };
        if rest.0.is_empty() {
            return Some(Sum::wave(&rate, sine));
        }
        let [s, c] =
            [Operation::Sine, Operation::Cosine].map(|kind| self.named(kind, rest.clone()));
        let (s, c) = (s?, c?);
        if rate.is_zero() {
            return Some(if sine { s } else { c });
        }
        let [sin, cos] = [true, false].map(|sine| Sum::wave(&rate, sine));
        let minus = Rational::from(-1);
        match sine {
            true => Some(sin.times(&c)?.plus(&cos.times(&s)?)),
            false => Some(cos.times(&c)?.plus(&sin.times(&s)?.scaled(&minus))),
        }
    }

    /// base^(p/q) for a base that is no number: a power of base^(-1/q) and of the base.
    fn fraction(&mut self, base: Sum, exponent: &Rational, whole: &Expression) -> Option<Sum> {
        let parts = (exponent.numer().to_i32(), exponent.denom().to_u32());
        let taken = |(p, q): &(i32, u32)| p.unsigned_abs() <= MOST_POWER && *q <= MOST_ROOT;
        let Some((p, q)) = parts.0.zip(parts.1).filter(taken) else {
            return self.too_high(exponent);
        };
        let vanishes = base.0.keys().all(|key| key.powers.iter().any(|n| *n > 0));
        if q > 1 && vanishes {
            return self.refuse(Failure::NotSmooth(whole.clone()));
        }
        let root = self.named(Operation::Root(q), base.clone())?;
        if p < 0 {
            return root.power(p.unsigned_abs());
        }
        let above = p.unsigned_abs().div_ceil(q);
        base.power(above)?.times(&root.power(above * q - p.unsigned_abs())?)
    }
}

impl Operations for Reader {
    type Value = Sum;

    fn number(&mut self, q: &Rational) -> Option<Sum> {
        Some(Sum::number(q.clone()))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Sum> {
        let one = Rational::from(1);
        match leaf {
            Expression::Unknown(Unknown { index, derivative, delay: None })
                if *index < self.unknowns =>
            {
                match derivative {
                    0 => Some(Sum::variable(*index)),
                    1 => Some(Sum::variable(self.unknowns + index)),
                    _ => {
                        let value = self.accelerations.get(*index).copied().unwrap_or(0);
                        Some(Sum::number(Rational::from(value)))
                    }
                }
            }
            Expression::Time => Some(Sum::term(Key { time: 1, ..Key::default() }, one)),
            Expression::Parameter(name) => {
                let parameters = [(name.clone(), 1)].into();
                Some(Sum::term(Key { parameters, ..Key::default() }, one))
            }
            other => self.refuse(Failure::NotPolynomial(other.clone())),
        }
    }

    fn add(&mut self, a: Sum, b: Sum) -> Option<Sum> {
        Some(a.plus(&b))
    }

    fn multiply(&mut self, a: Sum, b: Sum) -> Option<Sum> {
        a.times(&b)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Sum> {
        let whole = || base.clone().pow(exponent.clone());
        let Some(n) = exponent.as_number() else {
            return self.refuse(Failure::NotPolynomial(whole()));
        };
        if matches!(base, Expression::Function(Function::Abs | Function::Sign, _)) {
            return self.refuse(Failure::NotSmooth(whole()));
        }
        let base = base.evaluate(self)?;
        let integer = n.is_integer().then(|| n.numer().to_i32()).flatten();
        match integer {
            Some(n)
                if n.unsigned_abs() < 1000
                    && base.as_number().is_some_and(|q| n > 0 || !q.is_zero()) =>
            {
                return base.as_number().map(|q| Sum::number(q.pow(n)));
            }
            Some(n) if (0..=MOST_POWER.cast_signed()).contains(&n) => {
                return base.power(n.unsigned_abs());
            }
            Some(n) if n >= 0 || n <= -1000 => return self.too_high(&n.into()),
            Some(n) => {
                // A product of parameters and a number can be divided by.
                if let [(key, waves)] = &base.0.iter().collect::<Vec<_>>()[..]
                    && key.powers.is_empty()
                    && key.time == 0
                    && let Some(q) = Sum([(Key::default(), (*waves).clone())].into()).as_number()
                {
                    let mut inverse = (*key).clone();
                    inverse.parameters.values_mut().for_each(|power| *power *= n);
                    return Some(Sum::term(inverse, q.pow(n)));
                }
            }
            None => {}
        }
        self.fraction(base, &n, &whole())
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Sum> {
        let whole = || argument.clone().apply(function);
        match function {
            Function::Sin | Function::Cos => {
                let argument = argument.evaluate(self)?;
                self.wave(argument, function == Function::Sin)
            }
            Function::Exp => {
                let argument = argument.evaluate(self)?;
                self.named(Operation::Exponential, argument)
            }
            Function::Abs | Function::Sign => self.refuse(Failure::NotSmooth(whole())),
            _ => self.refuse(Failure::NotPolynomial(whole())),
        }
    }
}
