//! Antiderivatives in the Lobachevsky ring, decided completely.
//!
//! Write F = sum_k (cos^k a_k + cos^k sin b_k) with a_k, b_k polynomials in l and the Lambda_m.
//! F' = f reads, power by power (d = d/dl, E = sum_m (l^m/m! - mu_m) d/dLambda_m),
//!
//!   cos^k:      E a_k + (d - (k+1)) b_{k+1} + (k - d) b_{k-1} = f_k
//!   cos^k sin:  E b_k + (d - (k+1)) a_{k+1}                   = g_k
//!
//! d - k is invertible for k != 0 because d is nilpotent, so powers above zero are eliminated
//! from the top, powers below zero from the bottom, and what meets at zero decides: for the
//! pi-periodic functions (k + number of sines even) it determines the part of a_0 that depends
//! on the Lambda_m alone, and the mean value; for the others it must vanish.

use super::word::{along_lambdas, antiderivative_by_log, by_log, from_gradient, shifted_inverse};
use super::{Factor, Lobachevsky, LobachevskyElement, LogPolynomial, Word};
use lindstedt_algebra::{PhaseError, RationalAlgebra};
use lindstedt_coeff::sparse::Monomial;
use std::collections::BTreeMap;

type Antiderivative<C> = (
    LobachevskyElement<<C as lindstedt_algebra::Ring>::Element>,
    <C as lindstedt_algebra::Ring>::Element,
);

/// (F, mean) with f = mean + F'; the constant of integration is arbitrary.
pub(super) fn antiderivative<C: RationalAlgebra>(
    algebra: &Lobachevsky<C>,
    f: &LobachevskyElement<C::Element>,
) -> Result<Antiderivative<C>, PhaseError> {
    let mut mean = algebra.constants.zero();
    let mut blocks = BTreeMap::new();
    for class in [0, 1] {
        let of_class =
            |factor: &Factor| (factor.power + i32::from(factor.sine)).rem_euclid(2) == class;
        let part: BTreeMap<_, _> =
            f.blocks.iter().filter(|(k, _)| of_class(k)).map(|(k, p)| (*k, p)).collect();
        if part.is_empty() {
            continue;
        }
        let mut elimination =
            Elimination { algebra, f: part, a: BTreeMap::new(), b: BTreeMap::new() };
        elimination.positive_powers(class);
        elimination.negative_powers(class);
        if class == 0 {
            mean = elimination.close_periodic()?;
        } else {
            elimination.close_antiperiodic()?;
        }
        let solved = [(false, elimination.a), (true, elimination.b)];
        for (sine, list) in solved {
            for (power, p) in list.into_iter().filter(|(_, p)| !p.is_zero()) {
                blocks.insert(Factor { power, sine }, p);
            }
        }
    }
    Ok((LobachevskyElement { blocks }, mean))
}

struct Elimination<'a, C: RationalAlgebra> {
    algebra: &'a Lobachevsky<C>,
    f: BTreeMap<Factor, &'a LogPolynomial<C::Element>>,
    a: BTreeMap<i32, LogPolynomial<C::Element>>,
    b: BTreeMap<i32, LogPolynomial<C::Element>>,
}

impl<C: RationalAlgebra> Elimination<'_, C> {
    fn right_side(&self, power: i32, sine: bool) -> LogPolynomial<C::Element> {
        self.f.get(&Factor { power, sine }).copied().cloned().unwrap_or_default()
    }

    fn a(&self, k: i32) -> LogPolynomial<C::Element> {
        self.a.get(&k).cloned().unwrap_or_default()
    }

    fn b(&self, k: i32) -> LogPolynomial<C::Element> {
        self.b.get(&k).cloned().unwrap_or_default()
    }

    fn subtract(&self, target: &mut LogPolynomial<C::Element>, p: &LogPolynomial<C::Element>) {
        let ring = &self.algebra.constants;
        target.add_assign(ring, &p.neg(ring));
    }

    /// (d - k) p.
    fn shifted(&self, p: &LogPolynomial<C::Element>, k: i32) -> LogPolynomial<C::Element> {
        let ring = &self.algebra.constants;
        let mut image = by_log(ring, p);
        image.add_assign(ring, &p.scale(ring, &rug::Rational::from(-k)));
        image
    }

    /// a_k and b_{k-1} for k > 0, from the top. The two equations
    ///
    ///   (d - k) a_k = g_{k-1} - E b_{k-1},   (d - k) b_{k-1} = -(f_k - (d - k - 1) b_{k+1}) + E a_k
    ///
    /// refer to each other only through E, which lowers the degree in the Lambda_m: iterate.
    fn positive_powers(&mut self, class: i32) {
        let ring = &self.algebra.constants;
        let top = |factor: &Factor| factor.power + i32::from(factor.sine);
        let mut k = self.f.keys().map(top).max().unwrap_or(0);
        while k > 0 {
            debug_assert_eq!(k.rem_euclid(2), class);
            let mut known = self.right_side(k, false);
            self.subtract(&mut known, &self.shifted(&self.b(k + 1), k + 1));
            let mut step_a = shifted_inverse(ring, &self.right_side(k - 1, true), k);
            let mut step_b = shifted_inverse(ring, &known.neg(ring), k);
            step_b
                .add_assign(ring, &shifted_inverse(ring, &along_lambdas(self.algebra, &step_a), k));
            let (mut a, mut b) = (step_a.clone(), step_b.clone());
            while !step_b.is_zero() {
                step_a = shifted_inverse(ring, &along_lambdas(self.algebra, &step_b).neg(ring), k);
                step_b = shifted_inverse(ring, &along_lambdas(self.algebra, &step_a), k);
                a.add_assign(ring, &step_a);
                b.add_assign(ring, &step_b);
            }
            self.a.insert(k, a);
            self.b.insert(k - 1, b);
            k -= 2;
        }
    }

    /// a_k and b_{k+1} for k < 0 (b_0 is not touched), from the bottom, without coupling.
    fn negative_powers(&mut self, class: i32) {
        let ring = &self.algebra.constants;
        let bottom = |factor: &Factor| factor.power + i32::from(factor.sine);
        let mut k = self.f.keys().map(bottom).min().unwrap_or(0);
        debug_assert_eq!(k.rem_euclid(2), class);
        while k < 0 {
            let mut known = self.right_side(k - 1, true);
            self.subtract(&mut known, &along_lambdas(self.algebra, &self.b(k - 1)));
            let a = shifted_inverse(ring, &known, k);
            if k + 1 != 0 {
                let mut known = self.right_side(k, false);
                self.subtract(&mut known, &along_lambdas(self.algebra, &a));
                known.add_assign(ring, &self.shifted(&self.b(k - 1), k));
                self.b.insert(k + 1, shifted_inverse(ring, &known, k + 1));
            }
            self.a.insert(k, a);
            k += 2;
        }
    }

    /// The equations at cos^{-1} sin and cos^0: a_0 = int (g_{-1} - E b_{-1}) dl + C(Lambda)
    /// and E C = rest - mean. The coefficient of l^m in the latter is dC/dLambda_m / m!.
    fn close_periodic(&mut self) -> Result<C::Element, PhaseError> {
        let ring = &self.algebra.constants;
        let mut known = self.right_side(-1, true);
        self.subtract(&mut known, &along_lambdas(self.algebra, &self.b(-1)));
        let mut a = antiderivative_by_log(ring, &known);
        let mut rest = self.right_side(0, false);
        self.subtract(&mut rest, &along_lambdas(self.algebra, &a));
        self.subtract(&mut rest, &self.shifted(&self.b(1), 1));
        rest.add_assign(ring, &by_log(ring, &self.b(-1)));
        let potential = from_gradient(ring, &rest);
        self.subtract(&mut rest, &along_lambdas(self.algebra, &potential));
        a.add_assign(ring, &potential);
        self.a.insert(0, a);
        match rest.terms() {
            [] => Ok(ring.zero()),
            [(word, mean)] if *word == Word::unit() => Ok(mean.clone()),
            _ => Err(PhaseError::NotIntegrable { power: 0 }),
        }
    }

    /// The equation at cos^{-1}, where everything is already determined.
    fn close_antiperiodic(&mut self) -> Result<(), PhaseError> {
        let ring = &self.algebra.constants;
        let mut rest = self.right_side(-1, false);
        self.subtract(&mut rest, &along_lambdas(self.algebra, &self.a(-1)));
        self.subtract(&mut rest, &by_log(ring, &self.b(0)));
        rest.add_assign(ring, &self.shifted(&self.b(-2), -1));
        if rest.is_zero() { Ok(()) } else { Err(PhaseError::NotIntegrable { power: -1 }) }
    }
}
