//! The tanh-sinh rule in doubles.

use std::f64::consts::PI;

/// Halvings of the step of the tanh-sinh rule.
const LEVELS: u32 = 10;
/// The end of the tanh-sinh rule: nodes closer to an end of the interval round to it.
const REACH: f64 = 3.2;

/// Two integrals over an interval.
pub(super) struct Integrals {
    pub values: [f64; 2],
    /// Of each, estimated.
    pub errors: [f64; 2],
    /// The integrals of the sizes of their terms.
    pub absolute: [f64; 2],
}

/// Two integrals over an interval, of integrands that say the sizes of their terms as well, by which they are rounded;
/// integrable singularities at the ends do no harm. In doubles: some hundred integrals are wanted, to 12 digits.
pub(super) fn tanh_sinh(
    from: f64,
    to: f64,
    f: &dyn Fn(f64) -> Option<[[f64; 2]; 2]>,
) -> Option<Integrals> {
    let half = (to - from) / 2.0;
    if half <= 0.0 {
        return Some(Integrals { values: [0.0; 2], errors: [0.0; 2], absolute: [0.0; 2] });
    }
    let term = |t: f64| {
        let s = PI / 2.0 * t.sinh();
        // The distance to the nearer end keeps its digits.
        let near = 2.0 * half / (1.0 + (2.0 * s.abs()).exp());
        let place = if s < 0.0 { from + near } else { to - near };
        let weight = half * PI / 2.0 * t.cosh() / s.cosh().powi(2);
        Some(f(place)?.map(|pair| pair.map(|value| value * weight)))
    };
    let mut sums = term(0.0)?;
    let (mut before, mut sizes) = ([0.0; 2], sums.map(|[_, size]| size));
    for level in 0..LEVELS {
        let h = 0.5f64.powi(level as i32);
        let (mut t, stride) = if level == 0 { (1.0, 1.0) } else { (h, 2.0 * h) };
        while t < REACH {
            for t in [t, -t] {
                let value = term(t)?;
                for k in [0, 1] {
                    sizes[k] = sizes[k].max(value[k][1]);
                    sums[k] = [sums[k][0] + value[k][0], sums[k][1] + value[k][1]];
                }
            }
            t += stride;
        }
        let values = sums.map(|[sum, _]| sum * h);
        // Neither has converged before the other: they have the same singularities.
        let change = |k: usize| (values[k] - before[k]).abs() / sizes[k].max(f64::MIN_POSITIVE);
        let change = change(0).max(change(1));
        if level > 2 && change < 1e-13 || level + 1 == LEVELS {
            // Of a singularity d^(p-1) the terms fall as exp(-p pi sinh t): what is beyond the last is the last over
            // p pi cosh t, p = 1/2 here; of a pole they do not fall.
            let beyond = 2.0 / (PI * REACH.cosh());
            let ends = [term(-REACH)?, term(REACH)?];
            let error = |k: usize| {
                let tail = (ends[0][k][1] + ends[1][k][1]) * beyond;
                change.max(4.0 * f64::EPSILON) * sizes[k] + tail
            };
            let absolute = sums.map(|[_, size]| size * h);
            return Some(Integrals { values, errors: [0, 1].map(error), absolute });
        }
        before = values;
    }
    None
}
