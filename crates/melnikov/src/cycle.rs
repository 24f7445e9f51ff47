//! Cycles of the paper's oscillator on its belt, without a force and without sticking.
//!
//!   x'' = a x - b x^3 - eps T(x' - v*),   T(w) = T0 sgn w + sum_k t_k w^k.
//!
//! An orbit of energy H of eps = 0 loses eps D(H) in a period P(H), D = int v T(v - v*) dt. While |v| < v* the sign is
//! -1 and does no work: D is a sum of S_n = int v^{2n} dt. To first order cycles are the zeros of D, and since
//! v dv = dH at fixed x,
//!
//!   dS_n/dH = (2n - 1) S_{n-1},   S_0 = P,   lambda = -eps D'(H)/P   (Floquet exponent per unit of t).

use crate::elliptic::Elliptic;
use crate::error::positive;
use crate::root::enclose_root;
use crate::subharmonic::Parts;
use crate::{MelnikovError, PolynomialFriction, Region};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Float;

/// A cycle to first order in eps; every number is enclosed.
#[derive(Clone, Debug)]
pub struct BeltCycle {
    /// The turning points, in x > 0 inside a well.
    pub turning_points: [Ball; 2],
    /// The largest |x'|.
    pub largest_speed: Ball,
    /// The period at eps = 0.
    pub period: Ball,
    /// lambda/eps: the cycle attracts for eps > 0 where it is negative.
    pub exponent: Ball,
    /// The speed of the belt.
    pub belt_speed: Ball,
}

/// Which belt: a given one, or the one as fast as the mass at its fastest.
#[derive(Clone, Copy)]
enum Belt<'a> {
    At(&'a Exact),
    Touching,
}

/// Steps of L = -ln k' in the search for a change of sign, and their number in 1.
const STEPS: u32 = 512;
const PER_UNIT: u32 = 64;

/// The cycles of x'' = a x - b x^3 - eps T(x' - v*) in a region that do not reach the speed of the belt, |x'| < |v*|: the
/// changes of sign of D(H) on a grid of step 1/64 in -ln k' up to 8 (each is proved; two zeros closer than the grid
/// are missed).
///
/// # Errors
/// [`MelnikovError::NotPositive`]; [`MelnikovError::Undecided`] at too low a precision.
///
/// ```
/// use lindstedt_melnikov::{PolynomialFriction, Region, belt_cycles};
/// use lindstedt_number::{Exact, ball::Balls};
/// let (one, t) = (Exact::from(1), || Exact::from((3, 10)));
/// let law = PolynomialFriction::cubic(t(), &t(), t());
/// let cycles = belt_cycles(Balls::new(128), &one, &one, &law, &Exact::from((11, 20)), Region::Inside)?;
/// assert!(cycles.len() == 1 && cycles[0].exponent.is_negative());
/// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
/// ```
pub fn belt_cycles(
    balls: Balls,
    a: &Exact,
    b: &Exact,
    friction: &PolynomialFriction,
    belt_speed: &Exact,
    region: Region,
) -> Result<Vec<BeltCycle>, MelnikovError> {
    let all = search(balls, [a, b], friction, Belt::At(belt_speed), region)?;
    let belt = balls.abs(&belt_speed.ball(balls));
    let mut free = Vec::new();
    for cycle in all {
        let gap = balls.sub(&belt, &cycle.largest_speed);
        if gap.contains_zero() {
            return Err(MelnikovError::Undecided { bits: balls.bits() });
        }
        if gap.is_positive() {
            free.push(cycle);
        }
    }
    Ok(free)
}

/// The cycles whose largest speed is that of the belt, which is found with them: there sticking begins.
///
/// # Errors
/// As [`belt_cycles`].
pub fn sticking_begins(
    balls: Balls,
    a: &Exact,
    b: &Exact,
    friction: &PolynomialFriction,
    region: Region,
) -> Result<Vec<BeltCycle>, MelnikovError> {
    search(balls, [a, b], friction, Belt::Touching, region)
}

fn search(
    balls: Balls,
    [a, b]: [&Exact; 2],
    friction: &PolynomialFriction,
    belt: Belt<'_>,
    region: Region,
) -> Result<Vec<BeltCycle>, MelnikovError> {
    positive(a, "a")?;
    positive(b, "b")?;
    friction.check()?;
    let undecided = || MelnikovError::Undecided { bits: balls.bits() };
    let (a, b) = (a.ball(balls), b.ball(balls));
    let orbit = |balls: Balls, level: &Ball| {
        let complement = balls.exp(&balls.neg(level));
        let elliptic = Elliptic::new(balls, &complement)?;
        let parts =
            Parts { balls, a: a.clone(), b: b.clone(), omega: balls.one(), region, complement };
        let (factor, _) = parts.scale()?;
        let speed = parts.largest_speed(&elliptic, &factor)?;
        let belt = match belt {
            Belt::At(speed) => speed.ball(balls),
            Belt::Touching => speed.clone(),
        };
        Some((parts, elliptic, speed, belt))
    };
    let work = |balls: Balls, level: &Ball| {
        let (parts, elliptic, _, belt) = orbit(balls, level)?;
        parts.sliding(friction, &belt, |n| parts.moment(&elliptic, n))
    };
    let start = match region {
        Region::Inside => 0.0,
        Region::Outside => std::f64::consts::LN_2 / 2.0 + 1e-9,
    };
    let at = |k: u32| Float::with_val(balls.bits(), start + f64::from(k) / f64::from(PER_UNIT));
    let exact = |x: &Float| balls.from_parts(x, &Float::new(53));
    let mut found = Vec::new();
    let mut before: Option<(Float, bool)> = None;
    for level in (1..=STEPS).map(at) {
        let value = work(balls, &exact(&level)).ok_or_else(undecided)?;
        if value.contains_zero() {
            return Err(undecided());
        }
        let positive = value.is_positive();
        if let Some((low, _)) = before.filter(|(_, sign)| *sign != positive) {
            let root = enclose_root(balls, &low, &level, work).ok_or_else(undecided)?;
            let (parts, elliptic, speed, belt) = orbit(balls, &root).ok_or_else(undecided)?;
            let cycle = parts.cycle(&elliptic, friction, speed, belt);
            found.push(cycle.ok_or_else(undecided)?);
        }
        before = Some((level, positive));
    }
    Ok(found)
}

impl Parts {
    fn cycle(
        &self,
        elliptic: &Elliptic,
        friction: &PolynomialFriction,
        largest_speed: Ball,
        belt_speed: Ball,
    ) -> Option<BeltCycle> {
        let balls = self.balls;
        let (_, rate) = self.scale()?;
        let root = balls.sqrt(&balls.div(&balls.from_i64(2), &self.b)?)?;
        // Inside x = sqrt(2/b) lam dn, outside x = sqrt(2/b) lam k cn.
        let full = balls.mul(&root, &rate);
        let turns = match self.region {
            Region::Inside => [balls.mul(&full, &self.complement), full],
            Region::Outside => {
                let x = balls.mul(&full, &balls.sqrt(&elliptic.square)?);
                [balls.neg(&x), x]
            }
        };
        let quarters = if self.region == Region::Inside { 2 } else { 4 };
        let period = balls.div(&balls.mul_i64(&elliptic.k, quarters), &rate)?;
        let slope = self.sliding(friction, &belt_speed, |n| {
            let below = if n == 1 { period.clone() } else { self.moment(elliptic, n - 1)? };
            Some(balls.mul_i64(&below, i64::try_from(2 * n - 1).ok()?))
        })?;
        let exponent = balls.neg(&balls.div(&slope, &period)?);
        Some(BeltCycle { turning_points: turns, largest_speed, period, exponent, belt_speed })
    }
}
