//! Complete elliptic integrals by the arithmetic-geometric mean, in the complementary modulus.

use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// K(k), E(k) and the integrals of even powers of sn over a quarter period.
#[derive(Clone, Debug)]
pub struct Elliptic {
    /// k^2 = 1 - k'^2.
    pub square: Ball,
    /// K(k), the quarter period.
    pub k: Ball,
    /// E(k).
    pub e: Ball,
}

impl Elliptic {
    /// From the complementary modulus k' in (0, 1]: K = pi/(2 agm(1, k')),
    /// E = K (1 - sum_n 2^(n-1) c_n^2) with c_0^2 = k^2, c_{n+1} = (a_n - b_n)/2.
    ///
    /// Carrying k' keeps K accurate for k -> 1. The mean lies between b_n and a_n; because
    /// c_{n+1} = c_n^2/(4 a_{n+1}), the rest of the sum is below twice the next term. Cost
    /// O(log p + log log 1/k') square roots.
    #[must_use]
    pub fn new(balls: Balls, complement: &Ball) -> Option<Self> {
        if !complement.is_positive() || !complement.is_finite() {
            return None;
        }
        let square = balls.sub(&balls.one(), &balls.square(complement));
        let (mut a, mut b) = (balls.one(), complement.clone());
        let mut sum = balls.mul_power_of_two(&square, -1);
        let mut power = 0;
        loop {
            let c = balls.mul_power_of_two(&balls.sub(&a, &b), -1);
            let mean = balls.mul_power_of_two(&balls.add(&a, &b), -1);
            b = balls.sqrt(&balls.mul(&a, &b))?;
            a = mean;
            power += 1;
            let term = balls.mul_power_of_two(&balls.square(&c), power - 1);
            sum = balls.add(&sum, &term);
            let bits = i64::from(balls.bits());
            let exponent = |x: &Ball| x.abs_upper().get_exp().map_or(i64::MIN / 4, i64::from);
            if c.contains_zero() || 2 * exponent(&c) < exponent(&a) - bits - 8 {
                // All later terms together are below this one.
                sum = balls.add_error(&sum, &term.abs_upper());
                break;
            }
            if power > 200 {
                return None;
            }
        }
        let mean = balls.hull(&a, &b);
        let k = balls.div(&balls.mul_power_of_two(&balls.pi(), -1), &mean)?;
        let e = balls.mul(&k, &balls.sub(&balls.one(), &sum));
        Some(Self { square, k, e })
    }

    /// s_i = int_0^K sn^{2i} du for i = 0 .. count - 1: s_0 = K, s_1 = (K - E)/k^2 and
    /// (2i+1) k^2 s_{i+1} = 2i (1 + k^2) s_i - (2i-1) s_{i-1}.
    ///
    /// Forward recurrence: it loses about log2(1/k^2) bits per step for k -> 0, which the radii
    /// show; the caller raises the precision.
    #[must_use]
    pub fn sn_powers(&self, balls: Balls, count: usize) -> Option<Vec<Ball>> {
        let mut powers =
            vec![self.k.clone(), balls.div(&balls.sub(&self.k, &self.e), &self.square)?];
        let sum = balls.add(&balls.one(), &self.square);
        while powers.len() < count {
            let i = i64::try_from(powers.len()).ok()? - 1;
            let [.., before, last] = powers.as_slice() else {
                return None;
            };
            let right = balls.sub(
                &balls.mul_i64(&balls.mul(&sum, last), 2 * i),
                &balls.mul_i64(before, 2 * i - 1),
            );
            let next = balls.div(&right, &balls.mul_i64(&self.square, 2 * i + 1))?;
            powers.push(next);
        }
        powers.truncate(count);
        Some(powers)
    }

    /// int_0^K sn^{2n} (1 - q sn^2)^n du, for q = 1 (cn) or q = k^2 (dn).
    #[must_use]
    pub fn product_power(&self, balls: Balls, n: usize, q: &Ball) -> Option<Ball> {
        let powers = self.sn_powers(balls, 2 * n + 1)?;
        let minus = balls.neg(q);
        let mut factor = balls.one();
        let mut sum = balls.zero();
        for i in 0..=n {
            let binomial = rug::Integer::from(n).binomial(u32::try_from(i).ok()?);
            let term = balls.mul(&factor, &powers[n + i]);
            sum = balls.add(&sum, &balls.mul_rational(&term, &Rational::from(binomial)));
            factor = balls.mul(&factor, &minus);
        }
        Some(sum)
    }
}
