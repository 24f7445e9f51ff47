//! Whether x'' = f(x) has a saddle, by the signs of f on a grid.

use crate::Expression;
use rug::{Float, Rational};
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
    if terms.iter().any(|term| term.contains(&Expression::VELOCITY)) {
        return None;
    }
    let force = |x: f64| -> Option<f64> {
        let x = Float::with_val(53, x);
        terms.iter().try_fold(0.0, |sum, term| Some(sum - term.at_point(&x, values)?.to_f64()))
    };
    // A multiple of x changes its sign at zero alone.
    let is_multiple = |term: &&Expression| {
        let mut own = term.factors().iter().filter(|f| f.contains(&Expression::DISPLACEMENT));
        own.next() == Some(&Expression::DISPLACEMENT) && own.next().is_none()
    };
    if terms.iter().all(is_multiple) {
        return Some(force(1.0)? > 0.0);
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Function;

    #[test]
    fn wells_and_hills() {
        let x = || Expression::DISPLACEMENT;
        let none = BTreeMap::new();
        let of = |e: Expression| has_saddle(&e, &none);
        assert_eq!(of(x() - x().pow(2)), Some(true));
        assert_eq!(of(x().apply(Function::Sin)), Some(true));
        assert_eq!(of(x() + x().pow(3)), Some(false));
        assert_eq!(of(x() * Expression::integer(-2)), Some(true));
        assert_eq!(of(x() - Expression::Small * x().pow(3)), Some(false));
        assert_eq!(of(Expression::parameter("k") * x()), None);
        assert_eq!(of(x() + Expression::VELOCITY), None);
    }
}
