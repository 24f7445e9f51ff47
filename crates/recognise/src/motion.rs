//! A motion on an orbit, and the integrals of Melnikov's function along it.

use crate::threshold::Perturbation;
use lindstedt_algebra::Stop;
use lindstedt_melnikov::quadrature::tanh_sinh;
use lindstedt_melnikov::{Forcing, ForcingWork, Friction, Harmonic, MelnikovError};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_simulate::{Digits, Trajectory};
use rug::{Float, Rational, ops::Pow};

/// Halvings of the step of the trapezoidal rule.
const LEVELS: u32 = 9;

/// A function of t, x and x'.
type Integrand<'a> = dyn Fn(&Float, &Float, &Float) -> Float + 'a;

/// x(t), x'(t) for |t| <= end.
pub(crate) struct Motion {
    pub forward: Trajectory<Digits>,
    pub backward: Option<Trajectory<Digits>>,
    pub end: Float,
    pub rate: f64,
    pub saddle: Float,
    pub bits: u32,
    pub work: u32,
    pub stop: Stop,
}

impl Motion {
    pub fn state(&self, t: &Float) -> Option<(Float, Float)> {
        if self.stop.asked() {
            return None;
        }
        let (trajectory, flip) = match (&self.backward, t.is_sign_negative()) {
            (Some(backward), true) => (backward, true),
            // A loop is symmetric in time about its turning point.
            (None, true) => (&self.forward, true),
            _ => (&self.forward, false),
        };
        let t = Float::with_val(self.work, t.abs_ref());
        let (x, v) = (trajectory.value(0, &t)?, trajectory.value(1, &t)?);
        Some((x, if flip { -v } else { v }))
    }

    /// The integral of g(t, x, x') over the line by the trapezoidal rule, halved until it settles; the
    /// error is the last change.
    fn trapezoid(&self, g: &Integrand<'_>) -> Option<(Float, Float)> {
        let term = |t: &Float| {
            let (x, v) = self.state(t)?;
            Some(g(t, &x, &v))
        };
        let mut h = Float::with_val(self.work, 0.5 / self.rate);
        let (mut sum, mut last) = (term(&Float::new(self.work))?, None::<Float>);
        let mut size = Float::new(53);
        for level in 0..LEVELS {
            let mut n = 1u32;
            loop {
                let t = Float::with_val(self.work, &h * n);
                if t > self.end {
                    break;
                }
                for t in [t.clone(), -t] {
                    let value = term(&t)?;
                    size = size.max(&Float::with_val(53, value.abs_ref()));
                    sum += value;
                }
                n += if level == 0 { 1 } else { 2 };
            }
            let value = Float::with_val(self.work, &sum * &h);
            if let Some(before) = &last {
                let error = Float::with_val(53, &value - before).abs();
                let floor = Float::with_val(53, &size / self.rate) >> (self.bits - 8);
                if error <= floor {
                    return Some((value, error + floor));
                }
            }
            last = Some(value);
            h /= 2u32;
        }
        None
    }

    fn ball(&self, balls: Balls, parts: Option<(Float, Float)>) -> Result<Ball, MelnikovError> {
        let (value, error) = parts.ok_or(MelnikovError::Undecided { bits: self.bits })?;
        Ok(balls.from_parts(&value, &error))
    }

    /// D of a perturbation.
    pub fn dissipation(
        &self,
        balls: Balls,
        perturbation: &Perturbation,
    ) -> Result<Ball, MelnikovError> {
        let law = self.law_work(balls, &perturbation.friction, &perturbation.belt_speed)?;
        let mut sum = law;
        for term in &perturbation.damping {
            let work = self.trapezoid(&|_, x, v| {
                let speed = Float::with_val(self.work, v.pow(term.velocity + 1));
                speed * term.factor.value(x)
            });
            let work = balls.mul(&term.coefficient.ball(balls), &self.ball(balls, work)?);
            sum = balls.add(&sum, &work);
        }
        Ok(sum)
    }

    /// The work of T(x' - v*).
    fn law_work(
        &self,
        balls: Balls,
        friction: &Friction,
        belt: &Exact,
    ) -> Result<Ball, MelnikovError> {
        let undecided = || MelnikovError::Undecided { bits: self.bits };
        let belt = belt.ball(Balls::new(self.work)).midpoint().clone();
        if let Friction::Polynomial(law) = friction {
            let mut smooth = law.clone();
            smooth.dry = Exact::from(0);
            let smooth = Friction::Polynomial(smooth).law(self.work);
            let slide = |v: &Float| Float::with_val(self.work, v - &belt);
            let smooth = self.trapezoid(&|_, _, v| smooth(&slide(v)) * v);
            let smooth = self.ball(balls, smooth)?;
            let sign = self.sign_integral(&belt).ok_or_else(undecided)?;
            let error = Float::with_val(53, sign.abs_ref()) >> self.bits.saturating_sub(16);
            let dry = balls.mul(&law.dry.ball(balls), &balls.from_parts(&sign, &error));
            return Ok(balls.add(&smooth, &dry));
        }
        let law = friction.law(self.work);
        let mut total = (Float::new(self.work), Float::new(53));
        let cuts = self.cuts(&belt).ok_or_else(undecided)?;
        for pair in cuts.windows(2) {
            let [a, b] = pair else { continue };
            let part = tanh_sinh(self.bits, a, b, |t| {
                let (_, v) = self.state(t)?;
                Some(law(&Float::with_val(self.work, &v - &belt)) * v)
            })?;
            total.0 += part.value;
            total.1 += part.error;
        }
        total.1 += Float::with_val(53, total.0.abs_ref()) >> self.bits.saturating_sub(16);
        self.ball(balls, Some(total))
    }

    /// The ends, 0, and the times at which x' passes the speed of the belt.
    fn cuts(&self, belt: &Float) -> Option<Vec<Float>> {
        const CELLS: i32 = 600;
        let at = |n: i32| Float::with_val(self.work, &self.end * n) / CELLS;
        let above = |t: &Float| Some(self.state(t)?.1 > *belt);
        let mut cuts = vec![-self.end.clone(), Float::new(self.work), self.end.clone()];
        for n in -CELLS..CELLS {
            let (mut low, mut high) = (at(n), at(n + 1));
            let side = above(&low)?;
            if above(&high)? == side {
                continue;
            }
            for _ in 0..self.work {
                let middle = Float::with_val(self.work, &low + &high) / 2u32;
                if above(&middle)? == side { low = middle } else { high = middle }
            }
            cuts.push(low);
        }
        cuts.sort_by(Float::total_cmp);
        Some(cuts)
    }

    /// int v sgn(v - v*) dt: the displacements between the cuts.
    fn sign_integral(&self, belt: &Float) -> Option<Float> {
        let cuts = self.cuts(belt)?;
        let mut sum = Float::new(self.work);
        for pair in cuts.windows(2) {
            let [a, b] = pair else { continue };
            let piece = self.state(b)?.0 - self.state(a)?.0;
            let middle = Float::with_val(self.work, a + b) / 2u32;
            if self.state(&middle)?.1 > *belt { sum += piece } else { sum -= piece }
        }
        Some(sum)
    }

    /// max F, or -min F, of the work of the force.
    pub fn reach(
        &self,
        balls: Balls,
        forcing: &Forcing,
        down: bool,
    ) -> Result<Ball, MelnikovError> {
        let work = |(omega, harmonics): (&Exact, &[Harmonic])| {
            ForcingWork::from_transforms(balls, harmonics, &|harmonic| {
                let omega = omega.times(&Rational::from(harmonic.number));
                let omega = omega.ball(Balls::new(self.work)).midpoint().clone();
                let angle = |t: &Float| Float::with_val(self.work, t * &omega);
                let value = |x: &Float, v: &Float| harmonic.factor.value(x) * v;
                let c = self.trapezoid(&|t, x, v| angle(t).cos() * value(x, v));
                let s = self.trapezoid(&|t, x, v| angle(t).sin() * value(x, v));
                Ok((self.ball(balls, c)?, self.ball(balls, s)?))
            })
        };
        let (up, low) = forcing.reach(balls, &work)?;
        let found = if down { low } else { up };
        if found.contains_zero() {
            return Err(MelnikovError::NoForcing);
        }
        Ok(found)
    }
}
