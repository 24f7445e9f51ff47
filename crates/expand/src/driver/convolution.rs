//! Sums over the orders of a series of constants and a series of functions.

use super::{Constant, Driver};
use lindstedt_algebra::{PhaseAlgebra, Ring};

/// A convolution of constants and functions.
#[derive(Clone, Copy)]
pub(super) enum Combined {
    /// W_k x_{n-k}''.
    Inertia,
    /// omega_k x_{n-k}'.
    Velocity,
}

/// Whether c_k f_{order-k} is of orders that stay as they are; see [`next`](crate::ahead::Ahead::next).
fn is_settled(below: usize, order: usize, k: usize) -> bool {
    k <= below && order - k < below
}

impl<A: PhaseAlgebra> Driver<'_, A> {
    /// [x']_n = sum_k omega_k dx_{n-k}/dpsi.
    pub(super) fn velocity(&mut self, n: usize) -> A::Element {
        self.look_ahead(Combined::Velocity, n);
        let leading = [(&self.slopes[n], &self.frequency[0])];
        let rest = self.combined(Combined::Velocity, n);
        let terms: Vec<_> = leading.into_iter().chain(rest).collect();
        self.algebra.linear_combination(&terms)
    }

    /// The terms of a convolution, k = 1..n, those that were summed ahead as one.
    pub(super) fn combined(&self, which: Combined, n: usize) -> Vec<(&A::Element, &Constant<A>)> {
        let ahead = &self.ahead[which as usize];
        let below = ahead.below(n);
        let mut terms = self.terms_of(which, n, |k| !is_settled(below, n, k));
        let sum = ahead.sum(n);
        // W_0 = 1.
        terms.extend(sum.map(|sum| (sum, &self.frequency_squared[0])));
        terms
    }

    /// Sums a convolution for order n and some after it, where many sums at once cost less than one by one.
    pub(super) fn look_ahead(&mut self, which: Combined, n: usize) {
        let last = self.evaluator.last.filter(|_| A::SUMS_AT_ONCE);
        let Some(next) = last.and_then(|last| self.ahead[which as usize].next(n, last)) else {
            return;
        };
        let [coefficients, orders] = next.clone();
        let list = |order| {
            self.terms_of(which, order, |k| {
                is_settled(coefficients.end, order, k) && !is_settled(coefficients.start, order, k)
            })
        };
        let lists: Vec<_> = orders.map(list).collect();
        let (algebra, sums) = (self.algebra, self.algebra.linear_combinations(&lists));
        self.ahead[which as usize].take(next, sums, |sum, rest| algebra.add_assign(sum, rest));
    }

    fn terms_of(
        &self,
        which: Combined,
        n: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<(&A::Element, &Constant<A>)> {
        let (constants, f) = match which {
            Combined::Inertia => (&self.frequency_squared, &self.second_derivatives),
            Combined::Velocity => (&self.frequency, &self.slopes),
        };
        self.convolution(&constants[1..], f, n, wanted)
    }

    /// The terms c_k f_{n-k}, k = 1..n, that are wanted and do not vanish; c_1 is the first of the list.
    pub(crate) fn convolution<'b>(
        &self,
        constants: &'b [Constant<A>],
        f: &'b [A::Element],
        n: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<(&'b A::Element, &'b Constant<A>)> {
        let nonzero =
            |(k, c): &(usize, &Constant<A>)| wanted(*k) && !self.algebra.constants().is_zero(c);
        let terms = (1..=n).zip(constants).filter(nonzero);
        terms.filter_map(|(k, c)| Some((f.get(n - k)?, c))).collect()
    }
}
