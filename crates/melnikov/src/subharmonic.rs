//! Subharmonic Melnikov functions of the double well: periodic orbits in resonance with
//! cos(omega t), period 2 pi m/omega, inside one well or around both.

use crate::elliptic::Elliptic;
use crate::error::positive;
use crate::root::{enclose_root, sqrt_positive_part};
use crate::{MelnikovError, PolynomialFriction};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Integer, Rational};

/// Where the periodic orbit lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// In one well: x = +- sqrt(2a/(b(2-k^2))) dn(lam t), lam = sqrt(a/(2-k^2)), period 2K/lam.
    Inside,
    /// Around both: x = X cn(lam t), lam = sqrt(a/(2k^2-1)), X = sqrt(2ak^2/(b(2k^2-1))),
    /// period 4K/lam.
    Outside,
}

/// The resonant orbit and its Melnikov function M = +-gamma F_m sin(omega t0) - D_m.
#[derive(Clone, Debug)]
pub struct Subharmonic {
    /// The modulus k.
    pub modulus: Ball,
    /// k', carried instead of k.
    pub complement: Ball,
    /// D_m, the work of friction over one period of the orbit.
    pub dissipation: Ball,
    /// F_m > 0.
    pub forcing: Ball,
    /// R_m = |D_m|/F_m: the resonance exists for gamma > R_m; R_m -> gamma_c for m -> infinity.
    pub threshold: Ball,
}

/// The largest m.
const LARGEST_ORDER: u32 = 100_000;

/// The subharmonic of order m (one orbit period in m forcing periods; n = 1, the only one that a
/// single harmonic excites).
///
/// k' = e^{-L} is found by bisection in L of the monotone resonance condition, so the orbit is
/// enclosed. Cost about p elliptic integrals of p bits.
///
/// # Errors
/// [`MelnikovError::NotPositive`]; [`MelnikovError::NoResonance`] inside the well for
/// omega >= m sqrt(2a) (faster than small oscillations); [`MelnikovError::NoForcing`] outside for
/// even m; [`MelnikovError::Undecided`] at too low a precision.
#[allow(clippy::too_many_arguments, reason = "the parameters of the problem, each with its name")]
pub fn subharmonic(
    balls: Balls,
    a: &Exact,
    b: &Exact,
    omega: &Exact,
    friction: &PolynomialFriction,
    belt_speed: &Exact,
    region: Region,
    m: u32,
) -> Result<Subharmonic, MelnikovError> {
    positive(a, "a")?;
    positive(b, "b")?;
    positive(omega, "omega")?;
    friction.check()?;
    if m == 0 || m > LARGEST_ORDER {
        return Err(MelnikovError::NoResonance { m });
    }
    if region == Region::Outside && m.is_multiple_of(2) {
        return Err(MelnikovError::NoForcing);
    }
    let undecided = MelnikovError::Undecided { bits: balls.bits() };
    let (a, b, omega) = (a.ball(balls), b.ball(balls), omega.ball(balls));
    let level = resonance(balls, &a, &omega, region, m)?.ok_or(undecided.clone())?;
    let parts = Parts { balls, a, b, omega, region, complement: balls.exp(&balls.neg(&level)) };
    parts.melnikov(friction, belt_speed, m).ok_or(undecided)
}

/// L with k' = e^{-L}: K(k) sqrt(2-k^2) = pi m sqrt(a)/omega inside,
/// K(k) sqrt(2k^2-1) = pi m sqrt(a)/(2 omega) outside; both sides rise with L.
fn resonance(
    balls: Balls,
    a: &Ball,
    omega: &Ball,
    region: Region,
    m: u32,
) -> Result<Option<Ball>, MelnikovError> {
    let target = || {
        let root = balls.sqrt(a)?;
        let full =
            balls.div(&balls.mul(&balls.mul_i64(&balls.pi(), i64::from(m)), &root), omega)?;
        Some(if region == Region::Outside { balls.mul_power_of_two(&full, -1) } else { full })
    };
    let Some(target) = target() else {
        return Ok(None);
    };
    let period = |balls: Balls, level: &Ball| {
        let complement = balls.exp(&balls.neg(level));
        let k = Elliptic::new(balls, &complement)?.k;
        let square = balls.square(&complement);
        let factor = match region {
            Region::Inside => balls.add(&balls.one(), &square),
            Region::Outside => balls.sub(&balls.one(), &balls.mul_power_of_two(&square, 1)),
        };
        Some(balls.sub(&balls.mul(&k, &balls.sqrt(&factor)?), &target))
    };
    // L = 0 is the centre inside, L = ln 2/2 infinite energy outside; start a little above.
    let start = match region {
        Region::Inside => balls.zero(),
        Region::Outside => balls.mul_power_of_two(&balls.ln_2(), -1),
    };
    let step = Float::with_val(53, 1u32) >> (balls.bits() / 4);
    let low = Float::with_val(balls.bits(), start.midpoint() + &step);
    // K > L, and the factor is at least 1 inside, at least 1/2 for L > 1 outside.
    let high = Float::with_val(53, target.abs_upper() * 2u32) + 2u32;
    if region == Region::Inside {
        // The centre's period: K(0) sqrt 2 = pi/sqrt 2.
        let root = balls.sqrt(&balls.from_i64(2)).and_then(|root| balls.div(&balls.pi(), &root));
        if root.is_some_and(|centre| !balls.sub(&target, &centre).is_positive()) {
            return Err(MelnikovError::NoResonance { m });
        }
    }
    Ok(enclose_root(balls, &low, &high, period))
}

/// A periodic orbit of the double well.
pub(crate) struct Parts {
    pub(crate) balls: Balls,
    pub(crate) a: Ball,
    pub(crate) b: Ball,
    pub(crate) omega: Ball,
    pub(crate) region: Region,
    pub(crate) complement: Ball,
}

impl Parts {
    fn melnikov(&self, friction: &PolynomialFriction, belt: &Exact, m: u32) -> Option<Subharmonic> {
        let balls = self.balls;
        let elliptic = Elliptic::new(balls, &self.complement)?;
        let modulus = balls.sqrt(&elliptic.square)?;
        let other = Elliptic::new(balls, &modulus)?.k;
        // F_m = sqrt(2/b) pi omega sech(pi m K'/K), outside twice with K'/(2K).
        let ratio = balls.div(&other, &elliptic.k)?;
        let exponent = balls.mul_i64(&balls.mul(&balls.pi(), &ratio), i64::from(m));
        let root = balls.sqrt(&balls.div(&balls.from_i64(2), &self.b)?)?;
        let scale = balls.mul(&root, &balls.mul(&balls.pi(), &self.omega));
        let (scale, exponent) = match self.region {
            Region::Inside => (scale, exponent),
            Region::Outside => {
                (balls.mul_power_of_two(&scale, 1), balls.mul_power_of_two(&exponent, -1))
            }
        };
        let forcing = balls.div(&scale, &balls.cosh(&exponent))?;
        let dissipation = self.dissipation(&elliptic, friction, belt)?;
        let threshold = balls.abs(&balls.div(&dissipation, &forcing)?);
        Some(Subharmonic {
            modulus,
            complement: self.complement.clone(),
            dissipation,
            forcing,
            threshold,
        })
    }

    /// (2-k^2 or 2k^2-1, lam).
    pub(crate) fn scale(&self) -> Option<(Ball, Ball)> {
        let balls = self.balls;
        let square = balls.square(&self.complement);
        let factor = match self.region {
            Region::Inside => balls.add(&balls.one(), &square),
            Region::Outside => balls.sub(&balls.one(), &balls.mul_power_of_two(&square, 1)),
        };
        let rate = balls.sqrt(&balls.div(&self.a, &factor)?)?;
        Some((factor, rate))
    }

    /// D = T0 S(v*) + sum_k t_k sum_{j odd} C(k,j) (-v*)^(k-j) int v^(j+1) dt.
    fn dissipation(
        &self,
        elliptic: &Elliptic,
        friction: &PolynomialFriction,
        belt: &Exact,
    ) -> Option<Ball> {
        let balls = self.balls;
        let dry = balls.mul(&friction.dry.ball(balls), &self.sign_integral(elliptic, belt)?);
        let moment = |n| self.moment(elliptic, n);
        Some(balls.add(&dry, &self.sliding(friction, &belt.ball(balls), moment)?))
    }

    /// sum_k t_k sum_{j odd} C(k,j) (-v*)^(k-j) m((j+1)/2), for any m.
    pub(crate) fn sliding(
        &self,
        friction: &PolynomialFriction,
        belt: &Ball,
        moment: impl Fn(usize) -> Option<Ball>,
    ) -> Option<Ball> {
        let balls = self.balls;
        let minus = balls.neg(belt);
        let mut sum = balls.zero();
        for j in (1..friction.coefficients.len()).step_by(2) {
            let moment = moment(j.div_ceil(2))?;
            for (k, t) in friction.coefficients.iter().enumerate().skip(j) {
                let binomial = Integer::from(k).binomial(u32::try_from(j).ok()?);
                let power = balls.powi(&minus, i64::try_from(k - j).ok()?)?;
                let term = balls.mul(&balls.mul(&t.ball(balls), &power), &moment);
                sum = balls.add(&sum, &balls.mul_rational(&term, &Rational::from(binomial)));
            }
        }
        Some(sum)
    }

    /// int v^{2n} dt over a period: v = -2 v_m sn cn inside (v_m = V k^2/(2-k^2)),
    /// v = -X lam sn dn outside.
    pub(crate) fn moment(&self, elliptic: &Elliptic, n: usize) -> Option<Ball> {
        let balls = self.balls;
        let (factor, rate) = self.scale()?;
        let exponent = i64::try_from(2 * n).ok()?;
        let (size, quarter, periods) = match self.region {
            Region::Inside => {
                let speed = balls.mul_power_of_two(&self.largest_speed(elliptic, &factor)?, 1);
                (speed, elliptic.product_power(balls, n, &balls.one())?, 2)
            }
            Region::Outside => {
                let ratio = balls
                    .div(&balls.mul(&self.a, &elliptic.square), &balls.mul(&self.b, &factor))?;
                let amplitude = balls.sqrt(&balls.mul_power_of_two(&ratio, 1))?;
                (
                    balls.mul(&amplitude, &rate),
                    elliptic.product_power(balls, n, &elliptic.square)?,
                    4,
                )
            }
        };
        let value = balls.mul(&balls.powi(&size, exponent)?, &quarter);
        balls.div(&balls.mul_i64(&value, periods), &rate)
    }

    /// v_m: V k^2/(2-k^2) inside, V/(2k^2-1) outside, V = a/sqrt(2b).
    pub(crate) fn largest_speed(&self, elliptic: &Elliptic, factor: &Ball) -> Option<Ball> {
        let balls = self.balls;
        let root = balls.sqrt(&balls.mul_power_of_two(&self.b, 1))?;
        let speed = balls.div(&self.a, &balls.mul(&root, factor))?;
        Some(match self.region {
            Region::Inside => balls.mul(&speed, &elliptic.square),
            Region::Outside => speed,
        })
    }

    /// int v sgn(v - v*) dt = 2 (x_b - x_a) inside, 4 (x_b - x_a) outside, x_{b,a}^2 = (a +- r)/b
    /// with r = sqrt(2b (v_m^2 - v*^2)), and x_a = 0 where v*^2 <= 2h.
    fn sign_integral(&self, elliptic: &Elliptic, belt: &Exact) -> Option<Ball> {
        let balls = self.balls;
        let (factor, _) = self.scale()?;
        let largest = self.largest_speed(elliptic, &factor)?;
        let gap = balls.sub(&balls.square(&largest), &balls.square(&belt.ball(balls)));
        let square = balls.mul_power_of_two(&balls.mul(&self.b, &gap), 1);
        let r = sqrt_positive_part(balls, &square)?;
        // a^2 - r^2 > 0 exactly where v*^2 > 2h.
        let beyond = balls.sub(&balls.square(&self.a), &square);
        let periods = if self.region == Region::Inside { 2 } else { 4 };
        if gap.is_negative() {
            return Some(balls.zero());
        }
        if self.region == Region::Outside && !beyond.is_positive() {
            if !beyond.is_negative() {
                return None;
            }
            let x = balls.sqrt(&balls.div(&balls.add(&self.a, &r), &self.b)?)?;
            return Some(balls.mul_i64(&x, periods));
        }
        // (x_b^2 - x_a^2)/(x_b + x_a).
        let sum = balls.add(&self.a, &sqrt_positive_part(balls, &beyond)?);
        let sum = balls.sqrt(&balls.mul_power_of_two(&balls.div(&sum, &self.b)?, 1))?;
        let difference = balls.div(&balls.mul_i64(&r, 2 * periods), &balls.mul(&self.b, &sum))?;
        Some(difference)
    }
}
