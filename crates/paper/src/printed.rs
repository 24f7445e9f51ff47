//! The printed formulas (22)-(27) of section 3 against what is derived here.
//!
//! Every line evaluates a form *as printed* at a point where its misprint shows, beside the same
//! quantity by differentiation or quadrature. The verdict follows from the two numbers.

use crate::Findings;
use lindstedt_melnikov::quadrature::tanh_sinh;
use lindstedt_melnikov::{Branch, MelnikovError, StickSlip};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use rug::{Float, Rational};
use std::f64::consts::PI;

/// One printed formula with its value where a misprint shows.
#[derive(Clone, Debug)]
pub struct PrintedForm {
    /// The equation, like `(26)`.
    pub equation: &'static str,
    /// The form as printed.
    pub printed: &'static str,
    /// Its value at the point; `None` where the printed form has none (a root of a negative
    /// number).
    pub printed_value: Option<f64>,
    /// The derived value there, to f64.
    pub derived_value: f64,
    /// What the comparison found; the correction is the form with one change of the pen.
    pub findings: Findings,
    /// The correct form, or the effect.
    pub correct: &'static str,
}

/// The discriminating point: no two parameters coincide and a != 1.
#[derive(Clone, Copy)]
struct Point {
    a: f64,
    b: f64,
    dry: f64,
    alpha: f64,
    beta: f64,
    v: f64,
    gamma: f64,
    omega: f64,
    t0: f64,
}

const POINT: Point = Point {
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
pub(super) const COMPARED_AT: &str = "$a = 1.7$, $b = 2.3$, $T0 = 0.4$, $alpha = 0.35$, $beta = 0.25$, $v* = 0.5$, $gamma = 0.8$, \
                               $omega = 1.4$, $t0 = 0.6$";

/// A decimal of at most 6 places as the rational number it stands for.
fn exact(x: f64) -> Exact {
    Exact::Rational(Rational::from(((x * 1e6).round() as i64, 1_000_000)))
}

impl Point {
    fn stick_slip(&self) -> StickSlip {
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
    fn displacement(&self, t: f64) -> f64 {
        (2.0 * self.a / self.b).sqrt() / (self.a.sqrt() * t).cosh()
    }
    /// dx0/dt by a symmetric difference of sixth order.
    fn slope(&self, t: f64) -> f64 {
        let d = |h: f64| (self.displacement(t + h) - self.displacement(t - h)) / (2.0 * h);
        1.5 * d(1e-2) - 0.6 * d(2e-2) + 0.1 * d(3e-2)
    }
    /// The bracket of (26) as meant: sqrt(1/2 + q) - sqrt(1/2 - q), q = sqrt(1/4 - b v^2/(2a^2)).
    fn bracket(&self) -> f64 {
        let q = (0.25 - self.b * self.v * self.v / (2.0 * self.a * self.a)).sqrt();
        (0.5 + q).sqrt() - (0.5 - q).sqrt()
    }
    /// -pi gamma omega sqrt(2/b) sech(pi omega/(2 sqrt a)) sin(phase).
    fn forced(&self, phase: f64) -> f64 {
        let sech = (PI * self.omega / (2.0 * self.a.sqrt())).cosh().recip();
        -PI * self.gamma * self.omega * (2.0 / self.b).sqrt() * sech * phase.sin()
    }
    /// int f(sech z tanh z) dz over the line; f(0) = 0. The trapezoidal rule, which converges
    /// exponentially where f is entire.
    fn over_loop(f: impl Fn(f64) -> f64) -> f64 {
        let step = 1.0 / 64.0;
        let at = |n: i32| {
            let z = f64::from(n) * step;
            f(z.tanh() / z.cosh())
        };
        (-3200..=3200).map(at).sum::<f64>() * step
    }
    /// (25) with sin t0 or sin(omega t0), the integral beside T0, and whether the brace closes after the
    /// other terms; without the term that it lacks.
    fn form_25(&self, phase: f64, dry: f64, brace_over_all: bool) -> f64 {
        let slope = self.alpha - 3.0 * self.beta * self.v * self.v;
        let root = self.a.sqrt();
        // int sech^2 tanh^2 dz = 2/3; the odd powers vanish.
        let smooth = 2.0 * slope * self.a * self.a / self.b * (2.0 / 3.0) / root;
        let scale = self.dry * self.a * (2.0 / self.b).sqrt();
        let smooth = if brace_over_all { -scale * smooth } else { smooth };
        self.forced(phase) - scale * dry / root + smooth
    }
    /// What (25) lacks: -4 beta (a^4/b^2) int sech^4 tanh^4.
    fn quartic(&self) -> f64 {
        -16.0 / 35.0 * self.beta * self.a.powi(4) / (self.a.sqrt() * self.b * self.b)
    }
    /// (26) with the given cubic and linear coefficients and bracket.
    fn form_26(&self, cubic: f64, linear: f64, bracket: f64) -> f64 {
        let slope = self.alpha - 3.0 * self.beta * self.v * self.v;
        self.forced(self.omega * self.t0) - 16.0 / 35.0 * self.beta * cubic
            + 4.0 / 3.0 * slope * linear
            - 2.0 * self.dry * (2.0 * self.a / self.b).sqrt() * bracket
    }
    /// The right side of (27) with the factor of T0 [...] given.
    fn form_27(&self, dry_factor: f64) -> f64 {
        self.smooth_27() + dry_factor * self.dry * self.bracket()
    }
    /// Its first two terms.
    fn smooth_27(&self) -> f64 {
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
fn quadrature_of_24(p: &Point, with_quartic: bool) -> Result<f64, MelnikovError> {
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

fn compare(
    equation: &'static str,
    printed: &'static str,
    printed_value: Option<f64>,
    derived_value: f64,
    correct: &'static str,
) -> PrintedForm {
    let holds = printed_value.is_some_and(|value| same(value, derived_value));
    PrintedForm {
        equation,
        printed,
        printed_value: printed_value.filter(|value| value.is_finite()),
        derived_value,
        findings: Findings::holds(holds),
        correct,
    }
}

/// Equal to nine digits.
fn same(value: f64, derived: f64) -> bool {
    value.is_finite() && (value - derived).abs() <= 1e-9 * derived.abs().max(1e-3)
}

impl PrintedForm {
    /// The form with one typographical change has this value: where it is the derived one, what
    /// was wrong is a misprint.
    fn repaired_by(mut self, value: f64) -> Self {
        let repaired = !self.findings.holds && same(value, self.derived_value);
        self.findings.correction = repaired.then(|| self.correct.to_owned());
        self
    }
}

/// All forms of (22) to (27), in the order of the paper.
///
/// ```
/// use lindstedt_paper::{Verdict, printed_forms};
/// let list = printed_forms()?;
/// let of_27: Vec<_> = list.iter().filter(|form| form.equation == "(27)").collect();
/// assert_eq!(of_27[0].findings.verdict(), Verdict::Misprint);
/// # Ok::<(), lindstedt::unstable::melnikov::MelnikovError>(())
/// ```
///
/// # Errors
/// [`MelnikovError::Undecided`] where a reference value is not reached (never at the fixed point).
pub fn printed_forms() -> Result<Vec<PrintedForm>, MelnikovError> {
    let p = &POINT;
    let balls = Balls::new(120);
    let undecided = || MelnikovError::Undecided { bits: 120 };
    let f64_of = |ball: Option<lindstedt_number::ball::Ball>| {
        ball.map(|ball| ball.midpoint().to_f64()).ok_or_else(undecided)
    };
    let t = 0.7;
    let (root, speed) = (p.a.sqrt(), p.a * (2.0 / p.b).sqrt());
    let first_integral = |t: f64| {
        let x = p.displacement(t);
        x * (p.a - p.b * x * x / 2.0).sqrt()
    };
    let mut list = vec![
        compare(
            "(22)",
            "$dx/dt = x sqrt(a - b x^2/2)$ at $t = -0.7$",
            Some(first_integral(-t)),
            p.slope(-t),
            "as printed for $t < 0$",
        ),
        compare(
            "(22)",
            "$dx/dt = x sqrt(a - b x^2/2)$ at $t = 0.7$",
            Some(first_integral(t)),
            p.slope(t),
            "$-x sqrt(a - b x^2/2)$ for $t > 0$",
        )
        .repaired_by(-first_integral(t)),
        compare(
            "(23)",
            "$v0 = a sqrt(2/b) sech(sqrt a) tanh(sqrt a t)$",
            Some(speed / root.cosh() * (root * t).tanh()),
            p.slope(t),
            "$v0 = -+ a sqrt(2/b) sech(sqrt(a) t) tanh(sqrt(a) t)$, upper sign for $x > 0$",
        )
        .repaired_by(-speed / (root * t).cosh() * (root * t).tanh()),
    ];
    let (m, _) = p.stick_slip().system()?.melnikov(
        balls,
        Branch::Negative,
        &exact(p.gamma),
        &exact(p.t0),
    )?;
    let m = m.midpoint().to_f64();
    let by_quadrature = quadrature_of_24(p, true)?;
    let without_quartic = quadrature_of_24(p, false)?;
    let sin_t0 = by_quadrature - p.forced(p.omega * p.t0) + p.forced(p.t0);
    let (a, b, phase) = (p.a, p.b, p.omega * p.t0);
    let sine_of_loop = Point::over_loop(|s| s * (s - p.v).sin());
    // (26) has it in closed form: 2 sqrt(2a/b) [...] = a sqrt(2/b)/sqrt(a) int s sign(...) dz.
    let sign_of_loop = 2.0 * p.bracket();
    // The term linear in v of -v (-alpha (v - v*) + beta (v - v*)^3), at the scale of v0.
    let linear_in_v = {
        let smooth = |v: f64| {
            let w = v - p.v;
            -v * (w * w * w * p.beta - w * p.alpha)
        };
        let h = 1e-3;
        // The difference that is exact for degree 4.
        let d = |h: f64| (smooth(h) - smooth(-h)) / (2.0 * h);
        speed * (4.0 * d(h) - d(2.0 * h)) / 3.0
    };
    let cubic = a.powi(4) / (root * b * b);
    let linear = a * a / (root * b);
    let bracket = p.bracket();
    let printed_cubic = a.powi(4) / (a * b * b).sqrt();
    let printed_linear = a * a / (a * b).sqrt();
    let inner = (0.25 - b * p.v * p.v / (2.0 * a * a)).sqrt();
    let second_radical = (0.5f64 + inner).sqrt() - (0.5 - 0.5f64.sqrt() - inner).sqrt();
    list.extend([
        compare(
            "(24)",
            "$M(t0) = int {gamma v0(t - t0) cos(omega t) - v0(t - t0) [T0 sign(v0(t - t0) - v*) - alpha (v0(t - \
             t0) - v*) + beta (v0(t - t0) - v*)^3]} dt$",
            Some(by_quadrature),
            m,
            "with $v0 = +a sqrt(2/b) sech tanh$ as (23) prints it, which is the left loop",
        ),
        compare("(25)", "$gamma sin t0 ...$", Some(sin_t0), m, "$gamma sin(omega t0)$")
            .repaired_by(sin_t0 - p.forced(p.t0) + p.forced(p.omega * p.t0)),
        compare(
            "(25)",
            "$... sin(sech tanh - v*) ...$",
            Some(p.form_25(phase, sine_of_loop, false) + p.quartic()),
            m,
            "$sign(a sqrt(2/b) sech tanh - v*)$",
        )
        .repaired_by(p.form_25(phase, sign_of_loop, false) + p.quartic()),
        compare(
            "(25)",
            "the brace after $T0 a sqrt(2/b)$ closes behind all terms",
            Some(p.form_25(phase, sign_of_loop, true) + p.quartic()),
            m,
            "it closes behind the integral of the sign",
        )
        .repaired_by(p.form_25(phase, sign_of_loop, false) + p.quartic()),
        compare(
            "(25)",
            "no term $beta int sech^4 tanh^4$",
            Some(without_quartic),
            m,
            "add $-4 beta (a^4/b^2) int sech^4 tanh^4$",
        )
        .repaired_by(without_quartic + p.quartic()),
        compare(
            "(25)",
            "$+ (alpha - beta v*^2) v* a sqrt(2/b)$, the factor of $int sech tanh$",
            Some(-linear_in_v),
            linear_in_v,
            "- in the place of +; without effect, since the integral is 0",
        )
        .repaired_by(-(p.alpha - p.beta * p.v * p.v) * p.v * speed),
        compare(
            "(25)",
            "all of it as printed",
            Some(p.form_25(p.t0, sine_of_loop, true)),
            m,
            "the changes above together",
        )
        .repaired_by(p.form_25(phase, sign_of_loop, false) + p.quartic()),
        compare(
            "(26)",
            "$16/35 beta a^4/sqrt(a b^2)$",
            Some(p.form_26(printed_cubic, linear, bracket)),
            m,
            "$16/35 beta a^4/(sqrt(a) b^2)$",
        )
        .repaired_by(p.form_26(cubic, linear, bracket)),
        compare(
            "(26)",
            "$4/3 (alpha - 3 beta v*^2) a^2/sqrt(a b)$",
            Some(p.form_26(cubic, printed_linear, bracket)),
            m,
            "$... a^2/(sqrt(a) b)$",
        )
        .repaired_by(p.form_26(cubic, linear, bracket)),
        compare(
            "(26)",
            "second root $sqrt(1/2 - sqrt(1/2) - sqrt(1/4 - ...))$",
            Some(p.form_26(cubic, linear, second_radical)),
            m,
            "$sqrt(1/2 - sqrt(1/4 - b v*^2/(2a^2)))$; the text read here comes from a scan, whose reading may \
             have lost the grouping of the roots",
        )
        .repaired_by(p.form_26(cubic, linear, bracket)),
        compare(
            "(26)",
            "all of it as printed",
            Some(p.form_26(printed_cubic, printed_linear, second_radical)),
            m,
            "the changes above together; then $sqrt(1/2+q) - sqrt(1/2-q) = sqrt(1 - |v*|/V)$",
        )
        .repaired_by(p.form_26(cubic, linear, bracket)),
    ]);
    // To 6 places, as `exact` takes it.
    let fast = Point { v: (-1.3e6 * a / (2.0 * b).sqrt()).round() / 1e6, ..POINT };
    let (m_fast, _) = fast.stick_slip().system()?.melnikov(
        balls,
        Branch::Negative,
        &exact(p.gamma),
        &exact(p.t0),
    )?;
    list.push(
        compare(
            "(26)",
            "first branch for all $v* < a/sqrt(2b)$, at $v* = -1.030418$ ($V = 0.792629$)",
            Some(fast.form_26(cubic, linear, fast.bracket())),
            m_fast.midpoint().to_f64(),
            "for $|v*| < a/sqrt(2b)$",
        )
        .repaired_by(fast.form_26(cubic, linear, 0.0)),
    );
    // (27) multiplied by sqrt(2/b) must be D.
    let g = f64_of(p.stick_slip().g(balls))? * p.a.sqrt();
    list.push(
        compare(
            "(27)",
            "$... + 2 T0 a [...]$",
            Some(p.form_27(2.0 * a)),
            g,
            "$2 T0 sqrt(a) [...]$; with it the right side is $D sqrt(b/2)$",
        )
        .repaired_by(p.form_27(2.0 * root)),
    );
    let g_fast = f64_of(fast.stick_slip().g(balls))? * p.a.sqrt();
    list.push(
        compare(
            "(27)",
            "first branch for all $v* < a/sqrt(2b)$, at $v* = -1.030418$ ($V = 0.792629$)",
            Some(fast.form_27(2.0 * root)),
            g_fast,
            "for $|v*| < a/sqrt(2b)$",
        )
        .repaired_by(fast.smooth_27()),
    );
    let five = |v: f64| StickSlip { b: Exact::from(5), belt_speed: exact(v), ..StickSlip::paper() };
    // As printed, a negative right side lets every gamma > 0 pass: a threshold of 0.
    let gained = f64_of(five(0.45).signed_threshold(balls))?.abs();
    list.push(compare(
        "(27)",
        "... > ..., without a modulus on the right: at $b = 5$, $v* = 0.45$ every $gamma > 0$ passes",
        Some(0.0),
        gained,
        "$gamma F > |D|$",
    ));
    Ok(list)
}
