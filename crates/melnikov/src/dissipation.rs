//! D, the work of the friction force along the orbit: D_sigma = int v0 T(v0 - v*) dt.

use crate::crossing::level_crossings;
use crate::hyperbolic::HyperbolicRing;
use crate::quadrature::{Estimate, tanh_sinh};
use crate::{
    Branch, Damping, Factor, Friction, MelnikovError, OrbitDescription, PolynomialFriction,
    Potential,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::float::Constant;
use rug::{Float, Integer, Rational};

/// D for dry and polynomial friction, in balls:
///
/// D_sigma = T0 S(sigma v*) + sum_k t_k sum_j C(k,j) (-v*)^(k-j) sigma^(j+1) m_{j+1}
///
/// with S the sign integral and m_n = int v0^n dt. On a homoclinic loop m_n = 0 for odd n and S is
/// even, so D is the same for both loops. Cost O(degree^2).
///
/// `None` where an enclosure tells nothing at this precision.
#[must_use]
pub fn polynomial_dissipation(
    balls: Balls,
    potential: &Potential,
    friction: &PolynomialFriction,
    branch: Branch,
    belt_speed: &Exact,
) -> Option<Ball> {
    let sigma = branch.sign();
    let mirrored = if sigma < 0 { -belt_speed } else { belt_speed.clone() };
    let dry = friction.dry.ball(balls);
    let mut sum = if friction.dry.sign().is_eq() {
        balls.zero()
    } else {
        balls.mul(&dry, &potential.sign_integral(balls, &mirrored)?)
    };
    let degree = u32::try_from(friction.coefficients.len()).ok()?;
    let mut moments = Vec::new();
    for n in 1..=degree {
        let zero = potential.is_homoclinic() && n % 2 == 1;
        moments.push(if zero { balls.zero() } else { potential.moment(balls, &Factor::ONE, n)? });
    }
    let minus = balls.neg(&belt_speed.ball(balls));
    for (k, t) in friction.coefficients.iter().enumerate() {
        if t.sign().is_eq() {
            continue;
        }
        let mut inner = balls.zero();
        for (j, moment) in moments.iter().take(k + 1).enumerate() {
            if potential.is_homoclinic() && j % 2 == 0 {
                continue;
            }
            let binomial = Integer::from(k).binomial(u32::try_from(j).ok()?);
            let power = balls.powi(&minus, i64::try_from(k - j).ok()?)?;
            let mut term =
                balls.mul_rational(&balls.mul(&power, moment), &Rational::from(binomial));
            if sigma < 0 && j % 2 == 0 {
                term = balls.neg(&term);
            }
            inner = balls.add(&inner, &term);
        }
        sum = balls.add(&sum, &balls.mul(&t.ball(balls), &inner));
    }
    Some(sum)
}

/// The work of the terms c g(x) x'^j: sum c p int g(x0) v0^(j+1) dt, p = 1 on the positive branch, on the
/// other the sign that g(x) v^(j+1) takes when x and v change theirs.
///
/// `None` where a moment is not known ([`Potential::takes_damping`]).
#[must_use]
pub fn damping_work(
    balls: Balls,
    potential: &Potential,
    terms: &[Damping],
    branch: Branch,
) -> Option<Ball> {
    let mut sum = balls.zero();
    for term in terms {
        let n = term.velocity.checked_add(1)?;
        let moment = potential.moment(balls, &term.factor, n)?;
        let work = balls.mul(&term.coefficient.ball(balls), &moment);
        let even = (term.factor.parity() > 0) == n.is_multiple_of(2);
        let turned = branch.sign() < 0 && !even;
        sum = if turned { balls.sub(&sum, &work) } else { balls.add(&sum, &work) };
    }
    Some(sum)
}

/// A finite chart of the orbit: u in [u0, u1] with v0(u), dx/du >= 0, v0 rising from 0 to V at
/// `peak` and falling back.
struct Chart {
    ends: (Float, Float),
    peak: Float,
    speed: Box<dyn Fn(&Float) -> Float>,
    slope: Box<dyn Fn(&Float) -> Float>,
}

/// Double well: x = X sin u, v = V sin 2u. Pendulum: u = x/2, v = V cos u. Kink: x = X u,
/// v = V (1 - u^2). Helmholtz: x = X (1 - u^2), v = 2 X kappa u (1 - u^2). phi^6: u = x.
fn chart(potential: &Potential, bits: u32) -> Option<Chart> {
    let balls = Balls::new(bits);
    let middle = |b: Ball| b.midpoint().clone();
    let amplitude = middle(potential.amplitude(balls)?);
    let scale = middle(potential.velocity_scale(balls)?);
    let top = middle(potential.largest_speed(balls)?);
    let number = move |q: f64| Float::with_val(bits, q);
    let pi = Float::with_val(bits, Constant::Pi);
    let one_minus_square = move |u: &Float| 1u32 - Float::with_val(bits, u.square_ref());
    let third = Float::with_val(bits, 3u32).sqrt().recip();
    Some(match potential {
        // In time, by its own cuts.
        Potential::Described { .. } => return None,
        Potential::DoubleWell { .. } => Chart {
            ends: (number(0.0), Float::with_val(bits, &pi / 2u32)),
            peak: Float::with_val(bits, &pi / 4u32),
            speed: Box::new(move |u| Float::with_val(bits, u * 2u32).sin() * &top),
            slope: Box::new(move |u| Float::with_val(bits, u.cos_ref()) * &amplitude),
        },
        Potential::Pendulum { .. } => Chart {
            ends: (Float::with_val(bits, &pi / -2i32), Float::with_val(bits, &pi / 2u32)),
            peak: number(0.0),
            speed: Box::new(move |u| Float::with_val(bits, u.cos_ref()) * &top),
            slope: Box::new(move |_| number(2.0)),
        },
        Potential::SoftDuffing { .. } => Chart {
            ends: (number(-1.0), number(1.0)),
            peak: number(0.0),
            speed: Box::new(move |u| one_minus_square(u) * &top),
            slope: Box::new(move |_| amplitude.clone()),
        },
        Potential::Helmholtz { .. } => Chart {
            ends: (number(0.0), number(1.0)),
            peak: third,
            speed: Box::new(move |u| one_minus_square(u) * u * 2u32 * &scale),
            slope: Box::new(move |u| Float::with_val(bits, u * &amplitude) * 2u32),
        },
        Potential::PhiSix { .. } => Chart {
            ends: (number(0.0), number(1.0)),
            peak: third,
            speed: Box::new(move |u| one_minus_square(u) * u * &scale),
            slope: Box::new(move |_| number(1.0)),
        },
    })
}

/// D for any friction law by the finite integral below, split where the sliding speed
/// passes a kink of the law; the error is estimated (tanh-sinh), not proved.
///
/// Homoclinic: D = int (T(v - v*) - T(-v - v*)) dx over one half of the loop; heteroclinic:
/// D_sigma = sigma int T(sigma v - v*) dx.
///
/// # Errors
/// [`MelnikovError::Undecided`] where the quadrature does not converge to `bits` bits,
/// [`MelnikovError::UndefinedFriction`] where T is not finite.
pub fn quadrature_dissipation(
    bits: u32,
    potential: &Potential,
    friction: &Friction,
    branch: Branch,
    belt_speed: &Exact,
) -> Result<Estimate, MelnikovError> {
    let undecided = MelnikovError::Undecided { bits };
    if let Potential::Described { orbit, .. } = potential {
        return in_time(bits, potential, orbit, friction, branch, belt_speed);
    }
    let work = bits.saturating_mul(2).saturating_add(64);
    let chart = chart(potential, work).ok_or(undecided)?;
    let law = friction.law(work);
    let belt = belt_speed.ball(Balls::new(work)).midpoint().clone();
    let signs: &[i64] = if potential.is_homoclinic() { &[1, -1] } else { &[branch.sign()] };
    let mut cuts = vec![chart.ends.0.clone(), chart.ends.1.clone(), chart.peak.clone()];
    for kink in friction.kinks() {
        for sign in signs {
            // sign v - v* = kink.
            let speed = Float::with_val(work, &belt + kink) * *sign;
            cuts.extend(crossing(&chart, &chart.ends.0, &speed, work));
            cuts.extend(crossing(&chart, &chart.ends.1, &speed, work));
        }
    }
    let integrand = |u: &Float| {
        let speed = (chart.speed)(u);
        let mut sum = Float::new(work);
        for sign in signs {
            let sliding = Float::with_val(work, &speed * *sign) - &belt;
            sum += law(&sliding) * *sign;
        }
        Some(sum * (chart.slope)(u))
    };
    in_pieces(bits, &mut cuts, integrand)
}

/// D = int v0 T(v0 - v*) dt in the scaled time z for a described orbit: cut where sigma v0 - v*
/// passes a kink, and at |z| where v0 falls below 2^-bits.
fn in_time(
    bits: u32,
    potential: &Potential,
    orbit: &OrbitDescription,
    friction: &Friction,
    branch: Branch,
    belt_speed: &Exact,
) -> Result<Estimate, MelnikovError> {
    let undecided = || MelnikovError::Undecided { bits };
    let work = bits.saturating_mul(2).saturating_add(64);
    let balls = Balls::new(work);
    let law = friction.law(work);
    let shape = HyperbolicRing.derivative(&orbit.shape);
    let scale = potential.velocity_scale(balls).ok_or_else(undecided)?;
    let amplitude = potential.amplitude(balls).ok_or_else(undecided)?;
    let belt = belt_speed.ball(balls);
    let far = f64::from(bits) * std::f64::consts::LN_2 + 8.0;
    let mut cuts = vec![Float::with_val(work, -far), Float::with_val(work, far), Float::new(work)];
    for kink in friction.kinks() {
        let kink = balls.from_f64(kink).ok_or(MelnikovError::NotFinite { name: "kink" })?;
        let speed = balls.mul_i64(&balls.add(&belt, &kink), branch.sign());
        let level = balls.div(&speed, &scale).ok_or_else(undecided)?;
        let crossings = level_crossings(balls, &shape, &level).ok_or_else(undecided)?;
        cuts.extend(crossings.iter().map(|z| z.midpoint().clone()));
    }
    let sigma = branch.sign();
    let integrand = |z: &Float| {
        let z = balls.from_parts(z, &Float::new(53));
        let shape = shape.evaluate(balls, &z)?.midpoint().clone() * sigma;
        let sliding = Float::with_val(work, &shape * scale.midpoint()) - belt.midpoint();
        Some(law(&sliding) * shape * amplitude.midpoint())
    };
    in_pieces(bits, &mut cuts, integrand)
}

/// The integral between the outermost of the cuts, piece by piece.
fn in_pieces(
    bits: u32,
    cuts: &mut [Float],
    integrand: impl Fn(&Float) -> Option<Float> + Copy,
) -> Result<Estimate, MelnikovError> {
    cuts.sort_by(Float::total_cmp);
    let mut total = Estimate::zero(bits);
    for pair in cuts.windows(2) {
        if let [a, b] = pair
            && a < b
        {
            let part = tanh_sinh(bits, a, b, integrand)?;
            total.value += part.value;
            total.error += part.error;
        }
    }
    Ok(total)
}

/// The u between `end` and the peak with v(u) = speed, by bisection (v is monotone there).
fn crossing(chart: &Chart, end: &Float, speed: &Float, bits: u32) -> Option<Float> {
    let (mut slow, mut fast) = (end.clone(), chart.peak.clone());
    if *speed <= 0 || (chart.speed)(&fast) <= *speed {
        return None;
    }
    for _ in 0..bits {
        let middle = Float::with_val(bits, &slow + &fast) / 2u32;
        if (chart.speed)(&middle) < *speed {
            slow = middle;
        } else {
            fast = middle;
        }
    }
    Some(fast)
}
