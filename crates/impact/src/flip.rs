//! The flip boundary: the gains A with a multiplier at -1.
//!
//! At w = -1 kappa = 2 and G is elementary in A: G(-1) = 1 + e (-2 R_r Ch + (sigma -
//! 2 chi B (1+R_r)) Sc) + R_r^2 e^2 with m^2 = (c - 2B)^2/4 - alpha^2 + 2A, e = e^(-(c-2B)T/2).

use crate::characteristic::Kick;
use crate::error::ImpactError;
use crate::orbit::orbit;
use crate::parameters::ExactParameters;
use crate::propagator::propagator;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::{Certified, Real};

/// Depth of the bisection: intervals of 2^-40 of the range.
const DEEPEST: u32 = 40;

/// All A in \[low, high\] with G(-1) = 0, ascending, at the B of `parameters` (its A is ignored).
///
/// Certified and complete: intervals without zero are discarded by enclosures of G(-1), the others
/// have a derivative of one sign and are contracted by interval Newton steps.
///
/// # Errors
/// Those of [`crate::orbit::orbit`]; [`ImpactError::Undecided`] for a double zero.
pub fn flip_boundary(
    parameters: &ExactParameters,
    kick: Kick,
    low: f64,
    high: f64,
    bits: u32,
) -> Result<Vec<Certified>, ImpactError> {
    let certified = parameters.certified(bits);
    let orbit = orbit(&certified)?;
    let b = &certified.velocity_gain;
    let r = &certified.restitution;
    let one = b.integer(1);
    let d = certified.damping.clone() - b.doubled();
    let jump = r.clone() + &one;
    let sigma = Complex::real(orbit.saltation.clone() - (kick.factor(r) * b * jump).doubled());
    let base = (d.halved() - &certified.alpha) * (d.halved() + &certified.alpha);
    let evaluate = |a: &Certified| {
        let z = Complex::real(base.clone() + a.doubled());
        let flow = propagator(&Complex::real(d.clone()), &z, &orbit.period);
        let bounce = flow.cosh.scaled(&r.doubled());
        let value = sigma.clone() * &flow.sinh - bounce + flow.contraction.scaled(&r.square());
        let by_z =
            sigma.clone() * &flow.sinh_slope - flow.sinh.scaled(&(r.clone() * &orbit.period));
        (value.re + &one, by_z.re.doubled())
    };
    let mut roots = Vec::new();
    let mut open = vec![(low, high, 0)];
    while let Some((low, high, depth)) = open.pop() {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0 * (1.0 + 1e-15));
        let wide = one.number(middle).widened(&one.number(half));
        let (value, slope) = evaluate(&wide);
        if value.is_finite() && !value.ball().contains_zero() {
            continue;
        }
        if slope.is_finite() && !slope.ball().contains_zero() {
            let at = |x: f64| evaluate(&one.number(x)).0.sign();
            match (at(low), at(high)) {
                (Some(left), Some(right)) if left == right => continue,
                (Some(_), Some(_)) => {
                    // Narrow enough for the interval Newton step to map it into itself?
                    let step = evaluate(&one.number(middle)).0 / slope;
                    if step.magnitude_above() < half / 2.0 {
                        roots.push(contract(&evaluate, wide));
                        continue;
                    }
                }
                _ => {}
            }
        }
        if depth >= DEEPEST {
            return Err(ImpactError::Undecided { what: "the flip boundary", bits });
        }
        // Off the middle, so that no round number is an end of an interval.
        let cut = low + 0.4937 * (high - low);
        open.push((cut, high, depth + 1));
        open.push((low, cut, depth + 1));
    }
    roots.sort_by(|x, y| x.to_f64().total_cmp(&y.to_f64()));
    Ok(roots)
}

/// Interval Newton: the zero lies in m - f(m)/f'(enclosure).
fn contract(
    evaluate: &impl Fn(&Certified) -> (Certified, Certified),
    mut enclosure: Certified,
) -> Certified {
    for _ in 0..60 {
        let middle = enclosure.centre();
        let slope = evaluate(&enclosure).1;
        let next = middle.clone() - evaluate(&middle).0 / slope;
        if !(next.is_finite() && next.ball().radius() < enclosure.ball().radius()) {
            break;
        }
        enclosure = next;
    }
    enclosure
}
