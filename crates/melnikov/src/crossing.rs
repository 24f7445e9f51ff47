//! Where an element of the hyperbolic algebra takes a value, and its largest absolute value:
//! certified and complete, by bisection with ball evaluation.

use crate::hyperbolic::{Hyperbolic, HyperbolicRing};
use crate::root::enclose_root;
use lindstedt_number::ball::{Ball, Balls};
use rug::Float;

/// Bits that decide which intervals hold nothing.
const COARSE: u32 = 64;
/// The most intervals looked at.
const MOST_INTERVALS: usize = 100_000;

impl Hyperbolic {
    /// An enclosure of the values over a ball of z; `None` where the ball is too wide.
    #[must_use]
    pub fn evaluate(&self, balls: Balls, z: &Ball) -> Option<Ball> {
        let cosh = balls.cosh(z);
        let sech = balls.div(&balls.one(), &cosh)?;
        let tanh = balls.mul(&balls.sinh(z), &sech);
        let mut sum = balls.zero();
        for (c, p, odd) in self.terms() {
            let power = balls.powi(&sech, i64::from(p))?;
            let factor = if odd { balls.mul(&power, &tanh) } else { power };
            sum = balls.add(&sum, &balls.mul_rational(&factor, c));
        }
        Some(sum)
    }
}

/// |g(z)| <= B e^{-|z|} for a g that decays: B = sum |c| 2^p.
fn decay_bound(g: &Hyperbolic) -> f64 {
    g.terms().map(|(c, p, _)| c.to_f64().abs() * 2f64.powf(f64::from(p))).sum()
}

/// Some Z with |g(z)| < level for |z| > Z.
fn reach(g: &Hyperbolic, level: f64) -> Option<f64> {
    let reach = (decay_bound(g) / level).ln().max(0.0) + 1.0;
    reach.is_finite().then_some(reach)
}

fn interval(low: f64, high: f64) -> Option<Ball> {
    let coarse = Balls::new(COARSE);
    Some(coarse.hull(&coarse.from_f64(low)?, &coarse.from_f64(high)?))
}

/// All z with g(z) = level, ascending, complete; g decays, level != 0.
///
/// An interval is dropped where the ball of g - level over it excludes 0, searched for one sign
/// change where that of g' does, and halved otherwise. `None` where this does not end (a double
/// root: the level is an extreme of g) or the level is not known to differ from 0.
pub(crate) fn level_crossings(balls: Balls, g: &Hyperbolic, level: &Ball) -> Option<Vec<Ball>> {
    if !g.decays() || level.contains_zero() {
        return None;
    }
    let slope = HyperbolicRing.derivative(g);
    let z = reach(g, level.abs_lower().to_f64())?;
    let coarse = Balls::new(COARSE);
    // No symmetric split: roots and symmetry points would fall on the ends of intervals.
    let mut stack = vec![(-1.013_7 * z, z)];
    let mut roots = Vec::new();
    let mut looked = 0;
    while let Some((low, high)) = stack.pop() {
        looked += 1;
        if looked > MOST_INTERVALS {
            return None;
        }
        let over = interval(low, high)?;
        let value = g.evaluate(coarse, &over).map(|value| coarse.sub(&value, level));
        if value.is_some_and(|value| !value.contains_zero()) {
            continue;
        }
        if slope.evaluate(coarse, &over).is_some_and(|slope| !slope.contains_zero()) {
            let difference =
                |balls: Balls, z: &Ball| Some(balls.sub(&g.evaluate(balls, z)?, level));
            let sign = |x: f64| {
                let value = difference(balls, &balls.from_f64(x)?)?;
                (!value.contains_zero()).then(|| value.is_positive())
            };
            if sign(low)? != sign(high)? {
                let ends = (Float::with_val(53, low), Float::with_val(53, high));
                roots.push(enclose_root(balls, &ends.0, &ends.1, difference)?);
            }
            continue;
        }
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            return None;
        }
        stack.push((middle, high));
        stack.push((low, middle));
    }
    Some(roots)
}

/// max |g| over the line for a g that decays: the largest |g| at the roots of g' in the intervals
/// that can hold the maximum. `None` where the search does not end.
pub(crate) fn largest_value(balls: Balls, g: &Hyperbolic) -> Option<Ball> {
    if !g.decays() {
        return None;
    }
    let ring = HyperbolicRing;
    let slope = ring.derivative(g);
    let bend = ring.derivative(&slope);
    let coarse = Balls::new(COARSE);
    let size = |x: f64| Some(g.evaluate(coarse, &coarse.from_f64(x)?)?.abs_lower().to_f64());
    let mut best = 0.0f64;
    for i in -400..=400 {
        best = best.max(size(f64::from(i) * 0.05 + 0.011)?);
    }
    if best <= 0.0 {
        return None;
    }
    let z = reach(g, best)?;
    let mut stack = vec![(-1.013_7 * z, z)];
    let mut largest: Option<Ball> = None;
    let mut looked = 0;
    while let Some((low, high)) = stack.pop() {
        looked += 1;
        if looked > MOST_INTERVALS {
            return None;
        }
        let over = interval(low, high)?;
        let upper = g.evaluate(coarse, &over).map_or(f64::INFINITY, |v| v.abs_upper().to_f64());
        let moving = slope.evaluate(coarse, &over).is_some_and(|v| !v.contains_zero());
        if upper < best || moving {
            continue;
        }
        let monotone = bend.evaluate(coarse, &over).is_some_and(|v| !v.contains_zero());
        if monotone {
            let ends = (Float::with_val(53, low), Float::with_val(53, high));
            let root = enclose_root(balls, &ends.0, &ends.1, |b, z| slope.evaluate(b, z));
            if let Some(root) = root {
                let value = balls.abs(&g.evaluate(balls, &root)?);
                largest = Some(match largest {
                    Some(other) if other.lower() >= value.upper() => other,
                    Some(other) if other.upper() > value.lower() => balls.hull(&other, &value),
                    _ => value,
                });
            }
            continue;
        }
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            return None;
        }
        stack.push((middle, high));
        stack.push((low, middle));
    }
    largest
}

/// int xi' sgn(xi' - level) dz for xi' = derivative of `shape`, level != 0: the pieces between the
/// crossings, each the difference of xi at its ends.
pub(crate) fn sign_integral(balls: Balls, shape: &Hyperbolic, level: &Ball) -> Option<Ball> {
    let speed = HyperbolicRing.derivative(shape);
    let crossings = level_crossings(balls, &speed, level)?;
    // xi at -infinity and at infinity: the constant and the coefficient of tanh.
    let mut constant = balls.zero();
    let mut step = balls.zero();
    for (c, p, odd) in shape.terms() {
        match (p, odd) {
            (0, false) => constant = balls.from_rational(c),
            (0, true) => step = balls.from_rational(c),
            _ => {}
        }
    }
    let mut ends = vec![balls.sub(&constant, &step)];
    for z in &crossings {
        ends.push(shape.evaluate(balls, z)?);
    }
    ends.push(balls.add(&constant, &step));
    // At infinity xi' = 0, below a positive level; every crossing is simple and changes the sign.
    let mut faster = level.is_negative();
    let mut sum = balls.zero();
    for pair in ends.windows(2) {
        let [from, to] = pair else { continue };
        let piece = if faster { balls.sub(to, from) } else { balls.sub(from, to) };
        sum = balls.add(&sum, &piece);
        faster = !faster;
    }
    Some(sum)
}
