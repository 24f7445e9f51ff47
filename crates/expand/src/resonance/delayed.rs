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
        let mut slopes = Vec::new();
        let mut turns = Vec::new();
        for (k, f) in (1..=n).filter_map(|k| Some((k, f.get(n - k)?))) {
            if algebra.is_zero(f) {
                continue;
            }
            for (j, flow) in self.flow.iter().enumerate() {
                if let Some(flow) = flow.get(k).filter(|flow| !algebra.is_zero(flow)) {
                    slopes.push((flow, algebra.by_amplitude(f, j)));
                }
            }
            for (l, sigmas) in self.detuning.iter().enumerate() {
                if let Some(sigma) = sigmas.get(k - 1) {
                    turns.push((sigma, algebra.by_force(f, l)));
                }
            }
        }
        let along = |list: &[(&E, E)]| {
            let pairs: Vec<_> = list.iter().map(|(rate, slope)| (*rate, slope)).collect();
            algebra.sum_of_products(&pairs)
        };
        let mut sum = algebra.twice_real(&along(&slopes));
        if !turns.is_empty() {
            algebra.add_assign(&mut sum, &along(&turns));
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
