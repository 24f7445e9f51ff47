//! Where the KBM series converges.
//!
//! lambda(eps) of [`crate::flow`] has branch points where lambda^2 + alpha^2 = eps g and
//! 2 lambda = eps g' hold together; the nearest bounds the convergence of the series.

use crate::parameters::Parameters;
use lindstedt_number::complex::Complex;

type Point = Complex<f64>;

/// Estimates of the radius of convergence in eps; the series is summed at eps = 1.
#[derive(Clone, Copy, Debug)]
pub struct Convergence {
    /// The least |eps| of a branch point: estimated (some branch points lie on other sheets, then
    /// the series converges further). Infinite without control and damping.
    pub radius: f64,
    /// |lambda_N/lambda_(N-1)| of the last two terms: estimated, 1/radius in the limit.
    pub ratio: f64,
}

impl Convergence {
    /// Whether the sum at eps = 1 lies outside the estimated disc.
    #[must_use]
    pub fn diverges(&self) -> bool {
        self.radius < 1.0
    }
}

/// The radius by branch points: start values from the Lambert functions (x = -1 - W_j(-P/(e Q)),
/// P = A + i alpha B - i alpha c, Q = (A + i alpha B) e^(-i alpha T), valid for small gains), then
/// Newton's method on (l^2 + alpha^2) g'(l) - 2 l g(l) = 0, eps = 2 l/g'(l).
///
/// Estimated; `terms` are lambda_0, lambda_1, ... (for the ratio).
#[must_use]
pub fn convergence(parameters: &Parameters<f64>, terms: &[Point]) -> Convergence {
    let ratio = match terms {
        [.., before, last] if terms.len() > 2 => last.modulus() / before.modulus(),
        _ => f64::NAN,
    };
    Convergence { radius: radius(parameters), ratio }
}

fn radius(parameters: &Parameters<f64>) -> f64 {
    let &Parameters { alpha, damping: c, displacement_gain: a, velocity_gain: b, .. } = parameters;
    let time = parameters.period();
    let gain = Point::new(a, alpha * b);
    let p = gain.clone() - Point::new(0.0, alpha * c);
    let q = gain * Point::new(0.0, -alpha * time).exp();
    if q.modulus() == 0.0 {
        // lambda = sqrt(alpha^2 - eps^2 c^2/4) - eps c/2
        return if c == 0.0 { f64::INFINITY } else { 2.0 * alpha / c };
    }
    let argument = -p.over(&q).scaled(&(-1.0_f64).exp());
    let mut least = f64::INFINITY;
    for branch in -3..=3 {
        let Some(w) = lambert(&argument, branch) else { continue };
        let x = -Point::real(1.0) - w;
        if x.modulus() < 1e-9 {
            continue;
        }
        let approximate = 2.0 * alpha * x.re.exp() / (time * q.modulus());
        let start = Point::new(0.0, alpha) + x.scaled(&(1.0 / time));
        let refined = branch_point(parameters, time, &start);
        // A start value that runs far away says nothing about its branch point.
        let near = |eps: &f64| (0.3..3.0).contains(&(eps / approximate));
        least = least.min(refined.filter(near).unwrap_or(approximate));
    }
    least
}

/// |eps| at the branch point near `start`.
fn branch_point(parameters: &Parameters<f64>, time: f64, start: &Point) -> Option<f64> {
    let &Parameters { alpha, damping: c, displacement_gain: a, velocity_gain: b, .. } = parameters;
    let mut l = start.clone();
    for _ in 0..60 {
        let e = (-l.scaled(&time)).exp();
        let gain = Point::real(a) + l.scaled(&b);
        let one_minus = Point::real(1.0) - &e;
        let g = gain.clone() * &one_minus - l.scaled(&c);
        let g1 = one_minus.scaled(&b) + (gain.clone() * &e).scaled(&time) - Point::real(c);
        let g2 = e.scaled(&(2.0 * b * time)) - (gain * &e).scaled(&(time * time));
        let quadratic = l.clone() * &l + Point::real(alpha * alpha);
        let value = quadratic.clone() * &g1 - (l.clone() * &g).scaled(&2.0);
        let slope = quadratic * &g2 - g.scaled(&2.0);
        let step = value.over(&slope);
        l = l - &step;
        if !l.is_finite() {
            return None;
        }
        if step.modulus() < 1e-12 * (1.0 + l.modulus()) {
            return Some(l.scaled(&2.0).over(&g1).modulus());
        }
    }
    None
}

/// The branch W_j of w e^w = z by Newton's method on w + ln w = ln z + 2 pi i j; for j = 0 near
/// z = 0, where w ~ z, on w e^w - z.
fn lambert(z: &Point, branch: i32) -> Option<Point> {
    let angle = z.im.atan2(z.re) + 2.0 * std::f64::consts::PI * f64::from(branch);
    let logarithm = Point::new(z.modulus().ln(), angle);
    let mut w = if branch == 0 {
        Point::real(0.5) * z + Point::real(0.05)
    } else {
        let second = Point::new(logarithm.modulus().ln(), logarithm.im.atan2(logarithm.re));
        logarithm.clone() - second
    };
    for _ in 0..100 {
        let step = if branch == 0 {
            let e = w.exp();
            let value = w.clone() * &e - z;
            value.over(&(e * (Point::real(1.0) + &w)))
        } else {
            let ln = Point::new(w.modulus().ln(), w.im.atan2(w.re));
            let value = w.clone() + ln - &logarithm;
            value.over(&(Point::real(1.0) + w.inverse()))
        };
        w = w - &step;
        if !w.is_finite() {
            return None;
        }
        if step.modulus() < 1e-14 * (1.0 + w.modulus()) {
            return Some(w);
        }
    }
    None
}
