//! Complex constants: what multiplies e^(i psi) in Re(z e^(i psi)).

use super::Constant;
use lindstedt_algebra::{AveragingAlgebra, Ring};

/// [re, im].
pub(super) type Pair<E> = [E; 2];

/// R\[i\] over a real ring R.
pub(super) struct Complex<'a, R>(pub &'a R);

impl<R: Ring> Ring for Complex<'_, R> {
    type Element = Pair<R::Element>;

    fn zero(&self) -> Self::Element {
        [self.0.zero(), self.0.zero()]
    }
    fn one(&self) -> Self::Element {
        [self.0.one(), self.0.zero()]
    }
    fn is_zero(&self, z: &Self::Element) -> bool {
        z.iter().all(|part| self.0.is_zero(part))
    }
    fn may_vanish(&self, z: &Self::Element) -> bool {
        z.iter().all(|part| self.0.may_vanish(part))
    }
    fn add_assign(&self, z: &mut Self::Element, w: &Self::Element) {
        z.iter_mut().zip(w).for_each(|(a, b)| self.0.add_assign(a, b));
    }
    fn neg(&self, z: &Self::Element) -> Self::Element {
        z.each_ref().map(|part| self.0.neg(part))
    }
    fn mul(&self, z: &Self::Element, w: &Self::Element) -> Self::Element {
        self.sum_of_products(&[(z, w)])
    }
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let minus: Vec<_> = pairs.iter().map(|(z, _)| self.0.neg(&z[1])).collect();
        let straight =
            pairs.iter().zip(&minus).flat_map(|((z, w), m)| [(&z[0], &w[0]), (m, &w[1])]);
        let crossed = pairs.iter().flat_map(|(z, w)| [(&z[0], &w[1]), (&z[1], &w[0])]);
        let nonzero =
            |(a, b): &(&R::Element, &R::Element)| !self.0.is_zero(a) && !self.0.is_zero(b);
        let sum = |list: Vec<_>| self.0.sum_of_products(&list);
        [sum(straight.filter(nonzero).collect()), sum(crossed.filter(nonzero).collect())]
    }
}

/// z with f = Re(z e^(i psi)), for a first harmonic f.
pub(super) fn factor<A: AveragingAlgebra>(algebra: &A, f: &A::Element) -> Pair<Constant<A>> {
    let [cos, sin] = algebra.first_harmonic_of(f);
    [cos, algebra.constants().neg(&sin)]
}

/// Re(z a e^(i psi)).
pub(super) fn oscillation<A: AveragingAlgebra>(
    algebra: &A,
    [re, im]: &Pair<Constant<A>>,
) -> A::Element {
    let generating = algebra.generating_solution();
    // d/dpsi of a cos psi is -a sin psi = Re(i a e^(i psi)).
    let turned = algebra.by_phase(&generating);
    algebra.add(&algebra.scale_by(&generating, re), &algebra.scale_by(&turned, im))
}
