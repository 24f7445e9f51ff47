//! Nodes on the quarter period, and Si(pi m) for the indefinite integrals.
//!
//! The phase is mapped to the real line by
//!
//!   cos psi = 1/cosh w,  sin psi = tanh w,  dpsi = dw/cosh w,  w = (pi/2) sinh t,
//!
//! so psi = 0 is t = 0, psi -> pi/2 is t -> infinity, and cos psi keeps its full relative accuracy
//! at the end point, where x vanishes and the logarithms grow. The only singularities of
//! trigonometric functions of psi are at w = i pi/2 (mod i pi): functions with branch points at
//! odd multiples of pi/2 alone are analytic in the strip |Im t| < pi/2, and sampling t at the step
//! h costs a relative error of about exp(-pi^2/(2 h)) (Stenger, *Numerical Methods Based on Sinc and
//! Analytic Functions*, 1993, section 4.5). Even or odd extension to t < 0 halves the nodes.

use lindstedt_algebra::Stop;
use rug::float::Constant;
use rug::{Assign, Float};
use std::f64::consts::{LN_2, LN_10, PI};

/// The step of t and the number of nodes t = 0, h, 2h, ...
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// h.
    pub step: f64,
    /// How many nodes.
    pub nodes: usize,
}

impl Grid {
    /// The grid for `digits` digits of an expansion to `order`, and the bits to compute with.
    ///
    /// The grid ends at l = -ln cos psi where neglecting the rest costs less than the digits: a
    /// force of order n is at most about (2 l)^n/n! times cos psi (powers of the logarithm; then
    /// the integrand falls like e^(-2l)), or bounded (then e^(-l)).
    ///
    /// With A = -ln(error of one integral), poles of order k of cos^k psi at w = i pi/2 cost a
    /// factor (pi/h)^(k-1)/(k-1)!, of which k = 5 is allowed for (forces of higher degree need a
    /// larger A), and order n costs e^(A phi(n/A)), phi(y) = 0.62 (1 - e^(-4y)), as measured on the
    /// power law for A = 150, 200, 260 and n <= 60 (an upper bound). The grid must not reach to where
    /// cos psi is below the error of a solution, for powers of x_n/x_0 would be noise there.
    #[must_use]
    pub fn for_digits(digits: u32, order: usize) -> (Self, u32) {
        let wanted = f64::from(digits) * LN_10 + 8.0;
        let end = end(wanted, order);
        let poles = |accuracy: f64| 4.0 * (2.0 * accuracy / PI).ln();
        let mut accuracy = wanted;
        // A - loss(A) grows with A at a rate of at least 0.38.
        for _ in 0..60 {
            let loss = 0.62 * accuracy * (1.0 - (-4.0 * order as f64 / accuracy).exp());
            accuracy = wanted + loss + poles(accuracy);
        }
        let accuracy = accuracy.max(end + poles(accuracy) + 4.0);
        (Self::new(accuracy, end), (accuracy / LN_2).ceil() as u32 + 20)
    }

    /// The grid with discretisation error e^-accuracy that ends where cos psi = e^-end.
    #[must_use]
    pub fn new(accuracy: f64, end: f64) -> Self {
        // Few bits, so that k h is exact for every node k.
        let step = PI * PI / (2.0 * accuracy);
        let step = f64::from_bits(step.to_bits() >> 30 << 30);
        let nodes = ((2.0 * (end + LN_2) / PI).asinh() / step).ceil() as usize + 1;
        Self { step, nodes }
    }
}

/// The smallest l >= wanted with (2l)^n e^(-2l)/n! <= e^-wanted for all n <= order.
fn end(wanted: f64, order: usize) -> f64 {
    let log_factorial: f64 = (1..=order).map(|k| (k as f64).ln()).sum();
    let n = order as f64;
    // Beyond l = n/2 the left side falls with l and grows with n.
    let mut l = wanted.max(n);
    while n * (2.0 * l).ln() - log_factorial - 2.0 * l > -wanted {
        l += 1.0;
    }
    l
}

/// Node t: cos psi, sin psi and dpsi/dt at `bits` bits.
pub(super) fn node(t: f64, bits: u32) -> [Float; 3] {
    let work = bits + 64;
    let half_pi = Float::with_val(work, Constant::Pi) / 2u32;
    let t = Float::with_val(work, t);
    let (sinh, cosh) = t.sinh_cosh(Float::new(work));
    let w = Float::with_val(work, &half_pi * &sinh);
    let secant = Float::with_val(work, w.cosh_ref()).recip();
    let slope = half_pi * cosh * &secant;
    let round = |x: &Float| Float::with_val(bits, x);
    [round(&secant), round(&Float::with_val(work, w.tanh_ref())), round(&slope)]
}

/// Si(pi m)/pi for m = 0..count at `bits` bits; zero once `stop` says so.
///
/// From Si(x) = pi/2 - cos x f(x) - sin x g(x) with f(x) ~ sum_k (-1)^k (2k)!/x^(2k+1), whose error is
/// below its smallest term, about e^-x; where that is too large, by the Taylor series, whose terms
/// grow to e^x.
pub(super) fn sine_integrals(count: usize, bits: u32, stop: &Stop) -> Vec<Float> {
    let inverse_pi = Float::with_val(bits + 32, Constant::Pi).recip();
    let asymptotic_from = ((f64::from(bits) + 16.0) * LN_2 / PI).ceil() as usize + 1;
    let value = |m: usize| {
        if stop.asked() {
            return Float::new(bits);
        }
        let si = if m < asymptotic_from { taylor(m, bits) } else { asymptotic(m, bits) };
        Float::with_val(bits, &si * &inverse_pi)
    };
    (0..count).map(value).collect()
}

/// sum_k (-1)^k x^(2k+1)/((2k+1) (2k+1)!).
fn taylor(m: usize, bits: u32) -> Float {
    let size = PI * m as f64 / LN_2;
    let work = bits + size.ceil() as u32 + 32;
    let x = Float::with_val(work, Constant::Pi) * m as u64;
    let square = Float::with_val(work, x.square_ref());
    let mut sum = x.clone();
    let mut power = x;
    let mut term = Float::new(work);
    for k in 1u64.. {
        power *= &square;
        power /= 2 * k * (2 * k + 1);
        term.assign(&power / (2 * k + 1));
        if k % 2 == 1 {
            sum -= &term;
        } else {
            sum += &term;
        }
        let negligible = term.get_exp().is_none_or(|e| i64::from(e) < -i64::from(bits) - 16);
        if negligible && 2.0 * k as f64 > PI * m as f64 {
            break;
        }
    }
    sum
}

/// pi/2 - (-1)^m sum_k (-1)^k (2k)!/x^(2k+1), up to the smallest term.
fn asymptotic(m: usize, bits: u32) -> Float {
    let work = bits + 32;
    let pi = Float::with_val(work, Constant::Pi);
    let x = Float::with_val(work, &pi * m as u64);
    let square = Float::with_val(work, x.square_ref());
    let mut term = x.recip();
    let mut sum = term.clone();
    for k in 1u64.. {
        term *= (2 * k - 1) * (2 * k);
        term /= &square;
        term = -term;
        sum += &term;
        let negligible = term.get_exp().is_none_or(|e| i64::from(e) < -i64::from(bits) - 16);
        if negligible || 2.0 * k as f64 > PI * m as f64 {
            break;
        }
    }
    let half_pi = pi / 2u32;
    if m.is_multiple_of(2) { half_pi - sum } else { half_pi + sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_integral_on_both_branches() {
        // mpmath 1.3.0, 30 digits: si(pi*m)/pi.
        let expected = [
            (1, "0.589489872236083635116014422912"),
            (7, "0.514415997123305251036335634045"),
            (20, "0.494936499570695471054849394610"),
            (60, "0.498311408629275599011133370309"),
        ];
        let list = sine_integrals(61, 100, &Stop::default());
        for (m, text) in expected {
            let truth = Float::with_val(120, Float::parse(text).expect("a number"));
            let error = Float::with_val(53, &list[m] - &truth).abs();
            assert!(error < 1e-28, "m = {m}: {}", list[m]);
        }
        // The two formulas at one point.
        let difference = taylor(30, 100) - asymptotic(30, 100);
        assert!(difference.abs() < 1e-29);
    }

    #[test]
    fn the_map() {
        let [cos, sin, slope] = node(3.5, 100);
        let one = Float::with_val(100, cos.square_ref()) + sin.square();
        assert!((one - 1u32).abs() < 1e-29);
        // psi = 2 atan(tanh(w/2)) differentiated numerically.
        let psi = |t: f64| (2.0 * (PI / 4.0 * t.sinh()).tanh().atan()) - PI / 2.0;
        let numeric = (psi(1.0 + 1e-5) - psi(1.0 - 1e-5)) / 2e-5;
        assert!((node(1.0, 60)[2].to_f64() - numeric).abs() < 1e-9);
        assert!(slope > 0 && cos < 1e-9);
    }
}
