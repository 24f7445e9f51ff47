//! Quadrature: a certified trapezoidal rule on the line, and an estimated tanh-sinh rule.

use crate::MelnikovError;
use lindstedt_number::ball::{Ball, Balls};
use rug::float::Constant;
use rug::{Float, Rational};

/// What is known of an integrand f that is analytic in the strip |Im z| <= c.
#[derive(Clone, Debug)]
pub struct Strip {
    /// c > 0.
    pub half_width: Rational,
    /// A bound of the integral of |f(x + iy)| over the line, for |y| <= c.
    pub edge_integral: Ball,
    /// r > 0 in |f(x)| <= A e^{-r|x|} on the real line.
    pub decay: Rational,
    /// A in |f(x)| <= A e^{-r|x|}.
    pub amplitude: Ball,
}

/// The most nodes of one trapezoidal sum.
const MOST_NODES: f64 = 2e6;

/// The integral of f over the line with a proved error bound; `None` where f is undefined at a
/// node, a bound is not finite, or more than two million nodes would be needed.
///
/// |h sum_k f(kh) - int f| <= 2 N / (e^{2 pi c/h} - 1) (Trefethen and Weideman, SIAM Review 56
/// (2014) 385, theorem 5.1), and the nodes beyond nh contribute at most 2 A e^{-rnh}/r. Both are
/// below 2^-p by the choice of h and n, and are added to the radius. Cost O(p^2/(c r)) evaluations.
pub fn trapezoid(
    balls: Balls,
    strip: &Strip,
    f: impl Fn(Balls, &Ball) -> Option<Ball>,
) -> Option<Ball> {
    let (width, decay) = (strip.half_width.to_f64(), strip.decay.to_f64());
    let log = |b: &Ball| {
        let bound = b.abs_upper();
        if bound.is_zero() { 0.0 } else { f64::from(bound.get_exp().unwrap_or(0)) }
    };
    let nats =
        |b: &Ball| (f64::from(balls.bits()) + 4.0 + log(b).max(0.0)) * std::f64::consts::LN_2;
    let h = 2.0 * std::f64::consts::PI * width / nats(&strip.edge_integral);
    let count = (nats(&strip.amplitude) / (decay * h)).ceil() + 1.0;
    if !(h > 0.0 && count.is_finite() && count < MOST_NODES) {
        return None;
    }
    let step = balls.from_f64(h)?;
    let mut sum = f(balls, &balls.zero())?;
    let nodes = count as i64;
    for k in 1..=nodes {
        let z = balls.mul_i64(&step, k);
        sum = balls.add(&sum, &f(balls, &z)?);
        sum = balls.add(&sum, &f(balls, &balls.neg(&z))?);
    }
    let value = balls.mul(&sum, &step);
    let exponent = balls.mul_rational(&balls.pi(), &Rational::from(&strip.half_width * 2u32));
    let growth = balls.exp(&balls.div(&exponent, &step)?);
    let edge = balls.mul_i64(&strip.edge_integral, 2);
    let discretisation = balls.div(&edge, &balls.sub(&growth, &balls.one()))?;
    let reach = balls.mul_rational(&balls.mul_i64(&step, nodes), &strip.decay);
    let rest = balls.mul(&strip.amplitude, &balls.exp(&balls.neg(&reach)));
    let rest = balls.mul_rational(&rest, &(Rational::from(2) / &strip.decay));
    let value = balls.add_error(&value, &discretisation.abs_upper());
    Some(balls.add_error(&value, &rest.abs_upper()))
}

/// A value with an estimated error (the difference of the last two levels; no proof).
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The value.
    pub value: Float,
    /// The estimated error.
    pub error: Float,
}

impl Estimate {
    /// The exact 0.
    #[must_use]
    pub fn zero(bits: u32) -> Self {
        Self { value: Float::new(bits), error: Float::new(53) }
    }
}

/// The largest number of halvings of the step.
const LEVELS: u32 = 11;

/// The integral of f over (a, b) by the tanh-sinh rule to about `bits` bits, with an estimated
/// error.
///
/// Integrable singularities at the ends are harmless: the nodes are formed with twice the bits,
/// so that their distance to an end keeps `bits` of them. Kinks inside must be end points.
/// Cost about 2^level 8 evaluations; the level doubles the digits.
///
/// # Errors
/// [`MelnikovError::UndefinedFriction`] where f is not finite at a node,
/// [`MelnikovError::Undecided`] where 2^11 nodes per unit do not suffice.
pub fn tanh_sinh(
    bits: u32,
    a: &Float,
    b: &Float,
    f: impl Fn(&Float) -> Option<Float>,
) -> Result<Estimate, MelnikovError> {
    let work = bits.saturating_mul(2).saturating_add(64);
    let length = Float::with_val(work, b - a);
    if length.is_zero() {
        return Ok(Estimate::zero(bits));
    }
    let pi = Float::with_val(work, Constant::Pi);
    // Beyond this the weight is below 2^-(1.5 bits) (a square root singularity included).
    let reach = (1.5 * f64::from(bits) * std::f64::consts::LN_2 / 1.5).asinh() + 0.5;
    let node = |t: f64| -> Option<Float> {
        let t = Float::with_val(work, t);
        let fraction = Float::with_val(work, &pi * Float::with_val(work, t.sinh_ref())).exp();
        // x = 1/(1 + e^{pi sinh t}) is the distance to the end a, 1 - x that to b.
        let near = Float::with_val(work, 1u32 + &fraction).recip();
        let weight = Float::with_val(work, near.clone() * &near * fraction);
        let weight = weight * &pi * Float::with_val(work, t.cosh_ref());
        let u = Float::with_val(work, a + Float::with_val(work, &length * &near));
        let value = f(&u).filter(Float::is_finite)?;
        Some(value * weight)
    };
    let term = |t: f64| node(t).ok_or(MelnikovError::UndefinedFriction);
    let mut sum = term(0.0)?;
    let mut last: Option<Float> = None;
    for level in 0..=LEVELS {
        let h = 0.5f64.powi(level as i32);
        let (first, stride) = if level == 0 { (1.0, 1.0) } else { (h, 2.0 * h) };
        let mut t = first;
        while t <= reach {
            sum += term(t)?;
            sum += term(-t)?;
            t += stride;
        }
        let value = Float::with_val(work, &sum * h) * &length;
        if let Some(before) = &last {
            let error = Float::with_val(53, &value - before).abs();
            let size = Float::with_val(53, value.abs_ref());
            if level > 3 && error <= size.max(&Float::with_val(53, length.abs_ref())) >> bits {
                return Ok(Estimate { value: Float::with_val(bits, value), error });
            }
        }
        last = Some(value);
    }
    Err(MelnikovError::Undecided { bits })
}
