//! Trigonometric polynomials over any ring of constants.

use lindstedt_algebra::{
    FunctionAlgebra, PhaseAlgebra, PhaseError, RationalAlgebra, Resolution, Ring,
};
use rug::Rational;
use std::collections::BTreeMap;

/// c_0 + sum_k (c_k cos k psi + s_k sin k psi), lists without trailing zeros.
#[derive(Clone, Debug, PartialEq)]
pub struct TrigonometricPolynomial<E> {
    /// c_0, c_1, ...
    pub cos: Vec<E>,
    /// s_0 = 0, s_1, ...
    pub sin: Vec<E>,
}

/// The algebra of trigonometric polynomials with coefficients in a ring of constants.
///
/// Products cost O(n^2) coefficient products; everything else is linear in the number of
/// harmonics. Over Q high orders
/// are computed by [`crate::Modular`] instead, modulo many primes.
///
/// ```
/// use lindstedt_algebra::{PhaseAlgebra, Rationals, Ring};
/// use lindstedt_phase::Trigonometric;
/// let algebra = Trigonometric::new(Rationals);
/// let square = algebra.mul(&algebra.cosine(), &algebra.cosine());
/// // cos^2 = 1/2 + cos(2 psi)/2.
/// assert_eq!((square.cos[0].to_f64(), square.cos[2].to_f64()), (0.5, 0.5));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Trigonometric<C> {
    constants: C,
}

impl<C: RationalAlgebra> Trigonometric<C> {
    /// The algebra over a ring of constants.
    pub fn new(constants: C) -> Self {
        Self { constants }
    }

    /// c cos k psi.
    pub fn cos(&self, k: usize, c: C::Element) -> TrigonometricPolynomial<C::Element> {
        let mut cos = vec![self.constants.zero(); k];
        cos.push(c);
        self.trim(TrigonometricPolynomial { cos, sin: Vec::new() })
    }

    /// s sin k psi.
    pub fn sin(&self, k: usize, s: C::Element) -> TrigonometricPolynomial<C::Element> {
        if k == 0 {
            return self.zero();
        }
        let mut sin = vec![self.constants.zero(); k];
        sin.push(s);
        self.trim(TrigonometricPolynomial { cos: Vec::new(), sin })
    }

    fn trim(
        &self,
        mut f: TrigonometricPolynomial<C::Element>,
    ) -> TrigonometricPolynomial<C::Element> {
        for list in [&mut f.cos, &mut f.sin] {
            while list.last().is_some_and(|last| self.constants.is_zero(last)) {
                list.pop();
            }
        }
        f
    }

    fn add_lists(&self, a: &mut Vec<C::Element>, b: &[C::Element]) {
        if a.len() < b.len() {
            a.resize(b.len(), self.constants.zero());
        }
        for (x, y) in a.iter_mut().zip(b) {
            self.constants.add_assign(x, y);
        }
    }

    fn map(
        &self,
        f: &TrigonometricPolynomial<C::Element>,
        g: impl Fn(&C::Element) -> C::Element,
    ) -> TrigonometricPolynomial<C::Element> {
        let image = |list: &[C::Element]| list.iter().map(&g).collect();
        self.trim(TrigonometricPolynomial { cos: image(&f.cos), sin: image(&f.sin) })
    }
}

impl<C: RationalAlgebra> Ring for Trigonometric<C> {
    type Element = TrigonometricPolynomial<C::Element>;

    fn zero(&self) -> Self::Element {
        TrigonometricPolynomial { cos: Vec::new(), sin: Vec::new() }
    }
    fn one(&self) -> Self::Element {
        self.cos(0, self.constants.one())
    }
    fn is_zero(&self, f: &Self::Element) -> bool {
        f.cos.is_empty() && f.sin.is_empty()
    }
    fn add_assign(&self, f: &mut Self::Element, g: &Self::Element) {
        self.add_lists(&mut f.cos, &g.cos);
        self.add_lists(&mut f.sin, &g.sin);
        *f = self.trim(std::mem::replace(f, self.zero()));
    }
    fn neg(&self, f: &Self::Element) -> Self::Element {
        self.map(f, |c| self.constants.neg(c))
    }
    fn mul(&self, f: &Self::Element, g: &Self::Element) -> Self::Element {
        self.sum_of_products(&[(f, g)])
    }

    /// The product formulas cos a cos b = (cos(a+b) + cos(a-b))/2 and so on.
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let ring = &self.constants;
        let mut sum = Harmonics { ring, cos: Vec::new(), sin: Vec::new() };
        let nonzero = |list: &[C::Element]| -> Vec<(isize, C::Element)> {
            let entries = (0isize..).zip(list.iter().cloned());
            entries.filter(|(_, c)| !ring.is_zero(c)).collect()
        };
        for (f, g) in pairs {
            let first = [nonzero(&f.cos), nonzero(&f.sin)];
            let second = [nonzero(&g.cos), nonzero(&g.sin)];
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                for (k, x) in &first[i] {
                    for (m, y) in &second[j] {
                        let xy = ring.mul(x, y);
                        match (i, j) {
                            (0, 0) => {
                                sum.add_cos(k + m, xy.clone());
                                sum.add_cos(k - m, xy);
                            }
                            (1, 1) => {
                                sum.add_cos(k + m, ring.neg(&xy));
                                sum.add_cos(k - m, xy);
                            }
                            (0, _) => {
                                sum.add_sin(k + m, xy.clone());
                                sum.add_sin(k - m, ring.neg(&xy));
                            }
                            _ => {
                                sum.add_sin(k + m, xy.clone());
                                sum.add_sin(k - m, xy);
                            }
                        }
                    }
                }
            }
        }
        let half = Rational::from((1, 2));
        let Harmonics { cos, sin, .. } = sum;
        self.map(&TrigonometricPolynomial { cos, sin }, |c| ring.scale(c, &half))
    }
}

/// A sum of harmonics under construction; negative harmonics are folded back.
struct Harmonics<'a, C: Ring> {
    ring: &'a C,
    cos: Vec<C::Element>,
    sin: Vec<C::Element>,
}

impl<C: Ring> Harmonics<'_, C> {
    fn add_cos(&mut self, harmonic: isize, c: C::Element) {
        let index = harmonic.unsigned_abs();
        grow(self.ring, &mut self.cos, index);
        self.ring.add_assign(&mut self.cos[index], &c);
    }
    fn add_sin(&mut self, harmonic: isize, c: C::Element) {
        let index = harmonic.unsigned_abs();
        if index > 0 {
            let c = if harmonic < 0 { self.ring.neg(&c) } else { c };
            grow(self.ring, &mut self.sin, index);
            self.ring.add_assign(&mut self.sin[index], &c);
        }
    }
}

fn grow<R: Ring>(ring: &R, list: &mut Vec<R::Element>, index: usize) {
    if list.len() <= index {
        list.resize(index + 1, ring.zero());
    }
}

impl<C: RationalAlgebra> RationalAlgebra for Trigonometric<C> {
    fn rational(&self, q: &Rational) -> Self::Element {
        self.cos(0, self.constants.rational(q))
    }
    fn scale(&self, f: &Self::Element, q: &Rational) -> Self::Element {
        self.map(f, |c| self.constants.scale(c, q))
    }
    /// Only constants are units.
    fn reciprocal(&self, f: &Self::Element) -> Option<Self::Element> {
        let constant = self.as_constant(f)?;
        Some(self.cos(0, self.constants.reciprocal(&constant)?))
    }
    fn as_rational(&self, f: &Self::Element) -> Option<Rational> {
        self.constants.as_rational(&self.as_constant(f)?)
    }
}

impl<C: RationalAlgebra> FunctionAlgebra for Trigonometric<C> {
    type Constants = C;
    fn constants(&self) -> &C {
        &self.constants
    }
    fn embed(&self, c: &C::Element) -> Self::Element {
        self.cos(0, c.clone())
    }
    fn scale_by(&self, f: &Self::Element, c: &C::Element) -> Self::Element {
        self.map(f, |x| self.constants.mul(x, c))
    }
    fn as_constant(&self, f: &Self::Element) -> Option<C::Element> {
        (f.sin.is_empty() && f.cos.len() <= 1)
            .then(|| f.cos.first().cloned().unwrap_or_else(|| self.constants.zero()))
    }
    /// ln of a trigonometric polynomial is none, except ln 1 = 0.
    fn log_abs(&self, f: &Self::Element) -> Option<Self::Element> {
        (*f == self.one()).then(|| self.zero())
    }
    fn terms(&self, f: &Self::Element) -> usize {
        f.cos.iter().chain(&f.sin).filter(|c| !self.constants.is_zero(c)).count()
    }
}

impl<C: RationalAlgebra> PhaseAlgebra for Trigonometric<C> {
    fn cosine(&self) -> Self::Element {
        self.cos(1, self.constants.one())
    }
    fn sine(&self) -> Self::Element {
        self.sin(1, self.constants.one())
    }
    fn derivative(&self, f: &Self::Element) -> Self::Element {
        let times = |list: &[C::Element], sign: i64| -> Vec<C::Element> {
            let factors = (0i64..).map(|k| Rational::from(sign * k));
            list.iter().zip(factors).map(|(c, k)| self.constants.scale(c, &k)).collect()
        };
        self.trim(TrigonometricPolynomial { cos: times(&f.sin, 1), sin: times(&f.cos, -1) })
    }
    /// (1 - k^2) c_k: no sum of two long numbers.
    fn force(&self, f: &Self::Element) -> Self::Element {
        let times = |list: &[C::Element]| -> Vec<C::Element> {
            let factors = (0i64..).map(|k| Rational::from(1 - k * k));
            list.iter().zip(factors).map(|(c, k)| self.constants.scale(c, &k)).collect()
        };
        self.trim(TrigonometricPolynomial { cos: times(&f.cos), sin: times(&f.sin) })
    }
    fn at_zero(&self, f: &Self::Element) -> Option<C::Element> {
        let mut sum = self.constants.zero();
        for c in &f.cos {
            self.constants.add_assign(&mut sum, c);
        }
        Some(sum)
    }
    fn first_harmonic(&self, f: &Self::Element) -> Result<(C::Element, C::Element), PhaseError> {
        let first =
            |list: &[C::Element]| list.get(1).cloned().unwrap_or_else(|| self.constants.zero());
        Ok((first(&f.cos), first(&f.sin)))
    }
    /// u_k = f_k/(1 - k^2), then the multiples of cos and sin that bring u to rest at psi = 0.
    fn resolve(&self, f: &Self::Element) -> Result<Resolution<Self>, PhaseError> {
        let (cos_amplitude, sin_amplitude) = self.first_harmonic(f)?;
        let divide = |list: &[C::Element]| -> Vec<C::Element> {
            let quotient = |(k, c): (i64, &C::Element)| match k {
                1 => self.constants.zero(),
                _ => self.constants.scale(c, &Rational::from((1, 1 - k * k))),
            };
            (0i64..).zip(list).map(quotient).collect()
        };
        let mut response =
            self.trim(TrigonometricPolynomial { cos: divide(&f.cos), sin: divide(&f.sin) });
        let mut correction = self.zero();
        if let Some(value) = self.at_zero(&response) {
            self.add_assign(&mut correction, &self.cos(1, value));
        }
        if let Some(slope) = self.at_zero(&self.derivative(&response)) {
            self.add_assign(&mut correction, &self.sin(1, slope));
        }
        response = self.sub(&response, &correction);
        Ok(Resolution { cos_amplitude, sin_amplitude, response })
    }
}

/// The harmonics that occur with their coefficients, for printing: (k, c_k, s_k).
pub fn harmonics<C: RationalAlgebra>(
    constants: &C,
    f: &TrigonometricPolynomial<C::Element>,
) -> BTreeMap<usize, (C::Element, C::Element)> {
    let mut table = BTreeMap::new();
    for k in 0..f.cos.len().max(f.sin.len()) {
        let get = |list: &[C::Element]| list.get(k).cloned().unwrap_or_else(|| constants.zero());
        let (c, s) = (get(&f.cos), get(&f.sin));
        if !constants.is_zero(&c) || !constants.is_zero(&s) {
            table.insert(k, (c, s));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::{Rationals, laws};
    use lindstedt_coeff::{PolynomialRing, Symbol};

    #[test]
    fn laws_hold_over_q() {
        let a = Trigonometric::new(Rationals);
        let q = |n, d| Rational::from((n, d));
        let mixed = a.add(&a.cos(0, q(2, 3)), &a.add(&a.cos(1, q(-1, 2)), &a.sin(4, q(5, 7))));
        let odd = a.add(&a.cos(3, q(1, 3)), &a.sin(1, q(4, 1)));
        let even = a.add(&a.cos(2, q(1, 9)), &a.sin(6, q(4, 5)));
        let samples = [a.zero(), a.one(), a.cosine(), a.sine(), mixed, odd, even];
        assert_eq!(laws::phase_algebra(&a, &samples), Ok(()));
    }

    #[test]
    fn laws_hold_over_polynomials() {
        let ring = PolynomialRing { parameters: vec!["a".into()] };
        let amplitude = ring.symbol(Symbol::Parameter(0));
        let a = Trigonometric::new(ring.clone());
        let f = a.add(&a.cos(1, amplitude.clone()), &a.sin(3, ring.mul(&amplitude, &amplitude)));
        assert_eq!(laws::phase_algebra(&a, &[f, a.sine()]), Ok(()));
    }
}
