//! Does the flight between two impacts stay on its side of the wall?

use crate::characteristic::check;
use crate::error::ImpactError;
use crate::orbit::Orbit;
use crate::parameters::Parameters;
use lindstedt_algebra::Stop;
use lindstedt_number::real::Real;

/// Smallest interval of the bisection, as a power of two of the period.
const DEEPEST: u32 = 60;

/// The largest local maximum of x(t) - s inside (0, T).
#[derive(Clone, Debug)]
pub struct Clearance<S> {
    /// x - s there: positive means that the flight passes through the wall.
    pub margin: S,
    /// When.
    pub time: S,
}

/// A flight on \[0, T\].
struct Flight<'a, S>(&'a Parameters<S>, &'a Orbit<S>);

impl<S: Real> Flight<'_, S> {
    /// (x - s, x', x'').
    fn state(&self, t: &S) -> (S, S, S) {
        let Self(parameters, orbit) = self;
        let (x, v) = orbit.state(parameters, t);
        let Parameters { alpha, omega, damping: c, wall, force, .. } = parameters;
        let (sin, cos) = (omega.clone() * t).sin_cos();
        let drive = orbit.force_phase.0.clone() * cos - orbit.force_phase.1.clone() * sin;
        let acceleration = force.clone() * drive - c.clone() * &v - alpha.square() * &x;
        (x - wall, v, acceleration)
    }
    /// Bounds of |x''| and |x'''| on the whole flight.
    fn bounds(&self) -> (f64, f64) {
        // H = sqrt(x'^2 + alpha^2 x^2) grows at most by P0 per unit of time (c >= 0).
        let Self(parameters, orbit) = self;
        let alpha = parameters.alpha.magnitude_above();
        let force = parameters.force.magnitude_above();
        let start = orbit.velocity.magnitude_above() + alpha * parameters.wall.magnitude_above();
        let energy = start + force * orbit.period.magnitude_above();
        let c = parameters.damping.magnitude_above();
        let second = (c + alpha) * energy + force;
        let third =
            c * second + alpha * alpha * energy + force * parameters.omega.magnitude_above();
        (second * (1.0 + 1e-12), third * (1.0 + 1e-12))
    }
}

/// The clearance of the true orbit; `None` if x has no local maximum inside the flight (then it
/// stays below the wall).
///
/// Certified for balls: every interval is either proved monotone by |x'| > M2 width/2 at its
/// middle, or proved convex or concave by |x''| > M3 width/2, with M2, M3 bounds of |x''|, |x'''|.
/// Doubles follow the same subdivision without the rounding errors.
///
/// # Errors
/// [`ImpactError::Undecided`] where x' and x'' vanish together within the precision; [`ImpactError::Cancelled`].
pub fn clearance<S: Real>(
    parameters: &Parameters<S>,
    orbit: &Orbit<S>,
    stop: &Stop,
) -> Result<Option<Clearance<S>>, ImpactError> {
    largest_maximum(&Flight(parameters, orbit), &orbit.period, stop)
}

/// One interval of the bisection in units of T.
struct Interval {
    low: f64,
    high: f64,
    depth: u32,
}

fn largest_maximum<S: Real>(
    flight: &Flight<'_, S>,
    period: &S,
    stop: &Stop,
) -> Result<Option<Clearance<S>>, ImpactError> {
    let (second, third) = flight.bounds();
    let length = period.magnitude_above();
    let undecided =
        || ImpactError::Undecided { what: "penetration of the wall", bits: period.precision() };
    if !(second.is_finite() && third.is_finite() && length.is_finite()) {
        return Err(undecided());
    }
    let at = |part: f64| period.clone() * period.number(part);
    let mut best: Option<Clearance<S>> = None;
    let mut open = vec![Interval { low: 0.0, high: 1.0, depth: 0 }];
    while let Some(Interval { low, high, depth }) = open.pop() {
        check(stop)?;
        // Not the middle: a symmetric flight has its maximum there.
        let cut = low + 0.482 * (high - low);
        let reach = (high - cut).max(cut - low) * length * (1.0 + 1e-12);
        let (_, velocity, acceleration) = flight.state(&at(cut));
        if velocity.magnitude_below() > second * reach {
            continue;
        }
        let curved = acceleration.magnitude_below() > third * reach;
        if curved && acceleration.is_positive() {
            continue;
        }
        if curved {
            // The flight leaves the wall with x'(0) <= 0 and returns with x'(T) > 0.
            if low == 0.0 || high == 1.0 {
                continue;
            }
            let rising = flight.state(&at(low)).1;
            let falling = flight.state(&at(high)).1;
            if rising.is_negative() || falling.is_positive() {
                continue;
            }
            if rising.is_positive() && falling.is_negative() {
                let found = maximum(flight, &at(low), &at(high), &at(cut));
                best = larger(best, found.ok_or_else(undecided)?);
                continue;
            }
        }
        if depth >= DEEPEST {
            return Err(undecided());
        }
        open.push(Interval { low, high: cut, depth: depth + 1 });
        open.push(Interval { low: cut, high, depth: depth + 1 });
    }
    Ok(best)
}

/// The maximum in an interval where x is proved concave and x' changes sign: Newton's method on
/// x', then |t - t*| <= |x'|/min|x''|, and x(t*) - x(t) <= |x'| |t - t*|.
fn maximum<S: Real>(flight: &Flight<'_, S>, low: &S, high: &S, start: &S) -> Option<Clearance<S>> {
    let (_, third) = flight.bounds();
    let width = (high.clone() - low).magnitude_above();
    let (mut t, mut last) = (start.clone(), f64::INFINITY);
    let (mut low, mut high) = (low.to_f64(), high.to_f64());
    for _ in 0..200 {
        let (margin, velocity, acceleration) = flight.state(&t);
        let step = velocity.clone() / &acceleration;
        let size = step.to_f64().abs();
        if !size.is_finite() {
            return None;
        }
        if size == 0.0 || (size >= last && size < 1e-9 * width) {
            // Within `reach` of t |x''| stays above `slope`; the zero is in there if x' falls by
            // more than |x'(t)| over it.
            let (speed, bend) = (velocity.magnitude_above(), acceleration.magnitude_below());
            let reach = 4.0 * speed / bend;
            let slope = bend - third * reach;
            if slope.is_nan() || slope <= bend / 2.0 {
                return None;
            }
            let error = velocity.clone() / velocity.number(slope);
            let margin = margin.widened(&(error.clone() * &velocity));
            return Some(Clearance { margin, time: t.widened(&error) });
        }
        last = size;
        // x' falls through its zero: keep the bracket, bisect where Newton leaves it.
        if velocity.to_f64() > 0.0 {
            low = low.max(t.to_f64());
        } else {
            high = high.min(t.to_f64());
        }
        t = (t - step.centre()).centre();
        if t.to_f64() < low || t.to_f64() > high {
            t = t.number(f64::midpoint(low, high));
        }
    }
    None
}

fn larger<S: Real>(best: Option<Clearance<S>>, found: Clearance<S>) -> Option<Clearance<S>> {
    match best {
        Some(best) if best.margin.to_f64() >= found.margin.to_f64() => Some(best),
        _ => Some(found),
    }
}
