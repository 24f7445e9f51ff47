//! The solution as functions of the phase, in balls.

use crate::derivation::{Derivation, Solution};
use lindstedt_algebra::{PhaseAlgebra, Rationals};
use lindstedt_number::ball::Balls;
use lindstedt_phase::evaluate::{PhaseFunctions, of_rational};
use lindstedt_phase::lobachevsky_function::LambdaTable;
use lindstedt_phase::{Lobachevsky, Trigonometric};

impl Derivation {
    /// x_0, x_1, ..., x_N, or their derivatives by the phase, to be evaluated at many phases. Nothing where
    /// the solution was not kept.
    #[must_use]
    pub fn phase_functions(&self, derivative: bool, balls: Balls) -> Option<PhaseFunctions> {
        let lobachevsky = |solution: &[_]| {
            let algebra = Lobachevsky::new(self.ring.clone());
            let functions: Vec<_> = match derivative {
                true => solution.iter().map(|x| algebra.derivative(x)).collect(),
                false => solution.to_vec(),
            };
            let table = LambdaTable::new(functions.len(), balls);
            PhaseFunctions::lobachevsky(&functions, table, |c: &_| {
                self.constants.evaluate(c, balls)
            })
        };
        match &self.solution {
            Solution::Clock(solution) => lobachevsky(&solution.expansion().solution),
            Solution::Lobachevsky(expansion) => lobachevsky(&expansion.solution),
            Solution::Rational(proved) => {
                let algebra = Trigonometric::new(Rationals);
                let solution = proved.expansion().solution;
                let functions: Vec<_> = match derivative {
                    true => solution.iter().map(|x| algebra.derivative(x)).collect(),
                    false => solution,
                };
                PhaseFunctions::trigonometric(&functions, balls, of_rational(balls))
            }
            Solution::FrequencyOnly { .. } => None,
        }
    }
}
