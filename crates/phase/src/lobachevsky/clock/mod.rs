//! From the still part of an oscillation and the numbers of its clock to all of its functions.
//!
//! P = sum_j (-1)^j/j! (sum_m c_m Lambda_m)^j D^j p, D = (1/g) d/dpsi, g = 1 + sum_m c_m l^m/m!: the coefficient of
//! a monomial Lambda^k = prod_m Lambda_m^k_m is
//!
//!   C_k/prod_m k_m!,   C_k = (-1)^j prod_m c_m^k_m D^j p,   j = sum_m k_m,
//!
//! and no two still functions are multiplied but by g. Monomials with equal products of the c_m share C_k (for the power
//! law c_m = u^m, so that j and the weight decide), which leaves one multiplication by 1/(s! prod k_m!) for a term.
//! `docs/src/concepts/clock.md` has the proof.

mod leaf;
mod monomials;
mod unfolding;

use super::{Factor, Lobachevsky, LobachevskyElement, LogPolynomial, Word};
use leaf::factorial;
use lindstedt_algebra::{ClockAlgebra, RationalAlgebra, Ring, StillAndClock};
use lindstedt_coeff::sparse::Sparse;
use rug::Rational;

pub use monomials::LambdaMonomial;
pub use unfolding::Unfolding;

impl<C: RationalAlgebra> ClockAlgebra for Lobachevsky<C> {
    fn pace(&self, numbers: &[C::Element]) -> Self::Element {
        let terms = (1u16..).zip(numbers).map(|(m, c)| {
            let inverse = Rational::from((1, factorial(m.into())));
            (Word::log(m), self.constants.scale(c, &inverse))
        });
        let factor = Factor { power: 0, sine: false };
        self.block(factor, Sparse::collect(&self.constants, terms))
    }

    fn split_clock(&self, f: &Self::Element) -> Option<StillAndClock<Self>> {
        let mut still = self.zero();
        let mut numbers = Vec::new();
        for (factor, polynomial) in f.blocks() {
            let mut rest: LogPolynomial<C::Element> = Sparse::default();
            for (word, c) in polynomial.terms() {
                if word.lambda_degree() == 0 {
                    let term = Sparse::term(&self.constants, word.clone(), c.clone());
                    rest.add_assign(&self.constants, &term);
                    continue;
                }
                let m = word.exponents().len() - 1;
                let alone = *word == Word::lambda(m as u16);
                if !alone || *factor != (Factor { power: 0, sine: true }) {
                    return None;
                }
                if numbers.len() < m {
                    numbers.resize(m, self.constants.zero());
                }
                numbers[m - 1] = c.clone();
            }
            if !rest.is_zero() {
                still.blocks.insert(*factor, rest);
            }
        }
        Some((still, numbers))
    }
}

/// An element of the Lobachevsky ring over the constants of a clock.
pub type Still<C> = LobachevskyElement<<C as Ring>::Element>;
