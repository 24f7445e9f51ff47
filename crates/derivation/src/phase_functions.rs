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
        match &self.solution {
            Solution::Lobachevsky(expansion) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let functions: Vec<_> = match derivative {
                    true => expansion.solution.iter().map(|x| algebra.derivative(x)).collect(),
                    false => expansion.solution.clone(),
                };
                let table = LambdaTable::new(functions.len(), balls);
                let value = |c: &_| self.constants.evaluate(c, balls);
                PhaseFunctions::lobachevsky(&functions, table, value)
            }
            Solution::Rational(proved) => {
                let algebra = Trigonometric::new(Rationals);
                let solution = &proved.expansion.solution;
                let functions: Vec<_> = match derivative {
                    true => solution.iter().map(|x| algebra.derivative(x)).collect(),
                    false => solution.clone(),
                };
                PhaseFunctions::trigonometric(&functions, balls, of_rational(balls))
            }
            Solution::FrequencyOnly { .. } => None,
        }
    }
}
