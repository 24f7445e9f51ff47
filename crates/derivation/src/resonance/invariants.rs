//! Quadratic invariants of slow flows: Q = sum_j q_j |z_j|^2 with
//!
//!   D_n Q = sum_j q_j 2 Re(zbar_j f_{j,n}) = 0
//!
//! for n = 1, ..., identically. Every resonant term of order one of a Hamiltonian flow exchanges |z_j|^2 in the proportion that
//! the lattice of its resonances fixes (Manley and Rowe 1956), so that M unknowns with r independent resonances have M - r of
//! them; in the z_j, which are no canonical coordinates beyond order one, higher orders need not keep them. What is
//! asked here is the kernel of the rates of the |z_j|^2, which knows nothing of potentials and resonances, of all orders at
//! once first, then of fewer: a combination may live longer than the forms it is put together from.

use super::modes::{Matrix, kernel};
use super::{SlowFlow, Terms};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::Rational;
use std::collections::BTreeMap;

/// sum_j q_j |z_j|^2.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct QuadraticInvariant {
    /// As a polynomial.
    pub terms: Terms,
    /// f_1, ..., f_n of so many orders keep it, identically.
    pub orders: usize,
}

impl SlowFlow {
    /// Independent quadratic forms that the f_1, ..., f_n keep, those of most orders first, of several unknowns; none where
    /// coefficients are enclosed.
    #[must_use]
    pub fn quadratic_invariants(&self) -> Vec<QuadraticInvariant> {
        let unknowns = self.unknowns();
        if unknowns < 2 || self.enclosed.is_some() || self.order == 0 {
            return Vec::new();
        }
        let rates: Vec<Matrix> = (1..=self.order).map(|n| self.rates_of_squares(n)).collect();
        let moves = |n: &usize| self.flow.iter().any(|terms| !terms[*n].is_empty());
        // Nothing is said by orders at which all f_n vanish.
        let Some(first) = (1..=self.order).find(moves) else { return Vec::new() };
        let mut found: Vec<(Vec<Rational>, usize)> = Vec::new();
        for orders in (first..=self.order).rev() {
            for q in kernel(rates[..orders].concat(), unknowns) {
                let component = |j: usize| {
                    found.iter().map(|(q, _)| q).chain([&q]).map(|q| q[j].clone()).collect()
                };
                let dependent = kernel((0..unknowns).map(component).collect(), found.len() + 1);
                if dependent.is_empty() {
                    found.push((q, orders));
                }
            }
        }
        let invariant = |(q, orders): (Vec<Rational>, usize)| {
            let square = |(j, q): (usize, &Rational)| {
                let mut exponents = vec![0; self.first_symbol() + self.system.symbols.len()];
                exponents[2 * j..2 * j + 2].fill(1);
                AmplitudeTerm { exponents, re: q.clone(), im: Rational::new() }
            };
            let terms = q.iter().enumerate().filter(|(_, q)| !q.is_zero()).map(square).collect();
            QuadraticInvariant { terms, orders }
        };
        found.into_iter().map(invariant).collect()
    }

    /// The coefficients of D_n |z_j|^2, a column per j.
    fn rates_of_squares(&self, n: usize) -> Matrix {
        let unknowns = self.unknowns();
        let mut rows: BTreeMap<(Vec<i32>, bool), Vec<Rational>> = BTreeMap::new();
        for (j, terms) in self.flow.iter().enumerate() {
            for term in terms.get(n).into_iter().flatten() {
                let mut word = term.exponents.clone();
                word[2 * j + 1] += 1;
                let mut mirrored = word.clone();
                (0..unknowns).for_each(|k| mirrored.swap(2 * k, 2 * k + 1));
                mirrored[2 * unknowns..self.first_symbol()].iter_mut().for_each(|m| *m = -*m);
                for (key, sign) in [(word, 1), (mirrored, -1)] {
                    for (imaginary, part) in
                        [(false, term.re.clone()), (true, Rational::from(&term.im * sign))]
                    {
                        let row = rows.entry((key.clone(), imaginary));
                        row.or_insert_with(|| vec![Rational::new(); unknowns])[j] += part;
                    }
                }
            }
        }
        rows.into_values().collect()
    }
}
