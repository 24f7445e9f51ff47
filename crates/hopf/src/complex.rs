//! R\[i\] over a real field: pairs \[re, im\].

use lindstedt_algebra::RationalAlgebra;

/// \[re, im\].
pub type Pair<E> = [E; 2];

/// The complex numbers over a real field.
pub(crate) struct ComplexNumbers<'a, R>(pub &'a R);

impl<R: RationalAlgebra> ComplexNumbers<'_, R> {
    pub fn zero(&self) -> Pair<R::Element> {
        [self.0.zero(), self.0.zero()]
    }
    pub fn one(&self) -> Pair<R::Element> {
        [self.0.one(), self.0.zero()]
    }
    pub fn is_zero(&self, z: &Pair<R::Element>) -> bool {
        z.iter().all(|part| self.0.is_zero(part))
    }
    pub fn may_vanish(&self, z: &Pair<R::Element>) -> bool {
        z.iter().all(|part| self.0.may_vanish(part))
    }
    pub fn add_assign(&self, z: &mut Pair<R::Element>, w: &Pair<R::Element>) {
        z.iter_mut().zip(w).for_each(|(a, b)| self.0.add_assign(a, b));
    }
    pub fn add(&self, z: &Pair<R::Element>, w: &Pair<R::Element>) -> Pair<R::Element> {
        [self.0.add(&z[0], &w[0]), self.0.add(&z[1], &w[1])]
    }
    pub fn neg(&self, z: &Pair<R::Element>) -> Pair<R::Element> {
        z.each_ref().map(|part| self.0.neg(part))
    }
    pub fn conj(&self, [re, im]: &Pair<R::Element>) -> Pair<R::Element> {
        [re.clone(), self.0.neg(im)]
    }
    /// z w; zeros cost nothing.
    pub fn mul(&self, z: &Pair<R::Element>, w: &Pair<R::Element>) -> Pair<R::Element> {
        let product = |a: &R::Element, b: &R::Element| {
            let none = self.0.is_zero(a) || self.0.is_zero(b);
            if none { self.0.zero() } else { self.0.mul(a, b) }
        };
        [
            self.0.sub(&product(&z[0], &w[0]), &product(&z[1], &w[1])),
            self.0.add(&product(&z[0], &w[1]), &product(&z[1], &w[0])),
        ]
    }
    /// x z for a real x.
    pub fn times(&self, z: &Pair<R::Element>, x: &R::Element) -> Pair<R::Element> {
        self.mul(z, &[x.clone(), self.0.zero()])
    }
    /// i^n k^n z for whole n >= 0.
    pub fn differentiated(&self, z: &Pair<R::Element>, k: i64, n: u32) -> Pair<R::Element> {
        (0..n).fold(z.clone(), |[re, im], _| {
            let k = rug::Rational::from(k);
            [self.0.neg(&self.0.scale(&im, &k)), self.0.scale(&re, &k)]
        })
    }
    /// u_1 v_2 - u_2 v_1, of two columns.
    pub fn crossed(&self, u: &Pair<R::Element>, v: &Pair<R::Element>) -> R::Element {
        self.0.sub(&self.0.mul(&u[0], &v[1]), &self.0.mul(&u[1], &v[0]))
    }
    /// 1/z where it is known not to vanish.
    pub fn reciprocal(&self, z: &Pair<R::Element>) -> Option<Pair<R::Element>> {
        let square = self.0.sum_of_products(&[(&z[0], &z[0]), (&z[1], &z[1])]);
        Some(self.times(&self.conj(z), &self.0.reciprocal(&square)?))
    }
}
