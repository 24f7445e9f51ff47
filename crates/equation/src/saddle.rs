//! Whether x'' = f(x) has a saddle, by the signs of f on a grid.

use crate::{Expression, Function, Operations};
use rug::Rational;
use std::collections::BTreeMap;

/// Half the width of the grid.
const REACH: f64 = 20.0;
/// Its points.
const POINTS: i32 = 4000;

/// Whether f of x'' + rest = x'' - f(x) changes its sign upwards for some |x| < 20: estimated, for
/// a list of methods; the method itself looks for the orbit. Terms with the small parameter or t
/// are left out. Nothing where a parameter has no value or x' occurs.
pub(crate) fn has_saddle(rest: &Expression, values: &BTreeMap<String, Rational>) -> Option<bool> {
    let kept = |t: &&Expression| {
        ![Expression::Small, Expression::Time].iter().any(|part| t.contains(part))
    };
    let terms: Vec<&Expression> = rest.terms().iter().filter(kept).collect();
    let force = |x: f64| -> Option<f64> {
        terms.iter().try_fold(0.0, |sum, term| Some(sum - term.evaluate(&mut At { x, values })?))
    };
    let mut before = None;
    for n in -POINTS / 2..=POINTS / 2 {
        // Off the symmetric points, where zeros like to be.
        let here = force((f64::from(n) + 0.137) * 2.0 * REACH / f64::from(POINTS))?;
        if before.is_some_and(|f: f64| f < 0.0) && here > 0.0 {
            return Some(true);
        }
        before = Some(here);
    }
    Some(false)
}

/// Values in doubles at one x.
struct At<'a> {
    x: f64,
    values: &'a BTreeMap<String, Rational>,
}

impl Operations for At<'_> {
    type Value = f64;

    fn number(&mut self, q: &Rational) -> Option<f64> {
        Some(q.to_f64())
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<f64> {
        match leaf {
            Expression::Parameter(name) => self.values.get(name).map(Rational::to_f64),
            leaf => (*leaf == Expression::DISPLACEMENT).then_some(self.x),
        }
    }

    fn add(&mut self, a: f64, b: f64) -> Option<f64> {
        Some(a + b)
    }

    fn multiply(&mut self, a: f64, b: f64) -> Option<f64> {
        Some(a * b)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<f64> {
        Some(base.evaluate(self)?.powf(exponent.evaluate(self)?))
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<f64> {
        let z = argument.evaluate(self)?;
        Some(match function {
            Function::Ln => z.ln(),
            Function::Exp => z.exp(),
            Function::Sin => z.sin(),
            Function::Cos => z.cos(),
            Function::Abs => z.abs(),
            Function::Sign => z.signum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wells_and_hills() {
        let x = || Expression::DISPLACEMENT;
        let none = BTreeMap::new();
        let of = |e: Expression| has_saddle(&e, &none);
        assert_eq!(of(x() - x().pow(2)), Some(true));
        assert_eq!(of(x().apply(Function::Sin)), Some(true));
        assert_eq!(of(x() + x().pow(3)), Some(false));
        assert_eq!(of(x() - Expression::Small * x().pow(3)), Some(false));
        assert_eq!(of(Expression::parameter("k") * x()), None);
        assert_eq!(of(x() + Expression::VELOCITY), None);
    }
}
