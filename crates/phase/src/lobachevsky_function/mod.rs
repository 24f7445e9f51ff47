//! The Lobachevsky function and its relatives Lambda_m, as numbers.
//!
//! With l(t) = -ln|cos t| and the means mu_m = (1/m!) <l^m> over a period,
//!
//!   L(x)        = int_0^x l(t) dt,                      L(x + pi) = L(x) + pi ln 2,
//!   Lambda_m(x) = int_0^x ( l(t)^m/m! - mu_m ) dt,      odd and pi-periodic, m >= 1.
//!
//! Every function takes a [`Point`] that is known exactly and the precision, and returns a ball:
//! the true value lies in it, whatever the argument (10^-300, 10^100, pi/2 - 10^-1000), and its
//! radius is about 2^-bits relative to the value.
//! [`lobachevsky_f64`] is the fast path for double precision.

mod double;
mod integrals;
mod point;
mod rectangular;

pub use double::lobachevsky_f64;
pub use point::{Point, cosine, log_cosine, sine};

use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use point::Reduced;

/// Guard bits on top of log2 of the number of terms: the series lose about 4 ulp per term, the
/// difference of an integral and its mean, taken for |t| >= pi/4, at most 5 bits.
const GUARD_BITS: u32 = 24;

/// The precision in which the series are summed.
fn working(balls: Balls) -> Balls {
    balls.with_guard(GUARD_BITS + 2 * balls.bits().ilog2())
}

/// The means mu_0 = 1, mu_1 = ln 2, ..., mu_max_m of l^m/m! over a period.
///
/// Wallis' integral gives sum_m mu_m s^m = <|cos|^-s> = Gamma((1-s)/2) / (sqrt(pi) Gamma(1-s/2)).
/// Duplication, Gamma((1-s)/2) Gamma(1-s/2) = 2^s sqrt(pi) Gamma(1-s), makes it
/// 2^s Gamma(1-s) / Gamma(1-s/2)^2, and ln Gamma(1-s) = gamma s + sum_(k>=2) zeta(k) s^k / k gives
///
///   sum_m mu_m s^m = exp( s ln 2 + sum_(k>=2) (2^k - 2) zeta(k) (s/2)^k / k ).
///
/// The derivative of the exponent is sum_k eta(k) s^(k-1) with eta(1) = ln 2 and
/// eta(k) = (1 - 2^(1-k)) zeta(k), hence the recurrence m mu_m = sum_(k=1)^m eta(k) mu_(m-k), all
/// of whose terms are positive: the relative error stays at a few ulp times m.
/// Cost: max_m zeta values, max_m^2/2 products.
#[must_use]
pub fn means(max_m: usize, balls: Balls) -> Vec<Ball> {
    means_until(max_m, balls, &Stop::default()).unwrap_or_default()
}

/// As [`means`]; nothing once `stop` said so, which is asked for every m.
#[must_use]
pub fn means_until(max_m: usize, balls: Balls, stop: &Stop) -> Option<Vec<Ball>> {
    let work = balls.with_guard(GUARD_BITS);
    let mut means = vec![work.one()];
    let mut eta = Vec::new();
    for m in 1..=max_m {
        if stop.asked() {
            return None;
        }
        let index = u32::try_from(m).unwrap_or(u32::MAX);
        eta.push(eta_value(index, work));
        let sum = eta
            .iter()
            .zip(means.iter().rev())
            .fold(work.zero(), |sum, (e, mean)| work.add(&sum, &work.mul(e, mean)));
        let mean = work.div_i64(&sum, i64::from(index));
        means.push(mean.unwrap_or_else(|| work.indeterminate()));
    }
    Some(means.iter().map(|mean| balls.round(mean)).collect())
}

/// eta(k) = sum_j (-1)^(j+1) j^-k, k >= 1.
fn eta_value(k: u32, balls: Balls) -> Ball {
    let Some(zeta) = balls.zeta(k) else {
        return balls.ln_2();
    };
    let shift = i32::try_from(k).map_or(i32::MIN, |k| 1 - k);
    balls.sub(&zeta, &balls.mul_power_of_two(&zeta, shift))
}

/// The Lobachevsky function L(x) = -int_0^x ln|cos t| dt.
///
/// Domain: every real x. Returns a ball with about the precision of `balls` relative to |L(x)|,
/// exactly 0 at 0. Cost: at most `bits` steps with machine words and 3 sqrt(bits) products, fewer near
/// multiples of pi/2, one sine, one logarithm,
/// and the reduction of x modulo pi, which takes as many more bits of pi as |x| has.
///
/// ```
/// use lindstedt_number::{ball::Balls, digits::decimal};
/// use lindstedt_phase::lobachevsky_function::{Point, lobachevsky};
/// use rug::Rational;
///
/// let value = lobachevsky(&Point::PiTimes(Rational::from((1, 6))), Balls::new(128));
/// assert_eq!(decimal(&value, 20).as_deref(), Some("0.024617146247382480076"));
/// ```
#[must_use]
pub fn lobachevsky(x: &Point, balls: Balls) -> Ball {
    let work = working(balls);
    let reduced = Reduced::new(x, work);
    let half_period = work.mul_power_of_two(&work.mul(&work.pi(), &work.ln_2()), -1);
    let on_quarter = if reduced.is_zero() {
        work.zero()
    } else if reduced.is_pole() {
        half_period.clone()
    } else if reduced.is_near_zero() {
        let sine = work.sin(&work.abs(&reduced.offset));
        rectangular::from_zero(&sine, work)
    } else {
        let sine = work.sin(&reduced.complement);
        work.sub(&half_period, &rectangular::from_pole(&reduced.complement, &sine, work))
    };
    let value = with_sign(on_quarter, &reduced, work);
    let turns = work.mul_power_of_two(&half_period, 1);
    // For turns != 0 the sum has at least half the size of its larger term: no digits are lost.
    let shift = work.mul(&turns, &work.from_integer(&reduced.turns));
    balls.round(&work.add(&value, &shift))
}

fn last(mut values: Vec<Ball>, balls: Balls) -> Ball {
    values.pop().unwrap_or_else(|| balls.indeterminate())
}

/// An odd function of the offset from its value at |offset|.
fn with_sign(value: Ball, reduced: &Reduced, balls: Balls) -> Ball {
    if reduced.is_negative() { balls.neg(&value) } else { value }
}

/// The functions Lambda_1, ..., Lambda_max_m at many points: owns the means mu_m.
///
/// ```
/// use lindstedt_number::{ball::Balls, digits::decimal};
/// use lindstedt_phase::lobachevsky_function::{LambdaTable, Point};
/// use rug::Rational;
///
/// let table = LambdaTable::new(3, Balls::new(128));
/// let values = table.values(&Point::Rational(Rational::from((1, 2))));
/// assert_eq!(decimal(&values[2], 20).as_deref(), Some("-0.32489884272562125405"));
/// ```
#[derive(Clone, Debug)]
pub struct LambdaTable {
    balls: Balls,
    means: Vec<Ball>,
}

impl LambdaTable {
    /// The table for m = 1..=max_m at the precision of `balls`. Cost: that of [`means`].
    #[must_use]
    pub fn new(max_m: usize, balls: Balls) -> Self {
        Self { balls, means: means(max_m, working(balls)) }
    }
    /// The precision of the values.
    #[must_use]
    pub fn balls(&self) -> Balls {
        self.balls
    }
    /// mu_0 = 1, mu_1, ..., mu_max_m.
    #[must_use]
    pub fn means(&self) -> &[Ball] {
        &self.means
    }
    /// Lambda_0(x) = 0, Lambda_1(x), ..., Lambda_max_m(x), for any real x.
    ///
    /// Lambda_m(x) = int_0^x (l^m/m! - mu_m), with about full relative precision, exactly 0 at
    /// exact multiples of pi/2. Near pi/2 it is evaluated as mu_m y - int_0^y (-ln sin v)^m/m! dv,
    /// y = pi/2 - x, because Lambda_m(pi/2) = 0.
    /// Cost: at most `bits` steps of max_m products (near 0) or small divisions (near pi/2).
    #[must_use]
    pub fn values(&self, x: &Point) -> Vec<Ball> {
        let work = working(self.balls);
        let reduced = Reduced::new(x, work);
        if reduced.is_zero() || reduced.is_pole() {
            return vec![self.balls.zero(); self.means.len()];
        }
        let max_m = self.means.len().saturating_sub(1);
        let near_zero = reduced.is_near_zero();
        let (distance, integrals) = if near_zero {
            let distance = work.abs(&reduced.offset);
            let integrals = integrals::from_zero(&work.sin(&distance), max_m, work);
            (distance, integrals)
        } else {
            let sine = work.sin(&reduced.complement);
            (reduced.complement.clone(), integrals::from_pole(&sine, max_m, work))
        };
        let mut values: Vec<Ball> = (self.means.iter().zip(&integrals))
            .map(|(mean, integral)| {
                let linear = work.mul(mean, &distance);
                let value = if near_zero {
                    work.sub(integral, &linear)
                } else {
                    work.sub(&linear, integral)
                };
                self.balls.round(&with_sign(value, &reduced, work))
            })
            .collect();
        // The integrand of Lambda_0 is 1 - 1.
        if let Some(first) = values.first_mut() {
            *first = self.balls.zero();
        }
        values
    }
}

/// Lambda_m(x) alone, m >= 0; see [`LambdaTable::values`].
#[must_use]
pub fn lambda(m: usize, x: &Point, balls: Balls) -> Ball {
    last(LambdaTable::new(m, balls).values(x), balls)
}

#[cfg(test)]
mod tests;
