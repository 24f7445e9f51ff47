//! Sums of products, formed in advance of their orders.

use std::ops::Range;

/// Of a product of two series the sums of products of coefficients that stay as they are, in advance of their orders:
/// many orders at once from all coefficients, and of them a few at a time with the coefficients found meanwhile.
pub(crate) struct Ahead<E> {
    many: Option<Sums<E>>,
    few: Option<Sums<E>>,
}

struct Sums<E> {
    /// The orders of the coefficients are below.
    below: usize,
    /// The first of the orders, and their sums.
    first: usize,
    sums: Vec<E>,
}

/// The orders that are summed at once.
const MANY: usize = 64;
const FEW: usize = 8;

impl<E> Sums<E> {
    fn of(&self, n: usize) -> Option<&E> {
        self.sums.get(n.checked_sub(self.first)?)
    }
}

impl<E: Clone> Ahead<E> {
    pub(crate) fn new() -> Self {
        Self { many: None, few: None }
    }

    /// What is to be summed at order n, of all orders up to `last`: the orders of the coefficients, and those of their
    /// products. They are below n - 1: these stay as they are, since of a limit cycle order n fixes the amplitude of the
    /// one before.
    pub(crate) fn next(&self, n: usize, last: usize) -> Option<[Range<usize>; 2]> {
        if self.few.as_ref().is_some_and(|few| few.of(n).is_some()) {
            return None;
        }
        let many = self.many.as_ref().filter(|many| many.of(n).is_some());
        let (from, length, left) = match many {
            Some(many) => (many.below, FEW, many.first + many.sums.len() - n),
            None => (0, (n / 8).min(MANY), (last + 1).saturating_sub(n)),
        };
        let length = length.min(left);
        (length > 1).then(|| [from..n - 1, n..n + length])
    }

    /// Takes these sums.
    pub(crate) fn take(
        &mut self,
        [coefficients, orders]: [Range<usize>; 2],
        mut sums: Vec<E>,
        add: impl Fn(&mut E, &E),
    ) {
        let (below, first) = (coefficients.end, orders.start);
        if coefficients.start == 0 {
            let few = sums.iter().take(FEW).cloned().collect();
            self.few = Some(Sums { below, first, sums: few });
            self.many = Some(Sums { below, first, sums });
            return;
        }
        for (order, sum) in orders.zip(&mut sums) {
            if let Some(rest) = self.many.as_ref().and_then(|many| many.of(order)) {
                add(sum, rest);
            }
        }
        self.few = Some(Sums { below, first, sums });
    }

    fn sums(&self, n: usize) -> Option<&Sums<E>> {
        [&self.few, &self.many].into_iter().flatten().find(|sums| sums.of(n).is_some())
    }

    /// The sum of order n.
    pub(crate) fn sum(&self, n: usize) -> Option<&E> {
        self.sums(n)?.of(n)
    }

    /// The orders of the coefficients in the sum of order n are below.
    pub(crate) fn below(&self, n: usize) -> usize {
        self.sums(n).map_or(0, |sums| sums.below)
    }

    /// Coefficient n changes.
    pub(crate) fn forget(&mut self, n: usize) {
        self.few.take_if(|sums| n < sums.below);
        self.many.take_if(|sums| n < sums.below);
    }
}
