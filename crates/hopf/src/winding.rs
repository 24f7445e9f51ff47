//! How many roots of L have a positive real part at the Hopf point, by the argument principle.
//!
//! The half plane within |lambda| <= R is gone round, R so large that |L/lambda^n - 1| < 1 on Re lambda >= 0 beyond it;
//! i omega_0 is passed on the right, by a rectangle in which L has no other zero. L is conjugate at conjugate points, so
//! the upper half suffices: with D the change of arg L along the path from 0 to iR,
//!
//!   N = (n pi/2 + arg(L(iR)/(iR)^n) - D)/pi.
//!
//! Every piece of the path is a box whose image is a rectangle without zero, so that the argument changes by less than
//! pi along it and its ends decide by how much: the number is certain.

use crate::equation::{DelayEquation, characteristic, reach, value};
use crate::search::HopfPoint;
use lindstedt_equation::Expression;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls, Complex, ComplexBalls};
use rug::Float;
use std::f64::consts::{FRAC_PI_2, PI};

/// Bits of the values.
const BITS: u32 = 96;
/// Halvings of a piece of the path.
const DEEPEST: u32 = 40;

struct Path<'a> {
    equation: &'a DelayEquation<Enclosure>,
    ring: BallRing,
    alpha: &'a Ball,
}

/// The roots with Re lambda > 0; nothing where other roots lie on the imaginary axis or too near to tell.
pub(crate) fn unstable(equation: &DelayEquation<Expression>, point: &HopfPoint) -> Option<usize> {
    let ring = BallRing { balls: Balls::new(BITS) };
    let equation = equation.over(&ring)?;
    let path = Path { equation: &equation, ring, alpha: &point.parameter };
    let omega = point.frequency.midpoint().to_f64();
    let far = reach(&equation, ring, &point.parameter)?.max(2.0 * omega);
    let aside = path.aside(&point.frequency)?;
    let corners = [
        [0.0, 0.0],
        [0.0, omega - aside],
        [aside, omega - aside],
        [aside, omega + aside],
        [0.0, omega + aside],
        [0.0, far],
    ];
    let mut change = 0.0;
    for pair in corners.windows(2) {
        change += path.change(pair[0], pair[1], 0)?;
    }
    let end = path.value([0.0, far], [0.0, far]);
    let n = f64::from(equation.order);
    // arg(L/(i^n)), |.| < pi/2 where R is as large as that.
    let mut rest = argument(&end)? - n * FRAC_PI_2;
    rest -= 2.0 * PI * (rest / (2.0 * PI)).round();
    let count = (n * FRAC_PI_2 + rest - change) / PI;
    let whole = count.round();
    ((count - whole).abs() < 1e-3 && whole >= 0.0).then_some(whole as usize)
}

impl Path<'_> {
    /// L over the box with these opposite corners.
    fn value(&self, from: [f64; 2], to: [f64; 2]) -> Complex {
        let balls = self.ring.balls;
        let side = |k: usize| {
            let [a, b] = [from[k], to[k]]
                .map(|x| balls.from_parts(&Float::with_val(53, x), &Float::new(53)));
            balls.hull(&a, &b)
        };
        let lambda = Complex { re: side(0), im: side(1) };
        characteristic(self.equation, self.ring, &lambda, self.alpha).value
    }

    /// The change of arg L between two points.
    fn change(&self, from: [f64; 2], to: [f64; 2], depth: u32) -> Option<f64> {
        if !self.value(from, to).contains_zero() {
            let [a, b] = [from, to].map(|z| self.value(z, z));
            let plane = ComplexBalls::new(self.ring.balls);
            return argument(&plane.mul(&b, &plane.conj(&a)));
        }
        if depth == DEEPEST {
            return None;
        }
        let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        Some(self.change(from, middle, depth + 1)? + self.change(middle, to, depth + 1)?)
    }

    /// h, so small that L has no zero but i omega_0 within 2 h of it: |L''| h < |L'| there.
    fn aside(&self, omega: &Ball) -> Option<f64> {
        let balls = self.ring.balls;
        let lambda = Complex { re: balls.zero(), im: omega.clone() };
        let at = characteristic(self.equation, self.ring, &lambda, self.alpha);
        let slope = at.by_root.abs_lower().to_f64();
        let alpha = Enclosure(self.alpha.clone());
        let bends = |h: f64| -> f64 {
            let size = omega.abs_upper().to_f64() + 2.0 * h;
            let part = |(term, factor): (&crate::Term<Enclosure>, crate::Factor)| {
                let c = value(&self.ring, &term.coefficient, &alpha).0.abs_upper().to_f64();
                let delay = &self.equation.delays[factor.delay];
                let later = value(&self.ring, delay, &alpha).0.abs_upper().to_f64();
                let n = factor.derivative as i32;
                let power = |k: i32| if k > n { 0.0 } else { size.powi(n - k) };
                let m = f64::from(n);
                let derivative = m * (m - 1.0).max(0.0) * power(2)
                    + 2.0 * m * later * power(1)
                    + later * later * power(0);
                c * derivative * (2.0 * h * later).exp()
            };
            self.equation.linear().map(part).sum()
        };
        let first = 0.25 * omega.lower().to_f64();
        (0..60).map(|k| first * 0.5f64.powi(k)).find(|h| 1.01 * bends(*h) * h < slope)
    }
}

/// The argument in (-pi, pi].
fn argument(z: &Complex) -> Option<f64> {
    let [re, im] = [&z.re, &z.im].map(|part| part.midpoint().to_f64());
    (!z.contains_zero()).then(|| im.atan2(re))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residual::tests::wright;
    use crate::search::points;

    /// Of lambda + alpha e^-lambda: none at pi/2, the pair of pi/2 at 5 pi/2, a positive number at -3 pi/2.
    #[test]
    fn roots_of_wright() {
        let count = |near: f64| {
            let found = points(&wright(), "alpha", near, &mut || true).unwrap();
            unstable(&wright(), &found.points[0])
        };
        assert_eq!([count(1.0), count(8.0), count(-4.0)], [Some(0), Some(2), Some(1)]);
        assert_eq!(count(14.0), Some(4));
    }
}
