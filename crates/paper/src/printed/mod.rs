//! The printed formulas (22)-(27) of section 3 against what is derived here.
//!
//! Every line evaluates a form *as printed* at a point where its misprint shows, beside the same
//! quantity by differentiation or quadrature. The verdict follows from the two numbers.

mod point;

pub(crate) use point::COMPARED_AT;

use crate::Findings;
use crate::oscillator::section_three;
use lindstedt_melnikov::{Branch, MelnikovError, StickSlip};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use point::{POINT, Point, exact, quadrature_of_24};

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

/// A line of the lists below: a form with what it is and what it should be.
struct Line {
    equation: &'static str,
    printed: &'static str,
    /// The value of the form as printed, and the derived one.
    values: [f64; 2],
    correct: &'static str,
    /// The value with one typographical change: where it is the derived one, what was wrong is a
    /// misprint.
    repaired: Option<f64>,
}

impl Line {
    fn judged(self) -> PrintedForm {
        let [printed_value, derived_value] = self.values;
        let holds = same(printed_value, derived_value);
        let repaired = !holds && self.repaired.is_some_and(|value| same(value, derived_value));
        let correction = repaired.then(|| self.correct.to_owned());
        PrintedForm {
            equation: self.equation,
            printed: self.printed,
            printed_value: Some(printed_value).filter(|value| value.is_finite()),
            derived_value,
            findings: Findings { correction, ..Findings::holds(holds) },
            correct: self.correct,
        }
    }
}

/// Equal to nine digits.
fn same(value: f64, derived: f64) -> bool {
    value.is_finite() && (value - derived).abs() <= 1e-9 * derived.abs().max(1e-3)
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
    let balls = Balls::new(BITS);
    // To 6 places, as `exact` takes it.
    let v = (-1.3e6 * POINT.a / (2.0 * POINT.b).sqrt()).round() / 1e6;
    let fast = Point { v, ..POINT };
    let mut lines: Vec<Line> = homoclinic_orbit(&POINT).into();
    let m = melnikov(&POINT, balls)?;
    let quadratures = [quadrature_of_24(&POINT, true)?, quadrature_of_24(&POINT, false)?];
    lines.push(integral(quadratures[0], m));
    lines.extend(expanded_integral(&POINT, m, quadratures));
    lines.extend(closed_form(&POINT, m, (&fast, melnikov(&fast, balls)?)));
    lines.extend(criterion(&POINT, &fast, balls)?);
    Ok(lines.into_iter().map(Line::judged).collect())
}

/// The precision of the derived values.
const BITS: u32 = 120;

fn f64_of(ball: Option<Ball>) -> Result<f64, MelnikovError> {
    let undecided = MelnikovError::Undecided { bits: BITS };
    ball.map(|ball| ball.midpoint().to_f64()).ok_or(undecided)
}

/// M(t0), derived.
fn melnikov(p: &Point, balls: Balls) -> Result<f64, MelnikovError> {
    let system = p.stick_slip().system()?;
    let (m, _) = system.melnikov(balls, Branch::Negative, &exact(p.gamma), &exact(p.t0))?;
    Ok(m.midpoint().to_f64())
}

/// (22) and (23), against the slope of the orbit.
fn homoclinic_orbit(p: &Point) -> [Line; 3] {
    let t = 0.7;
    let (root, speed) = (p.a.sqrt(), p.a * (2.0 / p.b).sqrt());
    let first_integral = |t: f64| {
        let x = p.displacement(t);
        x * (p.a - p.b * x * x / 2.0).sqrt()
    };
    [
        Line {
            equation: "(22)",
            printed: "$dx/dt = x sqrt(a - b x^2/2)$ at $t = -0.7$",
            values: [first_integral(-t), p.slope(-t)],
            correct: "as printed for $t < 0$",
            repaired: None,
        },
        Line {
            equation: "(22)",
            printed: "$dx/dt = x sqrt(a - b x^2/2)$ at $t = 0.7$",
            values: [first_integral(t), p.slope(t)],
            correct: "$-x sqrt(a - b x^2/2)$ for $t > 0$",
            repaired: Some(-first_integral(t)),
        },
        Line {
            equation: "(23)",
            printed: "$v0 = a sqrt(2/b) sech(sqrt a) tanh(sqrt a t)$",
            values: [speed / root.cosh() * (root * t).tanh(), p.slope(t)],
            correct: "$v0 = -+ a sqrt(2/b) sech(sqrt(a) t) tanh(sqrt(a) t)$, upper sign for $x > 0$",
            repaired: Some(-speed / (root * t).cosh() * (root * t).tanh()),
        },
    ]
}

/// (24) by quadrature, against the derived M(t0).
fn integral(by_quadrature: f64, m: f64) -> Line {
    Line {
        equation: "(24)",
        printed: "$M(t0) = int {gamma v0(t - t0) cos(omega t) - v0(t - t0) [T0 sign(v0(t - t0) - v*) - alpha (v0(t - \
         t0) - v*) + beta (v0(t - t0) - v*)^3]} dt$",
        values: [by_quadrature, m],
        correct: "with $v0 = +a sqrt(2/b) sech tanh$ as (23) prints it, which is the left loop",
        repaired: None,
    }
}

/// (25), against the derived M(t0); (24) by quadrature, whole and without its quartic.
fn expanded_integral(p: &Point, m: f64, [by_quadrature, without_quartic]: [f64; 2]) -> [Line; 6] {
    let phase = p.omega * p.t0;
    let sin_t0 = by_quadrature - p.forced(phase) + p.forced(p.t0);
    let sine_of_loop = Point::over_loop(|s| s * (s - p.v).sin());
    // (26) has it in closed form: 2 sqrt(2a/b) [...] = a sqrt(2/b)/sqrt(a) int s sign(...) dz.
    let sign_of_loop = 2.0 * p.bracket();
    let linear_in_v = p.linear_in_v();
    let right = p.form_25(phase, sign_of_loop, false) + p.quartic();
    let speed = p.a * (2.0 / p.b).sqrt();
    let of_25 = |printed, value: f64, correct, repaired: f64| Line {
        equation: "(25)",
        printed,
        values: [value, m],
        correct,
        repaired: Some(repaired),
    };
    [
        of_25(
            "$gamma sin t0 ...$",
            sin_t0,
            "$gamma sin(omega t0)$",
            sin_t0 - p.forced(p.t0) + p.forced(phase),
        ),
        of_25(
            "$... sin(sech tanh - v*) ...$",
            p.form_25(phase, sine_of_loop, false) + p.quartic(),
            "$sign(a sqrt(2/b) sech tanh - v*)$",
            right,
        ),
        of_25(
            "the brace after $T0 a sqrt(2/b)$ closes behind all terms",
            p.form_25(phase, sign_of_loop, true) + p.quartic(),
            "it closes behind the integral of the sign",
            right,
        ),
        of_25(
            "no term $beta int sech^4 tanh^4$",
            without_quartic,
            "add $-4 beta (a^4/b^2) int sech^4 tanh^4$",
            without_quartic + p.quartic(),
        ),
        Line {
            equation: "(25)",
            printed: "$+ (alpha - beta v*^2) v* a sqrt(2/b)$, the factor of $int sech tanh$",
            values: [-linear_in_v, linear_in_v],
            correct: "- in the place of +; without effect, since the integral is 0",
            repaired: Some(-(p.alpha - p.beta * p.v * p.v) * p.v * speed),
        },
        of_25(
            "all of it as printed",
            p.form_25(p.t0, sine_of_loop, true),
            "the changes above together",
            right,
        ),
    ]
}

/// (26), against the derived M(t0); its first branch at a faster belt, too.
fn closed_form(p: &Point, m: f64, (fast, m_fast): (&Point, f64)) -> [Line; 5] {
    let (a, b, root, bracket) = (p.a, p.b, p.a.sqrt(), p.bracket());
    let cubic = a.powi(4) / (root * b * b);
    let linear = a * a / (root * b);
    let printed_cubic = a.powi(4) / (a * b * b).sqrt();
    let printed_linear = a * a / (a * b).sqrt();
    let inner = (0.25 - b * p.v * p.v / (2.0 * a * a)).sqrt();
    let second_radical = (0.5f64 + inner).sqrt() - (0.5 - 0.5f64.sqrt() - inner).sqrt();
    let right = p.form_26(cubic, linear, bracket);
    let of_26 = |printed, value: f64, correct| Line {
        equation: "(26)",
        printed,
        values: [value, m],
        correct,
        repaired: Some(right),
    };
    [
        of_26(
            "$16/35 beta a^4/sqrt(a b^2)$",
            p.form_26(printed_cubic, linear, bracket),
            "$16/35 beta a^4/(sqrt(a) b^2)$",
        ),
        of_26(
            "$4/3 (alpha - 3 beta v*^2) a^2/sqrt(a b)$",
            p.form_26(cubic, printed_linear, bracket),
            "$... a^2/(sqrt(a) b)$",
        ),
        of_26(
            "second root $sqrt(1/2 - sqrt(1/2) - sqrt(1/4 - ...))$",
            p.form_26(cubic, linear, second_radical),
            "$sqrt(1/2 - sqrt(1/4 - b v*^2/(2a^2)))$; the text read here comes from a scan, whose reading may \
             have lost the grouping of the roots",
        ),
        of_26(
            "all of it as printed",
            p.form_26(printed_cubic, printed_linear, second_radical),
            "the changes above together; then $sqrt(1/2+q) - sqrt(1/2-q) = sqrt(1 - |v*|/V)$",
        ),
        Line {
            equation: "(26)",
            printed: FIRST_BRANCH,
            values: [fast.form_26(cubic, linear, fast.bracket()), m_fast],
            correct: "for $|v*| < a/sqrt(2b)$",
            repaired: Some(fast.form_26(cubic, linear, 0.0)),
        },
    ]
}

const FIRST_BRANCH: &str =
    "first branch for all $v* < a/sqrt(2b)$, at $v* = -1.030418$ ($V = 0.792629$)";

/// (27), whose right side multiplied by sqrt(2/b) must be D.
fn criterion(p: &Point, fast: &Point, balls: Balls) -> Result<[Line; 3], MelnikovError> {
    let root = p.a.sqrt();
    let right_side = |p: &Point| f64_of(p.stick_slip().g(balls)).map(|g| g * root);
    let at_five = StickSlip { b: Exact::from(5), belt_speed: exact(0.45), ..section_three() };
    Ok([
        Line {
            equation: "(27)",
            printed: "$... + 2 T0 a [...]$",
            values: [p.form_27(2.0 * p.a), right_side(p)?],
            correct: "$2 T0 sqrt(a) [...]$; with it the right side is $D sqrt(b/2)$",
            repaired: Some(p.form_27(2.0 * root)),
        },
        Line {
            equation: "(27)",
            printed: FIRST_BRANCH,
            values: [fast.form_27(2.0 * root), right_side(fast)?],
            correct: "for $|v*| < a/sqrt(2b)$",
            repaired: Some(fast.smooth_27()),
        },
        // As printed, a negative right side lets every gamma > 0 pass: a threshold of 0.
        Line {
            equation: "(27)",
            printed: "... > ..., without a modulus on the right: at $b = 5$, $v* = 0.45$ every $gamma > 0$ passes",
            values: [0.0, f64_of(at_five.signed_threshold(balls))?.abs()],
            correct: "$gamma F > |D|$",
            repaired: None,
        },
    ])
}
