//! Products of l and the Lambda_m, and the derivations of polynomials in them.

use super::{Lobachevsky, LogPolynomial};
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::sparse::{Accumulator, Monomial, Sparse};
use rug::{Integer, Rational};
use smallvec::SmallVec;

/// l^e_0 Lambda_1^e_1 Lambda_2^e_2 ...: the exponents, without trailing zeros.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Word(SmallVec<[u16; 8]>);

impl Word {
    /// l^exponent. Exponents stay far below 2^16: the compiler of equations refuses degrees above
    /// 1000, and the weight of order n is at most n + 1 times the degree.
    pub fn log(exponent: u16) -> Self {
        let mut word = Self::default();
        if exponent > 0 {
            word.0.push(exponent);
        }
        word
    }

    /// Lambda_m, m >= 1.
    pub fn lambda(m: u16) -> Self {
        let mut word = Self(SmallVec::from_elem(0, usize::from(m.max(1)) + 1));
        if let Some(last) = word.0.last_mut() {
            *last = 1;
        }
        word
    }

    /// The exponents of l, Lambda_1, Lambda_2, ...
    pub fn exponents(&self) -> &[u16] {
        &self.0
    }

    /// The total degree in the Lambda_m.
    pub fn lambda_degree(&self) -> u32 {
        self.0.iter().skip(1).map(|&e| u32::from(e)).sum()
    }

    /// The weight: 1 for l, m for Lambda_m.
    pub fn weight(&self) -> u32 {
        let weights = std::iter::once(1).chain(1u32..);
        self.0.iter().zip(weights).map(|(&e, w)| u32::from(e) * w).sum()
    }

    /// The word with the exponent at `index` lowered by one, and that exponent.
    fn lowered(&self, index: usize) -> Option<(Self, u16)> {
        let exponent = *self.0.get(index).filter(|&&e| e > 0)?;
        let mut word = self.clone();
        word.0[index] -= 1;
        while word.0.last() == Some(&0) {
            word.0.pop();
        }
        Some((word, exponent))
    }
}

impl Ord for Word {
    /// By weight, then by exponents: the order in which solutions are printed.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.weight().cmp(&other.weight()).then_with(|| other.0.cmp(&self.0))
    }
}

impl PartialOrd for Word {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Monomial for Word {
    fn unit() -> Self {
        Self::default()
    }
    fn times(&self, other: &Self) -> Self {
        let (long, short) =
            if self.0.len() >= other.0.len() { (self, other) } else { (other, self) };
        let mut product = long.clone();
        for (x, y) in product.0.iter_mut().zip(&short.0) {
            *x = x.saturating_add(*y);
        }
        product
    }
}

/// dw/dl.
pub(super) fn by_log<C: RationalAlgebra>(
    constants: &C,
    w: &LogPolynomial<C::Element>,
) -> LogPolynomial<C::Element> {
    let derivative = w.terms().iter().filter_map(|(word, c)| {
        let (lowered, exponent) = word.lowered(0)?;
        Some((lowered, constants.scale(c, &Rational::from(exponent))))
    });
    Sparse::collect(constants, derivative)
}

/// The polynomial with derivative w in l and no term free of l.
pub(super) fn antiderivative_by_log<C: RationalAlgebra>(
    constants: &C,
    w: &LogPolynomial<C::Element>,
) -> LogPolynomial<C::Element> {
    let integral = w.terms().iter().map(|(word, c)| {
        let raised = word.times(&Word::log(1));
        let exponent = raised.exponents().first().copied().unwrap_or(1);
        (raised, constants.scale(c, &Rational::from((1, exponent))))
    });
    Sparse::collect(constants, integral)
}

/// (d/dl - k)^{-1} w = -(1/k) sum_j (d/dl)^j w / k^j for k not zero.
pub(super) fn shifted_inverse<C: RationalAlgebra>(
    constants: &C,
    w: &LogPolynomial<C::Element>,
    k: i32,
) -> LogPolynomial<C::Element> {
    let mut term = w.scale(constants, &Rational::from((-1, k)));
    let mut sum = LogPolynomial::default();
    while !term.is_zero() {
        sum.add_assign(constants, &term);
        term = by_log(constants, &term).scale(constants, &Rational::from((1, k)));
    }
    sum
}

/// E w = sum_m (l^m/m! - mu_m) dw/dLambda_m.
pub(super) fn along_lambdas<C: RationalAlgebra>(
    algebra: &Lobachevsky<C>,
    w: &LogPolynomial<C::Element>,
) -> LogPolynomial<C::Element> {
    let constants = &algebra.constants;
    let mut sum = Accumulator::default();
    for (word, c) in w.terms() {
        for index in 1..word.exponents().len() {
            let Some((lowered, exponent)) = word.lowered(index) else { continue };
            let m = index as u32;
            let power = Word::log(index as u16);
            let coefficient =
                Rational::from((u32::from(exponent), Integer::from(Integer::factorial(m))));
            sum.add(constants, lowered.times(&power), constants.scale(c, &coefficient));
            let moment = constants.mul(&(algebra.moment)(constants, index as u16), c);
            let coefficient = Rational::from(-i32::from(exponent));
            sum.add(constants, lowered, constants.scale(&moment, &coefficient));
        }
    }
    sum.finish(constants)
}

/// The C(Lambda) without constant term whose gradient is dC/dLambda_m = m! (coefficient of l^m
/// in w), if the gradient is one: by Euler's relation sum_m Lambda_m dC/dLambda_m = degree C.
pub(super) fn from_gradient<C: RationalAlgebra>(
    constants: &C,
    w: &LogPolynomial<C::Element>,
) -> LogPolynomial<C::Element> {
    let terms = w.terms().iter().filter_map(|(word, c)| {
        let m = word.exponents().first().copied().filter(|&m| m > 0)?;
        let mut rest = word.clone();
        rest.0[0] = 0;
        let degree = rest.lambda_degree() + 1;
        let factor = Rational::from((Integer::from(Integer::factorial(m.into())), degree));
        let raised = rest.times(&Word::lambda(m));
        Some((raised, constants.scale(c, &factor)))
    });
    Sparse::collect(constants, terms)
}
