//! Forcing terms, their work along the orbit, and the extremes of that work over the phase.

use crate::error::positive;
use crate::root::enclose_root;
use crate::{Branch, MelnikovError, Potential};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

/// One harmonic g cos(k omega t + phase).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Harmonic {
    /// k >= 1.
    pub order: u32,
    /// g.
    pub weight: Exact,
    /// The phase in radians.
    pub phase: Exact,
}

/// The forcing eps gamma f(t).
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Forcing {
    /// sum_k g_k cos(k omega t + psi_k).
    Harmonics {
        /// omega > 0.
        omega: Exact,
        /// The harmonics.
        harmonics: Vec<Harmonic>,
    },
    /// sum_i g_i cos(omega_i t + psi_i) with omega_i independent over Q: the phases sweep the
    /// torus, so only the sum of the amplitudes matters.
    Incommensurate(Vec<(Exact, Exact)>),
    /// x cos(omega t).
    Parametric {
        /// omega > 0.
        omega: Exact,
    },
}

impl Forcing {
    /// cos(omega t).
    #[must_use]
    pub fn single(omega: Exact) -> Self {
        let one = Harmonic { order: 1, weight: Exact::from(1), phase: Exact::from(0) };
        Self::Harmonics { omega, harmonics: vec![one] }
    }
    /// Positive frequencies and orders.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        match self {
            Self::Harmonics { omega, harmonics } => {
                positive(omega, "omega")?;
                if harmonics.iter().any(|h| h.order == 0) {
                    return Err(MelnikovError::NotPositive { name: "harmonic" });
                }
                Ok(())
            }
            Self::Incommensurate(terms) => {
                terms.iter().try_for_each(|(omega, _)| positive(omega, "omega"))
            }
            Self::Parametric { omega } => positive(omega, "omega"),
        }
    }
}

/// F(theta) = sum_k c_k cos(k theta) + s_k sin(k theta), the work of the forcing at unit gamma
/// as a function of theta = omega t0.
#[derive(Clone, Debug)]
pub struct ForcingWork {
    terms: Vec<(u32, Ball, Ball)>,
}

impl ForcingWork {
    /// From int v0 f(t + t0) dt: a harmonic g cos(k theta + psi + k omega t) contributes
    /// g (C cos(k theta + psi) - S sin(k theta + psi)), with C + iS the transform of v0.
    ///
    /// `None` for a forcing without this form (incommensurate, or parametric off the algebra).
    #[must_use]
    pub fn new(
        balls: Balls,
        potential: &Potential,
        branch: Branch,
        forcing: &Forcing,
    ) -> Option<Self> {
        let oriented = |ball: &Ball| if branch.sign() < 0 { balls.neg(ball) } else { ball.clone() };
        match forcing {
            Forcing::Harmonics { omega, harmonics } => {
                let transform = |k: u32| {
                    let frequency = balls.mul_i64(&omega.ball(balls), i64::from(k));
                    let (c, s) = potential.velocity_transform(balls, &frequency).ok_or(())?;
                    Ok((oriented(&c), oriented(&s)))
                };
                Self::from_transforms::<()>(balls, harmonics, &transform).ok()
            }
            Forcing::Parametric { omega } => {
                // x0 v0 is even under the mirror image: the same on both branches.
                let (c, s) = potential.parametric_transform(balls, &omega.ball(balls))?;
                Some(Self { terms: vec![(1, c, balls.neg(&s))] })
            }
            Forcing::Incommensurate(_) => None,
        }
    }

    /// The same from C + iS = int v0 e^{i k omega t} dt, which `transform` returns for k.
    ///
    /// # Errors
    /// Those of `transform`.
    pub fn from_transforms<E>(
        balls: Balls,
        harmonics: &[Harmonic],
        transform: &dyn Fn(u32) -> Result<(Ball, Ball), E>,
    ) -> Result<Self, E> {
        let mut terms = Vec::new();
        for harmonic in harmonics {
            let (c, s) = transform(harmonic.order)?;
            let (weight, phase) = (harmonic.weight.ball(balls), harmonic.phase.ball(balls));
            let (cos, sin) = (balls.cos(&phase), balls.sin(&phase));
            let even = balls.sub(&balls.mul(&c, &cos), &balls.mul(&s, &sin));
            let odd = balls.neg(&balls.add(&balls.mul(&c, &sin), &balls.mul(&s, &cos)));
            terms.push((harmonic.order, balls.mul(&weight, &even), balls.mul(&weight, &odd)));
        }
        Ok(Self { terms })
    }

    /// The n-th derivative of F at theta.
    #[must_use]
    pub fn derivative(&self, balls: Balls, theta: &Ball, n: u32) -> Ball {
        let mut sum = balls.zero();
        for (k, c, s) in &self.terms {
            let angle = balls.mul_i64(theta, i64::from(*k));
            let (cos, sin) = (balls.cos(&angle), balls.sin(&angle));
            let (along, across) = (
                balls.add(&balls.mul(c, &cos), &balls.mul(s, &sin)),
                balls.sub(&balls.mul(s, &cos), &balls.mul(c, &sin)),
            );
            let value = if n.is_multiple_of(2) { along } else { across };
            let value = if n % 4 >= 2 { balls.neg(&value) } else { value };
            let mut factor = rug::Integer::from(1);
            for _ in 0..n {
                factor *= k;
            }
            sum = balls.add(&sum, &balls.mul_rational(&value, &Rational::from(factor)));
        }
        sum
    }

    /// The amplitude sqrt(c^2 + s^2) of a single harmonic.
    fn single(&self, balls: Balls) -> Option<Ball> {
        let [(_, c, s)] = self.terms.as_slice() else {
            return None;
        };
        match (c.is_exact() && c.contains_zero(), s.is_exact() && s.contains_zero()) {
            (true, _) => Some(balls.abs(s)),
            (_, true) => Some(balls.abs(c)),
            _ => balls.sqrt(&balls.add(&balls.square(c), &balls.square(s))),
        }
    }

    /// max F over theta, certified; with `smallest`, min F instead.
    ///
    /// One harmonic: the amplitude. Several: the circle is cut into cells; a cell whose upper
    /// bound F(m) + |F'(m)| h/2 + B_2 h^2/8 is below a value already reached is discarded; on the
    /// cells left F'' must be negative (F''(m) + B_3 h/2 < 0), so that each holds at most one
    /// stationary point, which the sign of F' encloses. `None` where 2^14 cells per harmonic or
    /// the precision do not decide.
    #[must_use]
    pub fn extreme(&self, balls: Balls, smallest: bool) -> Option<Ball> {
        if let Some(amplitude) = self.single(balls) {
            return Some(if smallest { balls.neg(&amplitude) } else { amplitude });
        }
        if smallest {
            let flip = |(k, c, s): &(u32, Ball, Ball)| (*k, balls.neg(c), balls.neg(s));
            let flipped = Self { terms: self.terms.iter().map(flip).collect() };
            return Some(balls.neg(&flipped.largest(balls)?));
        }
        self.largest(balls)
    }

    fn largest(&self, balls: Balls) -> Option<Ball> {
        let highest = self.terms.iter().map(|t| t.0).max()?;
        (5..=14).find_map(|level| self.largest_on(balls, (1u32 << level).checked_mul(highest)?))
    }

    fn largest_on(&self, balls: Balls, cells: u32) -> Option<Ball> {
        let coarse = Balls::new(80);
        let bound = |power: u32| {
            let weight = |(k, c, s): &(u32, Ball, Ball)| {
                let size = c.abs_upper().to_f64() + s.abs_upper().to_f64();
                size * f64::from(*k).powi(power as i32)
            };
            self.terms.iter().map(weight).sum::<f64>() * 1.000_001
        };
        let (second, third) = (bound(2), bound(3));
        // A hair more than the circle, from an origin that is no symmetry point.
        let width = 6.283_186 / f64::from(cells);
        let centre = |i: u32| 0.123_456_7 + width * f64::from(i);
        let at = |i: u32, n| -> Option<Ball> {
            Some(self.derivative(coarse, &coarse.from_f64(centre(i))?, n))
        };
        let mut values = Vec::new();
        let mut best = f64::NEG_INFINITY;
        for i in 0..cells {
            let (value, slope) = (at(i, 0)?, at(i, 1)?);
            best = best.max(value.lower().to_f64());
            let slope = slope.abs_upper().to_f64();
            values
                .push(value.upper().to_f64() + slope * width / 2.0 + second * width * width / 8.0);
        }
        let mut largest: Option<Ball> = None;
        for (i, upper) in (0..cells).zip(values) {
            if upper < best - 1e-12 * best.abs() {
                continue;
            }
            if at(i, 2)?.upper().to_f64() + third * width / 2.0 >= 0.0 {
                return None;
            }
            let half = width * 0.500_000_1;
            let (low, high) = (centre(i) - half, centre(i) + half);
            let slope = |balls: Balls, theta: &Ball| Some(self.derivative(balls, theta, 1));
            let ends = (Float::with_val(53, low), Float::with_val(53, high));
            if let Some(theta) = enclose_root(balls, &ends.0, &ends.1, slope) {
                let value = self.derivative(balls, &theta, 0);
                largest = Some(match largest {
                    Some(other) if other.lower() >= value.upper() => other,
                    Some(other) if value.lower() >= other.upper() => value,
                    Some(other) => balls.hull(&other, &value),
                    None => value,
                });
            }
        }
        largest
    }
}
