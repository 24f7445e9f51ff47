//! The slow change of series, and delayed values x(t - T) = exp(-T D_0) sum_i (-T D')^i/i! x with
//! D' = eps D_1 + eps^2 D_2 + ...

use lindstedt_algebra::AmplitudeAlgebra;
use rug::Rational;

/// f_{j,n} at `flow[j][n]` and sigma_{l,n} at `detuning[l][n - 1]`.
pub(super) struct Rates<'a, E> {
    pub(super) flow: &'a [Vec<E>],
    pub(super) detuning: &'a [Vec<E>],
}

impl<E> Rates<'_, E> {
    /// Order n of D' f for a real series f: sum_{k=1}^n D_k f_{n-k}.
    pub(super) fn drift<A: AmplitudeAlgebra<Element = E>>(
        &self,
        algebra: &A,
        f: &[E],
        n: usize,
    ) -> E {
        let known = || (1..=n).filter_map(|k| Some((k, f.get(n - k)?)));
        let mut sum = algebra.zero();
        for (j, flow) in self.flow.iter().enumerate() {
            let pair = |(k, f)| Some((flow.get(k)?, f));
            let nonzero = |(flow, f): &(&E, &E)| !algebra.is_zero(flow) && !algebra.is_zero(f);
            let pairs: Vec<_> = known().filter_map(pair).filter(nonzero).collect();
            algebra.add_assign(&mut sum, &algebra.along(j, &pairs));
        }
        for (l, sigmas) in self.detuning.iter().enumerate() {
            let turn = |(k, f): (usize, _)| Some((sigmas.get(k - 1)?, algebra.by_force(f, l)));
            let turns: Vec<_> = known().filter_map(turn).collect();
            let pairs: Vec<_> = turns.iter().map(|(sigma, turn)| (*sigma, turn)).collect();
            algebra.add_assign(&mut sum, &algebra.sum_of_products(&pairs));
        }
        sum
    }
}

/// -T/i.
pub(super) fn step_back<A: AmplitudeAlgebra>(
    algebra: &A,
    delay: usize,
    i: usize,
) -> Option<A::Element> {
    Some(algebra.scale(&algebra.delay(delay)?, &Rational::from((-1, i))))
}

/// The powers (-T D')^i/i! x, order by order, and x(t - T) from their sum.
///
/// Power i starts at order i, so order n needs n of them: O(n) derivations each.
pub(super) struct Tower<E> {
    delay: usize,
    /// `powers[i]` from order 0; power 0 is x itself and is not stored.
    powers: Vec<Vec<E>>,
    values: Vec<E>,
}

impl<E: Clone> Tower<E> {
    pub(super) fn new(delay: usize) -> Self {
        Self { delay, powers: Vec::new(), values: Vec::new() }
    }

    /// x(t - T) from order 0.
    pub(super) fn values(&self) -> &[E] {
        &self.values
    }

    /// Computes order n as far as x and the rates of order n are known (or zero).
    pub(super) fn extend<A: AmplitudeAlgebra<Element = E>>(
        &mut self,
        algebra: &A,
        rates: &Rates<'_, E>,
        x: &[E],
        n: usize,
    ) -> Option<()> {
        let mut sum = x.get(n)?.clone();
        for i in 1..=n {
            if self.powers.len() < i {
                self.powers.push(vec![algebra.zero(); n]);
            }
            let below = if i == 1 { x } else { &self.powers[i - 2] };
            let change = rates.drift(algebra, below, n);
            let change = algebra.mul(&change, &step_back(algebra, self.delay, i)?);
            algebra.add_assign(&mut sum, &change);
            self.powers[i - 1].push(change);
        }
        self.values.push(algebra.shift(&sum, self.delay)?);
        Some(())
    }

    /// Adds to order n what a change of x_n and a change D_n x_0 of the drift bring: only the
    /// first power feels them.
    pub(super) fn amend<A: AmplitudeAlgebra<Element = E>>(
        &mut self,
        algebra: &A,
        n: usize,
        x: &E,
        drift: &E,
    ) -> Option<()> {
        let first = algebra.mul(drift, &step_back(algebra, self.delay, 1)?);
        if let Some(known) = self.powers.first_mut().and_then(|power| power.get_mut(n)) {
            algebra.add_assign(known, &first);
        }
        let change = algebra.shift(&algebra.add(x, &first), self.delay)?;
        algebra.add_assign(self.values.get_mut(n)?, &change);
        Some(())
    }
}
