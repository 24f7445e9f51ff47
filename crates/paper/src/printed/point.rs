//! The quantities that (22)-(27) print, in doubles, at one point where every misprint shows.

use lindstedt_melnikov::quadrature::tanh_sinh;
use lindstedt_melnikov::{MelnikovError, StickSlip};
use lindstedt_number::Exact;
use rug::{Float, Rational};
use std::f64::consts::PI;

/// The discriminating point: no two parameters coincide and a != 1.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub a: f64,
    pub b: f64,
    pub dry: f64,
    pub alpha: f64,
    pub beta: f64,
    pub v: f64,
    pub gamma: f64,
    pub omega: f64,
    pub t0: f64,
}

pub(super) const POINT: Point = Point {
    a: 1.7,
    b: 2.3,
    dry: 0.4,
    alpha: 0.35,
    beta: 0.25,
    v: 0.5,
    gamma: 0.8,
    omega: 1.4,
    t0: 0.6,
};

/// The point at which (22) to (27) are compared, in words.
pub(crate) const COMPARED_AT: &str = "$a = 1.7$, $b = 2.3$, $T0 = 0.4$, $alpha = 0.35$, $beta = 0.25$, $v* = 0.5$, $gamma = 0.8$, \
                               $omega = 1.4$, $t0 = 0.6$";

/// A decimal of at most 6 places as the rational number it stands for.
pub(super) fn exact(x: f64) -> Exact {
    Exact::Rational(Rational::from(((x * 1e6).round() as i64, 1_000_000)))
}

impl Point {
    pub fn stick_slip(&self) -> StickSlip {
        StickSlip {
            a: exact(self.a),
            b: exact(self.b),
            dry: exact(self.dry),
            alpha: exact(self.alpha),
            beta: exact(self.beta),
            omega: exact(self.omega),
            belt_speed: exact(self.v),
        }
    }
    /// x0 of (23), upper sign.
    pub fn displacement(&self, t: f64) -> f64 {
        (2.0 * self.a / self.b).sqrt() / (self.a.sqrt() * t).cosh()
    }
    /// dx0/dt by a symmetric difference of sixth order.
    pub fn slope(&self, t: f64) -> f64 {
        let d = |h: f64| (self.displacement(t + h) - self.displacement(t - h)) / (2.0 * h);
        1.5 * d(1e-2) - 0.6 * d(2e-2) + 0.1 * d(3e-2)
    }
    /// The bracket of (26) as meant: sqrt(1/2 + q) - sqrt(1/2 - q), q = sqrt(1/4 - b v^2/(2a^2)).
    pub fn bracket(&self) -> f64 {
        let q = (0.25 - self.b * self.v * self.v / (2.0 * self.a * self.a)).sqrt();
        (0.5 + q).sqrt() - (0.5 - q).sqrt()
    }
    /// -pi gamma omega sqrt(2/b) sech(pi omega/(2 sqrt a)) sin(phase).
    pub fn forced(&self, phase: f64) -> f64 {
        let sech = (PI * self.omega / (2.0 * self.a.sqrt())).cosh().recip();
        -PI * self.gamma * self.omega * (2.0 / self.b).sqrt() * sech * phase.sin()
    }
    /// int f(sech z tanh z) dz over the line; f(0) = 0. The trapezoidal rule, which converges
    /// exponentially where f is entire.
    pub fn over_loop(f: impl Fn(f64) -> f64) -> f64 {
        let step = 1.0 / 64.0;
        let at = |n: i32| {
            let z = f64::from(n) * step;
            f(z.tanh() / z.cosh())
        };
        (-3200..=3200).map(at).sum::<f64>() * step
    }
    /// (25) with sin t0 or sin(omega t0), the integral beside T0, and whether the brace closes after the
    /// other terms; without the term that it lacks.
    pub fn form_25(&self, phase: f64, dry: f64, brace_over_all: bool) -> f64 {
        let slope = self.alpha - 3.0 * self.beta * self.v * self.v;
        let root = self.a.sqrt();
        // int sech^2 tanh^2 dz = 2/3; the odd powers vanish.
        let smooth = 2.0 * slope * self.a * self.a / self.b * (2.0 / 3.0) / root;
        let scale = self.dry * self.a * (2.0 / self.b).sqrt();
        let smooth = if brace_over_all { -scale * smooth } else { smooth };
        self.forced(phase) - scale * dry / root + smooth
    }
    /// What (25) lacks: -4 beta (a^4/b^2) int sech^4 tanh^4.
    pub fn quartic(&self) -> f64 {
        -16.0 / 35.0 * self.beta * self.a.powi(4) / (self.a.sqrt() * self.b * self.b)
    }
    /// The term linear in v of -v (-alpha (v - v*) + beta (v - v*)^3), at the scale of v0.
    pub fn linear_in_v(&self) -> f64 {
        let smooth = |v: f64| {
            let w = v - self.v;
            -v * (w * w * w * self.beta - w * self.alpha)
        };
        let h = 1e-3;
        // The difference that is exact for degree 4.
        let d = |h: f64| (smooth(h) - smooth(-h)) / (2.0 * h);
        self.a * (2.0 / self.b).sqrt() * (4.0 * d(h) - d(2.0 * h)) / 3.0
    }
    /// (26) with the given cubic and linear coefficients and bracket.
    pub fn form_26(&self, cubic: f64, linear: f64, bracket: f64) -> f64 {
        let slope = self.alpha - 3.0 * self.beta * self.v * self.v;
        self.forced(self.omega * self.t0) - 16.0 / 35.0 * self.beta * cubic
            + 4.0 / 3.0 * slope * linear
            - 2.0 * self.dry * (2.0 * self.a / self.b).sqrt() * bracket
    }
    /// The right side of (27) with the factor of T0 [...] given.
    pub fn form_27(&self, dry_factor: f64) -> f64 {
        self.smooth_27() + dry_factor * self.dry * self.bracket()
    }
    /// Its first two terms.
    pub fn smooth_27(&self) -> f64 {
        let slope = self.alpha - 3.0 * self.beta * self.v * self.v;
        let root = (2.0 * self.a * self.b).sqrt();
        16.0 / 35.0 * self.beta * self.a.powi(4) / (self.b * root)
            - 4.0 / 3.0 * slope * self.a * self.a / root
    }
}

/// M(t0) of (24) by quadrature in time, split where v0 = v*; the left loop, v0 = +a sqrt(2/b)
/// sech tanh, as printed. Independent of every closed form of this crate.
///
/// # Errors
/// Those of the quadrature.
pub(super) fn quadrature_of_24(p: &Point, with_quartic: bool) -> Result<f64, MelnikovError> {
    let bits = 60;
    let work = 2 * bits + 64;
    let root = p.a.sqrt();
    let speed = p.a * (2.0 / p.b).sqrt();
    // v0 = v* at s = sinh(sqrt(a) t): speed s/(1+s^2) = v*.
    let ratio = speed / (2.0 * p.v);
    let disc = (ratio * ratio - 1.0).max(0.0).sqrt();
    let far = 40.0 / root;
    let cuts = [-far, 0.0, (ratio - disc).asinh() / root, (ratio + disc).asinh() / root, far];
    let mut sum = Float::with_val(bits, 0);
    for pair in cuts.windows(2) {
        let [low, high] = [pair[0], pair[1]].map(|t| Float::with_val(work, t));
        let middle = 0.5 * (pair[0] + pair[1]);
        let v_middle = speed * (root * middle).tanh() / (root * middle).cosh();
        let sign = (v_middle - p.v).signum();
        let part = tanh_sinh(bits, &low, &high, |t| {
            let z = Float::with_val(work, t * root);
            let tanh = Float::with_val(work, z.tanh_ref());
            let v = Float::with_val(work, z.cosh_ref()).recip() * tanh * speed;
            let w = Float::with_val(work, &v - p.v);
            let cube = Float::with_val(work, w.square_ref()) * &w;
            let quartic = Float::with_val(work, v.square_ref()) * &v;
            let cube = if with_quartic { cube } else { cube - quartic };
            let friction = Float::with_val(work, sign * p.dry) - w * p.alpha + cube * p.beta;
            let phase = (Float::with_val(work, t + p.t0) * p.omega).cos() * p.gamma;
            Some(v * (phase - friction))
        })?;
        sum += part.value;
    }
    Ok(sum.to_f64())
}
