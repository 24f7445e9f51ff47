//! The limit cycle in the time domain.

use crate::Error;
use lindstedt_simulate::{
    Digits, Integrator, Places, Real, Report, Settings as Precision, System, go_on, monodromy,
};
use rug::Float;
use std::ops::ControlFlow;

/// Steps of Newton's method; the number of digits doubles in each.
const MOST_STEPS: usize = 20;

/// x(0) of the limit cycle with x'(0) = 0: Newton's method for x(T) = x(0), x'(T) = 0 in x(0) and
/// T, with the derivative of the flow from its linearisation.
pub(super) fn cycle(
    system: &System<Digits>,
    guess: &(Float, Float),
    precision: Precision,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<Float>, Error> {
    let real = system.real();
    let zero = real.zero();
    let (mut a, mut period) = (real.float(&guess.0), real.float(&guess.1));
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        if !goes_on() {
            return Ok(None);
        }
        let start = [a.clone(), zero.clone()];
        let flow = monodromy(system, (&zero, &period), &start, precision, &go_on)?;
        let [x, v] = &flow.end[..] else { return Ok(None) };
        let [first, second] = &flow.matrix[..] else { return Ok(None) };
        // x''(0), at the solution x''(T).
        let mut acceleration = real.zero();
        let mut one = Integrator::new(system, &zero, &start, precision)?;
        one.advance(&period, &mut |report| {
            let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
            if let Some(rate) = segment.coefficients(1).and_then(|c| c.get(1)) {
                acceleration = rate.clone();
            }
            ControlFlow::Break(())
        })?;
        let (p, q) = (real.difference(&first[0], &real.double(1.0)), v.clone());
        let (r, s) = (second[0].clone(), acceleration);
        let (f, g) = (real.difference(x, &a), v.clone());
        let determinant = real.difference(&real.product(&p, &s), &real.product(&q, &r));
        let da = real.difference(&real.product(&q, &g), &real.product(&s, &f));
        let dt = real.difference(&real.product(&r, &f), &real.product(&p, &g));
        let (da, dt) = (real.quotient(&da, &determinant), real.quotient(&dt, &determinant));
        a += &da;
        period += &dt;
        let size = real.log2(&da);
        // At the noise of the integration the steps cease to shrink.
        let small = -std::f64::consts::LOG2_10 * f64::from(precision.digits);
        if size < small || (size >= last && last < -40.0) {
            return Ok(Some(a));
        }
        if size.is_nan() || size > 0.0 {
            return Ok(None);
        }
        last = size;
    }
    Ok(None)
}
