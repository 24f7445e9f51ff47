//! Forcing terms, their work along the orbit, and the extremes of that work over the phase.

use crate::error::positive;
use crate::root::enclose_root;
use crate::{Branch, Factor, MelnikovError, Potential};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// One harmonic g(x) h cos(k omega t + phase).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Harmonic {
    /// k >= 1.
    pub number: u32,
    /// h.
    pub weight: Exact,
    /// The phase in radians.
    pub phase: Exact,
    /// g, 1 for a force that does not depend on x.
    pub factor: Factor,
}

/// The forcing eps gamma f(t, x).
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Forcing {
    /// sum_k g_k(x) h_k cos(k omega t + psi_k); several terms may have the same k.
    Harmonics {
        /// omega > 0.
        omega: Exact,
        /// The harmonics; none is no force.
        harmonics: Vec<Harmonic>,
    },
    /// Sums as in `Harmonics` with frequencies independent over Q: the phases sweep the torus, so
    /// that the extremes of the parts add.
    Incommensurate(Vec<(Exact, Vec<Harmonic>)>),
}

/// F of the harmonics of one omega.
type WorkOfPart<'a> = dyn Fn((&Exact, &[Harmonic])) -> Result<ForcingWork, MelnikovError> + 'a;

impl Forcing {
    /// cos(omega t).
    #[must_use]
    pub fn single(omega: Exact) -> Self {
        Self::multiplied(omega, Factor::ONE)
    }
    /// g(x) cos(omega t).
    #[must_use]
    pub fn multiplied(omega: Exact, factor: Factor) -> Self {
        let (weight, phase) = (Exact::from(1), Exact::from(0));
        Self::Harmonics { omega, harmonics: vec![Harmonic { number: 1, weight, phase, factor }] }
    }
    /// No force.
    #[must_use]
    pub fn none() -> Self {
        Self::Harmonics { omega: Exact::from(1), harmonics: Vec::new() }
    }
    /// The parts whose frequencies are independent over Q: (omega, harmonics of it).
    pub fn parts(&self) -> impl Iterator<Item = (&Exact, &[Harmonic])> {
        let (one, several) = match self {
            Self::Harmonics { omega, harmonics } => (Some((omega, harmonics.as_slice())), &[][..]),
            Self::Incommensurate(list) => (None, list.as_slice()),
        };
        one.into_iter().chain(several.iter().map(|(omega, list)| (omega, list.as_slice())))
    }
    /// (max F, -min F) over the phases, from the work of the parts: their extremes add.
    ///
    /// # Errors
    /// [`MelnikovError::NoForcing`] without a force, [`MelnikovError::Undecided`], and those of `work`.
    pub fn reach(
        &self,
        balls: Balls,
        work: &WorkOfPart<'_>,
    ) -> Result<(Ball, Ball), MelnikovError> {
        let (mut up, mut down) = (balls.zero(), balls.zero());
        for part in self.parts() {
            if part.1.is_empty() {
                return Err(MelnikovError::NoForcing);
            }
            let undecided = || MelnikovError::Undecided { bits: balls.bits() };
            let found = work(part)?;
            let largest = found.extreme(balls, false).ok_or_else(undecided)?;
            let smallest = found.extreme(balls, true).ok_or_else(undecided)?;
            (up, down) = (balls.add(&up, &largest), balls.sub(&down, &smallest));
        }
        Ok((up, down))
    }
    /// Positive frequencies and numbers of harmonics.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        for (omega, harmonics) in self.parts() {
            positive(omega, "omega")?;
            for harmonic in harmonics {
                harmonic.factor.check()?;
                if harmonic.number == 0 {
                    return Err(MelnikovError::NotPositive { name: "harmonic" });
                }
            }
        }
        Ok(())
    }
}

/// F(theta) = sum_k c_k cos(k theta) + s_k sin(k theta), the work of the forcing at unit gamma
/// as a function of theta = omega t0.
#[derive(Clone, Debug)]
pub struct ForcingWork {
    terms: Vec<(u32, Ball, Ball)>,
}

/// C + iS = int g(x0) v0 e^{i k omega t} dt of a harmonic.
type TransformOf<'a, E> = dyn Fn(&Harmonic) -> Result<(Ball, Ball), E> + 'a;

impl ForcingWork {
    /// From int v0 f(t + t0) dt: a harmonic g(x) h cos(k theta + psi + k omega t) contributes
    /// h (C cos(k theta + psi) - S sin(k theta + psi)), with C + iS the transform of g(x0) v0.
    ///
    /// `None` where a transform is not known ([`Potential::takes_force`]).
    #[must_use]
    pub fn new(
        balls: Balls,
        potential: &Potential,
        branch: Branch,
        (omega, harmonics): (&Exact, &[Harmonic]),
    ) -> Option<Self> {
        let transform = |harmonic: &Harmonic| {
            let frequency = balls.mul_i64(&omega.ball(balls), i64::from(harmonic.number));
            let (c, s) = potential.transform(balls, &harmonic.factor, &frequency).ok_or(())?;
            // x and v change their signs on the mirror image.
            let turned = branch.sign() < 0 && harmonic.factor.parity() > 0;
            Ok(if turned { (balls.neg(&c), balls.neg(&s)) } else { (c, s) })
        };
        Self::from_transforms::<()>(balls, harmonics, &transform).ok()
    }

    /// The same from C + iS = int g(x0) v0 e^{i k omega t} dt, which `transform` returns.
    ///
    /// Terms of one k are one term: an even and an odd factor have their extremes at different phases.
    ///
    /// # Errors
    /// Those of `transform`.
    pub fn from_transforms<E>(
        balls: Balls,
        harmonics: &[Harmonic],
        transform: &TransformOf<'_, E>,
    ) -> Result<Self, E> {
        let mut terms: BTreeMap<u32, (Ball, Ball)> = BTreeMap::new();
        for harmonic in harmonics {
            let (c, s) = transform(harmonic)?;
            let (weight, phase) = (harmonic.weight.ball(balls), harmonic.phase.ball(balls));
            let (cos, sin) = (balls.cos(&phase), balls.sin(&phase));
            let even = balls.sub(&balls.mul(&c, &cos), &balls.mul(&s, &sin));
            let odd = balls.neg(&balls.add(&balls.mul(&c, &sin), &balls.mul(&s, &cos)));
            let (even, odd) = (balls.mul(&weight, &even), balls.mul(&weight, &odd));
            let (along, across) =
                terms.entry(harmonic.number).or_insert_with(|| (balls.zero(), balls.zero()));
            (*along, *across) = (balls.add(along, &even), balls.add(across, &odd));
        }
        Ok(Self { terms: terms.into_iter().map(|(k, (c, s))| (k, c, s)).collect() })
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
