//! A finished expansion substituted into its equation, and its halves joined.

use super::HalfTurn;
use super::average::{FrictionTerm, HalfTurnExpansion, mismatch};
use lindstedt_algebra::Stop;
use rug::Rational;

impl HalfTurnExpansion {
    /// The highest order up to which nothing is left of x'' + x + eps h(x, x'; eps), x and x' join their
    /// reflection, and psi = 0 is a turning point at a; 0 where there was no time for the check.
    ///
    /// The powers of x and x' are formed anew from the finished series.
    pub fn checked_orders(&self, law: &[FrictionTerm]) -> usize {
        if self.stop.asked() {
            return 0;
        }
        let order = self.solution.len() - 1;
        let each = |f: &[HalfTurn]| (0..=order).map(|n| self.rate_of_change(f, n)).collect();
        let velocity: Vec<HalfTurn> = each(&self.solution);
        let mut residual: Vec<HalfTurn> = each(&velocity);
        let plus = Rational::from(1);
        for (sum, x) in residual.iter_mut().zip(&self.solution) {
            sum.add_scaled(x, &plus);
        }
        for term in law {
            let mut force = vec![HalfTurn::default()];
            force.extend_from_slice(&term.factors);
            force.resize(order + 1, HalfTurn::default());
            let factors = std::iter::repeat_n(&self.solution, term.displacement)
                .chain(std::iter::repeat_n(&velocity, term.velocity));
            let force = factors.fold(force, |force, factor| product(&force, factor, &self.stop));
            for (sum, f) in residual.iter_mut().zip(&force) {
                sum.add_scaled(f, &plus);
            }
        }
        if self.stop.asked() {
            return 0;
        }
        let holds = |n: &usize| {
            let (x, v) = (&self.solution[*n], &velocity[*n]);
            let joins = mismatch(x).is_zero() && mismatch(v).is_zero();
            let turns = (*n == 0 || x.at_start().is_zero()) && v.at_start().is_zero();
            residual[*n].is_zero() && joins && turns
        };
        (0..=order).take_while(holds).count().saturating_sub(1)
    }
}

/// The product of two series, as far as both reach.
fn product(f: &[HalfTurn], g: &[HalfTurn], stop: &Stop) -> Vec<HalfTurn> {
    let order = |n: usize| {
        let mut sum = HalfTurn::default();
        for k in 0..=n {
            sum.add_product(&f[k], &g[n - k], stop);
        }
        sum
    };
    (0..f.len()).map(order).collect()
}
