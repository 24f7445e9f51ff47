//! Delayed values x(t - T) = exp(-T D_0) sum_i (-T D')^i/i! x with D' = eps D_1 + eps^2 D_2 + ...

use super::{Constant, step_back};
use lindstedt_algebra::{AveragingAlgebra, FunctionAlgebra, Ring};

/// Order n of D' f: sum_{k=1}^n (A_k d/da + B_k d/dpsi) f_{n-k}.
pub(super) fn drift<A: AveragingAlgebra>(
    algebra: &A,
    [amplitude_rate, phase_rate]: [&[Constant<A>]; 2],
    f: &[A::Element],
    n: usize,
) -> A::Element {
    let constants = algebra.constants();
    let mut sum = algebra.zero();
    for k in 1..=n {
        let (Some(a), Some(b), Some(f)) = (amplitude_rate.get(k), phase_rate.get(k), f.get(n - k))
        else {
            continue;
        };
        if !constants.is_zero(a) {
            algebra.add_assign(&mut sum, &algebra.scale_by(&algebra.by_amplitude(f), a));
        }
        if !constants.is_zero(b) {
            algebra.add_assign(&mut sum, &algebra.scale_by(&algebra.by_phase(f), b));
        }
    }
    sum
}

/// The powers (-T D')^i/i! x, order by order, and x(t - T) from their sum.
///
/// Power i starts at order i, so order n needs n of them: O(n) derivations each.
pub(super) struct Tower<A: FunctionAlgebra> {
    delay: usize,
    /// `powers[i]` from order 0; power 0 is x itself and is not stored.
    powers: Vec<Vec<A::Element>>,
    values: Vec<A::Element>,
}

impl<A: AveragingAlgebra> Tower<A> {
    pub(super) fn new(_: &A, delay: usize) -> Self {
        Self { delay, powers: Vec::new(), values: Vec::new() }
    }

    /// x(t - T) from order 0.
    pub(super) fn values(&self) -> &[A::Element] {
        &self.values
    }

    /// Computes order n as far as x, A_n and B_n of order n are known (or zero).
    pub(super) fn extend(
        &mut self,
        algebra: &A,
        rates: [&[Constant<A>]; 2],
        x: &[A::Element],
        n: usize,
    ) -> Option<()> {
        let mut sum = x.get(n)?.clone();
        for i in 1..=n {
            if self.powers.len() < i {
                self.powers.push(vec![algebra.zero(); n]);
            }
            let below = if i == 1 { x } else { &self.powers[i - 2] };
            let change = drift(algebra, rates, below, n);
            let change = algebra.scale_by(&change, &step_back(algebra, self.delay, i)?);
            algebra.add_assign(&mut sum, &change);
            self.powers[i - 1].push(change);
        }
        self.values.push(algebra.shift(&sum, self.delay)?);
        Some(())
    }

    /// Adds to order n what a change of x_n and a change D_n x_0 of the drift bring: only the
    /// first power feels them.
    pub(super) fn amend(
        &mut self,
        algebra: &A,
        n: usize,
        x: &A::Element,
        drift: &A::Element,
    ) -> Option<()> {
        let first = algebra.scale_by(drift, &step_back(algebra, self.delay, 1)?);
        if let Some(known) = self.powers.first_mut().and_then(|power| power.get_mut(n)) {
            algebra.add_assign(known, &first);
        }
        let change = algebra.shift(&algebra.add(x, &first), self.delay)?;
        algebra.add_assign(self.values.get_mut(n)?, &change);
        Some(())
    }
}
