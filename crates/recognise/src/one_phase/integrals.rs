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
    pub error: f64,
    /// The integral of the size of the terms.
    pub absolute: f64,
}

/// Two integrals over an interval, of an integrand that says the size of its terms as well, by which it is rounded;
/// integrable singularities at the ends do no harm. In doubles: some hundred integrals are wanted, to 12 digits.
pub(super) fn tanh_sinh(
    from: f64,
    to: f64,
    f: &dyn Fn(f64) -> Option<[f64; 3]>,
) -> Option<Integrals> {
    let half = (to - from) / 2.0;
    if half <= 0.0 {
        return Some(Integrals { values: [0.0; 2], error: 0.0, absolute: 0.0 });
    }
    let term = |t: f64| {
        let s = PI / 2.0 * t.sinh();
        // The distance to the nearer end keeps its digits.
        let near = 2.0 * half / (1.0 + (2.0 * s.abs()).exp());
        let place = if s < 0.0 { from + near } else { to - near };
        let weight = half * PI / 2.0 * t.cosh() / s.cosh().powi(2);
        Some(f(place)?.map(|value| value * weight))
    };
    let mut sums = term(0.0)?;
    let (mut before, mut size) = ([0.0; 2], sums[2]);
    for level in 0..LEVELS {
        let h = 0.5f64.powi(level as i32);
        let (mut t, stride) = if level == 0 { (1.0, 1.0) } else { (h, 2.0 * h) };
        while t < REACH {
            for t in [t, -t] {
                let value = term(t)?;
                size = size.max(value[2]);
                sums = [0, 1, 2].map(|k| sums[k] + value[k]);
            }
            t += stride;
        }
        let values = [sums[0] * h, sums[1] * h];
        let change = (values[0] - before[0]).abs().max((values[1] - before[1]).abs());
        if level > 2 && change < 1e-13 * size || level + 1 == LEVELS {
            // Of a singularity d^(p-1) the terms fall as exp(-p pi sinh t): what is beyond the last is the last over
            // p pi cosh t, p = 1/2 here; of a pole they do not fall.
            let beyond = 2.0 / (PI * REACH.cosh());
            let tail = (term(-REACH)?[2] + term(REACH)?[2]) * beyond;
            let error = change.max(4.0 * f64::EPSILON * size) + tail;
            return Some(Integrals { values, error, absolute: sums[2] * h });
        }
        before = values;
    }
    None
}
