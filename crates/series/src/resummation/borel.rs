//! Borel summation: f(x) = int_0^infinity e^-s B(x s) ds, B(y) = sum c_n y^n/n!, with B continued
//! by its Pade approximants.

use super::estimate::distance;
use super::{Pade, ResummationError};
use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Constant;
use std::sync::{Arc, Mutex, PoisonError};

/// Halvings of the step before the integral is given up.
const LEVELS: i32 = 9;

/// The coefficients of B(x s) in s.
#[must_use]
pub fn borel_transform(c: &[Float], x: &Float, bits: u32) -> Vec<Float> {
    let mut factor = Float::with_val(bits, 1);
    let term = |(n, c): (usize, &Float)| {
        if n > 0 {
            factor *= Float::with_val(bits, x / n as u64);
        }
        Float::with_val(bits, c * &factor)
    };
    c.iter().enumerate().map(term).collect()
}

/// A node of the quadrature: s, and e^-s ds/dt there.
struct Node {
    s: Float,
    weight: Float,
}

/// The nodes of the exp-sinh rule s = exp((pi/2) sinh t), level by level as they are asked for:
/// the same for all approximants.
pub(super) struct Nodes {
    accuracy: u32,
    bits: u32,
    stop: Stop,
    levels: Mutex<Vec<Arc<Vec<Node>>>>,
}

impl Nodes {
    /// For integrals to about 2^-`accuracy` relative, as long as `stop` does not say so.
    pub fn new(accuracy: u32, bits: u32, stop: &Stop) -> Self {
        Self { accuracy, bits, stop: stop.clone(), levels: Mutex::default() }
    }

    /// The step of a level.
    fn step(level: i32) -> f64 {
        0.5f64.powi(level + 1)
    }

    /// The nodes that a level adds to those before it.
    fn level(&self, level: i32) -> Arc<Vec<Node>> {
        let index = usize::try_from(level).unwrap_or(0);
        let levels = || self.levels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = levels().get(index) {
            return Arc::clone(known);
        }
        let bits = self.bits;
        let half_pi = Float::with_val(bits, Constant::Pi) >> 1u32;
        let nats = f64::from(self.accuracy + 8) * std::f64::consts::LN_2;
        // e^-s < 2^-accuracy above, s < 2^-accuracy below.
        let high = (nats.ln() * std::f64::consts::FRAC_2_PI).asinh() + 0.3;
        let low = -(nats * std::f64::consts::FRAC_2_PI).asinh() - 0.1;
        let h = Self::step(level);
        let (first, end) = ((low / h).floor() as i64, (high / h).ceil() as i64);
        let node = |k: i64| {
            let t = Float::with_val(bits, k as f64 * h);
            let (sinh, cosh) = t.sinh_cosh(Float::new(bits));
            let s = (sinh * &half_pi).exp();
            let slope = cosh * &half_pi * &s;
            let weight = Float::with_val(bits, -&s).exp() * slope;
            Node { s, weight }
        };
        let goes_on = |_: &i64| !self.stop.asked();
        let indices = (first..=end).filter(|k| level == 0 || k % 2 != 0);
        let new = indices.take_while(goes_on).map(node).collect();
        let new = Arc::new(new);
        let mut levels = levels();
        // Another thread may have been as fast; what was broken off is not kept.
        if levels.len() == index && !self.stop.asked() {
            levels.push(Arc::clone(&new));
        }
        new
    }
}

/// int_0^infinity e^-s B(x s) ds for a Pade approximant B.
///
/// The exp-sinh rule is exponentially convergent for an integrand that is analytic near the
/// positive axis; a simple zero of the denominator there is met as a change of its sign.
///
/// # Errors
/// [`ResummationError::PoleOnPath`], [`ResummationError::NotSettled`] after nine halvings,
/// [`ResummationError::Stopped`].
pub(super) fn laplace(pade: &Pade, x: &Float, nodes: &Nodes) -> Result<Float, ResummationError> {
    let bits = nodes.bits;
    let mut sum = Float::new(bits);
    let mut last: Option<Float> = None;
    // q(0) = 1: a node where q is not positive lies behind a pole.
    for level in 0..=LEVELS {
        for node in nodes.level(level).iter() {
            if nodes.stop.asked() {
                return Err(ResummationError::Stopped);
            }
            let (top, bottom) = pade.parts(&Float::with_val(bits, x * &node.s));
            if bottom <= 0 {
                return Err(ResummationError::PoleOnPath);
            }
            sum += top / bottom * &node.weight;
        }
        if nodes.stop.asked() {
            return Err(ResummationError::Stopped);
        }
        let value = Float::with_val(bits, &sum * Nodes::step(level));
        if let Some(before) = &last {
            let size = Float::with_val(53, value.abs_ref());
            if level > 2 && distance(&value, before) <= size >> (nodes.accuracy / 2) {
                return Ok(value);
            }
        }
        last = Some(value);
    }
    Err(ResummationError::NotSettled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Euler's series sum (-1)^n n! x^n = int e^-s/(1 + x s) ds: e E_1(1) at x = 1 (A073003);
    /// with alternating signs removed there is a pole on the path.
    #[test]
    fn euler() {
        let bits = 300;
        let c = |sign: i32| -> Vec<Float> {
            let term = |n: u32| Float::with_val(bits, Float::factorial(n)) * sign.pow(n);
            (0..21).map(term).collect()
        };
        let one = Float::with_val(bits, 1);
        let sum = |sign: i32| {
            let b = borel_transform(&c(sign), &one, bits);
            laplace(
                &Pade::new(&b, 10, 10, bits, &Stop::default()).unwrap(),
                &one,
                &Nodes::new(200, bits, &Stop::default()),
            )
        };
        let gompertz =
            Float::parse("0.596347362323194074341078499369279376074177860152548781573485").unwrap();
        let gompertz = Float::with_val(bits, gompertz);
        assert!((sum(-1).unwrap() - gompertz).abs() < 1e-40);
        assert_eq!(sum(1), Err(ResummationError::PoleOnPath));
    }
}
