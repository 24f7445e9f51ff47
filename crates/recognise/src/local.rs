//! Bound expressions at a point in doubles, with their slopes.

use crate::bound::PI;
use lindstedt_equation::{Expression, Function, Operations, Unknown};
use lindstedt_melnikov::splitting::Local;
use rug::Rational;

/// A point (t, x, x'), and the value of one parameter.
pub(crate) struct Point<'a> {
    t: f64,
    x: f64,
    velocity: f64,
    parameter: Option<(&'a str, f64)>,
}

impl<'a> Point<'a> {
    pub fn at(t: f64, x: f64, velocity: f64) -> Self {
        Self { t, x, velocity, parameter: None }
    }

    pub fn with(self, parameter: Option<(&'a str, f64)>) -> Self {
        Self { parameter, ..self }
    }

    /// The value of a bound expression, where it is finite; its slopes need not be, as those of |w|^(1/3) at w = 0.
    pub fn value(&mut self, e: &Expression) -> Option<f64> {
        e.evaluate(self).map(|local| local[0]).filter(|value| value.is_finite())
    }

    /// The value of a bound expression with its derivatives by x and by x' (those of a sign are zero); nothing where
    /// one of them is not finite.
    pub fn local(&mut self, e: &Expression) -> Option<Local> {
        e.evaluate(self).filter(|local| local.iter().all(|part| part.is_finite()))
    }
}

/// F(z) from F and F' at the value of z.
fn chain(z: Local, value: f64, slope: f64) -> Local {
    [value, slope * z[1], slope * z[2]]
}

impl Operations for Point<'_> {
    type Value = Local;

    fn number(&mut self, q: &Rational) -> Option<Local> {
        Some([q.to_f64(), 0.0, 0.0])
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Local> {
        let Self { t, x, velocity: v, parameter } = *self;
        match leaf {
            Expression::Time => Some([t, 0.0, 0.0]),
            Expression::Parameter(name) if **name == *PI => Some([std::f64::consts::PI, 0.0, 0.0]),
            Expression::Parameter(name) => {
                let known = parameter.filter(|(known, _)| **name == **known);
                known.map(|(_, value)| [value, 0.0, 0.0])
            }
            Expression::Unknown(Unknown { derivative: 0, delay: None, .. }) => Some([x, 1.0, 0.0]),
            Expression::Unknown(Unknown { derivative: 1, delay: None, .. }) => Some([v, 0.0, 1.0]),
            _ => None,
        }
    }

    fn add(&mut self, a: Local, b: Local) -> Option<Local> {
        Some([0, 1, 2].map(|k| a[k] + b[k]))
    }

    fn multiply(&mut self, a: Local, b: Local) -> Option<Local> {
        Some([a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0]])
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Local> {
        let z = base.evaluate(self)?;
        if let Some(n) =
            exponent.as_number().and_then(|n| n.is_integer().then(|| n.numer().to_i32())?)
        {
            return Some(chain(z, z[0].powi(n), f64::from(n) * z[0].powi(n - 1)));
        }
        // b^n = exp(n ln b), n a number or not.
        let [n, by_x, by_v] = exponent.evaluate(self)?;
        let value = z[0].powf(n);
        let slope = n * z[0].powf(n - 1.0);
        let growth = if by_x == 0.0 && by_v == 0.0 { 0.0 } else { value * z[0].ln() };
        Some([value, slope * z[1] + growth * by_x, slope * z[2] + growth * by_v])
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Local> {
        let z = argument.evaluate(self)?;
        let (value, slope) = match function {
            Function::Ln => (z[0].ln(), z[0].recip()),
            Function::Exp => (z[0].exp(), z[0].exp()),
            Function::Sin => (z[0].sin(), z[0].cos()),
            Function::Cos => (z[0].cos(), -z[0].sin()),
            Function::Abs => (z[0].abs(), z[0].signum()),
            Function::Sign if z[0] == 0.0 => (0.0, 0.0),
            Function::Sign => (z[0].signum(), 0.0),
        };
        Some(chain(z, value, slope))
    }
}
